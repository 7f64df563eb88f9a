"""From what the user asked for to a running flight: settings, mission, run, processes, then screen or headless."""

from __future__ import annotations

import argparse
import contextlib
import datetime
import os
import signal
import sys
from collections.abc import Generator
from pathlib import Path
from typing import NoReturn

import msgspec

from groundstation import heap
from groundstation.bus import Bus
from groundstation.config import Settings, check_flown_by_rate, load_settings, usual_file
from groundstation.connecting import note
from groundstation.errors import InputError
from groundstation.login import login_name
from groundstation.processes import Supervisor, free_port, running
from groundstation.run import Run
from groundstation.run_folder import new_run_id, run_folder, sweep_dead_runs
from groundstation.terminal import has_screen, terminal_path
from groundstation.training.mission import Mission, find_mission, load_mission
from groundstation.training.par import par_in
from groundstation.training.reference import load_reference
from groundstation.tui.wish import Ending
from groundstation.vehicle.signing import read_key
from groundstation.vehicle.transport import parse_url
from sim.scenario import VehicleChoice

FREE_FLIGHT = "free"
_EMULATED = "emulated:"


def fly(asked: argparse.Namespace) -> int:
    """Fly as asked and return the exit code.

    Raises:
        InputError: Something asked for cannot be.
    """
    heap.arrange()
    while True:
        _check(asked)
        run = accompanied(plan(asked), asked)
        note(asked)
        with started(run, asked) as (bus, supervisor):
            ending = _flown(run, asked, bus, supervisor)
            if ending.wish is not None:
                sys.stderr.write(f"{run.recording.name}: being closed; then {ending.wish.mission} begins.\n")
        if ending.wish is None:
            return ending.code
        asked.mission, asked.pilot = ending.wish


def _flown(run: Run, asked: argparse.Namespace, bus: Bus, supervisor: Supervisor) -> Ending:
    """Fly a run whose processes run, in the way that was asked for."""
    if asked.headless:
        from groundstation.headless import fly_headless

        operator = asked.operator or "average"
        return Ending(
            fly_headless(run, bus, supervisor, as_json=asked.json, operator=operator, seed=asked.seed)
        )
    if asked.plain:
        from groundstation.tui.plain import fly_plainly

        return Ending(fly_plainly(run, bus, supervisor))
    from groundstation.tui.running import fly_on_screen

    return fly_on_screen(run, bus, supervisor)


@contextlib.contextmanager
def started(run: Run, asked: argparse.Namespace) -> Generator[tuple[Bus, Supervisor]]:
    """Run a run's processes: yield the bus and the supervisor, and leave nothing behind however the block ends."""
    sweep_dead_runs()
    # Ended from outside, or the terminal closed: leave by the same way as always, children first.
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _leave)
    with running(run, "headless" if asked.headless else "screen", _sim_options(asked)) as both:
        yield both


def _leave(number: int, _frame: object) -> NoReturn:
    raise SystemExit(128 + number)


def plan(asked: argparse.Namespace) -> Run:
    """Turn what was asked for into a run.

    Raises:
        InputError: A file, a URL or a value is wrong.
    """
    settings = load_settings(asked.config)
    if asked.headless:
        check_flown_by_rate(settings)
    path = _mission_path(asked)
    mission = _with_vehicle(load_mission(path), asked) if path else None
    if mission:
        _check_vehicle(mission.vehicle, simulated=asked.sim)
    _check_controller(asked.controller, settings)
    url = asked.connect or f"udpin://127.0.0.1:{free_port()}"
    parse_url(url)
    if asked.signing_key:
        read_key(asked.signing_key)
    now = datetime.datetime.now().astimezone()
    run_id = new_run_id()
    device = _device(asked, run_id)
    par, par_from = par_in(load_reference(mission, path) if mission and path else None, asked.seed)
    if asked.device:
        _check_device(device, settings)
    return Run(
        run_id=run_id,
        url=url,
        simulated=asked.sim,
        device=device,
        mission=mission,
        mission_path=str(path.resolve()) if path else "",
        settings=settings,
        log=str(log_stem(asked.logs, now, mission.name if mission else "flight")),
        viewer_url=_viewer(asked),
        controller=asked.controller,
        pilot=_pilot(asked),
        seed=asked.seed,
        terminal="" if asked.headless or asked.plain else terminal_path(),
        started=now.isoformat(timespec="milliseconds"),
        config=str((asked.config or usual_file() or Path()).resolve())
        if asked.config or usual_file()
        else "",
        signing_key=str(asked.signing_key.resolve()) if asked.signing_key else "",
        par=par,
        par_from=par_from,
    )


def accompanied(run: Run, asked: argparse.Namespace) -> Run:
    """Return a run with the ghost that is followed, and with guidance and advice as the pilot's skill needs them.

    By itself it guides only a hand that trains on the simulated vehicle, and a scripted hand needs neither.
    """
    if run.mission is None:
        return run
    from groundstation.progress.company import flown_by, ghost_of, guidance_of, skill_of
    from groundstation.training.curriculum import lessons

    flights, best = flown_by(run.pilot, run.mission, asked.logs, _complain)
    curriculum = [each.mission for each in lessons()]
    wanted = run.settings.training.guidance if asked.guidance is None else asked.guidance
    if wanted == "auto":
        trains = run.simulated and not asked.headless
        wanted = guidance_of(run.mission, flights, curriculum) if trains else 0.0
    asked_ghost = "off" if asked.headless and not asked.ghost else asked.ghost
    ghost = ghost_of(asked_ghost, run.mission, Path(run.mission_path), best)
    skill = skill_of(run.mission, flights, curriculum)
    return msgspec.structs.replace(run, ghost=ghost, guidance=wanted, skill=skill)


def _complain(words: str) -> None:
    sys.stderr.write(f"groundstation: {words}\n")


def _check(asked: argparse.Namespace) -> None:
    """Refuse combinations that mean nothing, before anything starts."""
    if (folder := os.environ.get("TMPDIR")) and not Path(folder).is_dir():
        # MAVSDK would end the link by it.
        raise InputError(f"TMPDIR: {folder}: there is no such folder; make it, or unset TMPDIR.")
    if asked.headless and not asked.mission:
        raise InputError("--headless needs a --mission to fly; see 'groundstation missions list'.")
    if asked.headless and asked.device and not asked.device.startswith(_EMULATED):
        raise InputError(
            "--headless flies with the scripted hand; leave --device out, or give it a double: emulated:falcon."
        )
    if asked.operator and not asked.headless:
        raise InputError("--operator says who flies a --headless flight; add --headless.")
    if asked.json and not asked.headless:
        raise InputError("--json is the summary of a --headless flight; add --headless.")
    if asked.headless and asked.connect and not asked.confirm_real:
        raise InputError(
            "--headless --connect flies a real vehicle by itself; add --confirm-real if you mean it."
        )
    check_simulated(asked)
    if asked.headless and asked.plain:
        raise InputError("--plain is flown by hand and --headless by the scripted hand; choose one.")
    without_screen = asked.headless or asked.plain
    if not without_screen and not has_screen(os.environ):
        raise InputError(
            "the screen needs a terminal; without one use --plain, or --headless --mission NAME."
        )


def check_simulated(asked: argparse.Namespace) -> None:
    """Refuse options of the simulated vehicle that mean nothing, or that it would refuse."""
    if asked.connect and (asked.airframe or asked.model or asked.channel):
        raise InputError(
            "--airframe, --model and --channel are the simulator's; a real vehicle brings its own."
        )
    if asked.channel:
        _check_channel(asked.channel)


def _mission_path(asked: argparse.Namespace) -> Path | None:
    if asked.mission:
        return find_mission(asked.mission)
    return find_mission(FREE_FLIGHT) if asked.sim else None


def _with_vehicle(mission: Mission, asked: argparse.Namespace) -> Mission:
    """Let the flags choose the simulated vehicle over the mission."""
    choice = mission.vehicle
    choice = msgspec.structs.replace(
        choice, airframe=asked.airframe or choice.airframe, model=asked.model or choice.model
    )
    return msgspec.structs.replace(mission, vehicle=choice)


def _check_vehicle(vehicle: VehicleChoice, *, simulated: bool) -> None:
    """Refuse an airframe before anything is started: the simulator flies it, and it says what a contact is."""
    from sim.airframe import MODELS, load_airframe
    from sim.scenario import ScenarioError

    try:
        airframe = load_airframe(vehicle.airframe)
        if simulated:
            MODELS[vehicle.model](airframe)
    except ScenarioError as error:
        raise InputError(str(error)) from error


def _check_channel(text: str) -> None:
    """Refuse a channel that the simulator would."""
    from sim.conditions import ConditionsError, parse_conditions

    try:
        parse_conditions(text)
    except ConditionsError as error:
        raise InputError(f"--channel: {error}") from error


def _check_device(uri: str, settings: Settings) -> None:
    """Refuse a device or settings that no driver knows. One that is only not plugged in yet is waited for."""
    from drivers.device import DeviceError
    from groundstation.devices.making import flight_device

    try:
        flight_device(uri, settings)
    except DeviceError as error:
        raise InputError(f"--device: {error}") from error


def _check_controller(spec: str, settings: Settings) -> None:
    """Refuse a controller or an airframe to compensate that cannot be had."""
    from groundstation.pilot.guest import load_controller
    from sim.airframe import load_airframe
    from sim.scenario import ScenarioError

    load_controller(spec, settings)
    try:
        if settings.control.airframe:
            load_airframe(settings.control.airframe)
    except ScenarioError as error:
        raise InputError(f"control.airframe: {error}") from error


def _sim_options(asked: argparse.Namespace) -> tuple[str, ...]:
    options = ["--seed", str(asked.seed)]
    if asked.airframe:
        options += ["--airframe", asked.airframe]
    if asked.model:
        options += ["--model", asked.model]
    if asked.channel:
        options += ["--channel", asked.channel]
    if asked.signing_key:
        options += ["--signing-key", str(asked.signing_key)]
    return tuple(options)


def _device(asked: argparse.Namespace, run_id: str) -> str:
    """Return the device asked for; one that this program itself moves is told so in the run's folder."""
    ours = run_folder(run_id) / "hand.sock"
    if not asked.device:
        return f"{'scripted' if asked.headless else 'virtual'}:{ours}"
    if asked.device.startswith(_EMULATED) and "@" not in asked.device:
        return f"{asked.device}@{ours}"
    return asked.device


def _pilot(asked: argparse.Namespace) -> str:
    """Return who flies: as named, else who is logged in; the scripted hand is nobody unless it is given a name."""
    if asked.pilot is not None:
        return asked.pilot.strip()
    return "" if asked.headless else login_name()


def log_stem(folder: Path, now: datetime.datetime, name: str) -> Path:
    """Return the path of a recording without suffix, which no file has yet.

    Raises:
        InputError: The folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be made a folder for logs ({error.strerror}).") from error
    if not os.access(folder, os.W_OK):
        raise InputError(f"{folder}: is not writable; recordings go there, choose another with --logs.")
    name = name.replace(" ", "-")
    stem = folder.resolve() / f"{now:%Y-%m-%d_%H-%M-%S}_{name}"
    number = 2
    while any(stem.parent.glob(f"{stem.name}.*")):
        stem = stem.with_name(f"{now:%Y-%m-%d_%H-%M-%S}_{name}_{number}")
        number += 1
    return stem


def _viewer(asked: argparse.Namespace) -> str:
    if not asked.rerun and asked.viewer is None:
        return ""
    from groundstation.recording.live import find_viewer, start_viewer

    return start_viewer() if asked.viewer is None else find_viewer(asked.viewer)
