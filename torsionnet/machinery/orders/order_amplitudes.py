"""Amplitudes of the orders behind a judged value over speed, in the case of excitation to which that value belongs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.machinery.orders.order_line import lines_of_one_frequency, sum_name
from torsionnet.machinery.orders.order_response import OrderResponse, half_ranges_of
from torsionnet.machinery.orders.worst_response import WorstResponse

CaseIndices: TypeAlias = NDArray[np.int64]
"""Index of a case of excitation at each speed."""


@dataclass(frozen=True, eq=False)
class OrderAmplitudes:
    """Amplitudes of every order of a value over speed, in SI units of that value.

    Attributes
    ----------
    largest : (n_speeds, n_lines) array
        Largest amplitude of each order in any case of excitation, each for itself.
    phasors : (n_speeds, n_lines) complex array
        Complex amplitudes of all orders in one case, that of the largest half range at each speed. Their sum over a
        cycle has this half range.
    cases : (n_speeds,) array of int
        Index of that case among the cases of the response; 0 where there is one only.
    """

    largest: FloatArray
    phasors: ComplexArray
    cases: CaseIndices

    @classmethod
    def of(cls, run: OrderResponse, places: Sequence[int]) -> OrderAmplitudes:
        """Amplitudes of some outputs of a response by their indices: at each speed those of the largest half range."""
        speeds = np.arange(len(run.speeds))
        most = np.asarray(places)[np.argmax(half_ranges_of(run, places), axis=1)]
        cases = run.chosen[speeds, most] if isinstance(run, WorstResponse) else np.zeros(len(speeds), dtype=np.int64)
        return cls(run.sizes[:, :, places].max(axis=2), run.values[speeds, :, most], cases)

    def times(self, factor: float | FloatArray) -> OrderAmplitudes:
        """Amplitudes multiplied by a factor, one for all or one by speed and order, (n_speeds, n_lines)."""
        return OrderAmplitudes(self.largest * factor, self.phasors * factor, self.cases)

    @classmethod
    def joined(cls, parts: Sequence[OrderAmplitudes], order: NDArray[np.intp]) -> OrderAmplitudes:
        """Amplitudes at the speeds of several parts; ``order`` sorts their concatenated speeds."""
        return cls(
            np.concatenate([part.largest for part in parts])[order],
            np.concatenate([part.phasors for part in parts])[order],
            np.concatenate([part.cases for part in parts])[order],
        )


@dataclass(frozen=True)
class SummedOrder:
    """Order as a test measures it, the sum of all lines of one frequency, and the lines that it is the sum of.

    Attributes
    ----------
    name : str
        As ``engine 4 + screw 4``.
    places : tuple of int
        Indices of its lines among all lines.
    """

    name: str
    places: tuple[int, ...]


def summed_orders(run: OrderResponse) -> tuple[SummedOrder, ...]:
    """Orders of a response as a test measures them, one for every frequency.

    Examples
    --------
    >>> import torsionnet as tn
    >>> ship = tn.load("bulk_carrier").configured("normal")
    >>> run = ship.order_response("torque(tail)", speeds=[8])
    >>> [line.name for line in summed_orders(run) if len(line.places) > 1]
    ['engine 4 + screw 4']
    """
    return tuple(
        SummedOrder(sum_name([run.lines[place] for place in places]), tuple(places))
        for places in lines_of_one_frequency(run.lines)
    )
