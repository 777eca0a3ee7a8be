"""Vibration in the worst of several cases of excitation, such as misfires, from one solution by superposition.

A misfire of each cylinder, gas torques that differ by some per cent, engines at any angle to each other: only torques
of single cylinders or their phases change, and the response is linear in them.

Signs of deviations that may each add or subtract, with which the half range is largest. The half range is a convex
function of the deviations, so that it is largest where each deviation is at one end.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import joined
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.machinery.excitations import TorqueShares
from torsionnet.machinery.orders.engine_angles import EngineAngle, at_worst_angles
from torsionnet.machinery.orders.order_line import has_unknown_angles
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.worst_response import EQUAL_HALF_RANGE, EQUAL_SEARCHED_HALF_RANGE, WorstResponse

# Signs of deviations that may each add or subtract, with which the half range is largest.

POINTS_PER_PERIOD = 8
"""Points per period of the highest order while signs are searched, coarse since the half range is then summed more
finely."""
START_STRIDE = 2
"""Points along the cycle from one start of the search for signs to the next, with which half ranges are missed by less
than 1 %.

With a stride of 8 half ranges were missed by up to 7 %, with 2 by less than 1 %; a stride of 1 found no more.
"""
ROUNDING = 1e-9
"""Part of a bound that rounding could take, far above it, so that no start is left out for its sake."""
ROUNDS = 3
"""Rounds that improve the places of the highest and lowest value in turn, few since each costs time, though more may
find more."""
SPEEDS_PER_SEARCH = 50
"""Number of speeds for which signs are searched together, which bounds the memory."""
PARALLEL = 1e-9
"""Part of a deviation across an edge, over its size, below which the deviation counts as parallel to the edge."""
LONGEST_CYCLE = 100
"""Most revolutions of a common cycle of all shafts for which signs are searched for all excitations together. Beyond it
they are searched for each excitation alone.

A larger value searches longer waveforms, which takes time and memory in proportion.
"""


@dataclass(frozen=True, eq=False)
class Contributions:
    """Response amplitudes (n_shares, n_speeds, n_lines, n_out) that deviations of an excitation's torques add.

    Attributes
    ----------
    excitation : str
    labels : tuple of str
    lines : slice
        Indices of the lines of the excitation.
    values : (n_shares, n_speeds, n_lines, n_out) complex array
    parts : tuple of str
        Part of the machine, as a cylinder, to which each share belongs.
    """

    excitation: str
    labels: tuple[str, ...]
    lines: slice
    values: ComplexArray
    parts: tuple[str, ...]

    def without(self, parts: Container[tuple[str, str]]) -> Contributions:
        """Copy in which the amplitudes of parts, such as a cylinder, named by excitation and part, are zero."""
        kept = np.array([(self.excitation, part) not in parts for part in self.parts], dtype=float)
        return replace(self, values=self.values * kept[:, None, None, None])


def largest_amplitudes(values: ComplexArray, scatter: Sequence[Contributions]) -> FloatArray:
    """Largest amplitude of every order line over all signs of deviations, exactly, (n_speeds, n_lines, n_out).

    Combinations fill a polygon around the amplitude without deviations. One of its corners lies furthest out, and at
    every corner an edge begins: contributions along it have the sign of that edge, others that of their part across it.
    """
    largest = np.abs(values)
    for deviation in scatter:
        centre, best = values[:, deviation.lines], largest[:, deviation.lines]
        for edge in deviation.values:
            # Im(share conj(edge)) has the sign of the side of the edge to which a share points: all on one side make
            # a corner.
            product = deviation.values * edge.conj()
            is_along = np.abs(product.imag) <= PARALLEL * np.abs(product)
            signs = np.sign(np.where(is_along, product.real, product.imag))
            corner = (signs * deviation.values).sum(axis=0)
            # The polygon is symmetric to its centre: every corner has an opposite one.
            best = np.maximum(best, np.maximum(np.abs(centre + corner), np.abs(centre - corner)))
        largest[:, deviation.lines] = best
    return np.asarray(largest)


def worst_combination(case: OrderResponse, scatter: Sequence[Contributions]) -> tuple[OrderResponse, NDArray[np.int8]]:
    """Order response with the worst signs of deviations, and these signs (n_speeds, n_out, n_contributions)."""
    signs = [np.ones((len(case.speeds), len(case.outputs), 0), dtype=np.int8)]
    values = case.values.copy()
    # Excitations whose lines have a short common cycle scatter together, others each on its own.
    for group in [list(scatter)] if _repeats_soon(case) and scatter else [[deviation] for deviation in scatter]:
        parts = [slice(start, start + SPEEDS_PER_SEARCH) for start in range(0, len(case.speeds), SPEEDS_PER_SEARCH)]
        signs.append(np.concatenate([_signs(case, group, part) for part in parts]))
        first = 0
        for deviation in group:
            own = signs[-1][:, :, first : first + len(deviation.labels)]
            values[:, deviation.lines] += np.einsum("kslo,sok->slo", deviation.values, own)
            first += len(deviation.labels)
    return replace(case, values=values), np.concatenate(signs, axis=2)


def _repeats_soon(case: OrderResponse) -> bool:
    return case.revolutions is not None and case.revolutions <= LONGEST_CYCLE


def _signs(case: OrderResponse, group: Sequence[Contributions], part: slice) -> NDArray[np.int8]:
    """Signs +1 or -1, (n_speeds, n_out, n), of the deviations with the largest half range, at ``part`` of the speeds.

    They are found from values along the cycle of all lines or of one shaft.
    """
    base, *shares = _waves(case, group, part)
    high, low = _highest_and_lowest(base, np.array(shares))
    # A share adds to max - min with the sign of its difference between the two instants.
    ends = [np.take_along_axis(np.array(shares), at[None, :, :, None], axis=3)[..., 0] for at in (high, low)]
    return np.moveaxis(np.sign(ends[0] - ends[1]), 0, -1).astype(np.int8)


def _waves(case: OrderResponse, group: Sequence[Contributions], part: slice) -> list[FloatArray]:
    """Waveforms (n_speeds, n_out, n_points) along the cycle, of the case and then of every torque deviation.

    Where all lines have a short common cycle they all count, else only the lines of the shaft of the excitation.
    """
    places = list(range(len(case.lines)))
    orders = [case.lines[at].relative for at in places]
    if not _repeats_soon(case):
        ratio = case.lines[group[0].lines.start].ratio
        places = [at for at in places if case.lines[at].ratio == ratio]
        orders = [case.lines[at].exact_order for at in places]
    cycle = math.lcm(*(order.denominator for order in orders))
    counts = [int(order * cycle) for order in orders]
    # Orders of one shaft repeat many times in one cycle of a reference shaft behind a gear.
    repeats = math.gcd(*counts) or 1
    counts = [count // repeats for count in counts]
    points = POINTS_PER_PERIOD * max(counts)
    basis = np.exp(2j * np.pi * np.outer(counts, np.arange(points)) / points)
    waves = [np.einsum("slo,lm->som", case.values[part][:, places], basis).real]
    for deviation in group:
        own = basis[[places.index(at) for at in range(deviation.lines.start, deviation.lines.stop)]]
        waves += [np.einsum("slo,lm->som", share[part], own).real for share in deviation.values]
    return waves


def _highest_and_lowest(base: FloatArray, shares: FloatArray) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Indices (n_speeds, n_out) along the cycle of the highest and of the lowest value with the worst signs."""
    best = np.full(base.shape[:2], -np.inf)
    high, low = np.zeros(base.shape[:2], dtype=np.int64), np.zeros(base.shape[:2], dtype=np.int64)
    # Starts all over the cycle, since improving one end at a time may stop at a local maximum; but for those from which
    # even the farthest value of every share would not be as far off as what one start reaches.
    most = _largest_differences(base, shares)
    farthest = START_STRIDE * np.argmax(most[:, :, ::START_STRIDE], axis=2)  # itself one of the starts
    reached = np.max(_differences(base, shares, farthest), axis=2)
    promising = np.any(most >= reached[..., None] * (1 - ROUNDING), axis=(0, 1))
    for start in range(0, base.shape[2], START_STRIDE):
        if not promising[start]:
            continue
        differences = _differences(base, shares, np.full(base.shape[:2], start))
        at = np.argmax(differences, axis=2)
        value = np.take_along_axis(differences, at[..., None], axis=2)[..., 0]
        better = value > best
        best, high, low = np.where(better, value, best), np.where(better, start, high), np.where(better, at, low)
    # In turn the best highest instant to this lowest one, and the best lowest to that.
    for _ in range(ROUNDS):
        high = np.argmax(_differences(-base, shares, low), axis=2)
        low = np.argmax(_differences(base, shares, high), axis=2)
    return high, low


def _largest_differences(base: FloatArray, shares: FloatArray) -> FloatArray:
    """Bound (n_speeds, n_out, n_points) of the differences of each value from all others, under the worst signs."""
    bound = base - base.min(axis=2, keepdims=True)
    for share in shares:
        bound += np.maximum(share - share.min(axis=2, keepdims=True), share.max(axis=2, keepdims=True) - share)
    return np.asarray(bound)


def _differences(base: FloatArray, shares: FloatArray, at: NDArray[np.int64]) -> FloatArray:
    """Differences (n_speeds, n_out, n_points) of the value at ``at`` from all others, under the worst signs."""
    differences = np.take_along_axis(base, at[..., None], axis=2) - base
    for share in shares:
        differences += np.abs(np.take_along_axis(share, at[..., None], axis=2) - share)
    return np.asarray(differences)


MOST_CASES = 400
"""Most combinations of alternatives that are examined, which bounds time and memory since each is a full response."""
Entry = TypeVar("Entry", bound=np.generic)


def contributions(
    excitation: str,
    shares: TorqueShares,
    gains: ComplexArray,
    lines: slice,
    columns: Mapping[str, tuple[int, float]],
) -> Contributions:
    """Response amplitudes (n_shares, n_speeds, n_lines, n_out) that each deviation of torques adds to the nominal ones.

    Parameters
    ----------
    excitation : str
        Name of the excitation.
    shares : TorqueShares
    gains : (n_speeds, n_lines, n_out, n_inputs) complex array
        Outputs for unit inputs.
    lines : slice
        Indices of the lines of the excitation.
    columns : mapping
        Node -> index of its torque among the inputs, and its sign there; torques on other nodes have no effect.
    """
    values = np.zeros((len(shares.labels), *gains[:, lines, :, 0].shape), dtype=complex)
    for number, (node, torque) in enumerate(zip(shares.nodes, shares.amplitudes, strict=True)):
        if node in columns:
            column, sign = columns[node]
            # X = H T of one torque on one node.
            values[number] = sign * gains[:, lines, :, column] * torque[:, :, None]
    return Contributions(excitation, shares.labels, lines, values, shares.parts)


def worst_case(
    nominal: OrderResponse, alternatives: Sequence[Contributions], scatter: Sequence[Contributions]
) -> OrderResponse:
    """Order response with the case, signs and engine angles of the largest half range, by output and speed."""
    if not alternatives and not scatter and not has_unknown_angles(nominal.lines):
        return nominal
    cases = _responses_of_combinations(nominal, alternatives)
    largest = np.zeros(nominal.values.shape)
    at_worst = {}
    for label, (case, replaced) in cases.items():
        free = [deviation.without(replaced) for deviation in scatter]
        # The largest amplitude of one line may come in another case than the largest half range of all.
        largest = np.maximum(largest, largest_amplitudes(case.values, free))
        at_worst[label] = _at_its_worst(case, free)
    worst = [case for case, _, _ in at_worst.values()]
    sizes = np.array([case.half_range for case in worst])
    same = 1 - (EQUAL_SEARCHED_HALF_RANGE if any(angles for _, _, angles in at_worst.values()) else EQUAL_HALF_RANGE)
    chosen = np.argmax(sizes >= same * sizes.max(axis=0), axis=0)  # the first of equal cases
    values = _picked([case.values.swapaxes(1, 2) for case in worst], chosen).swapaxes(1, 2)
    return WorstResponse(
        nominal.speeds,
        nominal.reference,
        worst[0].lines,
        values,
        nominal.outputs,
        nominal.title,
        labels=tuple(cases) if alternatives else (),
        chosen=chosen,
        alternatives={label: case for label, (case, _) in cases.items()},
        each=tuple(worst),
        scattered=tuple(name for deviation in scatter for name in _named(deviation, scatter)),
        signs=_picked([signs for _, signs, _ in at_worst.values()], chosen),
        largest=largest,
        angles=_picked_angles([angles for _, _, angles in at_worst.values()], chosen),
    )


def _at_its_worst(
    case: OrderResponse, scatter: Sequence[Contributions]
) -> tuple[OrderResponse, NDArray[np.int8], tuple[EngineAngle, ...]]:
    """Order response of a case with the worst deviations, their signs +1 or -1, and the worst engine angles.

    The signs are (n_speeds, n_out, n_contributions).
    """
    if not has_unknown_angles(case.lines):
        return *worst_combination(case, scatter), ()
    worst = at_worst_angles(case.values, case.lines, [(deviation.lines, deviation.values) for deviation in scatter])
    none = np.ones((len(case.speeds), len(case.outputs), 0), dtype=np.int8)
    signs = np.concatenate([none, *worst.signs], axis=2)
    return replace(case, values=worst.values, lines=worst.lines), signs, worst.angles


def _named(deviation: Contributions, among: Sequence[Contributions]) -> list[str]:
    """Labels of the torque deviations, with the name of the excitation where there are several."""
    return [label if len(among) == 1 else joined(": ", (deviation.excitation, label)) for label in deviation.labels]


def _responses_of_combinations(
    nominal: OrderResponse, alternatives: Sequence[Contributions]
) -> dict[str, tuple[OrderResponse, set[tuple[str, str]]]]:
    """Order response of every combination of one alternative per excitation, by label, and the parts it changes.

    What it changes is a set of pairs of an excitation and its part, such as a cylinder.
    """
    count = math.prod(len(alternative.labels) for alternative in alternatives)
    if count > MOST_CASES:
        names = " and ".join(alternative.excitation for alternative in alternatives)
        raise UsageError(
            f"{names} make {count} cases together, more than {MOST_CASES}; let one of them have alternatives at a time",
            kind="too-large",
        )
    named = [list(enumerate(_named(alternative, alternatives))) for alternative in alternatives]
    cases = {}
    for choice in itertools.product(*named):
        values = nominal.values.copy()
        for alternative, (number, _) in zip(alternatives, choice, strict=True):
            # Superposition: an alternative is a deviation from the nominal torques.
            values[:, alternative.lines] += alternative.values[number]
        parts = {(case.excitation, case.parts[number]) for case, (number, _) in zip(alternatives, choice, strict=True)}
        cases[joined(", ", (label for _, label in choice))] = replace(nominal, values=values), parts
    return cases


def _picked_angles(several: Sequence[tuple[EngineAngle, ...]], chosen: NDArray[np.int64]) -> tuple[EngineAngle, ...]:
    """Angle and period in rad of each engine in the worst case, each of shape (n_speeds, n_out)."""
    return tuple(
        replace(
            same[0],
            angle=_picked([angle.angle[:, :, None] for angle in same], chosen)[:, :, 0],
            period=_picked([angle.period[:, :, None] for angle in same], chosen)[:, :, 0],
        )
        for same in zip(*several, strict=True)
    )


def _picked(several: Sequence[NDArray[Entry]], chosen: NDArray[np.int64]) -> NDArray[Entry]:
    """Rows (n_speeds, n_out, n) that are each taken from the worst case's array at its speed and output."""
    return np.asarray(np.take_along_axis(np.array(several), chosen[None, :, :, None], axis=0)[0])
