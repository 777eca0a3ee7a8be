"""Contributions that may each be up or down: the combination that makes the most of an output.

The half range is a convex function of the deviations, so that it is largest where each of them is at one end.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.frequency_response import ComplexArray, FloatArray
from torsionnet.response.order_response import OrderResponse

PER_PERIOD = 8
"""Points for each period of the highest order, where combinations are looked for; the one found is summed finely."""
COARSE = 8
"""Points from one to the next place of the highest value with which the search begins."""
ROUNDS = 3
TOGETHER = 50
"""Speeds that are searched together, which bounds the memory."""
LONGEST = 100
"""Revolutions: the waveform of a common cycle beyond these is searched by excitation."""


@dataclass(frozen=True, eq=False)
class Contributions:
    """What torques that come on top do to the outputs.

    Attributes
    ----------
    excitation : str
    labels : tuple of str
    lines : slice
        The lines of that excitation.
    values : (n_shares, n_speeds, n_lines, n_out) complex array
    """

    excitation: str
    labels: tuple[str, ...]
    lines: slice
    values: ComplexArray


def largest_amplitudes(values: ComplexArray, scatter: Sequence[Contributions]) -> FloatArray:
    """Largest amplitude of every line over all combinations, exactly; (n_speeds, n_lines, n_out).

    Combinations fill a polygon around the amplitude without deviations. One of its corners lies furthest out; along its
    edges one contribution changes while the signs of the others are those of their parts across that edge.
    """
    found = np.abs(values)
    for one in scatter:
        centre = values[:, one.lines]
        best = found[:, one.lines]
        for edge in one.values:
            parts = np.where(edge == 0, 0, (one.values * edge.conj()).imag)
            corner = (np.sign(parts) * one.values).sum(axis=0)  # without those along the edge
            along = np.where(parts == 0, (one.values * edge.conj()).real, 0)
            rest = (np.sign(along) * one.values).sum(axis=0)
            for end in (corner + rest, corner - rest):
                best = np.maximum(best, np.maximum(np.abs(centre + end), np.abs(centre - end)))
        found[:, one.lines] = best
    return np.asarray(found)


def worst_combination(case: OrderResponse, scatter: Sequence[Contributions]) -> tuple[OrderResponse, NDArray[np.int8]]:
    """The response with the worst combination by speed and output, and its signs (n_speeds, n_out, n_contributions)."""
    count = sum(len(one.labels) for one in scatter)
    signs = np.ones((len(case.speeds), len(case.outputs), count), dtype=np.int8)
    if not scatter:
        return case, signs
    groups = [list(scatter)] if (case.revolutions or LONGEST + 1) <= LONGEST else [[one] for one in scatter]
    first = 0
    for group in groups:
        width = sum(len(one.labels) for one in group)
        for start in range(0, len(case.speeds), TOGETHER):
            part = slice(start, start + TOGETHER)
            signs[part, :, first : first + width] = _signs(case, group, part)
        first += width
    values = case.values.copy()
    first = 0
    for one in scatter:
        factors = signs[:, :, first : first + len(one.labels)]
        values[:, one.lines] += np.einsum("kslo,sok->slo", one.values, factors)
        first += len(one.labels)
    return replace(case, values=values), signs


def _signs(case: OrderResponse, group: Sequence[Contributions], part: slice) -> NDArray[np.int8]:
    """Signs (n_speeds, n_out, n) at some speeds, by the values along the cycle of all lines or those of one shaft."""
    waves = _waves(case, group, part)
    base, shares = waves[0], waves[1:]
    high, low = _highest_and_lowest(base, shares)
    at_high, at_low = (np.take_along_axis(shares, at[None, :, :, None], axis=3)[..., 0] for at in (high, low))
    return np.moveaxis(np.where(at_high >= at_low, 1, -1), 0, -1).astype(np.int8)


def _waves(case: OrderResponse, group: Sequence[Contributions], part: slice) -> FloatArray:
    """Along the cycle: the case, then every contribution; (1 + n, n_speeds, n_out, n_points)."""
    together = len(group) > 1 or (case.revolutions or LONGEST + 1) <= LONGEST
    ratio = case.lines[group[0].lines.start].ratio
    places = [at for at, line in enumerate(case.lines) if together or line.ratio == ratio]
    cycle = case.revolutions if together else _own_cycle(case, places)
    counts = [
        int((case.lines[at].relative if together else case.lines[at].exact_order) * (cycle or 1)) for at in places
    ]
    points = PER_PERIOD * max(counts)
    points += -points % COARSE
    basis = np.exp(2j * np.pi * np.outer(counts, np.arange(points)) / points)
    found = [np.einsum("slo,lm->som", case.values[part][:, places], basis).real]
    for one in group:
        own = basis[[places.index(at) for at in range(one.lines.start, one.lines.stop)]]
        found += [np.einsum("slo,lm->som", share[part], own).real for share in one.values]
    return np.array(found)


def _own_cycle(case: OrderResponse, places: Sequence[int]) -> int:
    return int(np.lcm.reduce([case.lines[at].exact_order.denominator for at in places]))


def _highest_and_lowest(base: FloatArray, shares: FloatArray) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Two places along the cycle whose difference is largest with the signs that suit it; (n_speeds, n_out) each."""
    best = np.full(base.shape[:2], -np.inf)
    high, low = np.zeros(base.shape[:2], dtype=np.int64), np.zeros(base.shape[:2], dtype=np.int64)
    for start in _coarse(base.shape[2]):
        found = _differences(base, shares, np.full(base.shape[:2], start))
        at = np.argmax(found, axis=2)
        value = np.take_along_axis(found, at[..., None], axis=2)[..., 0]
        better = value > best
        best, high, low = np.where(better, value, best), np.where(better, start, high), np.where(better, at, low)
    for _ in range(ROUNDS):
        high = np.argmax(_differences(-base, shares, low), axis=2)
        low = np.argmax(_differences(base, shares, high), axis=2)
    return high, low


def _coarse(points: int) -> Iterator[int]:
    yield from range(0, points, COARSE)


def _differences(base: FloatArray, shares: FloatArray, at: NDArray[np.int64]) -> FloatArray:
    """Value at a place less that at every other one, all deviations as they suit it."""
    found = np.take_along_axis(base, at[..., None], axis=2) - base
    for share in shares:
        found += np.abs(np.take_along_axis(share, at[..., None], axis=2) - share)
    return np.asarray(found)
