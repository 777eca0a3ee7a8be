"""Peaks of single orders at critical speeds that matter for limits, each order in the worst of all conditions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.machinery.criticals.critical_speeds import CriticalSpeeds
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_conclusion import WorstLimit
from torsionnet.machinery.verdicts.order_peaks import LEAST_SHARE, OrderPeak, order_peaks, order_shares

SAME_SHARE = 0.05
"""Relative difference of an order's shares of a limit in two conditions up to which one condition stands for both: a
smaller value spreads the orders over conditions that hardly differ."""

LITTLE_DAMPING = 0.005
"""Damping ratio, a magnifier of 100, below which a governing value at a resonance is said to depend on it. What models
leave out, such as friction in the steel of shafts and in joints, makes about a tenth of a per cent; below five times as
much it changes the peak by more than a fifth."""
LEAST_USE = 0.5
"""Utilisation from which on that is said: below it the limit still holds with half the damping."""
SAME_PLACE = 0.01
"""Relative difference up to which the peak of an order and the worst speed of a limit count as one resonance."""


@dataclass(frozen=True, eq=False)
class GoverningPeaks:
    """Peaks at critical speeds where one order uses at least a given share of a limit, each in its worst condition.

    Attributes
    ----------
    peaks : tuple of OrderPeak
        By condition in the order of the checks, then by mode and speed.
    others : tuple of str
        Names of the orders that use less of every limit in all conditions and at all speeds.
    """

    peaks: tuple[OrderPeak, ...]
    others: tuple[str, ...]


def governing_peaks(
    checks: Sequence[LimitCheck],
    critical_speeds: Callable[[LimitCheck, Sequence[str]], CriticalSpeeds],
    least: float = LEAST_SHARE,
) -> GoverningPeaks:
    """Peaks at critical speeds where one order uses at least the share ``least`` of a limit, in its worst condition.

    Conditions with a misfiring cylinder are looked at for themselves, for orders that are larger there.
    Critical speeds are asked for only in those
    conditions in which some order is worst, and only of these orders.

    Parameters
    ----------
    checks : sequence of LimitCheck
        One for each condition.
    critical_speeds : callable
        Gives the critical speeds of some order lines, by name, in the condition of a check.
    least : float
        Smallest amplitude of an order over the value allowed.

    Examples
    --------
    >>> import torsionnet as tn
    >>> ship = tn.load("bulk_carrier").configured("normal")
    >>> found = governing_peaks([ship.check_limits()], lambda check, lines: ship.critical_speeds(lines=lines))
    >>> [(line_name(one), round(one.rpm)) for one in found.peaks], len(found.others)
    ([('engine 6', 51), ('screw 4', 76), ('engine 4', 77), ('engine 3', 102)], 12)
    """
    normal, misfiring = ([place for place, one in enumerate(checks) if one.misfiring is way] for way in (False, True))
    wanted: dict[int, list[str]] = {}
    known: dict[str, float] = {}
    for places in (normal, misfiring):
        for line, (share, place) in _worst_conditions([checks[one] for one in places], least).items():
            if share > (1 + SAME_SHARE) * known.get(line, 0.0):
                wanted.setdefault(places[place], []).append(line)
            known.setdefault(line, share)
    kept: list[OrderPeak] = []
    for place, lines in sorted(wanted.items()):
        peaks = [one for one in order_peaks(checks[place], critical_speeds(checks[place], lines)) if one.share >= least]
        kept += sorted(peaks, key=lambda one: (one.critical.mode.number, one.rpm))
    felt = {line for lines in wanted.values() for line in lines}
    every = dict.fromkeys(line for check in checks for line in check.lines)
    return GoverningPeaks(tuple(kept), tuple(line for line in every if line not in felt))


def little_damped(worst: Sequence[WorstLimit], peaks: Sequence[OrderPeak]) -> tuple[tuple[WorstLimit, OrderPeak], ...]:
    """Limits whose worst speed is at a resonance with a damping ratio below ``LITTLE_DAMPING``, each with that peak.

    Limits used by less than ``LEAST_USE`` are left out. The order that is in resonance uses a tenth of the limit or
    more, as all of ``peaks`` do, in any condition.
    """
    found = []
    for one in worst:
        there = [
            peak
            for peak in peaks
            if (peak.verdict.limit, peak.verdict.criterion) == (one.verdict.limit, one.verdict.criterion)
            and one.rpm is not None
            and (one.utilisation or 0.0) >= LEAST_USE
            and abs(peak.rpm / one.rpm - 1) <= SAME_PLACE
            and 0 <= peak.critical.mode.damping_ratio < LITTLE_DAMPING
        ]
        if there:
            found.append((one, max(there, key=lambda peak: peak.share)))
    return tuple(found)


def line_name(peak: OrderPeak) -> str:
    """Name of the excitation and the order of a peak, such as ``engine 6``, as in the check of limits."""
    return f"{peak.critical.excitation} {peak.critical.line}"


def _worst_conditions(checks: Sequence[LimitCheck], least: float) -> dict[str, tuple[float, int]]:
    """Largest share of a limit and index of the condition with it, by name of the order, where at least ``least``.

    Conditions taken for a larger order are taken again where they are as bad within ``SAME_SHARE``.
    """
    shares: dict[str, dict[int, float]] = {}
    for place, check in enumerate(checks):
        for line, share in zip(check.lines, np.nan_to_num(order_shares(check)).tolist(), strict=True):
            shares.setdefault(line, {})[place] = share
    largest = {line: max(by_place.values()) for line, by_place in shares.items()}
    taken: list[int] = []
    found: dict[str, tuple[float, int]] = {}
    for line in sorted(largest, key=lambda name: -largest[name]):
        if largest[line] < least:
            break
        alike = [place for place, share in shares[line].items() if share >= (1 - SAME_SHARE) * largest[line]]
        known = [place for place in taken if place in alike]
        place = known[0] if known else max(alike, key=lambda one: shares[line][one])
        taken += [] if known else [place]
        found[line] = (largest[line], place)
    return found
