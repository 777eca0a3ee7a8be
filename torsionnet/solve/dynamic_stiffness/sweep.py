"""Elimination tape run in numpy, where every operation works on a vector of frequency points at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import torsionnet.solve.dynamic_stiffness.tape as ops
from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.solve.dynamic_stiffness.lost_digits import Array, LostDigits
from torsionnet.solve.dynamic_stiffness.tape import Tape

BLOCK_BYTES = 24 * 2**20
"""Memory in bytes of the registers that numpy works on at once, since more would leave the processor's cache."""
FEWEST_POINTS, MOST_POINTS = 1024, 4096
"""Fewest and most frequency points that numpy works on at once, as fewer cost more in the interpreter than in
arithmetic and more leave the cache."""


@dataclass
class Sweep:
    """Motions and reactions (n_read, n_exc, n_points) per unit excitation, and mask of uncertain points."""

    values: Array
    uncertain: NDArray[np.bool_]


def sweep(tape: Tape, kappa: LawStiffness) -> tuple[Array, NDArray[np.bool_]]:
    """Output values (n_values, n_points) of a tape by numpy, and mask (n_points,) of points that lost digits.

    Parameters
    ----------
    tape : Tape
    kappa : LawStiffness
        Of the slots of the plan.

    Returns
    -------
    (n_values, n_points) array, (n_points,) boolean array
        Values, and which points have lost digits.
    """
    kind = float if kappa.is_real else complex
    values = np.zeros((tape.n_values, kappa.n_points), dtype=kind)
    uncertain = np.zeros(kappa.n_points, dtype=bool)
    walk = list(zip(*tape.operations.T.tolist(), tape.factors.tolist(), strict=True))
    start = 0
    for part in kappa.blocks(min(MOST_POINTS, max(FEWEST_POINTS, BLOCK_BYTES // (16 * (tape.n_registers + 1))))):
        here = slice(start, start + part.n_points)
        lost_digits = LostDigits(part.n_points)
        _walk(walk, part, np.empty((tape.n_registers + 1, part.n_points), dtype=kind), values[:, here], lost_digits)
        uncertain[here] = lost_digits.marked
        start = here.stop
    return values, uncertain


def _walk(
    walk: list[tuple[int, int, int, int, float]],
    kappa: LawStiffness,
    registers: Array,
    values: Array,
    lost_digits: LostDigits,
) -> None:
    *r, spare = registers
    parts = registers.reshape(len(registers), len(kappa.stiffness), kappa.n_frequencies)
    real, imag = list(parts.real), list(parts.imag) if np.iscomplexobj(parts) else [None] * len(parts)
    for code, t, a, b, factor in walk:
        if code == ops.PRODUCT:
            np.multiply(r[a], r[b], out=r[t])
        elif code in (ops.SUM, ops.PIVOT):
            term: Any = r[b] if factor == 1.0 else np.multiply(r[b], factor, out=spare)
            np.add(r[a], term, out=r[t])
            if code == ops.SUM:
                lost_digits.check_sum(term, r[t])
        elif code == ops.LAW:
            kappa.write(a, real[t], imag[t])
            against = kappa.inertial(a)
            if against is not None:
                lost_digits.check_sum(against, r[t])
        elif code == ops.QUOTIENT:
            np.divide(r[a], r[b], out=r[t])
        elif code == ops.WATCH:
            lost_digits.check_share(r[a], factor)
        elif code == ops.INVERSE:
            np.divide(1.0, r[a], out=r[t])
        elif code == ops.CONSTANT:
            r[t].fill(factor)
        else:
            np.multiply(r[a], factor, out=values[t])
