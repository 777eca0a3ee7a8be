"""Checked content of TORS files, the JSON format of openTorsion and its editor.

A file has ``components``, each a chain of ``elements``, and ``structure``, pairs ``[component.element,
component.element]`` that let a component begin where an element of another one ends. Lengths are in mm. A disk, a gear
without parent and the beginning of a shaft stand where the chain has come to; a shaft takes it to a new place, and so
does a gear with a parent, on the shaft it drives. Meaning as in ``opentorsion.Parser.from_tors`` of openTorsion 0.3.2.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from torsionnet.core.errors import Fault, Path, did_you_mean
from torsionnet.core.groups import Groups

SHEAR_MODULUS, DENSITY = 80e9, 8000.0
"""Shear modulus in Pa, which a TORS file has no entry for, and density in kg/m^3 that openTorsion takes by default."""

NUMBERS: dict[str, dict[str, str]] = {
    "Disk": {"inertia": "", "damping": "?", "stiffness": "?"},
    "ShaftDiscrete": {"stiffness": "", "damping": "?"},
    "ShaftContinuous": {"length": "+", "outerDiameter": "+", "innerDiameter": "?", "damping": "?", "density": "+?"},
    "GearElement": {"inertia": "", "diameter": "+?", "teeth": "+?"},
}
"""Numbers of each element type of TORS, by entry, with ? where one may be missing and + where it is above 0."""


@dataclass(frozen=True)
class Entry:
    """Element of a component of a TORS file, whose ``values`` are its numbers as written, by name."""

    component: str
    name: str
    kind: str
    values: Mapping[str, float]
    parent: str = ""
    node: str = ""
    excited: bool = False
    path: Path = ()

    @property
    def label(self) -> str:
        return f"{self.component}.{self.name}"


@dataclass(frozen=True)
class TorsDocument:
    """Components of a TORS file in their order, and the component that begins where an element ends."""

    name: str
    components: Mapping[str, tuple[Entry, ...]]
    onward: Mapping[tuple[str, str], tuple[str, ...]]
    start: str


def read_document(data: Any) -> tuple[TorsDocument | None, list[Fault]]:
    """Content of a TORS file, or None for a file without components, and all its faults."""
    if not isinstance(data, Mapping) or not isinstance(data.get("components"), list):
        text = 'this is no TORS file: it has no list of "components" (elements) and "structure" (connections)'
        return None, [Fault(text)]
    if not data["components"]:
        return None, [Fault("the file holds no components", ("components",))]
    components: dict[str, tuple[Entry, ...]] = {}
    faults: list[Fault] = []
    for index, raw in enumerate(data["components"]):
        path: Path = ("components", index)
        name = raw.get("name") if isinstance(raw, Mapping) else None
        if not isinstance(name, str) or not isinstance(raw.get("elements"), list) or not raw["elements"]:
            faults.append(Fault("a component has a name and a list of elements", path))
        elif name in components:
            faults.append(Fault(f'two components are named "{name}"', path))
        else:
            components[name], found = _entries(name, raw["elements"], (*path, "elements"))
            faults += found
    onward, found = _connections(data.get("structure", []), components)
    faults += found
    start, found = _start(components, onward)
    faults += found
    title = data.get("name")
    return TorsDocument(title if isinstance(title, str) and title else "TORS model", components, onward, start), faults


def _entries(component: str, raw: list[Any], path: Path) -> tuple[tuple[Entry, ...], list[Fault]]:
    entries: list[Entry] = []
    faults: list[Fault] = []
    for index, item in enumerate(raw):
        place = (*path, index)
        if not isinstance(item, Mapping) or not isinstance(item.get("name"), str):
            faults.append(Fault("an element needs a name and a type; one of them is missing", place))
            continue
        if item["name"] in {entry.name for entry in entries}:
            faults.append(Fault(f'two elements of {component} are named "{item["name"]}"', place))
            continue
        kind = item.get("type")
        if kind not in NUMBERS:
            hint = did_you_mean(str(kind), NUMBERS) or f"; there are {', '.join(NUMBERS)}"
            faults.append(Fault(f'no type of element is named "{kind}"{hint}', (*place, "type")))
            continue
        values, found = _values(item, place)
        faults += found
        parent = item.get("parent") or ""
        gears = [entry.name for entry in entries if entry.kind == "GearElement"]
        if parent and parent not in gears:
            text = f'no gear before it in {component} is named "{parent}"{did_you_mean(str(parent), gears)}'
            faults.append(Fault(text, (*place, "parent")))
        node = item.get("node", "")
        entries.append(
            Entry(
                component, item["name"], kind, values, str(parent), node if isinstance(node, str) else "",
                excited="excitation" in item, path=place,
            )
        )  # fmt: skip
    return tuple(entries), faults


def _values(item: Mapping[str, Any], path: Path) -> tuple[dict[str, float], list[Fault]]:
    values: dict[str, float] = {}
    faults: list[Fault] = []
    for key, mark in NUMBERS[item["type"]].items():
        raw, positive = item.get(key), "+" in mark
        if raw is None and "?" in mark:
            continue
        if isinstance(raw, bool) or not isinstance(raw, int | float) or raw != raw or abs(raw) == float("inf"):
            faults.append(Fault(f"{item['type']} needs a number as {key}, got {raw!r}", (*path, key)))
        elif raw < 0 or (raw == 0 and positive):
            word = "greater than 0" if positive else "not less than 0"
            faults.append(Fault(f"{key} must be {word}, got {raw}", (*path, key)))
        else:
            values[key] = raw
    if item["type"] == "GearElement" and not faults and not {"teeth", "diameter"} & values.keys():
        faults.append(Fault("a gear needs teeth or a diameter", path))
    return values, faults


def _connections(
    raw: object, components: Mapping[str, tuple[Entry, ...]]
) -> tuple[dict[tuple[str, str], tuple[str, ...]], list[Fault]]:
    onward: dict[tuple[str, str], tuple[str, ...]] = {}
    faults: list[Fault] = []
    if not isinstance(raw, list):
        return onward, [Fault(f"expected pairs of component.element, got {raw!r}", ("structure",))]
    entered: set[str] = set()
    for index, pair in enumerate(raw):
        path: Path = ("structure", index)
        if not isinstance(pair, list) or len(pair) != 2 or not all(isinstance(end, str) for end in pair):
            faults.append(Fault(f"expected [component.element, component.element], got {pair!r}", path))
            continue
        ends = [_end(text, components, (*path, side)) for side, text in enumerate(pair)]
        faults += [end for end in ends if isinstance(end, Fault)]
        source, target = ends
        if isinstance(source, Fault) or isinstance(target, Fault):
            continue
        if target[1] != components[target[0]][0].name:
            first = f"{target[0]}.{components[target[0]][0].name}"
            text = f"a component begins with its first element: connect {pair[0]} to {first}, not to {pair[1]}"
            faults.append(Fault(text, (*path, 1)))
        elif target[0] in entered:
            faults.append(
                Fault(
                    f'component "{target[0]}" begins at two places; connect it at one, as TORS holds no loops',
                    (*path, 1),
                )
            )
        else:
            entered.add(target[0])
            onward[source] = (*onward.get(source, ()), target[0])
    return onward, faults


def _end(text: str, components: Mapping[str, tuple[Entry, ...]], path: Path) -> tuple[str, str] | Fault:
    known = [(name, entry.name) for name, entries in components.items() for entry in entries]
    for name, element in known:
        if text == f"{name}.{element}":
            return name, element
    hint = did_you_mean(text, [f"{name}.{element}" for name, element in known])
    return Fault(f'there is no element "{text}"{hint}', path)


def _start(
    components: Mapping[str, tuple[Entry, ...]], onward: Mapping[tuple[str, str], tuple[str, ...]]
) -> tuple[str, list[Fault]]:
    """Component of a TORS file that no connection leads to, from which all others are reached, and faults."""
    entered = {name for names in onward.values() for name in names}
    free = [name for name in components if name not in entered]
    if len(free) != 1:
        listed = ", ".join(free) or "none"
        text = f"the components must form one connected tree; without a connection into them: {listed}"
        return "", [Fault(text, ("structure",))] if components else []
    joined = Groups(components)
    for (source, _), targets in onward.items():
        joined.join(source, *targets)
    lost = [name for name in components if name not in joined.of(free[0])]
    return free[0], [Fault(f"{', '.join(lost)} are not connected to {free[0]}", ("structure",))] if lost else []
