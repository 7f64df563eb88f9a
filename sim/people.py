"""People to choose among: how a novice, an average and an expert operator steer.

The average one is `Person` as it stands. The others are estimates around it: with practice the effective delay falls,
the gain rises and the remnant shrinks (McRuer and Jex 1967, A review of quasi-linear pilot models, on what training
changes; the numbers are ours).
"""

from __future__ import annotations

from dataclasses import replace

from sim.operator import Person

PEOPLE: dict[str, Person] = {
    "novice": Person(
        cruise=0.8,
        reaction=0.35,
        ahead=0.3,
        crossover=0.6,
        trim=0.25,
        slowing=0.35,
        remnant=0.04,
        remnant_share=0.12,
        remnant_time=0.25,
    ),
    "average": Person(),
    "expert": Person(
        cruise=1.6,
        reaction=0.15,
        ahead=0.5,
        crossover=1.0,
        trim=0.5,
        slowing=0.7,
        remnant=0.01,
        remnant_share=0.03,
    ),
}


def accustomed(person: Person, delay: float) -> Person:
    """Return the person after a while with a round trip of `delay`, s.

    People lower their gain until the loop has the phase margin it had: ω_c (τ + d) stays what ω_c τ was, with τ their
    own delay and the lag of the vehicle as they know it (McRuer and Jex 1967: the crossover regresses as the
    effective delay grows). They brake earlier and drive slower in proportion.
    """
    own = person.reaction + person.lag
    share = own / (own + delay)
    return replace(
        person,
        crossover=share * person.crossover,
        slowing=share * person.slowing,
        cruise=share * person.cruise,
        trim=share * person.trim,
    )
