"""Checks of scenarios, which must name what the model has."""

from __future__ import annotations

from torsionnet.core.errors import Fault
from torsionnet.model.definition import Definition
from torsionnet.model.parameters import resolve
from torsionnet.model.scenario_courses import scenario_subject


def unfit_scenarios(definition: Definition) -> list[Fault]:
    """Faults of scenarios that name what the model does not have, or that lack data of it."""
    subject = scenario_subject(definition, resolve(definition.parameters)[0])
    return [
        fault.under("scenarios", name)
        for name, scenario in definition.scenarios.items()
        for fault in scenario.name_faults(subject)
    ]
