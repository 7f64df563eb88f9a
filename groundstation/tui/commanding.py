"""What the operator commands: acts, choices and settings, asked back about where that is due, each with its answer.

The half of the application that the bus hears of; what is shown is in `groundstation.tui.app`.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import cast

import msgspec
from textual.app import App
from textual.screen import ModalScreen

from groundstation.config import Settings, user_file
from groundstation.console import Snapshot
from groundstation.errors import InputError
from groundstation.messages import CommandKind, Preset
from groundstation.run import Run, write_run
from groundstation.tui.acts import BY_NAME, Act, Ask
from groundstation.tui.choices import CHOICES_BY_NAME, Choice, Wishes
from groundstation.tui.frame import Reader
from groundstation.tui.notes import Answers
from groundstation.tui.screens.dialog import Confirm, Typed
from groundstation.tui.setting_list import Entry, changed, save

# A kill that is not confirmed within this was not meant.
_KILL_S = 3.0


class Commanding(App[int]):
    """An application by which the operator commands.

    Args:
        run: The run.
        console: The operator's side of the bus.
    """

    def __init__(self, run: Run, console: Reader) -> None:
        super().__init__()
        self._flight_run, self._reader = run, console
        self._answers, self._wishes = Answers(), Wishes()
        self._snapshot = console.snapshot()
        self._confirmed_real = run.simulated

    @property
    def snapshot(self) -> Snapshot:
        """The newest of everything."""
        return self._snapshot

    @property
    def simulated(self) -> bool:
        """The vehicle is ours."""
        return self._flight_run.simulated

    @property
    def settings(self) -> Settings:
        """As they are set now; what is not live takes effect at the next start."""
        return self._flight_run.settings

    @property
    def settings_file(self) -> Path:
        """Where settings are saved."""
        return Path(self._flight_run.config) if self._flight_run.config else user_file()

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Grey what cannot be done now."""
        table = {"act": BY_NAME, "choose": CHOICES_BY_NAME}.get(action)
        if table is not None and parameters:
            asked = table.get(str(parameters[0]))
            return True if asked is None or not asked.hindrance(self._snapshot) else None
        return super().check_action(action, parameters)

    def action_act(self, name: str) -> None:
        """Do one of the operator's acts, asking back where that is due."""
        act = BY_NAME[name]
        if act.kind is CommandKind.ENGAGE and not self._confirmed_real:
            self._confirm_real(act)
        elif act.ask is Ask.NEVER or (act.ask is Ask.REAL and self._flight_run.simulated):
            self._command(act)
        elif not self._hindered(act):
            which = "the simulated" if self._flight_run.simulated else "the REAL"
            killing = act.kind is CommandKind.KILL
            # Held down, a key repeats itself: what lets it fall takes another one.
            self.ask(
                f"{act.label} {which} vehicle?",
                act.explains,
                lambda: self._command(act),
                key="" if killing else act.key,
                within=_KILL_S if killing else 0.0,
            )

    def _confirm_real(self, act: Act) -> None:
        """Before a hand is first coupled to a real vehicle, have it typed that it is meant."""
        if self._hindered(act):
            return
        status = self._snapshot.status
        number = str(status.system_id) if status is not None else ""

        def typed(text: str | None) -> None:
            if text is not None:
                self._confirmed_real = True
                self._command(act)

        self.push_screen(
            Typed(
                "Engage the REAL vehicle?",
                f"The first time, type REAL or its system id, {number}. Propellers turn, people may be near.",
                lambda text: "" if text and text in {"REAL", number} else f"type REAL or {number}",
            ),
            typed,
        )

    def action_urgent(self, name: str) -> None:
        """Do what cannot wait, from wherever the operator is."""
        while isinstance(self.screen, ModalScreen):
            if name == "kill" and isinstance(self.screen, Confirm) and self.screen.asks_for(name):
                return
            cast("ModalScreen[object]", self.screen).dismiss(None)
        self.action_act(name)

    def set_setting(self, entry: Entry, text: str) -> None:
        """Change a setting, save it, and have the pilot take it where it can."""
        try:
            settings = changed(self.settings, entry.section, entry.key, text)
            save(self.settings_file, entry.section, entry.key, text)
        except InputError as error:
            self.notify(str(error), severity="error", timeout=8.0, markup=False)
            return
        self._flight_run = msgspec.structs.replace(self._flight_run, settings=settings)
        name = f"{entry.section}.{entry.key} = {text}"
        if entry.live:
            write_run(self._flight_run)
            self.send(CommandKind.SETTINGS)
            self.notify(f"{name}: saved, and sent to the pilot.", timeout=4.0, markup=False)
        else:
            self.notify(f"{name}: saved; takes effect at the next start.", timeout=6.0, markup=False)

    def action_choose(self, name: str) -> None:
        """Make one of the operator's choices: go on from what is in effect."""
        choice, pilot = CHOICES_BY_NAME[name], self._snapshot.pilot
        if not self._hindered(choice) and pilot is not None:
            self.send(choice.kind, choice.after(self._wishes.present(choice.kind, pilot)))

    def _choose_preset(self, preset: Preset) -> None:
        if not self._hindered(CHOICES_BY_NAME["preset"]):
            self.send(CommandKind.PRESET, preset)

    def _hindered(self, asked: Act | Choice) -> bool:
        """Say why an act or a choice is not possible, if so."""
        hindrance = asked.hindrance(self._snapshot)
        if hindrance:
            self.notify(f"{asked.label}: {hindrance}.", timeout=3.0, markup=False)
        return bool(hindrance)

    def _command(self, act: Act) -> None:
        """Send a command, unless it has become impossible while it was asked about."""
        if not self._hindered(act):
            self.send(act.kind)

    def send(self, kind: CommandKind, value: int = 0, name: str = "", amount: float = 0.0) -> None:
        """Send a command and watch for its answer."""
        now = self._snapshot.t
        self._wishes.sent(kind, value, now)
        self._answers.sent(self._reader.command(kind, value, name, amount), kind, now)

    def ask(
        self, question: str, consequence: str, then: Callable[[], None], *, key: str = "", within: float = 0.0
    ) -> None:
        """Ask back, and do it where the answer is yes; see `Confirm`."""

        def answered(yes: bool | None) -> None:
            if yes:
                then()

        self.push_screen(Confirm(question, consequence, key, within), answered)
