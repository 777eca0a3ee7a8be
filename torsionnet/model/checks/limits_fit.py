"""Checks of limits: do they name what there is, and has it what their rule needs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from torsionnet.core.errors import Fault, ModelError, unknown_name
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.model.limits.limit import Limit
from torsionnet.model.limits.subject import LimitSubject
from torsionnet.model.limits.unlike_kin import unlike_kin
from torsionnet.model.parameters import resolve


def unfit_limits(definition: Definition) -> list[Fault]:
    """Limits on what does not exist, and what the rules of the others miss."""
    values, wrong = resolve(definition.parameters)
    subject = limit_subject(definition, values)
    known = {"element": subject.elements, "node": subject.nodes}
    faults: list[Fault] = []
    for name, limit in definition.limits.items():
        found = [
            unknown_name(kind, what, known[kind], path) for path, kind, what in limit.named if what not in known[kind]
        ]
        if not found and not wrong:
            found = [*_unfit(limit, subject), *unlike_kin(limit)]
        faults += [fault.under("limits", name) for fault in found]
    return faults


def _unfit(limit: Limit, subject: LimitSubject) -> Iterator[Fault]:
    """What a limit lacks, with what the catalogue of its element adds."""
    try:
        yield from limit.fitted(subject.elements).unfit(subject)
    except ModelError as error:
        yield Fault(f"what the catalogue says of {limit.of} does not fit this limit", on_key=True)
        yield from error.faults


def limit_subject(definition: Definition, values: Mapping[str, Any]) -> LimitSubject:
    """What limits may know of a model."""
    engines = [one for one in definition.excitations.values() if isinstance(one, ReciprocatingEngine)]
    speeds = definition.speeds
    return LimitSubject(
        elements=definition.elements,
        active={element.name: element for element in definition.active},
        nodes=all_nodes(definition.elements.values()),
        active_nodes=all_nodes(definition.active),
        sensors=definition.sensors,
        speeds=() if speeds is None else speeds.values,
        rated=None if speeds is None else speeds.rated,
        misfiring=any(bool(engine.misfire) or bool(engine.gas_off) for engine in engines),
        values=values,
    )
