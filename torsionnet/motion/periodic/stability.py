"""Stability of periodic motions by their multipliers, exact over contact states or from the variational equation.

Laws of straight pieces: the monodromy over the contact states of a period that closes to rounding. Laws without steps:
the equation x' = (A - sum_l a_l s_l(t) b_l^T) x with the slopes s_l of the laws along the motion, stepped by the method
of Magnus of fourth order (S. Blanes et al., The Magnus expansion and some of its applications, Physics Reports 470,
2009). Delays, and laws that depend on frequency, have no finite state: there Hill's determinant counts what grows, or
stability is said to be not determined.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import scipy

from torsionnet.base.errors import SolveError, TorsionnetError, UsageError
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.motion.contact_form import contact_form, relative_form
from torsionnet.motion.motion_plant import Drive, Layout
from torsionnet.motion.periodic.contact_passage import ContactMarch, Passage, multipliers_of, without_turning
from torsionnet.motion.periodic.harmonic_balance import over_time
from torsionnet.motion.periodic.hill import hill_multipliers
from torsionnet.motion.periodic.law_forces import CurveForce, PieceForce
from torsionnet.motion.periodic.periodic_problem import PeriodicMotion, PeriodicProblem

CLOSED = 1e-7
"""Share of a state by which a period over contact states may stay open."""
NEAR, NEAR_OF_STEPS = 1e-3, 0.05
"""Share of a state by which the period that closes may begin elsewhere than the motion of harmonics, which fall slowly
where laws have steps."""
STEPS_PER_HARMONIC, FEWEST_STEPS = 16, 512
"""Steps of Magnus's method in a period over the harmonics, and at least."""
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
    except UsageError as error:
        counted = hill_multipliers(problem, motion)
        if counted is None:
            return Stability(np.zeros(0, dtype=complex), str(error))
        return Stability(counted[1], growing=counted[0])
    if not split.smooth and not problem.plant.turning.any():
        return _over_contacts(problem, motion, 0 if on_edge else MOST_CLOSED)
    if all(isinstance(force, CurveForce | PieceForce) for force in problem.forces):
        return _variational(problem, motion)
    return Stability(np.zeros(0, dtype=complex), "friction that sticks beside laws without straight pieces")


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


def _variational(problem: PeriodicProblem, motion: PeriodicMotion) -> Stability:
    plant = problem.plant
    bare = replace(plant.in_time.plant, laws=())
    n_q, n_laws = plant.rows.shape[1], len(plant.laws)
    drive = Drive(-plant.rows.T, (), 0, np.zeros((0, 0)), np.zeros((n_laws, 0)))
    at = Layout(n_q, sum(len(action.F) for action in bare.actions), 0, n_laws)
    try:
        form = relative_form(bare, at, contact_form(bare, (), (), drive))
    except (UsageError, SolveError) as error:
        return Stability(np.zeros(0, dtype=complex), str(error))
    own = slice(0, 2 * n_q + at.n_c)
    A, entry = form.A[own, own], form.A[own, at.u]
    position, speed, _ = form.motion
    if np.abs(plant.rows @ position[:, at.u]).max(initial=0.0) > 0:
        return Stability(np.zeros(0, dtype=complex), "a law acts where nothing has inertia")
    angles, rates = plant.rows @ position[:, own], plant.rows @ speed[:, own]
    period = 2 * math.pi / motion.omega
    count = max(FEWEST_STEPS, STEPS_PER_HARMONIC << (motion.harmonics - 1).bit_length())
    h = period / count
    # A(t) at the two Gauss points of every step
    first, second = (
        A + np.einsum("il,nlj->nij", entry, _slopes(problem, motion, angles, rates, count, place))
        for place in (0.5 - math.sqrt(3) / 6, 0.5 + math.sqrt(3) / 6)
    )
    exponents = h / 2 * (first + second) - math.sqrt(3) / 12 * h**2 * (first @ second - second @ first)
    product = np.eye(len(A))
    for step in np.asarray(scipy.linalg.expm(exponents)):
        product = step @ product
    return Stability(multipliers_of(without_turning(product, bare, at)))


def _slopes(
    problem: PeriodicProblem, motion: PeriodicMotion, angles: FloatArray, rates: FloatArray, count: int, place: float
) -> FloatArray:
    """Changes (count, n_laws, n) of the torques of laws over the states, at a place from 0 to 1 in every step."""
    k = np.arange(motion.harmonics + 1)
    over_states = []
    for number, force in enumerate(problem.forces):
        # x at t + place h: every harmonic turned on by that much
        x = motion.x[:, number] * np.exp(2j * math.pi * k * place / count)
        turning = problem.plant.turning[number] * problem.drive.speed(motion.parameter)
        rate = over_time(1j * motion.omega * k * x, count) + turning if force.needs_rate else None
        answer = force.answer_to(over_time(x, count), rate)
        change = answer.slope[:, None] * angles[number]
        if answer.rate_slope is not None:
            change = change + answer.rate_slope[:, None] * rates[number]
        over_states.append(change)
    return np.stack(over_states, axis=1)
