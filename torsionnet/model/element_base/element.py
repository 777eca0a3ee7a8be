"""Base class of all element types, and the register of element types.

A new element type is one class in a file of ``model/elements`` named as its ``kind``, or in that of its family
(`ELEMENT_TYPES`): a frozen dataclass whose fields carry specifications (:mod:`torsionnet.base.entries`), and a method
``own_parts`` that yields laws and constraints.
Registering it makes it known to model files, the JSON Schema, the checks and the documentation.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar, final

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import QuantityKind
from torsionnet.base.entries.spec import Flag, Json, Renaming, Schema, Spec, Text, entry, name_fault
from torsionnet.base.errors import EntryPath, Fault, ModelError, fault_of, got
from torsionnet.base.expressions import Expression
from torsionnet.base.packages import ArgumentHints
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.base.registers import TypeRegister, settle
from torsionnet.model.damping import DampingMeasure
from torsionnet.model.element_base.element_entries import (
    CATALOGUE,
    SIZE,
    CatalogueEntry,
    MultipleValues,
    NodeName,
    NodePair,
    QuantityGroup,
    ReferenceNode,
    SizeName,
)
from torsionnet.model.element_base.laws import (
    AT_REST,
    Constraint,
    Law,
    MotionLaw,
    MotionState,
    Part,
    Row,
    Values,
    WholePart,
)

if TYPE_CHECKING:
    from torsionnet.model.catalogues.catalogue import CatalogueRow

ELEMENT_TYPES: TypeRegister[type[Element]] = TypeRegister(
    "torsionnet.model.elements",
    {
        "masses_and_springs": ("inertia", "spring", "damper", "lock"),
        "gears": ("rigid_coupling", "gear", "planetary", "differential"),
        "contacts": ("clearance", "friction"),
        "dampers": ("viscous_damper", "tuned_damper", "spring_damper", "pendulum_absorber"),
        "electric_machines": ("synchronous_machine", "induction_machine", "grid_generator"),
        "flexible_couplings": ("flexible_coupling", "tabulated_spring", "hysteretic_spring"),
        "fluid_couplings": ("fluid_coupling", "torque_converter"),
        "gearboxes": ("gearbox", "final_drive"),
        "loads": ("propeller", "constant_power_load"),
        "loop_drives": ("belt", "chain_drive"),
        "vehicles": ("vehicle", "tyre"),
    },
    group="torsionnet.elements",
)
"""Class of every element type, by the word in ``type:``, in alphabetical order; a module is imported when its kind is
first used."""

REFERRED = ("stiffness", "damping", "inertia")
"""Names of the dimensions of values that may be quoted at the speed of another shaft."""

E = TypeVar("E", bound="Element")


def register(cls: type[E]) -> type[E]:
    """Class decorator that registers an element type under its ``kind``."""
    ELEMENT_TYPES[cls.kind] = cls
    return cls


def element_classes() -> dict[str, type[Element]]:
    """Registered element types by class name, as in ``torsionnet.Spring``."""
    return {cls.__name__: cls for cls in ELEMENT_TYPES.values()}


def element_class(name: str) -> type[Element] | None:
    """Element type of a class name, as in ``torsionnet.Spring``, or None; only its own file is imported."""
    kind = re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()
    cls = ELEMENT_TYPES.get(kind)
    return cls if cls is not None and cls.__name__ == name else element_classes().get(name)


@dataclass(frozen=True, eq=False, repr=False)
class Element(Declared, ArgumentHints):
    """Base class of a drivetrain element: an inertia, spring, gear, machine.

    Attributes
    ----------
    name : str
        Unique in its drivetrain.
    description : str
        Free text for tables and reports.
    enabled : bool
        A disabled element takes no part until a configuration switches it on.
    catalogue, size : CatalogueRow and str, optional
        Table and row that give the entries that the model leaves out.
    """

    kind: ClassVar[str] = ""
    """Word in ``type:`` of a model file that stands for the element type."""
    glyph: ClassVar[str] = ""
    """Name of the element type's symbol in the schematic, as disc, spring or gear; types that behave alike share it."""
    sign: ClassVar[str] = "positive when it drives from the first node into the element"
    """Meaning of a positive torque at the element's first port; at other ports it drives out of the element."""
    drives: ClassVar[bool] = False
    """Whether a positive torque at the first port drives out of the element, as that of a machine does."""
    absorbs: ClassVar[bool] = False
    """Whether the element takes power out of the drivetrain at its node, as a propeller does."""
    may_end_anywhere: ClassVar[bool] = False
    """Whether the element may be the only one at a node, since it has inertia there."""
    may_feed: ClassVar[bool] = False
    """Whether the element may feed energy into a vibration, by an action or by negative damping."""

    working_point: ClassVar[tuple[str, ...]] = ()
    """Names of entries that name the working point of the element's laws of motion, about which it is then linear."""
    when_stuck: ClassVar[str] = ""
    """Advice on what to give where friction should not make the element rigid in linear results; empty: none needed."""

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
    other_laws: OtherLaws | None = field(default=None, init=False)
    """Laws in place of those that follow from the entries; a copy with other entries has none."""

    def __post_init__(self) -> None:
        reason = (
            name_fault(self.name)
            if isinstance(self.name, str)
            else f"the name of an element is a text, {got(self.name)}"
        )
        faults = [fault_of(reason, "invalid-name")] if reason else []
        faults += [] if self.catalogue is None else self._looked_up() or self._resized()
        faults += self.coerced()
        # What contradicts each other can be said only of entries that are sound by themselves.
        faults = faults or self.contradictions()
        if faults:
            raise ModelError([fault.under("elements", str(self.name)) for fault in faults], f"element {self.name!r}")

    def _looked_up(self) -> list[Fault]:
        """Fill entries that are not given from the element's catalogue file, and return the faults.

        None counts as not given.
        """
        from torsionnet.model.catalogues.catalogue import Catalogue
        from torsionnet.model.catalogues.catalogue_reading import chosen_row, row_entries

        if not isinstance(self.catalogue, Catalogue | PurePath):
            return []
        row, faults = chosen_row({CATALOGUE: self.catalogue, SIZE: self.size or None})
        if row is None:
            settle(self, catalogue=None)
            return faults
        specs, defaults = dict(self.specs()), self.defaults()
        given = {name: getattr(self, name) for name in specs}
        # An entry beside the catalogue wins over the row; a default counts as not given.
        given = {name: raw for name, raw in given.items() if raw is not None and raw is not defaults.get(name)}
        taken, faults = row_entries(row, specs, given)
        settle(self, **taken, catalogue=row)
        return faults

    def _resized(self) -> list[Fault]:
        """Take the catalogue row of another size, where a configuration names one, and return the faults."""
        from torsionnet.model.catalogues.catalogue import CatalogueRow
        from torsionnet.model.catalogues.catalogue_reading import entries_of_other_size

        row = self.catalogue
        if not isinstance(row, CatalogueRow) or str(self.size) in ("", row.size):
            return []
        specs = dict(self.specs())
        changes, faults = entries_of_other_size(
            row, str(self.size), specs, {name: getattr(self, name) for name in specs}
        )
        settle(self, **changes)
        return faults

    @classmethod
    def from_entries(cls, name: str, **entries: Any) -> Self:
        """Element made from entries as a file gives them: numbers, and texts with units."""
        return cls(name, **entries)

    @classmethod
    @cache
    def _specs_of(cls, *kinds: type[Spec[object]]) -> tuple[tuple[str, Spec[object]], ...]:
        return tuple((name, spec) for name, spec in cls.specs() if isinstance(spec, kinds))

    def value_faults(self, value: Values) -> list[Fault]:
        """Faults of entries that contradict each other with the values of parameters, with their path in the element.

        Those of plain numbers :meth:`contradictions` has told before.
        """
        del value
        return []

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        """Laws, constraints and actions that follow from the entries, which an element type has to say."""
        raise NotImplementedError

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        """Parts that follow from the entries with laws of motion in full; most element types have none."""
        return self.parts(value)

    def own_tangent_parts(self, value: Values, states: Sequence[MotionState] = ()) -> tuple[Part, ...]:
        """Parts that follow from the entries for small motion about states."""
        parts: list[Part] = []
        given = iter(states)
        for part in self.whole_parts(value):
            # States belong to the laws of motion alone, in the order of these.
            parts += part.tangent(next(given, AT_REST)) if isinstance(part, MotionLaw) else (part,)
        return tuple(parts)

    @final
    def parts(self, value: Values) -> tuple[Part, ...]:
        """Laws, constraints and actions of the element, with coefficients in the algebra of ``value``."""
        return self.own_parts(value) if self.other_laws is None else self.other_laws.parts(value)

    @final
    def whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        """Parts of the element with its laws of motion in full, where :meth:`parts` has their tangents.

        Most elements have none: the two are the same.
        """
        return self.own_whole_parts(value) if self.other_laws is None else self.other_laws.whole_parts(value)

    @final
    def tangent_parts(self, value: Values, states: Sequence[MotionState] = ()) -> tuple[Part, ...]:
        """Parts of the element for small motion about a state of each of its laws of motion, in their order.

        Without states all rows rest without twist.
        """
        laws = self.other_laws
        return self.own_tangent_parts(value, states) if laws is None else laws.tangent_parts(value, states)

    @property
    def has_motion_laws(self) -> bool:
        """Whether :meth:`whole_parts` has laws of motion, of which :meth:`parts` has the tangents."""
        return type(self).own_whole_parts is not Element.own_whole_parts

    @property
    def over_time(self) -> Self:
        """Element with laws for motion over time that linear results do without, as friction that remembers."""
        laws = self.other_laws
        if laws is None:
            return self
        inner = laws.element.over_time
        return self if inner is laws.element else self.with_laws(replace(laws, element=inner))

    @property
    def has_own_working_point(self) -> bool:
        """Whether entries of the element name the working point about which :meth:`parts` is linear."""
        return any(getattr(self, name) is not None for name in self.working_point)

    def at_states(self, states: Sequence[MotionState]) -> Self:
        """Copy of the element with tangents about a state of each of its laws of motion in place of these."""
        return self.with_laws(TangentLaws(self, tuple(states)))

    def twist(self, value: Values) -> Row:
        """Row of node angles whose motion is the twist of the element."""
        return self.parts(value)[0].row

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """Rows of node speeds whose weighted sum is zero on average, by which the element transmits speeds.

        A law of motion over the twist transmits them even where it has no stiffness, as across a gap.
        """
        parts = self.parts(value)
        rows = [
            part.row for part in parts if isinstance(part, Constraint) or (isinstance(part, Law) and part.is_elastic)
        ]
        if self.has_motion_laws:
            laws = [part for part in self.whole_parts(value) if isinstance(part, MotionLaw)]
            # A curve over twist ties mean positions, as a spring does; one over speed leaves the shafts to slip.
            rows += [law.row for law in laws if law.curve.over == "twist" and law.row not in rows]
        return tuple(rows)

    @property
    def ports(self) -> dict[str, str]:
        """Name of the node that each port of the element is attached to, by port name.

        The first port defines the sign of the torque.
        """
        ports: dict[str, str] = {}
        for name, spec in self._specs_of(NodePair, NodeName):
            nodes = getattr(self, name)
            if isinstance(spec, NodePair):
                ports["first"], ports["second"] = nodes
            elif nodes is not None and not isinstance(spec, ReferenceNode):
                ports[name] = nodes
        return ports

    def place_of(self, at: str | None) -> int:
        """Index of a port of the element that is given by its name or node; None is the first port."""
        return next((place for place, pair in enumerate(self.ports.items()) if at in pair), 0)

    def sign_at(self, at: str | None) -> str:
        """Meaning, as text, of a positive torque at a port that is given by its name or node.

        None is the first port.
        """
        place = self.place_of(at)
        node = list(self.ports.values())[place]
        return phrase("positive when it drives out of the element into {node}", node=node) if place else self.sign

    @property
    def diameters(self) -> tuple[Expression, Expression] | None:
        """Outer and inner diameter in m of a round shaft, or None for an element without a stressed section."""
        return None

    def with_laws(self, laws: OtherLaws) -> Self:
        """Copy of the element with other laws in place of those that follow from its entries."""
        return self.unchecked(other_laws=laws)

    @property
    def is_at_own_speed(self) -> bool:
        """Whether the laws of the element were converted from another shaft, and not replaced otherwise."""
        return self.other_laws is not None and self.other_laws.are_converted

    @property
    def referral_fault(self) -> str | None:
        """Message if the values of the element cannot be quoted at another shaft, else None."""
        if self.diameters is not None:
            return phrase("{} follows from its dimensions, which are those of its own shaft", ModelName(self.name))
        if not any(dimension in REFERRED for _, _, _, dimension in self.expressions()):
            said = "{} has no stiffness, damping or inertia that could be quoted at another shaft"
            return phrase(said, ModelName(self.name))
        return None

    @property
    def reads_off(self) -> bool:
        """Whether the element has a curve that is read at an operating value of the element."""
        return any(spec.is_read_off for _, spec in self.specs())

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        """Names of the nodes that the element adds to the drivetrain."""
        return ()

    def expanded(self) -> tuple[Element, ...]:
        """Elements that the element stands for, named ``name.x``; most elements return themselves."""
        return (self,)

    def renamed(self, names: Renaming) -> Self:
        """Copy of the element of a part, with its names in the whole model."""
        renamed = {name: spec.renamed(value, names) for name, (spec, value) in self.scalars().items()}
        return replace(self, name=names.own(self.name), **renamed)

    def _key(self) -> tuple[Any, ...]:
        return (
            type(self),
            self.name,
            self.other_laws,
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
        """Specification and value of every entry that the element gives, by field name."""
        return {name: (spec, value) for name, spec in self.specs() if (value := getattr(self, name)) is not None}

    def expressions(self) -> Iterator[tuple[EntryPath, Spec[object], Expression, str]]:
        """Path, specification, expression and dimension name of every expression in the element's entries."""
        for name, spec in self._specs_of(QuantityKind, MultipleValues, QuantityGroup):
            value = getattr(self, name)
            if value is None or value == ():
                continue
            if isinstance(spec, QuantityGroup):
                for subpath, of, expression, dimension in spec.quantities(value):
                    yield (name, *subpath), of, expression, dimension
            else:
                kind = spec.of if isinstance(spec, MultipleValues) else spec
                for subpath, expression, dimension in spec.expressions(value):
                    yield (name, *subpath), kind, expression, dimension

    def to_data(self) -> dict[str, Json]:
        """Entries of the element as a model file has them."""
        data = {"type": self.kind, **self.written_entries()}
        if self.catalogue is None:
            return data
        from torsionnet.model.catalogues.catalogue_reading import row_entries

        specs = dict(self.specs())
        taken, _ = row_entries(self.catalogue, specs, {})
        # What the row says anyway is left to it, so that another size brings its own values.
        same = {name for name, raw in taken.items() if name in data and specs[name].coerce(raw) == getattr(self, name)}
        return {name: value for name, value in data.items() if name not in same}

    @classmethod
    def schema(cls, *, type_key: str = "") -> Schema:
        """JSON Schema of the element's entries in a model file; a catalogue may give the required ones."""
        schema: dict[str, Any] = dict(super().schema(type_key=type_key))
        from_row = [name for name in schema["required"] if name != type_key]
        # A row of a catalogue may give any entry, so that only without one they are required.
        lone = {"not": {"required": [CATALOGUE]}}
        return {**schema, "required": [type_key] if type_key else [], "if": lone, "then": {"required": from_row}}


def make_element(kind: str, name: str, data: Mapping[str, Any]) -> Element:
    """Element of a registered type from the entries of a model file."""
    return ELEMENT_TYPES[kind](name, **data)


def viscous(damping: Any, stiffness: Any, value: Values) -> Any:
    """Viscous coefficient in N m s/rad of a damping entry, given directly or by a measure of the stiffness."""
    if isinstance(damping, DampingMeasure):
        return damping.viscous(stiffness, value.parameters, value.algebra)
    return 0 if damping is None else value(damping)


@dataclass(frozen=True)
class OtherLaws:
    """Laws in place of those that follow from the entries of an element; each kind says how its parts are made."""

    are_converted: ClassVar[bool] = False
    """Whether they are those of the element, only converted from another shaft."""

    element: Element

    def parts(self, value: Values) -> tuple[Part, ...]:
        """Parts of the element that follow from these laws."""
        raise NotImplementedError

    def whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        """Parts of the element as it was, where it has laws of motion, else those that follow from these laws."""
        whole = self.element.whole_parts(value)
        return whole if any(isinstance(part, MotionLaw) for part in whole) else self.parts(value)

    def tangent_parts(self, value: Values, states: Sequence[MotionState] = ()) -> tuple[Part, ...]:
        """Tangents of the laws of motion of the element as it was."""
        return self.element.tangent_parts(value, states)


@dataclass(frozen=True)
class TangentLaws(OtherLaws):
    """Tangents of the laws of motion of an element about given states."""

    states: tuple[MotionState, ...]

    def parts(self, value: Values) -> tuple[Part, ...]:
        return self.element.tangent_parts(value, self.states)
