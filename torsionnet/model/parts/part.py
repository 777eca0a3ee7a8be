"""A part as it is written, and the place where a model uses it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import torsionnet.model.section_entries as sections
from torsionnet.core.entries.composite import Listed, Named, Nested, PairOf
from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.scalars import AnyQuantity
from torsionnet.core.entries.spec import EntryError, Schema, Spec, entry
from torsionnet.core.entries.words import Count, Text, is_plain
from torsionnet.core.errors import Fault
from torsionnet.core.expression_reading import check_name
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.configurations import Overlay
from torsionnet.model.elements import Element
from torsionnet.model.elements.nodes import NodeName
from torsionnet.model.parameters import Parameter

MOST_COPIES = 1000
PLAIN_NAME_SCHEMA: Schema = {"pattern": "^[A-Za-z][A-Za-z0-9_]*$"}


@dataclass(frozen=True, eq=False, repr=False)
class OneOrEach(Spec):
    """One value for all copies of a part, or a list with one for each."""

    of: Spec

    def coerce(self, raw: Any) -> Any:
        if not isinstance(raw, list | tuple):
            return self.of.coerce(raw)
        values, faults = Listed(self.description, self.of).read(raw)
        if faults:
            raise EntryError(faults)
        return values

    def plain(self, value: Any) -> Any:
        return [self.of.plain(one) for one in value] if isinstance(value, tuple) else self.of.plain(value)

    def schema(self) -> Schema:
        one = {key: value for key, value in self.of.schema().items() if key != "description"}
        return {"anyOf": [one, {"type": "array", "items": one}], "description": self.description}


_PORT = Text("a port of the part", "the name of a port")
_AT = Named(
    "port -> the node of this model that it is; a list has one for each copy",
    OneOrEach("a node, or one for each copy", NodeName("a node")),
    form="{inner: dl, outer: hub}",
)
_VALUES = Named(
    "parameter of the part -> value here, an expression of this model's parameters; a list has one for each copy",
    OneOrEach("a value, or one for each copy", AnyQuantity("a value, a quantity or an expression")),
    form="{k: 9 kN*m/rad}",
)


@dataclass(frozen=True, kw_only=True)
class Use(Declared):
    """A part put into a model: which one, joined to which nodes, with which values, how often.

    Examples
    --------
    >>> use = Use(part="throw", repeat=3, chain=("front", "rear"), at={"front": "nose", "rear": "fly"})
    >>> use.prefixes("cyl")
    ('cyl1', 'cyl2', 'cyl3')
    """

    kind: ClassVar[str] = "use"
    article: ClassVar[str] = "a use of a part"
    form: ClassVar[str] = "{part: half_shaft, at: {inner: dl, outer: hub}, parameters: {k: 9 kN*m/rad}}"

    part: str = entry(Text("which part it is", "the name of a part"))
    at: Mapping[str, str | tuple[str, ...]] = entry(_AT, None)
    parameters: Mapping[str, Any] = entry(_VALUES, None)
    repeat: int | None = entry(Count("how many copies; their names end in 1, 2, ...", 1, MOST_COPIES), None)
    chain: tuple[str, str] | None = entry(
        PairOf("ports [front, rear]: the rear of each copy is the front of the next", _PORT), None
    )

    def contradictions(self) -> list[Fault]:
        if self.chain is not None and self.repeat is None:
            return [Fault("a chain needs repeat: the number of copies in it", ("chain",), on_key=True)]
        if self.chain is not None and self.chain[0] == self.chain[1]:
            return [Fault("a chain leads from one port to another, [front, rear]", ("chain",))]
        return []

    def prefixes(self, name: str) -> tuple[str, ...]:
        """What the names of each copy begin with, before the dot."""
        return (name,) if self.repeat is None else tuple(f"{name}{index}" for index in range(1, self.repeat + 1))


def use_name_fault(name: str) -> str | None:
    """Why nothing can be used, or defined as a part, under a name."""
    if name.isascii() and is_plain(name):
        return None
    return f'"{name}" is no name; use letters, digits and _, beginning with a letter'


def prefix_fault(name: str) -> str | None:
    """Why nothing can be used under a name, which begins the names of parameters."""
    return use_name_fault(name) or check_name(name)


USE = Named(
    "parts put into this model, by the name that stands before those of all they hold",
    Nested("a part, the nodes it is joined to and its values", lambda: Use, "use"),
    refused=prefix_fault,
    names=PLAIN_NAME_SCHEMA,
    form="{left: {part: half_shaft, at: {inner: dl, outer: hub}}}",
)
PORTS = Listed(
    "nodes at which a model is joined to others that use it as a part", NodeName("a node", False), "a list of nodes"
)


@dataclass(frozen=True, kw_only=True)
class Part(Declared):
    """A model with ports, to be put into others."""

    kind: ClassVar[str] = "part"
    article: ClassVar[str] = "a part"
    form: ClassVar[str] = "{ports: [inner, outer], parameters: {k: 9 kN*m/rad}, elements: {...}}"

    ports: tuple[str, ...] = entry(PORTS)
    source: str = entry(Text("where the numbers come from"), "")
    description: str = entry(Text("what the part is"), "")
    parameters: Mapping[str, Parameter] = entry(sections.PARAMETERS, None)
    elements: Mapping[str, Element] = entry(sections.ELEMENTS, None)
    use: Mapping[str, Use] = entry(USE, None)
    inputs: Mapping[str, Input] = entry(sections.INPUTS, None)
    sensors: Mapping[str, Sensor] = entry(sections.SENSORS, None)
    configurations: Mapping[str, Mapping[str, Overlay]] = entry(sections.CONFIGURATIONS, None)
    excitations: Mapping[str, Any] = entry(sections.EXCITATIONS, None)
    limits: Mapping[str, Any] = entry(sections.LIMITS, None)

    def __post_init__(self) -> None:
        """The values are typed already."""
        for name, stored in self.defaults().items():
            if getattr(self, name) is None:
                object.__setattr__(self, name, stored)

    @classmethod
    def read(cls, raw: Any) -> tuple[Self | None, list[Fault]]:
        """As for any entry, but with what could be read where something could not."""
        if isinstance(raw, cls) or not isinstance(raw, Mapping):
            return super().read(raw)
        values, faults = cls.read_entries(raw)
        if "elements" not in raw and "use" not in raw:
            faults.append(cls.missing("elements"))
        return cls(**{"ports": (), **values}), faults


@dataclass(frozen=True, eq=False, repr=False)
class PartTable(Named):
    """Parts that could be read in part stay: what uses them is checked all the same."""

    def read(self, raw: Any) -> tuple[dict[str, Any], list[Fault]]:
        if not isinstance(raw, Mapping):
            return super().read(raw)
        table, faults = {}, list(self._name_faults(raw))
        for name, one in raw.items():
            part, found = self.of.read(one)
            faults += [fault.under(name) for fault in found]
            if part is not None and not use_name_fault(str(name)):
                table[str(name)] = part
        return table, faults

    def _name_faults(self, raw: Mapping[str, Any]) -> Iterator[Fault]:
        for name in raw:
            reason = use_name_fault(str(name))
            if reason:
                yield Fault(reason, (name,), on_key=True)


PARTS = PartTable(
    "models with ports, to be put in under use:, by name",
    Nested("a model with ports", lambda: Part, "part"),
    names=PLAIN_NAME_SCHEMA,
    form="{half_shaft: {ports: [inner, outer], elements: {...}}}",
)
INCLUDE = Listed(
    "files beside this one or below with parts:, or models with ports:, which are parts under the name of their file",
    Text("the name of a file", "the name of a file"),
    "a list of files",
)
