"""Whole orders of a wheel's pitch pattern, and the methods by which a calibration finds them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.calculated_orders import CalculatedOrders
from torsionnet.signals.rotation.constant_part import ConstantPart, constant_part
from torsionnet.signals.rotation.wheel import Wheel

LEAST_GAIN = 0.05
"""Least gain of two pickups in an order, of 2 at most, as below it errors grow more than twentyfold."""
RANDOM_SHARE = 0.25
"""Share of the variance that random steps of a counter leave between windows, below which they repeat with every turn:
of five windows, one in fifty shows less by chance."""
NO_VIBRATION, TWO_PICKUPS, CALCULATED = "no vibration there", "two pickups", "calculated orders"
CONSTANT_TOO = (
    "a rigid response to inertia torques, and a twist below resonance, are constant in angle, too; a second pickup, or "
    "the calculated orders of a model, tell"
)
ABOVE_CALCULATED, SPEEDS, ABOVE = "above the calculated orders", "speeds", "above the orders of vibration"


@dataclass(frozen=True)
class PitchOrder:
    """A whole order of the pitch pattern of a wheel.

    Attributes
    ----------
    order : int
        Per turn of the wheel.
    value : complex
        Peak amplitude P in rad of the positions Re P exp(j o theta) of the teeth; where it is not resolved, what is
        constant over speed, of which a part may be vibration.
    half_width : float
        Half width of the 95 % interval of real and of imaginary part, rad.
    resolved : bool
        Whether it is known to be the pattern's.
    by : str
        Method, in words.
    gain : float, optional
        Of two pickups, 2 sin(o alpha/2).
    change : float
        By how much the vibration varies over the speeds, rad.
    scatter : float
        Standard deviation from window to window, rad.
    why : str
        Why it is not resolved, and what would help.
    """

    order: int
    value: complex
    half_width: float
    resolved: bool
    by: str
    gain: float | None = None
    change: float = 0.0
    scatter: float = 0.0
    why: str = ""


def repeating(once: FloatArray, seen: float) -> FloatArray:
    """Standard deviation of errors that all windows have in common, from the variance that one period leaves.

    ``seen`` is the variance of one period that the scatter between windows shows; above the share that random errors
    may leave by chance, all may be random.
    """
    return np.sqrt(np.where(seen < RANDOM_SHARE * once, once - seen, 0.0))


def pickup_gains(angle: float, orders: ArrayLike) -> FloatArray:
    """Gain 2 sin(o alpha/2) of two pickups at an angle alpha in rad for each order, of which 0 is blind.

    Examples
    --------
    >>> pickup_gains(np.radians(114), range(1, 13)).round(2).min().item()
    0.31
    >>> pickup_gains(np.radians(180), [1, 2, 3]).round(9).tolist()
    [2.0, 0.0, 2.0]
    """
    return np.asarray(2 * np.abs(np.sin(np.asarray(orders, dtype=float) * angle / 2)))


@dataclass(frozen=True, eq=False)
class PitchEvidence:
    """PitchEvidence that tells the pattern from vibration: second pickup, calculated orders, or the speeds alone.

    Attributes
    ----------
    wheel : Wheel
    speeds : (n_windows,) array
        Of the reference shaft, rad/s.
    groups : (n_windows,) int array
        Groups of equal speed.
    loads : (n_windows,) array of str
    angle : float or None
        From first to second pickup, rad.
    calculated : CalculatedOrders or None
    constant_orders : tuple of float or None
        Orders of the reference shaft in which a part of the vibration may be constant over speed; None: not known.
    poles : (n_poles,) complex array
        Poles of the torsional vibration, rad/s.
    widest : float
        Widest half width of an interval that counts as resolved, rad.
    time : float
        Standard deviation that the step of a counter leaves in times of pulses, s.
    periods : float
        Of the vibration in a window: turns, or cycles where it has orders between whole ones.
    turns : float
        Of the wheel in a period.
    """

    wheel: Wheel
    speeds: FloatArray
    groups: NDArray[np.intp]
    loads: NDArray[np.str_]
    angle: float | None
    calculated: CalculatedOrders | None
    constant_orders: tuple[float, ...] | None
    poles: ComplexArray
    widest: float
    time: float = 0.0
    periods: float = 1.0
    turns: float = 1.0

    def of(self, order: int, shared: bool, first: ComplexArray, second: ComplexArray | None) -> PitchOrder:
        """Order of the pattern from its amplitudes (n_windows,) in rad at both pickups."""
        gain = None if self.angle is None else float(pickup_gains(self.angle, [order])[0])
        relative = order / self.wheel.ratio
        if not shared:
            return self._judged(order, self._alone(-first), NO_VIBRATION, gain)
        if second is not None and gain is not None and self.angle is not None and gain >= LEAST_GAIN:
            found = self._alone((second - first) / (1 - np.exp(-1j * order * self.angle)), np.sqrt(2) / gain)
            return self._judged(order, found, TWO_PICKUPS, gain)
        if self.calculated is not None:
            if self.calculated.place(relative) is None:
                return self._judged(order, self._alone(-first), ABOVE_CALCULATED, gain)
            known, shapes = self._calculated(self.calculated, relative)
            return self._judged(order, self._constant(known - first, self._by_load(shapes)), CALCULATED, gain)
        if second is not None:
            found = self._alone(-first)
            at = np.degrees(self.angle or 0)
            why = f"pickups at {at:.5g} degrees are blind there; calculated orders of a model, or another angle, tell"
            return PitchOrder(order, found.value, found.half_width, False, SPEEDS, gain, 0.0, found.scatter, why)
        found = self._constant(-first, self._by_load(self._shapes(relative)))
        one = self._judged(order, found, SPEEDS, gain)
        if self.constant_orders is None or any(abs(relative - other) < 1e-6 for other in self.constant_orders):
            why = CONSTANT_TOO
            return PitchOrder(order, one.value, one.half_width, False, SPEEDS, gain, one.change, one.scatter, why)
        return one

    def _judged(self, order: int, found: ConstantPart, by: str, gain: float | None) -> PitchOrder:
        resolved = found.half_width <= self.widest
        why = "" if resolved else self._too_wide(found)
        return PitchOrder(
            order, found.value, found.half_width, resolved, by, gain, found.change, found.scatter, why
        )  # fmt: skip

    def _too_wide(self, found: ConstantPart) -> str:
        low, high = self.speeds.min() * RPM, self.speeds.max() * RPM
        return (
            f"over {low:.4g} to {high:.4g} rpm the vibration changes by {np.degrees(found.change):.2g} degrees, the "
            f"scatter is {np.degrees(found.scatter):.2g}; a wider range of speeds, or longer records, help"
        )

    def _alone(self, values: ComplexArray, factor: float = 1.0) -> ConstantPart:
        return self._constant(values, np.empty((len(values), 0), dtype=complex), factor)

    def _constant(self, values: ComplexArray, columns: ComplexArray, factor: float = 1.0) -> ConstantPart:
        """Constant part, with the errors of the pulses' times that return with the vibration at a steady speed.

        A counter's steps do so where a period takes a whole number of them. Such an error is in all windows: what the
        pulses of one period leave, less what the scatter of the windows, each of several periods, shows of it.
        """
        there = self.wheel.teeth - self.wheel.missing_teeth
        once = factor * np.sqrt(2 / (there * self.turns)) * self.time * self.speeds / self.wheel.ratio
        inside = [values[self.groups == group] for group in range(self.groups.max() + 1)]
        spread = sum(float((np.abs(one - one.mean()) ** 2).sum()) for one in inside)
        seen = self.periods * spread / 2 / max(len(values) - len(inside), 1)
        return constant_part(values, columns, self.groups, repeating(once**2, seen))

    def _shapes(self, relative: float) -> ComplexArray:
        """Vibration under a torque that does not change with speed: of a rigid shaft, and near each pole."""
        frequency = relative * self.speeds
        rigid = [(self.speeds.max() / self.speeds) ** 2 + 0j]
        near = [1 / ((pole - 1j * frequency) * (pole.conjugate() - 1j * frequency)) for pole in self.poles]
        return np.column_stack([*rigid, *(one / np.abs(one).max() for one in near)])

    def _calculated(self, calculated: CalculatedOrders, relative: float) -> tuple[ComplexArray, ComplexArray]:
        """Known amplitudes (n,) and shapes (n, m) of the wheel's own angle in rad, 0 at its tooth 0."""
        known, shapes = calculated.at(relative, self.speeds)
        if self.wheel.reversed:
            known, shapes = -known.conj(), -shapes.conj()
        return known / self.wheel.ratio, shapes / self.wheel.ratio

    def _by_load(self, shapes: ComplexArray) -> ComplexArray:
        """Columns of the shapes, with factors of their own for each load."""
        of_loads = [shapes * (self.loads == load)[:, None] for load in dict.fromkeys(self.loads.tolist())]
        return np.hstack(of_loads)
