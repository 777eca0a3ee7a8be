"""Names of nodes, elements, parameters and other things that a model text may refer to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

from torsionnet.app.text.tolerant_reading import tolerant_document
from torsionnet.base.entries.declared import files_beside, nearby_file
from torsionnet.base.entries.spec import EntryError, Spec
from torsionnet.base.errors import EntryPath
from torsionnet.model.channels import ChannelName, RecordedName
from torsionnet.model.element_base.element import ELEMENT_TYPES
from torsionnet.model.element_base.element_entries import ElementName, NodeName, NodePair, NodeText, PlaceOnElement
from torsionnet.model.element_base.laws import GROUND
from torsionnet.model.files.part_includes import MOST_INCLUDED
from torsionnet.model.parts.use import PartName, PartParameter, PortName

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
        found: Any = self.data
        if isinstance(found.get("model"), str) and "elements" not in found:
            return {**self._model_of_bench(str(found["model"])), **found}
        for step in self.scope:
            found = found.get(step) if isinstance(found, Mapping) else None
        return found if isinstance(found, Mapping) else {}

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
        found = dict.fromkeys(_nodes_of(self.table("elements").values()))
        for _, use in self._uses():
            for at in _table(use, "at").values():
                found |= dict.fromkeys(one for one in (at if isinstance(at, list) else [at]) if isinstance(one, str))
        for prefix, part, joined in self._copies():
            inner = _nodes_of(_table(part, "elements").values())
            found |= dict.fromkeys(f"{prefix}.{node}" for node in inner if node not in joined)
        found.pop(GROUND, None)
        return tuple(found)

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

        found = {name: _read(path) for name, path in library_parts().items()}
        with files_beside(self.folder):
            for name in _listed(self.data.get("include"))[:MOST_INCLUDED]:
                try:
                    path = nearby_file(str(name))
                except EntryError:
                    continue
                held = _read(path)
                found |= {str(key): one for key, one in _table(held, "parts").items() if isinstance(one, Mapping)}
                found |= {path.stem: held} if "ports" in held else {}
        own = {str(name): one for name, one in _table(self.data, "parts").items() if isinstance(one, Mapping)}
        return {**own, **{name: one for name, one in found.items() if name not in own}}

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
    found = next((kinds for classes, kinds in table if isinstance(spec, classes)), ())
    return found or (("node",) if type(spec).__name__ == "OneOrTwoNodes" else ())


def _table(data: Any, section: str) -> Mapping[str, Any]:
    found = data.get(section) if isinstance(data, Mapping) else None
    return found if isinstance(found, Mapping) else {}


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
