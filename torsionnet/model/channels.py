"""Sensors and inputs: what is measured or driven, and where."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from torsionnet.core.errors import Fault, UsageError, did_you_mean, unknown_key
from torsionnet.model.elements import Element
from torsionnet.model.elements.fields import FieldError, node_name_fault

SENSOR_QUANTITIES = ("angle", "velocity", "acceleration", "twist", "torque")
"""angle, velocity, acceleration of a node; twist of an element; torque through an element at one of its ports."""

ELEMENT_QUANTITIES = ("twist", "torque")
INPUT_QUANTITIES = ("torque", "angle")

UNITS = {"angle": "rad", "velocity": "rad/s", "acceleration": "rad/s^2", "twist": "rad", "torque": "N*m"}


@dataclass(frozen=True)
class Sensor:
    """A measured quantity: angle, velocity or acceleration of a node, twist or torque of an element.

    ``at`` is the port (or its node) where a torque is taken; without it, the port that defines the element's sign.

    Examples
    --------
    >>> print(Sensor("torque", "gearbox", at="output_shaft"))
    torque(gearbox, output_shaft)
    """

    quantity: str
    of: str
    at: str | None = None

    def __post_init__(self) -> None:
        if self.quantity not in SENSOR_QUANTITIES:
            raise UsageError(_wrong_quantity("a sensor measures", self.quantity, SENSOR_QUANTITIES))
        if not isinstance(self.of, str) or not isinstance(self.at, str | None):
            msg = f"a sensor is on a node or element given by its name, got {self.of!r}, {self.at!r}"
            raise UsageError(msg)
        if self.at is not None and self.quantity != "torque":
            msg = f"only a torque is taken at a port; leave out at={self.at!r}, or measure a torque instead"
            raise UsageError(msg)

    def __str__(self) -> str:
        return f"{self.quantity}({self.of}{', ' + self.at if self.at else ''})"

    def to_data(self) -> dict[str, str]:
        return {self.quantity: self.of, **({"at": self.at} if self.at else {})}


@dataclass(frozen=True)
class Input:
    """An excitation: a ``torque`` on a node, or an imposed ``angle`` of a node."""

    quantity: str
    of: str

    def __post_init__(self) -> None:
        if self.quantity not in INPUT_QUANTITIES:
            raise UsageError(_wrong_quantity("an input drives", self.quantity, INPUT_QUANTITIES))
        if not isinstance(self.of, str):
            msg = f"an input is on a node given by its name, got {self.of!r}"
            raise UsageError(msg)

    def __str__(self) -> str:
        return f"{self.quantity} on {self.of}"

    def to_data(self) -> dict[str, str]:
        return {self.quantity: self.of}


def _wrong_quantity(what: str, quantity: object, known: tuple[str, ...]) -> str:
    return f"{what} {' or '.join(known)}, not {quantity!r}{did_you_mean(str(quantity), known)}"


_CALL = re.compile(r"\s*([a-z]+)\s*\(\s*([A-Za-z][\w.]*)\s*(?:,\s*([A-Za-z][\w.]*)\s*)?\)\s*")


def parse_sensor(text: str) -> Sensor | None:
    """Sensor from text such as ``torque(gearbox, output_shaft)``, or None if the text has another form.

    >>> parse_sensor("twist(dmf)")
    Sensor(quantity='twist', of='dmf', at=None)
    """
    match = _CALL.fullmatch(text)
    if match is None or match[1] not in SENSOR_QUANTITIES or (match[3] and match[1] != "torque"):
        return None
    return Sensor(match[1], match[2], match[3])


def read_sensor(raw: Any) -> Sensor:
    if isinstance(raw, Sensor):
        return raw
    quantity, of = _read_entry(raw, SENSOR_QUANTITIES, ("at",), "{angle: node} or {torque: element, at: node}")
    at = raw.get("at")
    if at is not None and (quantity != "torque" or not isinstance(at, str)):
        only = f"only a torque is taken at a port; leave out at:, or measure a torque instead of the {quantity}"
        msg = only if quantity != "torque" else f"expected the name of a node, got {at!r}"
        raise FieldError(msg, ("at",))
    return Sensor(quantity, of, at)


def read_input(raw: Any) -> Input:
    if isinstance(raw, Input):
        return raw
    quantity, of = _read_entry(raw, INPUT_QUANTITIES, (), "{torque: node} or {angle: node}")
    return Input(quantity, of)


def _read_entry(raw: Any, quantities: tuple[str, ...], extra: tuple[str, ...], example: str) -> tuple[str, str]:
    if not isinstance(raw, Mapping):
        msg = f"expected {example}, got {raw!r}"
        raise FieldError(msg)
    for key in raw:
        if key not in quantities and key not in extra:
            rest = f"expected {' or '.join(quantities)}"
            raise FieldError(unknown_key(key, (*quantities, *extra), (key,), rest))
    given = [key for key in raw if key in quantities]
    if len(given) != 1:
        msg = f"expected one of {', '.join(quantities)}, as in {example}"
        raise FieldError(msg)
    name = raw[given[0]]
    if not isinstance(name, str) or not name:
        msg = f"expected a name, got {name!r}"
        raise FieldError(msg, (given[0],))
    return given[0], name


def read_channels(raw: Mapping[str, Any], table: str) -> tuple[dict[str, Any], list[Fault]]:
    """All readable entries of ``inputs`` or ``sensors``, and the faults of the others."""
    read = read_input if table == "inputs" else read_sensor
    channels: dict[str, Any] = {}
    faults: list[Fault] = []
    for name, entry in raw.items():
        reason = node_name_fault(str(name))
        if reason:
            faults.append(Fault(reason, (table, name), on_key=True))
            continue
        try:
            channels[name] = read(entry)
        except FieldError as error:
            faults.append(error.fault.under(table, name))
    return channels, faults


def port_fault(element: Element, at: str) -> str | None:
    """Why ``at`` names no port of the element, neither by the port's own name nor by its node; or None.

    A name that is a port and also the node of another port is refused: either could be meant.
    """
    by_name, by_node = (
        [index for index, pair in enumerate(element.ports.items()) if pair[side] == at] for side in (0, 1)
    )
    ports = ", ".join(f"{node} ({port})" for port, node in element.ports.items())
    if not by_name and not by_node:
        hint = did_you_mean(at, [*element.ports.values(), *element.ports])
        return f'{element.name} is not attached to "{at}"{hint}; it is attached to {ports}'
    if len({*by_name, *by_node}) > 1:
        return f'"{at}" could be two ports of {element.name}, which is attached to {ports}; rename the node'
    return None
