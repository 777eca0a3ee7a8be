"""The dynamic stiffness that a stiffness and curves over frequency make."""

from __future__ import annotations

import math

from torsionnet.core.piecewise_linear import Rows
from torsionnet.model.element_base.sampled_stiffness import SampledStiffness


def over_frequency(stiffness: float, factor: Rows, loss: Rows, loss_factor: float = 0.0) -> SampledStiffness:
    """The stiffness k factor(f) (1 + j eta(f)).

    Without rows in ``loss`` eta is ``loss_factor`` everywhere, without rows in ``factor`` that is 1.

    Examples
    --------
    >>> from torsionnet.core.expressions import Number
    >>> rows = ((Number(1), Number(1)), (Number(100), Number(4)))
    >>> over_frequency(500.0, rows, (), 0.1).stiffness
    (500.0, 2000.0)
    """
    frequencies = sorted({float(f.value) for f, _ in (*factor, *loss)})
    factors = [_read(factor, f, 1.0) for f in frequencies]
    losses = [_read(loss, f, loss_factor) for f in frequencies]
    storage = [stiffness * one for one in factors]
    return SampledStiffness.of(frequencies, storage, [k * eta for k, eta in zip(storage, losses, strict=True)])


def _read(rows: Rows, frequency: float, otherwise: float) -> float:
    """By powers of the frequency, as the law itself goes between its rows."""
    import numpy as np

    if not rows:
        return otherwise
    keys, values = zip(*((math.log(f.value), math.log(one.value)) for f, one in rows), strict=True)
    return math.exp(float(np.interp(math.log(frequency), keys, values)))
