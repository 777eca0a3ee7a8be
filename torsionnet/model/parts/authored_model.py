"""Model with parts as its author wrote it, also after values in it have changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from torsionnet.model.definition import Definition
from torsionnet.model.parts.flattening import SECTIONS, flatten_parts
from torsionnet.model.parts.use import Use


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
        whole = {one.name for one in fields(flat)} - {*SECTIONS, "parts", "use", "authored"}
        now: dict[str, Any] = {name: getattr(flat, name) for name in whole}
        now |= {section: self._own(section, flat) for section in SECTIONS}
        changed = replace(self.authored, **now, use=self._uses(flat))
        made, faults = flatten_parts(changed)
        told = [fault for fault in faults if fault.severity == "error"]
        return None if told or made.flat_data() != flat.flat_data() or _order(made) != _order(flat) else changed

    def _own(self, section: str, flat: Definition) -> dict[str, Any]:
        """Entries of a section that the author wrote, as they are now, and entries added later, by name."""
        own, before, now = (getattr(one, section) for one in (self.authored, self.flat, flat))
        kept = {name: now.get(name, one) for name, one in own.items() if name in now or name not in before}
        return kept | {name: one for name, one in now.items() if name not in before}

    def _uses(self, flat: Definition) -> Mapping[str, Use]:
        """Uses of parts by name, with changed values of parts given where the part is used."""
        uses = dict(self.authored.use)
        for name, parameter in flat.parameters.items():
            before = self.flat.parameters.get(name)
            if before is None or parameter.by is not None or before == parameter or name in self.authored.parameters:
                continue
            found = owner(self.authored.use, name)
            if found is not None:
                use, index, own = found
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
    for use, one in uses.items():
        prefixes = one.prefixes(use)
        if prefix in prefixes:
            return use, prefixes.index(prefix), own
    return None


def with_copy_value(use: Use, own: str, index: int, value: Any, before: tuple[Any, ...]) -> Use:
    """Use of a part with another value of a parameter for one of its copies."""
    old = use.parameters.get(own)
    values = list(old) if isinstance(old, tuple) else [old if old is not None else one for one in before]
    values[index] = value
    alone = use.repeat is None
    return replace(use, parameters={**use.parameters, own: values[0] if alone else tuple(values)})


def _same(one: Definition, other: Definition) -> bool:
    """Whether all entries of two definitions of a model are the same objects.

    Equal contents are compared more slowly.
    """
    return all(
        getattr(one, entry.name) is getattr(other, entry.name) for entry in fields(one) if entry.name != "authored"
    )


def _order(definition: Definition) -> list[list[str]]:
    return [list(getattr(definition, section)) for section in SECTIONS]
