"""Channel of a record with the pulses of a wheel and how it is read, and direction and steps of two tracks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import Fault, UsageError, did_you_mean
from torsionnet.base.notes import NoteOrText
from torsionnet.signals.encoder import HIGH_PERCENTILE, LOW_PERCENTILE, flanks, holds_pulse_times
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.counter import PulseReading
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel import Wheel

if TYPE_CHECKING:
    from torsionnet.signals.recording import Recording


# Direction and steps of an encoder with two tracks, the second a quarter pitch further than the first.

EDGES = 4
"""Number of edges of two tracks in a pitch: forwards the first rises, the second rises, the first falls, the second
falls."""

LEAST_APART = 0.03
"""Least share of a pitch, by median, from an edge of one track to that of the other, nominally a quarter; below it
jitter exchanges the two."""


@dataclass(frozen=True, eq=False)
class DirectedPulses(PulseChannel):
    """Pulses of an encoder whose direction is known.

    Attributes
    ----------
    numbers : (n,) int array
        Pitch of each pulse; it falls while the shaft turns backwards, and is the same before and after it turns back
        between two teeth.
    """

    numbers: NDArray[np.intp] = field(default_factory=lambda: np.empty(0, np.intp))

    @property
    def turns_back(self) -> int:
        """Number of times that the shaft turns back between pulses."""
        moves = np.sign(np.diff(self.numbers))
        moves = moves[moves != 0]
        return int(np.count_nonzero(np.diff(moves)))


def quadrature_pulses(
    name: str,
    first: tuple[FloatArray, FloatArray],
    second: tuple[FloatArray, FloatArray],
    *,
    edge: str = "rising",
    notes: tuple[NoteOrText, ...] = (),
) -> DirectedPulses:
    """Pulses of the first track of an encoder with the direction that the second tells.

    In both directions a pulse is the passage of the same flank of a tooth.

    Parameters
    ----------
    name : str
        Name of the channel.
    first, second : pair of arrays
        Times in s at which a track rises, and at which it falls.
    edge : {"rising", "falling"}
        Flank of the first track that is a pulse, as it is while the shaft turns forwards.
    notes : tuple of str, optional

    Raises
    ------
    UsageError
        A track without edges, or tracks of which one changes twice before the other does most of the time.

    Examples
    --------
    >>> quarter = np.arange(12) * 0.25
    >>> pulses = quadrature_pulses("n1", (quarter[::4], quarter[2::4]), (quarter[1::4], quarter[3::4]))
    >>> pulses.times.tolist(), pulses.numbers.tolist()
    ([0.0, 1.0, 2.0], [0, 1, 2])
    """
    times = np.concatenate([first[0], second[0], first[1], second[1]])
    kinds = np.repeat(np.arange(EDGES), [len(first[0]), len(second[0]), len(first[1]), len(second[1])])
    if len(times) <= 2 * EDGES or len(np.unique(kinds)) < EDGES:
        raise UsageError(
            f"{name}: a track has no edges that rise and fall, and two tracks are needed for the direction",
            kind="missing-data",
        )
    order = np.argsort(times, kind="stable")
    times, kinds = times[order], kinds[order]
    signs = _signs(kinds)
    # A flank is that of the same tooth in both directions, but falls on the way back where it rose before.
    flanks = np.where(signs > 0, kinds, (kinds + 2) % EDGES)
    # An edge on is a step in the direction of travel; where the shaft turns back the same flank comes again, no step.
    usual = (signs[1:] + signs[:-1]) // 2
    # What goes beyond that, modulo four edges, was lost.
    lost = (signs[1:] * (np.diff(flanks) - usual)) % EDGES
    # Part of a pitch from each edge to the next, which is one of the other track.
    shares = np.diff(times)[: -EDGES + 1] / (times[EDGES:] - times[:-EDGES])
    apart = min(float(np.median(shares[kinds[: len(shares)] == kind])) for kind in range(EDGES))
    if np.count_nonzero(lost) > len(lost) // 2 or apart < LEAST_APART:
        raise UsageError(
            f"{name}: the two tracks do not change in turn: the second is not a quarter pitch further, or not of "
            "the same teeth",
            kind="unfit-wheel",
        )
    # Quarter pitches counted with their sign; whole pitches follow at one flank of the first track.
    steps = np.concatenate([[flanks[0]], usual + signs[1:] * lost]).cumsum()
    wanted = flanks == (2 if edge == "falling" else 0)
    numbers = (steps[wanted] - flanks[wanted]) // EDGES
    remarks = (f"{np.count_nonzero(lost)} lost edges of two tracks counted",) if lost.any() else ()
    return DirectedPulses(name, times[wanted], notes=(*notes, *remarks), numbers=numbers - numbers[0])


def _signs(kinds: NDArray[np.intp]) -> NDArray[np.intp]:
    """Direction at each edge, 1 or -1, from the level of the other track."""
    places = np.arange(len(kinds))
    signs = np.ones(len(kinds), dtype=np.intp)
    for track in (0, 1):
        own, other = np.flatnonzero(kinds % 2 == track), np.flatnonzero(kinds % 2 != track)
        last = np.searchsorted(other, places[own]) - 1
        # Before its first edge the other track has the level that this edge leaves.
        high = np.where(last >= 0, kinds[other[np.maximum(last, 0)]] < 2, kinds[other[0]] >= 2)
        rises = kinds[own] < 2
        # Forwards the first track rises while the second is low, and the second rises while the first is high.
        signs[own] = np.where(rises != high, 1, -1) if track == 0 else np.where(rises == high, 1, -1)
    return signs


# Standstills after which a shaft may have turned back, which the pulses of one track do not tell.

NEAR, FAR = 2, 9
"""Number of pulses from a standstill at which intervals are compared, as their growth there tells it from a change of
speed and from a gap."""
GROWTH, LAST_GROWTH = 1.7, 2.5
"""Least ratios of the intervals near and at a standstill to those far from it. At constant deceleration the former is
1.9."""
INTERVALS_TOGETHER = 2**17
"""Number of intervals that are compared together, which limits the memory."""


def refuse_turning_back(times: FloatArray, name: str) -> None:
    """Refuse pulses of a shaft that stands still in between, as it may turn back there.

    Parameters
    ----------
    times : (n,) array
        Times of the pulses, s.
    name : str
        Channel, for the message.

    Raises
    ------
    UsageError
        With the time of the standstill and what would help.
    """
    longest, place = 0.0, -1
    for begin in range(0, len(times) - 2 * FAR - 1, INTERVALS_TOGETHER):
        steps = np.diff(times[begin : begin + INTERVALS_TOGETHER + 2 * FAR + 1])
        here = steps[FAR:-FAR]
        far = np.maximum(steps[: -2 * FAR], steps[2 * FAR :])
        near = np.minimum(steps[FAR - NEAR : -FAR - NEAR], steps[FAR + NEAR : len(steps) - FAR + NEAR])
        closer = np.minimum(steps[FAR - 1 : -FAR - 1], steps[FAR + 1 : len(steps) - FAR + 1])
        # At a standstill intervals grow like 1/sqrt(pulses to it) from both sides; at a gap a single one is long.
        still = (near > GROWTH * far) & (closer >= near) & (here > LAST_GROWTH * far)
        if still.any() and here[still].max() > longest:
            at = np.flatnonzero(still)[here[still].argmax()]
            longest, place = float(here[at]), begin + FAR + int(at)
    if place >= 0:
        raise UsageError(
            f"{name}: the shaft stands still around {times[place]:.6g} s, pulse {place}: whether it turns on or back, "
            "the pulses of one track do not tell; record a second track a quarter pitch further (second:), or cut the "
            "record there",
            kind="turning-back",
        )


# Rotation of a shaft that turns back, through the pulses of an encoder with two tracks.

REVERSING_BAND = 1 / 3
"""Share of half the pulses of a turn up to which cubic splines read orders within 0.2 %."""
END_PULSES = 4
"""Number of pulses from either end on which the spline depends on what comes beyond it."""
SPLINE_DEGREE = 3
"""Degree of the splines, which follow constant acceleration through a standstill."""


class ReversingRotation:
    """Rotation of a shaft over time in encoder steps by cubic splines over time, as it has no course to be even over.

    Parameters
    ----------
    times : (n,) array
        Times of the pulses, s.
    places : (n,) array
        Steps at which they stand, from 0.
    """

    kept_band = REVERSING_BAND
    end_pulses = END_PULSES

    def __init__(self, times: FloatArray, places: FloatArray) -> None:
        from scipy.interpolate import make_interp_spline

        self.mean_rotation: Any = make_interp_spline(times, places, k=min(SPLINE_DEGREE, len(times) - 1))

    def at(self, times: FloatArray) -> FloatArray:
        """Rotation in encoder steps since the first pulse at times in s between first and last pulse, shape (n,)."""
        return np.asarray(self.mean_rotation(times), dtype=float)

    def rate(self, times: FloatArray) -> FloatArray:
        """Speed in encoder steps a second at times in s between first and last pulse, shape (n,)."""
        return np.asarray(self.mean_rotation(times, 1), dtype=float)


# Channel of a record with the pulses of a wheel: its wheel, how the channel is read, and the pulses it holds.

HEIGHT_PARTS, LEAST_EVEN_HEIGHT = 10, 0.6
"""Number of parts of a record whose heights are compared, and least ratio of the smallest to the largest of a signal
that switches; below it, its hysteresis loses pulses."""


@dataclass(frozen=True, kw_only=True)
class WheelChannel(PulseReading, Wheel):
    """A channel of pulses: the wheel that it sees, and how its values are read.

    Examples
    --------
    >>> channel = WheelChannel(teeth=60, missing_teeth=2, tick="12.5 ns", bits=32)
    >>> channel.missing_teeth, channel.seconds
    (2, 1.25e-08)
    """

    kind: ClassVar[str] = "wheel channel"
    article: ClassVar[str] = "a wheel"
    form: ClassVar[str] = "{teeth: 60, ...}"

    index: str = entry(Text("channel of an index pulse, once in a turn of the wheel or in several"), "")

    def contradictions(self) -> list[Fault]:
        return [*PulseReading.contradictions(self), *Wheel.contradictions(self)]


def wheel_pulses(recording: Recording, name: str, reading: PulseReading) -> PulseChannel:
    """Pulses of a channel of a record, from its pulse times or from the signal of the teeth, times in s.

    With a second track the pulses have a direction.

    Raises
    ------
    UsageError
        There is no such channel, or it holds no pulses.

    Examples
    --------
    >>> from torsionnet.signals.recording import Recording, Signal
    >>> teeth = np.sin(2 * np.pi * 50 * np.arange(1000) / 10e3)
    >>> record = Recording((Signal("n1", "", teeth),), sampling_rate=10e3)
    >>> len(wheel_pulses(record, "n1", PulseReading(level=0.5)))
    5
    """
    stored = {channel.name: channel for channel in recording.pulses}
    if name in stored:
        if reading.second:
            raise UsageError(
                f"{name}: the record holds times of its pulses, and {reading.second} tells the direction only where "
                "both tracks were sampled: of times the flank that falls is missing; leave second out, and cut the "
                "record where the shaft turns back",
                kind="missing-data",
            )
        return stored[name]
    if name not in recording.names:
        known = [*stored, *recording.names]
        hint = did_you_mean(name, known)
        raise UsageError(
            f'no channel is named "{name}"{hint}; there is {", ".join(known) or "none"}', kind="unknown-channel"
        )
    values, times = recording[name].values, recording.time
    if not reading.is_of_a_signal and holds_pulse_times(values):
        return PulseChannel(name, values, notes=("times of pulses as recorded",))
    first = _flanks(name, values, times, reading)
    spacing = float((times[-1] - times[0]) / max(len(times) - 1, 1))
    if reading.pickup == "switching":
        _refuse_growing(name, values)
    note = f"flanks of a tooth signal sampled every {spacing:.4g} s, {reading.edge}"
    if reading.second:
        second = _flanks(reading.second, recording[reading.second].values, times, reading)
        return quadrature_pulses(name, first, second, edge=reading.edge, notes=(f"{note}; {reading.second} beside it",))
    return PulseChannel(name, first[1 if reading.edge == "falling" else 0], notes=(note,))


def _flanks(name: str, values: FloatArray, times: FloatArray, reading: PulseReading) -> tuple[FloatArray, FloatArray]:
    try:
        return flanks(
            values, times, level=reading.level, hysteresis=reading.hysteresis,
            pickup="inductive" if reading.pickup == "inductive" else "switching",
        )  # fmt: skip
    except UsageError as error:
        raise UsageError(f"{name}: {error}", kind=error.kind) from None


def _refuse_growing(name: str, values: FloatArray) -> None:
    """Refuse a signal without direct component whose height changes along the record, read as one that switches."""
    parts = [part for part in np.array_split(values, HEIGHT_PARTS) if len(part)]
    heights = [float(np.ptp(np.percentile(part, [LOW_PERCENTILE, HIGH_PERCENTILE]))) for part in parts]
    if min(heights) < LEAST_EVEN_HEIGHT * max(heights):
        raise UsageError(
            f"{name}: the signal of the teeth is between {min(heights):.3g} and {max(heights):.3g} high along the "
            "record, as that of an inductive pickup, which grows with the speed: read it as such (pickup: inductive), "
            "or cut the record to where the shaft turns",
            kind="disturbed-signal",
        )


def counted_reading(reading: PulseReading) -> PulseReading:
    """Reading of the counts or times of a channel alone, without the entries of a wheel."""
    return PulseReading(**{name: getattr(reading, name) for name in ("tick", "clock", "bits")})
