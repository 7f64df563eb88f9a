"""Answers to what was wanted to happen, for whoever carries it out."""

from __future__ import annotations

from groundstation.messages import ANSWER_TEXT, Intervention, InterventionAnswer, fit

# An instructor who comes late gets to know within this what has been done, s.
WELCOME_S = 0.2
REAL = "the vehicle is real; this is for simulated ones"


def answer_to(asked: Intervention, why: str, now: float) -> InterventionAnswer:
    """Return the answer to one: that it was done or, with `why`, that it was not."""
    answer = InterventionAnswer(t=now, number=asked.number, ok=int(not why))
    answer.source, answer.happening, answer.text = asked.source, asked.happening, fit(why, ANSWER_TEXT)
    return answer
