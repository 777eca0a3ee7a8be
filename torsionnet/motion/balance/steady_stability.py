"""Stability of steady speeds under the slopes of laws of motion over the rate."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.model.element_base.laws import MotionState
from torsionnet.model.kinematics import exact_row
from torsionnet.model.law_network import LawNetwork, PlacedMotionLaw
from torsionnet.motion.balance.rate_states import LawSpeed

FloatArray = NDArray[np.float64]

ZERO_SHARE = 1e-9
"""Size of a number over those that it was made of below which it counts as zero."""


def returns_to_speeds(
    network: LawNetwork, rows: Mapping[PlacedMotionLaw, FloatArray], laws: Mapping[PlacedMotionLaw, LawSpeed]
) -> bool:
    """Whether the free motions, with the inertias that follow them, return to their speeds.

    ``rows`` are those of the laws over the free motions, in which laws that stick allow no motion.
    """
    n = len(network.free_motions)
    inertia, damping = np.zeros((n, n)), np.zeros((n, n))
    for _, law in network.linear:
        if law.inertia != 0:
            row = free_row(network, law.row)
            inertia += float(law.inertia) * np.outer(row, row)
    stuck = []
    for one, speed in laws.items():
        if one.law.curve.holds(speed.state):
            stuck.append(rows[one])
        else:
            _, slope, *others = (float(one.law.scale) * float(slope) for slope in one.law.curve.slopes(speed.state))
            damping += slope * np.outer(rows[one], rows[one])
            for sensed, share in zip(one.law.sensed, others, strict=True):
                damping += share * np.outer(rows[one], free_row(network, sensed))
    moving = null_space(np.array(stuck).reshape(len(stuck), n))
    inertia, damping = moving.T @ inertia @ moving, moving.T @ damping @ moving
    if not damping.size or not damping.any():
        return True
    if np.linalg.matrix_rank(inertia) < len(inertia):
        inertia = np.eye(len(inertia))
    rates = np.linalg.eigvals(np.linalg.solve(inertia, damping)).real
    return bool(rates.min() >= -ZERO_SHARE * np.abs(rates).max())


def returns_to_twists(network: LawNetwork, states: Mapping[PlacedMotionLaw, MotionState]) -> bool:
    """Whether the twists return where the torque of a law over the twist falls: its energy is least there.

    Steps hold their rows still; the stiffness of all other laws is positive on what is left.
    """
    slopes = {
        one: float(one.rounded.scale) * float(one.law.curve.slopes(state)[0])
        for one, state in states.items()
        if not one.law.curve.holds(state)
    }
    if all(slope >= 0 for slope in slopes.values()):
        return True
    place = {name: number for number, name in enumerate(network.coordinates)}

    def row_of(row: Mapping[str, Any]) -> FloatArray:
        found = np.zeros(len(place))
        for name, share in network.reduction.in_floats(exact_row(row)).items():
            if name in place:
                found[place[name]] = share
        return found

    rows = [(row_of(law.row), float(law.stiffness)) for _, law in network.elastic]
    rows += [(row_of(one.law.row), slope) for one, slope in slopes.items()]
    held = [row_of(one.law.row) for one in states if one not in slopes]
    moving = null_space(np.array(held).reshape(len(held), len(place)))
    stiffness = sum(size * np.outer(moving.T @ row, moving.T @ row) for row, size in rows)
    sizes = np.linalg.eigvalsh(stiffness)
    return bool(sizes.min() >= -ZERO_SHARE * np.abs(sizes).max())


def free_row(network: LawNetwork, row: Mapping[str, Any]) -> FloatArray:
    """Coefficients (n_free,) of a row of node angles over the free motions."""
    found = network.free.in_floats(exact_row(row))
    return np.array([found.get(name, 0.0) for name in network.free_motions])


def null_space(matrix: FloatArray) -> FloatArray:
    """Orthonormal columns (n, n_null) of the null space of a matrix (m, n)."""
    if not matrix.shape[0]:
        return np.eye(matrix.shape[1])
    _, sizes, right = np.linalg.svd(matrix)
    rank = int((sizes > ZERO_SHARE * sizes.max(initial=0.0)).sum())
    return np.asarray(right[rank:].T)
