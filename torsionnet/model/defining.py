"""Model definitions made of the content of model files, or of the arguments of a call, and checked.

Checks of names and values say everything they find. The structural ones need a model whose names and values are sound,
and run on the base model and on every alternative of every axis.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from torsionnet.base.entries.declared import names_a_file
from torsionnet.base.errors import Fault, got
from torsionnet.base.packages import gc_paused
from torsionnet.model.checks import names, values
from torsionnet.model.checks.structure import check_structure, unconnected_parts
from torsionnet.model.configurations import VALUE, Overlay, combinations, label
from torsionnet.model.definition import Definition, section_of
from torsionnet.model.elements import Element
from torsionnet.model.parameters import resolve


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
    read, faults = Definition.read_entries(entries)
    authored = Definition(**{name: value for name, value in read.items() if value is not None})
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


MOST_COMBINATIONS = 64
"""Largest number of configurations that are all checked, as the time grows with the product of the alternatives; with
more, each alternative is checked alone."""


_USELESS = ("no-effect", "indeterminate-torque")
"""Kinds of faults of an entry that cannot be used in this configuration, while another may allow it."""


@gc_paused()
def check_definition(definition: Definition) -> list[Fault]:
    """Faults, warnings and notes of a model with all its configurations."""
    checks = (check for check, of in names.CHECKS.items() if not of or getattr(definition, of))
    faults = [fault for check in checks for fault in check(definition)]
    faults += values.wrong_dimensions(definition) + values.parameter_dimensions(definition)
    faults += values.passive_tables(definition)
    faults += unconnected_parts(definition)
    known, findings = resolve(definition.parameters)
    faults += findings + values.impossible_sizes(definition, known) + values.unusual_sizes(definition, known)
    if has_errors(faults):
        return list(dict.fromkeys(faults))
    base, axes = check_structure(definition, known), definition.configurations
    chosen = choices(definition) if axes else []
    others = {label(choice, axes): _of_choice(definition, choice) for choice in chosen}
    # An entry of the base model that no configuration can use either is an error.
    useless = {fault.path for fault in base if fault.kind in _USELESS}
    for findings in others.values():
        useless &= {fault.path for fault in findings if fault.kind in _USELESS}
    faults += [replace(fault, severity="error") if fault.path in useless else fault for fault in base]
    for name, findings in others.items():
        faults += _in_configuration(name, findings, faults)
    return list(dict.fromkeys(faults))


def check_variant(definition: Definition) -> list[Fault]:
    """Faults of a model's definition that depend on the values of its parameters.

    For a configuration or changed parameters of a sound model.
    """
    known, faults = resolve(definition.parameters)
    faults += values.wrong_dimensions(definition) + values.impossible_sizes(definition, known)
    faults += values.unusual_sizes(definition, known)
    return faults if has_errors(faults) else faults + check_structure(definition, known)


def choices(definition: Definition) -> list[dict[str, str]]:
    """Choices of alternatives, by axis, that are checked.

    All of them where they are few, else each alternative alone.
    """
    count = 1
    for alternatives in definition.configurations.values():
        count *= max(1, len(alternatives))
    if count <= MOST_COMBINATIONS:
        return [choice for choice in combinations(definition.configurations) if choice]
    return [{axis: name} for axis, alternatives in definition.configurations.items() for name in alternatives]


def variants(definition: Definition) -> Iterator[tuple[str, Definition]]:
    """Pairs of configuration name and definition, one for each of the :func:`choices`."""
    axes = definition.configurations
    return ((label(choice, axes), _chosen(definition, choice)) for choice in choices(definition))


def _chosen(definition: Definition, choice: Mapping[str, str]) -> Definition:
    for axis, name in choice.items():
        definition = definition.with_overlay(definition.configurations[axis][name])
    return definition


def _of_choice(definition: Definition, choice: Mapping[str, str]) -> list[Fault]:
    faults = check_variant(_chosen(definition, choice))
    if not faults or not definition.has_overrides:
        return faults
    from torsionnet.model.checks.overrides import at_override

    return [at_override(fault, definition, choice) for fault in faults]


def has_errors(faults: list[Fault]) -> bool:
    """Whether any of the faults is an error, not only a warning or note."""
    return any(fault.severity == "error" for fault in faults)


def _in_configuration(name: str, findings: list[Fault], base: list[Fault]) -> list[Fault]:
    """Findings on a configuration that the base model does not have, with the configuration's name."""
    known = {(fault.path, fault.message) for fault in base}
    return [
        replace(fault, configuration=name)
        for fault in findings
        if (fault.severity == "error" or fault.path) and (fault.path, fault.message) not in known
    ]
