"""Stability margins of a controlled drivetrain, from the loop opened at a controller."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.packages import SavedResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.action_laws import ActionLaw
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import law_stiffness
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.quotient import respond
from torsionnet.linear.dynamic_stiffness.response_problem import make_reading_problem
from torsionnet.linear.modes.natural_modes import natural_modes

STABLE_NOTE = "the drivetrain is stable"
"""Text of the note below the table of stability margins of a stable drivetrain."""
UNSTABLE_NOTE = (
    "the closed loop is unstable, so these are no margins: they say where a pole would reach the imaginary axis"
)
"""Text of the note below the table of stability margins of an unstable drivetrain."""
_STABLE_ROWS = ("gain may grow by the factor", "gain may fall to the factor", "phase margin", "delay margin")
_UNSTABLE_ROWS = ("gain grown by the factor", "gain fallen to the factor", "phase lag added", "delay added")


@dataclass(frozen=True)
class Margin:
    """Gain (factor), phase (deg), delay (s) or modulus margin of a loop, and its frequency in Hz; nan for none."""

    value: float = math.nan
    frequency: Annotated[float, Out(json="frequency_Hz")] = math.nan


@dataclass(frozen=True, eq=False, repr=False)
class LoopMargins(SavedResult):
    """Open loop L(j omega), without unit, at a controller's torque, all other loops closed, and its stability margins.

    The drivetrain with the loop closed has its poles where 1 + L(s) = 0: L is the torque of the controller, with the
    sign of negative feedback, in response to 1 N m applied in its place.

    Attributes
    ----------
    controller : str
    frequencies : (n,) array
        Frequencies, Hz.
    loop : (n,) complex array
        Open loop L at the frequencies.
    stable : bool
        Whether no mode grows. For an unstable drivetrain the values below are no margins: they say where a pole reaches
        the imaginary axis, which need not be the unstable one.
    gain_increase, gain_decrease : Margin
        Factors > 1 and < 1 of the gain of the controller at which a pole reaches the imaginary axis.
    phase : Margin
        Smallest phase margin in degrees: lag (lead if negative) that L may gain where its magnitude is 1.
    delay : Margin
        Additional delay in s at which a pole reaches the imaginary axis.
    modulus : Margin
        Smallest distance of L from -1.
    title : str
    """

    picture: ClassVar[str] = "nyquist"
    SHOWN: ClassVar = (
        "title", "controller", "stable", "gain_increase", "gain_decrease", "phase", "delay", "modulus",
    )  # fmt: skip

    controller: str
    frequencies: NDArray[np.float64]
    loop: NDArray[np.complex128]
    stable: bool
    gain_increase: Margin
    gain_decrease: Margin
    phase: Annotated[Margin, Out(json="phase_deg")]
    delay: Annotated[Margin, Out(json="delay_s")]
    modulus: Margin
    title: str = ""

    def table(self) -> Table:
        """Table of stability margins of a loop, if unstable of changes to a pole on the axis, and frequencies in Hz."""
        names, what, note = (
            (_STABLE_ROWS, "margin", STABLE_NOTE)
            if self.stable
            else (_UNSTABLE_ROWS, "a pole reaches the axis with", UNSTABLE_NOTE)
        )
        rows = (
            (names[0], self.gain_increase.value, "1", self.gain_increase.frequency),
            (names[1], self.gain_decrease.value, "1", self.gain_decrease.frequency),
            (names[2], self.phase.value, "deg", self.phase.frequency),
            (names[3], 1e3 * self.delay.value, "ms", self.delay.frequency),
            ("smallest |1 + L|", self.modulus.value, "1", self.modulus.frequency),
        )
        columns = (Column(what), Column("value"), Column("unit"), Column("at", "Hz"))
        shown = tuple(tuple(None if cell != cell else cell for cell in row) for row in rows)
        title = f"{self.title}: loop opened at {self.controller}"
        return Table(title if self.stable else f"{title}, UNSTABLE when closed", columns, shown, (note,))


# Stability margins of a controlled drivetrain, from its exact open loop with delays and without a fit.

GRID_POINTS, POINTS_BESIDE_MARK = 2000, 60
"""Number of frequencies of the open loop over its range, and to each side of a resonance, enough to find narrow
crossings."""
BISECTIONS = 50
"""Number of bisections of an interval in which the loop crosses a margin, 50 to reach the spacing of double
precision."""


def loop_margins(drivetrain: AssembledModel, controller: str | None = None) -> LoopMargins:
    """Stability margins of the loop opened at a controller, and its frequency response for Nyquist's plot.

    Gain, phase, delay and modulus margins, each with its frequency, all other loops being closed; delays are exact.
    :func:`torsionnet.plot.nyquist` draws it.

    Parameters
    ----------
    controller : str, optional
        Name of the element; default: the only one.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.Drivetrain("governed", [tn.Inertia("rotor", node="a", inertia=2),
    ...     tn.Controller("governor", sense={"velocity": "a"}, act="a", law=-30, delay="50 ms")])
    >>> margins = rig.loop_margins()
    >>> round(margins.gain_increase.value, 4), round(margins.phase.value, 3), round(margins.delay.value, 6)
    (2.0944, 47.028, 0.05472)
    """
    actions = drivetrain.assembly.system.actions
    name = _chosen(drivetrain, controller, actions)
    place = [action.owner for action in actions].index(name)
    modes, _ = natural_modes(drivetrain)
    frequencies = _frequencies(modes.undamped_natural_frequencies, np.abs(modes.eigenvalues) / (2 * np.pi), actions)

    def at(f: FloatArray) -> ComplexArray:
        return open_loop(drivetrain, place, f)

    loop = at(frequencies)
    finite = np.isfinite(loop)
    frequencies, loop = frequencies[finite], loop[finite]
    # |L| = 1 for the phase margin, Im L = 0 for the gain margins.
    crossings = _met(at, frequencies, loop, lambda value: np.abs(value) - 1)
    phase_crossings = _met(at, frequencies, loop, lambda value: np.asarray(value.imag))
    return LoopMargins(
        name, frequencies, loop, not bool((modes.eigenvalues.real > 0).any()),
        *_gains(phase_crossings, at(phase_crossings)), *_phases(crossings, at(crossings)),
        _modulus(at, frequencies, loop),
        drivetrain.title,
    )  # fmt: skip


def _chosen(drivetrain: AssembledModel, name: str | None, actions: tuple[ActionLaw, ...]) -> str:
    known = list(dict.fromkeys(action.owner for action in actions))
    if not known:
        raise UsageError(
            "stability margins need a controller, fluid coupling or other feedback; this drivetrain has none",
            kind="missing-entry",
        )
    if name is None:
        if len(known) > 1:
            raise UsageError(f"there are several controllers; name one of {', '.join(known)}", kind="ambiguous-name")
        return known[0]
    if name not in known:
        there = "is no controller" if name in drivetrain.elements else "is not in this drivetrain"
        raise UsageError(
            f'"{name}" {there}{did_you_mean(name, known)}; known: {", ".join(known)}', kind="unknown-element"
        )
    if sum(action.owner == name for action in actions) > 1:
        raise UsageError(
            f"{name} acts at several places at once, so its loop cannot be opened at one; choose another controller",
            kind="unsupported-law",
        )
    return name


def open_loop(drivetrain: AssembledModel, place: int, frequencies: FloatArray) -> ComplexArray:
    """Open loop L (n_f,), a pure number, at the action of this number for frequencies in Hz.

    All other loops are closed.
    """
    assembly = drivetrain.assembly
    reading_problem = make_reading_problem(assembly, (), (), ())
    laws = law_stiffness([assembly.system], 2 * np.pi * frequencies)
    values = respond(reading_problem.problem, laws)
    gains = np.array([gain.ravel() for gain in laws.actions])
    with np.errstate(all="ignore"):
        # Torque of every action per unit torque of every other, with all loops open.
        by_torque = np.moveaxis(gains[:, None, :] * values[list(reading_problem.sensed)], 2, 0)
        others = [number for number in range(len(gains)) if number != place]
        own = by_torque[:, place, place]
        if not others:
            return np.asarray(-own)
        # The other loops closed: L = -(l_pp + l_po (I - l_oo)^-1 l_op)
        rest = np.eye(len(others)) - by_torque[np.ix_(range(len(own)), others, others)]
        back = by_torque[:, place, others][:, None, :] @ np.linalg.solve(rest, by_torque[:, others, place][:, :, None])
    return np.asarray(-own - back[:, 0, 0])


def _frequencies(undamped: FloatArray, damped: FloatArray, actions: tuple[ActionLaw, ...]) -> FloatArray:
    """Frequencies (n,) in Hz for an open loop, dense around every resonance with and without loops closed."""
    marks = [float(f) for f in (*undamped, *damped) if f > 0]
    for action in actions:
        roots = np.roots([float(value) for value in reversed(action.denominator)])
        marks += [float(abs(root)) / (2 * math.pi) for root in roots if root]
        marks += [1 / (2 * math.pi * float(action.delay))] if action.delay else []
    marks = marks or [1.0]
    whole = np.geomspace(min(marks) / 1000, max(marks) * 100, GRID_POINTS)
    aside = np.concatenate(
        [-np.geomspace(0.3, 1e-7, POINTS_BESIDE_MARK), [0.0], np.geomspace(1e-7, 0.3, POINTS_BESIDE_MARK)]
    )
    return np.unique(np.concatenate([whole, *(mark * (1 + aside) for mark in marks)]))


def _met(
    at: Callable[[FloatArray], ComplexArray], f: FloatArray, loop: ComplexArray,
    what: Callable[[ComplexArray], NDArray[np.float64]],
) -> FloatArray:  # fmt: skip
    """Frequencies (n,) in Hz at which a real property of the open loop changes its sign, by bisection."""
    sign = np.sign(what(loop))
    places = np.flatnonzero(sign[:-1] * sign[1:] < 0)
    low, high, below = f[places], f[places + 1], sign[places]
    for _ in range(BISECTIONS if len(places) else 0):
        middle = (low + high) / 2
        same = np.sign(what(at(middle))) == below
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return np.asarray((low + high) / 2)


def _gains(f: FloatArray, loop: ComplexArray) -> tuple[Margin, Margin]:
    # k L = -1 where L is real
    with np.errstate(all="ignore"):
        factors = -1 / loop.real
    real = np.isfinite(factors) & (factors > 0) & (np.abs(loop.imag) < 1e-6 * np.abs(loop))
    up, down = real & (factors > 1), real & (factors < 1)
    return _best(factors, f, up, np.argmin), _best(factors, f, down, np.argmax)


def _phases(f: FloatArray, loop: ComplexArray) -> tuple[Margin, Margin]:
    """Phase margin in degrees and delay margin in s, the least that turn a loop of magnitude one into -1."""
    every = np.isclose(np.abs(loop), 1, rtol=1e-6)
    # Angle by which L lies before -1, and the delay that turns it so far at f, by a lag alone.
    angle = np.degrees(np.angle(-loop))
    with np.errstate(all="ignore"):
        delay = np.mod(angle, 360) / (360 * f)
    place = _best(np.abs(angle), f, every, np.argmin)
    smallest = angle[np.flatnonzero(every)[np.argmin(np.abs(angle[every]))]] if every.any() else math.nan
    return Margin(float(smallest), place.frequency), _best(delay, f, every, np.argmin)


def _best(
    values: FloatArray, f: FloatArray, some: NDArray[np.bool_], choose: Callable[[FloatArray], np.intp]
) -> Margin:
    if not some.any():
        return Margin()
    place = np.flatnonzero(some)[choose(values[some])]
    return Margin(float(values[place]), float(f[place]))


def _modulus(at: Callable[[FloatArray], ComplexArray], f: FloatArray, loop: ComplexArray) -> Margin:
    """Modulus margin, the smallest distance of L from -1, and its frequency in Hz, refined around the closest point."""
    place = int(np.argmin(np.abs(1 + loop)))
    low, high = f[max(place - 1, 0)], f[min(place + 1, len(f) - 1)]
    for _ in range(6):
        fine = np.linspace(low, high, 41)
        distance = np.abs(1 + at(fine))
        place = int(np.nanargmin(distance))
        low, high = fine[max(place - 1, 0)], fine[min(place + 1, 40)]
    return Margin(float(distance[place]), float(fine[place]))
