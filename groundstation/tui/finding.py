"""Whether the haptic device was ever there: what has not been found yet is looked for, what was there is gone."""

from __future__ import annotations

from groundstation.console import Snapshot


class DeviceWatch:
    """Remembers that the device was there."""

    def __init__(self) -> None:
        self._found = False

    def look(self, snapshot: Snapshot) -> bool:
        """Say whether the device has been there by now."""
        self._found = self._found or bool(snapshot.device is not None and snapshot.device.present)
        return self._found
