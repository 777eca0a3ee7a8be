"""Sensors and inputs: what is measured or driven, and where."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from torsionnet.core.entries.renaming import Renaming
from torsionnet.core.entries.spec import EntryError, Schema, Spec, reference
from torsionnet.core.entries.words import Text
from torsionnet.core.errors import UsageError, did_you_mean, unknown_key
from torsionnet.model.elements import Element

SENSOR_QUANTITIES = ("angle", "velocity", "acceleration", "twist", "torque", "stress")
"""angle, velocity, acceleration of a node; twist of an element; torque through an element at one of its ports, and the
nominal shear stress it makes there in a round shaft."""

ELEMENT_QUANTITIES = ("twist", "torque", "stress")
PORT_QUANTITIES = ("torque", "stress")
INPUT_QUANTITIES = ("torque", "angle")
"""Of the inputs of a model; a solver may also be asked for the response to an imposed twist."""

UNITS = {
    "angle": "rad",
    "velocity": "rad/s",
    "acceleration": "rad/s^2",
    "twist": "rad",
    "torque": "N*m",
    "stress": "Pa",
}


@dataclass(frozen=True)
class Sensor:
    """A measured quantity: angle, velocity or acceleration of a node, twist, torque or shear stress of an element.

    ``at`` is the port (or its node) where a torque or stress is taken; without it, the port that defines the sign.

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
            raise UsageError(f"a sensor is on a node or element given by its name, got {self.of!r}, {self.at!r}")
        if self.at is not None and self.quantity not in PORT_QUANTITIES:
            raise UsageError(f"only a torque is taken at a port; leave out at={self.at!r}, or measure a torque instead")

    @property
    def is_on_element(self) -> bool:
        """Whether ``of`` is an element; else it is a node."""
        return self.quantity in ELEMENT_QUANTITIES

    def __str__(self) -> str:
        return f"{self.quantity}({self.of}{', ' + self.at if self.at else ''})"

    def renamed(self, names: Renaming) -> Sensor:
        """The same in a part, with the names it has in the whole."""
        if not self.is_on_element:
            return Sensor(self.quantity, names.node(self.of))
        return Sensor(self.quantity, names.own(self.of), names.at(self.of, self.at))

    def to_data(self) -> dict[str, str]:
        return {self.quantity: self.of, **({"at": self.at} if self.at else {})}


@dataclass(frozen=True)
class Input:
    """An excitation: a ``torque`` on a node, an imposed ``angle`` of a node, or an imposed ``twist`` of an element.

    An imposed twist e is what the springs of the element take for no twist: their torque is kappa(s) (gamma - e).
    """

    quantity: str
    of: str

    def __post_init__(self) -> None:
        if self.quantity not in (*INPUT_QUANTITIES, "twist"):
            raise UsageError(_wrong_quantity("an input drives", self.quantity, INPUT_QUANTITIES))
        if not isinstance(self.of, str):
            raise UsageError(f"an input is on a node given by its name, got {self.of!r}")

    @property
    def is_on_element(self) -> bool:
        """Whether ``of`` is an element; else it is a node."""
        return self.quantity == "twist"

    def __str__(self) -> str:
        return f"{self.quantity} on {self.of}"

    def renamed(self, names: Renaming) -> Input:
        """The same in a part, with the names it has in the whole."""
        return Input(self.quantity, (names.own if self.is_on_element else names.node)(self.of))

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
    if match is None or match[1] not in SENSOR_QUANTITIES or (match[3] and match[1] not in PORT_QUANTITIES):
        return None
    return Sensor(match[1], match[2], match[3])


def named_sensor(entry: str | Sensor, declared: Mapping[str, Sensor]) -> Sensor | None:
    """The sensor meant: an object, a declared name, or text such as ``torque(gearbox)``."""
    if isinstance(entry, Sensor):
        return entry
    return declared[entry] if entry in declared else parse_sensor(entry)


@dataclass(frozen=True, eq=False, repr=False)
class ChannelName(Text):
    """A sensor or an input by name or as a text, or a node."""

    def renamed(self, value: Any, names: Renaming) -> Any:
        if value in names.channels:
            return names.own(value)
        sensor = parse_sensor(value)
        return names.node(value) if sensor is None else str(sensor.renamed(names))


@dataclass(frozen=True, eq=False, repr=False)
class ChannelEntry(Spec):
    """What is driven or measured, by the name of its quantity: ``{angle: node}``."""

    made: type[Input | Sensor]
    quantities: tuple[str, ...]
    name: str
    """Of its definition in the schema."""

    def coerce(self, raw: Any) -> Input | Sensor:
        if isinstance(raw, self.made) and raw.quantity in self.quantities:
            return raw
        quantity, of = self._one_quantity(raw)
        if self.made is Input:
            return Input(quantity, of)
        at = raw.get("at")
        if at is not None and (quantity not in PORT_QUANTITIES or not isinstance(at, str)):
            only = f"only a torque is taken at a port; leave out at:, or measure a torque instead of the {quantity}"
            raise EntryError(
                only if quantity not in PORT_QUANTITIES else f"expected the name of a node, got {at!r}", ("at",)
            )
        return Sensor(quantity, of, at)

    @property
    def _extra(self) -> tuple[str, ...]:
        return ("at",) if self.made is Sensor else ()

    def _one_quantity(self, raw: Any) -> tuple[str, str]:
        if not isinstance(raw, Mapping):
            raise EntryError(f"expected {self.description}, got {raw!r}")
        for key in raw:
            if key not in self.quantities and key not in self._extra:
                rest = f"expected {' or '.join(self.quantities)}"
                raise EntryError(unknown_key(key, (*self.quantities, *self._extra), (key,), rest))
        given = [key for key in raw if key in self.quantities]
        if len(given) != 1:
            raise EntryError(f"expected one of {', '.join(self.quantities)}, as in {self.description}")
        name = raw[given[0]]
        if not isinstance(name, str) or not name:
            raise EntryError(f"expected a name, got {name!r}", (given[0],))
        return given[0], name

    def plain(self, value: Any) -> dict[str, str]:
        plain: dict[str, str] = value.to_data()
        return plain

    def schema(self) -> Schema:
        return reference(self.name)

    def definitions(self) -> Schema:
        texts = {quantity: f"where the {quantity} acts or is measured" for quantity in self.quantities}
        texts |= dict.fromkeys(self._extra, "the port, or its node, where a torque is taken")
        schema: Schema = {
            "type": "object",
            "description": self.description,
            "properties": {key: {"type": "string", "description": text} for key, text in texts.items()},
            "oneOf": [{"required": [quantity]} for quantity in self.quantities],
            "additionalProperties": False,
        }
        return {
            self.name: schema
            | (
                {"dependentSchemas": {"at": {"anyOf": [{"required": [one]} for one in PORT_QUANTITIES]}}}
                if self._extra
                else {}
            )
        }


INPUT = ChannelEntry("{torque: node} or {angle: node}", Input, INPUT_QUANTITIES, "input")
SENSOR = ChannelEntry("{angle: node} or {torque: element, at: node}", Sensor, SENSOR_QUANTITIES, "sensor")


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
