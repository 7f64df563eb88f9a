"""For a class of one: what an instructor could let happen, by name in the trainee's own palette."""

from __future__ import annotations

from collections.abc import Iterator

from textual.app import SystemCommand

from groundstation.training.asking import Asker
from groundstation.training.happening import Calm, unpacked, words
from groundstation.training.strengths import FIRM, OFFERS


class Instructing:
    """Asks for it on the bus as an instructor would.

    Args:
        asker: Asks, of a simulated vehicle's flight; None where the vehicle is real, which is left alone.
    """

    def __init__(self, asker: Asker | None) -> None:
        self._asker = asker

    def commands(self) -> Iterator[SystemCommand]:
        """Yield what can be let happen."""
        if (asker := self._asker) is None:
            return
        for happening, name in (
            *((offer.at(FIRM), offer.name) for offer in OFFERS),
            (Calm(), "take all back"),
        ):
            told = words(happening)
            yield SystemCommand(
                f"Instructor: {name}",
                f"{told[0].upper()}{told[1:]}.",
                lambda happening=happening: asker.ask(happening),
            )

    def refusals(self) -> list[str]:
        """Return what was refused since the last call, with the reason; what happens is to be felt, not read."""
        answers = self._asker.answers() if self._asker else []
        return [
            f"{words(happening)}: {answer.text.decode(errors='replace')}."
            for answer in answers
            if not answer.ok and (happening := unpacked(answer.happening)) is not None
        ]
