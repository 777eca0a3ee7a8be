"""Elimination tape run in a loop that numba compiles, few frequency points at a time.

numba compiles the loop when it is first used and keeps it on disk.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import torsionnet.linear.dynamic_stiffness.tape as ops
from torsionnet.base.errors import MissingExtraError
from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.response_problem import ReadingProblem, SolvedTerm
from torsionnet.linear.dynamic_stiffness.tape import Tape

# Integer and float arrays that say how every reading is formed, as the compiled loop runs through them.


@dataclass(frozen=True, eq=False)
class ReadingTable:
    """Arrays that tell the compiled loop how to form every reading, and the size of a measured one, from the solution.

    Attributes
    ----------
    whole : (n, 3) array
        Of each reading, then of each term of the measured one: the number of what is solved, the power of s or -1, the
        place in ``laws`` or -1.
    factors : (n,) array
    laws : tuple of int
        Numbers of the laws that are read.
    applied : float
        Size of the torques applied in the measured reading.
    n_out, n_excitations : int
    is_measured : bool
        Whether the reading after the outputs is one to divide by; there is one excitation then.
    """

    whole: NDArray[np.int64]
    factors: FloatArray
    laws: tuple[int, ...]
    applied: float
    n_out: int
    n_excitations: int
    is_measured: bool


def reading_table(reading_problem: ReadingProblem, n_out: int, n_excitations: int) -> ReadingTable | None:
    """Arrays for the compiled loop to form readings by, or None for several measured inputs or with controllers.

    They are for excitations that are solved together.
    """
    n_measured = len(reading_problem.readings) - n_out
    if reading_problem.sensed or n_measured > 1:
        return None
    parts = [*reading_problem.readings, *(reading_problem.terms[-1] if n_measured else ())]
    laws = tuple(dict.fromkeys(part.term.law for part in parts if part.term is not None and part.term.law is not None))
    return ReadingTable(
        np.array([_entry(part, laws) for part in parts], dtype=np.int64).reshape(-1, 3),
        np.array([float(part.factor if part.term is None else part.term.factor) for part in parts]),
        laws,
        float(np.abs(reading_problem.applied[-1]).sum()) if n_measured else 0.0,
        n_out,
        n_excitations,
        is_measured=bool(n_measured),
    )


def _entry(part: SolvedTerm, laws: tuple[int, ...]) -> tuple[int, int, int]:
    if part.term is None:
        return part.solved, -1, -1
    if part.term.law is not None:
        return part.solved, -1, laws.index(part.term.law)
    return part.solved, part.term.power, -1


try:
    import numba
except ModuleNotFoundError as error:
    raise MissingExtraError('the compiled solver needs numba: pip install "torsionnet[fast]"') from error
except ImportError as error:
    raise MissingExtraError(f"the compiled solver needs a numba that works with this numpy: {error}") from error

MOST_AT_ONCE, VECTOR = 256, 16
"""Most frequency points that the compiled loop works on at once, few enough for a thousand registers in the cache, and
the number of which theirs is a multiple, for vector instructions."""

LAW, LAW_SUM, LAW_SHARE, CONSTANT, SUM = ops.LAW, ops.LAW_SUM, ops.LAW_SHARE, ops.CONSTANT, ops.SUM
PRODUCT, QUOTIENT, INVERSE = ops.PRODUCT, ops.QUOTIENT, ops.INVERSE
LEAST_SQUARE, MOST_SQUARE = 1e-290, 1e290
"""Squared magnitudes, least and most, within which the compiled loop divides by a measured reading, since beyond them
only numpy's scaled division is safe. The compiled loop leaves NaN there."""


def sweep(tape: Tape, laws: LawStiffness) -> ComplexArray:
    """Output values (n_values, n_points) of a tape by the compiled loop."""
    values = np.zeros((tape.n_values, laws.n_points), dtype=complex)
    _sweep(tape.operations, *_law_arrays(laws), *_own(tape, laws), values)
    return values


def read(tape: Tape, slots: LawStiffness, table: ReadingTable, laws: LawStiffness) -> tuple[ComplexArray, FloatArray]:
    """Readings of sensors in SI units per excitation, or over the measured reading, at all frequency points.

    Parameters
    ----------
    tape : Tape
    slots, laws : LawStiffness
        Of the slots of the plan, and of the laws that are read.
    table : ReadingTable

    Returns
    -------
    (n_points, n_out, n_exc) array, (n_points,) array
        Readings, or quotients by the last one where it is measured, NaN beyond the range of the loop; its conditioning.
    """
    values = np.empty((slots.n_points, table.n_out, table.n_excitations), dtype=complex)
    conditioning = np.ones(slots.n_points)
    own = _law_arrays(laws)
    _read(tape.operations, *_law_arrays(slots), *own[:-1], *_own(tape, slots), tape.n_values,
          table.n_excitations, table.is_measured, table.whole, table.factors, table.applied,
          values, conditioning)  # fmt: skip
    return values, conditioning


def _own(tape: Tape, laws: LawStiffness) -> tuple[FloatArray, FloatArray]:
    """Factors of a tape and its registers, in the precision of the laws."""
    kind = laws.stiffness.dtype
    # Blocks of equal length, so that few points of the last one do not count.
    n_f = max(laws.omega.shape[-1], 1)
    n_points = VECTOR * math.ceil(n_f / math.ceil(n_f / MOST_AT_ONCE) / VECTOR)
    registers = ops.in_cache_lines(tape.n_registers, 2 * n_points, kind)
    return tape.factors.astype(kind), registers.reshape(-1, 2, n_points)


def _law_arrays(laws: LawStiffness) -> tuple[Any, ...]:
    """Arrays for the compiled loop, which are J, c, k of laws in SI, sampled stiffnesses and omega in rad/s.

    J, c and k are (n_variants, n_laws); then come places of sampled laws (-1: none) and the samples.

    Omega has one row, or one for each variant.
    """
    place = np.full(laws.n_laws, -1)
    place[[law for law, _ in laws.sampled]] = np.arange(len(laws.sampled))
    shape = (len(laws.stiffness), laws.omega.shape[-1])
    sampled = np.empty((len(laws.sampled), *shape), dtype=np.result_type(laws.stiffness.dtype, np.complex64))
    for number, (_, values) in enumerate(laws.sampled):
        sampled[number] = values
    parts = (np.ascontiguousarray(part) for part in (laws.inertia, laws.damping, laws.stiffness))
    return *parts, place, sampled, np.ascontiguousarray(np.atleast_2d(laws.omega))


def _walk(
    operations: Any, factors: Any, inertia: Any, damping: Any, stiffness: Any, place: Any, sampled: Any, w2: Any,
    w: Any, first: int, n: int, r: Any, y: Any,
) -> None:  # fmt: skip
    """Run all operations of a tape for a block of frequency points of one variant and write its outputs into ``y``.

    The first ``n`` of the points count.
    """
    one = r.dtype.type(1.0)  # in the precision of the registers, as a number alone makes the division double
    for number in range(operations.shape[0]):
        code, t, a, b, slot = operations[number]
        f = factors[number]
        if code == PRODUCT:  # (a + jb)(c + jd), on real and imaginary parts apart: complex numbers give no vector code
            for i in range(r.shape[2]):
                real = r[a, 0, i] * r[b, 0, i] - r[a, 1, i] * r[b, 1, i]
                imag = r[a, 0, i] * r[b, 1, i] + r[a, 1, i] * r[b, 0, i]
                r[t, 0, i] = real
                r[t, 1, i] = imag
        elif code == SUM:  # r_a + f r_b
            for i in range(r.shape[2]):
                more, beside = f * r[b, 0, i], f * r[b, 1, i]
                real, imag = r[a, 0, i] + more, r[a, 1, i] + beside
                r[t, 0, i] = real
                r[t, 1, i] = imag
        elif code in (LAW, LAW_SUM, LAW_SHARE):
            # kappa = k - J omega^2 + j c omega, and the sample of a table where there is one
            k, J, c, at = stiffness[slot], inertia[slot], damping[slot], place[slot]
            if code == LAW_SUM:
                for i in range(r.shape[2]):
                    real = k - J * w2[i] + f * (r[a, 0, i] * r[b, 0, i] - r[a, 1, i] * r[b, 1, i])
                    imag = c * w[i] + f * (r[a, 0, i] * r[b, 1, i] + r[a, 1, i] * r[b, 0, i])
                    r[t, 0, i] = real
                    r[t, 1, i] = imag
            elif code == LAW or at >= 0:
                for i in range(r.shape[2]):
                    r[t, 0, i] = k - J * w2[i]
                    r[t, 1, i] = c * w[i]
            if at >= 0:
                for i in range(r.shape[2]):
                    value = sampled[at, first + min(i, n - 1)]
                    r[t, 0, i] += value.real
                    r[t, 1, i] += value.imag
            if code == LAW_SHARE and at >= 0:
                for i in range(r.shape[2]):
                    r[t, 0, i], r[t, 1, i] = _share(r[t, 0, i], r[t, 1, i], r[a, 0, i], r[a, 1, i], f, one)
            elif code == LAW_SHARE:
                for i in range(r.shape[2]):
                    r[t, 0, i], r[t, 1, i] = _share(k - J * w2[i], c * w[i], r[a, 0, i], r[a, 1, i], f, one)
        elif code == QUOTIENT:
            for i in range(r.shape[2]):
                r[t, 0, i], r[t, 1, i] = _share(r[a, 0, i], r[a, 1, i], r[b, 0, i], r[b, 1, i], f, one)
        elif code == INVERSE:
            for i in range(r.shape[2]):
                scale = one / (r[a, 0, i] * r[a, 0, i] + r[a, 1, i] * r[a, 1, i])
                real, imag = r[a, 0, i] * scale, -r[a, 1, i] * scale
                r[t, 0, i] = real
                r[t, 1, i] = imag
        elif code == CONSTANT:
            for i in range(r.shape[2]):
                r[t, 0, i] = f
                r[t, 1, i] = 0.0
        else:  # OUTPUT
            for i in range(r.shape[2]):
                y[t, 0, i] = f * r[a, 0, i]
                y[t, 1, i] = f * r[a, 1, i]


def _sharing(a: Any, b: Any, c: Any, d: Any, f: Any, one: Any) -> tuple[Any, Any]:
    """Real and imaginary part of a share u / S = u conj(S) / |S|^2 with u = a + jb and S = c + jd + f u."""
    c, d = c + f * a, d + f * b
    scale = one / (c * c + d * d)
    return (a * c + b * d) * scale, (b * c - a * d) * scale


def _sweeping(
    operations: Any, inertia: Any, damping: Any, stiffness: Any, place: Any, sampled: Any, omega: Any,
    factors: Any, r: Any, values: Any,
) -> None:  # fmt: skip
    """Run a tape at all frequency points of all variants, and fill in ``values``."""
    n_variants, n_f = inertia.shape[0], omega.shape[1]
    w, w2 = np.empty(r.shape[2], r.dtype), np.empty(r.shape[2], r.dtype)
    y = np.zeros((values.shape[0], 2, r.shape[2]), r.dtype)
    for variant in range(n_variants):
        offset = variant * n_f
        for first in range(0, n_f, r.shape[2]):
            n = min(r.shape[2], n_f - first)
            _start(omega[min(variant, omega.shape[0] - 1)], first, n, w, w2)
            _points(operations, factors, inertia[variant], damping[variant], stiffness[variant], place,
                    sampled[:, variant], w2, w, first, n, r, y)  # fmt: skip
            for t in range(values.shape[0]):
                for i in range(n):
                    values[t, offset + first + i] = complex(y[t, 0, i], y[t, 1, i])


def _starting(omega: Any, first: int, n: int, w: Any, w2: Any) -> None:
    """Fill in omega and omega^2 of a block of frequency points.

    The last one is repeated for points that do not count.
    """
    for i in range(len(w)):
        w[i] = omega[first + min(i, n - 1)]
        w2[i] = w[i] * w[i]


def _reading(
    operations: Any, inertia: Any, damping: Any, stiffness: Any, place: Any, sampled: Any, omega: Any,
    own_inertia: Any, own_damping: Any, own_stiffness: Any, own_place: Any, own_sampled: Any,
    factors: Any, r: Any, n_values: int, n_exc: int, is_measured: bool, whole: Any, shares: Any, applied: float,
    values: Any, conditioning: Any,
) -> None:  # fmt: skip
    """Run a tape at all frequency points of all variants, and form the readings from its outputs.

    Rows of ``whole`` are, for each reading and then for each term of the measured one: the number of what is solved, a
    power of s or -1, a law or -1.
    """
    n_variants, n_f = inertia.shape[0], omega.shape[1]
    n_out = values.shape[1]
    n_readings = n_out + is_measured
    w, w2 = np.empty(r.shape[2], r.dtype), np.empty(r.shape[2], r.dtype)
    y, z = np.zeros((n_values, 2, r.shape[2]), r.dtype), np.empty((whole.shape[0], n_exc, 2, r.shape[2]))
    c, size = np.empty((2, r.shape[2])), np.empty(r.shape[2])
    for variant in range(n_variants):
        for first in range(0, n_f, r.shape[2]):
            n = min(r.shape[2], n_f - first)
            _start(omega[min(variant, omega.shape[0] - 1)], first, n, w, w2)
            _points(operations, factors, inertia[variant], damping[variant], stiffness[variant], place,
                    sampled[:, variant], w2, w, first, n, r, y)  # fmt: skip
            for number in range(whole.shape[0]):
                solved, power, law = whole[number]
                f = shares[number]
                # factor s^power at s = j omega: f, j f omega or -f omega^2
                for i in range(r.shape[2]):
                    c[0, i] = f if power <= 0 else 0.0 if power == 1 else -f * w2[i]
                    c[1, i] = f * w[i] if power == 1 else 0.0
                if law >= 0:
                    # f kappa = f (k - J omega^2 + j c omega), and the sample of a table
                    k, J, d = own_stiffness[variant, law], own_inertia[variant, law], own_damping[variant, law]
                    for i in range(r.shape[2]):
                        c[0, i] = f * (k - J * w2[i])
                        c[1, i] = f * (d * w[i])
                    if own_place[law] >= 0:
                        for i in range(n):
                            value = own_sampled[own_place[law], variant, first + i]
                            c[0, i] += f * value.real
                            c[1, i] += f * value.imag
                for e in range(n_exc):
                    t = solved * n_exc + e
                    for i in range(r.shape[2]):
                        real = c[0, i] * y[t, 0, i] - c[1, i] * y[t, 1, i]
                        imag = c[0, i] * y[t, 1, i] + c[1, i] * y[t, 0, i]
                        z[number, e, 0, i] = real
                        z[number, e, 1, i] = imag
            offset = variant * n_f + first
            if is_measured:
                for i in range(r.shape[2]):
                    size[i] = applied
                for number in range(n_readings, whole.shape[0]):
                    for i in range(r.shape[2]):
                        size[i] += math.sqrt(z[number, 0, 0, i] ** 2 + z[number, 0, 1, i] ** 2)
                # Conditioning |y| over its terms, and 1 / y = conj(y) / |y|^2 to multiply the readings by.
                for i in range(r.shape[2]):
                    a, b = z[n_out, 0, 0, i], z[n_out, 0, 1, i]
                    square = a * a + b * b
                    size[i] = math.sqrt(square) / size[i] if size[i] > 0.0 else 0.0
                    scale = 1.0 / square if LEAST_SQUARE < square < MOST_SQUARE else math.nan
                    c[0, i], c[1, i] = a * scale, -b * scale
                for number in range(n_out):
                    for i in range(r.shape[2]):
                        real = z[number, 0, 0, i] * c[0, i] - z[number, 0, 1, i] * c[1, i]
                        imag = z[number, 0, 0, i] * c[1, i] + z[number, 0, 1, i] * c[0, i]
                        z[number, 0, 0, i] = real
                        z[number, 0, 1, i] = imag
                for i in range(n):
                    conditioning[offset + i] = size[i]
            for number in range(n_out):
                for e in range(n_exc):
                    for i in range(n):
                        values[offset + i, number, e] = complex(z[number, e, 0, i], z[number, e, 1, i])


_jit = numba.njit(cache=True, error_model="numpy", nogil=True, fastmath={"contract"})
_share, _points, _start = _jit(_sharing), _jit(_walk), _jit(_starting)
_sweep, _read = _jit(_sweeping), _jit(_reading)
