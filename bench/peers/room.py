"""An environment for the peers, of its own, in the user's cache; made on first use from the pinned requirements."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

import platformdirs

HERE = Path(__file__).resolve().parent
FILES = ("requirements.txt", "torch.txt")


class Room:
    """The peers' environment.

    Attributes:
        missing: What could not be installed, and why; by the requirements' file.
    """

    def __init__(self) -> None:
        told = b"".join((HERE / name).read_bytes() for name in FILES)
        name = (
            f"bench-{hashlib.sha256(told).hexdigest()[:12]}-{sys.version_info.major}{sys.version_info.minor}"
        )
        self.folder = Path(platformdirs.user_cache_dir("groundstation", appauthor=False)) / name
        self.python = self.folder / "bin" / "python"
        self.missing: dict[str, str] = {}
        if not self.python.exists() and (why := _run("venv", "--python", sys.executable, str(self.folder))):
            self.missing = dict.fromkeys(FILES, why)
            return
        for file in FILES:
            done = self.folder / f"{file}.done"
            if not done.exists():
                self._install(file, done)

    def environment(self) -> dict[str, str]:
        """Return what the peers run with: one thread, and what HyperDrone builds itself from."""
        cache = self.folder / "hyperdrone"
        seed = cache / ".dependencies" / "seed" / "nlohmann_json-src" / "include"
        header = next(self.folder.glob("lib/python*/site-packages/nlohmann_json/include"), None)
        if header and not seed.exists():
            shutil.copytree(header, seed)
        return os.environ | {
            "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1",
            "HYPERLUX_CACHE_DIR": str(cache), "HYPERLUX_OFFLINE": "1",
            "CMAKE_TOOLCHAIN_FILE": str(HERE / "hyperdrone.cmake"),
            "PYTHONWARNINGS": "ignore",
        }  # fmt: skip

    def _install(self, file: str, done: Path) -> None:
        print(f"  installing the peers of {file} into {self.folder} (once) …", flush=True)
        where = ("--python", str(self.python), "--no-deps", "-r", str(HERE / file))
        # Without a wheel at hand torch comes from its own index of builds for the processor alone.
        small = (
            ("--torch-backend", "cpu") if file == "torch.txt" and not os.environ.get("PIP_FIND_LINKS") else ()
        )
        if why := _run("pip", "install", *where, *small):
            self.missing[file] = why
        else:
            done.touch()


def _run(*arguments: str) -> str:
    """Run uv and return why it failed, "" if it did not."""
    uv = shutil.which("uv", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}")
    if uv is None:
        return "uv is not installed"
    # uv does not read where pip is told to look for wheels.
    links = os.environ.get("UV_FIND_LINKS") or os.environ.get("PIP_FIND_LINKS", "")
    ran = subprocess.run(
        [uv, *arguments],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"UV_FIND_LINKS": links},
    )
    return "" if ran.returncode == 0 else (ran.stderr.strip().splitlines() or ["uv failed"])[-1]
