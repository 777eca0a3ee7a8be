"""Parts put into models by calls from Python."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from torsionnet.base.errors import Fault
from torsionnet.model.definition import Definition
from torsionnet.model.parts.authored_model import AuthoredModel
from torsionnet.model.parts.part import Part
from torsionnet.model.parts.part_entries import USE
from torsionnet.model.parts.use import Use


def as_written(definition: Definition) -> Definition:
    """Definition of a model with its parts, where it can be written with them."""
    written = definition.authored
    changed = written.changed(definition) if isinstance(written, AuthoredModel) else None
    return replace(definition, authored=None) if changed is None else changed


def part_of(definition: Definition) -> tuple[Part, Mapping[str, Part]]:
    """Part made of a model, and the parts that the model uses itself, by name."""
    written = as_written(definition)
    return Part(**{one.name: getattr(written, one.name) for one in fields(Part)}), written.parts


def with_use(
    definition: Definition, name: str, use: Mapping[str, Any], model: Definition | None
) -> tuple[Definition, list[Fault]]:
    """Definition with one more use, of ``model`` or of a part that it has, and the faults of that use."""
    written = as_written(definition)
    parts = dict(written.parts)
    if model is not None:
        if not model.ports:
            text = f'"{model.name}" has no ports; give them when it is made: ports=["inner", "outer"]'
            return written, [Fault(text, ("use", name, "part"))]
        use = {**use, "part": _put(parts, model)}
    uses, faults = USE.read({name: use})
    if name in written.use:
        faults.append(Fault(f'"{name}" is used already; give this one another name', ("use", name), on_key=True))
    found = [fault.under("use") for fault in faults]
    return replace(written, parts=parts, use={**written.use, **uses}), found


def _put(parts: dict[str, Part], model: Definition) -> str:
    """Add a model to the parts, and return its name there; an equal part that is there already keeps its name."""
    part, inner = part_of(model)
    names = {name: _free(parts, name, one) for name, one in inner.items()}
    for name, one in inner.items():
        parts[names[name]] = _renamed_uses(one, names)
    part = _renamed_uses(part, names)
    wish = re.sub(r"\W+", "_", model.name, flags=re.ASCII).strip("_").lower()
    name = _free(parts, wish if wish[:1].isalpha() else f"part_{wish}".rstrip("_"), part)
    parts[name] = part
    return name


def _renamed_uses(part: Part, names: Mapping[str, str]) -> Part:
    uses: dict[str, Use] = {name: replace(one, part=names.get(one.part, one.part)) for name, one in part.use.items()}
    return replace(part, use=uses) if uses else part


def _free(parts: Mapping[str, Part], wish: str, part: Part) -> str:
    """Name ``wish`` of a part if it is free or that of an equal part, else with the first free number behind it."""
    name, number = wish, 1
    while name in parts and parts[name] != part:
        number += 1
        name = f"{wish}_{number}"
    return name
