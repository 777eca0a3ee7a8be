"""Check of propeller damping by Archer's formula, which holds at full ahead, in conditions of small torque."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import Fault, UsageError
from torsionnet.machinery.excitations.propeller_torque import PropellerTorque
from torsionnet.model.definition import LOAD
from torsionnet.model.elements.propeller import Propeller
from torsionnet.model.load.external_torques import ExternalTorques
from torsionnet.model.operating_values import OperatingPoints, with_operating_values
from torsionnet.model.parameters import resolve

SMALL_TORQUE_SHARE, SLIP_TORQUE_SHARE = 0.5, 0.01
"""Shares of the full-ahead torque below which Archer's formula does not apply, or a unit was slipped. Other checks warn
about the slip."""


def archer_at_small_torque(external: ExternalTorques) -> Iterator[Fault]:
    """Warnings about damping by Archer from a torque far below that of full ahead, at rated speed."""
    rated = external.rated_speed
    ahead = [one for one in external.definition.excitations.values() if isinstance(one, PropellerTorque)]
    screws = [one for one in external.definition.active if isinstance(one, Propeller) and one.archer is not None]
    if not rated or not ahead or not screws:
        return
    values = _values(external, rated)
    for screw in screws:
        torque = not_none(screw.torque)
        full = next((one for one in ahead if one.node == screw.node and torque.names <= values.keys()), None)
        ratio = abs(external.ratios.get(str(screw.node), 0.0))
        if full is None or not ratio:
            continue
        taken, whole = float(torque.evaluate(values)), full.torque * (ratio * rated / full.rated) ** full.exponent
        if SLIP_TORQUE_SHARE * whole < taken < SMALL_TORQUE_SHARE * whole:
            text = f"Archer's damping with {taken / 1e3:.4g} kN*m, {taken / whole:.0%} of the torque of full ahead"
            text += " at that speed; the formula is for a propeller that works at its pitch:"
            yield Fault(
                f"{text} give damping for this condition", ("elements", screw.name, "archer"), "warning", about=LOAD
            )


def _values(external: ExternalTorques, speed: float) -> Mapping[str, Any]:
    """Value in SI units of every parameter, by name, at a speed of the reference shaft in rad/s.

    Empty where the load determines no torque there.
    """
    if not external.definition.following:
        return external.values
    try:
        found = OperatingPoints(external).at(speed)
    except UsageError:
        return {}
    return resolve(with_operating_values(external.definition, found).parameters)[0]
