"""Model definitions from the plain content of model files, or from the arguments of a call."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from dataclasses import replace
from typing import Any

from torsionnet.base.entries.declared import names_a_file
from torsionnet.base.errors import Fault, got
from torsionnet.model.configurations import VALUE, Overlay
from torsionnet.model.definition import Definition, section_of
from torsionnet.model.elements import Element


def collect_elements(elements: Iterable[Element]) -> tuple[dict[str, Element], list[Fault]]:
    """Elements by name, and the faults of names that are used twice."""
    table: dict[str, Element] = {}
    faults: list[Fault] = []
    if isinstance(elements, Mapping):
        elements = elements.values()
    if not isinstance(elements, Iterable) or isinstance(elements, str):
        return {}, [Fault(f"expected a list of elements, {got(elements)}", ("elements",), kind="wrong-form")]
    for element in elements:
        if not isinstance(element, Element):
            faults.append(
                Fault(f"expected an element such as Inertia(...), {got(element)}", ("elements",), kind="wrong-form")
            )
            continue
        if element.name in table:
            faults.append(
                Fault(
                    f'two elements are named "{element.name}"; names must be unique',
                    ("elements", element.name),
                    kind="repeated-name",
                )
            )
        table[element.name] = element
    if not table and not faults:
        faults.append(Fault("a drivetrain needs at least one element", ("elements",), kind="missing-entry"))
    return table, faults


def define(entries: Mapping[str, Any]) -> tuple[Definition, list[Fault]]:
    """Definition of a model from the entries that can be read, and the faults of the others."""
    values, faults = Definition.read_entries(entries)
    authored = Definition(**{name: value for name, value in values.items() if value is not None})
    if authored.include:
        faults.append(Fault("files are included by model files only", ("include",), on_key=True, kind="needless-entry"))
    lost = {key for fault in faults for key in fault.path[:1]} & {"parts", "use"}
    flat, of_parts = flatten_definition(authored, whole=not lost)
    return flat, [*faults, *of_parts]


def flatten_definition(authored: Definition, *, whole: bool = True) -> tuple[Definition, list[Fault]]:
    """Definition of a model with all parts put in, linked to the definition as written, and its faults.

    Without ``whole`` some part or use could not be read; names that parts lack are then no faults of their own.
    """
    authored = _with_settled_alternatives(authored) if authored.configurations else authored
    if authored.is_flat:
        return authored, []
    from torsionnet.model.parts.authored_model import AuthoredModel
    from torsionnet.model.parts.flattening import flatten_parts

    flat, faults = flatten_parts(authored, whole=whole)
    flat = _with_settled_alternatives(flat)
    return replace(flat, authored=AuthoredModel(authored, flat)), faults


def _with_settled_alternatives(definition: Definition) -> Definition:
    """Definition in which ``left.k`` of an alternative is the parameter of that name, or else an entry of ``left``.

    Entries of excitations hold the content of the files that they name.
    """
    known, axes = definition.parameters, dict[str, Mapping[str, Overlay]]()
    for axis, written in definition.configurations.items():
        settled = written
        if any(key in known for overlay in written.values() for key in overlay.entries):
            settled = {label: replace(overlay, **_split_changes(overlay, known)) for label, overlay in written.items()}
        if any(names_a_file(value) for overlay in settled.values() for value in overlay.entries.values()):
            settled = {
                label: replace(
                    overlay,
                    entries=_with_file_contents(definition, overlay.entries),
                    by_files=_by_files(overlay.entries),
                )
                for label, overlay in settled.items()
            }
        if settled is not written:
            axes[axis] = settled
    return replace(definition, configurations={**definition.configurations, **axes}) if axes else definition


def _split_changes(overlay: Overlay, known: Container[str]) -> dict[str, Any]:
    """Parameters and entries of an alternative's changes, with parameters moved out of the entries.

    Unreadable values stay for the checks.
    """
    parameters, entries = dict(overlay.parameters), {}
    for key, raw in overlay.entries.items():
        value, faults = VALUE.read(raw) if key in known else (None, [])
        if value is not None and not faults:
            parameters[key] = value
        else:
            entries[key] = raw
    return {"parameters": parameters, "entries": entries}


def _by_files(changes: Mapping[str, Any]) -> dict[str, Any]:
    """Changed entries that name a file, as they are written."""
    return {key: value for key, value in changes.items() if names_a_file(value)}


def _with_file_contents(definition: Definition, changes: Mapping[str, Any]) -> dict[str, Any]:
    """Changed entries of excitations by name, with the content of the files that they name.

    Unreadable values stay for the checks.
    """
    changed = dict(changes)
    for key, raw in changes.items():
        section, field = section_of(definition, key), key.rpartition(".")[2]
        specs = dict(section[2].specs()) if section else {}
        value, faults = specs[field].read(raw) if field in specs and names_a_file(raw) else (None, [])
        if value is not None and not faults:
            changed[key] = specs[field].plain(value)
    return changed
