"""Sensors and inputs of a model, the quantities measured and imposed at nodes and elements."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, TypeAlias, TypeVar, cast

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.spec import EntryError, Json, Renaming, Schema, Spec, Text, reference
from torsionnet.base.errors import LEAVE_OUT, Fault, Remedy, UsageError, got, unfit_word, unknown_key
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.base.registers import settle
from torsionnet.model.element_base.element_entries import ElementName, NodeText, PlaceOnElement
from torsionnet.model.elements import GROUND, Element

SENSOR_QUANTITIES = ("angle", "velocity", "acceleration", "twist", "torque", "stress")
"""Names of the quantities that a sensor can measure.

Angle, velocity and acceleration of a node; twist of an element; torque through an element at one of its ports, and the
nominal shear stress that this torque makes in a round shaft."""

MOTIONS = ("angle", "velocity", "acceleration")
"""Names of the quantities measured at a node, or at a node relative to another node."""
ELEMENT_QUANTITIES = ("twist", "torque", "stress")
PORT_QUANTITIES = ("torque", "stress")
INPUT_QUANTITIES = ("torque", "angle")
"""Names of the quantities that an input of a model can impose; solvers also take an imposed twist."""

UNITS = {
    "angle": "rad",
    "velocity": "rad/s",
    "acceleration": "rad/s^2",
    "twist": "rad",
    "torque": "N*m",
    "stress": "Pa",
}


class ModelChannel:
    """Base class of sensors and inputs, whose ``quantity`` is that of a node, between two nodes, or of an element."""

    quantity: str
    of: str
    against: str | None
    quantities_of_elements: ClassVar[tuple[str, ...]] = ()
    """Names of the quantities that are those of an element."""

    @property
    def is_on_element(self) -> bool:
        """Whether the sensor or input is on an element and not on a node."""
        return self.quantity in self.quantities_of_elements

    @property
    def nodes(self) -> tuple[str, ...]:
        """Node of the sensor or input, and the node that it is taken against, if any; empty on an element."""
        if self.is_on_element:
            return ()
        return (self.of,) if self.against is None else (self.of, self.against)

    @property
    def row(self) -> dict[str, int]:
        """Coefficients by node of the motion that is measured or imposed, or with which a torque acts.

        1 at the first node, -1 at the second.
        """
        return dict(zip(self.nodes, PAIR_COEFFICIENTS, strict=False))


@dataclass(frozen=True)
class Sensor(ModelChannel):
    """Sensor of a drivetrain, which measures a motion of a node, or twist, torque or stress of an element.

    ``at`` is the port (or its node) where a torque or stress is taken; without it, the port that defines the sign. A
    motion is relative to that of the node ``against``, if there is one. With ``referred_to``, a node of another shaft,
    an angle is what it would be there, times the speed of that shaft over that of its own, and a torque divided by it.

    Examples
    --------
    >>> print(Sensor("torque", "gearbox", at="output_shaft"), Sensor("angle", "pulley", against="block"))
    torque(gearbox, output_shaft) angle(pulley, block)
    """

    quantities_of_elements: ClassVar[tuple[str, ...]] = ELEMENT_QUANTITIES

    quantity: str
    of: str
    at: str | None = None
    against: str | None = None
    referred_to: str | None = None

    def __post_init__(self) -> None:
        if self.quantity not in SENSOR_QUANTITIES:
            raise UsageError(_wrong_quantity("a sensor measures", self.quantity, SENSOR_QUANTITIES))
        if not isinstance(self.of, str) or not isinstance(self.at, str | None):
            raise UsageError(
                f"a sensor is on a node or element given by its name, got {self.of!r}, {self.at!r}", kind="not-a-node"
            )
        if self.at is not None and self.quantity not in PORT_QUANTITIES:
            raise UsageError(
                f"only a torque is taken at a port; leave out at={self.at!r}, or measure a torque instead",
                kind="unfit-channel",
            )
        if self.against is not None:
            if self.is_on_element:
                raise UsageError(
                    f"the {self.quantity} of an element is not relative to a node: leave out against=",
                    kind="unfit-channel",
                )
            _settle_pair(self)
        if self.referred_to is not None and self.quantity == "stress":
            raise UsageError(STRESS_OF_OWN_SHAFT, kind="unfit-channel")

    def __str__(self) -> str:
        return channel_words(self)

    def to_data(self) -> dict[str, Json]:
        extra = {"at": self.at, "referred_to": self.referred_to}
        return {self.quantity: _plain(self), **{key: name for key, name in extra.items() if name}}

    def renamed(self, names: Renaming) -> Sensor:
        """Copy of the sensor of a part, with its names in the whole model."""
        shaft = _renamed(self.referred_to, names)
        if not self.is_on_element:
            against = _renamed(self.against, names)
            return Sensor(self.quantity, names.node(self.of), against=against, referred_to=shaft)
        return Sensor(self.quantity, names.element(self.of), names.at(self.of, self.at), referred_to=shaft)


@dataclass(frozen=True)
class Input(ModelChannel):
    """Input of a drivetrain, a torque on a node, or an imposed angle or twist.

    Its ``quantity`` is ``torque`` or ``angle`` at a node, or ``twist`` in an element.

    With ``against``, a second node, +T acts on the first node and -T on the second, or the angle of the first relative
    to the second is imposed. Against the ground that is the same as on the node alone. An imposed twist e is what the
    springs of the element take for no twist: their torque is kappa(s) (gamma - e).

    Examples
    --------
    >>> engine = Input("torque", "pulley", "block")
    >>> print(engine, engine.row, engine.to_data())
    torque on pulley against block {'pulley': 1, 'block': -1} {'torque': ['pulley', 'block']}
    """

    quantities_of_elements: ClassVar[tuple[str, ...]] = ("twist",)

    quantity: str
    of: str
    against: str | None = None

    def __post_init__(self) -> None:
        if self.quantity not in (*INPUT_QUANTITIES, "twist"):
            raise UsageError(_wrong_quantity("an input drives", self.quantity, INPUT_QUANTITIES))
        if not isinstance(self.of, str):
            raise UsageError(f"an input is on a node given by its name, got {self.of!r}", kind="not-a-node")
        if self.against is not None:
            if self.is_on_element:
                raise UsageError(
                    "a twist is imposed in an element, not against a node: leave out against=", kind="unfit-channel"
                )
            _settle_pair(self)

    def __str__(self) -> str:
        return channel_words(self)

    def renamed(self, names: Renaming) -> Input:
        """Copy of the input of a part, with its names in the whole model."""
        if self.is_on_element:
            return Input(self.quantity, names.element(self.of))
        return Input(self.quantity, names.node(self.of), _renamed(self.against, names))

    def to_data(self) -> dict[str, Json]:
        return {self.quantity: _plain(self)}


Channels: TypeAlias = str | Sensor | Sequence[str | Sensor]
"""Type of what a solver is asked to read, one name or sensor, or several."""


def _renamed(node: str | None, names: Renaming) -> str | None:
    return None if node is None else names.node(node)


REFERRED = " referred to "
"""Text between a reading and the shaft that it is referred to, as in ``torque(shaft) referred to crank``."""

STRESS_OF_OWN_SHAFT = "a stress is that of its own shaft; refer the torque to another one"

PAIR_COEFFICIENTS = (1, -1)
"""Coefficients of the first node and of the node that it is taken against, in the motion between them."""


def channel_words(channel: Sensor | Input) -> str:
    """Text of a sensor or input, which keeps the names in it."""
    if isinstance(channel, Input):
        nodes = map(ModelName, filter(None, (channel.of, channel.against)))
        return phrase(f"{channel.quantity} on {{}}{' against {}' * bool(channel.against)}", *nodes)
    names = list(map(ModelName, filter(None, (channel.of, channel.at or channel.against))))
    text = phrase("{}({}, {})" if len(names) > 1 else "{}({})", channel.quantity, *names)
    return phrase("{}{}{}", text, REFERRED, ModelName(channel.referred_to)) if channel.referred_to else text


def named_nodes(channel: Sensor | Input) -> str:
    """Text that names the nodes of a sensor or input: ``"pulley" against "block"``."""
    nodes = [ModelName(node) for node in (channel.of, channel.against) if node is not None]
    return phrase(" against ".join(['"{}"'] * len(nodes)), *nodes)


def immobility_text(channel: Sensor | Input) -> str:
    """End of a sentence that says why the nodes of a sensor or input do not move."""
    return "it is locked" if channel.against is None else phrase("{} is held rigidly", named_nodes(channel))


def _plain(channel: Sensor | Input) -> str | list[str]:
    return channel.of if channel.against is None else [channel.of, channel.against]


def _settle_pair(channel: Sensor | Input) -> None:
    """Refuse a second name of a sensor or input that is no node; drop the ground as second node."""
    fault = pair_fault(channel.of, channel.against, channel.quantity)
    if fault:
        raise UsageError(fault)
    if channel.against == GROUND:
        settle(channel, against=None)


def pair_fault(first: str, second: Any, quantity: str) -> Fault | None:
    """Fault if a quantity cannot be taken between two nodes of these names, else None."""
    if not isinstance(second, str) or not second:
        return Fault(f"expected the name of a node, {got(second)}", kind="not-a-node")
    if first == second:
        text = f'both nodes are "{first}"; a {quantity} is between two different nodes, or on one: {quantity}: {first}'
        return Fault(text, kind="same-node")
    if first == GROUND:
        text = f"ground does not move; name the node first, {quantity}: {second}, and mind the sign"
        return Fault(text, kind="grounded-node")
    return None


def _wrong_quantity(what: str, quantity: object, known: tuple[str, ...]) -> Fault:
    return unfit_word(f"{what} {' or '.join(known)}, not {quantity!r}", str(quantity), known)


_CALL = re.compile(r"\s*([a-z]+)\s*\(\s*([A-Za-z][\w.]*)\s*(?:,\s*([A-Za-z][\w.]*)\s*)?\)\s*")


def parse_sensor(text: str) -> Sensor | None:
    """Sensor from text such as ``torque(gearbox, output_shaft)``, or None if the text has another form.

    >>> print(parse_sensor("twist(dmf)"), parse_sensor("angle(pulley,block)"))
    twist(dmf) angle(pulley, block)
    """
    match = _CALL.fullmatch(text)
    if match is None or match[1] not in SENSOR_QUANTITIES or (match[3] and match[1] == "twist"):
        return None
    # The second name is a port of a torque, and the node that a motion is taken against.
    if match[1] in PORT_QUANTITIES or not match[3]:
        return Sensor(match[1], match[2], match[3])
    return Sensor(match[1], match[2], against=match[3])


_PAIR = re.compile(r"\s*([A-Za-z][\w.]*)\s*-\s*([A-Za-z][\w.]*)\s*")


def parse_pair(text: str) -> tuple[str, str] | None:
    """Names of the two nodes in a text such as ``pulley-block``: a torque between them; or None if it has another form.

    >>> parse_pair("pulley-block"), parse_pair("pulley")
    (('pulley', 'block'), None)
    """
    match = _PAIR.fullmatch(text)
    return None if match is None else (match[1], match[2])


def named_sensor(entry: str | Sensor, declared: Mapping[str, Sensor]) -> Sensor | None:
    """Sensor given by an object, a declared name, or a text such as ``torque(gearbox)``; None for another text.

    >>> print(named_sensor("torque(gearbox) referred to crank", {}))
    torque(gearbox) referred to crank
    """
    if isinstance(entry, Sensor):
        return entry
    if entry in declared:
        return declared[entry]
    measured, _, shaft = entry.partition(REFERRED)
    if not shaft:
        return parse_sensor(entry)
    sensor = named_sensor(measured.strip(), declared)
    if sensor is None and re.fullmatch(r"[A-Za-z][\w.]*", measured.strip()):
        # A name alone in front of "referred to" is a node, whose angle is meant.
        sensor = Sensor("angle", measured.strip())
    return sensor and replace(sensor, referred_to=shaft.strip())


OPTIONAL_SENSOR_KEYS = {
    "at": "the port, or its node, where a torque is taken",
    "referred_to": "a node of the shaft that an angle or torque is referred to",
}


class ChannelName(Text):
    """Entry for the name of a sensor, input or node, or for the text of a sensor."""

    def renamed(self, value: Any, names: Renaming) -> Any:
        if not value:
            return value
        # A declared channel comes before a node of the same name, as when it is read.
        if value in names.channels:
            return names.channel(value)
        sensor = named_sensor(value, {})
        return names.node(value) if sensor is None else str(sensor.renamed(names))


class RecordedName(Text):
    """Entry for the name of a sensor or input of the model, or of another channel that is recorded."""

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.channel(value) if value else value


Made_co = TypeVar("Made_co", bound=Input | Sensor, covariant=True)


@dataclass(frozen=True, eq=False, repr=False)
class ChannelEntry(Spec[Made_co]):
    """Entry for an input or a sensor by its quantity: ``{angle: node}``."""

    made: type[Made_co]
    quantities: tuple[str, ...]
    name: str
    """Name under which the JSON Schema defines the entry."""

    def entry_specs(self, raw: object) -> Mapping[Any, Spec[Any]]:
        if not isinstance(raw, Mapping):
            return {}
        quantity = next((key for key in raw if key in self.quantities), "")
        is_on_element = quantity in ELEMENT_QUANTITIES and self.made is Sensor
        of = raw.get(quantity)
        node = NodeText("a node")
        named = ElementName("an element") if is_on_element else Listed("", node) if isinstance(of, list) else node
        at = PlaceOnElement("a port or node", element=str(of))
        return {quantity: named, "at": at, "referred_to": node}

    def coerce(self, raw: object) -> Made_co:
        if isinstance(raw, self.made) and raw.quantity in self.quantities:
            return raw
        if not isinstance(raw, Mapping):
            raise EntryError(f"expected {self.description}, {got(raw)}", kind="wrong-form")
        for key in raw:
            if key not in self.quantities and key not in self._extra:
                rest = f"expected {' or '.join(self.quantities)}"
                raise EntryError(unknown_key(key, (*self.quantities, *self._extra), (key,), rest))
        given = [key for key in raw if key in self.quantities]
        if len(given) != 1:
            raise EntryError(
                f"expected one of {', '.join(self.quantities)}, as in {self.description}", kind="wrong-form"
            )
        quantity: str = given[0]
        of, against = self._names(quantity, raw[quantity])
        if self.made is Input:
            return cast("Made_co", Input(quantity, of, against))
        at = raw.get("at")
        if at is not None and (quantity not in PORT_QUANTITIES or not isinstance(at, str)):
            if quantity in PORT_QUANTITIES:
                raise EntryError(Fault(f"expected the name of a node, {got(at)}", ("at",), kind="not-a-node"))
            only = f"only a torque is taken at a port; leave out at:, or measure a torque instead of the {quantity}"
            raise EntryError(Fault(only, ("at",), remedy=Remedy(LEAVE_OUT), kind="unfit-channel"))
        shaft = raw.get("referred_to")
        if not isinstance(shaft, str | None):
            raise EntryError(Fault(f"expected the name of a node, {got(shaft)}", ("referred_to",), kind="not-a-node"))
        if shaft is not None and quantity == "stress":
            raise EntryError(STRESS_OF_OWN_SHAFT, ("referred_to",), kind="unfit-channel")
        return cast("Made_co", Sensor(quantity, of, at, against, shaft))

    @property
    def _extra(self) -> tuple[str, ...]:
        return tuple(OPTIONAL_SENSOR_KEYS) if self.made is Sensor else ()

    @property
    def _of_pairs(self) -> tuple[str, ...]:
        """Names of the quantities that can be taken between two nodes."""
        return self.quantities if self.made is Input else MOTIONS

    def _names(self, quantity: str, given: Any) -> tuple[str, str | None]:
        """Name of the node or element of a channel, and of the second node, if any."""
        if isinstance(given, str) and given:
            return given, None
        if quantity not in self._of_pairs or not isinstance(given, list | tuple):
            raise EntryError(f"expected a name, {got(given)}", (quantity,), kind="not-a-node")
        if len(given) != 2 or not isinstance(given[0], str) or not given[0]:
            raise EntryError(
                f"expected a node, or two nodes [first, second], {got(given)}", (quantity,), kind="not-a-node"
            )
        fault = pair_fault(given[0], given[1], quantity)
        if fault:
            raise EntryError(fault.under(quantity, 0 if given[0] == GROUND else 1))
        return given[0], given[1]

    def plain(self, value: Any) -> dict[str, Any]:
        plain: dict[str, Any] = value.to_data()
        return plain

    def schema(self) -> Schema:
        return reference(self.name)

    def definitions(self) -> Schema:
        texts = {quantity: f"where the {quantity} acts or is measured" for quantity in self.quantities}
        texts |= {key: OPTIONAL_SENSOR_KEYS[key] for key in self._extra}
        pair: Schema = {"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2}
        forms: dict[str, Schema] = {
            key: {"anyOf": [{"type": "string"}, pair]} if key in self._of_pairs else {"type": "string"} for key in texts
        }
        schema: Schema = {
            "type": "object",
            "description": self.description,
            "properties": {key: {**forms[key], "description": text} for key, text in texts.items()},
            "oneOf": [{"required": [quantity]} for quantity in self.quantities],
            "additionalProperties": False,
        }
        return {
            self.name: schema
            | (
                {"dependentSchemas": {"at": {"anyOf": [{"required": [quantity]} for quantity in PORT_QUANTITIES]}}}
                if self._extra
                else {}
            )
        }


INPUT = ChannelEntry("{torque: node}, {angle: node} or {torque: [node, node]}", Input, INPUT_QUANTITIES, "input")
SENSOR = ChannelEntry("{angle: node} or {torque: element, at: node}", Sensor, SENSOR_QUANTITIES, "sensor")


def port_fault(element: Element, at: str) -> Fault | None:
    """Fault if ``at`` names no port of the element, by the port's name or its node; else None.

    A name that is a port and also the node of another port is refused: either could be meant.
    """
    by_name, by_node = (
        [index for index, pair in enumerate(element.ports.items()) if pair[side] == at] for side in (0, 1)
    )
    name, place = ModelName(element.name), ModelName(at)
    pairs = [phrase("{} ({})", ModelName(node), port) for port, node in element.ports.items()]
    ports = phrase(", ".join(["{}"] * len(pairs)), *pairs)
    if not by_name and not by_node:
        known = [*element.ports.values(), *element.ports]
        attached = phrase("it is attached to {}", ports)
        return unfit_word(phrase('{} is not attached to "{}"', name, place), at, known, (), attached)
    if len({*by_name, *by_node}) > 1:
        said = '"{}" could be two ports of {}, which is attached to {}; rename the node'
        return Fault(phrase(said, place, name, ports), kind="unknown-port")
    return None


@dataclass(frozen=True)
class Pair:
    """Transfer function of an output over an input for a report, with the excitation if the input is measured.

    Examples
    --------
    >>> Pair.parse("theta_1/T_T")
    Pair(output='theta_1', input='T_T', excitation='')
    >>> print(Pair.parse("torque(gearbox, output_shaft) / T_M"))
    torque(gearbox, output_shaft)/T_M
    """

    output: str
    input: str
    excitation: str = ""

    @classmethod
    def parse(cls, text: str) -> Pair:
        """Transfer function that the text ``OUTPUT/INPUT`` names.

        Raises
        ------
        UsageError
            There is not exactly one ``/`` with a name on either side.
        """
        parts = [part.strip() for part in text.split("/")]
        if len(parts) != 2 or not all(parts):
            raise UsageError(
                f'a transfer function is written OUTPUT/INPUT, as in theta_1/T_T; got "{text}"', kind="wrong-form"
            )
        return cls(*parts)

    def __str__(self) -> str:
        return f"{self.output}/{self.input}"

    def to_data(self) -> str | dict[str, str]:
        """Plain data of the transfer function for a file."""
        if not self.excitation:
            return str(self)
        return {"output": self.output, "input": self.input, "excitation": self.excitation}


_CHANNEL = ChannelName("sensor, input or node")


class PairEntry(Spec[Pair]):
    """Entry of a pair of output and input, whose transfer function the report of a model shows.

    Written as ``OUTPUT/INPUT``, or in parts by name.
    """

    def coerce(self, raw: object) -> Pair:
        if isinstance(raw, Pair):
            return raw
        try:
            return Pair.parse(raw) if isinstance(raw, str) else self._in_parts(raw)
        except UsageError as error:
            raise EntryError(error.fault) from None

    @staticmethod
    def _in_parts(raw: object) -> Pair:
        if isinstance(raw, Mapping) and {"output", "input"} <= set(raw) <= set(_PARTS):
            return Pair(**{str(key): str(value) for key, value in raw.items()})
        raise UsageError(
            f"expected OUTPUT/INPUT, or {{output: ..., input: ..., excitation: ...}}; {got(raw)}", kind="wrong-form"
        )

    def renamed(self, value: Any, names: Renaming) -> Any:
        ends = (_CHANNEL.renamed(end, names) for end in (value.output, value.input, value.excitation))
        return Pair(*ends)

    def plain(self, value: Any) -> Json:
        data: Json = value.to_data()
        return data

    def schema(self) -> Schema:
        return reference("report_transfer_function")

    def definitions(self) -> Schema:
        detailed: Schema = {
            "type": "object",
            "properties": {name: {"type": "string", "description": text} for name, text in _PARTS.items()},
            "required": ["output", "input"],
            "additionalProperties": False,
        }
        text = {"type": "string", "description": self.description}
        return {"report_transfer_function": {"anyOf": [text, detailed]}}


_PARTS = {
    "output": "sensor or node, or torque(element, port)",
    "input": "input or node, or a sensor: a measured input",
    "excitation": "what drives while the input is measured, if there are several inputs",
}
"""Description of each key of a transfer function that is written in parts."""


PAIR = PairEntry("OUTPUT/INPUT, as theta_1/T_T")
"""Specification of an entry with a transfer function."""
