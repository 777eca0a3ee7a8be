"""Renaming of what a model text names at a place, everywhere in the text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from torsionnet.app.text.named_places import NamedPlace, NamesInText, named_places
from torsionnet.app.text.text_edits import TextEdit, TextSpan, edited
from torsionnet.base.entries.spec import name_fault
from torsionnet.base.errors import EntryPath, UsageError, fault_of
from torsionnet.base.expression_reading import check_name
from torsionnet.base.units import UnitError, parse_unit

# Definition of what a model text names at a place, and the other places that name it.


def place_at(places: Iterable[NamedPlace], offset: int) -> NamedPlace | None:
    """Place of which the name stands at an offset or ends there, None if there is none."""
    return next((one for one in places if one.span.start <= offset <= one.span.end), None)


def definition(text: str, offset: int, file: str = "", folder: Path | None = None) -> TextSpan | None:
    """Stretch where the thing named at an offset is defined, None where nothing is named or it is defined elsewhere."""
    places = named_places(text, file, folder)
    found = place_at(places, offset)
    same = (one.span for one in places if found is not None and one.is_definition and one.home == found.home)
    return next(same, None)


def references(text: str, offset: int, file: str = "", folder: Path | None = None) -> list[TextSpan]:
    """Stretches that name the same thing as the one at an offset, its definition included, in the order of the text."""
    places = named_places(text, file, folder)
    found = place_at(places, offset)
    return [] if found is None else [one.span for one in places if one.home == found.home]


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
    found = place_at(names.places, offset)
    return None if found is None or _not_here(found, names) else found.span


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
    found = place_at(names.places, offset)
    if found is None:
        raise UsageError(NOTHING_HERE)
    reason = _not_here(found, names) or _no_name(found, new) or _taken(found, new, names.places)
    if reason:
        raise UsageError(reason)
    if new == found.name:
        return []
    edits = [TextEdit(one.span, new) for one in names.places if one.home == found.home]
    after = NamesInText.of(edited(text, edits), file)
    if _homes(names.places, found.home, new) != Counter(one.home for one in after.places):
        raise UsageError(f'with the name "{new}" something else would be meant in places; choose another one')
    return edits


def _not_here(found: NamedPlace, names: NamesInText) -> str:
    """Message that something cannot be renamed in this text, empty where it can."""
    if found.home in names.unplaced:
        return f'"{found.name}" is spelled with escapes (\\) somewhere; write it out there first'
    if not any(one.is_definition and one.home == found.home for one in names.places):
        return f'"{found.name}" is not defined in this text, so it cannot be renamed here'
    return ""


def _no_name(found: NamedPlace, new: str) -> str:
    """Message that a text is no name for something of that kind, empty where it is one."""
    if found.kind in _CHOICES:
        wrong = not new or not new.isprintable() or any(mark in new for mark in ",= \t:#{}[]&*!|>'\"%@`\\")
        return f'"{new}" is no name for a configuration: no spaces, commas, = or signs of YAML' if wrong else ""
    if found.kind in ("use", "part") and "." in new:
        return f'"{new}" has a dot; that stands between the name of a part and what is in it'
    is_value = found.kind in ("parameter", "use")
    unfit = check_name(new) if is_value else name_fault(new)
    reason = fault_of(unfit).message if unfit else ""
    if not reason and new == "ground":
        reason = '"ground" is the node that never moves; choose another name'
    if not reason and "." in new and "." not in found.name:
        reason = f'"{new}" has a dot, which stands between the name of a part and what is in it; use _ instead'
    if not reason and found.kind == "parameter" and len(new) > 1 and _is_unit(new):
        reason = f'"{new}" is a unit; choose another name for the parameter'
    return reason


def _is_unit(word: str) -> bool:
    try:
        parse_unit(word)
    except UnitError:
        return False
    return True


def _taken(found: NamedPlace, new: str, places: Iterable[NamedPlace]) -> str:
    """Message that a name is that of something else already, empty where it is free."""
    if new == found.name:
        return ""
    kinds = next((group for group in _TOGETHER if found.kind in group), (found.kind,))
    depth = len(found.home) - (1 if found.kind == "configuration" else 2)
    for one in places:
        if one.name == new and one.kind in kinds and one.home[:depth] == found.home[:depth]:
            if one.kind == "use":
                return f'"{new}" is a part used in this model already; choose another name'
            article = "an" if one.kind[0] in "aeiou" else "a"
            return f'"{new}" is {article} {one.kind} of this model already; choose another name'
    return ""


def _homes(places: Iterable[NamedPlace], home: EntryPath, new: str) -> Counter[EntryPath]:
    """Number of times that each thing is named, after one of them has another name."""

    def changed(path: EntryPath) -> EntryPath:
        return (*home[:-1], new, *path[len(home) :]) if path[: len(home)] == home else path

    return Counter(changed(one.home) for one in places)
