"""Which lanes have lost digits in a sum on the way: they are looked at again."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.law_stiffness import LawStiffness

Array: TypeAlias = NDArray[Any]
"""Real where nothing damps the system, else complex; the last axis is lanes."""

LARGE = 1e4
"""A sum this much smaller than its terms is in doubt: what follows from it has lost four digits or more."""
LOSSY = 3 / LARGE
"""With this loss factor in every spring no sum of dynamic stiffnesses can be in doubt, see :func:`lossy`."""


class Doubt:
    """Marks lanes; the tests are quick where there is nothing to mark."""

    def __init__(self, n_lanes: int) -> None:
        self.marked = np.zeros(n_lanes, dtype=bool)

    def shares(self, share: Array) -> None:
        """Look at terms over their sum."""
        if not np.vdot(share, share).real < LARGE * LARGE:
            self._mark(~(np.abs(share) < LARGE))

    def sums(self, term: Array, total: Array) -> None:
        """Look at a sum of two, of which ``term`` is one. Real parts tell where a closer look is needed."""
        ratio = term.real / total.real
        if not np.vdot(ratio, ratio) < LARGE * LARGE:
            self._mark(np.abs(term) > LARGE * np.abs(total))

    def _mark(self, found: NDArray[np.bool_]) -> None:
        self.marked |= found.reshape(-1, found.shape[-1]).any(axis=0)


def lossy(kappa: LawStiffness) -> NDArray[np.bool_]:
    r"""Lanes in which every spring takes out so much energy that no sum of dynamic stiffnesses can vanish.

    The dynamic stiffness S felt at a coordinate under a unit motion is V - T + j D with V, T, D = sum of Re, -Re and Im
    of kappa |gamma|^2 over springs, inertias and all laws. Where D >= eta V, its terms are at most 3/eta of its size:
    they are V + T + D, |S| >= D, and where T > 2 V even |S| >= T/2.

    Returns
    -------
    (n_variants, n_f) array
    """
    elastic = kappa.stiffness > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        slowest = np.where(elastic, kappa.damping / kappa.stiffness, np.inf).min(axis=1, initial=np.inf)
    slowest[(elastic & (kappa.inertia > 0)).any(axis=1)] = 0.0
    found: NDArray[np.bool_] = slowest[:, None] * kappa.omega >= LOSSY
    for law, values in kappa.sampled:
        found &= values.imag + kappa.damping[:, law, None] * kappa.omega >= LOSSY * np.abs(values)
    return found
