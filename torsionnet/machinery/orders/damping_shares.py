"""Shares of the elements in the damping of a mode at its critical speed."""

from __future__ import annotations

import math

import numpy as np

from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.modes.modes import OSCILLATORY
from torsionnet.linear.modes.natural_modes import modes
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed
from torsionnet.machinery.orders.operating_groups import drivetrains_at_speeds

SMALLEST_SHARE = 1e-9
"""Share of the damping of a mode below which an element has none but rounding."""


def damping_shares(
    drivetrain: AssembledModel, critical: CriticalSpeed, reference: str | None = None
) -> dict[str, float]:
    """Share of every element in the damping of a mode at its critical speed, without unit, by element, largest first.

    The share of an element is its part of the power that the damped mode dissipates, with parameters that follow the
    operating point at their values for the critical speed. Elements that feed energy in have a negative share.

    Parameters
    ----------
    drivetrain : Drivetrain
        The drivetrain that the critical speed was calculated for.
    critical : CriticalSpeed
    reference : str, optional
        Node to which the critical speed belongs; default: that of the model's ``speeds:``, else the first node.

    Returns
    -------
    dict
        Empty for a mode without damping and one that exists without damping only.

    References
    ----------
    E. J. Nestorides, A Handbook on Torsional Vibration, 1958: the damping of a mode as the sum of the energies that
    its parts dissipate per cycle.

    Examples
    --------
    >>> import torsionnet as tn
    >>> fan = tn.Drivetrain("fan",
    ...     [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...      tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4, damping=3),
    ...      tn.Damper("air", nodes=("b", "ground"), damping=0.75)],
    ...     speeds={"of": "a", "list": ["500 rpm", "700 rpm"]},
    ...     excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}})
    >>> {name: round(share, 3) for name, share in damping_shares(fan, fan.critical_speeds().of(1, 2)).items()}
    {'shaft': 0.9, 'air': 0.1}
    """
    mode = critical.mode
    if math.isnan(mode.natural_frequency):
        return {}
    given = drivetrain.definition.speeds
    node = reference or (given.of if given else None) or drivetrain.nodes[0]
    speed = critical.speed("natural")
    rig = drivetrain
    if math.isfinite(speed):
        ((rig, _),) = drivetrains_at_speeds(drivetrain, node, np.array([speed]))
    found = modes(rig)
    vibrating = [index for index, kind in enumerate(found.kinds) if kind == OSCILLATORY]
    # Modes may change their order over speed: the frequency at the critical speed tells which it is.
    place = min(vibrating, key=lambda index: abs(found.natural_frequencies[index] - mode.natural_frequency))
    shares = zip(found.elements, found.dissipated[:, place].tolist(), strict=True)
    return dict(sorted(((name, one) for name, one in shares if abs(one) > SMALLEST_SHARE), key=lambda pair: -pair[1]))
