"""The C++ loop over rigid bodies, built on first use."""

from __future__ import annotations

import ctypes
import hashlib
import shutil
import subprocess
from pathlib import Path

import numpy as np
import platformdirs

from sim.many.lanes import Flat
from sim.many.rows import Array

SOURCE = Path(__file__).with_name("rigid_body.cpp")
FLAGS = ("-std=c++17", "-O3", "-march=native", "-ffp-contract=off", "-fno-math-errno", "-shared", "-fPIC")
# The loop takes whole blocks of lanes only.
BLOCK = 16


class NoCompilerError(Exception):
    """The loop cannot be built here; the message says why."""


class CppLoop:
    """Rigid bodies in rows, stepped by the C++ loop.

    Args:
        lanes: Where they start, (20, n), n a multiple of `BLOCK`; stepped in place.
        v_ref: (4, n).
        wind: (3, n).
        constants: The rigid body's law's.

    Raises:
        NoCompilerError: There is no g++, or it fails.
    """

    def __init__(self, lanes: Array, v_ref: Array, wind: Array, constants: Flat) -> None:
        self.lanes = lanes
        self._kept = (np.ascontiguousarray(v_ref), np.ascontiguousarray(wind), np.array(constants))
        self._fly = ctypes.CDLL(str(built())).fly
        self._fly.argtypes = [ctypes.c_void_p] * 4 + [ctypes.c_size_t] * 2
        self._at = tuple(array.ctypes.data for array in (lanes, *self._kept))

    def step(self, steps: int = 1) -> None:
        """Advance by so many steps."""
        self._fly(*self._at, self.lanes.shape[1], steps)


def built() -> Path:
    """Return the library, built for this processor.

    Raises:
        NoCompilerError: There is no g++, or it fails.
    """
    compiler = shutil.which("g++")
    if compiler is None:
        raise NoCompilerError("there is no g++ here")
    digest = hashlib.sha256(SOURCE.read_bytes() + " ".join(FLAGS).encode()).hexdigest()[:12]
    library = Path(platformdirs.user_cache_dir("groundstation", appauthor=False)) / f"rigid_body-{digest}.so"
    if not library.exists():
        try:
            library.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise NoCompilerError(f"there is nowhere to keep it: {error}") from error
        ran = subprocess.run(
            [compiler, *FLAGS, str(SOURCE), "-o", str(library)], capture_output=True, text=True, check=False
        )
        if ran.returncode:
            raise NoCompilerError(f"g++ failed: {ran.stderr.strip().splitlines()[0]}")
    return library
