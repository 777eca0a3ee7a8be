"""Sliders of the explore page, with unit, value and range of every parameter of a model."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.spec import Json
from torsionnet.base.errors import TorsionnetError
from torsionnet.base.expressions import Expression, Number
from torsionnet.base.units import NUMERAL, UnitError, parse_unit
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.changes import LOAD_SIZES, SPEED, TORQUE, is_point_setting, setting_name
from torsionnet.model.checks.values import parameter_units
from torsionnet.model.definition import Definition, Tangents
from torsionnet.model.kinematics import exact_row
from torsionnet.model.law_network import LawNetwork, PlacedMotionLaw, keeps_own_point, law_network
from torsionnet.model.operating_point import torque_place
from torsionnet.model.parameters import Parameter

RANGE_FACTOR = 10.0
"""Factor from the value of a parameter without bounds to both ends of its slider, a decade up and down."""


@dataclass(frozen=True)
class Slider:
    """Slider of a model's parameter with value and range in ``unit``, the one written in the model.

    Attributes
    ----------
    name, description : str
    unit : str
        What is written behind a value; empty for a bare number.
    shown_unit : str
        The same, or the SI unit of a bare number by the places where it is used.
    si : float
        Value in SI.
    value, default : float
        Now, and in the configuration as the file has it.
    low, high : float
        Ends of the slider.
    logarithmic : bool
        Whether equal distances on the slider are equal factors; both ends have the same sign.
    changed : bool
    expression : str
        Of a derived parameter, which follows others and has no slider, or what one follows with the operating point;
        else empty.
    remark : str
        Words beside the slider, as on a torque that follows another one.
    """

    name: str
    description: str
    unit: str
    shown_unit: str
    si: float
    value: float
    default: float
    low: float
    high: float
    logarithmic: bool
    changed: bool
    expression: str
    remark: str = ""

    def to_data(self) -> dict[str, Json]:
        return asdict(self)


def sliders(plain: Drivetrain, changed: Drivetrain, values: Mapping[str, Any]) -> list[Slider]:
    """Sliders of all parameters of the model, in the order of its file.

    Parameters
    ----------
    plain : Drivetrain
        In the configuration chosen.
    changed : Drivetrain
        In that configuration with ``values``.
    values : mapping
        Parameter -> value given by hand.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("dmf_rig")
    >>> one = sliders(rig, rig.configured(k_1="15 kN*m/rad"), {"k_1": "15 kN*m/rad"})[2]
    >>> one.name, one.value, one.default, one.unit, one.low, one.high
    ('k_1', 15.0, 13.3, 'kN*m/rad', 1.33, 133.0)
    """
    units = parameter_units(plain.definition)
    return [_slider(name, plain, changed, units, is_changed=name in values) for name in plain.parameter_definitions]


def _slider(name: str, plain: Drivetrain, changed: Drivetrain, units: Mapping[str, str], *, is_changed: bool) -> Slider:
    own = plain.parameter_definitions[name]
    follows = own.by is not None
    derived = follows or changed.parameter_definitions[name].is_derived
    unit = "" if derived or own.is_derived else written_unit(own.value)
    shown = unit or units[name]
    factor = parse_unit(unit).factor if unit else Fraction(1)
    default, value = _over(plain.exact_values[name], factor), _over(changed.exact_values[name], factor)
    low, high = _range(name, plain, units, float(factor))
    low, high = min(low, value), max(high, value)
    return Slider(
        name=name,
        description=own.description,
        unit=unit,
        shown_unit=shown,
        si=changed.parameters[name],
        value=value,
        default=default,
        low=low,
        high=high,
        logarithmic=low > 0 or high < 0,
        changed=is_changed,
        expression=_followed(own) if follows else str(changed.parameter_definitions[name].value) if derived else "",
    )


def _followed(own: Parameter) -> str:
    """Words for the operating point that a parameter follows, as ``by load of propeller``."""
    return f"by {str(own.by).replace('_', ' ')}" + (f" of {own.of}" if own.of else "")


def written_unit(value: Expression) -> str:
    """Text of the unit behind a parameter's number in the model file; empty where none is written.

    >>> from torsionnet.base.expression_reading import scalar
    >>> written_unit(scalar("0.46 kN*m/rad")), written_unit(scalar(3))
    ('kN*m/rad', '')
    """
    if not isinstance(value, Number) or value.text is None or value.unit_dimension is None:
        return ""
    numeral = NUMERAL.match(value.text.strip())
    unit = value.text.strip()[numeral.end() :].strip() if numeral else ""
    try:
        return unit if unit and parse_unit(unit) else ""
    except UnitError:
        return ""


def _over(value: Any, factor: Any) -> float:
    """Value in SI over the factor of its unit, exact where both are fractions, so that 0.46 kN*m/rad stays 0.46."""
    exact = isinstance(value, int | Fraction) and isinstance(factor, Fraction)
    return float(Fraction(value) / factor) if exact else float(value) / float(factor)


def _range(name: str, plain: Drivetrain, units: Mapping[str, str], factor: float) -> tuple[float, float]:
    bounds = plain.parameter_definitions[name].bounds
    if bounds:
        return bounds[0] / factor, bounds[1] / factor
    value = plain.parameters[name] / factor
    if value:
        ends = (value / RANGE_FACTOR, value * RANGE_FACTOR)
        return min(ends), max(ends)
    return 0.0, _size(name, plain, units) / factor


def _size(name: str, plain: Drivetrain, units: Mapping[str, str]) -> float:
    """Upper end in SI of the slider of a parameter that is 0: by its alternatives, parameters of its unit, or 1."""
    overlays = [overlay for axis in plain.definition.configurations.values() for overlay in axis.values()]
    numbers = [overlay.parameters[name] for overlay in overlays if name in overlay.parameters]
    sizes = [abs(float(number.value)) for number in numbers if isinstance(number, Number)]
    if max(sizes, default=0.0) > 0:
        return RANGE_FACTOR * max(sizes)
    alike = [abs(plain.parameters[other]) for other in units if units[other] and units[other] == units[name]]
    largest = max(alike, default=0.0)
    return largest if 0 < largest < math.inf else 1.0


# Mean torques that change with one another so that a drivetrain with laws of motion stays in balance.

FloatArray = NDArray[np.float64]

NEGLIGIBLE = 1e-9
"""Share of the largest singular value below which one counts as zero."""

LEAST_TOGETHER = 0.1
"""Share of the sizes of torques that they have to leave over together, so that one factor on all of them can balance
a change; of torques that cancel one another it would be huge."""


def followed_torques(
    network: LawNetwork, before: Tangents, steps: Mapping[str, float], loose: Mapping[str, float]
) -> dict[str, float]:
    """Mean torques in N m, by place, that keep a drivetrain in balance when others change.

    Balance is needed along the motions that neither springs nor laws over the speed resist. All loose torques change
    by one factor, as with the load of a plant. What this leaves over the smallest relative changes take, those with
    the least sum of (dT/T)^2; what cannot be balanced stays.

    Parameters
    ----------
    network : LawNetwork
        With the parameter values in force.
    before : Tangents
        Operating point that the torques change, which tells which laws slip at their limit and take nothing more.
    steps : mapping
        Place -> change in N m of a torque given by hand.
    loose : mapping
        Place -> torque in N m that may change.
    """
    free = _unresisted(network, before)

    def along(place: str) -> FloatArray:
        return np.asarray(free @ _row(network, torque_place(place).row))

    torques = np.array(list(loose.values()))
    shares = np.array([along(place) for place in loose]).T.reshape(len(free), len(loose))
    needed = -sum((step * along(place) for place, step in steps.items()), np.zeros(len(free)))
    # First all loose torques by one factor, as far as that balances; what is left by least changes.
    together, apart = shares @ torques, np.abs(shares) @ np.abs(torques)
    factor = 0.0
    if np.linalg.norm(together) > LEAST_TOGETHER * np.linalg.norm(apart):
        factor = float(together @ needed / (together @ together))
    sizes = np.abs(torques) if torques.any() else np.ones(len(loose))
    rest = np.linalg.pinv(shares * sizes, rcond=NEGLIGIBLE) @ (needed - factor * together)
    changed = torques + factor * torques + sizes * rest
    return dict(zip(loose, changed.tolist(), strict=True))


def _unresisted(network: LawNetwork, before: Tangents) -> FloatArray:
    """Motions (n, n_free) over the free motions that no law over the speed resists at an operating point."""
    rows = [_row(network, placed.law.row) for placed in network.over_rate if _resists(network, before, placed)]
    n = len(network.free_motions)
    if not rows:
        return np.eye(n)
    _, sizes, directions = np.linalg.svd(np.array(rows).reshape(len(rows), n))
    return np.asarray(directions[int(np.sum(sizes > NEGLIGIBLE * sizes.max(initial=0.0))) :])


def _resists(network: LawNetwork, before: Tangents, placed: PlacedMotionLaw) -> bool:
    """Whether the torque of a law over the speed answers changes: it sticks, or rises or falls with the speed."""
    try:
        states = before.state.states[placed.owner]
    except TorsionnetError:
        return True
    state = states[[law.number for law in network.motion if law.owner == placed.owner].index(placed.number)]
    return bool(placed.law.curve.holds(state)) or float(placed.law.curve.slopes(state)[1]) != 0


def _row(network: LawNetwork, row: Mapping[str, float]) -> FloatArray:
    shares = network.free.in_floats(exact_row({node: share for node, share in row.items() if node in network.order}))
    return np.array([shares.get(name, 0.0) for name in network.free_motions])


# Sliders of the explore page for the operating point of a model with laws of motion, and for the size of its load.

UNITS = {TORQUE: "N*m", SPEED: "rpm", LOAD_SIZES[0]: "kW", LOAD_SIZES[1]: "N*m"}
"""Units of numbers that the model gives without one."""
TWICE = 2.0
"""Upper end of the slider of a torque, speed or load over its value."""
REVERSED = -1.0
"""Lower end of the slider of a torque over its value: a line that drives can be looked at in overrun."""
FOLLOWS = "follows, in balance"
"""Words beside a torque that changes with one moved by hand."""
DIGITS = 12
"""Significant digits of torques that follow others: what they leave over stays below what a note tells."""


@dataclass(frozen=True)
class PointSlider:
    """Entry of the operating point, or size of the load, that has a slider.

    Attributes
    ----------
    name : str
        Of its setting, as ``operating_point.torque.crank``.
    label : str
    entry : str
        ``torque`` or ``speed``, or the name of the size of a load.
    place : str
    """

    name: str
    label: str
    entry: str
    place: str = ""


def point_rows(rig: Drivetrain) -> list[PointSlider]:
    """Rows for the operating point of a model in its configuration; none without laws of motion that follow it."""
    definition = rig.definition
    if definition.tangents is None or not any(
        element.has_motion_laws and not keeps_own_point(element, definition) for element in definition.switched_on
    ):
        return []
    return list(_point_sliders(definition))


def _point_sliders(definition: Definition) -> Iterator[PointSlider]:
    """Rows for the torques, else the load, and the speeds of a model."""
    point, load = definition.operating_point, definition.load
    for name in LOAD_SIZES if load is not None else ():
        if getattr(load, name.partition(".")[2]) is not None:
            yield PointSlider(name, f"{name.partition('.')[2]} of the load at rated speed", name)
    for place in point.torque if load is None else ():
        yield PointSlider(setting_name(TORQUE, place), f"torque on {place}", TORQUE, place)
    speeds = dict.fromkeys(point.speed)
    if load is not None and not speeds and definition.speeds is not None:
        speeds = {str(definition.speeds.of): None}
    for node in speeds:
        yield PointSlider(setting_name(SPEED, node), f"speed of {node}", SPEED, node)


def all_point_rows(rig: Drivetrain) -> list[PointSlider]:
    """Rows for the operating points of a model in any of its configurations, each once."""
    if not any(element.has_motion_laws for element in rig.definition.elements.values()):
        return []
    points = [overlay.operating_point for axis in rig.definition.configurations.values() for overlay in axis.values()]
    rows = {row.name: row for row in _point_sliders(rig.definition)}
    for point in points if rig.definition.load is None else ():
        for place in point.torque if point else ():
            name = setting_name(TORQUE, place)
            rows.setdefault(name, PointSlider(name, f"torque on {place}", TORQUE, place))
    for point in points:
        for node in point.speed if point else ():
            name = setting_name(SPEED, node)
            rows.setdefault(name, PointSlider(name, f"speed of {node}", SPEED, node))
    return list(rows.values())


def point_settings(values: Mapping[str, Any], rig: Drivetrain) -> dict[str, Any]:
    """Values given by hand, by name, that are entries of the operating point or the load."""
    return {
        name: value
        for name, value in values.items()
        if name not in rig.parameter_definitions and is_point_setting(name)
    }


def with_balance(plain: Drivetrain, values: Mapping[str, Any]) -> dict[str, Any]:
    """Values given by hand, with torques of the operating point that follow so that all stay in balance.

    Torques that the file writes as expressions of parameters follow these instead. What the file leaves over, by
    rounding, stays over.

    Parameters
    ----------
    plain : Drivetrain
        In the configuration chosen.
    values : mapping
        Parameter or setting -> value.
    """
    own = plain.definition.operating_point.torque
    rows = [row for row in point_rows(plain) if row.entry == TORQUE]
    moved = [row.place for row in rows if row.name in values]
    loose = [row.place for row in rows if row.place not in moved and not own[row.place].names]
    if not moved or not loose:
        return dict(values)
    changed = plain.configured(**values)
    assert plain.definition.tangents is not None  # else there were no rows
    before, after = (_torques(rig) for rig in (plain, changed))
    loose_before = {place: before[place] for place in loose}
    if _is_balanced(plain):
        steps = {place: after[place] - before[place] for place in moved}
    else:  # nothing to keep: all torques together come into balance
        steps = {**{place: after[place] for place in moved}, **loose_before}
    followed = followed_torques(
        law_network(changed.definition, changed.exact_values),
        plain.definition.tangents,
        steps,
        loose_before,
    )
    return {**values, **{setting_name(TORQUE, place): _text(own[place], torque) for place, torque in followed.items()}}


def _is_balanced(rig: Drivetrain) -> bool:
    assert rig.definition.tangents is not None
    try:
        return bool(rig.definition.tangents.states)
    except TorsionnetError:
        return False


def _torques(rig: Drivetrain) -> dict[str, float]:
    values = rig.exact_values
    return {place: float(torque.evaluate(values)) for place, torque in rig.definition.operating_point.torque.items()}


def _text(own: Expression, torque: float) -> str:
    unit = written_unit(own) or UNITS[TORQUE]
    return f"{torque / float(parse_unit(unit).factor):.{DIGITS}g} {unit}"


def point_sliders(plain: Drivetrain, changed: Drivetrain, values: Mapping[str, Any]) -> list[Slider]:
    """Sliders of the operating point of a model, or of its load.

    Parameters
    ----------
    plain : Drivetrain
        In the configuration chosen.
    changed : Drivetrain
        In that configuration with the values given by hand and the torques that follow.
    values : mapping
        Parameter or setting -> value given by hand.
    """
    rows = point_rows(plain)
    largest = {
        entry: max((abs(_value(plain, row)) for row in rows if row.entry == entry), default=0.0) for entry in UNITS
    }
    return [_point_slider(row, plain, changed, values, largest[row.entry]) for row in rows]


def _point_slider(
    row: PointSlider, plain: Drivetrain, changed: Drivetrain, values: Mapping[str, Any], largest: float
) -> Slider:
    own = _written(plain, row)
    derived = own is not None and bool(own.names)
    unit = ("" if own is None else written_unit(own)) or UNITS[row.entry]
    factor = float(parse_unit(unit).factor)
    si = _value(changed, row)
    default, value = _value(plain, row) / factor, si / factor
    size = default or largest / factor or 1.0
    ends = (TWICE * size, REVERSED * size if row.entry == TORQUE else 0.0)
    follows = not derived and row.name not in values and value != default and row.entry == TORQUE
    return Slider(
        name=row.name,
        description="",
        unit=unit,
        shown_unit=unit,
        si=si,
        value=value,
        default=default,
        low=min(*ends, value),
        high=max(*ends, value),
        logarithmic=False,
        changed=row.name in values,
        expression=str(own) if derived else "",
        remark=FOLLOWS if follows else "",
    )


def _written(rig: Drivetrain, row: PointSlider) -> Expression | None:
    """Expression of an entry of the operating point; None where the model leaves it to its load, or to the page."""
    return getattr(rig.definition.operating_point, row.entry).get(row.place) if row.place else None


def _value(rig: Drivetrain, row: PointSlider) -> float:
    """Value of a row in SI; 0 of a torque or a speed that the model does not give in this configuration."""
    if not row.place:
        return float(getattr(rig.definition.load, row.name.partition(".")[2]))
    own = _written(rig, row)
    if own is not None:
        return float(own.evaluate(rig.exact_values))
    return rig.external_torques.operating_speed if row.entry == SPEED else 0.0
