"""Checks of the mean speeds and torques about which a model is linear, and of what depends on them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from torsionnet.core.errors import Fault, ModelError
from torsionnet.model.checks.balance import unbalanced_torques
from torsionnet.model.checks.curves_in_use import beyond_curves
from torsionnet.model.checks.load_fits import unfit_load
from torsionnet.model.definition import Definition
from torsionnet.model.kinematics import Kinematics
from torsionnet.model.load.external_torques import ExternalTorques
from torsionnet.model.operating_values import unfit_parameters


def unfit_operation(
    definition: Definition, values: Mapping[str, Any], kinematics: Kinematics, *, sound: bool
) -> list[Fault]:
    """All of them in one configuration; of a structure that is not ``sound`` only what does not follow from that."""
    external = ExternalTorques(definition, values)
    faults = _inconsistent_speeds(external)
    if faults or not sound:
        return faults if definition.load else faults + unbalanced_torques(external, kinematics)
    misfits = unfit_load(external) or unfit_parameters(external) or beyond_curves(external)
    return misfits or unbalanced_torques(external, kinematics)


def _inconsistent_speeds(external: ExternalTorques) -> list[Fault]:
    """Mean speeds that the gear ratios do not allow together."""
    try:
        _ = external.mean_speeds
    except ModelError as error:
        return list(error.faults)
    return []
