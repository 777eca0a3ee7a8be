"""Measured and calculated amplitudes of one order at the same speeds."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from torsionnet.base.entries.spec import Schema
from torsionnet.base.phrases import phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.signals.orders.differences import LONGEST_DELAY, amplitude_scores, best_turn, complex_scores, consistent

IS_SWEPT: Schema = {"type": "boolean", "description": "calculated along the measured speed"}
"""JSON Schema of the flag whether the calculated side is that along the measured speed over time."""


@dataclass(frozen=True, eq=False)
class OrderPair:
    """Measured and calculated peak amplitudes of one order at the same speeds, SI units of the output.

    Attributes
    ----------
    order : float
        Vibrations per revolution of the reference shaft.
    speeds : (n,) array
        rad/s, rising.
    measured, calculated : (n,) complex array
        Where phases cannot be compared, amplitudes without an imaginary part.
    has_phase : bool
        Whether both have a phase.
    half_widths : (n,) array, optional
        Half width of the 95 % interval of a part; None or NaN where the test states none.
    curve_speeds : (m,) array
        All calculated speeds, rad/s, rising, which may lie closer.
    curve : (m,) complex array
        Calculated values at these.
    bound : bool
        Whether the calculated amplitude is an upper bound.
    swept : bool
        Whether the calculated values are those along the measured speed over time.
    """

    order: float
    speeds: FloatArray
    measured: ComplexArray
    calculated: ComplexArray
    has_phase: bool
    half_widths: FloatArray | None
    curve_speeds: FloatArray
    curve: ComplexArray
    bound: Annotated[bool, Out(json="is_bound")] = False
    swept: Annotated[bool, Out(json="is_swept", schema=IS_SWEPT)] = False

    @property
    def in_intervals(self) -> FloatArray:
        """Distance of measured from calculated values in half widths of the 95 % interval, shape (n,); NaN without one.

        Of complex values where phases are known, else of amplitudes. Of a true model 95 of 100 complex values lie
        within 1.25, amplitudes within 1.
        """
        if self.half_widths is None:
            return np.full(len(self.speeds), math.nan)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.abs(self.measured - self.calculated) / self.half_widths)

    def with_intervals(self) -> OrderPair | None:
        """Pair at the speeds at which the test states an interval above 0; None if it states none."""
        if self.half_widths is None:
            return None
        good = np.isfinite(self.half_widths) & (self.half_widths > 0)
        if not good.any():
            return None
        return replace(
            self,
            speeds=self.speeds[good],
            measured=self.measured[good],
            calculated=self.calculated[good],
            half_widths=self.half_widths[good],
        )


# Explanations of a measured order that differs from the calculated one: sign, zero of the angle, delay, factor.

WRONG_SIGN, OFFSET, DELAY, FACTOR = "wrong sign", "reference offset", "time delay", "constant factor"
"""Verdicts on an order that one number explains."""
LEAST_EXPLAINED = 0.9
"""Share of the squared difference that an explanation must remove if it does not bring the order into the interval."""
FEWEST_OF_PEAK = 4
"""Number of speeds within the width of a peak from which its height and width are read."""
DAMPING_TOLERANCE = 0.15
"""Largest logarithm of height times width of a measured peak over those calculated, which other damping leaves at 1:
widths of tests are no better than 15 %. A smaller change of width says nothing."""


@dataclass(frozen=True, eq=False)
class DifferenceExplanation:
    """Calculated values in SI as the test would have shown them, and how many numbers were fitted to it.

    Attributes
    ----------
    verdict : str
    sentence : str
    values : (n,) complex array
    fitted : int
    offset : float, optional
        Angle in rad of the reference shaft by which the test's zero lies after the calculation's.
    delay : float, optional
        Time in s by which the signal comes late.
    factor : float, optional
        Ratio of measured to calculated amplitudes.
    """

    verdict: str
    sentence: str
    values: ComplexArray
    fitted: int = 1
    offset: float | None = None
    delay: float | None = None
    factor: float | None = None


def explanations(pair: OrderPair, weights: FloatArray) -> Iterator[DifferenceExplanation]:
    """Yield what may have happened to a measured order, with calculated values in SI to match, simplest first.

    ``weights`` are those of squared differences at each speed.
    """
    model = pair.calculated
    power = float((weights * np.abs(model) ** 2).sum())
    if not power:
        return
    # Least squares of test = a model: a = sum w conj(m) t / sum w |m|^2. Offset, delay and factor each leave one
    # part of a free.
    products = weights * np.conj(model) * pair.measured
    if pair.has_phase:
        yield DifferenceExplanation(WRONG_SIGN, "the signal has the opposite sign", -model, 0)
        # |a| = 1: the best turn is arg of the sum; a zero of the angle later by alpha turns order h by h alpha.
        turn = float(np.angle(products.sum()))
        offset = turn / pair.order
        yield DifferenceExplanation(OFFSET, offset_words(offset), model * np.exp(1j * turn), offset=offset)
        if len(pair.speeds) > 1:
            # A signal late by tau is turned by -h Omega tau, which grows with the speed as an offset does not.
            omega = pair.order * pair.speeds
            delay = best_turn(-omega, products, -LONGEST_DELAY, LONGEST_DELAY)
            yield DifferenceExplanation(DELAY, delay_words(delay), model * np.exp(-1j * omega * delay), delay=delay)
    # a real: a = Re sum / power. At or below 0 it would be a wrong sign and no factor.
    factor = float(products.sum().real) / power
    if factor > 0:
        share = f"{abs(factor - 1) * 100:.3g}"
        words = (
            phrase("amplitudes {share} % above the calculated ones at every speed", share=share)
            if factor > 1
            else phrase("amplitudes {share} % below the calculated ones at every speed", share=share)
        )
        yield DifferenceExplanation(FACTOR, words, factor * model, factor=factor)


def offset_words(offset: float, period: float = 0.0) -> str:
    """Text on an offset of the test's zero in rad, with degrees of the reference shaft, and its period in rad."""
    size, more = f"{abs(math.degrees(offset)):.3g}", f"{math.degrees(period):.4g}"
    if period:
        return (
            phrase(
                "the zero of the angle lies {degrees} degrees later than in the calculation (or {period} degrees more)",
                degrees=size,
                period=more,
            )
            if offset > 0
            else phrase(
                "the zero of the angle lies {degrees} degrees earlier than in the calculation (or {period} "
                "degrees more)",
                degrees=size,
                period=more,
            )
        )
    return (
        phrase("the zero of the angle lies {degrees} degrees later than in the calculation", degrees=size)
        if offset > 0
        else phrase("the zero of the angle lies {degrees} degrees earlier than in the calculation", degrees=size)
    )


def delay_words(delay: float) -> str:
    """Text on a delay of the measured signal in s, with its size in ms."""
    size = f"{abs(delay) * 1e3:.3g}"
    return (
        phrase("the signal comes {time} ms late", time=size)
        if delay > 0
        else phrase("the signal comes {time} ms early", time=size)
    )


def holds(explanation: DifferenceExplanation, pair: OrderPair) -> bool:
    """Whether an explanation brings the measured values of an order into their intervals."""
    widths = pair.half_widths
    assert widths is not None
    if pair.has_phase:
        return consistent(complex_scores(pair.measured, explanation.values, widths), explanation.fitted)
    return consistent(amplitude_scores(np.abs(pair.measured), np.abs(explanation.values), widths), explanation.fitted)


def best_explanation(pair: OrderPair, weights: FloatArray) -> DifferenceExplanation | None:
    """Explanation that removes most of the squared difference from calculated values in SI; None without one."""

    def left(values: ComplexArray) -> float:
        return float((weights * np.abs(pair.measured - values) ** 2).sum())

    ranked = [(left(explanation.values), explanation) for explanation in explanations(pair, weights)]
    least, best = min(ranked, key=lambda entry: entry[0], default=(math.inf, None))
    return best if least <= (1 - LEAST_EXPLAINED) * left(pair.calculated) else None


def damping_difference(pair: OrderPair) -> str:
    """Sentence on a measured peak that is lower and wider than the calculated one, or higher and narrower, or empty.

    The height of a resonance peak is inverse to its damping and the width at 0.707 of the height proportional to it.
    """
    heights, widths = [], []
    for speeds, values in ((pair.speeds, pair.measured), (pair.curve_speeds, pair.curve)):
        size = np.abs(values)
        at = int(size.argmax())
        # Half-power points of the peak, 1/sqrt(2) of its height.
        level = size[at] / math.sqrt(2)
        left, right = np.flatnonzero(size[:at] < level), np.flatnonzero(size[at:] < level)
        if not len(left) or not len(right) or right[0] + at - left[-1] <= FEWEST_OF_PEAK:
            return ""
        low = np.interp(level, size[left[-1] : left[-1] + 2], speeds[left[-1] : left[-1] + 2])
        end = at + right[0]
        high = np.interp(level, size[[end, end - 1]], speeds[[end, end - 1]])
        heights.append(float(size[at]))
        widths.append(float(high - low))
    # For the same torque height ~ 1/zeta and width ~ zeta: other damping leaves height times width as it is.
    height, width = heights[0] / heights[1], widths[0] / widths[1]
    if abs(math.log(height * width)) > DAMPING_TOLERANCE or abs(math.log(width)) < DAMPING_TOLERANCE:
        return ""
    # Ratio of the dampings, the geometric mean of its two estimates: width and 1/height.
    damping = math.sqrt(width / height)
    return phrase(
        "the peak is {height:.3g} times as high and {width:.3g} times as wide as calculated, as with "
        "{damping:.3g} times the damping",
        height=height,
        width=width,
        damping=damping,
    )


def peak_shift(pair: OrderPair, half_width: float) -> str:
    """Sentence on a measured peak at another speed than the calculated one; empty if there is no such shift."""
    test = np.abs(pair.measured)
    inside = (pair.curve_speeds >= pair.speeds[0]) & (pair.curve_speeds <= pair.speeds[-1])
    if min(int(inside.sum()), len(test)) < 3:  # a peak needs a lower value on either side
        return ""
    speeds, curve = pair.curve_speeds[inside], np.abs(pair.curve[inside])
    at, of = int(test.argmax()), int(curve.argmax())
    if at in (0, len(test) - 1) or of in (0, len(curve) - 1):
        return ""  # a maximum at an end of the speeds is no peak
    # Speeds whose amplitudes lie within an interval of the highest: any of them may be that of the measured peak.
    near = np.flatnonzero(test >= test[at] - half_width)
    low, high = pair.speeds[max(near[0] - 1, 0)], pair.speeds[min(near[-1] + 1, len(test) - 1)]
    if low <= speeds[of] <= high:
        return ""
    share = 100 * (pair.speeds[at] / speeds[of] - 1)
    return phrase(
        "peak at {measured:.5g} rpm instead of {calculated:.5g} rpm ({share:+.2g} %)",
        measured=pair.speeds[at] * RPM,
        calculated=speeds[of] * RPM,
        share=share,
    )


# Offset of the angle's zero in degrees, or delay of a signal in ms, that explains several measured orders.

LEAST_SHARE = 0.02
"""Squared difference, over the squared calculated values, below which nothing asks for an explanation: 8 degrees."""
SHORT_PERIOD = 2 * math.pi * (1 - 1e-9)
"""Angle in rad below which the period of an offset is worth saying: a whole turn is plain."""


def common_turn(pairs: Sequence[OrderPair]) -> str:
    """Sentence on the offset in degrees or the delay in ms that explains several orders; empty if neither does.

    Every order counts alike, whatever its amplitude: each is divided by the RMS of its calculated values.
    """
    used = [pair for pair in pairs if pair.has_phase and pair.calculated.any()]
    if len(used) < 2:
        return ""
    scales = [float(np.sqrt(np.sum(np.abs(pair.calculated) ** 2))) for pair in used]
    model = np.concatenate([pair.calculated / scale for pair, scale in zip(used, scales, strict=True)])
    test = np.concatenate([pair.measured / scale for pair, scale in zip(used, scales, strict=True)])
    orders = np.concatenate([np.full(len(pair.speeds), pair.order) for pair in used])
    omega = orders * np.concatenate([pair.speeds for pair in used])
    before = float((np.abs(test - model) ** 2).sum())
    if before < LEAST_SHARE * len(used):
        return ""
    products = np.conj(model) * test
    # Offsets a period apart turn all orders alike: one period is searched, around 0.
    period = _period([pair.order for pair in used])
    offset = best_turn(orders, products, -period / 2, period / 2)
    delay = best_turn(-omega, products, -LONGEST_DELAY, LONGEST_DELAY)
    again = period if period < SHORT_PERIOD else 0.0
    turned = {
        offset_words(offset, again): np.exp(1j * orders * offset),
        delay_words(delay): np.exp(-1j * omega * delay),
    }
    left = {words: float((np.abs(test - model * turn) ** 2).sum()) for words, turn in turned.items()}
    # Offset and delay have one free number each, so that the smaller remainder decides between them.
    words = min(left, key=left.__getitem__)
    removed = 1 - left[words] / before
    if removed < LEAST_EXPLAINED:
        return ""
    return phrase(
        "all orders together: {words}, which removes {share:.0f} % of the squared difference",
        words=words,
        share=100 * removed,
    )


def _period(orders: Sequence[float]) -> float:
    """Angle in rad of the reference shaft after which the phases of all orders repeat; a four-stroke cycle at most."""
    halves = [round(2 * order) for order in orders]
    whole = all(math.isclose(half, 2 * order, rel_tol=1e-6) for half, order in zip(halves, orders, strict=True))
    # Orders m/2: an angle alpha turns them by m alpha/2, whole turns for all at alpha = 4 pi/gcd(m).
    return 4 * math.pi / math.gcd(*halves) if whole else 4 * math.pi
