"""Vibration in the worst of several cases of excitation, such as misfires, from one solution by superposition.

A misfire of each cylinder, gas torques that differ by some per cent, engines at any angle to each other: only torques
of single cylinders or their phases change, and the response is linear in them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.machinery.excitations import TorqueShares
from torsionnet.machinery.orders.engine_angles import EngineAngle, at_worst_angles
from torsionnet.machinery.orders.engine_blocks import has_unknown_angles
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.worst_combination import Contributions, largest_amplitudes, worst_combination
from torsionnet.machinery.orders.worst_response import EQUAL_HALF_RANGE, EQUAL_SEARCHED_HALF_RANGE, WorstResponse

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
            values[number] = sign * gains[:, lines, :, column] * torque[:, :, None]
    return Contributions(excitation, shares.labels, lines, values, shares.parts)


def worst_case(
    nominal: OrderResponse, alternatives: Sequence[Contributions], scatter: Sequence[Contributions]
) -> OrderResponse:
    """Order response with the case, signs and engine angles of the largest half range, by output and speed."""
    if not alternatives and not scatter and not has_unknown_angles(nominal.lines):
        return nominal
    cases = _cases(nominal, alternatives)
    largest = np.zeros(nominal.values.shape)
    found = {}
    for label, (case, replaced) in cases.items():
        free = [one.without(replaced) for one in scatter]
        largest = np.maximum(largest, largest_amplitudes(case.values, free))
        found[label] = _at_its_worst(case, free)
    worst = [case for case, _, _ in found.values()]
    sizes = np.array([case.half_range for case in worst])
    same = 1 - (EQUAL_SEARCHED_HALF_RANGE if any(angles for _, _, angles in found.values()) else EQUAL_HALF_RANGE)
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
        scattered=tuple(name for one in scatter for name in _named(one, scatter)),
        signs=_picked([signs for _, signs, _ in found.values()], chosen),
        largest=largest,
        angles=_picked_angles([angles for _, _, angles in found.values()], chosen),
    )


def _at_its_worst(
    case: OrderResponse, scatter: Sequence[Contributions]
) -> tuple[OrderResponse, NDArray[np.int8], tuple[EngineAngle, ...]]:
    """Order response of a case with the worst deviations, their signs +1 or -1, and the worst engine angles.

    The signs are (n_speeds, n_out, n_contributions).
    """
    if not has_unknown_angles(case.lines):
        return *worst_combination(case, scatter), ()
    found = at_worst_angles(case.values, case.lines, [(one.lines, one.values) for one in scatter])
    none = np.ones((len(case.speeds), len(case.outputs), 0), dtype=np.int8)
    signs = np.concatenate([none, *found.signs], axis=2)
    return replace(case, values=found.values, lines=found.lines), signs, found.angles


def _named(one: Contributions, among: Sequence[Contributions]) -> list[str]:
    """Labels of the torque deviations, with the name of the excitation where there are several."""
    return [label if len(among) == 1 else f"{one.excitation}: {label}" for label in one.labels]


def _cases(
    nominal: OrderResponse, alternatives: Sequence[Contributions]
) -> dict[str, tuple[OrderResponse, set[tuple[str, str]]]]:
    """Order response of every combination of one alternative per excitation, by label, and the parts it changes.

    What it changes is a set of pairs of an excitation and its part, such as a cylinder.
    """
    count = math.prod(len(one.labels) for one in alternatives)
    if count > MOST_CASES:
        names = " and ".join(one.excitation for one in alternatives)
        raise UsageError(
            f"{names} make {count} cases together, more than {MOST_CASES}; let one of them have alternatives at a time"
        )
    named = [list(enumerate(_named(one, alternatives))) for one in alternatives]
    found = {}
    for choice in itertools.product(*named):
        values = nominal.values.copy()
        for one, (number, _) in zip(alternatives, choice, strict=True):
            values[:, one.lines] += one.values[number]
        parts = {(one.excitation, one.parts[number]) for one, (number, _) in zip(alternatives, choice, strict=True)}
        found[", ".join(label for _, label in choice)] = replace(nominal, values=values), parts
    return found


def _picked_angles(several: Sequence[tuple[EngineAngle, ...]], chosen: NDArray[np.int64]) -> tuple[EngineAngle, ...]:
    """Angle and period in rad of each engine in the worst case, each of shape (n_speeds, n_out)."""
    return tuple(
        replace(
            same[0],
            angle=_picked([one.angle[:, :, None] for one in same], chosen)[:, :, 0],
            period=_picked([one.period[:, :, None] for one in same], chosen)[:, :, 0],
        )
        for same in zip(*several, strict=True)
    )


def _picked(several: Sequence[NDArray[Entry]], chosen: NDArray[np.int64]) -> NDArray[Entry]:
    """Rows (n_speeds, n_out, n) that are each taken from the worst case's array at its speed and output."""
    return np.asarray(np.take_along_axis(np.array(several), chosen[None, :, :, None], axis=0)[0])
