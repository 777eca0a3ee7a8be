"""Explanations of the names, keys and values of a model text."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from torsionnet.app.text.name_homes import Scope, changed_section
from torsionnet.app.text.named_places import NamedPlace, NamesInText
from torsionnet.app.text.text_edits import TextSpan
from torsionnet.base.entries.composite import Typed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import QuantityKind, Value, plain_scalar
from torsionnet.base.entries.spec import Count, OneOf, Spec
from torsionnet.base.errors import EntryPath, TorsionnetError
from torsionnet.base.expressions import Expression, Number
from torsionnet.base.number_text import screen_text
from torsionnet.base.units import DIMENSIONS, Dimension, expected_unit
from torsionnet.model.files.located_yaml import LocatedNode

# Entry of a model text that stands at an offset, with the specification by which it is read.


@dataclass(frozen=True)
class EntryUnder:
    """Entry at an offset: its path, its value and specification, and those of what it stands in.

    ``span`` is the stretch of its key, ``on_key``, or else of its value. ``scope`` is the model or part that holds it,
    and ``owner`` the specification of the entry around it.
    """

    path: EntryPath
    node: LocatedNode
    spec: Spec[Any] | None
    owner: Spec[Any] | None
    beside: Mapping[str, Any]
    span: TextSpan
    on_key: bool
    scope: Scope


def entry_under(names: NamesInText, offset: int) -> EntryUnder | None:
    """Innermost entry whose key or value stands at an offset or ends there, None where there is none."""
    from torsionnet.model.definition import Definition

    if names.root is None or not isinstance(names.root.value, Mapping):
        return None
    scope = Scope((), names.root.value)
    specs: Mapping[Any, Spec[Any]] = Definition.entry_specs(names.root.value)
    node, owner = names.root, None
    path: EntryPath = ()
    under: EntryUnder | None = None
    while True:
        hit = _child_at(names, node, offset)
        if hit is None:
            return under
        key, child, span, on_key = hit
        beside = node.value if isinstance(node.value, Mapping) else {}
        spec = specs.get(key) or _changed(str(key), scope)
        path = (*path, key)
        under = EntryUnder(path, child, spec, owner, beside, span, on_key, scope)
        if on_key:
            return under
        # Names within a part are its own.
        if len(path) == 2 and path[0] == "parts" and isinstance(child.value, Mapping):
            scope = Scope(path, child.value)
        node, owner = child, spec
        specs = spec.entry_specs(child.value) if spec is not None else {}


def _child_at(
    names: NamesInText, node: LocatedNode, offset: int
) -> tuple[str | int, LocatedNode, TextSpan, bool] | None:
    """Key, value and stretch of the entry in a value that stands at an offset, and whether that is on the key."""
    for key, child in node.entries.items():
        if child.key_place:
            span = names.stretches.whole(child.key_place)
            if span.start <= offset <= span.end:
                return key, child, span, True
    for key, child in node.entries.items():
        span = names.stretches.span(child.place)
        if span.start <= offset <= span.end:
            return key, child, span, False
    return None


def _changed(key: str, scope: Scope) -> Spec[Any] | None:
    section = changed_section(key, scope) if "." in key else None
    return section and section.spec


# Words on values in a model text: as written, in SI units, and what an expression gives.

_MARKS = re.compile(r"([\\`*_<>\[\]])")


def prose(text: object) -> str:
    """Free text of a model in one line of Markdown, in which its own signs mean nothing."""
    return _MARKS.sub(r"\\\1", " ".join(str(text).split()))


def code(text: object) -> str:
    """Text of a model as it is written, for a line of Markdown."""
    return f"`{' '.join(str(text).replace('`', chr(39)).split())}`"


class KnownValues:
    """Values of the parameters of a model or part as far as they can be read, in SI units."""

    def __init__(self, scope: Scope) -> None:
        from torsionnet.model.sections import PARAMETERS

        self.parameters = dict(PARAMETERS.read(scope.table("parameters"))[0])

    @cached_property
    def values(self) -> Mapping[str, Any]:
        """Value of each parameter in SI units, by name."""
        from torsionnet.model.parameters import resolve

        return resolve(self.parameters)[0]

    @cached_property
    def dimensions(self) -> Mapping[str, Dimension | None]:
        """Dimension of each parameter, by name; None where it is a bare number."""
        from torsionnet.model.parameters import dimensions

        return dimensions(self.parameters)[0]

    def in_si(self, value: Expression, dimension: str = "") -> str:
        """Value of an expression with its SI unit; empty where a parameter in it has no value."""
        try:
            number = float(value.evaluate(self.values))
            dimensions = DIMENSIONS[dimension] if dimension else value.dimension(self.dimensions)
        except (TorsionnetError, ArithmeticError, TypeError):
            return ""
        # An angle counts as 1 in dimensions: only how the value is written tells a stiffness from a torque.
        per_angle = isinstance(value, Number) and value.has_angle
        if not dimension and dimensions == DIMENSIONS["torque"] and per_angle:
            dimension = "stiffness"
        unit = expected_unit(dimension) if dimension else "" if dimensions is None else str(dimensions)
        return f"{screen_text(number)} {unit}".strip() if unit != "1" else screen_text(number)

    def words(self, value: Expression, dimension: str = "") -> str:
        """Words on an expression: as written, what it is in SI units, and the parameters in it."""
        written, now = str(plain_scalar(value)), self.in_si(value, dimension)
        text = code(written)
        if now and now != written:
            text += f" = {now}"
        elif not now and not isinstance(value, Number):
            text += ", which has no value yet"
        known = [name for name in sorted(value.names) if name in self.parameters]
        if known and written not in known:
            shown = (f"{code(name)} = {self.in_si(self.parameters[name].value) or '?'}" for name in known)
            text += f"\n\nwith {', '.join(shown)}"
        return text


# Explanations of the keys and values of a model text.


def key_words(entry: EntryUnder) -> str:
    """Explanation of an entry by its key: what it is, its unit, bounds, symbol and default; empty where unknown."""
    if isinstance(entry.owner, Typed) and entry.path[-1] == entry.owner.key:
        return f"{code(entry.path[-1])}: {prose(entry.owner.description)}"
    if entry.spec is None:
        return ""
    lines = [f"{code(entry.path[-1])}: {prose(entry.spec.description or entry.spec.example)}"]
    facts = [*_facts(entry.spec), *_default(entry)]
    return "\n\n".join([*lines, *(["; ".join(facts)] if facts else [])])


def _facts(spec: Spec[Any]) -> list[str]:
    """Unit, bounds, symbol and words of an entry."""
    facts: list[str] = []
    dimension = getattr(spec, "dimension", "")
    if dimension:
        facts.append("a plain number" if dimension == "1" else f"{dimension} in {code(expected_unit(dimension))}")
    if isinstance(spec, QuantityKind | Value):
        if spec.lower is not None:
            facts.append(f"{'more than' if spec.exclusive else 'at least'} {spec.lower:g}")
        if isinstance(spec, QuantityKind) and spec.nonzero:
            facts.append("not 0")
        if isinstance(spec, QuantityKind) and spec.symbol:
            facts.append(f"symbol {code(spec.symbol)}")
        if isinstance(spec, Value) and spec.below is not None:
            facts.append(f"less than {spec.below:g}")
    if isinstance(spec, Count):
        facts.append(f"a whole number from {spec.lower} to {spec.upper}")
    if isinstance(spec, OneOf):
        facts.append(f"one of {', '.join(map(code, spec.options))}")
    return facts


def _default(entry: EntryUnder) -> list[str]:
    """Whether an entry must be given, and else what counts without it."""
    cls = class_of(entry.owner, entry.beside)
    name = str(entry.path[-1])
    if cls is None or name not in dict(cls.specs()):
        return []
    if name in cls.required():
        return ["must be given"]
    default = cls.defaults().get(name)
    if default is None or default in ("", (), {}) or entry.spec is None or isinstance(default, Declared):
        return []
    return [f"default {code(_plain(entry.spec, default))}"]


def _plain(spec: Spec[Any], value: Any) -> object:
    plain = spec.plain(value)
    return str(plain).lower() if isinstance(plain, bool) else plain


def class_of(spec: Spec[Any] | None, raw: Mapping[str, Any]) -> type[Declared] | None:
    """Class of the object that an entry holds, None where it holds none or its type is unknown."""
    if isinstance(spec, Typed):
        kind = raw.get(spec.key)
        cls: type[Declared] | None = spec.kinds().get(kind) if isinstance(kind, str) else None
        return cls
    of = getattr(spec, "of", None)
    made = of() if callable(of) else None
    return made if isinstance(made, type) and issubclass(made, Declared) else None


def value_words(entry: EntryUnder) -> str:
    """Explanation of a value: a type by its description, a number or expression by what it is in SI units."""
    raw = entry.node.value
    if isinstance(entry.owner, Typed) and entry.path[-1] == entry.owner.key:
        cls = class_of(entry.owner, entry.beside)
        return f"{code(raw)}: {prose(first_paragraph(cls))}" if cls else ""
    if entry.path[-1] == "size" and "catalogue" in entry.beside:
        return row_words(entry.beside)
    if entry.spec is None or isinstance(raw, bool) or not isinstance(raw, str | int | float):
        return ""
    read = read_expression(entry.spec, raw)
    if isinstance(read, Expression):
        dimension = getattr(entry.spec, "dimension", "")
        words = KnownValues(entry.scope).words(read, dimension)
        return f"{_named(entry)} {words}".strip()
    if isinstance(read, float) and isinstance(entry.spec, Value):
        unit = "" if entry.spec.dimension == "1" else f" {expected_unit(entry.spec.dimension)}"
        now = f" = {read:.6g}{unit}" if isinstance(raw, str) else unit
        return f"{_named(entry)} {code(raw)}{now}"
    return key_words(entry) if isinstance(entry.path[-1], str) else ""


def _named(entry: EntryUnder) -> str:
    """Name of the entry before its value, with a colon; empty for one of a list."""
    return f"{code(entry.path[-1])}:" if isinstance(entry.path[-1], str) else ""


def read_expression(spec: Spec[Any], raw: object) -> object:
    """Stored value of an entry, None where it is faulty."""
    try:
        value, faults = spec.read(raw)
    except (TorsionnetError, ArithmeticError):
        return None
    if faults:
        return None
    return getattr(value, "value", value) if isinstance(value, Declared) else value


def first_paragraph(cls: type) -> str:
    """First paragraph of the description of a class, in one line."""
    return " ".join((inspect.getdoc(cls) or "").partition("\n\n")[0].replace("``", "").split())


def first_sentence(cls: type) -> str:
    """First line of the description of a class, which stands alone."""
    return (inspect.getdoc(cls) or "").partition("\n")[0]


def row_words(entries: Mapping[str, Any]) -> str:
    """Row of the catalogue that an element names, cell by cell; the reason where it cannot be read."""
    from torsionnet.model.catalogues.catalogue_reading import chosen_row

    row, faults = chosen_row(entries)
    if row is None:
        return prose(faults[0].message) if faults else ""
    cells = [f"- {code(cell.column)}: {prose(cell.raw)}" for cell in row.cells]
    return "\n".join([f"size {code(row.size)} of {code(row.file)}", "", *cells])


# Explanations of what a model text names: parameters, nodes, elements and others.

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
    uses = sum(other.home == place.home and not other.is_definition for other in names.places)
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
    if parameter.tolerance is not None:
        lines.append(f"may be off by {100 * parameter.tolerance:g} %")
    source = scope.data.get("source")
    lines.append(used + (f"; numbers of the model: {prose(source)}" if isinstance(source, str) and source else ""))
    return "\n\n".join(lines)


def _node(place: NamedPlace, scope: Scope, names: NamesInText) -> str:
    depth = len(scope.path)
    owners: dict[str, None] = {}
    for other in names.places:
        if other.home != place.home or other.path[:depth] != scope.path or len(other.path) < depth + 2:
            continue
        section, name = other.path[depth : depth + 2]
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
    there = {str(other.path[depth + 1]) for other in names.places
             if other.home == place.home and other.path[depth : depth + 1] == ("elements",)}  # fmt: skip
    raw = {name: element for name, element in scope.table("elements").items() if name in there}
    elements = ELEMENTS.read(raw)[0] if raw else {}
    value = Values(KnownValues(scope).values)
    total, unknown = 0.0, len(elements) < len(raw)
    for element in elements.values():
        try:
            parts = element.parts(value) if element.enabled else ()
            total += sum(
                float(part.inertia) * float(part.row[place.name]) ** 2
                for part in parts
                if isinstance(part, Law) and list(part.row) == [place.name]
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
        f"{code(key)}: {code(_flat(entry_value))}"
        for key, entry_value in entry.items()
        if key != "description" and (not isinstance(entry_value, Mapping | list) or len(entry_value) <= 3)
    ]
    return "\n\n".join([head, *([", ".join(shown[:MOST_LISTED])] if shown else [])])


def _flat(value: Any) -> str:
    """Text of a short value in one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {_flat(inner)}" for key, inner in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_flat, value)) + "]"
    return "" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
