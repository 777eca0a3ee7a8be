"""Checks of the mean speeds and torques about which a model is linear, and of what depends on them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from torsionnet.core.errors import Fault, ModelError
from torsionnet.model.checks.balance import unbalanced_torques
from torsionnet.model.checks.curves_in_use import beyond_curves
from torsionnet.model.checks.load_fits import unfit_load
from torsionnet.model.checks.unlike_directions import unlike_directions
from torsionnet.model.checks.working_speeds import unlike_working_speeds
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
    if misfits:
        return misfits
    return [
        *unbalanced_torques(external, kinematics),
        *unlike_directions(external),
        *unlike_working_speeds(external),
        *_unlike_at_rated_speed(external),
    ]


def _unlike_at_rated_speed(external: ExternalTorques) -> list[Fault]:
    """Warnings about powers and speeds; what compares them loads numpy, which a model without speeds does not need."""
    if not external.rated_speed:
        return []
    from torsionnet.model.checks.propeller_conditions import archer_at_small_torque
    from torsionnet.model.checks.unlike_ratings import unlike_ratings

    return [*unlike_ratings(external), *archer_at_small_torque(external)]


def _inconsistent_speeds(external: ExternalTorques) -> list[Fault]:
    """Mean speeds that the gear ratios do not allow together."""
    try:
        _ = external.mean_speeds
    except ModelError as error:
        return list(error.faults)
    return []
