"""Torques of all excitations along a speed over time, and the exact steps of a state space under them.

Steps of a state space under torques that vibrate: exact for the free motion, by quadrature for the torques.

    z(t + h) = exp(T h) z(t) + h sum_j W_j B u(t + c_j h)

The weights W_j integrate exp(T (h - s)) times the polynomial through the torques at Gauss points exactly, so that stiff
parts need no short steps: a step only has to resolve the torques.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.triangular import DiagonalBlock, blocks
from torsionnet.machinery.orders.engine_angles import EngineAngle, with_engines_delayed
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.order_solution import OrderLoads, OrderRequest
from torsionnet.machinery.orders.worst_response import WorstResponse

# Torques of all excitations along a speed over time, for one case of excitation.


@dataclass(frozen=True)
class ExcitationCase:
    """Choice of one of the cases of excitation of running machinery.

    Misfire, values that scatter, and angles between engines in rad.

    Attributes
    ----------
    alternative : int or None
        Index of the case among those of the order response.
    signs : tuple of int
        1 where a value that scatters is up, -1 where it is down.
    angles : tuple of (EngineAngle, float)
        Engines and the angle in rad by which each is late.
    words : str
        Name of the case, empty where there is one only.
    """

    alternative: int | None = None
    signs: tuple[int, ...] = ()
    angles: tuple[tuple[EngineAngle, float], ...] = ()
    words: str = ""

    @classmethod
    def worst(cls, run: OrderResponse, output: int = 0) -> ExcitationCase:
        """Case of excitation with the largest half range of an output over all speeds of an order response."""
        if not isinstance(run, WorstResponse):
            return cls()
        at = int(np.argmax(run.half_range[:, output]))
        return cls(
            int(run.chosen[at, output]) if run.labels else None,
            tuple(run.signs[at, output].tolist()),
            tuple((angle, float(angle.angle[at, output])) for angle in run.angles),
            run.case_at(at, run.outputs[output].name),
        )


@dataclass(frozen=True, eq=False)
class PassageTorques:
    """Torques of one case of excitation as functions of the angle of the reference shaft, its speed and time."""

    request: OrderRequest
    case: ExcitationCase
    kept: NDArray[np.bool_]
    """Flags of the order lines that act, shape (n_lines,)."""

    def amplitudes(self, speeds: FloatArray) -> tuple[ComplexArray, OrderLoads]:
        """Complex amplitudes (n_speeds, n_lines, n_inputs) in N m at speeds in rad/s, and their lines and inputs."""
        loads = self.request.loads(speeds)
        values = loads.loads.copy()
        kinds = [each.torques.alternatives for each in loads.by_excitation]
        sizes = [len(kind.labels) for kind in kinds if kind is not None]
        # Cases are all combinations of one alternative per excitation, the last running fastest.
        picked = iter(np.unravel_index(self.case.alternative or 0, sizes) if sizes else ())
        signs, first = list(self.case.signs), 0
        for each, alternatives in zip(loads.by_excitation, kinds, strict=True):
            lines = slice(first, first := first + len(each.lines))
            out = ""
            shares = []
            if alternatives is not None:
                number = int(next(picked))
                out = alternatives.parts[number]
                shares.append((alternatives.nodes[number], alternatives.amplitudes[number], 1.0))
            if (scatter := each.torques.scatter) is not None:
                own, signs = signs[: len(scatter.labels)], signs[len(scatter.labels) :]
                shares += [
                    (node, torque, 0.0 if part == out else float(sign))
                    for node, torque, part, sign in zip(
                        scatter.nodes, scatter.amplitudes, scatter.parts, own, strict=True
                    )
                ]
            for node, torque, factor in shares:
                if node in each.inputs:
                    channel, sense = each.inputs[node]
                    values[:, lines, loads.inputs.index(channel)] += factor * sense * torque
        size = (len(speeds), len(loads.inputs))
        late = [replace(engine, angle=np.full(size, angle)) for engine, angle in self.case.angles]
        return with_engines_delayed(values, loads.lines, late), loads

    def sections(self, ranges: Sequence[tuple[float, float]], count: int) -> list[SectionTorques]:
        """Torques in each of some ranges of speed in rad/s, with amplitudes interpolated between ``count`` speeds."""
        # Chebyshev points with both ends, between which a polynomial does not swing.
        share = (1 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2
        speeds = np.array([low + (high - low) * share for low, high in ranges])
        values, loads = self.amplitudes(speeds.ravel())
        # A line that stands still is a mean torque, which is left out.
        values[loads.hertz == 0] = 0.0
        values = values[:, self.kept]
        size = (count, *values.shape[1:])
        inverse = np.linalg.inv(np.vander(share, increasing=True))
        relative = np.array([float(line.relative) for line in loads.lines])[self.kept]
        fixed = 2 * math.pi * np.array([line.fixed for line in loads.lines])[self.kept]
        return [
            SectionTorques(low, high, np.tensordot(inverse, part, axes=1), relative, fixed)
            for (low, high), part in zip(ranges, values.reshape(len(ranges), *size), strict=True)
        ]


@dataclass(frozen=True, eq=False)
class SectionTorques:
    """Torques Re sum_l T_l exp(j theta_l) with amplitudes that are polynomials of the speed within a section.

    Attributes
    ----------
    low, high : float
        Speeds at the ends, rad/s.
    powers : (n_powers, n_lines, n_inputs) complex array
        N m, factors of the powers of (speed - low)/(high - low).
    relative : (n_lines,) array
        Vibrations per revolution of the reference shaft.
    fixed : (n_lines,) array
        rad/s that come on top.
    """

    low: float
    high: float
    powers: ComplexArray
    relative: FloatArray
    fixed: FloatArray

    def at(self, times: FloatArray, angles: FloatArray, speeds: FloatArray) -> FloatArray:
        """Torques (n_inputs, n) in N m at times in s, angles in rad and speeds in rad/s of the reference shaft."""
        # theta_l = r_l phi + 2 pi f_l t; amplitudes by Horner's rule in the share of the speed range.
        turned = np.outer(self.relative, angles) + np.outer(self.fixed, times)
        # Re(T exp(j theta)) = Re T cos theta - Im T sin theta: real functions and products are several times as fast.
        waves = np.concatenate([np.cos(turned), np.sin(turned)])
        share = (speeds - self.low) / ((self.high - self.low) or 1.0)
        torques = np.zeros((self.powers.shape[2], len(times)))
        for factors in self.powers[::-1]:
            torques = torques * share + np.concatenate([factors.real, -factors.imag]).T @ waves
        return torques

    def steady(self, time: float, angle: float, speed: float) -> tuple[ComplexArray, FloatArray]:
        """Complex torques (n_inputs, n_lines) in N m at an instant, and frequencies (n_lines,) in rad/s."""
        share = (speed - self.low) / ((self.high - self.low) or 1.0)
        amplitudes = np.tensordot(share ** np.arange(len(self.powers)), self.powers, axes=1)
        # A line of order nu and frequency omega turns with nu phi + omega t.
        turning = np.exp(1j * (self.relative * angle + self.fixed * time))
        return amplitudes.T * turning, self.relative * speed + self.fixed


def lines_that_matter(run: OrderResponse, negligible: float) -> tuple[NDArray[np.bool_], float]:
    """Flags of the order lines followed, shape (n_lines,), and the share of the largest half range in the others.

    Highest orders are left out while together they have no more than a share ``negligible`` of any output.
    """
    size = run.half_range.max(axis=0)
    shares = (run.sizes.max(axis=0) / np.where(size > 0, size, 1.0)).max(axis=1)
    # From the highest frequency down: these cost the most steps.
    order = np.argsort(-np.abs(run.frequencies).max(axis=0), kind="stable")
    lost = np.cumsum(shares[order])
    count = min(int(np.searchsorted(lost, negligible, side="right")), len(order) - 1)
    kept = np.ones(len(order), dtype=bool)
    kept[order[:count]] = False
    return kept, float(lost[count - 1]) if count else 0.0


def highest_rate(lines: Sequence[float], fixed: FloatArray, speed: float) -> float:
    """Largest angular frequency in rad/s of order lines at a speed in rad/s."""
    return float(np.abs(np.asarray(lines) * speed + fixed).max(initial=0.0))


# Steps of a state space under torques that vibrate: exact for the free motion, by quadrature for the torques.

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
