"""Complex orders of a measured signal over speed and time, with intervals."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.base.packages import SavedResult
from torsionnet.base.result_rows import NUMBER_ROWS, NUMBERS, Out
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.signals.recording import QUANTITY_UNITS

# Weights with which an order tracking takes the mean of the amplitude over time.

VOLD_KALMAN_POLES = 2
"""Poles of a Vold-Kalman filter of which only the bandwidth is given."""
REACH = 3.0
"""Reach of a Vold-Kalman filter over its inverse bandwidth: the weights further out are under 0.1 % of the largest."""
INDEPENDENT = 0.6
"""Distance of values over the inverse bandwidth from which their noise is nearly independent."""
FINEST, HIGHEST = 2000, 40.0
"""Points and end of the frequencies over bandwidth by which the weights of a filter are calculated."""


@dataclass(frozen=True)
class TrackingKernel:
    """Weights of an order tracking: a Vold-Kalman filter of a bandwidth, or blocks of revolutions; else none known.

    Attributes
    ----------
    bandwidth : float
        Width between the -3 dB points, Hz, 0 where it is none or a share.
    share : float
        Instead: bandwidth over the frequency of the order.
    poles : int
    revolutions : float
        Length of a block, 0 where there are none.
    taper : float
        Revolutions over which its weights rise at one end and fall at the other, as half a Hann window.
    """

    bandwidth: float = 0.0
    share: float = 0.0
    poles: int = VOLD_KALMAN_POLES
    revolutions: float = 0.0
    taper: float = 0.0

    @property
    def known(self) -> bool:
        """Whether it is known how the order was tracked."""
        return bool(self.bandwidth or self.share or self.revolutions)

    def reach(self, speed: float, order: float) -> float:
        """Time in s on either side of a value over which it is a mean, at a speed in rad/s; 0: not known."""
        if self.revolutions:
            return self.revolutions * np.pi / speed
        return REACH / self._width(speed, order) if self.known else 0.0

    def distance(self, speed: float, order: float) -> float:
        """Time in s between values whose noise is nearly independent, at a speed in rad/s; 0: not known."""
        if self.revolutions:
            return (self.revolutions - self.taper) * 2 * np.pi / speed
        return INDEPENDENT / self._width(speed, order) if self.known else 0.0

    def weights(self, times: FloatArray, speed: float, order: float) -> FloatArray:
        """Relative weights at times in s from a value, shape (n,), at a speed in rad/s."""
        if self.revolutions:
            # Flanks of half a cosine over the taper, 1 between them: the sum of Hann windows a cycle apart.
            inside = (self.revolutions / 2 - np.abs(times) * speed / (2 * np.pi)) / self.taper
            return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.clip(inside, 0, 1)))
        at, heights = _filter_weights(self.poles)
        return np.interp(np.abs(times) * self._width(speed, order), at, heights)

    def _width(self, speed: float, order: float) -> float:
        return self.bandwidth or self.share * order * speed / (2 * np.pi)


UNKNOWN_TRACKING = TrackingKernel()
"""Weights of which nothing is known."""


def _filter_weights(poles: int) -> tuple[FloatArray, FloatArray]:
    """Times over the inverse bandwidth, and weights of the filter 1/(1 + (sqrt 2 - 1) (2 f/bandwidth)^(2 poles))."""
    f = np.linspace(0, HIGHEST, FINEST * 4)
    # 3 dB down at f = bandwidth/2; the weights are its inverse Fourier transform, an even one.
    transmitted = 1 / (1 + (np.sqrt(2) - 1) * (2 * f) ** (2 * poles))
    at = np.linspace(0, REACH, FINEST // 10)
    return at, np.asarray(np.trapezoid(transmitted * np.cos(2 * np.pi * np.outer(at, f)), f, axis=1))


@dataclass(frozen=True, eq=False)
class MeasuredOrder:
    """Measured peak amplitudes of one order in SI units over speed in rad/s.

    Attributes
    ----------
    order : float
        Vibrations per revolution of the reference shaft.
    speeds : (n,) array
        Speeds in rad/s, rising.
    amplitude : (n,) array
        Peak amplitudes, SI.
    values : (n,) complex array, optional
        Complex peak amplitudes X of Re X exp(j o phi), SI; None where phases are not known.
    half_widths : (n,) array, optional
        Half width of the 95 % interval of real and of imaginary part, SI.
    """

    order: float
    speeds: FloatArray
    amplitude: FloatArray
    values: ComplexArray | None = None
    half_widths: FloatArray | None = None


@dataclass(frozen=True, eq=False, repr=False)
class TrackedOrders(SavedResult):
    """Complex peak amplitudes of the orders of one measured signal in SI, shape (n_orders, n_times).

    The signal is Re sum_o X_o exp(j o phi) with phi the mean angle of rotation of the reference shaft, 0 where
    ``reference`` says: the convention of calculated order responses.

    Attributes
    ----------
    name : str
        Channel.
    quantity : str
        A key of ``QUANTITY_UNITS``.
    orders : (n_orders,) array
        Vibrations per revolution of the reference shaft, rising.
    times : (n_times,) array
        s, the middle of what each value is taken from.
    speeds : (n_times,) array
        Mean speed of the reference shaft, rad/s.
    values : (n_orders, n_times) complex array
        Peak amplitudes, SI.
    half_widths : (n_orders, n_times) array
        Half width of the 95 % interval of real and of imaginary part, SI; NaN where it is not known.
    half_range : (n_times,) array, optional
        (max - min)/2 of the signal over a cycle, SI.
    reference : str
        Where phi is 0, in words; empty where phases have no reference and only amplitudes can be compared.
    title : str
    notes : tuple of str or Note
        Method, bandwidth, repairs.
    undecided : tuple of float
        Orders whose sign is not known, since which turn of a cycle begins at the reference is not: their values are
        amplitudes, without a phase.
    related_within : tuple of float
        For each order the time in s within which values share data: the noise of two values dt apart has about the
        correlation 1 - dt/related_within. Empty where values are independent, as averages over blocks are.
    tracking : TrackingKernel
        Filter or blocks by which the orders were tracked, as far as known.

    Examples
    --------
    >>> tracked = TrackedOrders(
    ...     "T", "torque", np.array([6.0]), np.array([0.0, 1.0]), np.array([10.0, 20.0]),
    ...     np.array([[3j, 4]]), np.zeros((1, 2)), reference="top dead centre of cylinder 1",
    ... )
    >>> tracked.along(6).tolist(), tracked.measured()[0].amplitude.tolist()
    ([3j, (4+0j)], [3.0, 4.0])
    """

    picture: ClassVar[str] = "tracked_orders"
    SHOWN: ClassVar = (
        "name", "unit", "reference", "undecided", "notes", "orders", "times", "rpm", "real", "imag", "half_widths",
        "half_range",
    )  # fmt: skip

    name: Annotated[str, Out(json="channel")]
    quantity: str
    orders: FloatArray
    times: Annotated[FloatArray, Out(json="times_s")]
    speeds: FloatArray
    values: ComplexArray
    half_widths: Annotated[FloatArray, Out(schema=NUMBER_ROWS)]
    half_range: Annotated[FloatArray | None, Out(schema={"type": ["array", "null"], "items": NUMBERS["items"]})] = None
    reference: str = ""
    title: str = ""
    notes: tuple[NoteOrText, ...] = ()
    undecided: Annotated[tuple[float, ...], Out(schema={**NUMBERS, "description": "orders without a phase"})] = ()
    related_within: tuple[float, ...] = ()
    tracking: TrackingKernel = UNKNOWN_TRACKING

    @property
    def unit(self) -> str:
        """SI unit of the amplitudes of tracked orders."""
        return QUANTITY_UNITS.get(self.quantity, "")

    @property
    def rpm(self) -> Annotated[FloatArray, Out(json="speeds_rpm")]:
        """Speeds of the reference shaft in r/min, shape (n_times,)."""
        return np.asarray(self.speeds * RPM)

    @property
    def real(self) -> Annotated[FloatArray, Out(schema=NUMBER_ROWS)]:
        """Real parts of the peak amplitudes, SI, shape (n_orders, n_times)."""
        return self.values.real

    @property
    def imag(self) -> Annotated[FloatArray, Out(schema=NUMBER_ROWS)]:
        """Imaginary parts of the peak amplitudes, SI, shape (n_orders, n_times)."""
        return self.values.imag

    def along(self, order: float) -> ComplexArray:
        """Complex peak amplitudes of one order in SI units over time, shape (n_times,).

        Raises
        ------
        UsageError
            The order was not tracked.
        """
        place = int(np.abs(self.orders - order).argmin())
        if abs(self.orders[place] - order) > 1e-6:
            raise UsageError(
                f"order {order:g} was not tracked; there are {', '.join(f'{o:g}' for o in self.orders)}",
                kind="unknown-order",
            )
        return np.asarray(self.values[place])

    def measured(self) -> tuple[MeasuredOrder, ...]:
        """Orders of the signal over rising speed, to lay beside calculated ones; without phases that are not known."""
        rising = np.argsort(self.speeds, kind="stable")
        rising = rising[np.r_[True, np.diff(self.speeds[rising]) > 0]]
        values = self.values[:, rising] if self.reference else None
        return tuple(
            MeasuredOrder(
                float(order),
                self.speeds[rising],
                np.abs(self.values[place, rising]),
                None if values is None or float(order) in self.undecided else values[place],
                self.half_widths[place, rising],
            )
            for place, order in enumerate(self.orders)
        )

    def table(self, conventions: Conventions = SI) -> Table:
        """Table of the largest amplitude of each order, with its speed, phase and interval."""
        scale, unit = conventions.scale(self.unit), conventions.unit(self.unit)
        rows = []
        for place, order in enumerate(self.orders.tolist()):
            at = int(np.abs(self.values[place]).argmax())
            value, width = complex(self.values[place, at]), float(self.half_widths[place, at])
            known = bool(self.reference) and order not in self.undecided
            rows.append((
                order, float(self.rpm[at]), abs(value) * scale, None if np.isnan(width) else width * scale,
                float(np.degrees(np.angle(value))) if known else None,
                float(np.degrees(np.arctan2(width, abs(value)))) if known and not np.isnan(width) else None,
            ))  # fmt: skip
        columns = (
            Column("order"), Column("speed", "rpm", 5), Column("largest amplitude", unit, 4), Column("+-", unit, 2),
            Column("phase", "deg", 5, 2), Column("+-", "deg", 2),
        )  # fmt: skip
        where = f"phases from {self.reference}" if self.reference else "no phases: the record has no reference for them"
        half = () if self.half_range is None else (
            f"largest half range {self.half_range.max() * scale:.4g} {unit} at "
            f"{self.rpm[int(self.half_range.argmax())]:.5g} rpm",
        )  # fmt: skip
        title = f"{self.title}: {self.name}" if self.title else self.name
        return Table(f"{title}, {len(self.times)} speeds", columns, tuple(rows), (*half, where, *map(str, self.notes)))


# Orders derived from tracked ones: stress from torque, and slices over speed.

FEWEST_VALUES = 3
"""Fewest values in a bin of speeds from whose scatter an interval is made."""
LEVEL = 0.975
"""Quantile of Student's distribution for the half width of a 95 % interval."""


def stress_orders(torque: TrackedOrders, diameter: float) -> TrackedOrders:
    """Orders of the shear stress in Pa at the surface of a round shaft, 16 T/(pi d^3), from its torque.

    Parameters
    ----------
    torque : TrackedOrders
        Orders of a torque, N m.
    diameter : float
        m.

    Raises
    ------
    UsageError
        The channel is no torque, or the diameter is not positive.

    Examples
    --------
    >>> tracked = TrackedOrders(
    ...     "T", "torque", np.array([6.0]), np.zeros(1), np.ones(1), np.array([[np.pi / 16 + 0j]]), np.zeros((1, 1))
    ... )
    >>> stress_orders(tracked, 0.1).along(6).round(6).tolist()
    [(1000+0j)]
    """
    if torque.quantity != "torque":
        raise UsageError(
            f"{torque.name} is {torque.quantity or 'of no known quantity'}: a stress needs a torque",
            kind="unfit-channel",
        )
    if not diameter > 0:
        raise UsageError(f"the diameter of a shaft is positive, got {diameter:g} m", kind="out-of-range")
    # tau = T/W, W = pi d^3/16.
    factor = 16 / (np.pi * diameter**3)
    return replace(
        torque,
        name=f"stress({torque.name})",
        quantity="stress",
        values=torque.values * factor,
        half_widths=torque.half_widths * factor,
        half_range=None if torque.half_range is None else torque.half_range * factor,
        notes=(*torque.notes, f"stress of a diameter of {1e3 * diameter:.6g} mm"),
    )


def order_slices(tracked: TrackedOrders, step: float) -> TrackedOrders:
    """Complex orders in SI averaged in bins of speed, over rising speed.

    The half width of a bin is that of its values (root mean square: what the values share does not average out), or
    that which their scatter about a straight line over speed leaves in their mean, if that is larger.

    Parameters
    ----------
    tracked : TrackedOrders
        Orders over time, of one run or of several one after the other.
    step : float
        Width of a bin, rad/s.

    Raises
    ------
    UsageError
        The step is not positive.

    Examples
    --------
    >>> tracked = TrackedOrders(
    ...     "T", "torque", np.array([6.0]), np.arange(4.0), np.array([10.0, 11.0, 20.0, 21.0]),
    ...     np.array([[1, 3, 5, 7 + 0j]]), np.full((1, 4), 0.1), reference="tooth 0",
    ... )
    >>> order_slices(tracked, 10.0).along(6).tolist()
    [(2+0j), (6+0j)]
    """
    if not step > 0:
        raise UsageError(f"the step of speed must be positive, got {step * RPM:g} rpm", kind="out-of-range")
    bins = np.floor(tracked.speeds / step).astype(np.intp)
    numbers = np.unique(bins)
    members = [np.flatnonzero(bins == number) for number in numbers]
    values = np.array([tracked.values[:, inside].mean(axis=1) for inside in members]).T
    widths = np.array([_half_width(tracked, inside) for inside in members]).T
    half = tracked.half_range
    return replace(
        tracked,
        times=np.array([tracked.times[inside].mean() for inside in members]),
        speeds=np.array([tracked.speeds[inside].mean() for inside in members]),
        values=values,
        half_widths=widths,
        half_range=None if half is None else np.array([half[inside].max() for inside in members]),
        notes=(*tracked.notes, f"averaged in bins of {step * RPM:.4g} rpm; of half ranges the largest"),
    )


def _half_width(tracked: TrackedOrders, places: NDArray[np.intp]) -> FloatArray:
    """Half width of each order in one bin of speeds, SI, shape (n_orders,)."""
    from scipy.stats import t

    own = np.sqrt(np.mean(tracked.half_widths[:, places] ** 2, axis=1))
    count = len(places)
    if count < FEWEST_VALUES:
        return np.asarray(own)
    # An order changes with speed within its bin: only what a straight line over speed leaves is scatter.
    speeds = tracked.speeds[places] - tracked.speeds[places].mean()
    values = tracked.values[:, places]
    rest = values - values.mean(axis=1, keepdims=True)
    if (speeds**2).sum() > 0:
        rest = rest - np.outer((rest * speeds).sum(axis=1) / (speeds**2).sum(), speeds)
    # Half of the variance for the real part, with two of the values used up by mean and slope.
    spread = (np.abs(rest) ** 2).sum(axis=1) / (2 * (count - 2))
    scatter = t.ppf(LEVEL, 2 * (count - 2)) * np.sqrt(spread / count)
    return np.asarray(np.fmax(own, scatter))
