"""Balance of the mean powers of a drivetrain at one speed."""

from __future__ import annotations

from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.machinery.mean.power_balance import PowerBalance
from torsionnet.machinery.mean.static_solution import static_state


def power_balance(drivetrain: AssembledModel, speed: float | None = None) -> PowerBalance:
    """Powers that drivers give and absorbers take at one speed, with the mean torques between them.

    Parameters
    ----------
    speed : float, optional
        rad/s, of the node of the model's ``speeds:``; default: as for :meth:`static_state`.

    Raises
    ------
    UsageError
        As for :meth:`mean_response`.

    Examples
    --------
    >>> import torsionnet as tn
    >>> found = tn.load("bulk_carrier").power_balance()
    >>> round(found.given / 1e3, 6), round(found.taken / 1e3, 6), round(found.torque / 1e3, 2)  # kW, kN*m
    (7000.0, 7000.0, 636.62)
    """
    state = static_state(drivetrain, speed)
    ratios = drivetrain.external_torques.ratios
    powers = {node: torque * ratios.get(node, 0.0) * state.speed for node, torque in state.external.items()}
    return PowerBalance(state, powers)
