"""Where a hand wants the handle to be, as datagrams from another program: an on-screen stick, a script.

One datagram is one sample of 56 bytes, little-endian, sent to a Unix datagram socket that the driver binds:

| bytes | field | unit |
|---|---|---|
| 0-3 | magic `GSTK` | |
| 4-7 | version, uint32 | |
| 8-15 | time it was taken, float64 | s, monotonic clock of the machine |
| 16-39 | position x, y, z, 3 float64 | m from the centre, handle frame |
| 40-47 | yaw, float64 | rad, counter-clockwise from above |
| 48-51 | buttons, uint32 | one bit each |
| 52-55 | zero | |

The sender repeats its sample at 20 Hz or more even while the hand rests: a stick silent for 0.2 s is gone.
"""

from __future__ import annotations

import contextlib
import errno
import math
import os
import socket
import stat
import struct
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from drivers.device import DeviceError, Vector3

LAYOUT = struct.Struct("<4sI5dI4x")
MAGIC = b"GSTK"
VERSION = 1
LARGEST_POSITION = 1.0
LARGEST_YAW = math.pi
SILENCE_S = 0.2
MOST_PER_READ = 64
"""A reader looks at no more datagrams than this in one go, so that a flood cannot hold up its tick."""


class StickSample(NamedTuple):
    """Where the hand wants the handle to be, in the handle frame.

    Attributes:
        t: When it was taken, s on the monotonic clock.
        position: From the centre, m; each component within 1 m.
        yaw: Rad, counter-clockwise from above, within ±π.
        buttons: One bit a button, 32 of them.
    """

    t: float
    position: Vector3
    yaw: float
    buttons: int


def encode(sample: StickSample) -> bytes:
    """Return the datagram of a sample."""
    x, y, z = sample.position
    return LAYOUT.pack(MAGIC, VERSION, sample.t, x, y, z, sample.yaw, sample.buttons)


def decode(datagram: bytes) -> StickSample | None:
    """Return the sample in a datagram, or None where it is not one: length, magic, version, range, NaN."""
    if len(datagram) != LAYOUT.size:
        return None
    magic, version, t, x, y, z, yaw, buttons = LAYOUT.unpack(datagram)
    if magic != MAGIC or version != VERSION or not math.isfinite(t):
        return None
    # A comparison with NaN is false, so what is not a number does not pass.
    in_range = (
        abs(x) <= LARGEST_POSITION
        and abs(y) <= LARGEST_POSITION
        and abs(z) <= LARGEST_POSITION
        and abs(yaw) <= LARGEST_YAW
    )
    return StickSample(t, (x, y, z), yaw, buttons) if in_range else None


class StickSender:
    """Sends samples to a handle's socket. Nobody need be there, and no send ever waits.

    Args:
        path: The driver's socket.
    """

    def __init__(self, path: str) -> None:
        self._path = path
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.settimeout(0.0)

    def send(self, position: Vector3, yaw: float, buttons: int, t: float) -> bool:
        """Send one sample; see `StickSample`.

        Returns:
            True where it was handed over, False where no driver listens or it is too busy.
        """
        try:
            self._socket.sendto(encode(StickSample(t, position, yaw, buttons)), self._path)
        except OSError:
            return False
        return True

    def close(self) -> None:
        """Let the socket go."""
        self._socket.close()


class StickReceiver:
    """The driver's end: binds the socket, checks what comes, and knows the newest sample.

    Args:
        path: Where to bind, readable and writable by this user only.
        clock: Monotonic seconds.

    Attributes:
        newest: The newest good sample, or None before the first.
        rejected: Datagrams ignored because they were malformed, out of range, or not newer.

    Raises:
        DeviceError: There is no path.
    """

    def __init__(self, path: str, clock: Callable[[], float]) -> None:
        if not path:
            raise DeviceError(
                "The handle needs the path of its socket; write it after the colon: virtual:PATH."
            )
        self._path = path
        self._clock = clock
        self._socket: socket.socket | None = None
        self._bound: tuple[int, int] | None = None
        self.newest: StickSample | None = None
        self.rejected = self._rejected_before = 0

    def open(self) -> None:
        """Bind the socket; one that a program left behind when it died is replaced.

        Raises:
            DeviceError: The path is in use, is not a socket, or cannot be bound.
        """
        self.close()
        clear_dead_socket(self._path)
        receiver = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        try:
            receiver.settimeout(0.0)
            # On Linux the socket's mode becomes that of its file: at no moment can another user write to it.
            os.fchmod(receiver.fileno(), stat.S_IRUSR | stat.S_IWUSR)
            receiver.bind(self._path)
            self._bound = _identity(self._path)
        except OSError as error:
            receiver.close()
            raise DeviceError(
                f"{self._path}: the handle's socket cannot be bound ({error.strerror or error}); "
                "check the path."
            ) from error
        self._socket = receiver
        self.newest = None
        self.rejected = self._rejected_before = 0

    def receive(self) -> list[StickSample]:
        """Return the good samples that came since the last call, each newer than the one before it.

        A sample from the future is not believed: it would hide the sender's silence.

        Raises:
            DeviceError: The socket is not open.
        """
        if self._socket is None:
            raise DeviceError(f"{self._path}: the handle is not open; open it first.")
        samples: list[StickSample] = []
        for _ in range(MOST_PER_READ):
            try:
                datagram = self._socket.recv(LAYOUT.size + 1)
            except BlockingIOError:
                break
            sample = decode(datagram)
            newest_t = -math.inf if self.newest is None else self.newest.t
            if sample is None or not newest_t < sample.t <= self._clock():
                self.rejected += 1
                continue
            self.newest, self._rejected_before = sample, self.rejected
            samples.append(sample)
        return samples

    def fresh(self, now: float) -> StickSample:
        """Return the newest sample.

        Raises:
            DeviceError: None came yet, or the newest is older than 0.2 s: a stale handle is never flown.
        """
        if self.newest is not None and now - self.newest.t <= SILENCE_S:
            return self.newest
        if self.rejected > self._rejected_before:
            raise DeviceError(
                f"{self._path}: what comes is no sample of a stick (not a number, out of range, or old); "
                "check the program that moves the handle."
            )
        if self.newest is None:
            raise DeviceError(f"{self._path}: no stick yet; start the program that moves the handle.")
        raise DeviceError(f"{self._path}: the stick is silent; check the program that moves the handle.")

    def close(self) -> None:
        """Let the socket go and remove its file, if it is still ours."""
        if self._socket is None:
            return
        self._socket.close()
        self._socket = None
        with contextlib.suppress(OSError):
            if _identity(self._path) == self._bound:
                Path(self._path).unlink()


def clear_dead_socket(path: str) -> None:
    """Remove a socket file at `path` that nobody listens on.

    Raises:
        DeviceError: Somebody listens, or it is not a socket.
    """
    try:
        mode = Path(path).stat().st_mode
    except (OSError, ValueError):
        return
    if not stat.S_ISSOCK(mode):
        raise DeviceError(f"{path}: is not a socket; give the handle another path.")
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(path)
        except OSError as error:
            if error.errno != errno.ECONNREFUSED:
                raise DeviceError(
                    f"{path}: is somebody else's socket; give the handle another path."
                ) from error
            Path(path).unlink(missing_ok=True)
            return
    raise DeviceError(f"{path}: another handle listens there; end it or give this one another path.")


def _identity(path: str) -> tuple[int, int]:
    status = Path(path).stat()
    return status.st_dev, status.st_ino
