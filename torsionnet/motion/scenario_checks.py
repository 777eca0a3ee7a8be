"""Checks of scenarios, which must name what the model has."""

from __future__ import annotations

from torsionnet.base.errors import Fault, ModelError
from torsionnet.model.definition import SCENARIOS, Definition
from torsionnet.model.parameters import resolve
from torsionnet.motion.scenario_courses import scenario_subject


def unfit_scenarios(definition: Definition) -> list[Fault]:
    """Faults of scenarios that name what the model does not have, or lack data of it, in every configuration."""
    faults = scenario_faults(definition, *definition.scenarios)
    for alternatives in definition.configurations.values():
        for overlay in alternatives.values() if faults else ():
            try:
                changed = definition.with_overlay(overlay)
            except (ModelError, KeyError):  # other checks say what is wrong with it
                continue
            still = {
                fault.path for fault in scenario_faults(changed, *dict.fromkeys(str(one.path[1]) for one in faults))
            }
            faults = [fault for fault in faults if fault.path in still]
    return faults


def scenario_faults(definition: Definition, *names: str) -> list[Fault]:
    """Faults of the scenarios with these names that name what the model does not have, or that lack data of it."""
    subject = scenario_subject(definition, resolve(definition.parameters)[0])
    return [fault.under(SCENARIOS, name) for name in names for fault in definition.scenarios[name].name_faults(subject)]
