"""Explanations of the keys and values of a model text."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import Any

from torsionnet.app.text.explaining.entry_under import EntryUnder
from torsionnet.app.text.explaining.value_words import KnownValues, code, prose
from torsionnet.base.entries.composite import Typed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import QuantityKind, Value
from torsionnet.base.entries.spec import Count, OneOf, Spec
from torsionnet.base.errors import TorsionnetError
from torsionnet.base.expressions import Expression
from torsionnet.base.units import expected_unit


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
    found: list[str] = []
    dimension = getattr(spec, "dimension", "")
    if dimension:
        found.append("a plain number" if dimension == "1" else f"{dimension} in {code(expected_unit(dimension))}")
    if isinstance(spec, QuantityKind | Value):
        if spec.lower is not None:
            found.append(f"{'more than' if spec.exclusive else 'at least'} {spec.lower:g}")
        if isinstance(spec, QuantityKind) and spec.nonzero:
            found.append("not 0")
        if isinstance(spec, QuantityKind) and spec.symbol:
            found.append(f"symbol {code(spec.symbol)}")
        if isinstance(spec, Value) and spec.below is not None:
            found.append(f"less than {spec.below:g}")
    if isinstance(spec, Count):
        found.append(f"a whole number from {spec.lower} to {spec.upper}")
    if isinstance(spec, OneOf):
        found.append(f"one of {', '.join(map(code, spec.options))}")
    return found


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
    found = spec.plain(value)
    return str(found).lower() if isinstance(found, bool) else found


def class_of(spec: Spec[Any] | None, raw: Mapping[str, Any]) -> type[Declared] | None:
    """Class of the object that an entry holds, None where it holds none or its type is unknown."""
    if isinstance(spec, Typed):
        kind = raw.get(spec.key)
        found: type[Declared] | None = spec.kinds().get(kind) if isinstance(kind, str) else None
        return found
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
    found = read_expression(entry.spec, raw)
    if isinstance(found, Expression):
        dimension = getattr(entry.spec, "dimension", "")
        words = KnownValues(entry.scope).words(found, dimension)
        return f"{_named(entry)} {words}".strip()
    if isinstance(found, float) and isinstance(entry.spec, Value):
        unit = "" if entry.spec.dimension == "1" else f" {expected_unit(entry.spec.dimension)}"
        now = f" = {found:.6g}{unit}" if isinstance(raw, str) else unit
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
    from torsionnet.model.catalogues.catalogue_values import chosen_row

    row, faults = chosen_row(entries)
    if row is None:
        return prose(faults[0].message) if faults else ""
    cells = [f"- {code(cell.column)}: {prose(cell.raw)}" for cell in row.cells]
    return "\n".join([f"size {code(row.size)} of {code(row.file)}", "", *cells])
