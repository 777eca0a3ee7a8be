"""Poles in rad/s and mode shapes of a drivetrain with controllers or negative damping, with the controllers' poles.

Starts come from the states of drivetrain and controllers together; each pole is then a root of the exact characteristic
equation, delays included, with a bound on its rounding.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.action_laws import polynomial
from torsionnet.linear.assembly.rows import Assembly, ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.many_digits import in_many_digits
from torsionnet.linear.dynamic_stiffness.reduction import require_resistance
from torsionnet.linear.modes.active_pencil import (
    EPS,
    LARGEST_START_ERROR,
    ActivePencil,
    Pole,
    slow_starts,
    state_eigenvalues,
)
from torsionnet.linear.modes.eigen import (
    OSCILLATORY,
    REAL,
    RIGID,
    EigenSolution,
    complex_modes,
    undamped_modes,
    unit_shapes,
    with_zero_damping,
)
from torsionnet.model.element_base.dynamic_stiffness import ComplexStiffness

# Roots of the characteristic equation in many digits, for poles that double precision does not resolve.

DIGITS = 60
"""Decimal digits of all sums in a root's equation, enough against cancellation between stiff and soft springs."""
MOST_ITERATIONS = 20
"""Most steps of inverse iteration for a pole in many digits, as a start with some right digits needs a few."""
CONVERGED = 1e-15
"""Relative step at which a pole in many digits counts as found, since the result is rounded to double precision."""


class ManyDigitPencil:
    """Matrix P(s) of a controlled drivetrain's characteristic equation det P(s) = 0, in mpmath numbers.

    It is that of :class:`~torsionnet.linear.modes.active_pencil.ActivePencil`.

    To be used within ``mpmath.workdps(DIGITS)``.
    """

    def __init__(self, assembly: Assembly) -> None:
        import mpmath

        self.actions = assembly.system.actions
        self.index: dict[str, int] = {name: place for place, name in enumerate(assembly.kinematics.coordinates)}
        n = len(self.index)
        self.size: int = n + len(self.actions)
        self.powers: list[Any] = [mpmath.zeros(n, n) for _ in range(3)]
        for law, row in zip(assembly.laws, assembly.exact_rows, strict=True):
            ours = [(self.index[name], in_many_digits(value)) for name, value in row.items() if name in self.index]
            for power, value in zip(self.powers, (law.stiffness, law.damping, law.inertia), strict=True):
                for i, a in ours if value else ():
                    for j, b in ours:
                        power[i, j] += in_many_digits(value) * a * b

    def matrix_at(self, s: Any, rate: bool = False) -> Any:
        """Matrix P(s) of the characteristic equation, or its derivative dP/ds, as an mpmath matrix."""
        import mpmath

        K, C, M = self.powers
        n, whole = len(self.index), mpmath.zeros(self.size, self.size)
        # K + C s + M s^2, and C + 2 M s
        whole[:n, :n] = C + 2 * s * M if rate else K + s * (C + s * M)
        for place, action in enumerate(self.actions, n):
            above, below = (
                [in_many_digits(value) for value in part] for part in (action.numerator, action.denominator)
            )
            tau = in_many_digits(action.delay)
            factor, own = polynomial(above, s), polynomial(below, s)
            if rate:
                factor, own = polynomial(_slope(above), s) - tau * factor, polynomial(_slope(below), s)
            for name, value in action.sensed.items():
                if name in self.index:
                    whole[place, self.index[name]] = -factor * mpmath.exp(-s * tau) * in_many_digits(value)
            for name, value in action.row.items() if not rate else ():
                if name in self.index:
                    whole[self.index[name], place] = -in_many_digits(value)
            whole[place, place] = own
        return whole

    def root_near(self, start: complex, vector: ComplexArray) -> tuple[complex, ComplexArray] | None:
        """Pole near a start in rad/s with its vector, right to double precision, or None without convergence."""
        import mpmath

        s, w = mpmath.mpmathify(start), mpmath.matrix([mpmath.mpmathify(complex(value)) for value in vector])
        for _ in range(MOST_ITERATIONS):
            # Inverse iteration z = P^-1 P' w, and s moves by w_i / z_i of the largest w_i.
            try:
                z = mpmath.lu_solve(self.matrix_at(s), self.matrix_at(s, rate=True) * w)
            except ZeroDivisionError:
                return complex(s), np.array([complex(value) for value in w])
            largest = max(range(len(w)), key=lambda place: abs(w[place]))
            if not z[largest]:
                return None
            step = w[largest] / z[largest]
            s, w = s - step, z / max(abs(value) for value in z)
            if abs(step) <= CONVERGED * abs(s):
                return complex(s), np.array([complex(value) for value in w])
        return None


def _slope(coefficients: list[Any]) -> list[Any]:
    return [power * value for power, value in enumerate(coefficients)][1:]


LARGEST_SOLVED_EXACTLY = 150
"""Number of coordinates and controllers up to which every pole is solved on the characteristic equation and counted, as
time allows."""
LARGEST_COUNTED = 200
"""Number of coordinates and controllers up to which poles in a circle are counted, since counting takes their number
cubed."""
LARGEST_UNCERTAIN = 1e-3
"""Size of an uncertain start, over the radius of the circle, up to which slow poles are sought near it, as larger ones
stem from the delay.

Larger uncertain starts are poles of the delay that its points do not resolve.
"""
MOST_POINTS = 160
"""Most points by which a delay is approximated for start values, as each adds a state per controller."""
FEWEST_POINTS = 20
"""Fewest points by which a delay is approximated for start values, so that slow poles have good starts."""
POINTS_PER_RADIAN = 0.75
"""Points of a delay per radian by which the fastest motion turns in the time of the delay."""
SAME_POLE = 1e-7
"""Relative distance below which two poles are one, as roots are far more accurate and distinct poles hardly as near."""
REAL_BELOW = 1e-10
"""Imaginary part of a pole, over its size, up to which the pole counts as real."""
SOLVED_IN_MANY_DIGITS = 1e-11
"""Relative error of a pole above which the pole is solved in many digits."""
MOST_WORK = 3e5
"""Most coordinates cubed times poles that are solved in many digits, which bounds the time."""
LOSS_STEPS = 8
"""Number of equal steps in which loss factors grow from 0 while poles are followed, as more steps follow larger losses
more safely."""


def active_modes(assembly: Assembly) -> tuple[EigenSolution, tuple[str, ...], tuple[str, ...]]:
    """Modes of a drivetrain with controllers (eigenvalues in rad/s, shapes), texts of warnings, and notes.

    Raises
    ------
    UsageError
        Stiffness that varies with frequency, beside controllers.
    SolveError
        Some coordinates have neither inertia nor spring nor damper.
    """
    system = assembly.system
    if system.dynamic:
        return _with_hysteresis(assembly)
    require_resistance(system, (system.inertia != 0) | (system.damping != 0) | (system.stiffness != 0))
    pencil = ActivePencil(assembly)
    delay = max((float(action.delay) for action in system.actions), default=0.0)
    poles, warned, notes = _delayed(pencil, delay) if delay else _rational(pencil)
    poles = _in_many_digits(assembly, poles)
    return _solution(sorted(poles, key=lambda pole: abs(pole.value)), pencil.static_shapes), warned, notes


def _with_hysteresis(assembly: Assembly) -> tuple[EigenSolution, tuple[str, ...], tuple[str, ...]]:
    """Modes, warnings and notes of a drivetrain with controllers, where springs have loss factors.

    Raises
    ------
    UsageError
        A stiffness varies with frequency.
    """
    system = assembly.system
    varying = [assembly.owners[law] for law, table in system.dynamic if not isinstance(table, ComplexStiffness)]
    if varying:
        names = ", ".join(dict.fromkeys(varying))
        text = f"modes with controllers are not calculated where a stiffness varies with frequency: {names}"
        raise UsageError(
            f"{text}; a continuous shaft may be given as type: shaft with segments", kind="unsupported-law"
        )
    # Springs with k alone first; their losses k eta then grow in steps, each from the poles before.
    springs = system.frozen(1.0)[0].real
    elastic = replace(assembly, system=replace(system, dynamic=(), stiffness=springs))
    solution, warned, notes = active_modes(elastic)
    poles, lost = [], 0
    pencil = ActivePencil(elastic)
    for number, kind in enumerate(solution.kinds):
        value, shape = complex(solution.eigenvalues[number]), solution.vectors[:, number]
        pole = Pole(value, pencil.with_torques(value, shape), float(solution.errors[number]))
        if kind == OSCILLATORY:
            met = _led(elastic, system.frozen(1.0)[0].imag, pole)
            lost += met is None
            pole = met or pole
        if kind != RIGID:
            poles.append(pole)
    if lost or len(_distinct_poles(poles)) < len(poles):
        warned = (
            *warned,
            "with controllers and loss factors, some modes were lost or found twice; check without loss factors",
        )
    rigid = solution.vectors[:, [kind == RIGID for kind in solution.kinds]].real
    return _solution(sorted(poles, key=lambda pole: abs(pole.value)), rigid), warned, notes


def _led(elastic: Assembly, loss: FloatArray, pole: Pole) -> Pole | None:
    """Pole in rad/s that one without losses becomes as all laws get losses k eta (n_laws,), or None where lost."""
    value, vector, error = pole.value, pole.vector, pole.error
    for share in np.linspace(0, 1, LOSS_STEPS + 1)[1:]:
        met = ActivePencil(elastic, share * loss).root_near(value, vector)
        if met is None or met[0].imag <= 0:
            return None
        value, vector, error = met
    return Pole(value, vector, max(error, EPS))


def _distinct_poles(poles: Sequence[Pole]) -> list[Pole]:
    """Poles without those that repeat another one together with its mode shape."""
    distinct: list[Pole] = []
    for pole in poles:
        if all(
            abs(pole.value - other.value) > SAME_POLE * abs(pole.value) or _differ(pole, other) for other in distinct
        ):
            distinct.append(pole)
    return distinct


def _differ(pole: Pole, other: Pole) -> bool:
    a, b = pole.vector, other.vector
    return bool(abs(a.conj() @ b) < (1 - SAME_POLE) * np.linalg.norm(a) * np.linalg.norm(b))


def _rational(pencil: ActivePencil) -> tuple[list[Pole], tuple[str, ...], tuple[str, ...]]:
    """All nonzero poles in rad/s of a drivetrain with controllers without delays, texts of warnings, and notes."""
    starts = state_eigenvalues(pencil, 0)
    total = sum(pole.count for pole in starts)
    small = pencil.size <= LARGEST_SOLVED_EXACTLY
    firm, loose = [], []
    for start in starts:
        met = (_on_exact_equation(pencil, start) if small else start) if start.error < LARGEST_START_ERROR else None
        firm += [met] if met else []
        loose += [] if met else [start]
    # Poles that the states have, but for those at zero and those that are certain.
    left = total - pencil.zeros - sum(pole.count for pole in firm)
    if left:
        for pole in _distinct(pencil, [*slow_starts(pencil, loose), *loose]):
            if pole.count <= left and all(
                abs(pole.value - other.value) > SAME_POLE * abs(pole.value) for other in firm
            ):
                firm.append(pole)
                left -= pole.count
    if left:  # a double root is no simple root, on which the iteration converges
        for pole in sorted(loose, key=lambda pole_left: pole_left.error):
            if pole.count <= left and pole.error < 1:
                firm.append(pole)
                left -= pole.count
    if not small:
        return firm, _count_warning(total, total - left), ()
    count, zeros = pencil.counts()
    return firm, (*_count_warning(zeros, pencil.zeros, " at zero"), *_count_warning(count, total - left)), ()


def _count_warning(counted: int, met: int, where: str = "") -> tuple[str, ...]:
    return () if counted == met else (f"{counted} poles{where} were counted, but {met} found",)


def _on_exact_equation(pencil: ActivePencil, pole: Pole) -> Pole | None:
    """Pole in rad/s on the exact characteristic equation near a start, or None where the iteration leaves it."""
    root = pencil.root_near(pole.value, pole.vector)
    # Further away than its error lets expect lies another pole.
    if root is None or abs(root[0] - pole.value) > max(1e-3, 100 * pole.error) * abs(pole.value):
        return None
    value = complex(root[0].real, 0.0) if pole.is_real else root[0]
    return Pole(value, root[1], min(root[2], max(pole.error, EPS)))


def _in_many_digits(assembly: Assembly, poles: Sequence[Pole]) -> list[Pole]:
    """Poles of which the uncertain ones are solved in many digits as time allows, as slow ones of stiff drivetrains."""
    size = assembly.system.n_coordinates + len(assembly.system.actions)
    most = int(MOST_WORK // max(size, 1) ** 3)
    blurred = sorted((pole.error, place) for place, pole in enumerate(poles) if pole.error > SOLVED_IN_MANY_DIGITS)[
        ::-1
    ][:most]
    if not blurred:
        return list(poles)
    import mpmath

    refined = list(poles)
    with mpmath.workdps(DIGITS):
        exact = ManyDigitPencil(assembly)
        for error, place in blurred:
            pole = refined[place]
            met = exact.root_near(pole.value, pole.vector)
            if met is not None and abs(met[0] - pole.value) <= max(0.1, 10 * error) * abs(pole.value):
                value = complex(met[0].real, 0.0) if pole.is_real else met[0]
                refined[place] = Pole(value, met[1], EPS)
    return refined


# --- delays --------------------------------------------------------------------------------------------------------


def _delayed(pencil: ActivePencil, delay: float) -> tuple[list[Pole], tuple[str, ...], tuple[str, ...]]:
    """Poles of a drivetrain with delays, all in a circle and those near modes outside, warnings, and notes.

    The circle holds the modes without control and the poles of controllers, as far as the delay is resolved there.
    """
    system = pencil.assembly.system
    passive = replace(system, actions=())
    free = complex_modes(passive) if not passive.is_active else None
    sizes = (
        np.abs(free.eigenvalues) if free else undamped_modes(replace(passive, damping=np.zeros_like(system.damping)))[0]
    )
    widest = (MOST_POINTS - FEWEST_POINTS) / (POINTS_PER_RADIAN * delay)
    radius = min(1.3 * max([float(sizes.max(initial=0.0)), *(_corner(pencil)), 6 / delay]), widest)
    starts = state_eigenvalues(pencil, FEWEST_POINTS + math.ceil(POINTS_PER_RADIAN * radius * delay))
    loose = [
        pole for pole in starts if pole.error >= LARGEST_START_ERROR and abs(pole.value) <= LARGEST_UNCERTAIN * radius
    ]
    tried = [*starts, *slow_starts(pencil, loose)]
    near = _distinct(pencil, [pole for pole in tried if abs(pole.value) <= 1.2 * radius])
    # The circle lies in the widest gap between poles, where counting along it is surest.
    radius = _between(radius, [abs(pole.value) for pole in near])
    inside = [pole for pole in near if abs(pole.value) < radius]
    counted = pencil.count_within(radius) if pencil.size <= LARGEST_COUNTED else None
    listed = pencil.zeros + sum(pole.count for pole in inside)
    below = f"{radius / (2 * np.pi):.4g} Hz"
    if counted is None:
        warned: tuple[str, ...] = (f"with the delay, the poles below {below} could not be counted",)
    elif counted != listed:
        warned = (f"with the delay, {counted} poles lie below {below}, but {listed} were found",)
    else:
        warned = ()
    if pencil.size <= LARGEST_SOLVED_EXACTLY:
        warned = (*warned, *_count_warning(pencil.counts()[1], pencil.zeros, " at zero"))
    beyond = [] if free is None else _poles_beyond(pencil, free, radius)
    known = "may lack some here" if warned else "are all here"
    text = f"a delay makes infinitely many poles; those below {below} {known}"
    notes = (f"{text}, and of faster ones those next to modes without control" if beyond else text,)
    return inside + beyond, warned, notes


def _corner(pencil: ActivePencil) -> list[float]:
    """Magnitudes in rad/s of the poles that the controllers have by themselves."""
    magnitudes = []
    for action in pencil.assembly.system.actions:
        roots = np.roots([float(value) for value in reversed(action.denominator)])
        magnitudes += [float(abs(root)) for root in roots]
    return magnitudes


def _distinct(pencil: ActivePencil, starts: Sequence[Pole]) -> list[Pole]:
    """Poles in rad/s with Im >= 0 to which inverse iteration leads from the starts, each once."""
    poles: list[Pole] = []
    for start in starts:
        met = pencil.root_near(start.value, start.vector)
        if met is None:
            continue
        value = met[0]
        if abs(value.imag) <= REAL_BELOW * abs(value):
            value = complex(value.real, 0.0)
        pole = Pole(complex(value.real, abs(value.imag)), met[1] if value.imag >= 0 else met[1].conj(), met[2])
        if all(abs(pole.value - other.value) > SAME_POLE * abs(pole.value) for other in poles):
            poles.append(pole)
    return poles


def _between(radius: float, sizes: Sequence[float]) -> float:
    """Radius in rad/s, from 0.8 to 1 times the given one, in the widest gap between magnitudes of poles."""
    marks = sorted([0.8 * radius, *(size for size in sizes if 0.8 * radius < size < radius), radius])
    gaps = [(b / a, math.sqrt(a * b)) for a, b in pairwise(marks)]
    return max(gaps)[1]


def _poles_beyond(pencil: ActivePencil, free: EigenSolution, radius: float) -> list[Pole]:
    """Poles outside the circle of this radius (rad/s), which inverse iteration finds from modes without control."""
    n_act = pencil.size - pencil.n_coordinates
    starts = [
        Pole(complex(value), np.concatenate([free.vectors[:, number], np.zeros(n_act)]), 0.0)
        for number, value in enumerate(free.eigenvalues)
        if abs(value) >= radius
    ]
    poles = _distinct(pencil, starts)
    return [pole for pole in poles if abs(pole.value) >= radius and abs(pole.value) > 0]


# --- results ----------------------------------------------------------------------------------------------------


def _solution(poles: Sequence[Pole], rigid: FloatArray) -> EigenSolution:
    count, n_rigid, n = len(poles), rigid.shape[1], len(rigid)
    values = with_zero_damping(
        np.array([pole.value for pole in poles], dtype=complex), np.array([pole.error for pole in poles])
    )
    shapes = np.array([pole.vector[:n] for pole in poles], dtype=complex).reshape(count, n).T
    real = [pole.is_real for pole in poles]
    shapes[:, real] = _real_shapes(shapes[:, real])
    zeros = np.zeros(n_rigid)
    return EigenSolution(
        eigenvalues=np.concatenate([zeros, values]).astype(complex),
        vectors=np.hstack([_scaled_shapes(rigid), _scaled_shapes(shapes)]).astype(complex),
        kinds=(RIGID,) * n_rigid + tuple(REAL if is_real else OSCILLATORY for is_real in real),
        converged=np.ones(n_rigid + count, dtype=bool),
        iterations=np.concatenate([zeros, np.ones(count)]).astype(int),
        errors=np.concatenate([zeros, [pole.error for pole in poles]]),
    )


def _real_shapes(shapes: ComplexArray) -> ComplexArray:
    largest = shapes[np.argmax(np.abs(shapes), axis=0), np.arange(shapes.shape[1])] if shapes.size else np.ones(0)
    return np.asarray((shapes / np.where(largest == 0, 1, largest)).real.astype(complex))


def _scaled_shapes(shapes: Any) -> Any:
    """Shapes (n_q, n_modes) scaled to 1 at their largest angle, while shapes of zeros stay.

    The pole of a controller that oscillates alone has such a shape.
    """
    moving = np.abs(shapes).max(axis=0, initial=0.0) > 0
    scaled = np.array(shapes)
    scaled[:, moving] = unit_shapes(scaled[:, moving])
    return scaled
