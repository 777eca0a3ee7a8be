"""Mean torques that change with one another so that a drivetrain with laws of motion stays in balance."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import TorsionnetError
from torsionnet.model.definition import Tangents
from torsionnet.model.kinematics import exact_row
from torsionnet.model.law_network import LawNetwork, PlacedMotionLaw
from torsionnet.model.operating_point import torque_place

FloatArray = NDArray[np.float64]

NEGLIGIBLE = 1e-9
"""Share of the largest singular value below which one counts as zero."""

LEAST_TOGETHER = 0.1
"""Share of the sizes of torques that they have to leave over together, so that one factor on all of them can balance
a change; of torques that cancel one another it would be huge."""


def followed_torques(
    network: LawNetwork, before: Tangents, steps: Mapping[str, float], loose: Mapping[str, float]
) -> dict[str, float]:
    """Mean torques in N m, by place, that keep a drivetrain in balance when others change.

    Balance is needed along the motions that neither springs nor laws over the speed resist. All loose torques change
    by one factor, as with the load of a plant. What this leaves over the smallest relative changes take, those with
    the least sum of (dT/T)^2; what cannot be balanced stays.

    Parameters
    ----------
    network : LawNetwork
        With the parameter values in force.
    before : Tangents
        Operating point that the torques change, which tells which laws slip at their limit and take nothing more.
    steps : mapping
        Place -> change in N m of a torque given by hand.
    loose : mapping
        Place -> torque in N m that may change.
    """
    free = _unresisted(network, before)

    def along(place: str) -> FloatArray:
        return np.asarray(free @ _row(network, torque_place(place).row))

    torques = np.array(list(loose.values()))
    shares = np.array([along(place) for place in loose]).T.reshape(len(free), len(loose))
    needed = -sum((step * along(place) for place, step in steps.items()), np.zeros(len(free)))
    together, apart = shares @ torques, np.abs(shares) @ np.abs(torques)
    factor = 0.0
    if np.linalg.norm(together) > LEAST_TOGETHER * np.linalg.norm(apart):
        factor = float(together @ needed / (together @ together))
    sizes = np.abs(torques) if torques.any() else np.ones(len(loose))
    rest = np.linalg.pinv(shares * sizes, rcond=NEGLIGIBLE) @ (needed - factor * together)
    changed = torques + factor * torques + sizes * rest
    return dict(zip(loose, changed.tolist(), strict=True))


def _unresisted(network: LawNetwork, before: Tangents) -> FloatArray:
    """Motions (n, n_free) over the free motions that no law over the speed resists at an operating point."""
    rows = [_row(network, one.law.row) for one in network.over_rate if _resists(network, before, one)]
    n = len(network.free_motions)
    if not rows:
        return np.eye(n)
    _, sizes, directions = np.linalg.svd(np.array(rows).reshape(len(rows), n))
    return np.asarray(directions[int(np.sum(sizes > NEGLIGIBLE * sizes.max(initial=0.0))) :])


def _resists(network: LawNetwork, before: Tangents, one: PlacedMotionLaw) -> bool:
    """Whether the torque of a law over the speed answers changes: it sticks, or rises or falls with the speed."""
    try:
        states = before.state.states[one.owner]
    except TorsionnetError:
        return True
    state = states[[law.number for law in network.motion if law.owner == one.owner].index(one.number)]
    return bool(one.law.curve.holds(state)) or float(one.law.curve.slopes(state)[1]) != 0


def _row(network: LawNetwork, row: Mapping[str, float]) -> FloatArray:
    found = network.free.in_floats(exact_row({node: share for node, share in row.items() if node in network.order}))
    return np.array([found.get(name, 0.0) for name in network.free_motions])
