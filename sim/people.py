"""People to choose among: how a novice, an average and an expert operator steer.

The average one is `Person` as it stands. The others are estimates around it: with practice the effective delay falls,
the gain rises and the remnant shrinks (McRuer and Jex 1967, A review of quasi-linear pilot models, on what training
changes; the numbers are ours). Who is new to a task stiffens the arm by pulling with opposed muscles at once, and
lets go of that with practice (Osu et al. 2002, Short- and long-term changes in joint co-contraction associated with
motor learning as revealed from surface EMG): the novice's arm is the stiffest.
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
        turn_gain=0.7,
        turn_rate=0.35,
        recovers=4.0,
        arm_stiffness=200.0,
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
        turn_gain=1.3,
        turn_rate=0.7,
        recovers=1.0,
        arm_stiffness=110.0,
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
        turn_gain=share * person.turn_gain,
    )
