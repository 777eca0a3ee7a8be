"""Places where an author wrote the entries of a flat model, so that faults are shown there and at each use."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from torsionnet.base.errors import EntryPath, Fault, Worded
from torsionnet.model.configurations import DEFAULT_AXIS
from torsionnet.model.definition import Definition
from torsionnet.model.parts.authored_model import owner
from torsionnet.model.parts.flattening import SECTIONS
from torsionnet.model.parts.part import Part


@dataclass(frozen=True)
class PlaceInPart:
    """Path of a part's entry as written, the uses that lead to it, outermost first, and their prefix of names."""

    path: EntryPath
    uses: tuple[EntryPath, ...] = ()
    prefix: str = ""


def place_in_part(definition: Definition, path: EntryPath) -> PlaceInPart:
    """Place where an entry of the flat model is written in a model with parts."""
    if len(path) < 2 or path[0] not in SECTIONS:
        return PlaceInPart(path)
    section, name, rest = str(path[0]), str(path[1]), path[2:]
    model: Definition | Part = definition
    base: EntryPath = ()
    uses: tuple[EntryPath, ...] = ()
    prefix = ""
    while name not in getattr(model, section):
        found = _owner(model, section, name)
        if found is None:
            return PlaceInPart((*base, section, *_short(model, section, name), *rest), uses, prefix)
        use, index, own = found
        given = model.use[use].parameters.get(own) if section == "parameters" else None
        if given is not None:
            each = (index,) if isinstance(given, tuple) else ()
            return PlaceInPart((*base, "use", use, "parameters", own, *each), uses, prefix)
        before = model.use[use].prefixes(use)[index] + "."
        rest = _renamed_back(section, rest, before)
        prefix += before
        uses = (*uses, (*base, "use", use))
        base, name = ("parts", model.use[use].part), own
        if base[1] not in definition.parts:
            return PlaceInPart(uses[-1], uses[:-1], prefix)
        model = definition.parts[str(base[1])]
    return PlaceInPart((*base, section, name, *rest), uses, prefix)


def _owner(model: Definition | Part, section: str, name: str) -> tuple[str, int, str] | None:
    found = owner(model.use, name)
    return (*found[:2], DEFAULT_AXIS) if found and section == "configurations" and not found[2] else found


def _short(model: Definition | Part, section: str, name: str) -> tuple[str]:
    """Name of the element that stands for several, one of which has this name."""
    short = name.partition(".")[0]
    return (short,) if section == "elements" and short in model.elements else (name,)


def _renamed_back(section: str, rest: EntryPath, before: str) -> EntryPath:
    """Path within an alternative with the name that the changed entry has in the part."""
    if section != "configurations" or len(rest) < 2:
        return rest
    return (rest[0], str(rest[1]).removeprefix(before), *rest[2:])


def at_written_places(flat: Definition, faults: Iterable[Fault]) -> list[Fault]:
    """Faults of a flat model with the paths where their entries are written.

    A fault in every use of a part is kept once, in its words.
    """
    if flat.authored is None:
        return list(faults)
    found: dict[tuple[object, ...], Fault] = {}
    for fault in faults:
        told = _in_part(fault, place_in_part(flat.authored.authored, fault.path))
        found.setdefault((told.message, told.severity, told.configuration, told.path), told)
    return list(found.values())


def _in_part(fault: Fault, place: PlaceInPart) -> Fault:
    """Fault at its place in a part, in whose words the names of the flat model have no prefix."""
    if not place.prefix:
        return replace(fault, path=place.path)

    def own(name: str) -> str:
        return name.removeprefix(place.prefix)

    message = fault.message.in_names(own) if isinstance(fault.message, Worded) else fault.message
    return replace(
        fault, path=place.path, message=message, about=own(fault.about), meant=own(fault.meant), uses=place.uses
    )
