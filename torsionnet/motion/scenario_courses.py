"""Scenarios of a model: what they may name, with checks of it, and their courses of torques over time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from torsionnet.base.errors import Fault, ModelError, TorsionnetError, UsageError, did_you_mean, unknown_name
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.elements import Values
from torsionnet.model.parameters import resolve
from torsionnet.model.sections import SCENARIOS
from torsionnet.model.speeds import mean_speeds
from torsionnet.motion.scenarios.scenario import DrivingCourse, Scenario, ScenarioSubject


class Defined(Protocol):
    """Interface of a model with its definition and the values of its parameters."""

    @property
    def definition(self) -> Definition:
        """Definition of the model."""

    @property
    def exact_values(self) -> Mapping[str, Any]:
        """Value in SI of every parameter, by name."""


def scenario_subject(definition: Definition, values: Mapping[str, Any]) -> ScenarioSubject:
    """Nodes, elements and channels that scenarios of a model may name, with values of its parameters.

    Mean speeds come with them as far as they are known.
    """
    try:
        speeds = mean_speeds(definition, values)
    except (TorsionnetError, ArithmeticError, KeyError):  # other checks say what is wrong
        speeds = {}
    return ScenarioSubject(
        all_nodes(definition.elements.values()), definition.elements, definition.inputs, definition.excitations,
        Values(values), speeds,
    )  # fmt: skip


def scenario_of(model: Defined, scenario: str | Scenario | Mapping[str, Any]) -> Scenario:
    """Scenario of a model by its name, or one that is given as an object or by its entries.

    Raises
    ------
    UsageError
        The model has no such scenario, or the one given names what it does not have.
    ModelError
        Entries that are wrong.
    """
    definition = model.definition
    if isinstance(scenario, str):
        known = definition.scenarios
        if scenario not in known:
            rest = f"there are {', '.join(known)}" if known else "the model has no entry scenarios:"
            raise UsageError(
                f'no scenario is named "{scenario}"{did_you_mean(scenario, known)}; {rest}', kind="unknown-name"
            )
        return known[scenario]
    if not isinstance(scenario, Scenario | Mapping):
        raise UsageError(
            f"a scenario is named, or given as an object or by its entries, got {scenario!r}", kind="wrong-form"
        )
    made: tuple[Scenario | None, list[Fault]] = SCENARIOS.of.read(scenario)
    read, wrong = made
    if read is None or wrong:
        raise ModelError(wrong, "the scenario")
    names = {name for _, _, expression, _ in read.expressions() for name in expression.names}
    unknown = [
        unknown_name("parameter", name, model.exact_values, ()) for name in sorted(names - {*model.exact_values})
    ]
    if unknown:
        raise UsageError("; ".join(fault.message for fault in unknown), kind="unknown-parameter")
    return read


def driving_course(model: Defined, scenario: Scenario) -> DrivingCourse:
    """Course over time of what a scenario does to a model in its present configuration.

    Raises
    ------
    UsageError
        This configuration lacks what the scenario needs.
    """
    subject = scenario_subject(model.definition, model.exact_values)
    faults = list(scenario.name_faults(subject))
    for name in scenario.needed:
        part = subject.elements.get(name, subject.excitations.get(name))
        if not getattr(part, "enabled", True):
            text = f"{name} is switched off here, and the scenario needs it; switch it on"
            faults.append(Fault(text, kind="switched-off"))
    if faults:
        raise UsageError("; ".join(fault.message for fault in faults), kind=faults[0].kind)
    return scenario.course(subject)


# Checks of scenarios, which must name what the model has.


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
                fault.path for fault in scenario_faults(changed, *dict.fromkeys(str(left.path[1]) for left in faults))
            }
            faults = [fault for fault in faults if fault.path in still]
    return faults


def scenario_faults(definition: Definition, *names: str) -> list[Fault]:
    """Faults of the scenarios with these names that name what the model does not have, or that lack data of it."""
    subject = scenario_subject(definition, resolve(definition.parameters)[0])
    return [
        fault.under("scenarios", name) for name in names for fault in definition.scenarios[name].name_faults(subject)
    ]
