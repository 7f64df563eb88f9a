"""A device's double with the device's own driver: `emulated:falcon@SOCKET` starts the emulator and opens it.

All that the driver says and hears are the real device's bytes. The hand on the double is told what it wants by
datagrams (`drivers.stick`) at SOCKET, and yields to the force.
"""

from __future__ import annotations

import contextlib
import select
import subprocess
import sys

from drivers.device import DeviceError, DeviceInfo, HandleState, HapticDevice, Vector3
from drivers.emulators.registry import emulator_names
from drivers.registry import make_device

# Starting an emulator takes a few tenths of a second.
_PATIENCE_S = 5.0


class Emulated:
    """A driver and the emulator it talks to.

    Args:
        address: `NAME@SOCKET`.

    Raises:
        DeviceError: There is no emulator of this name, or no socket is given.
    """

    def __init__(self, address: str) -> None:
        self._name, _, self._socket = address.partition("@")
        if self._name not in emulator_names():
            known = ", ".join(emulator_names())
            raise DeviceError(f"{self._name!r}: there is no such emulator; use one of: {known}.")
        if not self._socket:
            raise DeviceError(
                f"emulated:{self._name}: give the socket that moves its hand, emulated:{self._name}@SOCKET."
            )
        self._process: subprocess.Popen[str] | None = None
        self._device: HapticDevice | None = None

    @property
    def info(self) -> DeviceInfo:
        """What the device is."""
        return self._opened().info

    def open(self) -> None:
        """Start the emulator and open it as the real device.

        Raises:
            DeviceError: It does not start, or cannot be opened.
        """
        self.close()
        self._process = subprocess.Popen(
            [sys.executable, "-m", "drivers.emulators", self._name, self._socket],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._device = make_device(self._uri(self._process))
        self._device.open()

    def read(self) -> HandleState:
        """Return the handle's state."""
        return self._opened().read()

    def write_force(self, force: Vector3) -> None:
        """Press on the hand."""
        self._opened().write_force(force)

    def close(self) -> None:
        """Let the device go and end the emulator."""
        if self._device is not None:
            self._device.close()
            self._device = None
        if self._process is not None:
            process, self._process = self._process, None
            with contextlib.suppress(BrokenPipeError), process:
                # Closing its standard input ends it; leaving the block closes both pipes and waits for it.
                pass

    def _opened(self) -> HapticDevice:
        if self._device is None:
            raise DeviceError(f"The emulated {self._name} is not open.")
        return self._device

    def _uri(self, process: subprocess.Popen[str]) -> str:
        output = process.stdout
        said = ""
        if output is not None and select.select([output], [], [], _PATIENCE_S)[0]:
            said = output.readline().strip()
        if not said or said.startswith("!"):
            self.close()
            raise DeviceError(
                said.removeprefix("! ") or f"The emulator of {self._name} did not start; try again."
            )
        return said
