"""Declared content of a whole TORS file: components, and which begins at which element of another one.

Declared content of TORS files, the JSON format of openTorsion and its editor. A file has ``components``, each a chain
of ``elements``, and ``structure``, pairs ``[component.element, component.element]`` that let a component begin where an
element of another one ends. Lengths are in mm. A disk, a gear without parent and the beginning of a shaft stand where
the chain has come to; a shaft takes it to a new place, and so does a gear with a parent, on the shaft it drives.
Meaning as in ``opentorsion.Parser.from_tors`` of openTorsion 0.3.2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Any, ClassVar

from torsionnet.base.entries.composite import Listed, Nested, PairOf, Typed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.plain_numbers import PlainNumber
from torsionnet.base.entries.spec import EntryError, Json, Spec, Text, entry
from torsionnet.base.errors import Fault, did_you_mean
from torsionnet.base.registers import Groups

# Declared content of TORS files, the JSON format of openTorsion and its editor.

SHEAR_MODULUS, DENSITY = 80e9, 8000.0
"""Shear modulus in Pa, which a TORS file has no entry for, and density in kg/m^3 that openTorsion takes by default."""


@dataclass(frozen=True, eq=False, repr=False)
class Size(PlainNumber):
    """Entry of a finite number, kept as it is written, which in a file is not below 0, or above 0 if ``exclusive``.

    Negative damping, as that of a load of constant power, is written for openTorsion all the same.
    """

    exclusive: bool = False

    def coerce(self, raw: object) -> float:
        if isinstance(raw, bool) or not isinstance(raw, int | float) or not -inf < raw < inf:
            raise EntryError(f"expected a number as {self.description}, got {raw!r}", kind="not-a-number")
        return raw

    def read(self, raw: object) -> tuple[float | None, list[Fault]]:
        value, faults = super().read(raw)
        if value is None or value > 0 or (value == 0 and not self.exclusive):
            return value, faults
        bound = "be greater than" if self.exclusive else "not be less than"
        return None, [Fault(f"{self.description} must {bound} 0, got {raw!r}", kind="out-of-range")]


class AsWritten(Spec[object]):
    """Entry of anything, kept as it is written."""

    def coerce(self, raw: object) -> object:
        return raw


class TorsPart(Declared):
    """Base of the parts of a TORS file, whose fields have the names of its keys.

    Other programs have keys of their own and leave entries without a value; both are passed over.
    """

    @classmethod
    def key_faults(cls, raw: Mapping[Any, Any], name: str = "") -> list[Fault]:
        return [cls.missing(key, name) for key in cls.required() if key not in raw]

    def written_entries(self) -> dict[str, Json]:
        """Plain value of every entry that has one, by name, because defaults of other programs may be others."""
        return {name: spec.plain(value) for name, spec in self.specs() if (value := getattr(self, name)) is not None}


@dataclass(frozen=True, eq=False, kw_only=True)
class TorsElement(TorsPart):
    """Element of a component of a TORS file, of one of the types in :data:`ELEMENT_TYPES`."""

    is_shaft: ClassVar[bool] = False

    name: str = entry(Text("text that no other element of the component has"))
    node: object = entry(AsWritten("name of the node at its end, by torsionnet"), None)
    excitation: object = entry(AsWritten("torque on it"), None)

    common: ClassVar[tuple[str, ...]] = ("node", "excitation")

    def to_data(self) -> Json:
        return {"name": self.name, "type": self.kind, **self.written_entries()}


@dataclass(frozen=True, eq=False, kw_only=True)
class Disk(TorsElement):
    """Disk of a TORS file, with a damper and spring to ground."""

    kind = "Disk"

    inertia: float = entry(Size("inertia in kg m^2"))
    damping: float = entry(Size("damping to ground in N m s/rad"), 0.0)
    stiffness: float | None = entry(Size("stiffness to ground in N m/rad"), None)


@dataclass(frozen=True, eq=False, kw_only=True)
class ShaftDiscrete(TorsElement):
    """Shaft without inertia of a TORS file."""

    kind = "ShaftDiscrete"
    is_shaft = True

    stiffness: float = entry(Size("stiffness in N m/rad"))
    damping: float = entry(Size("damping in N m s/rad"), 0.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class ShaftContinuous(TorsElement):
    """Round shaft with inertia of a TORS file."""

    kind = "ShaftContinuous"
    is_shaft = True

    length: float = entry(Size("length in mm", exclusive=True))
    outerDiameter: float = entry(Size("outer diameter in mm", exclusive=True))
    innerDiameter: float = entry(Size("inner diameter in mm"), 0.0)
    density: float = entry(Size("density in kg/m^3", exclusive=True), DENSITY)
    damping: float | None = entry(Size("damping in N m s/rad"), None)

    def contradictions(self) -> list[Fault]:
        has_wall = self.innerDiameter < self.outerDiameter
        return (
            []
            if has_wall
            else [Fault("the inner diameter must be smaller than the outer one", kind="contradicting-values")]
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class GearElement(TorsElement):
    """Wheel of a TORS file, with a parent the wheel that it meshes with."""

    kind = "GearElement"

    inertia: float = entry(Size("inertia in kg m^2"))
    diameter: float | None = entry(Size("diameter in mm", exclusive=True), None)
    teeth: float | None = entry(Size("number of teeth", exclusive=True), None)
    parent: str | None = entry(Text("name of the wheel before it that it meshes with"), None)

    def contradictions(self) -> list[Fault]:
        return [] if self.teeth or self.diameter else [Fault("a gear needs teeth or a diameter", kind="missing-entry")]

    def sizes_against(self, parent: GearElement) -> tuple[float, float] | None:
        """Sizes of parent and wheel by which they mesh, in teeth or diameters, or None where they have none alike."""
        pairs = ((parent.teeth, self.teeth), (parent.diameter, self.diameter))
        return next(((first, second) for first, second in pairs if first and second), None)


ELEMENT_TYPES: Mapping[str, type[TorsElement]] = {
    cls.kind: cls for cls in (Disk, ShaftDiscrete, ShaftContinuous, GearElement)
}
"""Classes of elements of TORS files by their ``type``."""


class TypedTorsElement(Typed[TorsElement]):
    """Entry of an element of a TORS file, which is written with its name before its type."""

    def plain(self, value: Any) -> Json:
        return TorsElement.to_data(value)


_PAIR = PairOf("connection", Text("element", "component.element"), "[component.element, component.element]")


@dataclass(frozen=True, eq=False, kw_only=True)
class TorsComponent(TorsPart):
    """Component of a TORS file, a chain of elements."""

    kind = "component"
    article = "a component"
    form = "{name: ..., elements: [...]}"

    name: str = entry(Text("text that no other component has"))
    elements: tuple[TorsElement, ...] = entry(
        Listed("list of elements", TypedTorsElement("element", lambda: ELEMENT_TYPES, "element", "element"))
    )

    def contradictions(self) -> list[Fault]:
        if not self.elements:
            return [Fault("a component needs at least one element", ("elements",), kind="missing-entry")]
        faults = _same_names(f"elements of {self.name}", "elements", self.elements)
        gears: dict[str, GearElement] = {}
        for index, wheel in enumerate(self.elements):
            if not isinstance(wheel, GearElement):
                continue
            parent = gears.get(wheel.parent or "")
            if parent and not wheel.sizes_against(parent):
                meshing = f"{self.name}.{parent.name} and {self.name}.{wheel.name}"
                faults.append(
                    Fault(
                        f"{meshing} mesh; give both teeth, or both a diameter",
                        ("elements", index),
                        kind="missing-entry",
                    )
                )
            elif wheel.parent and not parent:
                text = f'no gear before it in {self.name} is named "{wheel.parent}"{did_you_mean(wheel.parent, gears)}'
                faults.append(Fault(text, ("elements", index, "parent"), kind="unknown-element"))
            gears[wheel.name] = wheel
        return faults


@dataclass(frozen=True, eq=False, kw_only=True)
class TorsFile(TorsPart):
    """Content of a TORS file, whose components form one tree."""

    kind = "TORS file"

    name: object = entry(AsWritten("title"), None)
    date: object = entry(AsWritten("date, without which the editor of openTorsion opens no file"), None)
    notes: object = entry(AsWritten("what a model has that the file does not hold"), None)
    components: tuple[TorsComponent, ...] = entry(
        Listed("components", Nested("component", lambda: TorsComponent, "component"))
    )
    structure: tuple[tuple[str, str], ...] = entry(Listed("connections", _PAIR, "pairs of component.element"), ())

    @cached_property
    def chains(self) -> Mapping[str, tuple[TorsElement, ...]]:
        """Elements of each component, by its name."""
        return {component.name: component.elements for component in self.components}

    @cached_property
    def ends(self) -> Mapping[str, tuple[str, str]]:
        """Names of component and element by ``component.element``."""
        return {
            f"{name}.{element.name}": (name, element.name)
            for name, elements in self.chains.items()
            for element in elements
        }

    @cached_property
    def onward(self) -> Mapping[tuple[str, str], tuple[str, ...]]:
        """Components that begin at the end of an element, by the names of its component and its own."""
        onward: dict[tuple[str, str], tuple[str, ...]] = {}
        for source, target in self.structure:
            start = self.ends[source]
            onward[start] = (*onward.get(start, ()), self.ends[target][0])
        return onward

    @cached_property
    def starts(self) -> tuple[str, ...]:
        """Components that no connection leads to; one, from which all others are reached."""
        entered = {self.ends[target][0] for _, target in self.structure}
        return tuple(name for name in self.chains if name not in entered)

    def contradictions(self) -> list[Fault]:
        if not self.components:
            return [Fault("the file holds no components", ("components",), kind="missing-entry")]
        faults = _same_names("components", "components", self.components)
        return faults or self._connection_faults() or self._tree_faults()

    def _connection_faults(self) -> list[Fault]:
        faults: list[Fault] = []
        entered: set[str] = set()
        for index, (source, target) in enumerate(self.structure):
            unknown = [
                Fault(
                    f'there is no element "{end}"{did_you_mean(end, self.ends)}',
                    ("structure", index, side),
                    kind="unknown-element",
                )
                for side, end in enumerate((source, target))
                if end not in self.ends
            ]
            faults += unknown
            if unknown:
                continue
            name, element = self.ends[target]
            first = self.chains[name][0].name
            if element != first:
                text = f"a component begins with its first element: connect {source} to {name}.{first}, not to {target}"
                faults.append(Fault(text, ("structure", index, 1), kind="no-counterpart"))
            elif name in entered:
                text = f'component "{name}" begins at two places; connect it at one, as TORS holds no loops'
                faults.append(Fault(text, ("structure", index, 1), kind="no-counterpart"))
            entered.add(name)
        return faults

    def _tree_faults(self) -> list[Fault]:
        if len(self.starts) != 1:
            listed = ", ".join(self.starts) or "none"
            text = f"the components must form one connected tree; without a connection into them: {listed}"
            return [Fault(text, ("structure",), kind="unconnected-nodes")]
        joined = Groups(self.chains)
        for (source, _), targets in self.onward.items():
            joined.join(source, *targets)
        lost = [name for name in self.chains if name not in joined.of(self.starts[0])]
        return (
            [
                Fault(
                    f"{', '.join(lost)} are not connected to {self.starts[0]}", ("structure",), kind="unconnected-nodes"
                )
            ]
            if lost
            else []
        )


def _same_names(what: str, key: str, parts: Sequence[TorsComponent] | Sequence[TorsElement]) -> list[Fault]:
    names = [part.name for part in parts]
    doubles = [(index, name) for index, name in enumerate(names) if names.index(name) < index]
    return [Fault(f'two {what} are named "{name}"', (key, index), kind="repeated-name") for index, name in doubles]
