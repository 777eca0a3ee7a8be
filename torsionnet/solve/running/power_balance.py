"""Balance of the mean powers of a drivetrain at one speed."""

from __future__ import annotations

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.response.power_balance import PowerBalance
from torsionnet.solve.running.static_state import static_state


def power_balance(drivetrain: AssembledModel, speed: float | None = None) -> PowerBalance:
    """Balance of the mean powers in W given and absorbed in a drivetrain at one speed in rad/s.

    See :meth:`torsionnet.Drivetrain.power_balance`.
    """
    state = static_state(drivetrain, speed)
    ratios = drivetrain.external_torques.ratios
    powers = {node: torque * ratios.get(node, 0.0) * state.speed for node, torque in state.external.items()}
    return PowerBalance(state, powers)
