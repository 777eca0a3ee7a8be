"""Offset of the angle's zero in degrees, or delay of a signal in ms, that explains several measured orders."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from torsionnet.base.phrases import phrase
from torsionnet.machinery.orders.difference_explanations import LEAST_EXPLAINED, delay_words, offset_words
from torsionnet.machinery.orders.order_pair import OrderPair
from torsionnet.signals.phase_turns import LONGEST_DELAY, best_turn

LEAST_SHARE = 0.02
"""Squared difference, over the squared calculated values, below which nothing asks for an explanation: 8 degrees."""
SHORT_PERIOD = 2 * math.pi * (1 - 1e-9)
"""Angle in rad below which the period of an offset is worth saying: a whole turn is plain."""


def common_turn(pairs: Sequence[OrderPair]) -> str:
    """Sentence on the offset in degrees or the delay in ms that explains several orders; empty if neither does.

    Every order counts alike, whatever its amplitude: each is divided by the RMS of its calculated values.
    """
    used = [pair for pair in pairs if pair.has_phase and pair.calculated.any()]
    if len(used) < 2:
        return ""
    scales = [float(np.sqrt(np.sum(np.abs(pair.calculated) ** 2))) for pair in used]
    model = np.concatenate([pair.calculated / scale for pair, scale in zip(used, scales, strict=True)])
    test = np.concatenate([pair.measured / scale for pair, scale in zip(used, scales, strict=True)])
    orders = np.concatenate([np.full(len(pair.speeds), pair.order) for pair in used])
    omega = orders * np.concatenate([pair.speeds for pair in used])
    before = float((np.abs(test - model) ** 2).sum())
    if before < LEAST_SHARE * len(used):
        return ""
    products = np.conj(model) * test
    period = _period([pair.order for pair in used])
    offset = best_turn(orders, products, -period / 2, period / 2)
    delay = best_turn(-omega, products, -LONGEST_DELAY, LONGEST_DELAY)
    again = period if period < SHORT_PERIOD else 0.0
    turned = {
        offset_words(offset, again): np.exp(1j * orders * offset),
        delay_words(delay): np.exp(-1j * omega * delay),
    }
    left = {words: float((np.abs(test - model * turn) ** 2).sum()) for words, turn in turned.items()}
    words = min(left, key=left.__getitem__)
    removed = 1 - left[words] / before
    if removed < LEAST_EXPLAINED:
        return ""
    return phrase(
        "all orders together: {words}, which removes {share:.0f} % of the squared difference",
        words=words,
        share=100 * removed,
    )


def _period(orders: Sequence[float]) -> float:
    """Angle in rad of the reference shaft after which the phases of all orders repeat; a four-stroke cycle at most."""
    halves = [round(2 * order) for order in orders]
    whole = all(math.isclose(half, 2 * order, rel_tol=1e-6) for half, order in zip(halves, orders, strict=True))
    return 4 * math.pi / math.gcd(*halves) if whole else 4 * math.pi
