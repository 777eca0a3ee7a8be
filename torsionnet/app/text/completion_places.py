"""Specification of the entry at a path of a model file, from its declaration alone."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from torsionnet.app.text.cursor_context import CursorContext
from torsionnet.app.text.name_homes import Scope, changed_section, properties_of
from torsionnet.app.text.tolerant_reading import tolerant_document
from torsionnet.base.entries.composite import Named, Nested, Typed
from torsionnet.base.entries.declared import Declared, files_beside
from torsionnet.base.entries.scalars import AnyQuantity, Band, Bands, NumberTable, PhysicalQuantity, QuantityKind, Value
from torsionnet.base.entries.spec import EntryError, OneOf, Schema, Spec, Text
from torsionnet.base.errors import EntryPath
from torsionnet.base.nearby_files import nearby_file
from torsionnet.base.units import expected_unit
from torsionnet.model.channels import ChannelName, RecordedName
from torsionnet.model.configurations import AlternativeEntry, AxesEntry
from torsionnet.model.damping import DampingQuantity, LossFactor
from torsionnet.model.element_base.element import ELEMENT_TYPES
from torsionnet.model.element_base.element_entries import ElementName, NodeName, NodePair, NodeText, PlaceOnElement
from torsionnet.model.element_base.laws import GROUND
from torsionnet.model.files.located_yaml import MOST_LEVELS
from torsionnet.model.files.part_includes import MOST_INCLUDED
from torsionnet.model.parameters import BoundsEntry
from torsionnet.model.parts.part import PartName, PartParameter, PortName


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
        from torsionnet.bench.plan.plan import BenchFile

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
        name: {key: 0 if value is None and key in parameters else value for key, value in changes.items()}
        if isinstance(changes, Mapping)
        else changes
        for name, changes in alternatives.items()
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
    inner = spec.entry_specs(given).get(step)
    return inner if inner is not None else _of_whole(spec, step)


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
        nested: type[Declared] = spec.of()
        return nested
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


# Names of nodes, elements, parameters and other things that a model text may refer to.

_MOST_COPIES_SHOWN = 40
"""Largest number of copies of a part whose nodes and elements are offered, as more could not be looked through."""


@dataclass(frozen=True)
class ModelNames:
    """Names in the data of a model or part, with those of the parts that it can use."""

    data: Mapping[str, Any]
    scope: EntryPath = ()
    folder: Path | None = None

    @cached_property
    def own(self) -> Mapping[str, Any]:
        """Data of the model, or of the part in it, whose names count; of a bench file those of its model too."""
        data: Any = self.data
        if isinstance(data.get("model"), str) and "elements" not in data:
            return {**self._model_of_bench(str(data["model"])), **data}
        for step in self.scope:
            data = data.get(step) if isinstance(data, Mapping) else None
        return data if isinstance(data, Mapping) else {}

    def _model_of_bench(self, name: str) -> Mapping[str, Any]:
        from torsionnet.model.files.library import library_models

        if name in library_models():
            return _read(library_models()[name])
        with files_beside(self.folder):
            try:
                return _read(nearby_file(name))
            except EntryError:
                return {}

    def table(self, section: str) -> Mapping[str, Any]:
        """Entries of a section by name; empty where there is none."""
        return _table(self.own, section)

    @cached_property
    def nodes(self) -> tuple[str, ...]:
        """Names of the nodes of elements and of uses of parts, without ground."""
        nodes = dict.fromkeys(_nodes_of(self.table("elements").values()))
        for _, use in self._uses():
            for at in _table(use, "at").values():
                nodes |= dict.fromkeys(
                    node_name for node_name in (at if isinstance(at, list) else [at]) if isinstance(node_name, str)
                )
        for prefix, part, joined in self._copies():
            inner = _nodes_of(_table(part, "elements").values())
            nodes |= dict.fromkeys(f"{prefix}.{node}" for node in inner if node not in joined)
        nodes.pop(GROUND, None)
        return tuple(nodes)

    def names(self, section: str) -> tuple[str, ...]:
        """Names in a section of the model, and of those in the parts that it uses, which begin with that of the use."""
        used = [f"{prefix}.{name}" for prefix, part, _ in self._copies() for name in _table(part, section)]
        return (*map(str, self.table(section)), *used)

    @cached_property
    def configurations(self) -> tuple[str, ...]:
        """Names of the alternatives of configurations, with their axis where there are several."""
        from torsionnet.model.sections import CONFIGURATIONS

        axes, _ = CONFIGURATIONS.read(self.table("configurations"))
        several = len(axes) > 1
        return tuple(
            f"{axis}={name}" if several else name for axis, alternatives in axes.items() for name in alternatives
        )

    @cached_property
    def parts(self) -> Mapping[str, Mapping[str, Any]]:
        """Data of each part that the model can use, by name: its own ones, those it includes, and the library's."""
        from torsionnet.model.files.library import library_parts

        parts = {name: _read(path) for name, path in library_parts().items()}
        with files_beside(self.folder):
            for name in _listed(self.data.get("include"))[:MOST_INCLUDED]:
                try:
                    path = nearby_file(str(name))
                except EntryError:
                    continue
                held = _read(path)
                parts |= {str(key): part for key, part in _table(held, "parts").items() if isinstance(part, Mapping)}
                parts |= {path.stem: held} if "ports" in held else {}
        own = {str(name): part for name, part in _table(self.data, "parts").items() if isinstance(part, Mapping)}
        return {**own, **{name: part for name, part in parts.items() if name not in own}}

    def _uses(self) -> Iterator[tuple[str, Mapping[str, Any]]]:
        yield from ((str(name), use) for name, use in self.table("use").items() if isinstance(use, Mapping))

    def _copies(self) -> Iterator[tuple[str, Mapping[str, Any], set[str]]]:
        """Prefix of each copy of a part that the model uses, the data of the part, and nodes with another name here."""
        for name, use in self._uses():
            part = self.parts.get(str(use.get("part")), {})
            repeat = use.get("repeat")
            count = min(repeat, _MOST_COPIES_SHOWN) if isinstance(repeat, int) else 0
            for prefix in [f"{name}{number}" for number in range(1, count + 1)] or [name]:
                yield prefix, part, {GROUND, *map(str, _table(use, "at")), *map(str, _listed(use.get("chain")))}

    def places_on(self, element: str) -> tuple[str, ...]:
        """Ports of an element and its nodes."""
        raw = self.table("elements").get(element)
        kind = raw.get("type") if isinstance(raw, Mapping) else None
        if not isinstance(kind, str) or kind not in ELEMENT_TYPES:
            return self.nodes
        assert isinstance(raw, Mapping)
        specs = ELEMENT_TYPES[kind].specs()
        pair = ("first", "second") if any(isinstance(spec, NodePair) for _, spec in specs) else ()
        ports = [name for name, spec in specs if isinstance(spec, NodeName) and name in raw]
        return tuple(dict.fromkeys([*_nodes_of([raw]), *pair, *ports]))

    def for_spec(self, spec: Spec[Any] | None) -> Iterator[tuple[str, str]]:
        """Kind and name of everything that an entry may name."""
        if isinstance(spec, PlaceOnElement):
            yield from (("node", name) for name in self.places_on(spec.element))
        elif isinstance(spec, PortName):
            yield from (("node", str(name)) for name in _listed(self.parts.get(spec.part, {}).get("ports")))
        elif isinstance(spec, PartParameter):
            yield from (("parameter", name) for name in _table(self.parts.get(spec.part, {}), "parameters"))
        elif isinstance(spec, PartName):
            yield from (("part", name) for name in self.parts)
        else:
            for kind in _kinds(spec):
                yield from ((kind, name) for name in self._of_kind(kind))
            if isinstance(spec, NodeName) and spec.allow_ground:
                yield "node", GROUND

    def _of_kind(self, kind: str) -> Iterable[str]:
        if kind == "node":
            return self.nodes
        if kind == "channel":
            return tuple(map(str, _table(self.own.get("bench"), "channels")))
        return self.configurations if kind == "configuration" else self.names(f"{kind}s")


def _kinds(spec: Spec[Any] | None) -> tuple[str, ...]:
    """Kinds of the things that an entry names: a section without its last letter, a node, or a configuration."""
    from torsionnet.model.configurations import ConfigurationName
    from torsionnet.model.operating_point import DriverName, ExcitationName, MachineName, TorqueInput, TorquePlace
    from torsionnet.report.plan.report_plan import SectionName

    if isinstance(spec, SectionName):
        return ()
    table: tuple[tuple[tuple[type, ...], tuple[str, ...]], ...] = (
        ((DriverName,), ("node", "excitation")),
        ((TorqueInput,), ("input", "node")),
        ((NodeName, NodePair, NodeText, TorquePlace), ("node",)),
        ((MachineName,), ("element", "excitation")),
        ((ElementName,), ("element",)),
        ((ChannelName,), ("sensor", "input", "node")),
        ((RecordedName,), ("sensor", "input", "channel")),
        ((ExcitationName,), ("excitation",)),
        ((ConfigurationName,), ("configuration",)),
    )
    kinds_named = next((kinds for classes, kinds in table if isinstance(spec, classes)), ())
    return kinds_named or (("node",) if type(spec).__name__ == "OneOrTwoNodes" else ())


def _table(data: Any, section: str) -> Mapping[str, Any]:
    table = data.get(section) if isinstance(data, Mapping) else None
    return table if isinstance(table, Mapping) else {}


def _listed(data: Any) -> list[Any]:
    return data if isinstance(data, list) else []


def _nodes_of(elements: Iterable[Any]) -> Iterator[str]:
    """Nodes that elements as a file gives them are attached to, also those that lack other entries."""
    for raw in elements:
        kind = raw.get("type") if isinstance(raw, Mapping) else None
        for name, is_table in _node_entries(kind) if isinstance(kind, str) else ():
            given = raw.get(name)
            for node in given if isinstance(given, list) or (is_table and isinstance(given, Mapping)) else [given]:
                if isinstance(node, str):
                    yield node


@lru_cache(maxsize=256)
def _node_entries(kind: str) -> tuple[tuple[str, bool], ...]:
    """Entries of an element type that name nodes, and whether they are tables by node."""
    from torsionnet.model.element_base.control_entries import OneOrTwoNodes
    from torsionnet.model.element_base.element_entries import ReferenceNode
    from torsionnet.model.element_base.quantity_table import TableByNode

    if kind not in ELEMENT_TYPES:
        return ()
    wanted = (NodeName, NodePair, OneOrTwoNodes, TableByNode)
    return tuple(
        (name, isinstance(spec, TableByNode))
        for name, spec in ELEMENT_TYPES[kind].specs()
        if isinstance(spec, wanted) and not isinstance(spec, ReferenceNode)
    )


def _read(path: Path) -> Mapping[str, Any]:
    """Data of a file of parts, empty where it cannot be read."""
    try:
        stat = path.stat()
        return _read_once(path, stat.st_mtime_ns, stat.st_size)
    except OSError:
        return {}


@lru_cache(maxsize=64)
def _read_once(path: Path, changed: int, size: int) -> Mapping[str, Any]:
    del changed, size
    data = tolerant_document(path.read_text(encoding="utf-8", errors="replace"), str(path)).data
    return data if isinstance(data, Mapping) else {}


# Options of a completion before it is known which stretch of the text they replace.


class CompletionOption(NamedTuple):
    """Option of a completion; ``begin`` is the number of characters of the word begun that stay before it."""

    label: str
    kind: str
    insert: str
    detail: str = ""
    documentation: str = ""
    begin: int = 0


@dataclass(frozen=True)
class Writing:
    """Text that is being written: its data without the word begun, where the cursor is, and which names there are.

    The word goes on behind the cursor up to ``end``.
    """

    text: str
    offset: int
    end: int
    context: CursorContext
    place: EntryPlace
    names: ModelNames
    folder: Path | None = None

    @cached_property
    def word(self) -> str:
        """Key or value begun, up to the cursor."""
        return self.text[self.context.word.start : self.offset]

    @cached_property
    def after(self) -> str:
        """Rest of the line behind the word at the cursor."""
        end = self.text.find("\n", self.end)
        return self.text[self.end : end if end >= 0 else None]

    @property
    def is_flow(self) -> bool:
        return self.context.is_flow

    def entries_around(self) -> Mapping[str, Any]:
        """Data of the table in which the entry stands."""
        table = self.place.around[-1] if self.place.around else None
        return table if isinstance(table, Mapping) else {}


def unit_text(spec: Spec[Any]) -> str:
    """SI unit of an entry that holds a physical quantity, else an empty text."""
    if isinstance(spec, QuantityKind | Value) and spec.dimension != "1":
        return expected_unit(spec.dimension)
    return ""


def summary(cls: type) -> str:
    """First line of the documentation of a class."""
    return (cls.__doc__ or "").strip().partition("\n")[0]
