"""Checks of entries that alternatives of a configuration change: they must exist, and their values must fit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from torsionnet.core.errors import Fault, ModelError, Path, unknown_name
from torsionnet.core.expressions import Expression
from torsionnet.model.configurations import Overlay
from torsionnet.model.definition import ELEMENTS, EXCITATIONS, LOAD, SCENARIOS, Definition, by_section, section_of
from torsionnet.model.elements import Element

if TYPE_CHECKING:
    from torsionnet.model.scenarios.scenario import Scenario

_TABLES = ((ELEMENTS,), (EXCITATIONS,), (SCENARIOS,))


def unfit_overrides(definition: Definition) -> list[Fault]:
    """Faults of alternatives whose ``box.engaged``, ``engine.misfire`` or ``load.power`` does not exist or fit."""
    return [fault for path, overlay in _alternatives(definition) for fault in _unfit(definition, overlay, path)]


def expressions_of_overrides(definition: Definition) -> Iterator[tuple[Path, Expression]]:
    """Pairs (path, expression) of the expressions that alternatives set in entries of elements and scenarios."""
    for path, overlay in _alternatives(definition):
        for (table, name), changes in by_section(definition, overlay.entries).items():
            changed = _changed(getattr(definition, table)[name], changes) if table in (ELEMENTS, SCENARIOS) else None
            for inner, _, expression, _ in changed.expressions() if changed else ():
                # Elements whose torques a scenario scales stand among its entries.
                scaled = table == SCENARIOS and inner[0] not in dict(changed.specs()) if changed else False
                entry, *rest = ("elements", *inner) if scaled else inner
                if entry in changes:
                    yield (*path, f"{name}.{entry}", *rest), expression


def at_override(fault: Fault, definition: Definition, choice: Mapping[str, str]) -> Fault:
    """Fault of an entry whose path is moved to the alternative that gives the entry its value.

    Where none does, to one that changes the section which the fault is about besides.
    """
    section = fault.path if fault.path[:1] == (LOAD,) else fault.path[1:] if fault.path[:1] in _TABLES else ()
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


def _alternatives(definition: Definition) -> Iterator[tuple[Path, Overlay]]:
    for axis, alternatives in definition.configurations.items():
        for label, overlay in alternatives.items():
            if overlay.entries:
                yield ("configurations", axis, label), overlay


def _changed(one: Element | Scenario, changes: Mapping[str, Any]) -> Element | Scenario | None:
    """Copy of an element or a scenario with the entries that an alternative changes; None where they do not fit it."""
    try:
        return replace(one, **changes) if changes.keys() <= dict(one.specs()).keys() else None
    except ModelError:
        return None


def _unfit(definition: Definition, overlay: Overlay, path: Path) -> Iterator[Fault]:
    unknown = {key: fault for key in overlay.entries if (fault := _meaningless(definition, key, (*path, key)))}
    yield from unknown.values()
    for (table, name), changes in by_section(definition, overlay.entries).items():
        keys = {entry: (*path, f"{name}.{entry}") for entry in changes}
        if not any(f"{name}.{entry}" in unknown for entry in changes):
            for fault in _wrong_values(definition, table, name, changes):
                about = next((one for one in fault.path if one in keys), next(iter(keys)))
                yield replace(fault, path=keys[str(about)])


def _meaningless(definition: Definition, key: str, path: Path) -> Fault | None:
    """Fault that an entry which an alternative changes does not exist, or None."""
    name, _, entry = key.rpartition(".")
    found = section_of(definition, key)
    if found is None:
        return _no_section(definition, name, path)
    known = dict(found[2].specs())
    return None if entry in known else unknown_name(f"entry of {name}", entry, known, path, on_key=True)


def _no_section(definition: Definition, name: str, path: Path) -> Fault:
    """Fault that an alternative cannot change entries of the section it names."""
    if name in {declared.name for declared in definition.declared()} - {LOAD}:
        text = f"a configuration does not change entries of {name}:; it may change parameters, and entries of elements"
        text += ", excitations, scenarios and load: (box.engaged, engine.misfire, fault.phases, load.power)"
        return Fault(text, path, on_key=True)
    known = [*definition.excitations, *definition.elements, *definition.scenarios, *([LOAD] if definition.load else [])]
    return unknown_name("element, excitation or scenario", name, known, path, on_key=True)


def _wrong_values(definition: Definition, table: str, name: str, changes: Mapping[str, Any]) -> tuple[Fault, ...]:
    """Faults of a section whose entries an alternative changes to wrong values."""
    try:
        changed = definition.with_overlay(
            Overlay(entries={f"{name}.{entry}": value for entry, value in changes.items()})
        )
    except ModelError as error:
        return error.faults
    if table == EXCITATIONS:
        from torsionnet.model.checks.excitation_checks import excitation_faults

        return () if any(excitation_faults(definition, name)) else tuple(excitation_faults(changed, name))
    if table == SCENARIOS:
        from torsionnet.model.checks.scenario_checks import scenario_faults

        return () if scenario_faults(definition, name) else tuple(scenario_faults(changed, name))
    if table == ELEMENTS:
        return tuple(_moved(definition.elements[name], changed.elements[name], changes))
    return ()


def _moved(before: Element, after: Element, changes: Mapping[str, Any]) -> Iterator[Fault]:
    """Faults of elements that an alternative switches by an entry or moves to other nodes, which it may not."""
    if before.enabled != after.enabled:
        text = f"write on: [{before.name}] or off: [{before.name}] to switch an element"
        yield Fault(text, ("enabled",), on_key=True)
    if before.ports != after.ports:
        text = f"a configuration does not move {before.name} to other nodes; write two elements, and switch them"
        yield Fault(f"{text} with on: and off:", (next(iter(changes)),), on_key=True)
