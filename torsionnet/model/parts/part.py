"""Part as its author wrote it, with ports, parameters and elements, and its use in a model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Self

import torsionnet.model.sections as sections
from torsionnet.base.entries.composite import Listed, Named, PairOf
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import AnyQuantity
from torsionnet.base.entries.spec import Count, EntryError, Json, Renaming, Schema, Spec, Stored_co, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.configurations import Overlay
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.elements import Element
from torsionnet.model.parameters import Parameter

if TYPE_CHECKING:
    from torsionnet.machinery.excitations.order_excitation import OrderExcitation
    from torsionnet.machinery.limits.limit import Limit

MOST_COPIES = 1000
"""Largest number of copies in one use of a part, as a larger number is a slip and would fill the memory."""


@dataclass(frozen=True, eq=False, repr=False)
class OneOrEach(Spec[Stored_co | tuple[Stored_co, ...]]):
    """Entry of one value for all copies of a part, or a list with one for each."""

    of: Spec[Stored_co]

    def entry_specs(self, raw: object) -> Mapping[Any, Spec[Any]]:
        return Listed(self.description, self.of).entry_specs(raw) or self.of.entry_specs(raw)

    def renamed(self, value: Any, names: Renaming) -> Any:
        if isinstance(value, tuple):
            return tuple(self.of.renamed(each, names) for each in value)
        return self.of.renamed(value, names)

    def coerce(self, raw: object) -> Any:
        if not isinstance(raw, list | tuple):
            return self.of.coerce(raw)
        values, faults = Listed(self.description, self.of).read(raw)
        if faults:
            raise EntryError(faults)
        return values

    def plain(self, value: Any) -> Json:
        return [self.of.plain(each) for each in value] if isinstance(value, tuple) else self.of.plain(value)

    def schema(self) -> Schema:
        single = {key: value for key, value in self.of.schema().items() if key != "description"}
        return {"anyOf": [single, {"type": "array", "items": single}], "description": self.description}


@dataclass(frozen=True, eq=False, repr=False)
class PortName(Text):
    """Entry for a port of a part."""

    part: str = ""

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.port(self.part, value)


@dataclass(frozen=True, eq=False, repr=False)
class PartParameter(Text):
    """Entry for the name of a parameter of a part."""

    part: str = ""

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.part_parameter(self.part, value)


class PartName(Text):
    """Entry for the name of a part."""

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.part(value)


_PORT = PortName("a port of the part", "the name of a port")
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

    part: str = entry(PartName("which part it is", "the name of a part"))
    at: Mapping[str, str | tuple[str, ...]] = entry(_AT, None)
    parameters: Mapping[str, Expression | tuple[Expression, ...]] = entry(_VALUES, None)
    repeat: int | None = entry(Count("how many copies; their names end in 1, 2, ...", 1, MOST_COPIES), None)
    chain: tuple[str, str] | None = entry(
        PairOf("ports [front, rear]: the rear of each copy is the front of the next", _PORT), None
    )

    @classmethod
    def spec_beside(cls, name: str, spec: Spec[Any], entries: Mapping[str, Any]) -> Spec[Any]:
        part = str(entries.get("part"))
        if isinstance(spec, PairOf):
            return replace(spec, of=replace(_PORT, part=part))
        if isinstance(spec, Named):
            names = PortName if name == "at" else PartParameter
            return replace(spec, keys=names(spec.description, part=part))
        return spec

    def contradictions(self) -> list[Fault]:
        if self.chain is not None and self.repeat is None:
            return [
                Fault("a chain needs repeat: the number of copies in it", ("chain",), on_key=True, kind="missing-entry")
            ]
        if self.chain is not None and self.chain[0] == self.chain[1]:
            return [Fault("a chain leads from one port to another, [front, rear]", ("chain",), kind="wrong-form")]
        return []

    def prefixes(self, name: str) -> tuple[str, ...]:
        """Prefixes, without the dot, of the names of each copy of the part."""
        return (name,) if self.repeat is None else tuple(f"{name}{index}" for index in range(1, self.repeat + 1))


@dataclass(frozen=True, kw_only=True)
class Part(Declared):
    """A model with ports, to be put into others."""

    kind: ClassVar[str] = "part"
    article: ClassVar[str] = "a part"
    form: ClassVar[str] = "{ports: [inner, outer], parameters: {k: 9 kN*m/rad}, elements: {...}}"

    ports: tuple[str, ...] = entry(sections.PORTS)
    source: str = entry(Text("where the numbers come from"), "")
    description: str = entry(Text("what the part is"), "")
    parameters: Mapping[str, Parameter] = entry(sections.PARAMETERS, None)
    elements: Mapping[str, Element] = entry(sections.ELEMENTS, None)
    use: Mapping[str, Use] = entry(sections.USE, None)
    inputs: Mapping[str, Input] = entry(sections.INPUTS, None)
    sensors: Mapping[str, Sensor] = entry(sections.SENSORS, None)
    configurations: Mapping[str, Mapping[str, Overlay]] = entry(sections.CONFIGURATIONS, None)
    excitations: Mapping[str, OrderExcitation] = entry(sections.EXCITATIONS, None)
    limits: Mapping[str, Limit] = entry(sections.LIMITS, None)

    def __post_init__(self) -> None:
        """Accept the typed values of the part as they are, without checks."""
        self.settle_absent()

    @classmethod
    def read(cls, raw: object) -> tuple[Self | None, list[Fault]]:
        """Part of a model as far as it could be read, and every fault."""
        if isinstance(raw, cls) or not isinstance(raw, Mapping):
            return super().read(raw)
        values, faults = cls.read_entries(raw)
        if "elements" not in raw and "use" not in raw:
            faults.append(cls.missing("elements"))
        return cls(**{"ports": (), **values}), faults
