"""What came over the bus in a recorded flight, as the very records that its servo knew."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from drivers.device import DeviceInfo
from groundstation.messages import Command, Ranges, Record, VehicleState, VehicleStatus
from groundstation.recording import entities, schema
from groundstation.recording.changes import SAFE
from groundstation.review.flight import Flight

_TEXT_S = 0.001


class Known(NamedTuple):
    """Records of a flight by their time, as `schema.KNOWN` names those that a tick knew.

    Attributes:
        states, statuses, ranges: Of the vehicle.
        commands: In the order they came.
    """

    states: Mapping[float, Record]
    statuses: Mapping[float, Record]
    ranges: Mapping[float, Record]
    commands: list[Command]


def known_in(flight: Flight) -> Known:
    """Return what came over the bus in a recorded flight.

    Raises:
        InputError: It was recorded before schema 4.
    """
    return Known(
        {state.t: state for state in _states(flight)},
        {status.t: status for status in _statuses(flight)},
        {ranges.t: ranges for ranges in _ranges(flight)},
        list(_commands(flight)),
    )


def device_at(flight: Flight, t: float) -> DeviceInfo | None:
    """Return what the device was that the servo had at a time, monotonic s; None where it is not recorded."""
    axes, workspace, force, stiffness, rate = flight.held(schema.LIMITS, np.array([t]))[0].tolist()
    if np.isnan(axes):
        return None
    facts = flight.properties(schema.DEVICE)
    return DeviceInfo(
        str(facts.get("name", "")),
        str(facts.get("serial", "")),
        int(axes),
        workspace,
        force,
        stiffness,
        rate,
        facts.get("renders", "nothing"),
    )


def _states(flight: Flight) -> Iterator[VehicleState]:
    t, boots = flight.clock(schema.POSITION), flight.series(schema.BOOT_TIME).values[:, 0]
    told = np.column_stack([flight.series(each).values for each in (schema.POSITION, schema.VELOCITY)])
    when = flight.clock(schema.UNTRUSTED).tolist()
    untrusted = dict(zip(when, flight.series(schema.UNTRUSTED).values.tolist(), strict=True))
    for when, boot, trusted in zip(t.tolist(), boots.tolist(), told.tolist(), strict=True):
        numbers = untrusted.get(when, trusted)
        state = VehicleState(t=when, boot_t=boot, valid=when not in untrusted)
        state.position[:], state.velocity[:] = numbers[:4], numbers[4:]
        yield state


def _statuses(flight: Flight) -> Iterator[VehicleStatus]:
    t = flight.clock(schema.LOSS)
    numbers = np.column_stack(
        (
            t,
            flight.series(schema.LOSS).values,
            flight.series(schema.ROUND_TRIP).values,
            flight.held(schema.STATUS, t),
            # A recording from before them has none: not known.
            np.nan_to_num(flight.held(schema.SPEED_LIMITS, t)),
        )
    )
    # Lines of text have whole milliseconds; statuses are tens of them apart.
    told = [(line.t - _TEXT_S, line.text) for line in flight.texts(entities.UNSAFE)]
    for when, loss, rtt, *codes in numbers.tolist():
        connected, armed, in_air, mode, stream = map(int, codes[:5])
        unsafe = next((words for since, words in reversed(told) if since <= when - flight.start), "")
        yield VehicleStatus(
            t=when,
            speed_limits=tuple(codes[5:]),
            unsafe=b"" if unsafe == SAFE else unsafe.encode(),
            loss=loss,
            rtt=rtt,
            connected=connected,
            armed=armed,
            in_air=in_air,
            mode=mode,
            streaming=stream,
        )


def _ranges(flight: Flight) -> Iterator[Ranges]:
    t, rings = flight.clock(schema.RING), flight.series(schema.RING).values
    upright = flight.series(schema.RANGES).values[:, 1:]
    for when, ring, (below, above) in zip(t.tolist(), rings.tolist(), upright.tolist(), strict=True):
        yield Ranges(t=when, ring=tuple(ring), below=below, above=above)


def _commands(flight: Flight) -> Iterator[Command]:
    t, rows = flight.clock(schema.COMMANDED), flight.series(schema.COMMANDED).values
    for when, (number, kind, value) in zip(t.tolist(), rows.astype(np.int64).tolist(), strict=True):
        yield Command(t=when, number=number, kind=kind, value=value)
