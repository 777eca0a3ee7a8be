"""Stability of periodic motions by their multipliers, exact over contact states or from the variational equation.

Laws of straight pieces: the monodromy over the contact states of a period that closes to rounding, as also of friction.
Beside smooth laws that of :mod:`.variational`, with the state of friction behind a spring. Delays, and laws that depend
on frequency, have no finite state: there Hill's determinant counts what grows, or stability is said to be not
determined.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import TorsionnetError, UsageError
from torsionnet.linear.assembly.rows import ComplexArray
from torsionnet.motion.periodic.contact_passage import ContactMarch, Passage, multipliers_of
from torsionnet.motion.periodic.hill import hill_multipliers
from torsionnet.motion.periodic.periodic_problem import PeriodicMotion, PeriodicProblem
from torsionnet.motion.periodic.variational import variational_monodromy

CLOSED = 1e-7
"""Share of a state by which a period over contact states may stay open."""
NEAR, NEAR_OF_STEPS = 1e-3, 0.05
"""Share of a state by which the period that closes may begin elsewhere than the motion of harmonics, which fall slowly
where laws have steps."""
MOST_CLOSED = 8
"""Most Newton steps by which a period over contact states closes."""
ON_CIRCLE = 1e-7
"""Distance from the unit circle up to which a multiplier counts as on it."""
DOUBLE = 1e-5
"""Distance from the unit circle up to which a double multiplier counts as on it: to the root of rounding."""


@dataclass(frozen=True, eq=False)
class Stability:
    """Multipliers (n,) of a motion, the largest first, or the reason for which they are not determined.

    ``passage`` is the period over contact states, where laws have straight pieces. ``growing`` is the number of
    disturbances that grow where Hill's determinant counts them; the multipliers are then some of all that there are.
    ``idle`` motions have a law over the twist without any torque, as that of a gap never closed.
    """

    multipliers: ComplexArray
    undetermined: str = ""
    march: ContactMarch | None = None
    passage: Passage | None = None
    growing: int | None = None
    idle: bool = False

    @property
    def is_neutral(self) -> bool:
        """Whether a law that never acts leaves something where it is put, or drifting: nothing brings it back."""
        return self.idle and abs(float(np.abs(self.multipliers).max(initial=0.0)) - 1) < DOUBLE

    @property
    def is_stable(self) -> bool | None:
        """Whether the motion is stable; None where it is neutral or that is not determined."""
        if self.undetermined or self.is_neutral:
            return None
        if self.growing is not None:
            return not self.growing
        return bool(np.abs(self.multipliers).max(initial=0.0) < 1 + ON_CIRCLE)

    @property
    def words(self) -> str:
        """Stability in words."""
        if self.undetermined:
            return "stability not determined"
        if self.is_neutral:
            return "neutral"
        if self.is_stable:
            return "stable"
        if not (np.abs(self.multipliers) > 1).any():
            return "unstable"
        worst = self.multipliers[0]
        if abs(worst.imag) > ON_CIRCLE * abs(worst):
            return "unstable: a second frequency grows"
        return "unstable: leaves" if worst.real > 0 else "unstable: doubles"

    @property
    def has_all(self) -> bool:
        """Whether the multipliers are all that there are."""
        return not self.undetermined and self.growing is None

    @property
    def doubling(self) -> float:
        """Product of 1 + multiplier, which passes zero where the period doubles."""
        return float(np.prod(1 + self.multipliers).real)


def stability_of(problem: PeriodicProblem, motion: PeriodicMotion, *, on_edge: bool = False) -> Stability:
    """Stability of a periodic motion; where it is ``on_edge`` no period near it closes better than another."""
    try:
        split = problem.plant.in_time
    except UsageError:
        counted = hill_multipliers(problem, motion)
        if counted is None:
            sticks = any(force.yielding for force in problem.forces)
            why = "friction that sticks has no slopes for" if sticks else "two truncations do not agree on"
            text = f"delays and laws that depend on frequency or on what was have no states, and {why}"
            return Stability(np.zeros(0, dtype=complex), f"{text} Hill's determinant")
        return Stability(counted[1], growing=counted[0])
    if not split.smooth and not problem.plant.turning.any():
        return _over_contacts(problem, motion, 0 if on_edge else MOST_CLOSED)
    if problem.has_steps:
        return Stability(np.zeros(0, dtype=complex), "friction that sticks beside laws without straight pieces")
    try:
        return Stability(multipliers_of(variational_monodromy(problem, motion)))
    except TorsionnetError as error:
        return Stability(np.zeros(0, dtype=complex), str(error))


def _over_contacts(problem: PeriodicProblem, motion: PeriodicMotion, most: int) -> Stability:
    try:
        march = ContactMarch(problem, motion.parameter)
        z, contact = march.start(motion)
        passage, first, left_open = march.closed(z, contact, most)
    except TorsionnetError as error:
        return Stability(np.zeros(0, dtype=complex), str(error))
    own = slice(0, 2 * march.at.n_q + march.at.n_c)
    # what has no inertia may begin with any rate
    z = march.states.form(passage.stretches[0].contact).refresh @ z
    size = np.abs(z[own]).max()
    near = NEAR_OF_STEPS if problem.has_steps else NEAR
    if left_open > (CLOSED if most else NEAR) or np.abs((first - z)[own]).max() > near * size:
        return Stability(np.zeros(0, dtype=complex), "over its contact states the motion does not close")
    over_twist = np.array([law.law.curve.over == "twist" for law in problem.plant.laws])
    idle = bool((over_twist & ~motion.torques.any(axis=0)).any())
    return Stability(march.multipliers(passage), march=march, passage=passage, idle=idle)
