"""Make all pictures of README and docs: the screen from a canned flight, the report's figures from virtual ones, the
viewer and the moving one from real ones.

`make docs-pictures`. The viewer's picture needs a Vulkan driver (Debian: mesa-vulkan-drivers, libvulkan1).
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
FLY = ("-m", "groundstation.cli", "--sim", "--headless", "--mission", "paper", "--json")


def main() -> None:
    """Make them."""
    for picture in ("screen.py", "paper.py", "session.py"):
        subprocess.run([sys.executable, HERE / picture], check=True)
    with tempfile.TemporaryDirectory() as logs:
        flown = subprocess.run(
            [sys.executable, *FLY, "--logs", logs],
            cwd=HERE.parents[1],
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
        recording = json.loads(flown.stdout)["logs"]["rrd"]
        subprocess.run([sys.executable, HERE / "viewer.py", recording], check=True)


if __name__ == "__main__":
    main()
