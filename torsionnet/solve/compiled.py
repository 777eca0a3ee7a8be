"""The numbers of an elimination plan in a compiled loop: some lanes at a time, small enough to stay in the cache.

The same plan as in :mod:`torsionnet.solve.sweep`, walked along as a tape. numba compiles the loop when it is first used
and keeps it on disk.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.assembly.rows import ComplexArray
from torsionnet.errors import MissingExtraError
from torsionnet.solve import tape as ops
from torsionnet.solve.doubt import LARGE, lossy
from torsionnet.solve.sweep import Sweep
from torsionnet.solve.tape import Tape

try:
    import numba
except ImportError as error:
    msg = 'the compiled solver needs numba: pip install "torsionnet[fast]"'
    raise MissingExtraError(msg) from error

LANES = 64
"""Lanes worked on at once: enough for vector instructions, few enough for a thousand registers in the cache."""

SET_LAW, ADD_LAW, WATCHED_LAW = ops.SET_LAW, ops.ADD_LAW, ops.WATCHED_LAW
SET_SUM, ADD_SUM, WATCHED_SUM = ops.SET_SUM, ops.ADD_SUM, ops.WATCHED_SUM
SET_PRODUCT, ADD_PRODUCT, WATCHED_PRODUCT = ops.SET_PRODUCT, ops.ADD_PRODUCT, ops.WATCHED_PRODUCT
CONSTANT, INVERSE, OUTPUT = ops.CONSTANT, ops.INVERSE, ops.OUTPUT


def run(tape: Tape, kappa: LawStiffness, n_read: int) -> Sweep:
    """Walk along the tape for all lanes; values are (n_read, n_exc, n_lanes)."""
    values = np.zeros((n_read, tape.n_excitations, kappa.n_lanes), dtype=complex)
    doubtful = np.zeros(kappa.n_lanes, dtype=bool)
    place, sampled = _sampled(kappa)
    registers = np.empty((tape.n_registers, 2, LANES))
    n_f = len(kappa.omega)
    quiet = lossy(kappa)
    for variant in range(len(kappa.stiffness)):
        _walk(tape.operations, tape.factors, tape.of_stiffness, quiet[variant], kappa.inertia[variant], kappa.damping[variant], kappa.stiffness[variant],
              place, sampled[:, variant], kappa.omega, registers, values, doubtful, variant * n_f)  # fmt: skip
    return Sweep(values, doubtful)


def _sampled(kappa: LawStiffness) -> tuple[Any, ComplexArray]:
    """Where each law has its sampled part (-1: it has none), and these parts (n_sampled, n_variants, n_f)."""
    place = np.full(kappa.n_laws, -1)
    place[[law for law, _ in kappa.sampled]] = np.arange(len(kappa.sampled))
    values = [at for _, at in kappa.sampled]
    nothing = np.zeros((0, len(kappa.stiffness), len(kappa.omega)), dtype=complex)
    return place, np.stack(values) if values else nothing


def _loop(  # noqa: PLR0912, PLR0915
    operations: Any, factors: Any, of_stiffness: Any, lossy: Any, inertia: Any, damping: Any, stiffness: Any,
    place: Any, sampled: Any, omega: Any, registers: Any, values: Any, doubtful: Any, offset: int,
) -> None:  # fmt: skip
    """All operations for LANES lanes, then for the next; ``offset`` is the first lane of this variant."""
    n_f = omega.shape[0]
    w, w2 = np.empty(LANES), np.empty(LANES)
    lost, before = np.empty(LANES), np.empty(LANES)
    r = registers
    for first in range(0, n_f, LANES):
        n = min(LANES, n_f - first)
        for i in range(LANES):
            w[i] = omega[first + min(i, n - 1)]
            w2[i] = w[i] * w[i]
            lost[i] = 0.0
        quiet = lossy[first : first + n].all()
        for number in range(operations.shape[0]):
            operation, t, a, b = operations[number]
            f = factors[number]
            watched = operation == WATCHED_LAW or operation == WATCHED_SUM or operation == WATCHED_PRODUCT  # noqa: PLR1714
            if watched and quiet and of_stiffness[number]:
                watched, operation = False, operation - 1
            if operation <= WATCHED_LAW:
                k, J, c = f * stiffness[a], f * inertia[a], f * damping[a]
                if operation == SET_LAW:
                    for i in range(LANES):
                        r[t, 0, i] = k - J * w2[i]
                        r[t, 1, i] = c * w[i]
                else:
                    for i in range(LANES):
                        before[i] = abs(r[t, 0, i]) + abs(r[t, 1, i])
                        r[t, 0, i] += k - J * w2[i]
                        r[t, 1, i] += c * w[i]
                if place[a] >= 0:
                    for i in range(n):
                        r[t, 0, i] += f * sampled[place[a], first + i].real
                        r[t, 1, i] += f * sampled[place[a], first + i].imag
            elif operation == SET_SUM:
                for i in range(LANES):
                    r[t, 0, i] = f * r[a, 0, i]
                    r[t, 1, i] = f * r[a, 1, i]
            elif operation == ADD_SUM:
                for i in range(LANES):
                    r[t, 0, i] += f * r[a, 0, i]
                    r[t, 1, i] += f * r[a, 1, i]
            elif operation == WATCHED_SUM:
                for i in range(LANES):
                    before[i] = abs(r[t, 0, i]) + abs(r[t, 1, i])
                    r[t, 0, i] += f * r[a, 0, i]
                    r[t, 1, i] += f * r[a, 1, i]
            elif operation == SET_PRODUCT:
                for i in range(LANES):
                    real = r[a, 0, i] * r[b, 0, i] - r[a, 1, i] * r[b, 1, i]
                    imag = r[a, 0, i] * r[b, 1, i] + r[a, 1, i] * r[b, 0, i]
                    r[t, 0, i] = f * real
                    r[t, 1, i] = f * imag
            elif operation == ADD_PRODUCT:
                for i in range(LANES):
                    real = r[a, 0, i] * r[b, 0, i] - r[a, 1, i] * r[b, 1, i]
                    imag = r[a, 0, i] * r[b, 1, i] + r[a, 1, i] * r[b, 0, i]
                    r[t, 0, i] += f * real
                    r[t, 1, i] += f * imag
            elif operation == WATCHED_PRODUCT:
                for i in range(LANES):
                    before[i] = abs(r[t, 0, i]) + abs(r[t, 1, i])
                    real = r[a, 0, i] * r[b, 0, i] - r[a, 1, i] * r[b, 1, i]
                    imag = r[a, 0, i] * r[b, 1, i] + r[a, 1, i] * r[b, 0, i]
                    r[t, 0, i] += f * real
                    r[t, 1, i] += f * imag
            elif operation == INVERSE:
                for i in range(LANES):
                    scale = 1.0 / (r[a, 0, i] * r[a, 0, i] + r[a, 1, i] * r[a, 1, i])
                    real, imag = r[a, 0, i] * scale, -r[a, 1, i] * scale
                    r[t, 0, i] = real
                    r[t, 1, i] = imag
            elif operation == OUTPUT:
                for i in range(n):
                    values[t, b, offset + first + i] = complex(f * r[a, 0, i], f * r[a, 1, i])
            elif operation == CONSTANT:
                for i in range(LANES):
                    r[t, 0, i] = f
                    r[t, 1, i] = 0.0
            if watched:
                for i in range(LANES):
                    if before[i] > LARGE * (abs(r[t, 0, i]) + abs(r[t, 1, i])):
                        lost[i] = 1.0
        for i in range(n):
            doubtful[offset + first + i] = lost[i] > 0.0


_walk = numba.njit(cache=True, error_model="numpy", nogil=True, fastmath={"contract"})(_loop)
