"""Wheels with several gaps or with uneven lobes: where their teeth stand, as words state it, and which pulse is which.

Words are runs of even teeth, ``16 teeth, 2 missing, 10 teeth, 2 missing, 4 teeth, 2 missing``, or the angles of all
edges, ``0, 80, 180, 270 deg``. The pulses are matched with them by the intervals: over those of the wheel they change
with the speed alone, at one of its teeth as the first.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.gap_filling import filled_band

_RUNS = re.compile(r"\d+ (teeth|tooth|missing)(, *\d+ (teeth|tooth|missing))+")
_ANGLES = re.compile(r"(\d+\.?\d*)(, *\d+\.?\d*)+ *deg")
_NUMBERS_AND_WORDS = re.compile(
    r"[\d.]+ *([,;°]|\s|teeth|tooth|missing|deg)([\d.,;°\s]|teeth|tooth|missing|deg(rees)?)*"
)
MOST_PLACES, NEAREST_PLACE = 720, 0.2
"""Most even places of a turn on which uneven edges are put, and how near to its place an edge has to be, in places."""
COMPARED_TURNS = 8
"""Turns whose intervals tell which tooth comes first."""
LEAST_LEAD = 2.0
"""Least ratio of the scatter of intervals at the second best first tooth to that at the best."""
LARGEST_CHANGE = 1.5
"""Largest ratio of neighbouring intervals, each over that of its teeth, that a change of speed may make."""
FEWEST_TURNS, MOST_LOBES = 5, 24
"""Fewest turns, and most teeth, of which a pattern is guessed for a question."""
SAME_SHARE, UNEVEN = 0.03, 0.2
"""Largest mean change of an interval's share from turn to turn, and least range of the shares of a turn over the usual
share, of uneven teeth."""
MOSTLY_THERE = 0.75
"""Share of the places with teeth from which on the others are gaps between even teeth, which are filled."""


@dataclass(frozen=True, eq=False)
class ToothPlaces:
    """Places of the teeth of a wheel among ``count`` even places of its turn, and what they stand beyond them.

    Attributes
    ----------
    count : int
    places : (n,) int array
    offsets : (n,) array
        Places by which each tooth stands beyond its place, less than half.
    """

    count: int
    places: NDArray[np.intp]
    offsets: FloatArray

    @property
    def widest(self) -> int:
        """Places without a tooth in the widest gap."""
        return int(np.diff(self.places, append=self.places[0] + self.count).max()) - 1

    @property
    def repeats(self) -> int:
        """Times that the pattern comes in a turn; from two on it does not tell which tooth is the first."""
        steps = np.diff(self.places + self.offsets, append=self.places[0] + self.offsets[0] + self.count)
        times = (n for n in range(len(steps), 1, -1) if len(steps) % n == 0)
        return next((n for n in times if np.allclose(np.roll(steps, len(steps) // n), steps, rtol=0, atol=1e-6)), 1)

    @property
    def band(self) -> float:
        """Share of half the places up to which the teeth tell orders."""
        if len(self.places) < MOSTLY_THERE * self.count:
            return 1 / (self.widest + 1)
        several = (np.diff(self.places, append=self.places[0] + self.count) > 1).sum() > 1
        return filled_band(self.widest) / (2 if several else 1)  # pulses that fill one gap are missing in another


def is_stated(text: str) -> bool:
    """Whether the words of a pattern state the teeth themselves, well or not, and are not the name of a file."""
    return bool(_NUMBERS_AND_WORDS.fullmatch(text.strip()))


def stated_places(text: str, teeth: int) -> ToothPlaces:
    """Places of the teeth of a wheel as words state them.

    Raises
    ------
    UsageError
        Other words, another number of teeth than that of the wheel, or angles that do not rise within a turn.

    Examples
    --------
    >>> stated_places("4 teeth, 2 missing, 2 teeth, 1 missing", 9).places.tolist()
    [0, 1, 2, 3, 6, 7]
    >>> lobes = stated_places("0, 80, 180, 270 deg", 4)
    >>> lobes.count, lobes.offsets.round(3).tolist()
    (4, [0.0, -0.111, 0.0, 0.0])
    """
    if _RUNS.fullmatch(text.strip()):
        runs = [(int(number), word == "missing") for number, word in re.findall(r"(\d+) (\w+)", text)]
        there = np.concatenate([np.full(number, not missing) for number, missing in runs])
        if len(there) != teeth or there.sum() < 2:
            raise UsageError(
                f"the pattern has {len(there)} places, {there.sum()} with teeth; teeth: {teeth} counts both"
            )
        places = np.flatnonzero(there)
        return ToothPlaces(teeth, places, np.zeros(len(places)))
    if not _ANGLES.fullmatch(text.strip()):
        raise UsageError(
            f"{text!r} is neither runs of teeth, as '16 teeth, 2 missing, 10 teeth, 2 missing', nor angles, as "
            "'0, 80, 180, 270 deg'"
        )
    turns = np.array([float(angle) for angle in re.findall(r"[\d.]+", text)]) / 360
    if len(turns) != teeth or (np.diff(turns) <= 0).any() or turns[-1] - turns[0] >= 1:
        raise UsageError(f"the pattern has {len(turns)} angles, for {teeth} teeth; they have to rise within one turn")
    turns -= turns[0]
    for count in range(teeth, MOST_PLACES + 1):
        places = np.rint(turns * count).astype(np.intp)
        offsets = turns * count - places
        if (np.diff(places) > 0).all() and np.abs(offsets).max() <= NEAREST_PLACE:
            return ToothPlaces(count, places, offsets)
    raise UsageError(f"edges of the pattern are nearer than {360 / MOST_PLACES:g} degrees")


def runs_in_words(gaps: Iterable[tuple[int, int]], teeth: int) -> str:
    """Words on the runs of teeth and gaps of a wheel, each gap as the tooth before it and how many are missing.

    >>> runs_in_words([(15, 2), (27, 2), (33, 2)], 36)
    '16 teeth, 2 missing, 10 teeth, 2 missing, 4 teeth, 2 missing'
    """
    runs, behind = [], 0
    for after, missing in sorted(gaps):
        runs.append((after - behind, missing))
        behind = after + missing
    runs[0] = (runs[0][0] + teeth - behind, runs[0][1])
    return ", ".join(f"{count} teeth, {missing} missing" for count, missing in runs)


def lobes_in_words(times: FloatArray, teeth: int) -> str:
    """Question after the angles of the lobes of a wheel where intervals return each turn, for an error; else empty."""
    turns = (len(times) - 1) // teeth
    if turns < FEWEST_TURNS or not 2 <= teeth <= MOST_LOBES:
        return ""
    each = np.diff(times)[: turns * teeth].reshape(turns, teeth)
    shares = each / each.sum(axis=1, keepdims=True)
    usual = np.median(shares, axis=0)
    if np.abs(shares / usual - 1).mean() > SAME_SHARE or np.ptp(usual * teeth) < UNEVEN:
        return ""
    angles = ", ".join(f"{angle:.3g}" for angle in 360 * np.cumsum(np.r_[0, usual[:-1]]))
    return f"; the intervals return every {teeth} pulses: if the teeth stand so, state pattern: {angles} deg"


def matched_pulses(times: FloatArray, teeth: ToothPlaces) -> tuple[NDArray[np.intp], FloatArray]:
    """Place of each pulse of a wheel, counted on from turn to turn, and what it stands beyond it, each (n,).

    Raises
    ------
    UsageError
        No tooth fits as the first, or a pulse is lost or too many.
    """
    count = len(teeth.places)
    turns = (teeth.places + teeth.offsets) / teeth.count
    steps = np.log(np.diff(turns, append=turns[0] + 1))
    intervals = np.log(np.diff(times))
    compared = intervals[: COMPARED_TURNS * count]
    if len(compared) < 2 * count:
        raise UsageError(f"{len(times)} pulses are too few to match a pattern of {count} teeth")
    tooth = np.arange(len(compared))
    firsts = range(count // teeth.repeats)
    changes = (np.abs(np.diff(compared - steps[(tooth + first) % count])) for first in firsts)
    scatter, largest = np.array([(change.mean(), change.max()) for change in changes]).T
    first = int(scatter.argmin())
    own, others = scatter[first], np.delete(scatter, first)
    fitting = (largest <= np.log(LARGEST_CHANGE)).sum()
    if fitting != 1 and others.min(initial=np.inf) < LEAST_LEAD * own:
        raise UsageError(
            f"the pulses do not tell which tooth of the pattern comes first: intervals over those of the teeth "
            f"scatter by {100 * own:.2g} % with tooth {first} and {100 * others.min():.2g} % with another; is it the "
            "pattern of this wheel?"
        )
    tooth = np.arange(len(times)) + first
    change = np.abs(np.diff(intervals - steps[tooth[:-1] % count]))
    if change.max() > np.log(LARGEST_CHANGE):
        at = int(np.argmax(change > np.log(LARGEST_CHANGE))) + 1
        raise UsageError(
            f"from pulse {at} at {times[at]:.6g} s on the pulses do not follow the pattern: one is lost or too "
            "many; cut the record there"
        )
    return tooth // count * teeth.count + teeth.places[tooth % count], teeth.offsets[tooth % count]
