"""Windows of all tests of a calibration: what one or two pickups show in each order of the wheel's turn."""

from __future__ import annotations

import math
from collections.abc import Sequence
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
from torsionnet.signals.rotation.wheel_windows import Shown, Window, first_window, second_shown, spans

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
    step = wheel.ratio / cycle
    vibration = step * np.arange(1, int(highest / step + 1e-9) + 1)
    whole = np.arange(1, int(highest) + 1)
    near = np.abs(vibration[:, None] - whole) if len(vibration) else np.ones((1, len(whole)))
    shared = frozenset(whole[(near < 1e-6).any(axis=0)].tolist())
    own = np.array([order for order in whole if order not in shared], dtype=float)
    orders = np.sort(np.concatenate([vibration, own]))
    gap = float(np.diff(orders).min()) if len(orders) > 1 else 1.0
    revolutions = max(WINDOW_REVOLUTIONS, math.ceil(1 / gap))
    if revolutions > MOST_REVOLUTIONS:
        raise UsageError(
            f"with {wheel.ratio:g} turns of the reference shaft per turn of the wheel, orders of its vibration lie "
            f"{gap:.3g} beside whole orders of the wheel, too near to tell them apart; calibrate on the wheel's own "
            "shaft"
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
        raise UsageError(f"{name}: {turns:.3g} revolutions are too few, a window is of {orders.revolutions}")
    windows = tuple(first_window(times[part], numbers[part], teeth, orders.orders, positions) for part in parts)
    if second is None:
        return TestWindows(windows, (), load)
    try:
        found = repaired_pulses(second.times, teeth if wheel.missing_teeth else 0)
    except UsageError as error:
        by_gap = pulses_by_gap(second.times, wheel) if wheel.missing_teeth else None
        if by_gap is None:
            raise UsageError(f"{second.name}: {error}") from None
        found = by_gap
    stamps = found.times
    shown = []
    for window in windows:
        inside = stamps[slice(*np.searchsorted(stamps, [window.begin, window.end]).tolist())]
        if len(inside) < len(orders.orders) * 2 + 1:
            raise UsageError(f"{second.name} has {len(inside)} pulses from {window.begin:.6g} to {window.end:.6g} s")
        # The shaft may vibrate by more than a pitch: the first pickup's pulses say where it is, not the mean rotation.
        passing = _numbers(second.name, np.interp(inside, times, numbers) - teeth * angle / (2 * np.pi), wheel)
        shown.append(second_shown(window, inside, passing, teeth, angle, orders.orders))
    return TestWindows(windows, tuple(shown), load, tuple(f"{second.name}: {text}" for text in found.remarks))


def _numbers(name: str, places: FloatArray, wheel: Wheel) -> NDArray[np.intp]:
    """Teeth of the pulses of the second pickup, by where they fall in the pitches of the first one's rotation."""
    pointer = complex(np.exp(2j * np.pi * places).mean())
    shift = float(np.angle(pointer)) / (2 * np.pi)
    pitch = 360 / wheel.teeth
    if abs(pointer) < LEAST_AGREEMENT:
        raise UsageError(f"{name} has no pulse for each tooth of the first pickup's wheel; are both on one wheel?")
    numbers = np.rint(places - shift).astype(np.intp)
    if (numbers % wheel.teeth >= wheel.teeth - wheel.missing_teeth).any():
        raise UsageError(
            f"{name}: by the angle given, it has pulses where the gap passes: the angle is from the first to the "
            "second pickup in the sense of rotation; are they exchanged?"
        )
    if abs(shift) > MOST_PITCH_SHARE:
        raise UsageError(
            f"{name}: its pulses fall {shift * pitch:.3g} degrees from where the angle given puts them, of a pitch of "
            f"{pitch:g} degrees: which tooth passes cannot be told; measure the angle between the pickups anew"
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
    return np.array([one.orders(positions, count) for one in shown])
