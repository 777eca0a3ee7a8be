"""Specification of the entry at a path of a model file, from its declaration alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from torsionnet.app.text.naming.fixed_keys import properties_of
from torsionnet.app.text.naming.mentions import Scope
from torsionnet.app.text.naming.name_homes import changed_section
from torsionnet.base.entries.composite import Named, Nested, Typed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import AnyQuantity, Band, Bands, NumberTable, PhysicalQuantity
from torsionnet.base.entries.spec import OneOf, Schema, Spec, Text
from torsionnet.base.errors import EntryPath
from torsionnet.model.configurations import AlternativeEntry, AxesEntry
from torsionnet.model.damping import DampingQuantity, LossFactor
from torsionnet.model.element_base.element_entries import NodeName, NodePair
from torsionnet.model.files.located_yaml import MOST_LEVELS
from torsionnet.model.parameters import BoundsEntry


@dataclass(frozen=True)
class EntryPlace:
    """Place of an entry in a model file: its specification, its data, and those of the tables around it."""

    spec: Spec[Any] | None
    data: Any
    around: tuple[Any, ...] = ()
    path: EntryPath = ()


@dataclass(frozen=True, eq=False, repr=False)
class KindWord(OneOf):
    """Entry of the word that chooses one of several classes, as ``type:``."""

    typed: Typed[Any] | None = None


@dataclass(frozen=True, eq=False, repr=False)
class _Row(Spec[Any]):
    """Row of a table of numbers."""

    columns: tuple[Any, ...] = ()

    def schema(self) -> Schema:
        return {"type": "array", "description": self.description}


def root_class(data: Any) -> type[Declared]:
    """Class of the file that holds some data: that of a model, or of a test bench, which names its model."""
    if isinstance(data, Mapping) and "model" in data and "elements" not in data and "use" not in data:
        from torsionnet.bench.plan.bench_file import BenchFile

        return BenchFile
    from torsionnet.model.definition import Definition

    return Definition


def entry_place(data: Any, path: EntryPath) -> EntryPlace:
    """Place at a path of a file with some data, of which much may still be missing."""
    cls = root_class(data)
    spec: Spec[Any] | None = Nested("the file", lambda: cls, "file")
    around: tuple[Any, ...] = ()
    raw = data
    if len(path) > MOST_LEVELS:
        return EntryPlace(None, None)
    for step in path:
        around = (*around, raw)
        if isinstance(spec, AlternativeEntry) and "." in str(step):
            spec = _changed_spec(data, path, str(step))
        else:
            if isinstance(spec, AxesEntry):
                raw = _with_values(raw, _inner_data(around[-2], "parameters"))
            spec = None if spec is None else inner_spec(spec, raw, step)
        raw = _inner_data(raw, step)
    return EntryPlace(spec, raw, around, path)


def _with_values(alternatives: Any, parameters: Any) -> Any:
    """Alternatives with a number for each parameter without value, without which they would seem an axis of others."""
    if not isinstance(alternatives, Mapping) or not isinstance(parameters, Mapping):
        return alternatives
    return {
        name: {key: 0 if value is None and key in parameters else value for key, value in one.items()}
        if isinstance(one, Mapping)
        else one
        for name, one in alternatives.items()
    }


def _changed_spec(data: Any, path: EntryPath, key: str) -> Spec[Any] | None:
    """Specification of an entry that an alternative changes, as ``box.engaged``."""
    inner = _inner_data(_inner_data(data, "parts"), path[1]) if path[:1] == ("parts",) else data
    changed = changed_section(key, Scope((), inner if isinstance(inner, Mapping) else {}))
    return changed.spec if changed else None


def _inner_data(raw: Any, step: str | int) -> Any:
    if isinstance(raw, Mapping):
        return raw.get(step)
    return raw[step] if isinstance(raw, list) and isinstance(step, int) and step < len(raw) else None


def inner_spec(spec: Spec[Any], raw: Any, step: str | int) -> Spec[Any] | None:
    """Specification of an entry within another one; None where it has no such entry."""
    if isinstance(spec, Typed) and step == spec.key:
        return KindWord(spec.description, tuple(spec.kinds()), spec)
    if isinstance(step, int):
        given: Any = [*(raw if isinstance(raw, list) else []), *[None] * (step + 1)]
    else:
        given = {**(raw if isinstance(raw, Mapping) else {}), step: _inner_data(raw, step)}
    found = spec.entry_specs(given).get(step)
    return found if found is not None else _of_whole(spec, step)


def _of_whole(spec: Spec[Any], step: str | int) -> Spec[Any] | None:
    """Specification of an entry within one that is read as a whole."""
    if isinstance(spec, NodePair):
        return NodeName("a node")
    if isinstance(spec, Band | Bands) or type(spec).__name__ == "SpeedBand":
        return spec
    if isinstance(spec, BoundsEntry):
        return AnyQuantity("a bound")
    if isinstance(spec, DampingQuantity | LossFactor):
        dimension = {"at": "frequency", "c": "damping"}.get(str(step), "1")
        return PhysicalQuantity(str(step), dimension)
    if isinstance(spec, NumberTable):
        return _Row(spec.description, spec.columns)
    if isinstance(spec, _Row):
        column = spec.columns[step] if isinstance(step, int) and step < len(spec.columns) else None
        return PhysicalQuantity(column.name, column.dimension) if column else None
    of = getattr(spec, "of", None)
    if isinstance(of, Spec):
        return of
    named = getattr(spec, "dimension", None)
    if isinstance(named, str) and named:
        return PhysicalQuantity(spec.description, named)
    properties = properties_of(spec)
    return Text(_description(properties[step])) if step in properties else None


def _description(schema: Any) -> str:
    return str(schema.get("description", "")) if isinstance(schema, Mapping) else ""


def class_at(place: EntryPlace) -> type[Declared] | None:
    """Class of the object that stands at a place, None where it is not known or none."""
    spec = place.spec
    if isinstance(spec, Nested):
        found: type[Declared] = spec.of()
        return found
    if isinstance(spec, Typed) and isinstance(place.data, Mapping):
        kind = place.data.get(spec.key)
        kinds: Mapping[str, type[Declared]] = spec.kinds()
        return kinds[kind] if isinstance(kind, str) and kind in kinds else None
    return None


def holds_entries(spec: Spec[Any] | None) -> bool:
    """Whether an entry is mostly a table of further entries, which in a block stand on lines of their own."""
    if isinstance(spec, Nested):
        return not spec.shorthand
    return isinstance(spec, Typed | Named) or type(spec).__name__ == "AxesEntry"
