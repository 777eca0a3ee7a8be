"""Intervals of averaged orders, from the scatter between cycles and from the bend of their course over speed.

A pair of cycles under a Hann window shares a cycle with the next pair, so that their estimates correlate by 1/6 even
where the noise does not; slow fluctuations correlate more. The correlation of neighbours, rho, is taken over all blocks
of a record, without the share that the straight line of each block adds; the mean of n estimates then has the variance
s^2/n (1 + rho)/(1 - rho) and n (1 - rho)/(1 + rho) - 2 degrees of freedom for each of two parts, as of a first-order
autoregression.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from torsionnet.signals.orders.cycle_average import FEWEST_PAIRS, AveragedBlock
from torsionnet.signals.recording import FloatArray

OVERLAP_CORRELATION = 1 / 6
"""Correlation of white noise under Hann windows that overlap by half."""
LARGEST_CORRELATION = 0.95
"""Largest correlation of neighbouring cycles reckoned with: beyond it a block has no two cycles that tell anything
new."""
LEVEL = 0.975
"""Quantile of Student's distribution for the half width of a 95 % interval."""
BEND_SHARE = 1 / 12
"""Share of the second difference of neighbouring blocks that counts as error: the mean over a block is off by 1/24 of
it where the course is a parabola; twice that, since at a peak it is not."""


def half_widths(blocks: Sequence[AveragedBlock]) -> FloatArray:
    """Half widths of the 95 % intervals of real and imaginary part, SI, shape (n_signals, n_orders, n_blocks)."""
    from scipy.stats import t

    counts = np.array([block.count for block in blocks])[:, :, None]
    scatter = np.array([block.scatter for block in blocks])
    rho = _correlation(blocks, counts)
    worth = np.maximum(counts * (1 - rho) / (1 + rho), 1.0)
    freedom = np.maximum(2 * (worth - 2), 1.0)
    spread = scatter / (2 * np.maximum(counts - 2, 1))
    found = t.ppf(LEVEL, freedom) * np.sqrt(spread / worth)
    found = np.where(counts < FEWEST_PAIRS, np.nan, found)
    values = np.array([block.values for block in blocks])
    bend = np.zeros(values.shape)
    if len(blocks) > 2:
        inner = np.nan_to_num(np.abs(values[2:] - 2 * values[1:-1] + values[:-2])) * BEND_SHARE
        bend = np.concatenate([inner[:1], inner, inner[-1:]])
    return np.asarray(np.moveaxis(np.hypot(found, bend), 0, -1))


def _correlation(blocks: Sequence[AveragedBlock], counts: NDArray[np.intp]) -> FloatArray:
    """Correlation of neighbouring estimates, shape (n_signals, n_orders), without that which a straight line leaves."""
    enough = counts >= FEWEST_PAIRS
    if not enough.any():
        return np.full(blocks[0].values.shape, OVERLAP_CORRELATION)
    total = sum(np.where(kept, block.scatter, 0) for block, kept in zip(blocks, enough, strict=True))
    following = sum(np.where(kept, block.next_scatter, 0) for block, kept in zip(blocks, enough, strict=True))
    # White noise of unit variance keeps n - 2 of n squares after a straight line, and -2 (n - 2)/n products of
    # neighbours.
    freedom = np.where(enough, counts - 2, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        left = np.nan_to_num((-2 * freedom / np.maximum(counts, 1)).sum(axis=0) / freedom.sum(axis=0))
        rho = np.nan_to_num(np.asarray(following / total)) - left
    return np.asarray(np.clip(rho, OVERLAP_CORRELATION, LARGEST_CORRELATION))
