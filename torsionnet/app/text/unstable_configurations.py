"""Warnings about modes that grow in any configuration of a model, apart from what mends faults of its text."""

from __future__ import annotations

from dataclasses import replace

from torsionnet.base.errors import Fault
from torsionnet.model.checks import variants
from torsionnet.model.definition import Definition


def unstable_configurations(definition: Definition) -> list[Fault]:
    """Warnings about modes of a model that grow, in all its configurations.

    None, and nothing numerical is loaded, if no element can feed energy into a vibration.
    """
    found: list[Fault] = []
    for name, variant in (("", definition), *variants(definition)):
        if not any(element.may_feed for element in variant.active):
            continue
        from torsionnet.linear.assembly.assembled import AssembledModel
        from torsionnet.linear.modes.stability import unstable_modes

        known = {(fault.message, fault.path) for fault in found}
        faults = unstable_modes(AssembledModel.from_definition(variant))
        found += [replace(one, configuration=name) for one in faults if (one.message, one.path) not in known]
    return found
