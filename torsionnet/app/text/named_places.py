"""Places in a model text where nodes, parameters, elements, parts and other things are named, and their renaming."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
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
from torsionnet.app.text.text_edits import TextEdit, TextLines, TextSpan, edited
from torsionnet.base.entries.declared import files_beside
from torsionnet.base.entries.spec import Spec, name_fault
from torsionnet.base.errors import EntryPath, UsageError, fault_of
from torsionnet.base.expression_reading import check_name
from torsionnet.base.units import UnitError, parse_unit
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
        names = cls(document.root, stretches)
        if document.root is not None and isinstance(document.root.value, Mapping):
            with files_beside(None):  # what other files hold names nothing here
                names.places = _Walk(document.root, stretches, names.unplaced).places()
        return names


class _Walk:
    """Walk through the entries of a model, each by its specification."""

    def __init__(self, root: LocatedNode, stretches: TextStretches, unplaced: set[EntryPath]) -> None:
        self.root, self.stretches, self.unplaced = root, stretches, unplaced
        self.by_span: dict[TextSpan, NamedPlace] = {}

    def places(self) -> tuple[NamedPlace, ...]:
        from torsionnet.model.definition import Definition
        from torsionnet.model.parts.part import Part

        scope = Scope((), self.root.value)
        self.sections(self.root, Definition.entry_specs(self.root.value), scope)
        parts = self.root.entries.get("parts")
        for name, part in parts.entries.items() if parts else ():
            if isinstance(part.value, Mapping):
                self.sections(part, Part.entry_specs(part.value), Scope(("parts", name), part.value))
        return self.with_first_mentions(sorted(self.by_span.values(), key=lambda place: place.span))

    @staticmethod
    def with_first_mentions(places: list[NamedPlace]) -> tuple[NamedPlace, ...]:
        """Places in order, with the first mention of what has no entry of its own as its definition."""
        first: dict[EntryPath, NamedPlace] = {}
        for place in places:
            known = first.get(place.home)
            is_first = known is None or (_in_element(place) and not _in_element(known))
            if place.kind in ("node", "channel") and is_first:
                first[place.home] = place
        return tuple(
            replace(place, is_definition=True) if first.get(place.home) is place else place for place in places
        )

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
            for label, alternative in entry.entries.items() if is_axis else ():
                if alternative.key_place:
                    span = self.stretches.whole(alternative.key_place)
                    self.defined(str(label), "configuration", span, (*path, name, label))
        self.entry(spec, table, path, scope)

    def defined(self, name: str, kind: str, span: TextSpan, home: EntryPath) -> None:
        if self.stretches.lines.text[span.start : span.end] == name:
            self.by_span.setdefault(span, NamedPlace(name, kind, span, True, home, home))
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
        for key, child in node.entries.items():
            below = (*path, key)
            if key in keys and child.key_place:
                self.mentioned(scope.recorder.mentions(keys[key], key), [child.key_place], below, scope)
            within = inner.get(key) or self.changed(key, scope)
            if within is not None:
                self.entry(within, child, below, scope)

    @staticmethod
    def changed(key: object, scope: Scope) -> Spec[Any] | None:
        """Specification of an entry that an alternative changes, as ``engine.misfire``; None for another key."""
        section = changed_section(str(key), scope) if "." in str(key) else None
        return section and section.spec

    def mentioned(self, mentions: list[Mention], places: Sequence[Place], path: EntryPath, scope: Scope) -> None:
        spans = self.stretches.located(places, [mention.name for mention in mentions]) if mentions else []
        for mention, span in zip(mentions, spans, strict=True):
            for home in homes(mention, scope, self.root):
                if span is None:
                    is_elsewhere = any(map(self.stretches.is_alias, places))
                    self.unplaced.update(() if is_elsewhere else (home.home,))
                    continue
                own = TextSpan(span.start + home.start, span.start + home.start + len(home.name))
                self.by_span.setdefault(own, NamedPlace(home.name, home.kind, own, False, path, home.home))


def _in_element(place: NamedPlace) -> bool:
    return place.path[len(place.home) - 2 :][:1] == ("elements",)


def _has_words(raw: object) -> bool:
    """Whether anything in a value could be a name."""
    if isinstance(raw, str):
        return not raw.isdigit()
    if isinstance(raw, Mapping):
        return any(not str(key).isdigit() or _has_words(below) for key, below in raw.items())
    return isinstance(raw, list) and any(_has_words(below) for below in raw)


# Definition of what a model text names at a place, the other places that name it, and its renaming in all of them.


def place_at(places: Iterable[NamedPlace], offset: int) -> NamedPlace | None:
    """Place of which the name stands at an offset or ends there, None if there is none."""
    return next((place for place in places if place.span.start <= offset <= place.span.end), None)


def definition(text: str, offset: int, file: str = "", folder: Path | None = None) -> TextSpan | None:
    """Stretch where the thing named at an offset is defined, None where nothing is named or it is defined elsewhere."""
    places = named_places(text, file, folder)
    place = place_at(places, offset)
    same = (other.span for other in places if place is not None and other.is_definition and other.home == place.home)
    return next(same, None)


def references(text: str, offset: int, file: str = "", folder: Path | None = None) -> list[TextSpan]:
    """Stretches that name the same thing as the one at an offset, its definition included, in the order of the text."""
    places = named_places(text, file, folder)
    place = place_at(places, offset)
    return [] if place is None else [other.span for other in places if other.home == place.home]


NOTHING_HERE = "nothing that has a name stands here; put the cursor on a node, a parameter, an element or a sensor"
"""Message that there is nothing to rename at a place."""
_TOGETHER = (
    ("element", "use"),
    ("sensor", "input"),
)
"""Groups of kinds of things of which no two may have the same name."""
_CHOICES = ("axis", "configuration")


def renamable(text: str, offset: int, file: str = "", folder: Path | None = None) -> TextSpan | None:
    """Stretch of the name at an offset if it can be renamed, else None."""
    del folder
    names = NamesInText.of(text, file)
    place = place_at(names.places, offset)
    return None if place is None or _not_here(place, names) else place.span


def rename(text: str, offset: int, new: str, file: str = "", folder: Path | None = None) -> list[TextEdit]:
    """Edits that give what is named at an offset another name everywhere in the text.

    Raises
    ------
    UsageError
        Nothing is named here, or the new name is none or is taken.

    Examples
    --------
    >>> text = "elements: {disc: {type: inertia, node: hub, inertia: 2 kg*m^2}}\\nsensors: {phi: {angle: hub}}"
    >>> print(edited(text, rename(text, text.index("hub"), "rim")))
    elements: {disc: {type: inertia, node: rim, inertia: 2 kg*m^2}}
    sensors: {phi: {angle: rim}}
    """
    del folder
    names = NamesInText.of(text, file)
    place = place_at(names.places, offset)
    if place is None:
        raise UsageError(NOTHING_HERE, kind="unknown-name")
    reasons = {
        "unknown-name": _not_here(place, names),
        "invalid-name": _no_name(place, new),
        "repeated-name": _taken(place, new, names.places),
    }
    for kind, reason in reasons.items():
        if reason:
            raise UsageError(reason, kind=kind)
    if new == place.name:
        return []
    # All places that lead to the same home, not all that are spelt alike.
    edits = [TextEdit(other.span, new) for other in names.places if other.home == place.home]
    # Read anew, every name has to lead where it led before.
    after = NamesInText.of(edited(text, edits), file)
    if _homes(names.places, place.home, new) != Counter(other.home for other in after.places):
        raise UsageError(
            f'with the name "{new}" something else would be meant in places; choose another one', kind="ambiguous-name"
        )
    return edits


def _not_here(place: NamedPlace, names: NamesInText) -> str:
    """Message that something cannot be renamed in this text, empty where it can."""
    if place.home in names.unplaced:
        return f'"{place.name}" is spelled with escapes (\\) somewhere; write it out there first'
    if not any(other.is_definition and other.home == place.home for other in names.places):
        return f'"{place.name}" is not defined in this text, so it cannot be renamed here'
    return ""


def _no_name(place: NamedPlace, new: str) -> str:
    """Message that a text is no name for something of that kind, empty where it is one."""
    if place.kind in _CHOICES:
        wrong = not new or not new.isprintable() or any(mark in new for mark in ",= \t:#{}[]&*!|>'\"%@`\\")
        return f'"{new}" is no name for a configuration: no spaces, commas, = or signs of YAML' if wrong else ""
    if place.kind in ("use", "part") and "." in new:
        return f'"{new}" has a dot; that stands between the name of a part and what is in it'
    is_value = place.kind in ("parameter", "use")
    unfit = check_name(new) if is_value else name_fault(new)
    reason = fault_of(unfit).message if unfit else ""
    if not reason and new == "ground":
        reason = '"ground" is the node that never moves; choose another name'
    if not reason and "." in new and "." not in place.name:
        reason = f'"{new}" has a dot, which stands between the name of a part and what is in it; use _ instead'
    if not reason and place.kind == "parameter" and len(new) > 1 and _is_unit(new):
        reason = f'"{new}" is a unit; choose another name for the parameter'
    return reason


def _is_unit(word: str) -> bool:
    try:
        parse_unit(word)
    except UnitError:
        return False
    return True


def _taken(place: NamedPlace, new: str, places: Iterable[NamedPlace]) -> str:
    """Message that a name is that of something else already, empty where it is free."""
    if new == place.name:
        return ""
    kinds = next((group for group in _TOGETHER if place.kind in group), (place.kind,))
    depth = len(place.home) - (1 if place.kind == "configuration" else 2)
    for other in places:
        if other.name == new and other.kind in kinds and other.home[:depth] == place.home[:depth]:
            if other.kind == "use":
                return f'"{new}" is a part used in this model already; choose another name'
            article = "an" if other.kind[0] in "aeiou" else "a"
            return f'"{new}" is {article} {other.kind} of this model already; choose another name'
    return ""


def _homes(places: Iterable[NamedPlace], home: EntryPath, new: str) -> Counter[EntryPath]:
    """Number of times that each thing is named, after one of them has another name."""

    def changed(path: EntryPath) -> EntryPath:
        return (*home[:-1], new, *path[len(home) :]) if path[: len(home)] == home else path

    return Counter(changed(place.home) for place in places)
