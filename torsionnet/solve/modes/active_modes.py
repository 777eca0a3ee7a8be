"""Modes of a drivetrain that controllers or negative damping act on: poles of any sign, those of the laws among them.

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

from torsionnet.assembly.rows import ComplexArray, FloatArray, RowSystem
from torsionnet.assembly.system import Assembly
from torsionnet.core.errors import UsageError
from torsionnet.model.element_base.dynamic_stiffness import ComplexStiffness
from torsionnet.solve.dynamic_stiffness.reduction import require_resistance
from torsionnet.solve.modes.active_digits import DIGITS, ManyDigitPencil
from torsionnet.solve.modes.active_pencil import EPS, ActivePencil
from torsionnet.solve.modes.active_starts import FIRM, Pole, slow_starts, upper_starts
from torsionnet.solve.modes.eigen import (
    OSCILLATORY,
    REAL,
    RIGID,
    EigenSolution,
    complex_modes,
    on_axis,
    scaled,
    undamped_modes,
)

SMALL = 150
"""Coordinates and controllers up to which every pole is settled on the characteristic equation, and counted."""
COUNTED = 200
"""Those up to which poles in a circle are counted."""
LARGEST_LOOSE = 1e-3
"""Share of the radius above which what is not firm is a pole of the delay that so few points do not resolve."""
MOST_POINTS = 160
FEWEST_POINTS = 20
PER_RADIAN = 0.75
"""Points of a delay per radian that the fastest motion turns in it."""
SAME = 1e-7
REAL_BELOW = 1e-10
BLURRED = 1e-11
"""Relative error from which on a pole is settled in many digits."""
MOST_WORK = 3e5
"""Cube of the coordinates times poles that are."""
LOSS_STEPS = 8
"""Shares of the loss factors by which poles are led from elastic springs to hysteretic ones."""


def is_active(system: RowSystem) -> bool:
    """Whether energy may be fed into the drivetrain, so that nothing says on which side poles lie."""
    return bool(system.actions) or bool((system.damping < 0).any())


def active_modes(assembly: Assembly) -> tuple[EigenSolution, tuple[str, ...], tuple[str, ...]]:
    """Modes, what is doubtful about them, and notes.

    Raises
    ------
    UsageError
        Frequency-dependent laws beside the actions.
    SolveError
        Some coordinates have neither inertia nor spring nor damper.
    """
    system = assembly.system
    if system.dynamic:
        return _with_hysteresis(assembly)
    require_resistance(system, (system.inertia != 0) | (system.damping != 0) | (system.stiffness != 0))
    pencil = ActivePencil(assembly)
    delay = max((float(one.delay) for one in system.actions), default=0.0)
    poles, doubts, notes = _delayed(pencil, delay) if delay else _rational(pencil)
    poles = _sharpened(assembly, poles)
    return _solution(sorted(poles, key=lambda pole: abs(pole.value)), pencil.standing), doubts, notes


def _with_hysteresis(assembly: Assembly) -> tuple[EigenSolution, tuple[str, ...], tuple[str, ...]]:
    """Modes with springs of a loss factor, which does nothing to what does not vibrate.

    Raises
    ------
    UsageError
        A stiffness varies with frequency.
    """
    system = assembly.system
    varying = [assembly.owners[law] for law, one in system.dynamic if not isinstance(one, ComplexStiffness)]
    if varying:
        names = ", ".join(dict.fromkeys(varying))
        text = f"modes with controllers are not worked out where a stiffness varies with frequency: {names}"
        raise UsageError(f"{text}; a continuous shaft may be given as type: shaft with segments")
    springs = system.stiffness + system.kappa(1.0).real
    elastic = replace(assembly, system=replace(system, dynamic=(), stiffness=springs))
    solution, doubts, notes = active_modes(elastic)
    poles, lost = [], 0
    pencil = ActivePencil(elastic)
    for number, kind in enumerate(solution.kinds):
        value, shape = complex(solution.eigenvalues[number]), solution.vectors[:, number]
        pole = Pole(value, pencil.completed(value, shape), float(solution.errors[number]))
        if kind == OSCILLATORY:
            met = _led(elastic, system.kappa(1.0).imag, pole)
            lost += met is None
            pole = met or pole
        if kind != RIGID:
            poles.append(pole)
    if lost or len(_apart(poles)) < len(poles):
        doubts = (*doubts, "with loss factors, some modes could not be told apart beside the controllers")
    rigid = solution.vectors[:, [kind == RIGID for kind in solution.kinds]].real
    return _solution(sorted(poles, key=lambda pole: abs(pole.value)), rigid), doubts, notes


def _led(elastic: Assembly, loss: FloatArray, pole: Pole) -> Pole | None:
    """The pole followed as the losses k eta (n_laws,) of all laws grow from nothing."""
    value, vector, error = pole.value, pole.vector, pole.error
    for share in np.linspace(0, 1, LOSS_STEPS + 1)[1:]:
        met = ActivePencil(elastic, share * loss).settled(value, vector)
        if met is None or met[0].imag <= 0:
            return None
        value, vector, error = met
    return Pole(value, vector, max(error, EPS))


def _apart(poles: Sequence[Pole]) -> list[Pole]:
    """Those that are not the same as one before, of equal shape."""
    found: list[Pole] = []
    for pole in poles:
        if all(abs(pole.value - other.value) > SAME * abs(pole.value) or _differ(pole, other) for other in found):
            found.append(pole)
    return found


def _differ(one: Pole, other: Pole) -> bool:
    a, b = one.vector, other.vector
    return bool(abs(a.conj() @ b) < (1 - SAME) * np.linalg.norm(a) * np.linalg.norm(b))


def _rational(pencil: ActivePencil) -> tuple[list[Pole], tuple[str, ...], tuple[str, ...]]:
    """All poles other than zero."""
    starts = upper_starts(pencil, 0)
    total = sum(pole.count for pole in starts)
    small = pencil.size <= SMALL
    firm, loose = [], []
    for start in starts:
        met = (_settled(pencil, start) if small else start) if start.error < FIRM else None
        firm += [met] if met else []
        loose += [] if met else [start]
    left = total - pencil.zeros - sum(pole.count for pole in firm)
    if left:
        for pole in _distinct(pencil, [*slow_starts(pencil, loose), *loose]):
            if pole.count <= left and all(abs(pole.value - other.value) > SAME * abs(pole.value) for other in firm):
                firm.append(pole)
                left -= pole.count
    if left:  # two that meet are no simple roots
        for pole in sorted(loose, key=lambda one: one.error):
            if pole.count <= left and pole.error < 1:
                firm.append(pole)
                left -= pole.count
    if not small:
        return firm, _told(total, total - left), ()
    count, zeros = pencil.counts()
    return firm, (*_told(zeros, pencil.zeros, " at zero"), *_told(count, total - left)), ()


def _told(counted: int, found: int, where: str = "") -> tuple[str, ...]:
    return () if counted == found else (f"{counted} poles{where} were counted, but {found} found",)


def _settled(pencil: ActivePencil, pole: Pole) -> Pole | None:
    """The pole on the exact equation; None where the start runs away."""
    found = pencil.settled(pole.value, pole.vector)
    if found is None or abs(found[0] - pole.value) > max(1e-3, 100 * pole.error) * abs(pole.value):
        return None
    value = complex(found[0].real, 0.0) if pole.is_real else found[0]
    return Pole(value, found[1], min(found[2], max(pole.error, EPS)))


def _sharpened(assembly: Assembly, poles: Sequence[Pole]) -> list[Pole]:
    """Poles that rounding blurs, as slow ones of stiff drivetrains, in many digits; as many as time allows."""
    size = assembly.system.n_coordinates + len(assembly.system.actions)
    most = int(MOST_WORK // max(size, 1) ** 3)
    blurred = sorted((pole.error, place) for place, pole in enumerate(poles) if pole.error > BLURRED)[::-1][:most]
    if not blurred:
        return list(poles)
    import mpmath

    found = list(poles)
    with mpmath.workdps(DIGITS):
        exact = ManyDigitPencil(assembly)
        for error, place in blurred:
            pole = found[place]
            met = exact.settled(pole.value, pole.vector)
            if met is not None and abs(met[0] - pole.value) <= max(0.1, 10 * error) * abs(pole.value):
                value = complex(met[0].real, 0.0) if pole.is_real else met[0]
                found[place] = Pole(value, met[1], EPS)
    return found


# --- delays --------------------------------------------------------------------------------------------------------


def _delayed(pencil: ActivePencil, delay: float) -> tuple[list[Pole], tuple[str, ...], tuple[str, ...]]:
    """All poles within a circle that holds those of the laws, if it may be so wide; of others those of the laws."""
    system = pencil.assembly.system
    passive = replace(system, actions=())
    free = complex_modes(passive) if not is_active(passive) else None
    sizes = (
        np.abs(free.eigenvalues) if free else undamped_modes(replace(passive, damping=np.zeros_like(system.damping)))[0]
    )
    widest = (MOST_POINTS - FEWEST_POINTS) / (PER_RADIAN * delay)
    radius = min(1.3 * max([float(sizes.max(initial=0.0)), *(_corner(pencil)), 6 / delay]), widest)
    starts = upper_starts(pencil, FEWEST_POINTS + math.ceil(PER_RADIAN * radius * delay))
    loose = [pole for pole in starts if pole.error >= FIRM and abs(pole.value) <= LARGEST_LOOSE * radius]
    tried = [*starts, *slow_starts(pencil, loose)]
    near = _distinct(pencil, [pole for pole in tried if abs(pole.value) <= 1.2 * radius])
    radius = _between(radius, [abs(pole.value) for pole in near])
    inside = [pole for pole in near if abs(pole.value) < radius]
    counted = pencil.within(radius) if pencil.size <= COUNTED else None
    found = pencil.zeros + sum(pole.count for pole in inside)
    below = f"{radius / (2 * np.pi):.4g} Hz"
    if counted is None:
        doubts: tuple[str, ...] = (f"with the delay, the poles below {below} could not be counted",)
    elif counted != found:
        doubts = (f"with the delay, {counted} poles lie below {below}, but {found} were found",)
    else:
        doubts = ()
    if pencil.size <= SMALL:
        doubts = (*doubts, *_told(pencil.counts()[1], pencil.zeros, " at zero"))
    beyond = [] if free is None else _beyond(pencil, free, radius)
    known = "may lack some here" if doubts else "are all here"
    text = f"a delay makes infinitely many poles; those below {below} {known}"
    notes = (f"{text}, and of faster ones those next to modes without control" if beyond else text,)
    return inside + beyond, doubts, notes


def _corner(pencil: ActivePencil) -> list[float]:
    """Sizes of the poles of the laws of controllers."""
    found = []
    for action in pencil.assembly.system.actions:
        roots = np.roots([float(value) for value in reversed(action.denominator)])
        found += [float(abs(root)) for root in roots]
    return found


def _distinct(pencil: ActivePencil, starts: Sequence[Pole]) -> list[Pole]:
    """Poles that starts lead to, each once."""
    found: list[Pole] = []
    for start in starts:
        met = pencil.settled(start.value, start.vector)
        if met is None:
            continue
        value = met[0]
        if abs(value.imag) <= REAL_BELOW * abs(value):
            value = complex(value.real, 0.0)
        pole = Pole(complex(value.real, abs(value.imag)), met[1] if value.imag >= 0 else met[1].conj(), met[2])
        if all(abs(pole.value - other.value) > SAME * abs(pole.value) for other in found):
            found.append(pole)
    return found


def _between(radius: float, sizes: Sequence[float]) -> float:
    """A radius near this one, in the widest gap between sizes."""
    marks = sorted([0.8 * radius, *(size for size in sizes if 0.8 * radius < size < radius), radius])
    gaps = [(b / a, math.sqrt(a * b)) for a, b in pairwise(marks)]
    return max(gaps)[1]


def _beyond(pencil: ActivePencil, free: EigenSolution, radius: float) -> list[Pole]:
    """Poles outside of the circle that modes without control lead to."""
    n_act = pencil.size - pencil.n_coordinates
    starts = [
        Pole(complex(value), np.concatenate([free.vectors[:, number], np.zeros(n_act)]), 0.0)
        for number, value in enumerate(free.eigenvalues)
        if abs(value) >= radius
    ]
    found = _distinct(pencil, starts)
    return [pole for pole in found if abs(pole.value) >= radius and abs(pole.value) > 0]


# --- results ----------------------------------------------------------------------------------------------------


def _solution(poles: Sequence[Pole], rigid: FloatArray) -> EigenSolution:
    count, n_rigid, n = len(poles), rigid.shape[1], len(rigid)
    values = on_axis(np.array([pole.value for pole in poles], dtype=complex), np.array([pole.error for pole in poles]))
    shapes = np.array([pole.vector[:n] for pole in poles], dtype=complex).reshape(count, n).T
    real = [pole.is_real for pole in poles]
    shapes[:, real] = _turned_real(shapes[:, real])
    zeros = np.zeros(n_rigid)
    return EigenSolution(
        eigenvalues=np.concatenate([zeros, values]).astype(complex),
        vectors=np.hstack([_scaled(rigid), _scaled(shapes)]).astype(complex),
        kinds=(RIGID,) * n_rigid + tuple(REAL if one else OSCILLATORY for one in real),
        converged=np.ones(n_rigid + count, dtype=bool),
        iterations=np.concatenate([zeros, np.ones(count)]).astype(int),
        errors=np.concatenate([zeros, [pole.error for pole in poles]]),
    )


def _turned_real(shapes: ComplexArray) -> ComplexArray:
    largest = shapes[np.argmax(np.abs(shapes), axis=0), np.arange(shapes.shape[1])] if shapes.size else np.ones(0)
    return np.asarray((shapes / np.where(largest == 0, 1, largest)).real.astype(complex))


def _scaled(shapes: Any) -> Any:
    """As elsewhere; a controller that swings by itself moves nothing."""
    moving = np.abs(shapes).max(axis=0, initial=0.0) > 0
    found = np.array(shapes)
    found[:, moving] = scaled(found[:, moving])
    return found
