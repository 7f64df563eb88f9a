"""What a flight was: mission, vehicle, device, settings, versions; a page and properties."""

from __future__ import annotations

import functools
import platform
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import rerun as rr

import groundstation
from groundstation.messages import DeviceReport
from groundstation.recording import entities, schema
from groundstation.recording.batch import text
from groundstation.recording.item import Still, nanoseconds
from groundstation.run import Run

_SOURCE = Path(groundstation.__file__).resolve().parents[1]
_PROPERTIES = "/__properties"


def about_flight(run: Run, start: float) -> Iterator[Still]:
    """Yield what is known when the run starts, at `start` on the monotonic clock, s."""
    mission = run.mission
    facts: dict[str, Any] = {
        "schema": schema.VERSION,
        "started": run.started,
        "start_ns": int(nanoseconds(np.array([start]))[0]),
        "mission": mission.name if mission else "",
        "vehicle": run.url,
        "simulated": run.simulated,
        "device": run.device,
        "controller": run.controller,
        "pilot": run.pilot,
        "seed": run.seed,
        "guidance": run.guidance,
        "groundstation": groundstation.__version__,
        "revision": revision(),
        "rerun": rr.__version__,
        "machine": platform.platform(),
        "settings_json": msgspec.json.encode(run.settings).decode(),
        "mission_json": msgspec.json.encode(mission).decode(),
        "par_json": msgspec.json.encode(run.par).decode(),
        "par_from": run.par_from,
    }
    yield Still(f"{_PROPERTIES}/{schema.FLIGHT}", rr.AnyValues(drop_untyped_nones=True, **facts))
    yield _page(run, None)


def about_device(run: Run, report: DeviceReport) -> Iterator[Still]:
    """Yield what is known once the device has reported."""
    facts: dict[str, Any] = {
        "name": text(report.name),
        "serial": text(report.serial),
        "renders": text(report.renders),
        "workspace_m": report.workspace,
        "force_limit_n": report.force_limit,
    }
    yield Still(f"{_PROPERTIES}/{schema.DEVICE}", rr.AnyValues(drop_untyped_nones=True, **facts))
    yield _page(run, report)


@functools.cache
def revision() -> str:
    """Return the git revision of a checkout this runs from, or "" where it was installed."""
    if not (_SOURCE / ".git").exists():
        return ""
    command = ("git", "-C", str(_SOURCE), "describe", "--always", "--dirty", "--tags")
    try:
        answer = subprocess.run(command, capture_output=True, text=True, timeout=5, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return answer.stdout.strip() if answer.returncode == 0 else ""


def _page(run: Run, device: DeviceReport | None) -> Still:
    mission = run.mission
    facts = {
        "Started": run.started,
        "Vehicle": f"simulated, {run.url}" if run.simulated else run.url,
        "Pilot": run.pilot or "not named",
        "Device": _device_words(run, device),
        "Program": f"groundstation {groundstation.__version__} {revision()}".strip(),
    }
    if mission and run.simulated:
        facts["Model"] = f"{mission.vehicle.airframe}, {mission.vehicle.model}"
        wind = mission.wind
        facts["Wind"] = (
            f"{_words(wind.mean)} m/s, {len(wind.gust)} gusts, turbulence {wind.turbulence.intensity:g} m/s"
        )
    lines = [f"# {mission.title if mission else 'Free flight'}", "", mission.teaches if mission else ""]
    lines += _table("", facts)
    for name, settings in msgspec.to_builtins(run.settings).items():
        lines += ["", f"## {name.capitalize()}", *_table("setting", settings)]
    page = rr.TextDocument("\n".join(lines), media_type=rr.MediaType.MARKDOWN)
    return Still(entities.ABOUT, page)


def _table(title: str, facts: Mapping[str, object]) -> list[str]:
    return [
        "",
        f"| {title} | |",
        "|---|---|",
        *(f"| {key} | {_words(value)} |" for key, value in facts.items()),
    ]


def _words(value: object) -> str:
    if isinstance(value, Sequence) and not isinstance(value, str):
        return ", ".join(f"{part:g}" for part in value)
    return str(value)


def _device_words(run: Run, device: DeviceReport | None) -> str:
    if device is None:
        return run.device
    name, serial = text(device.name), text(device.serial)
    words = f"{name} {serial}".strip()
    return f"{words}, workspace {device.workspace:g} m, up to {device.force_limit:g} N"
