"""A serial device's end of a pseudo-terminal: what pyserial opens as a port, seen from the other side."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import select
import struct
import tempfile
import tty
from pathlib import Path

# From Linux's asm-generic/termbits.h: struct termios2 holds the speeds as numbers, any at all.
_TCGETS2 = 0x802C542A
_TERMIOS2 = struct.Struct("4I20B2I")


class Pty:
    """A port that can be plugged in and out; its path stays the same.

    Attributes:
        path: What a driver opens: a link to the pseudo-terminal, or to nothing while unplugged.
    """

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="groundstation-pty-")
        self._master = -1
        self.path = str(Path(self._folder.name) / "port")
        self.plug()

    def plug(self) -> None:
        """Put it in, if it is out."""
        if self._master >= 0:
            return
        self._master, slave = os.openpty()
        tty.setraw(slave)
        os.set_blocking(self._master, False)
        Path(self.path).symlink_to(os.ttyname(slave))
        # Held by nobody but the driver, so that the master sees it come and go, and so does who looks for users.
        os.close(slave)

    def unplug(self) -> None:
        """Pull it out, if it is in."""
        if self._master < 0:
            return
        Path(self.path).unlink()
        os.close(self._master)
        self._master = -1

    def close(self) -> None:
        """Unplug it for good."""
        self.unplug()
        self._folder.cleanup()

    def descriptors(self) -> list[int]:
        """Return what to select on: nothing while no driver has the port open, as that would be readable always."""
        return [self._master] if self.opened() else []

    def opened(self) -> bool:
        """Say whether a driver has the port open."""
        if self._master < 0:
            return False
        poll = select.poll()
        poll.register(self._master, 0)
        return not any(event & select.POLLHUP for _, event in poll.poll(0))

    def read(self) -> bytes:
        """Return the bytes the driver has sent; nothing while it has not the port open."""
        if self._master < 0:
            return b""
        try:
            return os.read(self._master, 4096)
        except OSError as error:
            if error.errno in {errno.EIO, errno.EAGAIN}:
                return b""
            raise

    def write(self, data: bytes) -> None:
        """Send bytes to the driver; what does not fit its buffer is lost, as on a real line."""
        if self._master >= 0 and data:
            with contextlib.suppress(BlockingIOError):
                os.write(self._master, data)

    def baudrate(self) -> int:
        """Return the speed the driver has set, baud."""
        settings = fcntl.ioctl(self._master, _TCGETS2, bytes(_TERMIOS2.size))
        return int(_TERMIOS2.unpack(settings)[-1])
