"""Explanations of what a model text names: parameters, nodes, elements and others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from torsionnet.app.text.explaining.hover_entries import class_of, first_sentence
from torsionnet.app.text.explaining.value_words import KnownValues, code, prose
from torsionnet.app.text.named_places import NamedPlace, NamesInText
from torsionnet.app.text.naming.mentions import Scope
from torsionnet.base.errors import TorsionnetError
from torsionnet.base.number_text import screen_text

MOST_LISTED = 12
"""Largest number of things that an explanation lists."""


def thing_words(place: NamedPlace, names: NamesInText) -> str:
    """Explanation of what is named at a place of a text; empty where there is nothing to say."""
    scope = scope_of(place, names)
    if scope is None:
        return ""
    if place.kind == "parameter":
        return _parameter(place, scope, names)
    if place.kind == "node":
        return _node(place, scope, names)
    if place.kind == "element":
        return _element(place, scope)
    return _other(place, scope)


def scope_of(place: NamedPlace, names: NamesInText) -> Scope | None:
    """Model or part to which what is named belongs, None where the text does not hold it."""
    if names.root is None or not isinstance(names.root.value, Mapping):
        return None
    if place.home[:1] != ("parts",) or len(place.home) < 4:
        return Scope((), names.root.value)
    part = names.root.entries["parts"].entries.get(place.home[1])
    return None if part is None or not isinstance(part.value, Mapping) else Scope(place.home[:2], part.value)


def _parameter(place: NamedPlace, scope: Scope, names: NamesInText) -> str:
    raw = scope.table("parameters").get(place.name)
    known = KnownValues(scope)
    parameter = known.parameters.get(place.name)
    uses = sum(one.home == place.home and not one.is_definition for one in names.places)
    used = "not used" if not uses else f"used in {uses} place{'s' if uses > 1 else ''}"
    if raw is None:
        return f"parameter {code(place.name)}, which is not defined here; {used}"
    lines = [f"parameter {code(place.name)}"]
    if parameter is None:
        return f"{lines[0]}, whose value cannot be read; {used}"
    if parameter.description:
        lines[0] += f": {prose(parameter.description)}"
    lines.append(known.words(parameter.value) if parameter.by is None else prose(parameter.written))
    if parameter.bounds is not None:
        low, high = (screen_text(bound) for bound in parameter.bounds)
        lines.append(f"bounds {low} to {high} in SI units")
    source = scope.data.get("source")
    lines.append(used + (f"; numbers of the model: {prose(source)}" if isinstance(source, str) and source else ""))
    return "\n\n".join(lines)


def _node(place: NamedPlace, scope: Scope, names: NamesInText) -> str:
    depth = len(scope.path)
    owners: dict[str, None] = {}
    for one in names.places:
        if one.home != place.home or one.path[:depth] != scope.path or len(one.path) < depth + 2:
            continue
        section, name = one.path[depth : depth + 2]
        if section == "elements":
            raw = scope.table("elements").get(str(name))
            kind = str(raw.get("type", "")).replace("_", " ") if isinstance(raw, Mapping) else ""
            owners[f"{kind} {code(name)}".strip()] = None
        elif section == "use":
            owners[f"part {code(name)}"] = None
    lines = [f"node {code(place.name)}", _meeting(list(owners)), _inertia(place, scope, names)]
    return "\n\n".join(line for line in lines if line)


def _meeting(owners: list[str]) -> str:
    if not owners:
        return "no element is attached to it"
    listed = ", ".join(owners[:MOST_LISTED]) + (", ..." if len(owners) > MOST_LISTED else "")
    return f"here {'is' if len(owners) == 1 else 'meet'} {listed}"


def _inertia(place: NamedPlace, scope: Scope, names: NamesInText) -> str:
    """Sentence on the inertia that elements have on a node alone."""
    from torsionnet.model.elements import Law, Values
    from torsionnet.model.sections import ELEMENTS

    depth = len(scope.path)
    there = {str(one.path[depth + 1]) for one in names.places
             if one.home == place.home and one.path[depth : depth + 1] == ("elements",)}  # fmt: skip
    raw = {name: one for name, one in scope.table("elements").items() if name in there}
    elements = ELEMENTS.read(raw)[0] if raw else {}
    value = Values(KnownValues(scope).values)
    total, unknown = 0.0, len(elements) < len(raw)
    for element in elements.values():
        try:
            parts = element.parts(value) if element.enabled else ()
            total += sum(
                float(one.inertia) * float(one.row[place.name]) ** 2
                for one in parts
                if isinstance(one, Law) and list(one.row) == [place.name]
            )
        except (TorsionnetError, ArithmeticError, KeyError, TypeError):
            unknown = True
    if not total:
        return "" if unknown else "no inertia of its own"
    return f"inertia {'at least ' if unknown else ''}{screen_text(total)} kg*m^2".replace("*", "·")


def _element(place: NamedPlace, scope: Scope) -> str:
    from torsionnet.model.sections import ELEMENTS

    raw = scope.table("elements").get(place.name)
    if not isinstance(raw, Mapping):
        return f"element {code(place.name)}, which is not defined here"
    cls = class_of(ELEMENTS.of, raw)
    lines = [f"element {code(place.name)}" + (f": {prose(first_sentence(cls))}" if cls else "")]
    if isinstance(raw.get("description"), str):
        lines.append(prose(raw["description"]))
    known = KnownValues(scope)
    rows = [
        f"- {code(key)}: {known.words(value, dimension).partition(chr(10))[0]}"
        for key, value, dimension in _values(cls, raw)
    ]
    return "\n\n".join([*lines, *(["\n".join(rows[:MOST_LISTED])] if rows else [])])


def _values(cls: Any, raw: Mapping[str, Any]) -> Iterable[tuple[str, Any, str]]:
    """Key, expression and dimension of each value that an element gives."""
    from torsionnet.app.text.explaining.hover_entries import read_expression
    from torsionnet.base.expressions import Expression

    for key, spec in cls.specs() if cls else ():
        if isinstance(raw.get(key), str | int | float) and not isinstance(raw[key], bool):
            value = read_expression(spec, raw[key])
            if isinstance(value, Expression):
                yield key, value, getattr(spec, "dimension", "")


def _other(place: NamedPlace, scope: Scope) -> str:
    """Explanation of a sensor, input, part and the like: what it is by its entry."""
    head = f"{place.kind} {code(place.name)}"
    entry: Any = scope.data
    for key in place.home[len(scope.path) :]:
        entry = entry.get(key) if isinstance(entry, Mapping) else None
    if not isinstance(entry, Mapping) or not entry:
        return head
    if isinstance(entry.get("description"), str):
        head += f": {prose(entry['description'])}"
    shown = [
        f"{code(key)}: {code(_flat(one))}"
        for key, one in entry.items()
        if key != "description" and (not isinstance(one, Mapping | list) or len(one) <= 3)
    ]
    return "\n\n".join([head, *([", ".join(shown[:MOST_LISTED])] if shown else [])])


def _flat(value: Any) -> str:
    """Text of a short value in one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {_flat(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_flat, value)) + "]"
    return "" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
