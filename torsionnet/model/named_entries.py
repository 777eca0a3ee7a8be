"""Parameters made from values of elements, as ``dmf.stiffness``, so that these can vary."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, cast

from torsionnet.core.entries.scalars import QuantityKind
from torsionnet.core.entries.spec import not_none
from torsionnet.core.expressions import Expression, Name
from torsionnet.model.configurations import Axes, Overlay
from torsionnet.model.definition import ELEMENTS, Definition, section_of
from torsionnet.model.parameters import Parameter


def value_of_entry(definition: Definition, name: str) -> Expression | None:
    """Expression of an element's entry, as that of ``dmf.stiffness``.

    None if no element has such a physical quantity.
    """
    element, _, entry = name.rpartition(".")
    if element not in definition.elements:
        return None
    spec, value = definition.elements[element].scalars().get(entry, (None, None))
    return value if isinstance(spec, QuantityKind) and isinstance(value, Expression) else None


def can_be_named(definition: Definition, name: str) -> bool:
    """Whether an entry as ``dmf.stiffness`` is a plain value, and its name is not that of a parameter."""
    value = value_of_entry(definition, name)
    return name not in definition.parameters and value is not None and not value.names


def with_named_entries(definition: Definition, names: Iterable[str]) -> Definition:
    """Definition of a model with a parameter for each of the entries ``names``, as ``dmf.stiffness``.

    An alternative that gives the entry another value gives it to the parameter.
    """
    parameters, elements = dict(definition.parameters), dict(definition.elements)
    named = dict.fromkeys(names)
    for name in named:
        element, _, entry = name.rpartition(".")
        text = f"{entry.replace('_', ' ')} of {element}"
        parameters[name] = Parameter(value=not_none(value_of_entry(definition, name)), description=text)
        entries: dict[str, Any] = {entry: Name(name)}
        elements[element] = replace(elements[element], **entries)
    axes = _with_parameters(definition, named)
    return replace(definition, parameters=parameters, elements=elements, configurations=axes)


def _with_parameters(definition: Definition, named: Mapping[str, None]) -> Axes:
    return {
        axis: {label: _moved(definition, overlay, named) for label, overlay in alternatives.items()}
        for axis, alternatives in definition.configurations.items()
    }


def _moved(definition: Definition, overlay: Overlay, named: Mapping[str, None]) -> Overlay:
    """Changes of an alternative in which those of named entries are changes of parameters."""
    entries = dict(overlay.entries)
    parameters = dict(overlay.parameters)
    for name in named:
        section = section_of(definition, name) if name in entries else None
        if section is not None and section[0] == ELEMENTS:
            key = name.rpartition(".")[2]
            parameters[name] = cast("Expression", dict(section[2].specs())[key].coerce(entries.pop(name)))
    return replace(overlay, parameters=parameters, entries=entries)
