"""Complex orders of a measured signal over speed and time, with intervals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.core.errors import UsageError
from torsionnet.core.notebook import NotebookResult
from torsionnet.core.units import RPM
from torsionnet.response.frequency_response import ComplexArray, FloatArray
from torsionnet.response.order_comparison import MeasuredOrder
from torsionnet.response.recording import QUANTITY_UNITS


@dataclass(frozen=True, eq=False, repr=False)
class TrackedOrders(NotebookResult):
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
    notes : tuple of str
        Method, bandwidth, repairs.
    undecided : tuple of float
        Orders whose sign is not known, since which turn of a cycle begins at the reference is not: their values are
        amplitudes, without a phase.

    Examples
    --------
    >>> one = TrackedOrders(
    ...     "T", "torque", np.array([6.0]), np.array([0.0, 1.0]), np.array([10.0, 20.0]),
    ...     np.array([[3j, 4]]), np.zeros((1, 2)), reference="top dead centre of cylinder 1",
    ... )
    >>> one.along(6).tolist(), one.measured()[0].amplitude.tolist()
    ([3j, (4+0j)], [3.0, 4.0])
    """

    picture: ClassVar[str] = "tracked_orders"

    name: str
    quantity: str
    orders: FloatArray
    times: FloatArray
    speeds: FloatArray
    values: ComplexArray
    half_widths: FloatArray
    half_range: FloatArray | None = None
    reference: str = ""
    title: str = ""
    notes: tuple[str, ...] = ()
    undecided: tuple[float, ...] = ()

    @property
    def unit(self) -> str:
        """SI unit of the amplitudes of tracked orders."""
        return QUANTITY_UNITS.get(self.quantity, "")

    @property
    def rpm(self) -> FloatArray:
        """Speeds of the reference shaft in r/min, shape (n_times,)."""
        return np.asarray(self.speeds * RPM)

    def along(self, order: float) -> ComplexArray:
        """Complex peak amplitudes of one order in SI units over time, shape (n_times,).

        Raises
        ------
        UsageError
            The order was not tracked.
        """
        place = int(np.abs(self.orders - order).argmin())
        if abs(self.orders[place] - order) > 1e-6:
            raise UsageError(f"order {order:g} was not tracked; there are {', '.join(f'{o:g}' for o in self.orders)}")
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
