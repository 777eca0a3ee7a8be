"""Checks of limits: do they name what there is, and has it what their rule needs."""

from __future__ import annotations

from torsionnet.core.errors import Fault, unknown_name
from torsionnet.model.definition import Definition, all_nodes


def unfit_limits(definition: Definition) -> list[Fault]:
    """Limits on what does not exist, and what the rules of the others miss."""
    known = {"element": definition.elements, "node": all_nodes(definition.elements.values())}
    faults: list[Fault] = []
    for name, limit in definition.limits.items():
        unknown = [
            unknown_name(kind, what, known[kind], path) for path, kind, what in limit.named if what not in known[kind]
        ]
        faults += [fault.under("limits", name) for fault in unknown or limit.unfit(definition)]
    return faults
