"""Reference angles of measured orders from which a fit starts.

A test that counts its angle from elsewhere than the model turns order o by exp(j o psi). The sum of squares over psi
has as many minima as the highest order has periods in a cycle, and an even engine without misfire looks the same every
firing interval: minima are looked for with the other unknowns following each angle by a linear step.
"""

from __future__ import annotations

import numpy as np

from torsionnet.identification.orders.order_block import OrderBlock
from torsionnet.linear.assembly.rows import FloatArray

ANGLES_PER_PERIOD = 12
"""Number of angles within a period of the highest order at which a minimum is looked for."""
LONGEST_CYCLE = 4 * np.pi
"""Crank angle in rad of the longest common cycle, of a four-stroke engine, after which a reference comes again."""
MOST_MINIMA = 6
"""Number of minima from which a fit starts, one for each firing interval of an engine with six cylinders."""
LIKELY_EXCESS = 0.5
"""Share of the largest sum of squares, above the smallest, within which a minimum is worth a start."""


def reference_angles(block: OrderBlock, values: FloatArray) -> tuple[float, ...]:
    """Reference angles in rad at which the model is near the test, the nearest first; in (-360, 360] degrees.

    Parameters
    ----------
    block : OrderBlock
        With phases, its reference angle being an unknown.
    values : (n,) array
        Values of the unknowns of the block; the reference angle itself does not matter.
    """
    place = len(block.response.names) + block.extra.index("reference_angle")
    others = np.arange(len(values)) != place
    at = values.copy()
    at[place] = 0.0
    predicted, slopes = block.predicted(at)
    weight = 1 / np.sqrt(block.noise)
    size = np.where(values[others] != 0, np.abs(values[others]), 1.0)
    moving = slopes[:, others] * size * weight[:, None]
    highest = max(float(block.line_orders.max()), 1.0)
    steps = int(np.ceil(ANGLES_PER_PERIOD * highest * LONGEST_CYCLE / (2 * np.pi)))
    angles = (np.arange(steps) - steps // 2) * (LONGEST_CYCLE / steps)
    costs = np.array(
        [
            _cost(turn * predicted * weight - block.measured * weight, turn[:, None] * moving)
            for turn in np.exp(1j * angles[:, None] * block.line_orders)
        ]
    )
    likely = costs <= costs.min() + LIKELY_EXCESS * (costs.max() - costs.min())
    found = [k for k in np.flatnonzero(likely) if costs[k] <= costs[k - 1] and costs[k] < costs[(k + 1) % steps]]
    # Equal minima, as without half orders: the smallest angle first.
    ranked = sorted(found, key=lambda k: (round(costs[k] / max(costs.max(), np.finfo(float).tiny), 9), abs(angles[k])))
    return tuple(float(angles[k]) for k in ranked[:MOST_MINIMA])


def _cost(residual: np.ndarray, moving: np.ndarray) -> float:
    """Sum of squares after a linear step of the other unknowns, each held near its value by its own size."""
    count = moving.shape[1]
    if not count:
        return float(np.sum(np.abs(residual) ** 2))
    rows = np.concatenate([moving.real, moving.imag, np.eye(count)])
    left = np.concatenate([residual.real, residual.imag, np.zeros(count)])
    normal, side = rows.T @ rows, rows.T @ left
    return float(left @ left - side @ np.linalg.solve(normal, side))
