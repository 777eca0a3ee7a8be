"""The numbers of a tape in a compiled loop: few points at a time, so that all registers stay in the cache.

numba compiles the loop when it is first used and keeps it on disk.
"""

# ruff: noqa: FURB136  (``min`` looks for NaN, which keeps compilers from making vector instructions of a loop)

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import torsionnet.solve.tape as ops
from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.assembly.rows import ComplexArray
from torsionnet.core.errors import MissingExtraError
from torsionnet.solve.doubt import LARGE, SHARE
from torsionnet.solve.tape import Tape

try:
    import numba
except ImportError as error:
    raise MissingExtraError('the compiled solver needs numba: pip install "torsionnet[fast]"') from error

POINTS = 128
"""Points worked on at once: enough for vector instructions, few enough for a thousand registers in the cache."""

LAW, CONSTANT, SUM, PIVOT, PRODUCT = ops.LAW, ops.CONSTANT, ops.SUM, ops.PIVOT, ops.PRODUCT
QUOTIENT, INVERSE, WATCH, OUTPUT = ops.QUOTIENT, ops.INVERSE, ops.WATCH, ops.OUTPUT
SQUARE, SHARE_SQUARE = LARGE * LARGE, SHARE * SHARE


def sweep(tape: Tape, kappa: LawStiffness) -> tuple[ComplexArray, NDArray[np.bool_]]:
    """As :func:`torsionnet.solve.sweep.sweep`."""
    values = np.zeros((tape.n_values, kappa.n_points), dtype=complex)
    doubtful = np.zeros(kappa.n_points, dtype=bool)
    place, sampled = _sampled(kappa)
    registers = np.empty((tape.n_registers, 2, POINTS))
    n_f = kappa.n_frequencies
    omega = np.ascontiguousarray(np.broadcast_to(kappa.omega, (len(kappa.stiffness), n_f)))
    for variant in range(len(kappa.stiffness)):
        _walk(tape.operations, tape.factors, kappa.inertia[variant], kappa.damping[variant], kappa.stiffness[variant],
              place, sampled[:, variant], omega[variant], registers, values, doubtful, variant * n_f)  # fmt: skip
    return values, doubtful


def _sampled(kappa: LawStiffness) -> tuple[Any, ComplexArray]:
    """Where each law has its sampled part (-1: it has none), and these parts (n_sampled, n_variants, n_f)."""
    place = np.full(kappa.n_laws, -1)
    place[[law for law, _ in kappa.sampled]] = np.arange(len(kappa.sampled))
    values = [at for _, at in kappa.sampled]
    nothing = np.zeros((0, len(kappa.stiffness), kappa.n_frequencies), dtype=complex)
    return place, np.stack(values) if values else nothing


def _loop(
    operations: Any, factors: Any, inertia: Any, damping: Any, stiffness: Any, place: Any, sampled: Any, omega: Any,
    r: Any, values: Any, doubtful: Any, offset: int,
) -> None:  # fmt: skip
    """All operations for POINTS points, then for the next; ``offset`` is the first point of this variant.

    ``left`` falls below zero where a sum is smaller than its terms by more than LARGE, or a share is larger than SHARE.
    """
    n_f = omega.shape[0]
    w, w2, left = np.empty(POINTS), np.empty(POINTS), np.empty(POINTS)
    for first in range(0, n_f, POINTS):
        n = min(POINTS, n_f - first)
        for i in range(POINTS):
            w[i] = omega[first + min(i, n - 1)]
            w2[i] = w[i] * w[i]
            left[i] = 0.0
        for number in range(operations.shape[0]):
            code, t, a, b = operations[number]
            f = factors[number]
            if code == PRODUCT:
                for i in range(POINTS):
                    real = r[a, 0, i] * r[b, 0, i] - r[a, 1, i] * r[b, 1, i]
                    imag = r[a, 0, i] * r[b, 1, i] + r[a, 1, i] * r[b, 0, i]
                    r[t, 0, i] = real
                    r[t, 1, i] = imag
            elif code == SUM:
                for i in range(POINTS):
                    more, beside = f * r[b, 0, i], f * r[b, 1, i]
                    real, imag = r[a, 0, i] + more, r[a, 1, i] + beside
                    r[t, 0, i] = real
                    r[t, 1, i] = imag
                    spare = SQUARE * (real * real + imag * imag) - (more * more + beside * beside)
                    left[i] = spare if spare < left[i] else left[i]
            elif code == PIVOT:
                for i in range(POINTS):
                    r[t, 0, i] = r[a, 0, i] + f * r[b, 0, i]
                    r[t, 1, i] = r[a, 1, i] + f * r[b, 1, i]
            elif code == LAW:
                k, J, c, at = stiffness[a], inertia[a], damping[a], place[a]
                if at < 0:
                    for i in range(POINTS):
                        r[t, 0, i] = k - J * w2[i]
                        r[t, 1, i] = c * w[i]
                else:
                    for i in range(POINTS):
                        value = sampled[at, first + min(i, n - 1)]
                        r[t, 0, i] = k - J * w2[i] + value.real
                        r[t, 1, i] = c * w[i] + value.imag
                if J != 0.0 and (k != 0.0 or at >= 0):
                    for i in range(POINTS):
                        size = r[t, 0, i] * r[t, 0, i] + r[t, 1, i] * r[t, 1, i]
                        spare = SQUARE * size - (J * w2[i]) * (J * w2[i])
                        left[i] = spare if spare < left[i] else left[i]
            elif code == QUOTIENT:
                for i in range(POINTS):
                    scale = 1.0 / (r[b, 0, i] * r[b, 0, i] + r[b, 1, i] * r[b, 1, i])
                    real = r[a, 0, i] * r[b, 0, i] + r[a, 1, i] * r[b, 1, i]
                    imag = r[a, 1, i] * r[b, 0, i] - r[a, 0, i] * r[b, 1, i]
                    r[t, 0, i] = real * scale
                    r[t, 1, i] = imag * scale
            elif code == WATCH:
                for i in range(POINTS):
                    size = r[a, 0, i] * r[a, 0, i] + r[a, 1, i] * r[a, 1, i]
                    spare = SHARE_SQUARE - f * f * size
                    left[i] = spare if spare < left[i] else left[i]
            elif code == INVERSE:
                for i in range(POINTS):
                    scale = 1.0 / (r[a, 0, i] * r[a, 0, i] + r[a, 1, i] * r[a, 1, i])
                    real, imag = r[a, 0, i] * scale, -r[a, 1, i] * scale
                    r[t, 0, i] = real
                    r[t, 1, i] = imag
            elif code == CONSTANT:
                for i in range(POINTS):
                    r[t, 0, i] = f
                    r[t, 1, i] = 0.0
            else:
                for i in range(n):
                    values[t, offset + first + i] = complex(f * r[a, 0, i], f * r[a, 1, i])
        for i in range(n):
            doubtful[offset + first + i] = left[i] < 0.0


_walk = numba.njit(cache=True, error_model="numpy", nogil=True, fastmath={"contract"})(_loop)
