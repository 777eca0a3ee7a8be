"""Search for damping and stiffness of dampers, within bounds, for which the largest vibration is smallest.

Drivetrain with the rings of its viscous dampers free, locked to the hub, or counted by half. Where natural frequencies
are quoted without damping, the ring of an untuned damper is left out (free), joined to the hub (locked), or half of its
inertia is put on the hub, which is where the film of best damping brings the resonance near.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, TypeVar

import numpy as np
import scipy
from numpy.typing import ArrayLike

from torsionnet.base.entries.scalars import read_scalar
from torsionnet.base.entries.spec import EntryError
from torsionnet.base.errors import UsageError, suggestion_or
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
from torsionnet.machinery.design.level_minimax import (
    Box,
    Levels,
    OrderLevels,
    ReceptanceLevels,
    VariedModel,
    largest,
    smallest_maximum,
)
from torsionnet.machinery.orders.order_solution import orders_at_speeds
from torsionnet.machinery.orders.refined_response import ExaminedSpeeds
from torsionnet.model.channels import Sensor
from torsionnet.model.checks.values import parameter_units
from torsionnet.model.configurations import known_elements
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.element import OtherLaws
from torsionnet.model.elements import Element, Law, Part, Values
from torsionnet.model.elements.dampers import ViscousDamper
from torsionnet.model.elements.gears import RigidCoupling
from torsionnet.model.elements.masses_and_springs import Inertia
from torsionnet.model.model import Model
from torsionnet.model.operating_values import running_notes

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
    excitation: str | Iterable[str] | None = None,
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
    >>> optimum = crank.damper_design("a", {"damper.damping": (20, 2000)}, input="a")
    >>> round(float(optimum.values["damper.damping"]) / (2 * 1 * 200), 4)  # Den Hartog: sqrt(2/15)
    0.3651
    """
    names = [parameters] if isinstance(parameters, str) else list(parameters)
    if not names:
        raise UsageError(
            "name at least one parameter to optimise, such as the damping of a damper", kind="missing-entry"
        )
    varied = unknowns(drivetrain, names)
    given = parameters if isinstance(parameters, Mapping) else {}
    units = sought_units(varied)
    start = np.array(varied.start)
    box = sought_box(varied, given, units)
    levels = levels_of(drivetrain, varied, output, input, band, speeds, speed_of, excitation)
    best = smallest_maximum(levels, box, start)
    sought = tuple(
        DesignParameter(name, unit, *numbers)
        for name, unit, *numbers in zip(names, units, start, box.lower, box.upper, best, strict=True)
    )
    damping = np.array([parameter.is_damping for parameter in sought])
    # c towards 0 frees the ring from its hub, c towards infinity locks the two together.
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
        tuple(
            replace(parameter, values=values, largest=sizes)
            for place, parameter in enumerate(sought)
            for values, sizes in [_effect(levels, box, best, place).T]
        ),
        highest_peaks(levels, start)[0],
        highest_peaks(levels, best)[0],
        highest_peaks(levels, best),
        tuple(_curve(levels, label, values) for label, values in cases.items()),
        _fixed_points(levels, free, locked, films) if damping.any() and input is not None else (),
        drivetrain.title,
        (*running_notes(drivetrain.definition), *range_notes(drivetrain.assembly, levels.frequencies)),
        drivetrain.configuration,
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
            raise UsageError(
                "a band of frequencies needs input=; without an input, give speeds instead", kind="missing-entry"
            )
        chosen = None if excitations is None else [*excitations]
        run = orders_at_speeds(drivetrain, output, speeds=speeds, speed_of=speed_of, excitations=chosen)
        examined = ExaminedSpeeds.of(drivetrain, speeds, speed_of=speed_of, excitations=chosen)
        return OrderLevels(VariedModel(varied), output, chosen, run, examined.refine)
    if speeds is not None or excitations is not None:
        raise UsageError(
            "speeds and excitations do not go with an input, which is swept over frequency; leave out one or the other",
            kind="contradicting-entries",
        )
    low, high = band or vibration_range(modes(drivetrain))
    if not 0 < low < high < np.inf:
        raise UsageError(
            f"a band goes from a frequency above 0 to a higher one, got {low:g} to {high:g} Hz", kind="unordered-rows"
        )
    response = parametric_response(drivetrain, output, input, [low, high], list(varied.names))
    if len(response.request.outputs) * len(response.request.inputs) != 1:
        raise UsageError("one response is made small: name one output and one input", kind="missing-entry")
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
            raise UsageError(
                f"{name} is {start:g}, which gives no default bounds; give a lower and a higher one",
                kind="missing-entry",
            )
        low, high = (
            (start / DEFAULT_BOUNDS_FACTOR, start * DEFAULT_BOUNDS_FACTOR)
            if written is None
            else _pair(name, written, unit)
        )
        if not (np.isfinite([low, high]).all() and low < high):
            raise UsageError(
                f"{name}: bounds are a lower and a higher value, got {low:g} and {high:g}", kind="unordered-rows"
            )
        if low < 0:
            raise UsageError(f"{name}: a damper has no value below 0, got {low:g}", kind="out-of-range")
        ends.append((low, high))
    lower, upper = np.array(ends, dtype=float).T
    return Box(lower, upper)


def _pair(name: str, written: Sequence[Any], unit: str) -> tuple[float, float]:
    if isinstance(written, str) or len(written) != 2:
        raise UsageError(f"{name}: bounds are two values, got {written!r}", kind="wrong-form")
    low, high = (_number(name, bound, unit) for bound in written)
    return low, high


def _number(name: str, written: Any, unit: str) -> float:
    try:
        value = read_scalar(written)
    except EntryError as error:
        raise UsageError(f"{name}: {error}", kind=error.fault.kind) from None
    if not isinstance(value, Number):
        raise UsageError(f"{name}: a bound is a number, got {written!r}", kind="not-a-number")
    if value.unit_dimension is not None and value.unit_dimension != parse_unit(unit or "1").dimension:
        raise UsageError(f'{name}: "{written}" is not in {unit or "a plain number"}', kind="wrong-unit")
    return float(value.value)


def highest_peaks(levels: Levels, values: FloatArray) -> tuple[LevelPeak, ...]:
    """Peaks, as point and level, of the curve at parameter ``values`` within a thousandth of the highest one.

    Points are in the unit of display.
    """
    points = levels.maxima(values)
    sizes = levels.sizes_at(values, points)
    peaks = zip(levels.shown(points).tolist(), sizes.tolist(), strict=True)
    return tuple(LevelPeak(point, level) for point, level in peaks if level >= sizes[0] * (1 - EQUAL_PEAK_DIFFERENCE))


def _effect(levels: Levels, box: Box, best: FloatArray, place: int) -> FloatArray:
    """Parameter value in SI units and largest level there, over the range of one parameter's bounds, shape (n, 2)."""
    own = box.place(best)
    along = np.union1d(np.linspace(0.0, 1.0, EFFECT_POINTS), own[place])
    every = [box.inside(np.where(np.arange(len(own)) == place, x, own)) for x in along]
    return np.array([(values[place], largest(levels, values, refined=False)) for values in every])


def _curve(levels: Levels, label: str, values: FloatArray) -> LevelCurve:
    grid = levels.grid(values)
    return LevelCurve(label, levels.shown(grid), levels.sizes_at(values, grid))


def _fixed_points(
    levels: Levels, free: FloatArray, locked: FloatArray, films: Sequence[FloatArray]
) -> tuple[FixedPoint, ...]:
    """Fixed points (point, level, spread), highest first, where all dampings give nearly the same level.

    The dampings go from none to infinite.
    """

    def apart(points: FloatArray) -> FloatArray:
        return np.log(levels.sizes_at(free, points) / levels.sizes_at(locked, points))

    grid = np.union1d(levels.grid(free), levels.grid(locked))
    # Den Hartog: curves of all dampings pass the points where those of c = 0 and c = infinity cross.
    gap = apart(grid)
    fixed = []
    for place in np.flatnonzero(np.diff(np.sign(gap)) != 0):
        point = scipy.optimize.brentq(
            lambda f: float(apart(np.array([f]))[0]), grid[place], grid[place + 1], rtol=1e-12
        )
        # With damping elsewhere the crossing is no fixed point in the strict sense: other dampings must agree there.
        sizes = np.concatenate([levels.sizes_at(values, np.array([point])) for values in (free, *films)])
        spread = float(sizes.max() / sizes.min() - 1)
        if spread < FIXED_POINT_SPREAD:
            fixed.append(FixedPoint(float(point), float(sizes.max()), spread))
    return tuple(sorted(fixed, key=lambda point: -point.level))


# Drivetrain with the rings of its viscous dampers free, locked to the hub, or counted by half.

AS_MODELLED = "as_modelled"
RING_SHARES = {"free": 0.0, "locked": 1.0, "half": 0.5}
"""Share of the ring's inertia that turns with the hub of a viscous damper, by state of the ring."""
STATES = (AS_MODELLED, *RING_SHARES)


def with_dampers(
    definition: Definition, values: Mapping[str, Any], state: str, names: Iterable[str] | None = None
) -> Definition:
    """Definition of a model with the rings of its viscous dampers in a given state.

    Parameters
    ----------
    state : str
        ``"as_modelled"``, ``"free"``, ``"locked"`` or ``"half"``.
    names : iterable of str, optional
        Elements of type viscous_damper, or the spring or damper that is the film between a hub and a ring; by default
        all elements of type viscous_damper.

    Raises
    ------
    UsageError
        No such state or element, no damper at all, or an element that is no film of a ring.
    """
    if state not in STATES:
        known = f"choose {', '.join(STATES)}"
        raise UsageError(f'"{state}" is no state of a damper{suggestion_or(state, STATES, known)}', kind="unknown-word")
    if state == AS_MODELLED:
        return definition
    active = {element.name: element for element in definition.active}
    chosen = [name for name, element in active.items() if isinstance(element, ViscousDamper)]
    if names is not None:
        chosen = known_elements(names, active)
    if not chosen:
        raise UsageError(
            "the model has no element of type viscous_damper; name the spring or damper that is the film",
            kind="not-applicable",
        )
    elements = dict(definition.elements)
    for name in chosen:
        damper = active[name]
        if isinstance(damper, ViscousDamper):
            elements[name] = _of_damper(damper, Values(values), RING_SHARES[state])
        else:
            elements |= _of_film(damper, active, Values(values), RING_SHARES[state])
    return replace(definition, elements=elements)


def _of_damper(damper: ViscousDamper, value: Values, share: float) -> Element:
    """Element with the inertia of a damper's hub and of a share of its ring."""
    inertia = float(value(damper.hub_inertia)) + share * float(value(damper.ring_inertia))
    return Inertia.from_entries(damper.name, node=damper.node, inertia=inertia, enabled=inertia > 0)


def _of_film(film: Element, active: Mapping[str, Element], value: Values, share: float) -> dict[str, Element]:
    """Elements in place of a damper's film and ring, by name.

    A rigid coupling or nothing, and the share of the ring.
    """
    hub, ring = _hub_and_ring(film, active)
    elements: dict[str, Element] = {}
    for element in active.values():
        if isinstance(element, Inertia) and element.node == ring:
            inertia = share * float(value(element.inertia))
            elements[element.name] = Inertia.from_entries(element.name, node=ring, inertia=inertia, enabled=share > 0)
        elif set(element.ports.values()) == {hub, ring}:
            elements[element.name] = replace(element, enabled=False)
    if share:
        elements[film.name] = RigidCoupling(film.name, nodes=(hub, ring))
    return elements


def _hub_and_ring(film: Element, active: Mapping[str, Element]) -> tuple[str, str]:
    ends = tuple(film.ports.values())
    rings = [node for node in ends if len(ends) == 2 and _is_ring(node, set(ends), active)]
    if len(rings) != 1:
        raise UsageError(
            f'"{film.name}" is no film of a damper: a film lies between a hub and a ring on which nothing else acts',
            kind="not-applicable",
        )
    (ring,) = rings
    return next(node for node in ends if node != ring), ring


def _is_ring(node: str, ends: set[str], active: Mapping[str, Element]) -> bool:
    """Whether a node carries only inertias and the film of a viscous damper."""
    there = [element for element in active.values() if node in element.ports.values()]
    only = all(isinstance(element, Inertia) or set(element.ports.values()) == ends for element in there)
    return only and any(isinstance(element, Inertia) for element in there)


# Viscous equivalent of hysteretic and tabulated laws, springs and dampers equal to them at one frequency.

AnyModel = TypeVar("AnyModel", bound=Model)


def viscous_equivalent(model: AnyModel, frequency: float) -> AnyModel:
    """Copy of a model with a spring Re kappa and a damper Im kappa/(2 pi f) in place of each law over frequency.

    At f the copy responds as the model does. Elsewhere its damping is c omega where that of the model was k eta:
    vibrations above f are damped too much and those below too little.

    Parameters
    ----------
    model : Drivetrain
    frequency : float
        Frequency f in Hz above zero, mostly that of the mode in question.

    Raises
    ------
    UsageError
        The frequency is not above zero, or a law is no spring there, as that of a long continuous shaft.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rubber = tn.HystereticSpring("rubber", nodes=("a", "ground"), stiffness=1000, loss_factor=0.1)
    >>> rig = tn.Drivetrain("rig", [tn.Inertia("disc", node="a", inertia=0.5), rubber])
    >>> round(float(viscous_equivalent(rig, 10).assembly.system.C[0, 0]), 6)  # 1000 * 0.1/(2 pi 10)
    1.591549
    """
    if not 0 < frequency < float("inf"):
        raise UsageError(
            f"a viscous equivalent holds at a frequency above 0 Hz, got {frequency:g}", kind="out-of-range"
        )
    values, elements = Values(model.exact_values), dict(model.definition.elements)
    for name, element in elements.items():
        if any(isinstance(part, Law) and _is_over_frequency(part) for part in element.parts(values)):
            laws = ViscousLaws(element, Fraction(repr(float(frequency))))
            laws.parts(values)  # refuses what has no equivalent
            elements[name] = element.with_laws(laws)
    return model.with_definition(replace(model.definition, elements=elements))


def _is_over_frequency(law: Law) -> bool:
    return law.table is not None or law.loss_factor != 0


@dataclass(frozen=True)
class ViscousLaws(OtherLaws):
    """Laws of an element with constant coefficients at a frequency in Hz."""

    frequency: Fraction

    def parts(self, value: Values) -> tuple[Part, ...]:
        return tuple(
            self._viscous(part, value) if isinstance(part, Law) and _is_over_frequency(part) else part
            for part in self.element.parts(value)
        )

    def _viscous(self, law: Law, value: Values) -> Law:
        omega = value.algebra.pi * value.algebra.number(2 * self.frequency)
        # kappa = k (1 + j eta) becomes k + j omega c with c = k eta/omega at this frequency.
        stiffness, lost = law.stiffness, law.stiffness * law.loss_factor
        if law.table is not None:
            import numpy as np

            table = law.table.with_coefficients(*map(float, law.table.coefficients))
            kappa = complex(table.kappa(np.array([2 * np.pi * float(self.frequency)]))[0])
            # A negative stiffness is the mass of a long continuous shaft, for which no spring can stand.
            if kappa.real < 0:
                at = f"{self.element.name}: at {float(self.frequency):g} Hz the stiffness is {kappa.real:.6g} N m/rad"
                rest = "a continuous shaft may be given as type: shaft with segments"
                raise UsageError(f"{at}, which no spring has; {rest}", kind="not-applicable")
            stiffness = stiffness + value.algebra.number(Fraction(kappa.real))
            lost = lost + value.algebra.number(Fraction(kappa.imag))
        return replace(law, stiffness=stiffness, damping=law.damping + lost / omega, loss_factor=0, table=None)
