"""`groundstation instruct`: does what an instructor asked for in a flight that runs, and says what became of it."""

from __future__ import annotations

import argparse
import os
import sys
import time

from groundstation.errors import InputError
from groundstation.instruct.flights import chosen, running_flights, title
from groundstation.instruct.seat import Seat, seat
from groundstation.instruct.telling import line, status
from groundstation.instruct.wanted import WANTED
from groundstation.messages import EVENT_TEXT, CommandKind, InterventionAnswer
from groundstation.status_line import StatusLine
from groundstation.terminal import has_screen
from groundstation.training.answering import WELCOME_S
from groundstation.training.happening import Happening, words

# What is done to the vehicle waits for its word, however silent its link; longer than the link tries, s.
_PATIENCE_S = 130.0
_COMMAND_S = 10.0
# What was sent must be taken before its sender goes, s: everyone looks at least ten times a second.
_TAKEN_S = 0.5
_FIRST_S = 1.5
_WATCH_S = 0.1
# Without a terminal to change a line on, s.
_LINE_EVERY_S = 5.0
_COMMANDS = {"hold": CommandKind.HOLD, "land": CommandKind.LAND}
_GONE = "the flight has ended"


def run(asked: argparse.Namespace) -> int:
    """Do what was asked and return the exit code.

    Raises:
        InputError: There is no such flight, or nothing was asked for.
    """
    if asked.act is None and not has_screen(os.environ):
        raise InputError("say what shall happen, such as 'status' or 'gust 5 0'; see instruct --help.")
    flight = chosen(running_flights(), asked.run)
    with seat(flight) as taken:
        if asked.act is None:
            from groundstation.instruct.screen import show

            return show(taken)
        return _act(asked, taken)


def _act(asked: argparse.Namespace, taken: Seat) -> int:
    if asked.act == "status":
        return _status(taken)
    if asked.act == "watch":
        return _watch(taken)
    if asked.act == "say":
        return _say(taken, " ".join(asked.text))
    if asked.act in _COMMANDS:
        return _command(taken, _COMMANDS[asked.act])
    return _let_happen(taken, WANTED[asked.act](asked))


def _status(taken: Seat) -> int:
    taken.heard(_FIRST_S, lambda: taken.look().status)
    # Told again to who comes late is what was done.
    time.sleep(2 * WELCOME_S)
    view = taken.look()
    for name, told in status(taken.run, view, taken.in_force.told(view.t)):
        print(f"{name:<9} {told}")
    return 0


def _watch(taken: Seat) -> int:
    """Tell how it goes until the flight ends: a line that changes, else one now and then; events stay."""
    print(f"Watching {title(taken.run)}; Ctrl-C ends it.")
    told_t, next_t = time.monotonic(), 0.0
    with StatusLine(sys.stdout) as out:
        every = _WATCH_S if out.live else _LINE_EVERY_S
        while taken.there:
            view = taken.look()
            for event in view.events:
                if event.t > told_t:
                    told_t = event.t
                    out.note(
                        f"{event.source.decode(errors='replace')}: {event.text.decode(errors='replace')}"
                    )
            if view.t >= next_t:
                next_t = view.t + every
                told = line(view, taken.in_force.told(view.t))
                out.step(_cut(told)) if out.live else out.tell(told)
            time.sleep(_WATCH_S)
    print("The flight has ended.")
    return 0


def _cut(text: str) -> str:
    """Return what of a line fits the terminal: one that went on below would not be cleared."""
    columns = os.get_terminal_size(sys.stdout.fileno()).columns
    return text if len(text) < columns else f"{text[: columns - 2]}…"


def _say(taken: Seat, text: str) -> int:
    if not text.strip() or len(text.encode()) >= EVENT_TEXT:
        raise InputError(f"say: a message has 1 to {EVENT_TEXT - 1} letters; say it in fewer.")
    taken.say(text)
    time.sleep(_TAKEN_S)
    print("Told.")
    return 0


def _command(taken: Seat, kind: CommandKind) -> int:
    number = taken.command(kind)
    answer = taken.heard(_COMMAND_S, lambda: taken.answer_to(number))
    if answer is not None and answer.ok:
        print(f"Done: {kind.name.capitalize()}.")
        return 0
    why = answer.text.decode(errors="replace") if answer is not None else _nobody(taken, _COMMAND_S)
    return _fail(why)


def _let_happen(taken: Seat, happening: Happening) -> int:
    taken.ask(happening)
    began, told = time.monotonic(), words(happening)
    with StatusLine(sys.stderr) as out:

        def look() -> InterventionAnswer | None:
            out.step(f"{told}: waiting for the answer, {time.monotonic() - began:.0f} s …")
            return next(iter(taken.answers()), None)

        answer = taken.heard(_PATIENCE_S, look)
    if answer is not None and answer.ok:
        print(f"Done: {told}.")
        return 0
    why = answer.text.decode(errors="replace") if answer is not None else _nobody(taken, _PATIENCE_S)
    return _fail(f"{told}: refused: {why}")


def _nobody(taken: Seat, seconds: float) -> str:
    return f"nobody answered in {seconds:.0f} s" if taken.there else _GONE


def _fail(why: str) -> int:
    print(f"groundstation: {why.rstrip('.')}.", file=sys.stderr)
    return 1
