"""Entries of a toothed wheel or encoder that is read by its pulses.

Wheels with several gaps or with uneven lobes: where their teeth stand, as words state it, and which pulse is which.
Words are runs of even teeth, ``16 teeth, 2 missing, 10 teeth, 2 missing, 4 teeth, 2 missing``, or the angles of all
edges, ``0, 80, 180, 270 deg``. The pulses are matched with them by the intervals: over those of the wheel they change
with the speed alone, at one of its teeth as the first.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, Flag, Text, entry
from torsionnet.base.errors import Fault, UsageError
from torsionnet.base.result_rows import Out
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.bandlimited import filled_band
from torsionnet.signals.recording import FloatArray

# Wheels with several gaps or with uneven lobes: where their teeth stand, as words state it, and which pulse is which.

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
                f"the pattern has {len(there)} places, {there.sum()} with teeth; teeth: {teeth} counts both",
                kind="wrong-count",
            )
        places = np.flatnonzero(there)
        return ToothPlaces(teeth, places, np.zeros(len(places)))
    if not _ANGLES.fullmatch(text.strip()):
        raise UsageError(
            f"{text!r} is neither runs of teeth, as '16 teeth, 2 missing, 10 teeth, 2 missing', nor angles, as "
            "'0, 80, 180, 270 deg'",
            kind="wrong-form",
        )
    turns = np.array([float(angle) for angle in re.findall(r"[\d.]+", text)]) / 360
    if len(turns) != teeth or (np.diff(turns) <= 0).any() or turns[-1] - turns[0] >= 1:
        raise UsageError(
            f"the pattern has {len(turns)} angles, for {teeth} teeth; they have to rise within one turn",
            kind="wrong-count",
        )
    turns -= turns[0]
    # The fewest even places of a turn on which each edge nearly falls.
    for count in range(teeth, MOST_PLACES + 1):
        places = np.rint(turns * count).astype(np.intp)
        offsets = turns * count - places
        if (np.diff(places) > 0).all() and np.abs(offsets).max() <= NEAREST_PLACE:
            return ToothPlaces(count, places, offsets)
    raise UsageError(f"edges of the pattern are nearer than {360 / MOST_PLACES:g} degrees", kind="out-of-range")


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
    # Shares of the turn: a change of speed from turn to turn drops out.
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
    # log(interval) = log(pitch) - log(speed): less that of the right tooth, only the speed's slow change is left.
    steps = np.log(np.diff(turns, append=turns[0] + 1))
    intervals = np.log(np.diff(times))
    compared = intervals[: COMPARED_TURNS * count]
    if len(compared) < 2 * count:
        raise UsageError(f"{len(times)} pulses are too few to match a pattern of {count} teeth", kind="too-short")
    tooth = np.arange(len(compared))
    # A pattern that repeats within a turn is the same from each repetition on: only its own teeth are tried.
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
            "pattern of this wheel?",
            kind="ambiguous-tooth",
        )
    # By that tooth through the whole record: a jump is a pulse that is lost or too many.
    tooth = np.arange(len(times)) + first
    change = np.abs(np.diff(intervals - steps[tooth[:-1] % count]))
    if change.max() > np.log(LARGEST_CHANGE):
        at = int(np.argmax(change > np.log(LARGEST_CHANGE))) + 1
        raise UsageError(
            f"from pulse {at} at {times[at]:.6g} s on the pulses do not follow the pattern: one is lost or too "
            "many; cut the record there",
            kind="lost-pulses",
        )
    return tooth // count * teeth.count + teeth.places[tooth % count], teeth.offsets[tooth % count]


@dataclass(frozen=True, kw_only=True)
class Wheel(Declared):
    """A toothed wheel or an encoder, as its pulses are read.

    Examples
    --------
    >>> Wheel(teeth=60, missing_teeth=2).teeth
    60
    """

    kind: ClassVar[str] = "wheel"
    article: ClassVar[str] = "a wheel"

    teeth: int = entry(Count("pulses per revolution of the wheel, missing ones included", lower=1, upper=10_000_000))
    missing_teeth: int = entry(Count("teeth that the gap lacks, as 2 of a wheel 60-2", lower=0), 0)
    ratio: float = entry(Value("turns of the reference shaft per turn of the wheel", "1", exclusive=True), 1.0)
    reversed: bool = entry(Flag("whether the wheel turns against the sense of the model"), False)
    pattern: str = entry(
        Text("file of its pitch pattern, from the folder of this file; or where its teeth stand: "
             "4 teeth, 2 missing, 2 teeth, 1 missing; or 0, 80, 180, 270 deg"), "",
    )  # fmt: skip

    def contradictions(self) -> list[Fault]:
        if self.missing_teeth and self.missing_teeth >= self.teeth - 1:
            return [
                Fault(
                    f"a wheel of {self.teeth} teeth cannot lack {self.missing_teeth}",
                    ("missing_teeth",),
                    kind="contradicting-values",
                )
            ]
        try:
            stated = self.stated
        except UsageError as error:
            return [error.fault.under("pattern")]
        if stated and self.missing_teeth:
            return [
                Fault(
                    "the pattern states the gaps already; leave missing_teeth out",
                    ("missing_teeth",),
                    kind="contradicting-entries",
                )
            ]
        return []

    @property
    def stated(self) -> ToothPlaces | None:
        """Places of the teeth of the wheel where its pattern states them and they are not even."""
        places = stated_places(self.pattern, self.teeth) if is_stated(self.pattern) else None
        return None if places is None or places.repeats == places.count else places

    @property
    def pattern_file(self) -> str:
        """File of the wheel's pitch pattern; empty where there is none."""
        return "" if is_stated(self.pattern) else self.pattern

    @property
    def shows_tooth_0(self) -> bool:
        """Whether the wheel itself tells which tooth is 0, by its gap or by the pattern stated."""
        stated = self.stated
        return self.missing_teeth > 0 or (stated is not None and stated.repeats == 1)


# Pitch pattern of a toothed wheel: by how much each tooth stands beyond its place.


@dataclass(frozen=True, eq=False)
class WheelPattern:
    """Angle in rad by which the edge of each tooth stands beyond its place on a wheel of even pitch.

    Tooth 0 is the first after the gap of a wheel with missing teeth, else the one named in ``first``. A pulse of
    tooth k comes at the wheel's angle 2 pi k/teeth + positions[k], teeth that are missing included.

    Attributes
    ----------
    positions : (teeth,) array
        rad, of mean 0; of missing teeth 0.
    half_widths : (teeth,) array
        Half width of the 95 % interval of each position, rad.
    missing : int
        Teeth that the gap lacks, the last ones of a turn.
    name : str
        Wheel, with machine and date.
    first : str
        Which tooth is 0, in words.
    unresolved : tuple of int
        Whole orders whose share of the pattern the calibration could not tell from vibration.
    notes : tuple of str
        From which records, by which method.
    reversed : bool
        Whether it was calibrated while the wheel turned against the sense of the model: a pickup then sees the other
        edges of the teeth, in the other sequence.

    Raises
    ------
    UsageError
        There are fewer than two teeth, or the two arrays differ in length.

    Examples
    --------
    >>> wheel = WheelPattern(np.radians(0.05) * np.cos(2 * np.pi * np.arange(60) / 60), np.zeros(60))
    >>> float(np.degrees(abs(wheel.order(1))).round(6)), wheel.teeth
    (0.05, 60)
    """

    positions: Annotated[FloatArray, Out(json="positions_rad")]
    half_widths: Annotated[FloatArray, Out(json="half_widths_rad")]
    missing: Annotated[int, Out(json="missing_teeth")] = 0
    name: str = ""
    first: Annotated[str, Out(json="first_tooth")] = ""
    unresolved: tuple[int, ...] = ()
    notes: tuple[str, ...] = ()
    reversed: bool = False

    def __post_init__(self) -> None:
        if len(self.positions) < 2 or len(self.positions) != len(self.half_widths):
            raise UsageError(
                "a pattern has a position and a half width for each tooth, two teeth or more", kind="wrong-form"
            )

    @property
    def teeth(self) -> int:
        """Number of teeth of the wheel, missing ones included."""
        return len(self.positions)

    def order(self, order: int) -> complex:
        """Complex peak amplitude in rad that the pattern adds to a whole order of the angle, X of Re X exp(j o phi).

        An edge that stands beyond its place comes late, so the angle read there is too small: X is minus the
        amplitude of the positions.
        """
        turning = np.exp(-2j * np.pi * order * np.arange(self.teeth) / self.teeth)
        lines: ComplexArray = self.positions * turning
        mean = complex(lines.mean())
        # At order 0 and half the tooth count a line stands once, else twice with its conjugate.
        if order % self.teeth in (0, self.teeth / 2):
            return complex(-mean.real, 0)  # real but for rounding, which would be read as a phase
        return -2 * mean
