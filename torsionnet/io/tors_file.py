"""Declared content of a whole TORS file: components, and which begins at which element of another one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from torsionnet.base.entries.composite import Listed, Nested, PairOf
from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import Fault, did_you_mean
from torsionnet.base.registers import Groups
from torsionnet.io.tors_elements import ELEMENT_TYPES, AsWritten, GearElement, TorsElement, TorsPart, TypedTorsElement

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
            return [Fault("a component needs at least one element", ("elements",))]
        faults = _same_names(f"elements of {self.name}", "elements", self.elements)
        gears: dict[str, GearElement] = {}
        for index, wheel in enumerate(self.elements):
            if not isinstance(wheel, GearElement):
                continue
            parent = gears.get(wheel.parent or "")
            if parent and not wheel.sizes_against(parent):
                meshing = f"{self.name}.{parent.name} and {self.name}.{wheel.name}"
                faults.append(Fault(f"{meshing} mesh; give both teeth, or both a diameter", ("elements", index)))
            elif wheel.parent and not parent:
                text = f'no gear before it in {self.name} is named "{wheel.parent}"{did_you_mean(wheel.parent, gears)}'
                faults.append(Fault(text, ("elements", index, "parent")))
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
        return {f"{name}.{one.name}": (name, one.name) for name, elements in self.chains.items() for one in elements}

    @cached_property
    def onward(self) -> Mapping[tuple[str, str], tuple[str, ...]]:
        """Components that begin at the end of an element, by the names of its component and its own."""
        found: dict[tuple[str, str], tuple[str, ...]] = {}
        for source, target in self.structure:
            start = self.ends[source]
            found[start] = (*found.get(start, ()), self.ends[target][0])
        return found

    @cached_property
    def starts(self) -> tuple[str, ...]:
        """Components that no connection leads to; one, from which all others are reached."""
        entered = {self.ends[target][0] for _, target in self.structure}
        return tuple(name for name in self.chains if name not in entered)

    def contradictions(self) -> list[Fault]:
        if not self.components:
            return [Fault("the file holds no components", ("components",))]
        faults = _same_names("components", "components", self.components)
        return faults or self._connection_faults() or self._tree_faults()

    def _connection_faults(self) -> list[Fault]:
        faults: list[Fault] = []
        entered: set[str] = set()
        for index, (source, target) in enumerate(self.structure):
            unknown = [
                Fault(f'there is no element "{end}"{did_you_mean(end, self.ends)}', ("structure", index, side))
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
                faults.append(Fault(text, ("structure", index, 1)))
            elif name in entered:
                text = f'component "{name}" begins at two places; connect it at one, as TORS holds no loops'
                faults.append(Fault(text, ("structure", index, 1)))
            entered.add(name)
        return faults

    def _tree_faults(self) -> list[Fault]:
        if len(self.starts) != 1:
            listed = ", ".join(self.starts) or "none"
            text = f"the components must form one connected tree; without a connection into them: {listed}"
            return [Fault(text, ("structure",))]
        joined = Groups(self.chains)
        for (source, _), targets in self.onward.items():
            joined.join(source, *targets)
        lost = [name for name in self.chains if name not in joined.of(self.starts[0])]
        return [Fault(f"{', '.join(lost)} are not connected to {self.starts[0]}", ("structure",))] if lost else []


def _same_names(what: str, key: str, parts: Sequence[TorsComponent] | Sequence[TorsElement]) -> list[Fault]:
    names = [part.name for part in parts]
    doubles = [(index, name) for index, name in enumerate(names) if names.index(name) < index]
    return [Fault(f'two {what} are named "{name}"', (key, index)) for index, name in doubles]
