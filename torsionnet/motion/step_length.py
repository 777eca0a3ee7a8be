"""Length of the steps of a motion with laws of straight pieces, from the rates of its contact states."""

from __future__ import annotations

import math
from collections.abc import Sequence

from torsionnet.base.errors import UsageError
from torsionnet.motion.contact_states import ContactStates
from torsionnet.motion.march_tables import MOST_TURN
from torsionnet.motion.phases import LawPhases

LONGEST_TURN = 1.0
"""Angle in rad that the fastest vibration may turn in a step: between two looks at the guards it then makes one turning
point at most."""
MOST_SUBSTEPS = 64
"""Most points of the finer grid in a step, which bounds the memory of the tables: poles quicker than all vibrations, as
of strong dampers, shorten the step beyond that."""
MOST_STEPS = 100_000_000
"""Most steps of a motion, some minutes of work."""


def first_rates(states: ContactStates, laws: Sequence[LawPhases]) -> tuple[float, float]:
    """Largest frequency and pole in rad/s with all laws at their stiffest and most damped pieces."""
    contact: list[int] = []
    for law in laws:
        slopes = [number for number, phase in enumerate(law.phases) if phase.kind == "slope"]
        contact.append(max(slopes, key=lambda number: (law.phases[number].stiffness, law.phases[number].damping)))
    try:
        return states.form(tuple(contact)).largest_rates
    except UsageError:  # massless parts that only other contact states fix
        return 0.0, 0.0


def steps_of(rates: tuple[float, float], step: float, n: int, refinement: int = 1) -> tuple[int, int]:
    """Number of steps in a sampling interval of ``step`` seconds, and points of the finer grid in a step.

    ``rates`` are the fastest vibration and the largest pole in rad/s, ``n`` is the number of samples.

    Raises
    ------
    UsageError
        The motion needs too many steps.
    """
    turning, largest = rates
    most = MOST_SUBSTEPS * MOST_TURN
    k = refinement * max(1, math.ceil(step * turning / LONGEST_TURN), math.ceil(step * largest / most))
    if k * n > MOST_STEPS:
        text = f"the fastest motion, {largest:.3g} rad/s, needs {k * n:.2g} steps over {n * step:.3g} s"
        raise UsageError(f"{text}; simulate a shorter time, or leave out what is so stiff")
    n_sub = 4
    while n_sub * MOST_TURN < largest * step / k and n_sub < MOST_SUBSTEPS:
        n_sub *= 2
    return k, n_sub
