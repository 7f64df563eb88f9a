"""An emulator in a process of its own: `python -m drivers.emulators NAME SOCKET`.

It says on its standard output what to give to `--device`, and ends when its standard input does.
"""

from __future__ import annotations

import gc
import select
import sys
import time

from drivers.device import DeviceError
from drivers.emulators.registry import make_emulator, serve


def main() -> int:
    """Serve until nobody holds the standard input any more; return the exit code."""
    name, socket = sys.argv[1:]
    try:
        emulator = make_emulator(name, time.monotonic, socket)
    except DeviceError as error:
        sys.stdout.write(f"! {error}\n")
        return 2
    sys.stdout.write(f"{emulator.uri}\n")
    sys.stdout.flush()
    gc.freeze()
    try:
        serve(emulator, lambda: not select.select([sys.stdin], [], [], 0.0)[0])
    finally:
        emulator.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
