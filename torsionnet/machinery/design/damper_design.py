"""Search for damping and stiffness of dampers, within bounds, for which the largest vibration is smallest."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import scipy
from numpy.typing import ArrayLike

from torsionnet.base.entries.scalars import read_scalar
from torsionnet.base.entries.spec import EntryError
from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import Number
from torsionnet.base.units import parse_unit
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.linear.modes.natural_modes import modes
from torsionnet.linear.responses.grid import vibration_range
from torsionnet.linear.sensitivity.parametric import parametric_response
from torsionnet.linear.sensitivity.unknowns import Unknowns, unknowns
from torsionnet.machinery.design.damper_optimum import (
    EQUAL_PEAK_DIFFERENCE,
    DamperOptimum,
    DesignParameter,
    FixedPoint,
    LevelCurve,
    LevelPeak,
)
from torsionnet.machinery.design.levels import Levels, OrderLevels, ReceptanceLevels, VariedModel
from torsionnet.machinery.design.minimax import Box, largest, smallest_maximum
from torsionnet.machinery.orders.examined_speeds import ExaminedSpeeds
from torsionnet.machinery.orders.order_solution import orders_at_speeds
from torsionnet.model.channels import Sensor
from torsionnet.model.checks.parameter_units import parameter_units

DEFAULT_BOUNDS_FACTOR = 10.0
"""Factor on a parameter's value for the default bounds of a damper design, a tenth to ten times the value."""
EFFECT_POINTS = 33
"""Number of values between the bounds of one parameter for which the largest level is calculated, enough for a smooth
curve."""
FREE_FACTOR, LOCKED_FACTOR = 1e-6, 1e6
"""Factors on the best damping for a free damper, whose peaks stay finite, and for a locked one, in which nothing
slips."""
FIXED_POINT_SPREAD = 0.02
"""Spread of levels over dampings up to which a crossing of curves counts as a fixed point, 2 %, about the width of a
curve."""

Bounds = Mapping[str, Sequence[Any] | None]


def damper_design(
    drivetrain: AssembledModel,
    output: str | Sensor,
    parameters: str | Sequence[str] | Mapping[str, Sequence[float | str] | None],
    *,
    input: str | Sensor | None = None,
    band: tuple[float, float] | None = None,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitations: Iterable[str] | None = None,
) -> DamperOptimum:
    """Optimal damping and stiffness of dampers, with which the largest vibration is smallest.

    Parameters
    ----------
    output : str or Sensor
        What is to be small, as for :meth:`frequency_response`.
    parameters : str, sequence of str, or mapping
        Names of parameters or ``element.field``; in a mapping with (lower, upper) bounds in SI or with units. Those
        not given are the bounds in the model, else a tenth to ten times the value.
    input : str or Sensor, optional
        The largest magnitude of output over input within ``band`` is made small. Without it the largest half range
        of all orders over ``speeds``, under the model's excitations.
    band : (float, float), optional
        Hz; default: around all natural frequencies.
    speeds, speed_of, excitations
        As for :meth:`order_response`.

    Raises
    ------
    UsageError
        Unknown names, no bounds, or what goes only with the other question.

    Examples
    --------
    >>> import torsionnet as tn
    >>> crank = tn.Drivetrain("crank", [tn.Inertia("mass", node="a", inertia=2),
    ...     tn.Spring("shaft", nodes=("a", "ground"), stiffness=8e4),
    ...     tn.ViscousDamper("damper", node="a", ring_inertia=1, damping=100)])
    >>> found = crank.damper_design("a", {"damper.damping": (20, 2000)}, input="a")
    >>> round(float(found.values["damper.damping"]) / (2 * 1 * 200), 4)  # Den Hartog: sqrt(2/15)
    0.3651
    """
    names = [parameters] if isinstance(parameters, str) else list(parameters)
    if not names:
        raise UsageError("name at least one parameter to optimise, such as the damping of a damper")
    varied = unknowns(drivetrain, names)
    given = parameters if isinstance(parameters, Mapping) else {}
    units = sought_units(varied)
    start = np.array(varied.start)
    box = sought_box(varied, given, units)
    levels = levels_of(drivetrain, varied, output, input, band, speeds, speed_of, excitations)
    best = smallest_maximum(levels, box, start)
    sought = tuple(
        DesignParameter(name, unit, *numbers)
        for name, unit, *numbers in zip(names, units, start, box.lower, box.upper, best, strict=True)
    )
    damping = np.array([one.is_damping for one in sought])
    free, locked = (
        np.where(damping, factor * np.maximum(best, FREE_FACTOR * box.upper), best)
        for factor in (FREE_FACTOR, LOCKED_FACTOR)
    )
    cases = {"as given": start, "optimum": best}
    if damping.any():
        cases |= {"free": free, "locked": locked}
    films = [np.where(damping, values, best) for values in (box.lower, start, best, box.upper)]
    return DamperOptimum(
        levels.channel,
        levels.of,
        sought,
        highest_peaks(levels, start)[0],
        highest_peaks(levels, best)[0],
        highest_peaks(levels, best),
        {name: _effect(levels, box, best, place) for place, name in enumerate(names)},
        tuple(_curve(levels, label, values) for label, values in cases.items()),
        _fixed_points(levels, free, locked, films) if damping.any() and input is not None else (),
        drivetrain.title,
        range_notes(drivetrain.assembly, levels.frequencies),
    )


def levels_of(
    drivetrain: AssembledModel,
    varied: Unknowns,
    output: str | Sensor,
    input: str | Sensor | None,
    band: tuple[float, float] | None,
    speeds: ArrayLike | None,
    speed_of: str | None,
    excitations: Iterable[str] | None,
) -> Levels:
    """Vibration levels to be made small, over a band in Hz from an input, or over speeds under excitations."""
    if input is None:
        if band is not None:
            raise UsageError("a band of frequencies needs input=; without an input, give speeds instead")
        chosen = None if excitations is None else [*excitations]
        run = orders_at_speeds(drivetrain, output, speeds=speeds, speed_of=speed_of, excitations=chosen)
        examined = ExaminedSpeeds.of(drivetrain, speeds, speed_of=speed_of, excitations=chosen)
        return OrderLevels(VariedModel(varied), output, chosen, run, examined.refine)
    if speeds is not None or excitations is not None:
        raise UsageError(
            "speeds and excitations do not go with an input, which is swept over frequency; leave out one or the other"
        )
    low, high = band or vibration_range(modes(drivetrain))
    if not 0 < low < high < np.inf:
        raise UsageError(f"a band goes from a frequency above 0 to a higher one, got {low:g} to {high:g} Hz")
    response = parametric_response(drivetrain, output, input, [low, high], list(varied.names))
    if len(response.request.outputs) * len(response.request.measured) != 1:
        raise UsageError("one response is made small: name one output and one input")
    return ReceptanceLevels(response, (low, high))


def sought_units(varied: Unknowns) -> list[str]:
    """Units of the parameters sought by a damper design, in their order."""
    known = parameter_units(varied.definition)
    return [known[name] for name in varied.parameters]


def sought_box(varied: Unknowns, given: Bounds, units: Sequence[str]) -> Box:
    """Bounds (n_p,) in SI units of the parameters sought, as given, else from the model, else a decade to each side."""
    ends = []
    for name, parameter, start, unit in zip(varied.names, varied.parameters, varied.start, units, strict=True):
        written = given.get(name) or varied.definition.parameters[parameter].bounds
        if written is None and not start > 0:
            raise UsageError(f"{name} is {start:g}, which gives no default bounds; give a lower and a higher one")
        low, high = (
            (start / DEFAULT_BOUNDS_FACTOR, start * DEFAULT_BOUNDS_FACTOR)
            if written is None
            else _pair(name, written, unit)
        )
        if not (np.isfinite([low, high]).all() and low < high):
            raise UsageError(f"{name}: bounds are a lower and a higher value, got {low:g} and {high:g}")
        if low < 0:
            raise UsageError(f"{name}: a damper has no value below 0, got {low:g}")
        ends.append((low, high))
    lower, upper = np.array(ends, dtype=float).T
    return Box(lower, upper)


def _pair(name: str, written: Sequence[Any], unit: str) -> tuple[float, float]:
    if isinstance(written, str) or len(written) != 2:
        raise UsageError(f"{name}: bounds are two values, got {written!r}")
    low, high = (_number(name, one, unit) for one in written)
    return low, high


def _number(name: str, written: Any, unit: str) -> float:
    try:
        value = read_scalar(written)
    except EntryError as error:
        raise UsageError(f"{name}: {error}") from None
    if not isinstance(value, Number):
        raise UsageError(f"{name}: a bound is a number, got {written!r}")
    if value.unit_dimension is not None and value.unit_dimension != parse_unit(unit or "1").dimension:
        raise UsageError(f'{name}: "{written}" is not in {unit or "a plain number"}')
    return float(value.value)


def highest_peaks(levels: Levels, values: FloatArray) -> tuple[LevelPeak, ...]:
    """Peaks, as point and level, of the curve at parameter ``values`` within a thousandth of the highest one.

    Points are in the unit of display.
    """
    points = levels.maxima(values)
    sizes = levels.at(values, points)
    found = zip(levels.shown(points).tolist(), sizes.tolist(), strict=True)
    return tuple(LevelPeak(point, level) for point, level in found if level >= sizes[0] * (1 - EQUAL_PEAK_DIFFERENCE))


def _effect(levels: Levels, box: Box, best: FloatArray, place: int) -> FloatArray:
    """Parameter value in SI units and largest level there, over the range of one parameter's bounds, shape (n, 2)."""
    own = box.place(best)
    along = np.union1d(np.linspace(0.0, 1.0, EFFECT_POINTS), own[place])
    every = [box.inside(np.where(np.arange(len(own)) == place, x, own)) for x in along]
    return np.array([(values[place], largest(levels, values, refined=False)) for values in every])


def _curve(levels: Levels, label: str, values: FloatArray) -> LevelCurve:
    grid = levels.grid(values)
    return LevelCurve(label, levels.shown(grid), levels.at(values, grid))


def _fixed_points(
    levels: Levels, free: FloatArray, locked: FloatArray, films: Sequence[FloatArray]
) -> tuple[FixedPoint, ...]:
    """Fixed points (point, level, spread), highest first, where all dampings give nearly the same level.

    The dampings go from none to infinite.
    """

    def apart(points: FloatArray) -> FloatArray:
        return np.log(levels.at(free, points) / levels.at(locked, points))

    grid = np.union1d(levels.grid(free), levels.grid(locked))
    gap = apart(grid)
    found = []
    for place in np.flatnonzero(np.diff(np.sign(gap)) != 0):
        point = scipy.optimize.brentq(
            lambda f: float(apart(np.array([f]))[0]), grid[place], grid[place + 1], rtol=1e-12
        )
        sizes = np.concatenate([levels.at(values, np.array([point])) for values in (free, *films)])
        spread = float(sizes.max() / sizes.min() - 1)
        if spread < FIXED_POINT_SPREAD:
            found.append(FixedPoint(float(point), float(sizes.max()), spread))
    return tuple(sorted(found, key=lambda one: -one.level))
