"""Rotation of a shaft from the pulses of a toothed wheel, band-limited between them, and its uncertainty."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.signals.bandlimited import Rotation, filled_band, smooth_course
from torsionnet.signals.encoder import refuse_unlikely_unit
from torsionnet.signals.pulses import Pulses, check_pulses, repaired_pulses
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.pulse_deviations import PulseDeviations, seen_deviations
from torsionnet.signals.rotation.tooth_zero import pulses_by_gap, tooth_after_gap, tooth_after_index
from torsionnet.signals.rotation.turn_pattern import check_pattern, first_tooth
from torsionnet.signals.rotation.wheel import ToothPlaces, Wheel, WheelPattern, lobes_in_words, matched_pulses
from torsionnet.signals.rotation.wheel_channel import DirectedPulses, ReversingRotation, refuse_turning_back

HALF_WIDTH_DEVIATIONS = 1.96
"""Half width of the 95 % interval of a normal variable over its standard deviation."""
MOST_LISTED_ORDERS = 6
"""Most orders that a message lists one by one; more are named by the first and the last."""
FOLLOWED_KNOTS = 8
"""Knots per turn of the course beside which errors of pulses are seen: it follows low orders, which are vibration."""
MOST_ALTERNATION = 0.03
"""Pitches by which every second tooth may stand beside the middle of its neighbours: those of a wheel stand within some
hundredths, flanks of either kind by how much wider teeth are than what is between them."""
WHOLE_ORDER = 1e-6
"""Largest distance of an order from a whole number of vibrations per turn of a wheel at which teeth reach it."""


@dataclass(frozen=True, eq=False)
class WheelRotation:
    """Rotation of the reference shaft as a toothed wheel shows it, over the time of its pulses.

    Attributes
    ----------
    name : str
    wheel : Wheel
    times : (n,) array
        Times of the pulses kept, s.
    numbers : (n,) int array
        Tooth of each pulse, counted on from turn to turn; tooth 0 is the first after the gap of a wheel with missing
        teeth, the first at or after an index pulse, else that of the first pulse.
    rotation : Rotation or ReversingRotation
        Rotation in pitches since the place of the first tooth on a wheel of even pitch.
    remarks : tuple of str
        Repairs, with their counts.
    deviations : PulseDeviations
        Errors of the times of pulses and of the places of teeth.
    gap : str
        Gap of the wheel as it was found, in words; empty where it has none.
    zero : str
        Which tooth is 0, in words.
    backwards : bool
        Whether two tracks showed that the wheel turns backwards all the time.
    repairs : int
        Number of pulses that were left out, or were missing and counted.
    gap_band : float or None
        Share of the orders up to half the teeth that gaps leave; by default that of the gap of the wheel.
    """

    name: str
    wheel: Wheel
    times: FloatArray
    numbers: NDArray[np.intp]
    rotation: Rotation | ReversingRotation
    remarks: tuple[NoteOrText, ...] = ()
    deviations: PulseDeviations = PulseDeviations()
    gap: str = ""
    zero: str = "the tooth of the first pulse"
    backwards: bool = False
    repairs: int = 0
    gap_band: float | None = None

    def angle(self, times: FloatArray) -> FloatArray:
        """Angle of the reference shaft in rad at times in s between first and last pulse, shape (n,).

        It is 0 at tooth 0.
        """
        return np.asarray(self._pitch * (self.rotation.at(times) + self.numbers[0]))

    def speed(self, times: FloatArray) -> FloatArray:
        """Speed of the reference shaft in rad/s at times in s between first and last pulse, shape (n,)."""
        return np.asarray(self._pitch * self.rotation.rate(times))

    @property
    def _pitch(self) -> float:
        """Angle of the reference shaft in rad from tooth to tooth, negative of a wheel that turns against it."""
        return 2 * np.pi * self.wheel.ratio * (-1 if self.wheel.reversed != self.backwards else 1) / self.wheel.teeth

    @cached_property
    def speeds(self) -> FloatArray:
        """Speed of the reference shaft in rad/s at the pulses, shape (n,)."""
        return self.speed(self.times)

    @property
    def settled(self) -> tuple[float, float]:
        """First and last time in s between which the angle does not depend on what comes beyond the record.

        Nearer to the ends, on 20 pulses, high orders are off by up to 15 % of their amplitude.
        """
        edge = min(self.rotation.end_pulses, (len(self.times) - 1) // 2)
        return float(self.times[edge]), float(self.times[-1 - edge])

    @property
    def revolutions(self) -> float:
        """Turns of the reference shaft from the first to the last pulse, those in either direction added up."""
        return float(np.abs(np.diff(self.numbers)).sum()) * self.wheel.ratio / self.wheel.teeth

    @property
    def angle_deviation(self) -> FloatArray:
        """Standard deviation of the angle of the reference shaft in rad at the pulses, shape (n,).

        It holds what counter and jitter leave at the speed there, and what is known or seen of the places of teeth.
        """
        of_times = self.deviations.time * np.abs(self.speeds)
        return np.asarray(np.hypot(of_times, self.deviations.place * self.wheel.ratio))

    @property
    def alias_order(self) -> float:
        """Order of the reference shaft from which on orders alias: half the teeth that pass in one of its turns."""
        return self.wheel.teeth / (2 * self.wheel.ratio)

    @property
    def highest_order(self) -> float:
        """Highest order of the reference shaft that the teeth tell, with the part that interpolation and gap leave."""
        gap_band = filled_band(self.wheel.missing_teeth) if self.gap_band is None else self.gap_band
        return self.alias_order * min(self.rotation.kept_band, gap_band)

    def aliased(self, order: float) -> float:
        """Order that an order of the reference shaft reads as, itself up to half the teeth."""
        per_turn = 2 * self.alias_order
        return abs(order - per_turn * round(order / per_turn))

    def order_deviation(self, order: float) -> float:
        """RMS in rad of what errors of pulses add to the peak amplitude of an order of the reference shaft's angle.

        Independent errors of the places of z teeth add 2 sigma/sqrt(z) to each order that is whole on the wheel;
        those of the times of n pulses 2 sigma/sqrt(n) to every order of the whole record.
        """
        # Errors s at n pulses leave a line of RMS 2 s/sqrt(n); times become angles by the speed.
        of_times = 2 * float(np.sqrt(np.mean((self.deviations.time * self.speeds) ** 2) / len(self.times)))
        # Errors of places return with each turn, in whole orders of the wheel alone, however long the record is.
        on_wheel = order * self.wheel.ratio
        whole = abs(on_wheel - round(on_wheel)) < WHOLE_ORDER
        there = self.wheel.teeth - self.wheel.missing_teeth
        of_places = 2 * self.deviations.place * self.wheel.ratio / np.sqrt(there) if whole else 0.0
        return float(np.hypot(of_times, of_places))

    def check_orders(self, orders: Iterable[float]) -> None:
        """Refuse orders of the reference shaft that the teeth of the wheel do not tell.

        Raises
        ------
        UsageError
            With all of them, and what would help.
        """
        beyond = [order for order in orders if order > self.highest_order]
        if not beyond:
            return
        many = len(beyond) > MOST_LISTED_ORDERS
        listed = f"{min(beyond):g} to {max(beyond):g}" if many else ", ".join(f"{order:g}" for order in beyond)
        reads = max(beyond)
        alias = f", order {reads:g} would read as {self.aliased(reads):g}" if reads >= self.alias_order else ""
        raise UsageError(
            f"{self.name}: order{'s' * (len(beyond) > 1)} {listed}: {self.wheel.teeth} teeth tell orders up to "
            f"{self.highest_order:.4g}, and from {self.alias_order:g} on orders alias{alias}; leave them out, or take "
            "a wheel or encoder of more teeth, or a second pickup that sees the teeth half a pitch later",
            kind="beyond-sampling",
        )


def wheel_rotation(
    channel: PulseChannel,
    wheel: Wheel,
    pattern: WheelPattern | None = None,
    *,
    index: PulseChannel | None = None,
    first: int | None = None,
) -> WheelRotation:
    """Rotation of the reference shaft from the pulses of a wheel, without the errors of its pitch pattern.

    Between the pulses it is band-limited, so that an order reads as large as it is, up to
    :attr:`WheelRotation.highest_order`.

    Parameters
    ----------
    channel : PulseChannel
        Times of the pulses, s.
    wheel : Wheel
        Teeth, gap, and turns of the reference shaft per turn of the wheel.
    pattern : WheelPattern, optional
        Places of the teeth, which are removed. Without gap, index or ``first`` its tooth 0 is found by its shape.
    index : PulseChannel, optional
        Pulses that come once per turn of the wheel, or once in several turns; the first tooth at or after is tooth 0.
    first : int, optional
        Tooth of the first pulse, where neither gap nor index tells it.

    Raises
    ------
    UsageError
        Pulses that cannot be repaired or do not fit the teeth, no gap or two that could be it, a shaft that may have
        turned back, or a pattern of another wheel or sense of rotation, or one whose first tooth neither gap nor index
        nor its shape tells.

    Examples
    --------
    A wheel of 60 teeth at 600 r/min, stamped by a counter of 1 MHz.

    >>> times = np.round(np.arange(6000) / 600, 6)
    >>> rotation = wheel_rotation(PulseChannel("n1", times, tick=1e-6), Wheel(teeth=60))
    >>> round(rotation.revolutions, 3), rotation.highest_order, round(float(rotation.speeds.mean() * 30 / np.pi), 3)
    (99.983, 25.0, 600.0)
    >>> round(float(np.degrees(rotation.deviations.tick / np.sqrt(12) * rotation.speeds.mean())), 5)
    0.00104
    """
    if pattern is not None:
        check_pattern(channel.name, wheel, pattern)
    backwards = False
    if isinstance(channel, DirectedPulses):
        if channel.turns_back:
            return _reversing(channel, wheel, pattern, first)
        backwards = bool(channel.numbers[-1] < 0)
    else:
        refuse_turning_back(channel.times, channel.name)
    stated = wheel.stated
    try:
        if not channel.unit_known:
            refuse_unlikely_unit(channel.times, wheel.teeth / wheel.ratio)
        if stated is not None:
            return _of_stated(channel, wheel, stated, index, first)
    except UsageError as error:
        raise _named(error, channel, wheel) from None
    by_gap: Pulses | None = None
    try:
        pulses = _repaired(channel, wheel)
        result = _of_pulses(pulses, channel, wheel, pattern, index, first, backwards)
        if wheel.missing_teeth and (result.repairs or len(pulses.missing.after) < pulses.numbers[-1] // wheel.teeth):
            by_gap = pulses_by_gap(channel.times, wheel)  # which lets vibration not pass for lost pulses
        if by_gap is None:
            return result
    except (UsageError, SolveError):
        by_gap = pulses_by_gap(channel.times, wheel) if wheel.missing_teeth else None
        if by_gap is None:
            raise
    skipped = int(np.searchsorted(channel.times, by_gap.times[0]))
    # The tooth given is that of the record's first pulse; the pulses left out at the beginning end with a gap.
    if first is not None and skipped:
        first += skipped + wheel.missing_teeth
    result = _of_pulses(by_gap, channel, wheel, pattern, index, first, backwards)
    beyond = len(channel.times) - len(by_gap.times)
    remark = f"{beyond} pulse{'s' * (beyond > 1)} at the ends left out: too few beyond the gap to fill it"
    return replace(result, remarks=(*result.remarks, remark)) if beyond else result


def _named(error: UsageError, channel: PulseChannel, wheel: Wheel) -> UsageError:
    return UsageError(f"{channel.name}: {error}{lobes_in_words(channel.times, wheel.teeth)}", kind=error.kind)


def _repaired(channel: PulseChannel, wheel: Wheel) -> Pulses:
    try:
        return repaired_pulses(channel.times)
    except UsageError as error:
        raise _named(error, channel, wheel) from None


def _of_pulses(
    pulses: Pulses,
    channel: PulseChannel,
    wheel: Wheel,
    pattern: WheelPattern | None,
    index: PulseChannel | None,
    first: int | None,
    backwards: bool,
) -> WheelRotation:
    """Rotation by numbered pulses of a wheel of even pitch, or with its pitch pattern removed."""
    after_gap, gap = tooth_after_gap(pulses, wheel, channel.name) if first is None else (None, "")
    pulses = replace(pulses, period=wheel.teeth if wheel.missing_teeth else 0)
    remarks, repairs = pulses.remarks, len(pulses.spurious) + pulses.irregular.total
    zero = "the tooth of the first pulse"
    rotation: Rotation | None = None
    # Tooth 0 by the number given, else by the gap, by an index pulse, or by the shape of the pattern.
    if after_gap is not None:
        first, zero = after_gap, "the first tooth after the gap"
    elif first is not None:
        zero = "the tooth given"
    elif index is not None:
        rotation = Rotation(pulses.times, pulses.numbers, wheel.teeth)
        first = tooth_after_index(rotation, pulses.times, index, wheel.teeth, channel.name)
        zero = f"the first tooth at or after a pulse of {index.name}"
    elif pattern is not None:
        first = first_tooth(channel.name, pulses.times, pulses.numbers, wheel, pattern)
        zero = f"tooth 0 of the pattern, by its shape: the first pulse is of tooth {first}"
    offsets = None
    if pattern is not None:
        offsets, rotation = _offsets(pattern, pulses.numbers + (first or 0), channel.name), None
    if rotation is None:
        rotation = Rotation(pulses.times, pulses.numbers, wheel.teeth, offsets)
    if pattern is None and rotation.alternation > MOST_ALTERNATION:
        raise UsageError(
            f"{channel.name}: every second pulse stands {rotation.alternation:.2g} pitches beside the middle of its "
            "neighbours: are rising and falling flanks both counted? take one kind (edge: rising), or give the pattern "
            f"of the wheel{lobes_in_words(pulses.times, wheel.teeth)}",
            kind="unfit-wheel",
        )
    deviations = _deviations(channel, wheel, pattern, pulses.times, pulses.numbers, offsets)
    numbers = pulses.numbers + first if first else pulses.numbers
    return WheelRotation(
        channel.name, wheel, pulses.times, numbers, rotation, remarks, deviations, gap, zero, backwards, repairs
    )  # fmt: skip


def _of_stated(
    channel: PulseChannel, wheel: Wheel, stated: ToothPlaces, index: PulseChannel | None, first: int | None
) -> WheelRotation:
    """Rotation by a wheel whose pattern states where its teeth stand; places without a tooth count as its teeth."""
    times = check_pulses(channel.times)
    places, offsets = matched_pulses(times, stated)
    rotation = Rotation(times, places - places[0], stated.count, offsets)
    repeats = stated.repeats
    zero = f"one of the {repeats} first teeth of the pattern" if repeats > 1 else "the first tooth of the pattern"
    if first is not None:
        places, zero = places - places[0] + first, "the tooth given"
    elif index is not None:
        places = places - places[0] + tooth_after_index(rotation, times, index, stated.count, channel.name)
        zero = f"the first place at or after a pulse of {index.name}"
    even = replace(wheel, teeth=stated.count, missing_teeth=stated.widest, pattern="")
    deviations = _deviations(channel, even, None, times, places, offsets)
    return WheelRotation(
        channel.name, even, times, places, rotation, deviations=deviations, zero=zero, gap_band=stated.band,
        gap=f"pattern of {len(stated.places)} teeth on {stated.count} places",
    )  # fmt: skip


def _reversing(channel: DirectedPulses, wheel: Wheel, pattern: WheelPattern | None, first: int | None) -> WheelRotation:
    if wheel.missing_teeth:
        raise UsageError(
            f"{channel.name}: the shaft turns back, and the gap of {wheel.missing_teeth} missing teeth cannot be told "
            "from a standstill; cut the record where it turns back",
            kind="turning-back",
        )
    numbers = channel.numbers + (first or 0)
    offsets = 0.0 if pattern is None else _offsets(pattern, numbers, channel.name)
    backs = channel.turns_back
    remarks = (
        f"the shaft turns back {backs} time{'s' * (backs > 1)}: interpolated by cubic splines over time",
        *channel.notes,
    )
    rotation = ReversingRotation(channel.times, np.asarray(channel.numbers + offsets, dtype=np.float64))
    zero = "the tooth of the first pulse" if first is None else "the tooth given"
    deviations = PulseDeviations(channel.tick, pattern=None if pattern is None else _known(pattern))
    return WheelRotation(channel.name, wheel, channel.times, numbers, rotation, remarks, deviations, zero=zero)


def _offsets(pattern: WheelPattern, numbers: NDArray[np.intp], name: str) -> FloatArray:
    """Pitches by which each pulse stands beyond its place."""
    pitch = 2 * np.pi / pattern.teeth
    if np.abs(pattern.positions).max() >= pitch / 2:
        raise UsageError(
            f"{name}: teeth of the pattern stand half a pitch or more beyond their places, in rad?", kind="wrong-unit"
        )
    return np.asarray(pattern.positions[numbers % pattern.teeth] / pitch)


def _deviations(
    channel: PulseChannel,
    wheel: Wheel,
    pattern: WheelPattern | None,
    times: FloatArray,
    numbers: NDArray[np.intp],
    offsets: FloatArray | None,
) -> PulseDeviations:
    # A smooth course takes out the rotation and its low orders; what is left are errors of times and of places.
    pitch = 2 * np.pi / wheel.teeth
    passed = numbers - numbers[0] if numbers[0] else numbers
    standing = passed if offsets is None else passed + offsets
    course = smooth_course(times, standing, passed, round(wheel.teeth / FOLLOWED_KNOTS))

    def read(part: slice) -> tuple[FloatArray, FloatArray]:
        return pitch * (standing[part] - course(times[part])), pitch * course(times[part], 1)

    jitter, places = seen_deviations(read, numbers, wheel.teeth)
    return PulseDeviations(channel.tick, jitter, places, None if pattern is None else _known(pattern))


def _known(pattern: WheelPattern) -> float:
    """Standard deviation of the places of a pattern in rad."""
    return float(np.sqrt(np.mean(pattern.half_widths**2))) / HALF_WIDTH_DEVIATIONS
