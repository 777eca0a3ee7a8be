"""Patterns that return with every turn: what they leave in a speed or an angle, and the first tooth that they show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.calibration_windows import order_set, windows_of_test
from torsionnet.signals.rotation.wheel import Wheel, WheelPattern

# Pattern that returns with every turn in a speed or an angle, as the pitch errors of the wheel behind it leave it.

FEWEST_TURNS, POINTS_PER_TURN, HIGHEST_ORDER = 24, 64, 12
"""Fewest turns from which a pattern is recognised, points of a turn at which the speed is read, and the highest order
that is looked at."""
LEAST_SAMPLES_PER_TURN = 30
"""Fewest samples of a turn in the mean, from which orders up to the highest one are read."""
LEAST_AMPLITUDE = np.radians(0.003)
"""Least amplitude of order 1 in rad that is told; the teeth of good wheels leave 0.01 degrees."""
SURE = 6.0
"""Size of a mean over turns against its standard deviation, from which an order returns with every turn; in records of
noise alone, with twelve orders, fewer than one of a million reaches it."""
FEWEST_ORDERS = 5
"""Fewest of the twelve orders that return at one steady speed as those of a wheel do; vibration has fewer."""
SPEED_RANGE = 0.2
"""Change of speed over its mean, from which a pattern that is constant in angle differs from vibration."""
SAME_AMPLITUDE = 0.15
"""Relative difference of order 1 at low and at high speed, up to which it is constant in angle; that of vibration
under a constant torque falls with the square of the speed, by more than 30 %."""


@dataclass(frozen=True, eq=False)
class TurnPattern:
    """Orders of an angle that return with every turn, complex peak amplitudes in rad from order 1 on.

    ``constant`` says whether order 1 is the same at low and high speed; it is None at one steady speed.
    """

    amplitudes: ComplexArray
    returning: tuple[int, ...]
    constant: bool | None

    def words(self) -> str:
        """Text that names orders and amplitudes in degrees, and what the pattern may be."""
        sizes = np.degrees(np.abs(self.amplitudes))
        largest = sorted(self.returning, key=lambda order: -sizes[order - 1])[:3]
        listed = ", ".join(f"order {order} of {sizes[order - 1]:.2g} degrees" for order in sorted({1, *largest}))
        text = f"returns with every turn: {listed}"
        if self.constant:
            return (
                f"{text}, order 1 the same at low and high speed, as the pitch errors of a wheel or its eccentricity: "
                "whole orders are not vibration alone; nothing was removed: calibrate the wheel and use its pattern"
            )
        return (
            f"{text}, as the pitch errors of a wheel do; one speed does not tell them from vibration: "
            "compare half orders, record another speed, or calibrate the wheel; nothing was removed"
        )


def turn_pattern(speeds: FloatArray, sampling_rate: float) -> TurnPattern | None:
    """Pattern that returns with every turn in a speed in rad/s, or None where there is none like that of a wheel.

    Parameters
    ----------
    speeds : (n,) array
        Speed of one shaft, rad/s, in one direction.
    sampling_rate : float
        Hz.

    Examples
    --------
    >>> turned = 2 * np.pi * np.linspace(0, 100, 20_000)
    >>> wheel = np.radians(0.05) * np.cos(turned + 1) + np.radians(0.01) * np.cos(2 * turned)
    >>> times = np.cumsum(1 / np.linspace(60, 120, 20_000)) * (2 * np.pi * 100 / 20_000)
    >>> even = np.arange(times[0], times[-1], 1e-3)
    >>> angle = np.interp(even, times, turned + wheel)
    >>> turn_pattern(np.gradient(angle, even), 1000.0).constant
    True
    """
    size = np.abs(speeds)
    total = float(size.sum()) / sampling_rate / (2 * np.pi)
    one_way = bool(size.min() > 0) and not np.ptp(np.sign(speeds))
    if not one_way or total < FEWEST_TURNS or len(speeds) < LEAST_SAMPLES_PER_TURN * total:
        return None
    # Angle by the trapezoidal rule, then the speed at even angles of each turn.
    turned = np.concatenate([[0.0], np.cumsum((size[1:] + size[:-1]) / (2 * sampling_rate))])
    count = int(turned[-1] / (2 * np.pi))
    places = 2 * np.pi * np.arange(count * POINTS_PER_TURN + 1) / POINTS_PER_TURN
    read = np.interp(places, turned, size)
    turns, ends = read[:-1].reshape(count, POINTS_PER_TURN), read[::POINTS_PER_TURN]
    means = turns.mean(axis=1)
    # The speed rises or falls within a turn: a straight line between its ends is taken out.
    ramp = np.diff(ends)[:, None] * (np.arange(POINTS_PER_TURN) / POINTS_PER_TURN - 0.5)
    lines = 2 * np.fft.rfft(turns - ramp, axis=1)[:, 1 : HIGHEST_ORDER + 1] / POINTS_PER_TURN
    # From speed to angle: an order o at mean speed Omega has d phi/dt = j o Omega phi.
    lines = lines / (1j * np.arange(1, HIGHEST_ORDER + 1) * means[:, None])
    pattern = lines.mean(axis=0)
    spread = np.sqrt(np.mean(np.abs(lines - pattern) ** 2, axis=0) / count)
    returning = tuple(int(order) + 1 for order in np.flatnonzero(np.abs(pattern) > SURE * spread))
    if 1 not in returning or abs(pattern[0]) < LEAST_AMPLITUDE:
        return None
    # A pattern is the same angle at each speed, which one speed alone cannot show: then many orders have to return.
    if np.ptp(means) < SPEED_RANGE * means.mean():
        return TurnPattern(pattern, returning, None) if len(returning) >= FEWEST_ORDERS else None
    middle = np.median(means)
    low, high = lines[means <= middle, 0], lines[means > middle, 0]
    apart = abs(low.mean() - high.mean())
    constant = bool(apart < SAME_AMPLITUDE * abs(pattern[0]) + 3 * float(spread[0]))
    return TurnPattern(pattern, returning, True) if constant else None


# First tooth of a record in a stored pitch pattern, found by the shape that its pulses show.

MATCHED_SHARE = 0.2
"""Share of the number of teeth above which orders are compared: vibration fills those below it."""
LEAST_CORRELATION, LEAST_LEAD = 0.7, 0.2
"""Least correlation of a pattern with a record, and its least lead over the next best tooth: of 60 independent teeth
the best wrong one correlates by about 0.4."""


def first_tooth(name: str, times: FloatArray, numbers: NDArray[np.intp], wheel: Wheel, pattern: WheelPattern) -> int:
    """Tooth of a pattern that the tooth numbered 0 in a record is, found by the shape that the pulses show.

    For records without gap or index pulse. What is compared are orders above those of vibration.

    Parameters
    ----------
    name : str
        Channel, for messages.
    times, numbers : (n,) arrays
        Times of the pulses in s, and their teeth counted on from turn to turn.
    wheel : Wheel
    pattern : WheelPattern

    Raises
    ------
    UsageError
        No tooth fits, or two fit about as well.
    """
    test = windows_of_test(name, times, numbers, None, wheel, order_set(wheel, 2), 0.0, np.zeros(wheel.teeth))
    seen = np.mean([window.first.mean_of_tooth for window in test.windows], axis=0)
    return best_shift(name, pattern.positions, -np.nan_to_num(seen))


def best_shift(name: str, positions: FloatArray, seen: FloatArray) -> int:
    """Tooth of a pattern (teeth,) that is tooth 0 of what a record shows at each tooth, both in rad.

    Raises
    ------
    UsageError
        None fits, or two fit about as well.

    Examples
    --------
    >>> teeth = np.random.default_rng(1).standard_normal(60)
    >>> best_shift("n1", teeth, np.roll(teeth, -7))
    7
    """
    own, other = _compared(positions), _compared(seen)
    size = np.linalg.norm(own) * np.linalg.norm(other)
    # Circular correlation over the teeth, by the product of the spectra, at each shift of one against the other.
    fits = np.fft.irfft(own * other.conj(), len(positions)) * len(positions) / 2 / size if size > 0 else None
    if fits is None:
        raise UsageError(
            f"{name}: the pattern is the same at every tooth, and says not which is the first", kind="ambiguous-tooth"
        )
    best, second = np.argsort(fits)[[-1, -2]]
    if fits[best] < LEAST_CORRELATION or fits[best] - fits[second] < LEAST_LEAD:
        raise UsageError(
            f"{name}: the pattern fits the record by a correlation of {fits[best]:.2f} with its tooth {best} first and "
            f"{fits[second]:.2f} with tooth {second}: which is the first cannot be told; record an index pulse, or "
            "calibrate from this record itself",
            kind="ambiguous-tooth",
        )
    return int(best)


def _compared(values: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    """Spectrum over the teeth of the orders that are compared; others are 0."""
    spectrum = np.fft.rfft(values)
    spectrum[: int(MATCHED_SHARE * len(values)) + 1] = 0
    if len(values) % 2 == 0:
        spectrum[-1] /= np.sqrt(2)  # half the tooth count stands once in the spectrum of a full turn, others twice
    return np.asarray(spectrum)


# Whether a stored pitch pattern can be that of a wheel.


def check_pattern(name: str, wheel: Wheel, pattern: WheelPattern) -> None:
    """Refuse a pitch pattern that cannot be that of a wheel.

    Raises
    ------
    UsageError
        Other numbers of teeth or of missing teeth, or the other sense of rotation; all of them at once.

    Examples
    --------
    >>> import numpy as np
    >>> check_pattern("n1", Wheel(teeth=60), WheelPattern(np.zeros(60), np.zeros(60)))
    """
    faults = []
    if pattern.teeth != wheel.teeth:
        faults.append(f"a pattern of {pattern.teeth} teeth does not fit a wheel of {wheel.teeth}")
    if pattern.missing != wheel.missing_teeth:
        faults.append(f"the pattern's gap lacks {pattern.missing} teeth, the wheel's {wheel.missing_teeth}")
    if pattern.reversed != wheel.reversed:
        senses = ("in the sense of the model", "against the sense of the model")
        faults.append(
            f"the pattern was calibrated while the wheel turned {senses[pattern.reversed]}, but it turns "
            f"{senses[wheel.reversed]}: the pickup sees the other edges in the other sequence; calibrate in this sense"
        )
    if faults:
        raise UsageError(f"{name}: {'; '.join(faults)}", kind="unfit-wheel")
