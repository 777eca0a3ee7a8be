"""Steps of a state space under torques that vibrate: exact for the free motion, by quadrature for the torques.

    z(t + h) = exp(T h) z(t) + h sum_j W_j B u(t + c_j h)

The weights W_j integrate exp(T (h - s)) times the polynomial through the torques at Gauss points exactly, so that stiff
parts need no short steps: a step only has to resolve the torques.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np
import scipy

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.triangular import DiagonalBlock, blocks

NEGLIGIBLE_CHANGE, ROUNDING = 1e-6, 1e-12
"""Singular values of the state matrices' relative change, relative to the largest and absolute, below which they are
rounding."""
CORRECTION_TOLERANCE = 1e-8
"""Size of a correction for the change of the state matrix, over the motion, at which no further one follows."""
MOST_CORRECTIONS = 20
"""Largest number of corrections for the change of the state matrix in a section: each is smaller by the share by which
damping changes in a section, a few per cent."""

Matrices: TypeAlias = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""Matrices A, B, C and D of a state space x' = A x + B u, y = C x + D u in SI units."""


@dataclass(frozen=True, eq=False)
class SteppedForm:
    """State space in SI units of a section of time in which its matrices change evenly from first to last.

    The matrices in the middle are split into uncoupled blocks. What A(t) x differs from that is a torque like another,
    of low rank, that follows from the motion: corrections of the motion are repeated until they no longer matter.

    Attributes
    ----------
    middle, change : matrices A, B, C, D
        In the middle of the section, and at its end less those at its beginning.
    read : (n_out, rank) array
        How the change of C reads what is sensed.
    sensed : (rank, n_x) array
        What the changes of A and C sense of the states.
    parts : tuple of DiagonalBlock
        Blocks with the inputs u, u times its change, the change of A, and the states; outputs y, sensed, states.
    """

    middle: Matrices
    change: Matrices
    read: FloatArray
    sensed: FloatArray
    parts: tuple[DiagonalBlock, ...]

    @classmethod
    def between(cls, first: Matrices, last: Matrices) -> SteppedForm:
        """State space of a section of time in SI units, from its matrices at both ends."""
        A, B, C, _ = middle = _matrices((begin + other) / 2 for begin, other in zip(first, last, strict=True))
        change = _matrices(other - begin for begin, other in zip(first, last, strict=True))
        # (dA; dC) = acting @ sensed of least rank, by singular values of rows scaled to A and C, so that units
        # decide nothing.
        rows = np.vstack([change[0], change[2]])
        sizes = np.abs(np.vstack([A, C])).max(axis=1, keepdims=True, initial=1e-300)
        left, singular, right = np.linalg.svd(rows / sizes)
        rank = int((singular > max(NEGLIGIBLE_CHANGE * singular.max(initial=0.0), ROUNDING)).sum())
        acting, sensed = sizes * left[:, :rank] * singular[:rank], right[:rank]
        every = np.eye(len(A))
        inputs = np.hstack([B, change[1], acting[: len(A)], every])
        parts = tuple(blocks(A, inputs, np.vstack([C, sensed, every])))
        return cls(middle, change, acting[len(A) :], sensed, parts)

    def steps(
        self, start: FloatArray, torques: FloatArray, at_points: FloatArray, h: float
    ) -> tuple[FloatArray, FloatArray]:
        """Outputs (n_out, n + 1) in SI units at every point of n steps of h seconds, and the states (n_x,) at the end.

        Parameters
        ----------
        start : (n_x,) array
            States at the first point.
        torques : (n_in, n, n_nodes) array
            N m at the Gauss points of every step.
        at_points : (n_in, n + 1) array
            N m at the points.
        h : float
            s.
        """
        n_in, n, nodes = torques.shape
        (n_out, n_x), rank = self.middle[2].shape, len(self.sensed)
        # A(t) = A + swing dA over the section, swing from -1/2 to 1/2, and likewise B, C and D.
        swing = (np.arange(n)[:, None] + gauss_points(nodes)) / n - 0.5
        swing_at = np.linspace(-0.5, 0.5, n + 1)
        stepping = [(part, part.is_diagonal) for part in self.parts]
        steps = [
            _Steps(part, diagonal, *step_weights(part.T, h, nodes, diagonal=diagonal)) for part, diagonal in stepping
        ]
        driven = np.concatenate([torques, torques * swing]) if self.change[1].any() else torques
        response = _sum(step.run(start, driven, slice(0, len(driven)), n_x) for step in steps)
        own, more = slice(2 * n_in, 2 * n_in + rank), response
        # Picard iteration: dA acts on the motion found last and makes a correction, which dA acts on again.
        for _ in range(MOST_CORRECTIONS if rank else 0):
            push = swing * _at_gauss_points(more[0][n_out : n_out + rank], nodes)
            more = _sum(step.run(0 * start, push, own, n_x) for step in steps)
            response = (response[0] + more[0], response[1] + more[1])
            if np.abs(more[0]).max() <= CORRECTION_TOLERANCE * np.abs(response[0]).max():
                break
        # y = (C + swing dC) x + (D + swing dD) u.
        read = self.read @ response[0][n_out : n_out + rank] + self.change[3] @ at_points
        return response[0][:n_out] + self.middle[3] @ at_points + swing_at * read, response[1]

    def steady(self, torques: ComplexArray, frequencies: FloatArray) -> FloatArray:
        """States (n_x,) of steady vibration at the beginning, under torques (n_in, n_lines) at frequencies in rad/s.

        Lines that stand still, at 0 rad/s, move nothing.
        """
        # At the beginning swing is -1/2: x = Re (j omega - A)^-1 B T for each line.
        A, B = (self.middle[place] - self.change[place] / 2 for place in (0, 1))
        states = np.zeros(len(A))
        for column, omega in zip((B @ torques).T, frequencies.tolist(), strict=True):
            if omega and column.any():
                states += np.linalg.solve(1j * omega * np.eye(len(A)) - A, column).real
        return states


@dataclass(frozen=True, eq=False)
class _Steps:
    """Uncoupled block with the matrices of a step: exp(T h), and the weights of the torques at the Gauss points."""

    part: DiagonalBlock
    diagonal: bool
    step: ComplexArray
    weights: ComplexArray

    def run(self, start: FloatArray, torques: FloatArray, columns: slice, n_x: int) -> tuple[FloatArray, FloatArray]:
        """Contribution of a block to output rows (n_rows, n + 1) at the ends of n steps, and to the last states (n_x,).

        Parameters
        ----------
        start : (n_x,) array
        torques : (n_columns, n, n_nodes) array
            At the Gauss points of every step.
        columns : slice
            Inputs of the block that they are.
        n_x : int
        """
        from scipy.signal import lfilter

        part, step = self.part, self.step
        z = part.B[:, -n_x:] @ start
        # z(n+1) = exp(T h) z(n) + sum_j W_j B u(t_n + g_j h).
        pushed = np.tensordot(part.B[:, columns], torques, axes=1)
        drive = np.einsum("jk,knj->kn" if self.diagonal else "jkl,lnj->kn", self.weights, pushed)
        states = np.empty((len(z), torques.shape[1] + 1), dtype=complex)
        # T is upper triangular: from the last state up each one depends on itself and on those below it alone.
        for state in range(len(z) - 1, -1, -1):
            source = np.concatenate([z[state : state + 1], drive[state]])
            if not self.diagonal:
                source[1:] += step[state, state + 1 :] @ states[state + 1 :, :-1]
            own = step[state] if self.diagonal else step[state, state]
            states[state] = lfilter([1.0], [1.0, -own], source)
        seen = part.C[:-n_x]
        outputs = seen.real @ states.real - seen.imag @ states.imag
        return outputs, (part.C[-n_x:] @ states[:, -1]).real


def _sum(parts: Iterable[tuple[FloatArray, FloatArray]]) -> tuple[FloatArray, FloatArray]:
    """Sums of the first and of the second arrays of pairs."""
    first, *others = parts
    for other in others:
        first = (first[0] + other[0], first[1] + other[1])
    return first


def _matrices(four: Iterable[FloatArray]) -> Matrices:
    A, B, C, D = four
    return A, B, C, D


def _at_gauss_points(values: FloatArray, nodes: int) -> FloatArray:
    """Values (n_rows, n, n_nodes) at the Gauss points of n even steps, from those at their ends, by cubics."""
    n = values.shape[1] - 1
    # Lagrange's cubic through the four points around a step; at an end those inside.
    first = np.clip(np.arange(n) - 1, 0, n - 3)
    at_points = np.zeros((len(values), n, nodes))
    place = (np.arange(n) - first)[:, None] + gauss_points(nodes)
    for point in range(4):
        weight = np.ones_like(place)
        for other in range(4):
            if other != point:
                weight = weight * (place - other) / (point - other)
        at_points += values[:, first + point, None] * weight
    return at_points


@lru_cache(maxsize=16)
def gauss_points(count: int) -> FloatArray:
    """Places of the Gauss points in a step from 0 to 1, shape (count,)."""
    return np.asarray((np.polynomial.legendre.leggauss(count)[0] + 1) / 2)


def step_weights(T: ComplexArray, h: float, count: int, *, diagonal: bool) -> tuple[ComplexArray, ComplexArray]:
    """Matrix exp(T h), and weights in s of the torques at the Gauss points; of a diagonal T the diagonals alone.

    The shapes are (n, n) and (count, n, n), or (n,) and (count, n).
    """
    powers = np.vander(gauss_points(count), count, increasing=True)
    lagrange = np.linalg.inv(powers)  # column j: coefficients of the polynomial that is 1 at point j alone
    # The integral of exp(T (h - s)) (s/h)^m from 0 to h is h m! phi_(m+1)(T h).
    moments = h * np.array([math.factorial(power) for power in range(count)], dtype=float)
    if diagonal:
        functions = _phi(np.diag(T)[:, None, None] * h, count)[:, :, 0, 0].T
        return functions[0], np.einsum("mj,m,mk->jk", lagrange, moments, functions[1:])
    dense = _phi(T[None] * h, count)[0]
    return dense[0], np.einsum("mj,m,mkl->jkl", lagrange, moments, dense[1:])


def _phi(matrices: ComplexArray, count: int) -> ComplexArray:
    """Matrices exp(X), phi_1(X), ..., phi_count(X), shape (n_matrices, count + 1, n, n).

    phi_{m+1}(X) is the integral of exp(X (1 - s)) s^m / m! from 0 to 1; all stand in one exponential of a larger matrix
    (Al-Mohy and Higham 2011, theorem 2.1).
    """
    n = matrices.shape[1]
    # [X I 0; 0 0 I; 0 0 0]: the first row of blocks of its exponential is exp(X), phi_1(X), phi_2(X).
    whole = np.zeros((len(matrices), n * (count + 1), n * (count + 1)), dtype=complex)
    whole[:, :n, :n] = matrices
    for block in range(count):
        rows, columns = slice(block * n, (block + 1) * n), slice((block + 1) * n, (block + 2) * n)
        whole[:, rows, columns] += np.eye(n)
    power: Any = scipy.linalg.expm(whole)
    return np.asarray(power[:, :n].reshape(len(matrices), n, count + 1, n).transpose(0, 2, 1, 3))
