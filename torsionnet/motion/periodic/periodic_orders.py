"""Order response of machinery whose laws of motion act in full: of all periodic motions the largest that can be met.

Several motions may be stable at one speed; which of them is met depends on where the machine comes from. A result that
has one value at a speed, as those of orders and limits, takes for every output the motion of largest half range among
the stable ones, and tells where sweeps jump.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.machinery.orders.order_line import SUM_SEPARATOR, OrderLine
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.model.channels import Channels
from torsionnet.motion.periodic.forcing import order_request
from torsionnet.motion.periodic.periodic_response import AROUND, periodic_response
from torsionnet.motion.periodic.periodic_result import FoundMotion, PeriodicResponse

SUBHARMONICS = 4
"""Most periods of the torques after which motions repeat whose orders are looked for."""
EDGE = 0.01
"""Distance from the unit circle of a multiplier that passes it, at a place that is located."""
SMALLEST_ORDER = 1e-6
"""Amplitude of an order, over the largest half range of its output, below which it is left out."""
TAKEN = "laws of motion in full: at every speed the largest motion of each output that is stable"
"""Text of the note on the motions whose orders an order response holds."""
BETWEEN = "between the speeds given those are added at which branches of motions turn or outputs have a peak"
"""Text of the note on the speeds that are added to those of a range."""
UNMET = "{where} no motion found is stable: the values there are of one that is not met"
"""Text of the note on the speeds at which the motion of an order response is not stable."""
OPEN = "{where} it is not determined whether the largest motion is stable"
"""Text of the note on the speeds at which the motion of an order response may not be stable."""


@dataclass(frozen=True, eq=False, repr=False)
class PeriodicOrders(OrderResponse):
    """Orders of periodic motion over speed, at every speed and output those of the largest motion that is stable.

    Lines are orders of the reference shaft, of all excitations together, also those that the motion alone has. Half
    ranges are those of the motions, not of the orders kept.

    Attributes
    ----------
    motions : PeriodicResponse
        All motions found, their stability, and where sweeps jump.
    """

    motions: PeriodicResponse = field(kw_only=True)

    @cached_property
    def taken(self) -> tuple[tuple[FoundMotion, ...], ...]:
        """Motion of every output, speed by speed."""
        places = range(len(self.outputs))
        return tuple(tuple(largest_met(self.motions, at, place) for place in places) for at in self.speeds.tolist())

    @cached_property
    def _known_bounds(self) -> dict[int, FloatArray]:
        half_ranges = np.zeros((2, len(self.speeds), len(self.outputs)))
        for number, row in enumerate(self.taken):
            for place, motion in enumerate(row):
                mean = motion.amplitudes[0, place].real
                half_ranges[:, number, place] = motion.highest[place] - mean, motion.lowest[place] - mean
        return dict(enumerate(np.moveaxis(half_ranges, 2, 0)))

    @property
    def open_notes(self) -> tuple[str, ...]:
        """Notes on speeds at which the motions taken are not stable, or may not be."""
        return tuple(unsettled(self.speeds, self.taken))

    @property
    def unmet(self) -> NDArray[np.bool_]:
        return np.array([any(_stable(motion) is False for motion in row) for row in self.taken])


def periodic_orders(
    drivetrain: AssembledModel,
    output: Channels,
    *,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitation: str | Iterable[str] | None = None,
    between: bool = False,
) -> PeriodicOrders:
    """Orders of the periodic motions of a drivetrain over speed, its laws of motion in full.

    Parameters
    ----------
    output, speeds, speed_of, excitation
        As for :meth:`order_response`.
    between : bool
        Whether those speeds between are added at which branches end, turn or have peaks: there a value is largest.

    Raises
    ------
    UsageError
        As for :meth:`order_response` and :meth:`periodic_response`; excitations with several cases.
    SolveError
        No periodic motion was found at a speed.
    """
    names = excitation if excitation is None or isinstance(excitation, str) else tuple(excitation)
    request = order_request(drivetrain, speeds, speed_of, names)
    at = np.unique(request.speeds)
    searched = _searched(drivetrain, request.reference, at)

    def found_at(those: FloatArray) -> PeriodicResponse:
        return periodic_response(
            drivetrain, output, speeds=np.concatenate([those, searched]), speed_of=request.reference,
            excitation=names, subharmonics=SUBHARMONICS,
        )  # fmt: skip

    response = found_at(at)
    turns = (*response.turns(), *response.peaks)
    turned = np.array([turn.at for turn in turns if between and at[0] < turn.at < at[-1]])
    if len(turned):
        at = np.unique(np.concatenate([at, turned]))
        response = found_at(at)
    taken = [[largest_met(response, speed, place) for place in range(len(response.outputs))] for speed in at.tolist()]
    lines, values = _orders(response, taken, SUM_SEPARATOR.join(request.excitations))
    notes = (TAKEN, *([BETWEEN] if between else []), *response.jump_sentences, *unsettled(at, taken), *response.notes)
    return PeriodicOrders(
        at, request.reference, lines, values, response.outputs, response.title, notes=notes, motions=response,
    )  # fmt: skip


def largest_met(response: PeriodicResponse, at: float, place: int) -> FoundMotion:
    """Motion at a speed in rad/s with the largest half range of an output that is stable, or may be.

    A motion on the edge counts as stable, as the end of those that are. Where none is stable it is the largest of all.

    Raises
    ------
    UsageError
        No motion was found at this speed.
    """
    here = [motion for motion in response.motions if math.isclose(motion.at, at, rel_tol=1e-9)]
    if not here:
        text = "no periodic motion was found; simulate shows what happens there"
        raise UsageError(f"at {response.shown(at):.6g} {response.unit} {text}", kind="no-period")
    met = [motion for motion in here if _stable(motion) is not False] or here
    return max(met, key=lambda motion: float(motion.highest[place] - motion.lowest[place]))


def _stable(motion: FoundMotion) -> bool | None:
    if motion.on_edge:
        return bool((np.abs(motion.multipliers) < 1 + EDGE).all())
    return motion.is_stable


def _searched(drivetrain: AssembledModel, reference: str, at: FloatArray) -> FloatArray:
    """Ends in rad/s of the speeds over which branches are followed: those of the model, that all calls share."""
    given = drivetrain.definition.speeds
    if given is not None and given.of == reference:
        return np.array([min(at[0], *given.values), max(at[-1], *given.values)])
    return at[[0, -1]] if len(at) > 1 else at[0] * np.array(AROUND)


def _orders(
    response: PeriodicResponse, taken: Sequence[Sequence[FoundMotion]], name: str
) -> tuple[tuple[OrderLine, ...], ComplexArray]:
    """Order lines of motions, and amplitudes (n_speeds, n_lines, n_out): of doubled motions half orders, too."""
    motions = [motion for row in taken for motion in row]
    periods = math.lcm(*(motion.periods for motion in motions))
    count = max((len(motion.amplitudes) - 1) * periods // motion.periods for motion in motions)
    values = np.zeros((len(taken), count, len(response.outputs)), dtype=complex)
    sizes = np.zeros(len(response.outputs))
    for number, row in enumerate(taken):
        for place, motion in enumerate(row):
            # Harmonic k of a motion of p periods is harmonic k P/p of P periods.
            each = periods // motion.periods
            values[number, each - 1 : (len(motion.amplitudes) - 1) * each : each, place] = motion.amplitudes[1:, place]
            sizes[place] = max(sizes[place], response.peak_to_peak(motion, response.outputs[place].name) / 2)
    kept = (np.abs(values) > SMALLEST_ORDER * sizes).any(axis=(0, 2))
    base = Fraction(response.order).limit_denominator(10**6) / periods
    lines = tuple(OrderLine(name, float(base * (number + 1)), Fraction(1)) for number in np.flatnonzero(kept).tolist())
    return lines, values[:, kept]


def unsettled(at: FloatArray, taken: Sequence[Sequence[FoundMotion]]) -> Iterator[str]:
    """Sentences on speeds at which the motion taken is unstable, or its stability is not determined."""
    states = [{_stable(motion) for motion in row} for row in taken]
    for state, text in ((False, UNMET), (None, OPEN)):
        speeds = at[[state in each for each in states]] * RPM
        if len(speeds):
            at_one, several = "at {at:.6g} rpm", "from {low:.6g} to {high:.6g} rpm"
            where = phrase(several, low=speeds[0], high=speeds[-1]) if len(speeds) > 1 else phrase(at_one, at=speeds[0])
            yield phrase(text, where=where)
