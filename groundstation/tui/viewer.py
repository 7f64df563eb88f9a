"""Opens a recording in the viewer, as a program of its own that outlives the flight; tells why if it could not."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import IO


class Viewer:
    """Starts `groundstation review` and watches whether it fails."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._output: IO[bytes] | None = None

    def open(self, recording: Path, at: float | None = None) -> None:
        """Open a recording, at a time of it, s, or at its beginning."""
        where = [] if at is None else ["--at", f"{at:.3f}"]
        self._output = tempfile.TemporaryFile()  # noqa: SIM115 - read when the program has ended
        self._process = subprocess.Popen(
            [sys.executable, "-m", "groundstation.cli", "review", str(recording), *where],
            stdin=subprocess.DEVNULL,
            stdout=self._output,
            stderr=self._output,
            start_new_session=True,
        )

    def failure(self) -> str:
        """Return once why the viewer could not show it, or ""."""
        process, output = self._process, self._output
        if process is None or output is None or (code := process.poll()) is None:
            return ""
        self._process = self._output = None
        output.seek(0)
        lines = [line for line in output.read().decode(errors="replace").splitlines() if line.strip()]
        output.close()
        return (lines[-1] if lines else f"the viewer ended with {code}") if code else ""
