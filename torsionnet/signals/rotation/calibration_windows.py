"""Windows of all tests of a calibration: what one or two pickups show in each order of the wheel's turn.

Whole revolutions of a wheel, one window after the other: what its pulses show in each order, and in each tooth. The
wheel turns by theta = phi + x(phi), phi the mean angle of rotation, a cubic over the window, x(phi) = Re sum_v X_v
exp(j v phi) its vibration. A pulse of tooth k says theta = 2 pi (n + k/z) + p_k at its time, p_k the tooth's error of
position. Mean rotation and X follow by least squares from all pulses of the window, and depend on p linearly: so a
window is solved once, and a better pattern changes what it shows by one product of matrices.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.pulses import repaired_pulses
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.tooth_zero import pulses_by_gap
from torsionnet.signals.rotation.wheel import Wheel

# Whole revolutions of a wheel, one window after the other: what its pulses show in each order, and in each tooth.

MEAN_DEGREE = 3
"""Degree of the polynomial of the mean rotation over a window: a run-up changes its speed smoothly, and a higher one
would take part of the lowest order."""
MEAN_STEPS = 4
"""Repetitions in which mean rotation and vibration are found: each leaves about the square of the vibration in rad."""


@dataclass(frozen=True, eq=False)
class Shown:
    """Solution of the pulses of one pickup over a window of whole revolutions, linear in the errors of the teeth.

    Attributes
    ----------
    solution : (n_terms,) array
        Terms beside the vibration, then its cosines and its sines, rad.
    by_tooth : (n_terms, teeth) array
        Change of the solution per rad of each tooth.
    terms_of_tooth : (teeth, n_terms) array
        Mean of each term over the pulses of a tooth.
    mean_of_tooth : (teeth,) array
        Mean over the pulses of a tooth of the angle beyond the mean rotation, rad; NaN where it has none.
    """

    solution: FloatArray
    by_tooth: FloatArray
    terms_of_tooth: FloatArray
    mean_of_tooth: FloatArray

    def terms(self, positions: FloatArray) -> FloatArray:
        """Terms in rad, shape (n_terms,), with the teeth at these positions beyond their places."""
        return np.asarray(self.solution + self.by_tooth @ positions)

    def orders(self, positions: FloatArray, count: int) -> ComplexArray:
        """Peak amplitudes X of Re X exp(j v phi) in rad, shape (count,), with the teeth at these positions."""
        terms = self.terms(positions)
        return np.asarray(terms[-2 * count : -count] - 1j * terms[-count:])

    def left(self, positions: FloatArray) -> FloatArray:
        """Angle in rad at each tooth that rotation and vibration do not explain, shape (teeth,); NaN without pulses."""
        return np.asarray(self.mean_of_tooth + positions - self.terms_of_tooth @ self.terms(positions))


@dataclass(frozen=True, eq=False)
class Window:
    """A window of whole revolutions of a wheel.

    Attributes
    ----------
    begin, end : float
        s.
    speed : float
        Mean speed of the wheel, rad/s.
    first : Shown
        Of the pickup that says the mean rotation.
    mean : (n,) array
        Coefficients of the mean rotation, rad, of Legendre's polynomials over the window.
    """

    begin: float
    end: float
    speed: float
    first: Shown
    mean: FloatArray

    def mean_rotation(self, times: FloatArray) -> FloatArray:
        """Mean rotation of the wheel in rad at times in s, shape (n,)."""
        return np.asarray(np.polynomial.legendre.legval(self.place(times), self.mean))

    def place(self, times: FloatArray) -> FloatArray:
        """Times as places between -1 and 1 in the window, shape (n,)."""
        return np.asarray((2 * times - self.begin - self.end) / (self.end - self.begin))


def spans(numbers: NDArray[np.intp], length: int, most: int) -> Iterator[slice]:
    """Yield slices of the pulses of windows of ``length`` pitches, at most so many, evenly over the record."""
    starts = np.arange(numbers[0], numbers[-1] - length + 1, length)
    if len(starts) > most:
        starts = starts[np.unique(np.linspace(0, len(starts) - 1, most).round().astype(int))]
    for start in starts:
        yield slice(*np.searchsorted(numbers, [start, start + length]).tolist())


def first_window(
    times: FloatArray, numbers: NDArray[np.intp], teeth: int, orders: FloatArray, positions: FloatArray
) -> Window:
    """Window with mean rotation and orders of the first pickup, teeth at ``positions`` for the mean rotation."""
    begin, end = float(times[0]), float(times[-1])
    place = (2 * times - begin - end) / (end - begin)
    angle = 2 * np.pi * numbers / teeth
    powers = np.polynomial.legendre.legvander(place, MEAN_DEGREE)
    mean: FloatArray = np.asarray(np.linalg.lstsq(powers, angle, rcond=None)[0])
    # theta(t) = mean + vibration over the mean angle: the mean first without vibration, then with it.
    for step in range(MEAN_STEPS):
        base = powers @ mean
        terms = np.hstack([powers, _waves(orders, base)])
        if step == MEAN_STEPS - 1:
            break
        # The polynomial alone is moved on; the orders come from the last solution.
        mean += solved(terms, angle + positions[numbers % teeth] - base)[: MEAN_DEGREE + 1]
    speed = float(powers[-1] @ mean - powers[0] @ mean) / (end - begin)
    return Window(begin, end, speed, shown(terms, angle - base, numbers % teeth, teeth), mean)


def second_shown(
    window: Window, times: FloatArray, numbers: NDArray[np.intp], teeth: int, angle: float, orders: FloatArray
) -> Shown:
    """Solution of the pulses of a second pickup, ``angle`` rad behind the first, in the mean rotation of the first."""
    base = window.mean_rotation(times)
    terms = np.hstack([np.ones((len(times), 1)), _waves(orders, base)])
    return shown(terms, 2 * np.pi * numbers / teeth + angle - base, numbers % teeth, teeth)


def shown(terms: FloatArray, values: FloatArray, tooth: NDArray[np.intp], teeth: int) -> Shown:
    """Solution of the terms for the values (n,) in rad, and what an error of each tooth changes in it."""
    # The solution is linear in the teeth: (A^T A)^-1 A^T P, where P puts teeth to pulses and A^T P are sums by tooth.
    sums = np.zeros((teeth, terms.shape[1]))
    np.add.at(sums, tooth, terms)
    counts = np.bincount(tooth, minlength=teeth)
    with np.errstate(invalid="ignore"):
        means = np.bincount(tooth, values, minlength=teeth) / counts
    both = solved(terms, np.column_stack([values, np.zeros_like(values)]), sums.T)
    return Shown(both[:, 0], both[:, 2:], sums / np.maximum(counts, 1)[:, None], means)


def solved(terms: FloatArray, values: FloatArray, more: FloatArray | None = None) -> FloatArray:
    """Least squares solution for values (n,) or (n, m), and of further right-hand sides of the normal equations."""
    right = terms.T @ values
    if more is not None:
        right = np.hstack([right, more])
    return np.asarray(np.linalg.solve(terms.T @ terms, right))


def _waves(orders: FloatArray, angle: FloatArray) -> FloatArray:
    phases = angle[:, None] * orders
    return np.hstack([np.cos(phases), np.sin(phases)])


WINDOW_REVOLUTIONS, MOST_REVOLUTIONS = 8, 64
"""Revolutions of the wheel in a window, four cycles of a four-stroke engine, and at most so many where orders of the
vibration lie closer to whole ones of the wheel than these can part."""
MOST_WINDOWS = 200
"""Windows of a test at most, evenly over it, as more take time and the scatter is known by then."""
HIGHEST_SHARE = 5 / 6
"""Share of half the number of teeth up to which orders of vibration are sought; what is beyond counts as pattern."""
HIGHEST_ORDER = 40
"""Highest order of vibration sought per turn of the wheel, as an encoder of many pulses would take long, and shafts
hardly vibrate there."""
LEAST_AGREEMENT = 0.9
"""Least mean of the pointers of where, in a pitch, the second pickup's pulses fall: with less, they fall anywhere."""
MOST_PITCH_SHARE = 0.4
"""Largest distance from the given angle between two pickups in pitches: next to half a pitch two teeth are as near."""


@dataclass(frozen=True, eq=False)
class TestWindows:
    """Windows of a test with what the first pickup shows, and the second one where there is one.

    Attributes
    ----------
    windows : tuple of Window
    second : tuple of Shown
        Of the second pickup, empty without one.
    load : str
        Tests of one load have the same torques of the working gas at a speed.
    remarks : tuple of str
        On the pulses of the second pickup.
    """

    __test__ = False  # no test of pytest's

    windows: tuple[Window, ...]
    second: tuple[Shown, ...] = ()
    load: str = ""
    remarks: tuple[NoteOrText, ...] = ()


@dataclass(frozen=True, eq=False)
class OrderSet:
    """Orders per turn of the wheel that its vibration may have, and the whole ones that are the pattern's.

    Attributes
    ----------
    orders : (n,) array
        All that are sought.
    whole : tuple of int
        Whole orders sought.
    shared : frozenset of int
        Those of them that vibration may have, too.
    revolutions : int
        Of a window.
    """

    orders: FloatArray
    whole: tuple[int, ...]
    shared: frozenset[int]
    revolutions: int

    def place(self, order: int) -> int:
        """Index of a whole order among all."""
        return int(np.abs(self.orders - order).argmin())


def order_set(wheel: Wheel, cycle: int) -> OrderSet:
    """Orders of a wheel's turn for vibration that repeats after ``cycle`` revolutions of the reference shaft.

    Raises
    ------
    UsageError
        Orders of the vibration that are nearly, but not quite, whole ones of the wheel.
    """
    highest = min(HIGHEST_SHARE * (wheel.teeth - wheel.missing_teeth) / 2, HIGHEST_ORDER)
    # Vibration that repeats after some turns of the reference shaft has orders of the wheel in steps of ratio/cycle.
    step = wheel.ratio / cycle
    vibration = step * np.arange(1, int(highest / step + 1e-9) + 1)
    whole = np.arange(1, int(highest) + 1)
    # Whole orders that vibration may have, too, have to be told apart; the others are the pattern's own.
    near = np.abs(vibration[:, None] - whole) if len(vibration) else np.ones((1, len(whole)))
    shared = frozenset(whole[(near < 1e-6).any(axis=0)].tolist())
    own = np.array([order for order in whole if order not in shared], dtype=float)
    orders = np.sort(np.concatenate([vibration, own]))
    # Windows of n turns part orders that are 1/n apart.
    gap = float(np.diff(orders).min()) if len(orders) > 1 else 1.0
    revolutions = max(WINDOW_REVOLUTIONS, math.ceil(1 / gap))
    if revolutions > MOST_REVOLUTIONS:
        raise UsageError(
            f"with {wheel.ratio:g} turns of the reference shaft per turn of the wheel, orders of its vibration lie "
            f"{gap:.3g} beside whole orders of the wheel, too near to tell them apart; calibrate on the wheel's own "
            "shaft",
            kind="unfit-order",
        )
    return OrderSet(orders, tuple(whole.tolist()), shared, revolutions)


def windows_of_test(
    name: str,
    times: FloatArray,
    numbers: NDArray[np.intp],
    second: PulseChannel | None,
    wheel: Wheel,
    orders: OrderSet,
    angle: float,
    positions: FloatArray,
    load: str = "",
) -> TestWindows:
    """Windows of one test, each solved for mean rotation and orders.

    ``times`` are those of the first pickup's pulses in s, ``numbers`` their teeth, counted on from turn to turn.

    Raises
    ------
    UsageError
        The test is shorter than a window, or the second pickup's pulses do not fit the angle.
    """
    teeth = wheel.teeth
    parts = list(spans(numbers, orders.revolutions * teeth, MOST_WINDOWS))
    if not parts:
        turns = (numbers[-1] - numbers[0]) / teeth
        raise UsageError(
            f"{name}: {turns:.3g} revolutions are too few, a window is of {orders.revolutions}", kind="too-short"
        )
    windows = tuple(first_window(times[part], numbers[part], teeth, orders.orders, positions) for part in parts)
    if second is None:
        return TestWindows(windows, (), load)
    try:
        pulses = repaired_pulses(second.times, teeth if wheel.missing_teeth else 0)
    except UsageError as error:
        by_gap = pulses_by_gap(second.times, wheel) if wheel.missing_teeth else None
        if by_gap is None:
            raise UsageError(f"{second.name}: {error}", kind=error.kind) from None
        pulses = by_gap
    stamps = pulses.times
    shown = []
    for window in windows:
        inside = stamps[slice(*np.searchsorted(stamps, [window.begin, window.end]).tolist())]
        if len(inside) < len(orders.orders) * 2 + 1:
            raise UsageError(
                f"{second.name} has {len(inside)} pulses from {window.begin:.6g} to {window.end:.6g} s",
                kind="lost-pulses",
            )
        # The shaft may vibrate by more than a pitch: the first pickup's pulses say where it is, not the mean rotation.
        passing = _tooth_numbers(second.name, np.interp(inside, times, numbers) - teeth * angle / (2 * np.pi), wheel)
        shown.append(second_shown(window, inside, passing, teeth, angle, orders.orders))
    return TestWindows(windows, tuple(shown), load, tuple(f"{second.name}: {text}" for text in pulses.remarks))


def _tooth_numbers(name: str, places: FloatArray, wheel: Wheel) -> NDArray[np.intp]:
    """Teeth of the pulses of the second pickup, by where they fall in the pitches of the first one's rotation."""
    # Mean pointer of the places within a pitch: near 1 where all pulses fall on the same place of it.
    pointer = complex(np.exp(2j * np.pi * places).mean())
    shift = float(np.angle(pointer)) / (2 * np.pi)
    pitch = 360 / wheel.teeth
    if abs(pointer) < LEAST_AGREEMENT:
        raise UsageError(
            f"{name} has no pulse for each tooth of the first pickup's wheel; are both on one wheel?",
            kind="unfit-wheel",
        )
    numbers = np.rint(places - shift).astype(np.intp)
    if (numbers % wheel.teeth >= wheel.teeth - wheel.missing_teeth).any():
        raise UsageError(
            f"{name}: by the angle given, it has pulses where the gap passes: the angle is from the first to the "
            "second pickup in the sense of rotation; are they exchanged?",
            kind="unfit-wheel",
        )
    if abs(shift) > MOST_PITCH_SHARE:
        raise UsageError(
            f"{name}: its pulses fall {shift * pitch:.3g} degrees from where the angle given puts them, of a pitch of "
            f"{pitch:g} degrees: which tooth passes cannot be told; measure the angle between the pickups anew",
            kind="ambiguous-tooth",
        )
    return numbers


@dataclass(frozen=True, eq=False)
class Stack:
    """Windows of all tests, one after the other.

    Attributes
    ----------
    tests : tuple of TestWindows
    speeds : (n,) array
        Mean speeds of the reference shaft, rad/s.
    loads : (n,) array of str
    """

    tests: tuple[TestWindows, ...]
    speeds: FloatArray
    loads: NDArray[np.str_]

    @property
    def first(self) -> list[Shown]:
        """Solutions of the first pickup, one for each window."""
        return [window.first for test in self.tests for window in test.windows]

    @property
    def second(self) -> list[Shown]:
        """Solutions of the second pickup, one for each window; empty unless every test has one."""
        every = all(test.second for test in self.tests)
        return [shown for test in self.tests for shown in test.second] if every else []

    @property
    def range_text(self) -> str:
        """Range of the speeds in rpm, in words."""
        low, high = float(self.speeds.min() * RPM), float(self.speeds.max() * RPM)
        return f"{low:.4g} to {high:.4g} rpm" if high > low * 1.001 else f"{low:.4g} rpm"


def stacked(tests: Sequence[TestWindows], wheel: Wheel) -> Stack:
    """Windows of all tests together, with the speeds of the reference shaft."""
    speeds = np.array([window.speed * wheel.ratio for test in tests for window in test.windows])
    loads = np.array([test.load for test in tests for _ in test.windows])
    return Stack(tuple(tests), speeds, loads)


def amplitudes(shown: Sequence[Shown], positions: FloatArray, count: int) -> ComplexArray:
    """Peak amplitudes in rad of every window and order, shape (n_windows, count), teeth at these positions."""
    return np.array([window.orders(positions, count) for window in shown])
