"""Torques of all excitations along a speed over time, for one case of excitation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.machinery.orders.engine_angles import EngineAngle, with_engines_delayed
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.order_solution import OrderLoads, OrderRequest
from torsionnet.machinery.orders.worst_response import WorstResponse


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
