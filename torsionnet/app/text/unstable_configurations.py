"""Warnings about modes that grow in any configuration of a model, apart from what mends faults of its text."""

from __future__ import annotations

from dataclasses import replace

from torsionnet.base.errors import Fault
from torsionnet.model.defining import variants
from torsionnet.model.definition import Definition


def unstable_configurations(definition: Definition) -> list[Fault]:
    """Warnings about modes of a model that grow, in all its configurations.

    None, and nothing numerical is loaded, if no element can feed energy into a vibration.
    """
    warnings: list[Fault] = []
    for name, variant in (("", definition), *variants(definition)):
        if not any(element.may_feed for element in variant.active):
            continue
        from torsionnet.linear.assembly.assembled import AssembledModel
        from torsionnet.linear.modes.unstable_modes import unstable_modes

        # What the model as written has already is told once, without a configuration.
        known = {(fault.message, fault.path) for fault in warnings}
        faults = unstable_modes(AssembledModel.from_definition(variant))
        warnings += [replace(fault, configuration=name) for fault in faults if (fault.message, fault.path) not in known]
    return warnings
