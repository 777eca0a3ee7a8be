"""Dynamic stiffness from a stiffness and curves of its factor and loss factor over frequency."""

from __future__ import annotations

import math

from torsionnet.base.expressions import Rows
from torsionnet.model.element_base.sampled_stiffness import SampledStiffness


def stiffness_from_curves(
    stiffness: float, factor: Rows, loss: Rows, loss_factor: float = 0.0, *, viscous: bool = False
) -> SampledStiffness:
    """Dynamic stiffness k factor(f) (1 + j eta(f)) in N m/rad, sampled at the frequencies of the curves.

    Without rows in ``loss`` eta is ``loss_factor`` everywhere, without rows in ``factor`` the factor is 1.
    Eta is c omega/k of a ``viscous`` damping, else a loss factor.

    Examples
    --------
    >>> from torsionnet.base.expressions import Number
    >>> rows = ((Number(1), Number(1)), (Number(100), Number(4)))
    >>> stiffness_from_curves(500.0, rows, (), 0.1).stiffness
    (500.0, 2000.0)
    """
    frequencies = sorted({float(f.value) for f, _ in (*factor, *loss)})
    factors = [_read(factor, f, 1.0) for f in frequencies]
    losses = [_read(loss, f, loss_factor) for f in frequencies]
    storage = [stiffness * one for one in factors]
    second = [k * eta for k, eta in zip(storage, losses, strict=True)]
    return SampledStiffness.of(frequencies, storage, second, viscous=viscous)


def _read(rows: Rows, frequency: float, otherwise: float) -> float:
    """Value of a curve at a frequency in Hz, interpolated as a power of the frequency between its rows."""
    import numpy as np

    if not rows:
        return otherwise
    keys, values = zip(*((math.log(f.value), math.log(one.value)) for f, one in rows), strict=True)
    return math.exp(float(np.interp(math.log(frequency), keys, values)))
