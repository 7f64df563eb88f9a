#!/usr/bin/env python3
"""Ask whether a locked dependency has a known vulnerability: exit 1 where one has, 0 where none has or none answers.

pip-audit (of the PyPA) looks them up at pypi.org; what it could not look up is said.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

UV = Path(sys.executable).with_name("uv")
PIP_AUDIT = "pip-audit==2.10.*"


def report() -> str:
    """Return pip-audit's report on all locked packages as JSON, or "" where it has none."""
    with tempfile.NamedTemporaryFile(suffix=".txt") as locked:
        subprocess.run(
            [UV, "export", "--locked", "--quiet", "--all-extras", "--no-emit-project", "--no-hashes",
             "--output-file", locked.name], check=True, stdout=subprocess.DEVNULL,
        )  # fmt: skip
        return subprocess.run(
            [UV, "tool", "run", "--quiet", PIP_AUDIT, "--disable-pip", "--no-deps", "--progress-spinner", "off",
             "--format", "json", "--requirement", locked.name], check=False, capture_output=True, text=True,
        ).stdout  # fmt: skip


def judged(text: str) -> tuple[int, list[str]]:
    """Return the exit code of a report and what there is to say."""
    try:
        packages: list[dict[str, Any]] = json.loads(text)["dependencies"]
    except (ValueError, KeyError):
        return 0, ["audit: skipped, the vulnerability database does not answer."]
    asked = [each for each in packages if "skip_reason" not in each]
    if not asked:
        return 0, ["audit: skipped, the vulnerability database knows none of the packages; is it a mirror?"]
    lines = [
        f"audit: {each['name']} {each['version']}: {found['id']}, "
        f"mended in {', '.join(found['fix_versions']) or 'no version yet'}"
        for each in asked
        for found in each["vulns"]
    ]
    unknown = len(packages) - len(asked)
    good = (
        f"audit: none of {len(asked)} packages has a known vulnerability; {unknown} could not be looked up."
    )
    return (1, lines) if lines else (0, [good])


if __name__ == "__main__":
    code, lines = judged(report())
    sys.stdout.write("\n".join(lines) + "\n")
    sys.exit(code)
