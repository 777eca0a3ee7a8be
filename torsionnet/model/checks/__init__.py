"""Consistency checks of a model, of which :func:`check_definition` runs all.

Checks of names and values say everything they find. The structural ones need a model whose names and values are sound,
and run on the base model and on every alternative of every axis.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from torsionnet.base.errors import Fault
from torsionnet.base.packages import gc_paused
from torsionnet.model.checks import names, values
from torsionnet.model.checks.structure import check_structure, unconnected_parts
from torsionnet.model.checks.values import unusual_sizes
from torsionnet.model.configurations import combinations, label
from torsionnet.model.definition import Definition
from torsionnet.model.parameters import resolve

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
    faults += findings + values.impossible_sizes(definition, known) + unusual_sizes(definition, known)
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
    faults += unusual_sizes(definition, known)
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
