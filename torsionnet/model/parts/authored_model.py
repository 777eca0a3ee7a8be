"""Model with parts as its author wrote it, also after values in it have changed."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.phrases import in_names
from torsionnet.model.configurations import DEFAULT_AXIS
from torsionnet.model.definition import Definition
from torsionnet.model.parts.flattening import SECTIONS, flatten_parts
from torsionnet.model.parts.part import Part, Use
from torsionnet.model.sections import USE


@dataclass(frozen=True)
class AuthoredModel:
    """Definition of a model with its parts, and the flat definition without parts that follows from it.

    A changed flat definition is written with its parts where changes of the model's own entries and of the values given
    to parts can make it; else flat.
    """

    authored: Definition
    flat: Definition

    def data(self, flat: Definition) -> dict[str, Any]:
        """Entries of a model file for a changed flat definition, with parts where possible."""
        changed = self.changed(flat)
        return flat.flat_data() if changed is None else changed.flat_data()

    def changed(self, flat: Definition) -> Definition | None:
        """Definition with parts whose flat form is ``flat``; None if there is none."""
        if _same(flat, self.flat):
            return self.authored
        whole = {field.name for field in fields(flat)} - {*SECTIONS, "parts", "use", "authored"}
        now: dict[str, Any] = {name: getattr(flat, name) for name in whole}
        now |= {section: self._own(section, flat) for section in SECTIONS}
        changed = replace(self.authored, **now, use=self._uses(flat))
        made, faults = flatten_parts(changed)
        told = [fault for fault in faults if fault.severity == "error"]
        return None if told or made.flat_data() != flat.flat_data() or _order(made) != _order(flat) else changed

    def _own(self, section: str, flat: Definition) -> dict[str, Any]:
        """Entries of a section that the author wrote, as they are now, and entries added later, by name."""
        own, before, now = (getattr(model, section) for model in (self.authored, self.flat, flat))
        kept = {name: now.get(name, written) for name, written in own.items() if name in now or name not in before}
        return kept | {name: later for name, later in now.items() if name not in before}

    def _uses(self, flat: Definition) -> Mapping[str, Use]:
        """Uses of parts by name, with changed values of parts given where the part is used."""
        uses = dict(self.authored.use)
        for name, parameter in flat.parameters.items():
            before = self.flat.parameters.get(name)
            if before is None or parameter.by is not None or before == parameter or name in self.authored.parameters:
                continue
            owning = owner(self.authored.use, name)
            if owning is not None:
                use, index, own = owning
                uses[use] = with_copy_value(uses[use], own, index, parameter.value, self._values(use, own))
        return uses

    def _values(self, use: str, own: str) -> tuple[Any, ...]:
        """Values of a part's parameter before the change, one for each copy of a use."""
        prefixes = self.authored.use[use].prefixes(use)
        return tuple(self.flat.parameters[f"{prefix}.{own}"].value for prefix in prefixes)


def owner(uses: Mapping[str, Use], name: str) -> tuple[str, int, str] | None:
    """Name of the use that a name belongs to, index of the copy, and the name within that copy.

    None for a name of the model.
    """
    prefix, _, own = name.partition(".")
    for use, part_use in uses.items():
        prefixes = part_use.prefixes(use)
        if prefix in prefixes:
            return use, prefixes.index(prefix), own
    return None


def with_copy_value(use: Use, own: str, index: int, value: Any, before: tuple[Any, ...]) -> Use:
    """Use of a part with another value of a parameter for one of its copies."""
    old = use.parameters.get(own)
    values = list(old) if isinstance(old, tuple) else [old if old is not None else was for was in before]
    values[index] = value
    alone = use.repeat is None
    return replace(use, parameters={**use.parameters, own: values[0] if alone else tuple(values)})


def _same(first: Definition, other: Definition) -> bool:
    """Whether all entries of two definitions of a model are the same objects.

    Equal contents are compared more slowly.
    """
    return all(
        getattr(first, entry.name) is getattr(other, entry.name) for entry in fields(first) if entry.name != "authored"
    )


def _order(definition: Definition) -> list[list[str]]:
    return [list(getattr(definition, section)) for section in SECTIONS]


# Parts put into models by calls from Python.


def as_written(definition: Definition) -> Definition:
    """Definition of a model with its parts, where it can be written with them."""
    written = definition.authored
    changed = written.changed(definition) if isinstance(written, AuthoredModel) else None
    return replace(definition, authored=None) if changed is None else changed


def part_of(definition: Definition) -> tuple[Part, Mapping[str, Part]]:
    """Part made of a model, and the parts that the model uses itself, by name."""
    written = as_written(definition)
    return Part(**{field.name: getattr(written, field.name) for field in fields(Part)}), written.parts


def with_use(
    definition: Definition, name: str, use: Mapping[str, Any], model: Definition | None
) -> tuple[Definition, list[Fault]]:
    """Definition with one more use, of ``model`` or of a part that it has, and the faults of that use."""
    written = as_written(definition)
    parts = dict(written.parts)
    if model is not None:
        if not model.ports:
            text = f'"{model.name}" has no ports; give them when it is made: ports=["inner", "outer"]'
            return written, [Fault(text, ("use", name, "part"), kind="missing-entry")]
        use = {**use, "part": _put(parts, model)}
    uses, faults = USE.read({name: use})
    if name in written.use:
        faults.append(
            Fault(
                f'"{name}" is used already; give this one another name',
                ("use", name),
                on_key=True,
                kind="repeated-name",
            )
        )
    wrong = [fault.under("use") for fault in faults]
    return replace(written, parts=parts, use={**written.use, **uses}), wrong


def _put(parts: dict[str, Part], model: Definition) -> str:
    """Add a model to the parts, and return its name there; an equal part that is there already keeps its name."""
    part, inner = part_of(model)
    names = {name: _free(parts, name, inner_part) for name, inner_part in inner.items()}
    for name, inner_part in inner.items():
        parts[names[name]] = _renamed_uses(inner_part, names)
    part = _renamed_uses(part, names)
    wish = re.sub(r"\W+", "_", model.name, flags=re.ASCII).strip("_").lower()
    name = _free(parts, wish if wish[:1].isalpha() else f"part_{wish}".rstrip("_"), part)
    parts[name] = part
    return name


def _renamed_uses(part: Part, names: Mapping[str, str]) -> Part:
    uses: dict[str, Use] = {name: replace(use, part=names.get(use.part, use.part)) for name, use in part.use.items()}
    return replace(part, use=uses) if uses else part


def _free(parts: Mapping[str, Part], wish: str, part: Part) -> str:
    """Name ``wish`` of a part if it is free or that of an equal part, else with the first free number behind it."""
    name, number = wish, 1
    while name in parts and parts[name] != part:
        number += 1
        name = f"{wish}_{number}"
    return name


# Places where an author wrote the entries of a flat model, so that faults are shown there and at each use.


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
        owning = _owner(model, section, name)
        if owning is None:
            return PlaceInPart((*base, section, *_short(model, section, name), *rest), uses, prefix)
        use, index, own = owning
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
    owning = owner(model.use, name)
    return (*owning[:2], DEFAULT_AXIS) if owning and section == "configurations" and not owning[2] else owning


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
    distinct: dict[tuple[object, ...], Fault] = {}
    for fault in faults:
        told = _in_part(fault, place_in_part(flat.authored.authored, fault.path))
        distinct.setdefault((told.message, told.severity, told.configuration, told.path), told)
    return list(distinct.values())


def _in_part(fault: Fault, place: PlaceInPart) -> Fault:
    """Fault at its place in a part, in whose words the names of the flat model have no prefix."""
    if not place.prefix:
        return replace(fault, path=place.path)

    def own(name: str) -> str:
        return name.removeprefix(place.prefix)

    return replace(
        fault,
        path=place.path,
        message=in_names(fault.message, own),
        about=own(fault.about),
        meant=own(fault.meant),
        uses=place.uses,
    )
