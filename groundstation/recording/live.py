"""The live viewer: one that `--rerun` starts, a window or a page for the browser, or one that runs already."""

from __future__ import annotations

import atexit
import os
import re
import socket
import subprocess
import sys
import time
from collections.abc import Mapping
from urllib.parse import quote

from groundstation.errors import InputError
from groundstation.recording.program import ENVIRONMENT, LOOPBACK, program

_HOST = "127.0.0.1"
_START_S = 15.0
_POLL_S = 0.05
_ANSWER_S = 2.0
# Rerun's own port, where none is named.
_PORT = 9876
_ADDRESS = re.compile(r"(?:rerun(?:\+https?)?://)?(\[[0-9a-fA-F:]+\]|[\w.-]+)(?::(\d{1,5}))?(?:/proxy)?/?")
# What a viewer keeps of a long flight; older data leave it, not the file.
_MEMORY = ("--memory-limit", "2GB", "--server-memory-limit", "256MB")


def start_viewer(environment: Mapping[str, str] = os.environ) -> str:
    """Start a live viewer on this machine's loopback and return the URL to stream to.

    A window stays open after the flight, to look at; the browser's page is served until this program ends.

    Args:
        environment: Tells whether there is a display.

    Raises:
        InputError: The viewer does not start.
    """
    port = free_tcp_port()
    window = has_display(environment)
    command = [str(program()), *LOOPBACK, "--port", str(port), *_MEMORY]
    page_port = free_tcp_port()
    if window:
        command += ["--hide-welcome-screen", "--expect-data-soon"]
    else:
        command += ["--serve-web", "--web-viewer-port", str(page_port)]
    viewer = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**environment, **ENVIRONMENT},
        start_new_session=True,
    )
    if not window:
        atexit.register(viewer.terminate)
    deadline = time.monotonic() + _START_S
    while not listening(port):
        if viewer.poll() is not None or time.monotonic() > deadline:
            viewer.terminate()
            raise InputError(
                "the Rerun viewer does not start; fly without --rerun and use 'review' afterwards."
            )
        time.sleep(_POLL_S)
    url = f"rerun+http://{_HOST}:{port}/proxy"
    if not window:
        sys.stderr.write(f"Live view: {page_address(page_port, url)}\n")
    return url


def find_viewer(address: str) -> str:
    """Return the URL to stream to of a viewer that runs already.

    Args:
        address: `HOST`, `HOST:PORT`, or a URL as the viewer tells it, `rerun+http://HOST:PORT/proxy`.

    Raises:
        InputError: That is no address, or nothing answers there; a stream would never find it later.
    """
    found = _ADDRESS.fullmatch(address)
    port = int(found[2] or _PORT) if found else 0
    if found is None or not 0 < port < 65_536:
        raise InputError(f"--viewer {address}: is no address; use HOST:PORT, such as {_HOST}:{_PORT}.")
    try:
        socket.create_connection((found[1].strip("[]"), port), _ANSWER_S).close()
    except OSError as error:
        raise InputError(
            f"--viewer {address}: nothing answers there ({error.strerror or error}); start a viewer with "
            f"'rerun --bind {_HOST} --port {port}', or let --rerun do it."
        ) from error
    return f"rerun+http://{found[1]}:{port}/proxy"


def page_address(page_port: int, url: str) -> str:
    """Return what to open in a browser to see what is streamed to `url`."""
    return f"http://{_HOST}:{page_port}/?url={quote(url, safe='')}"


def has_display(environment: Mapping[str, str]) -> bool:
    """Say whether a window can be opened."""
    return sys.platform == "darwin" or bool(environment.get("DISPLAY") or environment.get("WAYLAND_DISPLAY"))


def free_tcp_port() -> int:
    """Return a TCP port on loopback that nobody listens on."""
    with socket.socket() as probe:
        probe.bind((_HOST, 0))
        return int(probe.getsockname()[1])


def listening(port: int) -> bool:
    """Say whether somebody listens on a loopback port."""
    with socket.socket() as probe:
        return probe.connect_ex((_HOST, port)) == 0
