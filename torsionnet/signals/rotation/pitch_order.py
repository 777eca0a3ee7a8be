"""Whole orders of a wheel's pitch pattern, and the methods by which a calibration finds them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.result_rows import Out
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.wheel import Wheel

# Calculated orders of the angle of a wheel, by which a calibration tells vibration from the wheel's pitch pattern.

SPEED_MARGIN = 0.01
"""Share by which a speed of a test may lie beyond the calculated ones, as that of a governed engine wanders."""


@dataclass(frozen=True, eq=False)
class CalculatedOrders:
    """Response of the reference shaft's angle at the wheel in rad, known or but for complex factors.

    Attributes
    ----------
    speeds : (n_speeds,) array
        Speeds of the reference shaft, rad/s, rising.
    orders : (n_orders,) array
        Per revolution of the reference shaft, rising.
    known : (n_orders, n_speeds) complex array
        Peak amplitudes that are known, rad: the response to inertia torques, which masses and lengths decide.
    shapes : (n_parts, n_orders, n_speeds) complex array
        Responses whose size and phase the test decides, one factor for each part, order and load: to gas torques.
    zero : float
        Angle of the reference shaft at tooth 0, rad, in the convention of the amplitudes: 0 where top dead centre of
        the first cylinder and tooth 0 pass together.
    source : str
        Model and what acts in it.

    Raises
    ------
    UsageError
        Shapes that do not fit, or speeds that do not rise.
    """

    speeds: FloatArray
    orders: FloatArray
    known: ComplexArray
    shapes: ComplexArray
    zero: float = 0.0
    source: str = ""

    def __post_init__(self) -> None:
        shape = (len(self.orders), len(self.speeds))
        if self.known.shape != shape or self.shapes.shape[1:] != shape or self.shapes.ndim != 3:
            raise UsageError(
                f"calculated orders have a value for each of {shape[0]} orders and {shape[1]} speeds",
                kind="wrong-count",
            )
        if len(self.speeds) > 1 and not (np.diff(self.speeds) > 0).all():
            raise UsageError("the speeds of calculated orders have to rise", kind="unordered-rows")

    def place(self, order: float) -> int | None:
        """Index of an order of the reference shaft, None where it was not calculated."""
        near = np.flatnonzero(np.abs(self.orders - order) < 1e-6)
        return int(near[0]) if len(near) else None

    def at(self, order: float, speeds: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Known amplitudes (n,) and shapes (n, n_parts) of an order in rad at speeds in rad/s, by cubic splines.

        Raises
        ------
        UsageError
            A speed lies beyond those calculated, or the order was not calculated.
        """
        place = self.place(order)
        if place is None:
            raise UsageError(f"order {order:g} was not calculated", kind="unknown-order")
        low, high = self.speeds[0] * (1 - SPEED_MARGIN), self.speeds[-1] * (1 + SPEED_MARGIN)
        if speeds.min() < low or speeds.max() > high:
            raise UsageError(
                f"the test turns at {speeds.min() * RPM:.4g} to {speeds.max() * RPM:.4g} rpm, but orders were "
                f"calculated for {self.speeds[0] * RPM:.4g} to {self.speeds[-1] * RPM:.4g} rpm",
                kind="beyond-table",
            )
        # From the zero of the calculation to tooth 0: X exp(j o zero).
        turning = np.exp(1j * order * self.zero)
        both = np.vstack([self.known[place], self.shapes[:, place]]) * turning
        values = self._between(both, np.clip(speeds, self.speeds[0], self.speeds[-1]))
        return values[0], values[1:].T

    def _between(self, values: ComplexArray, speeds: FloatArray) -> ComplexArray:
        if len(self.speeds) < 2:
            return np.repeat(values[:, :1], len(speeds), axis=1)
        from scipy.interpolate import make_interp_spline

        degree = 3 if len(self.speeds) > 3 else 1
        return np.asarray(make_interp_spline(self.speeds, values, k=degree, axis=1)(speeds))


# The part of a complex amplitude that stays the same over speed, with an interval from revolutions and speeds.

CONFIDENCE = 0.95
"""Confidence of the intervals of a wheel's pitch pattern, as of all measured orders."""
NORMAL = 10**6
"""Degrees of freedom of what is known without an estimate."""
SAME_SPEED = 0.02
"""Relative width of the speeds that count as one: a governed speed wanders less, and steps of a test are wider."""


@dataclass(frozen=True)
class ConstantPart:
    """Constant part of a complex amplitude over speed, in the unit of the amplitude.

    Attributes
    ----------
    value : complex
    half_width : float
        Half width of the 95 % interval of real and of imaginary part; infinite where nothing is left to judge by.
    change : float
        Largest distance of the part that varies from its mean.
    scatter : float
        Standard deviation of what neither explains, from window to window.
    between : bool
        Whether the speeds scatter more than the windows at one speed, and the interval is from the speeds.
    """

    value: complex
    half_width: float
    change: float
    scatter: float
    between: bool = False


def speed_groups(speeds: FloatArray) -> NDArray[np.intp]:
    """Number of the group of about equal speeds that each belongs to, shape (n,), counted over rising speed.

    >>> speed_groups(np.array([100.0, 50, 100.5, 101, 49.5])).tolist()
    [1, 0, 1, 1, 0]
    """
    groups, group, start = np.zeros(len(speeds), dtype=np.intp), -1, 0.0
    for place in np.argsort(speeds, kind="stable"):
        if group < 0 or speeds[place] > start * (1 + SAME_SPEED):
            group, start = group + 1, float(speeds[place])
        groups[place] = group
    return groups


def constant_part(
    values: ComplexArray, columns: ComplexArray, groups: NDArray[np.intp], repeating: FloatArray | None = None
) -> ConstantPart:
    """Constant part of values (n,) of which the rest is a sum of columns (n, m), each with a complex factor.

    The scatter of the means of the groups, of which each is a speed, counts where an F test at 5 % finds it larger than
    that of single values; else the interval would be too narrow. ``repeating`` (n,) is a standard deviation of real and
    imaginary part that all values of a group have in common; where the scatter of the speeds counts, it is in that.

    Examples
    --------
    >>> speed = np.array([1.0, 2.0, 4.0, 5.0])
    >>> part = constant_part(3j + 2 / speed**2, (1 / speed**2)[:, None].astype(complex), np.arange(4))
    >>> bool(abs(part.value - 3j) < 1e-9), bool(part.half_width < 1e-9)
    (True, True)
    """
    # Columns scaled to a largest value of 1; those of no vibration at all would make the fit singular.
    sizes = np.abs(columns).max(axis=0, initial=0.0)
    columns = columns[:, sizes > 0] / sizes[sizes > 0]
    terms = np.column_stack([np.ones(len(values), dtype=complex), columns])
    unknown = terms.shape[1]
    count = np.bincount(groups)
    if len(count) < unknown:  # the speeds are too few to part what is constant from what varies
        return ConstantPart(complex(values.mean()), np.inf, 0.0, float(np.std(values)))
    factors, error, freedom = _fit(terms, values, np.ones(len(values)))
    varying = columns @ factors[1:]
    change = float(np.abs(varying - varying.mean()).max())
    if freedom <= 0:
        return ConstantPart(complex(factors[0]), np.inf, change, 0.0)
    scatter, spread = np.sqrt(error), _spread(terms, np.ones(len(values)))
    value, between = complex(factors[0]), False
    places = np.array([terms[groups == group].mean(axis=0) for group in range(len(count))])
    # Windows at one speed have what differs between the speeds in common: then the speeds count, not the windows.
    if unknown < len(count) < len(values):
        means = np.array([values[groups == group].mean() for group in range(len(count))])
        _, of_speeds, few = _fit(places, means, count.astype(float))
        # Squares within the speeds are the whole ones less those between.
        rest = max(error * freedom - of_speeds * few, 0.0)
        inside = rest / (len(values) - len(count))
        if inside == 0 or of_speeds / inside > _fisher(2 * few, 2 * (len(values) - len(count))):
            error, freedom, between = of_speeds, few, True
    # Real and imaginary part have half the variance each, and together twice the degrees of freedom.
    half = student_quantile(2 * freedom) * np.sqrt(error / 2) * spread
    if repeating is not None and not between:
        half = np.hypot(
            half, student_quantile(NORMAL) * np.sqrt(np.mean(repeating**2)) * _spread(places, np.ones(len(count)))
        )
    return ConstantPart(value, float(half), change, float(scatter), between)


def _fit(terms: ComplexArray, values: ComplexArray, weights: FloatArray) -> tuple[ComplexArray, float, int]:
    """Factors of the terms, the variance of a single complex value about them, and its degrees of freedom."""
    # Weighted least squares: rows times sqrt(w); variance = sum w r^2 over the degrees of freedom.
    root = np.sqrt(weights)
    factors = np.linalg.lstsq(terms * root[:, None], values * root, rcond=None)[0]
    freedom = len(values) - terms.shape[1]
    left = float((weights * np.abs(values - terms @ factors) ** 2).sum())
    return np.asarray(factors), left / max(freedom, 1), freedom


def _spread(terms: ComplexArray, weights: FloatArray) -> float:
    """Standard deviation of the constant per standard deviation of a value."""
    inverse = np.linalg.pinv((terms.conj().T * weights) @ terms)
    return float(np.sqrt(inverse[0, 0].real))


def student_quantile(freedom: int | NDArray[np.intp]) -> FloatArray:
    """Half width of the 95 % interval of a mean over its standard error, by degrees of freedom.

    >>> student_quantile(10).round(3).item()
    2.228
    """
    from scipy.special import stdtrit

    return np.asarray(stdtrit(freedom, 0.5 + CONFIDENCE / 2))


def _fisher(above: int, below: int) -> float:
    from scipy.special import fdtri

    return float(fdtri(above, below, CONFIDENCE))


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
    value: Annotated[complex, Out(json="amplitude_rad")]
    half_width: Annotated[float, Out(json="half_width_rad")]
    resolved: bool
    by: str
    gain: float | None = None
    change: Annotated[float, Out(json="vibration_changes_by_rad")] = 0.0
    scatter: Annotated[float, Out(json="scatter_rad")] = 0.0
    why: Annotated[str, Out(json="why_not_resolved")] = ""


def repeating_error(once: FloatArray, seen: float) -> FloatArray:
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
    """Evidence that tells the pattern from vibration: second pickup, calculated orders, or the speeds alone.

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
        # Vibration has no such order: what is read there is -P alone.
        if not shared:
            return self._judged(order, self._alone(-first), NO_VIBRATION, gain)
        # The second pickup reads V - P exp(-j o alpha), the first V - P: in the difference V drops out.
        if second is not None and gain is not None and self.angle is not None and gain >= LEAST_GAIN:
            constant = self._alone((second - first) / (1 - np.exp(-1j * order * self.angle)), np.sqrt(2) / gain)
            return self._judged(order, constant, TWO_PICKUPS, gain)
        if self.calculated is not None:
            if self.calculated.place(relative) is None:
                return self._judged(order, self._alone(-first), ABOVE_CALCULATED, gain)
            # V - (V - P) is P, but for the gas torques' part of V: a factor of its own for each load and shape.
            known, shapes = self._calculated(self.calculated, relative)
            return self._judged(order, self._constant(known - first, self._by_load(shapes)), CALCULATED, gain)
        if second is not None:
            constant = self._alone(-first)
            at = np.degrees(self.angle or 0)
            why = f"pickups at {at:.5g} degrees are blind there; calculated orders of a model, or another angle, tell"
            return PitchOrder(
                order, constant.value, constant.half_width, False, SPEEDS, gain, 0.0, constant.scatter, why
            )
        # With one pickup P is what stays over speed, while V follows the shapes of a rigid shaft and of the poles.
        constant = self._constant(-first, self._by_load(self._shapes(relative)))
        judged = self._judged(order, constant, SPEEDS, gain)
        if self.constant_orders is None or any(abs(relative - other) < 1e-6 for other in self.constant_orders):
            why = CONSTANT_TOO
            return PitchOrder(
                order, judged.value, judged.half_width, False, SPEEDS, gain, judged.change, judged.scatter, why
            )
        return judged

    def _judged(self, order: int, constant: ConstantPart, by: str, gain: float | None) -> PitchOrder:
        resolved = constant.half_width <= self.widest
        why = "" if resolved else self._too_wide(constant)
        return PitchOrder(
            order, constant.value, constant.half_width, resolved, by, gain, constant.change, constant.scatter, why
        )  # fmt: skip

    def _too_wide(self, constant: ConstantPart) -> str:
        low, high = self.speeds.min() * RPM, self.speeds.max() * RPM
        return (
            f"over {low:.4g} to {high:.4g} rpm the vibration changes by {np.degrees(constant.change):.2g} degrees, the "
            f"scatter is {np.degrees(constant.scatter):.2g}; a wider range of speeds, or longer records, help"
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
        # Variance of real and of imaginary part between windows of one speed, for a single period.
        inside = [values[self.groups == group] for group in range(self.groups.max() + 1)]
        spread = sum(float((np.abs(at_speed - at_speed.mean()) ** 2).sum()) for at_speed in inside)
        seen = self.periods * spread / 2 / max(len(values) - len(inside), 1)
        return constant_part(values, columns, self.groups, repeating_error(once**2, seen))

    def _shapes(self, relative: float) -> ComplexArray:
        """Vibration under a torque that does not change with speed: of a rigid shaft, and near each pole."""
        # Torque of one size: a rigid shaft answers with 1/omega^2, a mode with 1/((p - j omega)(p* - j omega)).
        frequency = relative * self.speeds
        rigid = [(self.speeds.max() / self.speeds) ** 2 + 0j]
        near = [1 / ((pole - 1j * frequency) * (pole.conjugate() - 1j * frequency)) for pole in self.poles]
        return np.column_stack([*rigid, *(resonance / np.abs(resonance).max() for resonance in near)])

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
