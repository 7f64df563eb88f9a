"""Make the pictures of the screen from a canned flight, and of the school: `python docs/pictures/screen.py [FOLDER]`.

Writes them as SVG, and as PNG where rsvg-convert is installed.
"""

from __future__ import annotations

import asyncio
import datetime
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import cast

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from canned_flight import (  # noqa: E402
    START,
    CannedFlight,
    CannedFollower,
    CannedReader,
    CannedStick,
    CannedSupervisor,
    canned_run,
)
from terminal_svg import crisp  # noqa: E402

from groundstation.console import Snapshot  # noqa: E402
from groundstation.progress.desk import Desk  # noqa: E402
from groundstation.progress.flown import Flown  # noqa: E402
from groundstation.progress.opening import store_in  # noqa: E402
from groundstation.progress.store import Store  # noqa: E402
from groundstation.training.follower import MissionFollower  # noqa: E402
from groundstation.tui.app import FlightApp  # noqa: E402
from groundstation.tui.school import School  # noqa: E402

SIZES = ((80, 24), (120, 40), (200, 60))
SCHOOL_SIZE = (140, 40)
FLOWN_S = 15.0
# What Ann has flown today: mission, points, passed.
ANN = (
    ("spring", 61.0, True), ("spring", 88.0, True), ("hover", 58.0, False), ("hover", 84.0, True),
    ("axes", 81.0, True), ("yaw", 66.0, True), ("box", 90.0, True), ("landing", 41.0, False),
    ("landing", 77.0, True), ("waypoints", 72.0, True),
)  # fmt: skip
FRAME_S = 0.1


async def picture(folder: Path, width: int, height: int) -> Path:
    """Fly to the moment of the picture and save it."""
    run = canned_run()
    flight = CannedFlight(run)
    reader = CannedReader(flight.snapshot())
    follower = cast(MissionFollower, CannedFollower(run))
    app = FlightApp(run, reader, CannedSupervisor(), CannedStick(), follower=follower, clock=lambda: START)
    async with app.run_test(size=(width, height)) as pilot:
        while flight.elapsed < FLOWN_S:
            flight.advance(FRAME_S)
            reader.shown = flight.snapshot()
            if flight.engaged:
                # The hand on the stick that gives the handle's position.
                for axis, share in enumerate(stick_shares(reader.shown)):
                    app.hand.place(axis, share)
            app.pull()
        for _ in range(6):
            app.pull()
        await pilot.pause()
        name = f"screen-{width}x{height}.svg"
        (folder / name).write_text(crisp(app.export_screenshot()), encoding="utf-8")
    return folder / name


async def school(folder: Path) -> Path:
    """Save the picture of a school in which somebody has flown some missions."""
    with tempfile.TemporaryDirectory() as logs:
        with Store(store_in(Path(logs))) as store:
            for hour, (mission, points, passed) in enumerate(ANN):
                started = f"{datetime.datetime.now(datetime.UTC).date()}T{hour:02d}:00:00+00:00"
                store.add(Flown("Ann", mission, "", started, passed=passed, points=points, duration_s=80.0))
        app = School(Desk(Path(logs)), "Ann")
        async with app.run_test(size=SCHOOL_SIZE) as pilot:
            await pilot.pause()
            name = "school-140x40.svg"
            (folder / name).write_text(crisp(app.export_screenshot()), encoding="utf-8")
    return folder / name


def stick_shares(snapshot: Snapshot) -> list[float]:
    """Return where the stick is for a handle to be where it is."""
    assert snapshot.handle is not None
    assert snapshot.device is not None
    return [value / snapshot.device.workspace for value in snapshot.handle.position] + [snapshot.handle.yaw]


def main() -> None:
    """Make all pictures."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "images"
    folder.mkdir(parents=True, exist_ok=True)
    converter = shutil.which("rsvg-convert")
    shown = [picture(folder, width, height) for width, height in SIZES]
    for making in (*shown, school(folder)):
        svg = asyncio.run(making)
        print(svg)
        if converter:
            subprocess.run(
                [converter, "--width", "1600", "--output", str(svg.with_suffix(".png")), str(svg)], check=True
            )


if __name__ == "__main__":
    main()
