"""Ways to a vehicle that can be cut off and joined again: a TCP connection, and a serial port."""

from __future__ import annotations

import contextlib
import os
import pty
import select
import socket
import threading
import time
import tty
from pathlib import Path


class Relay:
    """Carries bytes between who calls and the vehicle, until it hangs up.

    Args:
        vehicle: Port at which the vehicle listens.
    """

    def __init__(self, vehicle: int) -> None:
        self._vehicle = vehicle
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._listener.getsockname()[1])
        self._ends: tuple[socket.socket, socket.socket] | None = None
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._carry, daemon=True)
        self._thread.start()

    def hang_up(self) -> None:
        """Close both ends; the next call is taken."""
        ends, self._ends = self._ends, None
        for end in ends or ():
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
            end.close()

    def close(self) -> None:
        """End the relay."""
        self._over.set()
        self._thread.join()
        self.hang_up()
        self._listener.close()

    def _carry(self) -> None:
        while not self._over.is_set():
            ends = self._ends
            # A connection that has been hung up meanwhile has no descriptor: the next turn has the new ones.
            with contextlib.suppress(OSError, ValueError):
                for each in select.select(ends or [self._listener], [], [], 0.1)[0]:
                    if ends is None:
                        self._join(self._listener.accept()[0])
                    elif data := each.recv(65536):
                        ends[each is ends[0]].sendall(data)
                    else:
                        self.hang_up()

    def _join(self, caller: socket.socket) -> None:
        try:
            self._ends = caller, socket.create_connection(("127.0.0.1", self._vehicle), 5.0)
        except OSError:
            caller.close()


class Radio:
    """A serial port with a vehicle behind it: a pseudo-terminal whose other end speaks UDP.

    Args:
        name: Path of the port; a link to whatever number the system gives it.
        port: Where the vehicle is.
    """

    def __init__(self, name: Path, port: int) -> None:
        self.name = name
        self._air = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._air.connect(("127.0.0.1", port))
        self._over = threading.Event()
        self._ends: tuple[int, int] | None = None
        self.plug()
        self._thread = threading.Thread(target=self._relay)
        self._thread.start()

    def plug(self) -> None:
        """Plug it in: it gets the next number that is free."""
        controller, device = pty.openpty()
        tty.setraw(device)
        os.set_blocking(controller, False)
        self.name.unlink(missing_ok=True)
        self.name.symlink_to(os.ttyname(device))
        self._ends = controller, device

    def unplug(self) -> float:
        """Pull it out, and return when that was, monotonic s."""
        ends, self._ends = self._ends, None
        # Until then the relay has heard of it.
        time.sleep(0.15)
        self.name.unlink()
        unplugged = time.monotonic()
        for end in ends or ():
            os.close(end)
        return unplugged

    def close(self) -> None:
        """End the radio."""
        self._over.set()
        self._thread.join()
        self._air.close()

    def _relay(self) -> None:
        while not self._over.is_set():
            ends = self._ends
            for ready in select.select([self._air, *(ends or ())[:1]], [], [], 0.1)[0]:
                # What does not fit is lost, as in a radio; so is what is sent while nobody is there.
                with contextlib.suppress(OSError):
                    if ready is not self._air:
                        self._air.send(os.read(ready, 4096))
                    elif (data := self._air.recv(65536)) and ends:
                        os.write(ends[0], data)
