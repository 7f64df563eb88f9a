"""The screen in a browser: as `textual serve` starts it, over pipes, without a terminal."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

pytestmark = pytest.mark.flight
WEB = {"TEXTUAL_DRIVER": "textual.drivers.web_driver:WebDriver", "COLUMNS": "120", "ROWS": "40"}


def test_a_browsers_screen_is_painted_and_ends_with_its_page(tmp_path):
    with subprocess.Popen(
        [sys.executable, "-m", "groundstation.cli", "--sim", "--logs", str(tmp_path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=os.environ | WEB,
    ) as program:
        painted = b""
        while b"Ready on the ground" not in painted:
            painted = (painted + program.stdout.read1(65536))[-200_000:]
            assert program.poll() is None
        assert b"SIM" in painted
        # The page is closed: a stick that nobody holds.
        program.stdin.close()
        program.stdout.close()
        assert program.wait(30.0) != 0
