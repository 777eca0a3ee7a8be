"""Checks of a study's quantities and limits against its model in every configuration."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from torsionnet.base.errors import Fault, did_you_mean
from torsionnet.drivetrain import Drivetrain
from torsionnet.study.quantities.quantity import StudyQuantity
from torsionnet.study.quantities.quantity_limit import QuantityLimit, wrong_unit

RESERVED = {name: f"what labels of results call the {name}" for name in ("configuration", "variant", "percentile")}


def name_conflicts(quantities: Iterable[Any], parameters: Iterable[Any]) -> list[Fault]:
    """Faults of quantities that are named like another column in the table of variants."""
    meanings = dict.fromkeys(parameters, "a parameter that varies") | RESERVED
    return [
        Fault(f'"{name}" is {meanings[name]}; give the quantity another name', ("quantities", name), on_key=True)
        for name in quantities
        if name in meanings
    ]


def unknown_limits(limits: Iterable[Any], quantities: Iterable[Any]) -> list[Fault]:
    """Faults of limits on quantities that the study does not have."""
    known = [str(name) for name in quantities]
    return [
        Fault(
            f'no quantity is named "{name}"{did_you_mean(str(name), known)}; known: {", ".join(known)}',
            ("limits", name),
            on_key=True,
        )
        for name in limits
        if str(name) not in known
    ]


def quantity_model_faults(
    model: Drivetrain, configurations: Sequence[str], quantities: Mapping[str, StudyQuantity]
) -> list[Fault]:
    """Faults of quantities that cannot be calculated in a configuration."""
    found: dict[tuple[object, str], list[tuple[str, Fault]]] = {}
    for configuration in configurations:
        here = model.configured(configuration) if configuration else model
        for name, quantity in quantities.items():
            for fault in quantity.model_faults(here, quantities):
                placed = fault.under("quantities", name)
                found.setdefault((placed.path, placed.message), []).append((configuration, placed))
    return [_said(same, len(configurations)) for same in found.values()]


def wrong_units(
    model: Drivetrain,
    configurations: Sequence[str],
    quantities: Mapping[str, StudyQuantity],
    limits: Mapping[str, QuantityLimit],
) -> list[Fault]:
    """Faults of limits whose unit has not the dimension of their quantity."""
    here = model.configured(configurations[0]) if configurations and configurations[0] else model
    faults: list[Fault] = []
    for name, limit in limits.items():
        unit = quantities[name].measured(here, quantities).unit
        for key in ("below", "above"):
            faults += wrong_unit(getattr(limit, key), name, unit, ("limits", name, key))
    return faults


def _said(same: Sequence[tuple[str, Fault]], count: int) -> Fault:
    """Merge equal faults of several configurations into one that names them if some configuration lacks it."""
    names, fault = [name for name, _ in same if name], same[0][1]
    return fault if len(same) == count or not names else replace(fault, configuration=", ".join(names))
