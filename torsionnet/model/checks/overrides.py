"""Checks of entries that alternatives of a configuration change: they must exist, and their values must fit.

Models whose alternatives only change parameters and switch elements need none of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from torsionnet.base.errors import EntryPath, Fault, ModelError, unknown_name
from torsionnet.base.expressions import Expression
from torsionnet.base.packages import imported
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.model.configurations import Overlay
from torsionnet.model.definition import (
    ELEMENTS,
    EXCITATIONS,
    SCENARIOS,
    SINGLE_SECTIONS,
    SPEEDS,
    Definition,
    by_section,
    section_of,
)
from torsionnet.model.elements import Element
from torsionnet.model.sections import OWNERS

if TYPE_CHECKING:
    from torsionnet.motion.scenarios.scenario import Scenario

_TABLES = ((ELEMENTS,), (EXCITATIONS,), (SCENARIOS,))


def unfit_overrides(definition: Definition) -> list[Fault]:
    """Faults of alternatives whose ``box.engaged``, ``engine.misfire`` or ``load.power`` does not exist or fit."""
    return [fault for path, overlay in _alternatives(definition) for fault in _unfit(definition, overlay, path)]


def at_override(fault: Fault, definition: Definition, choice: Mapping[str, str]) -> Fault:
    """Fault of an entry whose path is moved to the alternative that gives the entry its value.

    Where none does, to one that changes the section which the fault is about besides.
    """
    section = (
        fault.path
        if fault.path[:1] and fault.path[0] in SINGLE_SECTIONS
        else fault.path[1:]
        if fault.path[:1] in _TABLES
        else ()
    )
    if len(section) < 2:
        return fault
    key = f"{section[0]}.{section[1]}"
    besides = None
    for axis, label in choice.items():
        for name in definition.configurations[axis][label].entries:
            if name == key:
                return replace(fault, path=("configurations", axis, label, key, *section[2:]))
            if fault.about and name.startswith(f"{fault.about}."):
                besides = replace(fault, path=("configurations", axis, label, name))
    return besides or fault


def _alternatives(definition: Definition) -> Iterator[tuple[EntryPath, Overlay]]:
    for axis, alternatives in definition.configurations.items():
        for label, overlay in alternatives.items():
            if overlay.entries:
                yield ("configurations", axis, label), overlay


def changed_expressions(definition: Definition) -> Iterator[tuple[EntryPath, Expression]]:
    """Path and expression of everything that alternatives give to entries of elements and scenarios."""
    for place, overlay in _alternatives(definition):
        for (table, name), changes in by_section(definition, overlay.entries).items():
            changed = _changed(getattr(definition, table)[name], changes) if table in (ELEMENTS, SCENARIOS) else None
            for inner, _, expression, _ in changed.expressions() if changed else ():
                # Elements whose torques a scenario scales stand among its entries.
                scaled = table == SCENARIOS and inner[0] not in dict(changed.specs()) if changed else False
                entry, *rest = ("elements", *inner) if scaled else inner
                # In the file the entry of an element or scenario stands behind its name: "shaft.stiffness".
                if entry in changes:
                    yield (*place, f"{name}.{entry}", *rest), expression


def _changed(section: Element | Scenario, changes: Mapping[str, Any]) -> Element | Scenario | None:
    """Copy of an element or a scenario with the entries that an alternative changes; None where they do not fit it."""
    try:
        return replace(section, **changes) if changes.keys() <= dict(section.specs()).keys() else None
    except ModelError:
        return None


def _unfit(definition: Definition, overlay: Overlay, path: EntryPath) -> Iterator[Fault]:
    unknown = {key: fault for key in overlay.entries if (fault := _meaningless(definition, key, (*path, key)))}
    yield from unknown.values()
    for (table, name), changes in by_section(definition, overlay.entries).items():
        # An alternative names an entry by what it belongs to, as in "shaft.stiffness".
        keys = {entry: (*path, f"{name}.{entry}") for entry in changes}
        if not any(f"{name}.{entry}" in unknown for entry in changes):
            for fault in _wrong_values(definition, table, name, changes):
                about = next((part for part in fault.path if part in keys), next(iter(keys)))
                yield replace(fault, path=keys[str(about)])


def _meaningless(definition: Definition, key: str, path: EntryPath) -> Fault | None:
    """Fault that an entry which an alternative changes does not exist, or None."""
    name, _, entry = key.rpartition(".")
    section = section_of(definition, key)
    if section is None:
        return _no_section(definition, name, path)
    known = dict(section[2].specs())
    return None if entry in known else unknown_name(f"entry of {name}", entry, known, path, on_key=True)


def _no_section(definition: Definition, name: str, path: EntryPath) -> Fault:
    """Fault that an alternative cannot change entries of the section it names."""
    if name in {declared.name for declared in definition.declared()} - {*SINGLE_SECTIONS}:
        text = (
            f"a configuration does not change entries of {name}:; it may change parameters, and entries of elements, "
        )
        text += "excitations, scenarios, load: and speeds: (box.engaged, engine.misfire, fault.phases, load.power, "
        return Fault(text + "speeds.range)", path, on_key=True, kind="fixed-entry")
    owner, _, entry = name.partition(".")
    outer = section_of(definition, name) if entry else None
    if outer is not None:
        known_entries = dict(outer[2].specs())
        if entry not in known_entries:
            return unknown_name(f"entry of {owner}", entry, known_entries, path, on_key=True)
        whole = f"write {owner}.{entry}: {{...}} with all its entries"
        return Fault(
            f"a configuration changes {entry} of {owner} as a whole; {whole}", path, on_key=True, kind="fixed-entry"
        )
    if name in definition.limits:
        return Fault(
            f"{name} is a limit; limits are the same in all configurations", path, on_key=True, kind="fixed-entry"
        )
    sections = [key for key in SINGLE_SECTIONS if getattr(definition, key)]
    known = [*definition.excitations, *definition.elements, *definition.scenarios, *sections]
    return unknown_name("element, excitation or scenario", name, known, path, on_key=True)


def _wrong_values(definition: Definition, table: str, name: str, changes: Mapping[str, Any]) -> tuple[Fault, ...]:
    """Faults of a section whose entries an alternative changes to wrong values."""
    try:
        changed = definition.with_overlay(
            Overlay(entries={f"{name}.{entry}": value for entry, value in changes.items()})
        )
    except ModelError as error:
        return error.faults
    if table == ELEMENTS:
        return tuple(_moved(definition.elements[name], changed.elements[name], changes))
    if table == SPEEDS:
        # An engine may have no gas at other speeds; what was wrong before the change is told where it stands.
        before, after = map(imported(OWNERS[EXCITATIONS].faults), (definition, changed))
        return tuple(fault for fault in after if fault.severity == "error" and fault not in before)
    if table in SINGLE_SECTIONS:
        return ()
    # What was wrong before the change is told where it stands.
    faults_of_one = imported(OWNERS[table].faults_of_one)
    return () if any(faults_of_one(definition, name)) else tuple(faults_of_one(changed, name))


def _moved(before: Element, after: Element, changes: Mapping[str, Any]) -> Iterator[Fault]:
    """Faults of elements that an alternative switches by an entry or moves to other nodes, which it may not."""
    if before.enabled != after.enabled:
        text = phrase("write on: [{0}] or off: [{0}] to switch an element", ModelName(before.name))
        yield Fault(text, ("enabled",), on_key=True, kind="fixed-entry")
    if before.ports != after.ports:
        text = phrase(
            "a configuration does not move {} to other nodes; write two elements, and switch them with on: and off:",
            ModelName(before.name),
        )
        yield Fault(text, (next(iter(changes)),), on_key=True, kind="fixed-entry")
