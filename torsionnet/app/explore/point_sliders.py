"""Sliders of the explore page for the operating point of a model with laws of motion, and for the size of its load."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from torsionnet.app.explore.sliders import Slider, written_unit
from torsionnet.app.explore.torque_balance import followed_torques
from torsionnet.base.errors import TorsionnetError
from torsionnet.base.expressions import Expression
from torsionnet.base.units import parse_unit
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.changes import LOAD_SIZES, SPEED, TORQUE, is_point_setting, setting_name
from torsionnet.model.definition import Definition
from torsionnet.model.law_network import keeps_own_point, law_network

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
class PointRow:
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


def point_rows(rig: Drivetrain) -> list[PointRow]:
    """Rows for the operating point of a model in its configuration; none without laws of motion that follow it."""
    definition = rig.definition
    if definition.tangents is None or not any(
        one.has_motion_laws and not keeps_own_point(one, definition) for one in definition.switched_on
    ):
        return []
    return list(_rows(definition))


def _rows(definition: Definition) -> Iterator[PointRow]:
    """Rows for the torques, else the load, and the speeds of a model."""
    point, load = definition.operating_point, definition.load
    for name in LOAD_SIZES if load is not None else ():
        if getattr(load, name.partition(".")[2]) is not None:
            yield PointRow(name, f"{name.partition('.')[2]} of the load at rated speed", name)
    for place in point.torque if load is None else ():
        yield PointRow(setting_name(TORQUE, place), f"torque on {place}", TORQUE, place)
    speeds = dict.fromkeys(point.speed)
    if load is not None and not speeds and definition.speeds is not None:
        speeds = {str(definition.speeds.of): None}
    for node in speeds:
        yield PointRow(setting_name(SPEED, node), f"speed of {node}", SPEED, node)


def all_point_rows(rig: Drivetrain) -> list[PointRow]:
    """Rows for the operating points of a model in any of its configurations, each once."""
    if not any(one.has_motion_laws for one in rig.definition.elements.values()):
        return []
    points = [overlay.operating_point for axis in rig.definition.configurations.values() for overlay in axis.values()]
    found = {row.name: row for row in _rows(rig.definition)}
    for point in points if rig.definition.load is None else ():
        for place in point.torque if point else ():
            name = setting_name(TORQUE, place)
            found.setdefault(name, PointRow(name, f"torque on {place}", TORQUE, place))
    for point in points:
        for node in point.speed if point else ():
            name = setting_name(SPEED, node)
            found.setdefault(name, PointRow(name, f"speed of {node}", SPEED, node))
    return list(found.values())


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
    return {place: float(one.evaluate(values)) for place, one in rig.definition.operating_point.torque.items()}


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
    row: PointRow, plain: Drivetrain, changed: Drivetrain, values: Mapping[str, Any], largest: float
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


def _written(rig: Drivetrain, row: PointRow) -> Expression | None:
    """Expression of an entry of the operating point; None where the model leaves it to its load, or to the page."""
    return getattr(rig.definition.operating_point, row.entry).get(row.place) if row.place else None


def _value(rig: Drivetrain, row: PointRow) -> float:
    """Value of a row in SI; 0 of a torque or a speed that the model does not give in this configuration."""
    if not row.place:
        return float(getattr(rig.definition.load, row.name.partition(".")[2]))
    own = _written(rig, row)
    if own is not None:
        return float(own.evaluate(rig.exact_values))
    return rig.external_torques.operating_speed if row.entry == SPEED else 0.0
