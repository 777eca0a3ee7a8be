"""Orders of different shafts that cross within a record: where, and what the intervals of filters do not know there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from torsionnet.base.errors import comma_list
from torsionnet.signals.orders.mean_rotation import MeanRotation
from torsionnet.signals.recording import FloatArray

MOST_LISTED = 3
"""Most crossings that are named, so that the note stays short."""
LEAST_APART = 1e-6
"""Share of a frequency below which two orders run together, apart by rounding, and do not cross."""


def crossing_notes(shafts: Sequence[tuple[MeanRotation, FloatArray]], times: FloatArray) -> tuple[str, ...]:
    """Note on the orders of different shafts that cross at times in s, or none where they do not.

    While two orders are closer than the bandwidth, the signal does not say how they share it: a filter continues what
    was before and after. Its own envelopes are as smooth as it allows, so that they do not show what it missed where an
    amplitude changes within the crossing. A filter that is wider than the square root of the rate at which the two
    frequencies part has a memory shorter than the crossing.
    """
    found, rates = [], []
    for number, (first, own) in enumerate(shafts):
        for second, other in shafts[number + 1 :]:
            here, there = first.speed(times) / (2 * np.pi), second.speed(times) / (2 * np.pi)
            for one in own:
                for two in other:
                    apart = one * here - two * there
                    if np.abs(apart).max() < LEAST_APART * np.abs(one * here).max():
                        continue
                    above = apart >= 0
                    for at in np.flatnonzero(above[1:] != above[:-1]):
                        share = apart[at] / (apart[at] - apart[at + 1])
                        time = times[at] + share * (times[at + 1] - times[at])
                        rates.append(abs((apart[at + 1] - apart[at]) / (times[at + 1] - times[at])))
                        found.append(f"{one:g} of {first.name} and {two:g} of {second.name} at {time:.4g} s")
    if not found:
        return ()
    return (
        f"orders cross: {comma_list(found, MOST_LISTED)}; where an amplitude changes within a crossing, as in a "
        "resonance, its interval is too narrow, the more so above a bandwidth of "
        f"{np.sqrt(min(rates)):.2g} Hz, the square root of the rate at which the frequencies part",
    )
