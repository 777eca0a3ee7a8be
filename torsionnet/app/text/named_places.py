"""Places in a model text where nodes, parameters, elements, parts and other things are named."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from torsionnet.app.text.name_homes import (
    Mention,
    Scope,
    TextStretches,
    changed_section,
    homes,
    properties_of,
    scalar_places,
)
from torsionnet.app.text.text_edits import TextLines, TextSpan
from torsionnet.base.entries.declared import files_beside
from torsionnet.base.entries.spec import Spec
from torsionnet.base.errors import EntryPath
from torsionnet.model.files.located_yaml import LocatedNode, Place

SECTION_KINDS = {
    "parameters": "parameter",
    "elements": "element",
    "parts": "part",
    "use": "use",
    "inputs": "input",
    "sensors": "sensor",
    "excitations": "excitation",
    "limits": "limit",
    "scenarios": "scenario",
}
"""Kind of the things whose names are the keys of a section of a model, by section."""


@dataclass(frozen=True)
class NamedPlace:
    """Stretch of a model text that names something.

    Attributes
    ----------
    name, kind : str
        What is named: a node, parameter, element, part, use, axis, configuration, input, sensor, channel, excitation,
        limit or scenario.
    span : TextSpan
        Of the name alone, without quotes.
    is_definition : bool
        Whether the thing is defined here; a node is where an element first names it.
    path : path
        Keys that lead to the entry that holds the name.
    home : path
        Which thing of that name it is: a node of a part is another one than the node of that name in the model.
    """

    name: str
    kind: str
    span: TextSpan
    is_definition: bool = False
    path: EntryPath = ()
    home: EntryPath = ()


def named_places(text: str, file: str = "", folder: Path | None = None) -> list[NamedPlace]:
    """Places where a model text names something, in the order of the text."""
    del folder
    return list(NamesInText.of(text, file).places)


@dataclass
class NamesInText:
    """Names in a model text: their places, and the homes of those that are written in a way that has no place.

    A name has no place where escapes in quotes spell it.
    """

    root: LocatedNode | None
    stretches: TextStretches
    places: tuple[NamedPlace, ...] = ()
    unplaced: set[EntryPath] = field(default_factory=set)

    @classmethod
    def of(cls, text: str, file: str = "") -> NamesInText:
        """Names in a model text, which may be faulty."""
        from torsionnet.app.text.tolerant_reading import tolerant_document

        document = tolerant_document(text.removeprefix("\ufeff"), file)
        stretches = TextStretches(TextLines(text), 1 if text.startswith("\ufeff") else 0)
        found = cls(document.root, stretches)
        if document.root is not None and isinstance(document.root.value, Mapping):
            with files_beside(None):  # what other files hold names nothing here
                found.places = _Walk(document.root, stretches, found.unplaced).places()
        return found


class _Walk:
    """Walk through the entries of a model, each by its specification."""

    def __init__(self, root: LocatedNode, stretches: TextStretches, unplaced: set[EntryPath]) -> None:
        self.root, self.stretches, self.unplaced = root, stretches, unplaced
        self.found: dict[TextSpan, NamedPlace] = {}

    def places(self) -> tuple[NamedPlace, ...]:
        from torsionnet.model.definition import Definition
        from torsionnet.model.parts.part import Part

        scope = Scope((), self.root.value)
        self.sections(self.root, Definition.entry_specs(self.root.value), scope)
        parts = self.root.entries.get("parts")
        for name, part in parts.entries.items() if parts else ():
            if isinstance(part.value, Mapping):
                self.sections(part, Part.entry_specs(part.value), Scope(("parts", name), part.value))
        return self.with_first_mentions(sorted(self.found.values(), key=lambda one: one.span))

    @staticmethod
    def with_first_mentions(places: list[NamedPlace]) -> tuple[NamedPlace, ...]:
        """Places in order, with the first mention of what has no entry of its own as its definition."""
        first: dict[EntryPath, NamedPlace] = {}
        for one in places:
            known = first.get(one.home)
            is_first = known is None or (_in_element(one) and not _in_element(known))
            if one.kind in ("node", "channel") and is_first:
                first[one.home] = one
        return tuple(replace(one, is_definition=True) if first.get(one.home) is one else one for one in places)

    def sections(self, node: LocatedNode, specs: Mapping[Any, Spec[Any]], scope: Scope) -> None:
        for section, table in node.entries.items():
            path = (*scope.path, section)
            if section == "configurations":
                self.axes(specs[section], table, path, scope)
                continue
            for name, entry in table.entries.items() if section in SECTION_KINDS else ():
                if entry.key_place:
                    span = self.stretches.whole(entry.key_place)
                    self.defined(str(name), SECTION_KINDS[str(section)], span, (*path, name))
            if section in specs and section != "parts":
                self.entry(specs[section], table, path, scope)

    def axes(self, spec: Spec[Any], table: LocatedNode, path: EntryPath, scope: Scope) -> None:
        """Axes of configurations and their alternatives, whose names are the keys of tables."""
        from torsionnet.model.configurations import ALTERNATIVES, DEFAULT_AXIS

        specs = spec.entry_specs(table.value)
        for name, entry in table.entries.items():
            if entry.key_place is None or name not in specs:
                continue
            is_axis = specs[name] is ALTERNATIVES
            home = (*path, name) if is_axis else (*path, DEFAULT_AXIS, name)
            kind = "axis" if is_axis else "configuration"
            self.defined(str(name), kind, self.stretches.whole(entry.key_place), home)
            for label, one in entry.entries.items() if is_axis else ():
                if one.key_place:
                    span = self.stretches.whole(one.key_place)
                    self.defined(str(label), "configuration", span, (*path, name, label))
        self.entry(spec, table, path, scope)

    def defined(self, name: str, kind: str, span: TextSpan, home: EntryPath) -> None:
        if self.stretches.lines.text[span.start : span.end] == name:
            self.found.setdefault(span, NamedPlace(name, kind, span, True, home, home))
        else:
            self.unplaced.add(home)

    def entry(self, spec: Spec[Any], node: LocatedNode, path: EntryPath, scope: Scope) -> None:
        """Names in an entry, which its specification says, and those in the entries within it."""
        raw = node.value
        if raw is None or isinstance(raw, bool | int | float) or self.stretches.is_alias(node.place):
            return
        keys, inner = spec.key_names(raw), spec.entry_specs(raw)
        if not inner and not keys:
            mentions = scope.recorder.mentions(spec, raw) if _has_words(raw) else []
            if mentions:
                fixed = properties_of(spec) if isinstance(raw, Mapping) else ()
                self.mentioned(mentions, [*scalar_places(node, fixed)], path, scope)
            return
        for key, one in node.entries.items():
            below = (*path, key)
            if key in keys and one.key_place:
                self.mentioned(scope.recorder.mentions(keys[key], key), [one.key_place], below, scope)
            within = inner.get(key) or self.changed(key, scope)
            if within is not None:
                self.entry(within, one, below, scope)

    @staticmethod
    def changed(key: object, scope: Scope) -> Spec[Any] | None:
        """Specification of an entry that an alternative changes, as ``engine.misfire``; None for another key."""
        found = changed_section(str(key), scope) if "." in str(key) else None
        return found and found.spec

    def mentioned(self, mentions: list[Mention], places: Sequence[Place], path: EntryPath, scope: Scope) -> None:
        spans = self.stretches.located(places, [one.name for one in mentions]) if mentions else []
        for mention, span in zip(mentions, spans, strict=True):
            for one in homes(mention, scope, self.root):
                if span is None:
                    is_elsewhere = any(map(self.stretches.is_alias, places))
                    self.unplaced.update(() if is_elsewhere else (one.home,))
                    continue
                own = TextSpan(span.start + one.start, span.start + one.start + len(one.name))
                self.found.setdefault(own, NamedPlace(one.name, one.kind, own, False, path, one.home))


def _in_element(place: NamedPlace) -> bool:
    return place.path[len(place.home) - 2 :][:1] == ("elements",)


def _has_words(raw: object) -> bool:
    """Whether anything in a value could be a name."""
    if isinstance(raw, str):
        return not raw.isdigit()
    if isinstance(raw, Mapping):
        return any(not str(key).isdigit() or _has_words(one) for key, one in raw.items())
    return isinstance(raw, list) and any(_has_words(one) for one in raw)
