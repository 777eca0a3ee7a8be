"""The base of all element types, and the register of them.

A new element type is one class in this package: a frozen dataclass whose fields carry specifications
(:mod:`torsionnet.core.entries`) and a ``parts`` method that yields laws and constraints. Registering it
makes it known to model files, the JSON Schema, the checks and the documentation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from copy import copy
from dataclasses import Field, dataclass, replace
from functools import cache
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar

from torsionnet.core.damping import DampingMeasure
from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.renaming import Renaming
from torsionnet.core.entries.scalars import QuantityKind
from torsionnet.core.entries.spec import Json, Schema, Spec, entry
from torsionnet.core.entries.words import Flag, Text, name_fault
from torsionnet.core.errors import Fault, ModelError, Path
from torsionnet.core.expressions import Expression
from torsionnet.core.type_register import TypeRegister
from torsionnet.model.catalogues.catalogue_entries import CATALOGUE, SIZE, CatalogueEntry, SizeName
from torsionnet.model.element_base.laws import Constraint, Law, Part, Row, Values
from torsionnet.model.element_base.nodes import NodeName, NodePair, ReferenceNode
from torsionnet.model.element_base.several import Several

if TYPE_CHECKING:
    from torsionnet.model.catalogues.catalogue import CatalogueRow
    from torsionnet.model.element_base.speed_path import SpeedPath

ELEMENT_TYPES: TypeRegister[type[Element]] = TypeRegister("torsionnet.model.elements", ("springs", "rigid", "gears"))
"""Kind -> type, in the order of the kinds; a file is imported when a kind that it has is first asked for."""

REFERRED = ("stiffness", "damping", "inertia")
"""Dimensions of values that may be quoted at the speed of another shaft."""

E = TypeVar("E", bound="Element")


def register(cls: type[E]) -> type[E]:
    """Make an element type known under its ``kind``."""
    ELEMENT_TYPES[cls.kind] = cls
    return cls


def element_classes() -> dict[str, type[Element]]:
    """The registered types by the names of their classes, as Python offers them: ``torsionnet.Spring``."""
    return {cls.__name__: cls for cls in ELEMENT_TYPES.values()}


@dataclass(frozen=True, eq=False, repr=False)
class Element(Declared):
    """One part of a drivetrain.

    Attributes
    ----------
    name : str
        Unique in its drivetrain.
    description : str
        Free text for tables and reports.
    enabled : bool
        A disabled element takes no part until a configuration switches it on.
    catalogue, size : CatalogueRow and str, optional
        Where entries that the model does not give come from.
    """

    kind: ClassVar[str] = ""
    """The word for the type in a model file."""
    glyph: ClassVar[str] = ""
    """How the schematic draws it: disc, spring, damper, coupling, gear, planetary, differential, gearbox, belt,
    clamp, shaft or pendulum."""
    sign: ClassVar[str] = "positive when it drives from the first node into the element"
    """What a positive torque means at the first port; at any other: positive when it drives out of the element."""
    drives: ClassVar[bool] = False
    """Whether a positive torque at the first port drives out of the element, as of one that acts by itself."""
    may_feed: ClassVar[bool] = False
    """Whether it may feed energy into a vibration, by an action or by damping that may be negative."""

    name: str
    description: str = entry(Text("free text for tables and reports"), "", kw_only=True)
    enabled: bool = entry(
        Flag("whether the element takes part before a configuration says otherwise"), True, kw_only=True
    )

    catalogue: CatalogueRow | None = entry(
        CatalogueEntry("a table from which it takes the entries that are not given here, as couplings.csv"),
        None,
        kw_only=True,
    )
    size: str = entry(SizeName("the row of the catalogue"), "", kw_only=True)
    referred_to: str | None = entry(
        ReferenceNode("a node of the shaft at whose speed the values are quoted; default: its own shaft"),
        None,
        kw_only=True,
    )

    def __post_init__(self) -> None:
        reason = name_fault(self.name) if isinstance(self.name, str) else f"{self.name!r} is no name"
        faults = [Fault(reason)] if reason else []
        faults += [] if self.catalogue is None else self._looked_up() or self._resized()
        faults += self.coerced()
        faults = faults or self.contradictions()
        if faults:
            raise ModelError([fault.under("elements", str(self.name)) for fault in faults], f"element {self.name!r}")

    def _looked_up(self) -> list[Fault]:
        """Take what is not given from a catalogue in a file; a required entry is not given if it is None."""
        from torsionnet.model.catalogues.catalogue import Catalogue
        from torsionnet.model.catalogues.taken_entries import entries_of, row_of

        if not isinstance(self.catalogue, Catalogue | PurePath):
            return []
        row, faults = row_of({CATALOGUE: self.catalogue, SIZE: self.size or None})
        if row is None:
            object.__setattr__(self, CATALOGUE, None)
            return faults
        specs, defaults = dict(self.specs()), self.defaults()
        given = {name: getattr(self, name) for name in specs}
        given = {name: raw for name, raw in given.items() if raw is not None and raw is not defaults.get(name)}
        taken, faults = entries_of(row, specs, given)
        for name, raw in {**taken, CATALOGUE: row}.items():
            object.__setattr__(self, name, raw)
        return faults

    def _resized(self) -> list[Fault]:
        """Take the row of another size, where a configuration says one; the faults of what it cannot give."""
        from torsionnet.model.catalogues.catalogue import CatalogueRow
        from torsionnet.model.catalogues.taken_entries import resized

        row = self.catalogue
        if not isinstance(row, CatalogueRow) or str(self.size) in ("", row.size):
            return []
        specs = dict(self.specs())
        changes, faults = resized(row, str(self.size), specs, {name: getattr(self, name) for name in specs})
        for name, value in changes.items():
            object.__setattr__(self, name, value)
        return faults

    @classmethod
    def from_entries(cls, name: str, **entries: Any) -> Self:
        """The element that entries describe as a file may give them: numbers, and texts with units."""
        return cls(name, **entries)

    @classmethod
    def _is_common(cls, declared: Field[Any]) -> bool:
        return declared.kw_only is True

    @classmethod
    @cache
    def _specs_of(cls, *kinds: type[Spec[object]]) -> tuple[tuple[str, Spec[object]], ...]:
        return tuple((name, spec) for name, spec in cls.specs() if isinstance(spec, kinds))

    def parts(self, value: Values) -> tuple[Part, ...]:
        """Laws and constraints, with coefficients in the algebra of ``value``."""
        raise NotImplementedError

    def twist(self, value: Values) -> Row:
        """The row whose motion is called the twist of the element."""
        return self.parts(value)[0].row

    def holds(self, value: Values) -> tuple[Row, ...]:
        """Rows that stay at zero on average: the element passes a mean speed on through them."""
        parts = self.parts(value)
        return tuple(
            part.row for part in parts if isinstance(part, Constraint) or (isinstance(part, Law) and part.is_elastic)
        )

    @property
    def ports(self) -> dict[str, str]:
        """Port name to node, the port that defines the sign of the torque first."""
        ports: dict[str, str] = {}
        for name, spec in self._specs_of(NodePair, NodeName):
            nodes = getattr(self, name)
            if isinstance(spec, NodePair):
                ports["first"], ports["second"] = nodes
            elif nodes is not None and not isinstance(spec, ReferenceNode):
                ports[name] = nodes
        return ports

    def place_of(self, at: str | None) -> int:
        """Place of a port among all, given by its name or node; None is the first port."""
        return next((place for place, pair in enumerate(self.ports.items()) if at in pair), 0)

    def sign_at(self, at: str | None) -> str:
        """What a positive torque means at a port, given by its name or node; None is the first port."""
        place = self.place_of(at)
        node = list(self.ports.values())[place]
        return f"positive when it drives out of the element into {node}" if place else self.sign

    @property
    def diameters(self) -> tuple[Expression, Expression] | None:
        """Outer and inner diameter of a round shaft; None of what has no section that could be stressed."""
        return None

    def at_own_speed(self, path: SpeedPath) -> Self:
        """A copy whose laws have the values of its own shaft, in place of those quoted at the end of ``path``."""
        return self.with_laws(path.of_own_shaft(self))

    def with_laws(self, parts: Callable[[Values], tuple[Part, ...]]) -> Self:
        """A copy with other laws in the place of those that follow from its entries."""
        found = copy(self)
        found.__dict__.update(parts=parts)
        return found

    @property
    def has_other_laws(self) -> bool:
        """Whether its laws are not those that follow from its entries alone."""
        return "parts" in self.__dict__

    @property
    def referral_fault(self) -> str | None:
        """Why its values cannot be quoted at another shaft, or None."""
        if self.diameters is not None:
            return f"{self.name} follows from its dimensions, which are those of its own shaft"
        if not any(dimension in REFERRED for _, _, _, dimension in self.expressions()):
            return f"{self.name} has no stiffness, damping or inertia that could be quoted at another shaft"
        return None

    @property
    def reads_off(self) -> bool:
        """Whether it has rows that are read off at a value of its own."""
        return any(spec.is_read_off for _, spec in self.specs())

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        """Nodes the element brings along by itself."""
        return ()

    def expanded(self) -> tuple[Element, ...]:
        """What it is a short way of writing: elements with names that begin with ``name.``, or itself."""
        return (self,)

    def renamed(self, names: Renaming) -> Self:
        """The same in a part, with the names it has in the whole."""
        found = {name: spec.renamed(value, names) for name, (spec, value) in self.scalars().items()}
        return replace(self, name=names.own(self.name), **found)

    def _key(self) -> tuple[Any, ...]:
        return (
            type(self),
            self.name,
            self.__dict__.get("parts"),
            *(getattr(self, declared.name) for declared in self.declared()),
        )

    def __eq__(self, other: object) -> bool:
        return self._key() == other._key() if isinstance(other, Element) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._key())

    def __repr__(self) -> str:
        given = "".join(f", {name}={value!r}" for name, value in self.to_data().items() if name != "type")
        return f"{type(self).__name__}({self.name!r}{given})"

    def scalars(self) -> dict[str, tuple[Spec[object], Any]]:
        """Field name to (specification, value) of everything that was given."""
        return {name: (spec, value) for name, spec in self.specs() if (value := getattr(self, name)) is not None}

    def expressions(self) -> Iterator[tuple[Path, Spec[object], Expression, str]]:
        """(path of the entry, specification, expression, dimension name) of every expression in its fields."""
        for name, spec in self._specs_of(QuantityKind, Several):
            value = getattr(self, name)
            if value is not None:
                one = spec.of if isinstance(spec, Several) else spec
                for subpath, expression, dimension in spec.expressions(value):
                    yield (name, *subpath), one, expression, dimension

    def to_data(self) -> dict[str, Json]:
        """The entry of a model file that makes this element."""
        data = {"type": self.kind, **self.written_entries()}
        if self.catalogue is None:
            return data
        from torsionnet.model.catalogues.taken_entries import entries_of

        specs = dict(self.specs())
        taken, _ = entries_of(self.catalogue, specs, {})
        same = {name for name, raw in taken.items() if name in data and specs[name].coerce(raw) == getattr(self, name)}
        return {name: value for name, value in data.items() if name not in same}

    @classmethod
    def schema(cls, *, told_by: str = "") -> Schema:
        """JSON Schema of the entry; with a catalogue, that gives what else would be required."""
        schema: dict[str, Any] = dict(super().schema(told_by=told_by))
        from_row = [name for name in schema["required"] if name != told_by]
        lone = {"not": {"required": [CATALOGUE]}}
        return {**schema, "required": [told_by] if told_by else [], "if": lone, "then": {"required": from_row}}


def make_element(kind: str, name: str, data: Mapping[str, Any]) -> Element:
    """Element of a registered type from the entries of a model file."""
    return ELEMENT_TYPES[kind](name, **data)


def viscous(damping: Any, stiffness: Any, value: Values) -> Any:
    """Viscous coefficient of a damping field: given directly, or by a damping measure of the stiffness."""
    if isinstance(damping, DampingMeasure):
        return damping.viscous(stiffness, value.parameters, value.algebra)
    return 0 if damping is None else value(damping)
