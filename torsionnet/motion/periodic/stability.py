"""Stability of periodic motions by multipliers, exact or of the variational equation, and by Hill's determinant.

Laws of straight pieces: the monodromy over the contact states of a period that closes to rounding, as also of friction.
Beside smooth laws that of :mod:`.variational`, with the state of friction behind a spring. Delays, and laws that depend
on frequency, have no finite state: there Hill's determinant counts what grows, or stability is said to be not
determined.

Stability of periodic motions by Hill's determinant, for delays, tables and loss factors, which have no states.

A small disturbance e^(lambda t) sum_k x_k e^(jkwt) of the motions of laws is kept up where

    h(lambda) = det[I + G(lambda + jkw) tau'] prod_k det D_0(lambda + jkw)/det D_p(lambda + jkw + a) = 0,

tau' being the Toeplitz matrices of the slopes along the motion, and D_p the springs, dampers and inertias alone, whose
zeros lie left of -a. h repeats with jw and tends to 1 far on the right: by the principle of the argument, as many
disturbances grow as h turns half turns backwards from Im lambda = 0 to w/2, a little right of the imaginary axis
(A. Lazarus, O. Thomas, Comptes Rendus Mecanique 338, 2010; the count is that of Nyquist).
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import TorsionnetError, UsageError
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.motion.periodic.contact_passage import ContactMarch, Passage, multipliers_of
from torsionnet.motion.periodic.periodic_problem import PeriodicMotion, PeriodicProblem, coefficients
from torsionnet.motion.periodic.variational import variational_monodromy

# Stability of periodic motions by Hill's determinant, for delays, tables and loss factors, which have no states.

FEWEST = 12
"""Harmonics of the smallest determinant; those after it have twice as many, until two agree."""
SHIFT = 1e-6
"""Growth within a period from which a disturbance counts as growing."""
SHIFTED = 0.05
"""Shift a of the zeros that h is divided by, over w."""
LOOKS = 32
"""Places between Im lambda = 0 and w/2 at which h is first looked at."""
TURN = 0.25 * math.pi
"""Turn of h from place to place above which it is looked at in between."""
DEEPEST = 26
"""Most halvings between two places."""
WHOLE = 0.2
"""Part of a half turn by which a count may miss a whole number."""
REAL_PARTS, IMAGINARY_PARTS = (0.03, 0.3, -0.03, -0.15), (0.0, 0.5, 0.25)
"""Further places, over w, from which zeros of h are looked for."""
REST = 1e-5
"""Distance from rest, over w, up to which a zero is that of what turns freely."""
SAME = 1e-5
"""Share of a multiplier up to which another is the same one."""
REAL = 1e-4
"""Share of a multiplier up to which its imaginary part is rounding."""
MOST_STEPS = 20
"""Most Newton steps to a zero of h."""


class HillDeterminant:
    """Function h(lambda) along a motion, truncated to so many harmonics."""

    def __init__(self, problem: PeriodicProblem, motion: PeriodicMotion, harmonics: int) -> None:
        self.problem, self.omega = problem, motion.omega
        self.k = np.arange(-harmonics, harmonics + 1)
        balance = problem.balance(motion.parameter, motion.harmonics)
        apart = self.k[:, None] - self.k
        self.slopes = []
        for answer in balance.answers(motion.x):
            own, rate = (None if s is None else _toeplitz(s, apart) for s in (answer.slope, answer.rate_slope))
            self.slopes.append((own, rate))

    def log(self, shift: complex, *, whole: bool = True) -> complex:
        """Natural logarithm of h at lambda, or of its upper part, which has no poles; its angle but for whole turns."""
        plant = self.problem.plant
        s = np.asarray(shift + 1j * self.k * self.omega, dtype=np.complex128)
        D = _stiffness(plant.stiffness, s)
        logs = _log_det(D)
        if whole:
            logs = logs - _log_det(self._passive(s + SHIFTED * self.omega))
        # Twists of the laws by their torques, G = R D^-1 R^T at lambda + j k omega.
        G = plant.rows @ np.linalg.solve(D, np.broadcast_to(plant.rows.T, (len(s), *plant.rows.T.shape)))
        n, count = len(plant.laws), len(s)
        matrix = np.zeros((n, count, n, count), dtype=complex)
        for m, (own, rate) in enumerate(self.slopes):
            # Hill's matrix I + G (S - k_ref): S couples harmonics as a Toeplitz matrix, and D has k_ref already.
            tau = own - plant.references[m] * np.eye(count)
            if rate is not None:
                tau = tau + rate * s
            for row in range(n):
                matrix[row, :, m] = G[:, row, m][:, None] * tau
            matrix[m, :, m] += np.eye(count)
        return complex(logs.sum() + _log_det(matrix.reshape(n * count, n * count)))

    def _passive(self, s: ComplexArray) -> ComplexArray:
        """Dynamic stiffness of inertias, dampers and springs alone, with the springs k_0."""
        plant = self.problem.plant
        system = plant.placed.linear
        parts = (np.maximum(part, 0.0) for part in (system.inertia, system.damping, system.stiffness))
        inertia, damping, stiffness = parts
        # Each row adds a^T (J s^2 + c s + k) a; negative parts are left out, so that it has no zero to the right.
        kappa = inertia * s[:, None] ** 2 + damping * s[:, None] + stiffness
        references = plant.rows.T @ (plant.references[:, None] * plant.rows)
        return np.asarray(system.rows.T @ (kappa[:, :, None] * system.rows) + references)

    def growing(self) -> tuple[int | None, list[complex]]:
        """Number of disturbances that grow, None where the count is none, and places at which h is small."""
        edge = SHIFT * self.omega / (2 * math.pi)
        places = (edge + 1j * np.linspace(0.0, 0.5, LOOKS + 1) * self.omega).tolist()
        values = [self.log(place) for place in places]
        # Argument principle: the angle of h along the edge of half the strip counts the zeros beyond, conjugates once.
        turned = sum(
            self._turn_between(before, other, DEEPEST)
            for before, other in zip(zip(places, values), zip(places[1:], values[1:]))  # noqa: B905
        )
        count = -turned / math.pi
        sizes = np.array([value.real for value in values])
        low = [
            place
            for number, place in enumerate(places)
            if sizes[number] <= sizes[max(number - 1, 0) : number + 2].min()
        ]
        whole = round(count)
        return (whole if abs(count - whole) < WHOLE and whole >= 0 else None), low

    def _turn_between(self, first: tuple[complex, complex], second: tuple[complex, complex], depth: int) -> float:
        """Angle in rad by which h turns between two places, looked at between them where it turns far."""
        turn = math.remainder(second[1].imag - first[1].imag, 2 * math.pi)
        if abs(turn) < TURN or not depth:
            return turn
        place = (first[0] + second[0]) / 2
        middle = (place, self.log(place))
        return self._turn_between(first, middle, depth - 1) + self._turn_between(middle, second, depth - 1)

    def zero(self, start: complex) -> complex | None:
        """Zero of h near a place by Newton's method; None where it does not get there."""
        at, change = start, complex(1e-3 * self.omega)
        for _ in range(MOST_STEPS):
            # a difference over a part of the last step, so that it sees the zero as a straight line
            step = 1e-3 * abs(change)
            here, beside = self.log(at, whole=False), self.log(at + step, whole=False)
            apart = beside - here
            slope = complex(apart.real, math.remainder(apart.imag, 2 * math.pi)) / step
            if not slope or not math.isfinite(abs(slope)):
                return None
            change = 1 / slope
            at -= change
            if abs(at.real) > self.omega:
                return None
            if abs(change) < 1e-8 * self.omega:
                return at
        return None


def hill_multipliers(problem: PeriodicProblem, motion: PeriodicMotion) -> tuple[int, ComplexArray] | None:
    """Number of disturbances that grow, and the multipliers found, the largest first; None where no count settles.

    Two truncations have to agree. The multipliers are those of zeros near some starts, not all that there are.
    """
    if any(force.yielding for force in problem.forces):
        return None
    first = HillDeterminant(problem, motion, FEWEST).growing()[0]
    for more in (2, 4):
        determinant = HillDeterminant(problem, motion, more * FEWEST)
        growing, low = determinant.growing()
        if growing is not None and growing == first:
            break
        first = growing
    else:
        return None
    multipliers: list[complex] = []
    for start in (*low, *(motion.omega * (real + 1j * imag) for real in REAL_PARTS for imag in IMAGINARY_PARTS)):
        zero = determinant.zero(start)
        # What turns freely as a whole has its zero at rest.
        if zero is not None and (abs(zero) > REST * motion.omega or not problem.plant.free.size):
            multipliers.append(cmath.exp(2 * math.pi / motion.omega * zero))
        if multipliers and sum(abs(multiplier) > 1 for multiplier in _distinct(multipliers)) >= growing:
            break
    return growing, _distinct(multipliers)


def _distinct(multipliers: Sequence[complex]) -> ComplexArray:
    """Multipliers with their conjugates, each once, the largest first."""
    rounded = np.round(np.array(multipliers, dtype=complex), 7)
    rounded = np.where(np.abs(rounded.imag) < REAL * np.abs(rounded), rounded.real, rounded)
    both = np.concatenate([rounded, rounded.conj()])
    both = both[np.argsort(-np.abs(both), kind="stable")]
    kept: list[complex] = []
    for multiplier in both.tolist():
        if all(abs(multiplier - other) > SAME * abs(multiplier) for other in kept):
            kept.append(multiplier)
    return np.array(kept, dtype=complex)


def _stiffness(stiffness: Callable[[ComplexArray], ComplexArray], s: ComplexArray) -> ComplexArray:
    """Dynamic stiffness (n, n_q, n_q) by that at frequencies from zero on, D(conj s) = conj D(s)."""
    below = s.imag < 0
    D = stiffness(np.where(below, s.conj(), s))
    D[below] = D[below].conj()
    return np.asarray(D)


def _toeplitz(values: FloatArray, apart: NDArray[np.intp]) -> ComplexArray:
    """Coefficients S_(k-m) of samples of a slope over a period."""
    series = coefficients(values, int(apart.max()) // 2)
    return np.where(apart >= 0, series[np.abs(apart)], series[np.abs(apart)].conj())


def _log_det(matrix: ComplexArray) -> ComplexArray:
    sign, size = np.linalg.slogdet(matrix)
    return np.asarray(size + np.log(sign))


# Stability of periodic motions by their multipliers, exact over contact states or from the variational equation.

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
