"""The keeper with the real on-screen stick, whose sender comes and goes, in virtual time."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from drivers.device import ZERO3, DeviceError, Vector3
from drivers.stick import StickSender
from drivers.virtual import VirtualHandle
from groundstation.devices.keeper import ABSENT, RETRY_S, DeviceKeeper
from groundstation.messages import Severity


class Bench:
    def __init__(self, path: Path) -> None:
        self.now = 50.0
        self.path = str(path)
        self.said: list[tuple[Severity, str]] = []
        self.device = VirtualHandle(self.path, lambda: self.now)
        self.keeper = DeviceKeeper(
            self.device, lambda *said: self.said.append(said), lambda: self.now, lambda work: work()
        )
        self.sender = StickSender(self.path)

    def close(self) -> None:
        self.keeper.close()
        self.sender.close()

    def run(self, seconds: float, *, sending: bool) -> list[bool]:
        seen = []
        for _ in range(round(seconds / 0.01)):
            self.now += 0.01
            if sending:
                self.sender.send((0.01, 0.0, 0.0), 0.0, 0, self.now)
            seen.append(self.keeper.read(self.now) is not None)
        return seen


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    bench = Bench(tmp_path / "hand.sock")
    yield bench
    bench.close()


def test_a_device_that_is_silent_at_the_start_is_waited_for(bench: Bench) -> None:
    assert bench.keeper.info is ABSENT
    assert not any(bench.run(3.0, sending=False))
    assert bench.keeper.info.name == "On-screen stick"
    assert [severity for severity, _ in bench.said] == [Severity.WARNING]
    assert "no stick yet" in bench.said[0][1]
    seen = bench.run(2 * RETRY_S + 0.1, sending=True)
    assert seen[-1]
    assert bench.said[1] == (Severity.INFO, "On-screen stick is there.")


def test_a_device_that_needs_a_moment_after_opening_is_not_complained_of(bench: Bench) -> None:
    bench.run(0.3, sending=False)
    bench.run(0.1, sending=True)
    assert bench.said == [(Severity.INFO, "On-screen stick is there.")]


def test_a_device_that_falls_silent_is_told_once_and_comes_back(bench: Bench) -> None:
    bench.run(1.5, sending=True)
    assert bench.keeper.present
    bench.said.clear()
    bench.run(3.0, sending=False)
    assert not bench.keeper.present
    assert [severity for severity, _ in bench.said if severity is Severity.ALARM] == []
    assert len({words for _, words in bench.said}) == len(bench.said) <= 2
    assert bench.run(2 * RETRY_S + 0.1, sending=True)[-1]


def test_force_goes_to_the_device_only_while_it_is_there(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.keeper.write((1.0, 0.0, 0.0))
    bench.run(1.5, sending=True)
    bench.keeper.write((1.0, 2.0, 0.0))
    assert bench.device.force == (1.0, 2.0, 0.0)
    told: list[Vector3] = []
    monkeypatch.setattr(bench.device, "write_force", told.append)
    bench.keeper.close()
    assert told == [ZERO3]
    assert bench.device.force == ZERO3
    assert not Path(bench.path).exists()


def test_a_device_that_refuses_a_force_is_lost_not_fatal(bench: Bench) -> None:
    bench.run(1.5, sending=True)
    bench.keeper.write((float("nan"), 0.0, 0.0))
    assert not bench.keeper.present
    assert "not a number" in bench.said[-1][1]
    assert bench.run(2 * RETRY_S + 0.1, sending=True)[-1]


def test_a_device_that_cannot_be_opened_is_tried_again(tmp_path: Path) -> None:
    folder = tmp_path / "later"
    bench = Bench(folder / "hand.sock")
    assert not any(bench.run(1.2, sending=False))
    assert len(bench.said) == 1
    assert "cannot be bound" in bench.said[0][1]
    assert bench.keeper.info is ABSENT
    folder.mkdir()
    came = bench.run(3 * RETRY_S, sending=True)[-1]
    bench.close()
    assert came


def test_a_device_that_is_slow_to_open_holds_up_nothing(tmp_path: Path) -> None:
    """Firmware takes seconds to load: until it is there, reading says at once that there is no device."""
    bench = Bench(tmp_path / "hand.sock")
    aside = []
    slow = DeviceKeeper(bench.device, lambda *_: None, lambda: bench.now, aside.append)
    bench.sender.send((0.0, 0.0, 0.0), 0.0, 0, bench.now)
    assert [slow.read(bench.now + 0.01 * tick) for tick in range(200)] == [None] * 200
    assert len(aside) == 1
    aside[0]()
    slow.read(bench.now)
    assert slow.info.name == "On-screen stick"
    bench.sender.send((0.0, 0.0, 0.0), 0.0, 0, bench.now)
    assert slow.read(bench.now) is not None
    slow.close()
    bench.close()


def test_a_driver_that_breaks_while_opening_is_told_of(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    bench = Bench(tmp_path / "hand.sock")

    def broken() -> None:
        raise RuntimeError("not a DeviceError")

    monkeypatch.setattr(bench.device, "open", broken)
    with pytest.raises(RuntimeError):
        bench.keeper.read(bench.now)
    assert bench.keeper.read(bench.now + 0.1) is None
    assert "driver failed" in bench.said[-1][1]
    bench.close()


def test_a_device_that_reads_but_takes_no_force_does_not_flood_the_events(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_force: Vector3) -> None:
        raise DeviceError("On-screen stick: takes no force; unplug it.")

    monkeypatch.setattr(bench.device, "write_force", refuse)
    for _ in range(300):
        bench.run(0.01, sending=True)
        bench.keeper.write((1.0, 0.0, 0.0))
    assert not bench.keeper.present
    assert 4 <= len(bench.said) <= 2 * (3.0 / RETRY_S + 1)
