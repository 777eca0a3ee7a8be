"""What is kept of the variants of a study: all values, or those of a part, and counts of what is beyond the limits."""

from __future__ import annotations

from math import ceil, gcd

from torsionnet.study.quantities.quantity_limit import QuantityLimit
from torsionnet.study.study import Study

KEPT_VALUES = 10_000_000
"""Values up to which those of all variants are kept; of more variants a part, with at most so many values."""


def kept_every(study: Study) -> int:
    """1 where the values of all variants of a study are kept, else the m with which every m-th is.

    It has no factor in common with the number of values on any axis, nor with two: of a grid every tenth variant could
    have one and the same value of a parameter, and every other point of a Sobol sequence lies in the same half.
    """
    if study.count * len(study.quantities) <= KEPT_VALUES:
        return 1
    model = study.model_in(study.configurations[0])
    forms = [one.measured(model, study.quantities) for one in study.quantities.values()]
    each = len(study.space.names) + sum(2 if form.is_curve else 1 for form in forms)
    every = ceil(study.count * each / KEPT_VALUES)
    while gcd(every, 2 * study.space.count) > 1:
        every += 1
    return every


def counted_limits(study: Study, every: int) -> dict[str, QuantityLimit]:
    """Limits that variants are counted by as they are calculated, always in the same order; none where all are kept."""
    return {} if every == 1 else dict(sorted(study.limits.items()))
