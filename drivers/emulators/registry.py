"""The emulators by name, and how one is run."""

from __future__ import annotations

import select
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Protocol, cast

from drivers.device import DeviceError
from drivers.emulators.hand import EmulatedHand, Motion, rest

BUILT_IN = {
    "falcon": ("drivers.emulators.falcon", "FalconEmulator"),
    "inverse3": ("drivers.emulators.inverse3", "Inverse3Emulator"),
    "two-diy": ("drivers.emulators.two_diy", "TwoDiyEmulator"),
}
"""Classes with a `WORKSPACE`, m, called with (hand, clock)."""

PATIENCE_S = 0.01
"""How long a served emulator sleeps at most, so that its hand moves on while its device is not asked."""


class Emulator(Protocol):
    """A double of a device: what its driver says to it and hears from it is, byte by byte, the real one's."""

    @property
    def uri(self) -> str:
        """What to give to `--device`, as `falcon:/dev/pts/7`."""
        ...

    def descriptors(self) -> Sequence[int]:
        """Return the file descriptors that become readable when there is something to do."""
        ...

    def turn(self) -> None:
        """Take what came, move the hand, answer. Never waits."""
        ...

    def close(self) -> None:
        """Unplug it and let its hand go. May be called twice."""
        ...


def emulator_names() -> list[str]:
    """Return the names of the devices there is an emulator of, sorted."""
    return sorted(BUILT_IN)


def make_emulator(
    name: str, clock: Callable[[], float], address: str | None = None, motion: Motion = rest
) -> Emulator:
    """Return a running emulator.

    Args:
        name: Of `emulator_names`.
        clock: Monotonic seconds.
        address: Socket of its hand; see `EmulatedHand`.
        motion: What its hand does where there is no address.

    Raises:
        DeviceError: There is no such emulator, or the socket cannot be bound.
    """
    if name not in BUILT_IN:
        known = ", ".join(emulator_names())
        raise DeviceError(f"{name!r}: there is no such emulator; use one of: {known}.")
    module, attribute = BUILT_IN[name]
    emulator = getattr(import_module(module), attribute)
    hand = EmulatedHand(cast("float", emulator.WORKSPACE), clock, address, motion)
    return emulator(hand, clock)


def serve(emulator: Emulator, lasting: Callable[[], bool]) -> None:
    """Turn the emulator whenever there is something to do, for as long as `lasting` says so."""
    while lasting():
        select.select(emulator.descriptors(), [], [], PATIENCE_S)
        emulator.turn()
