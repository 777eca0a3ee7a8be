"""Measured orders of a fit as lines: order, speed, complex amplitude and its standard deviation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import TypeAlias

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.base.errors import Fault, ModelError, UsageError, comma_list, did_you_mean, fault_of
from torsionnet.base.units import RPM
from torsionnet.identification.orders.parametric_orders import excited_orders, same_order
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.io.tracked_order_tables import is_tracked_table, read_orders, read_tracked_orders
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.transfer_request import named_output
from torsionnet.linear.frequency_response import Channel
from torsionnet.signals.orders.tracked_orders import MeasuredOrder, TrackedOrders

OrderData: TypeAlias = TrackedOrders | tuple[MeasuredOrder, ...]
"""Orders as a fit takes them: a tracked channel, or single orders of one output."""
DEVIATIONS_PER_HALF_WIDTH = 1.959964
"""Half width of a 95 % interval of a normal distribution over its standard deviation."""


@dataclass(frozen=True, eq=False)
class OrderLines:
    """Measured amplitudes of orders at speeds, sorted by order and speed, SI.

    Attributes
    ----------
    orders, speeds : (n_lines,) arrays
        Vibrations per revolution of the reference shaft, and its speed in rad/s.
    values : (n_lines,) complex array
        Peak amplitudes, SI; without phases the sizes.
    deviations : (n_lines,) array
        Standard deviation of real and of imaginary part, SI.
    is_known : bool
        Whether the deviations are stated or measured; else only their ratios are supposed.
    has_phase : bool
    left_out : tuple of float
        Orders of the test that the model does not excite.
    correlation : (n_lines, n_lines) sparse array, optional
        Correlation of the noise of the lines, None where they are independent.
    """

    orders: FloatArray
    speeds: FloatArray
    values: ComplexArray
    deviations: FloatArray
    is_known: bool
    has_phase: bool
    left_out: tuple[float, ...] = ()
    correlation: scipy.sparse.csr_array | None = None

    @property
    def runs(self) -> tuple[slice, ...]:
        """Slice of the lines of each order."""
        ends = [0, *(np.flatnonzero(np.diff(self.orders)) + 1).tolist(), len(self.orders)]
        return tuple(slice(first, last) for first, last in pairwise(ends))


def has_phases(data: OrderData) -> bool:
    """Whether all measured orders have phases against a reference, so that complex amplitudes can be compared."""
    if isinstance(data, TrackedOrders):
        return bool(data.reference)
    return all(order.values is not None for order in data)


def shows_phases(measurement: Measurement) -> bool:
    """Whether any order of a measurement has a phase against a reference."""
    return any(has_phases(part.data) for part in parts_by_phase(measurement))  # type: ignore[arg-type]


def parts_by_phase(measurement: Measurement) -> tuple[Measurement, ...]:
    """Measurement whose orders all have phases, and another of the amplitudes of those without, if there are both.

    Half orders lack a phase where a pulse once a turn does not say which turn of the cycle it is in.
    """
    if not measurement.has_orders:
        return (measurement,)
    data: OrderData = measurement.data  # type: ignore[assignment]
    if isinstance(data, TrackedOrders):
        if not data.reference or not data.undecided:
            return (measurement,)
        blind = [order.order for order in data.measured() if order.values is None]
        seen = np.array([order not in blind for order in data.orders.tolist()])
        parts: list[OrderData] = [_only(data, seen), replace(_only(data, ~seen), reference="")]
    else:
        parts = [tuple(order for order in data if (order.values is None) == lacks) for lacks in (False, True)]
    both = all(len(measured_orders(part)) for part in parts)
    measurements = []
    for part, is_blind in zip(parts, (False, True), strict=True):
        used = tuple(order for order in measurement.orders_used if _among(order, measured_orders(part)))
        if not measured_orders(part) or (measurement.orders_used and not used):
            continue
        measurements.append(
            replace(
                measurement,
                data=part,
                orders_used=used,
                name=f"{measurement.label} (amplitudes)" if is_blind and both else measurement.label,
                delay=measurement.delay and not (is_blind and both),
                reference_angle=measurement.reference_angle and not (is_blind and both),
            )
        )
    return tuple(measurements) or (measurement,)


def _only(data: TrackedOrders, kept: NDArray[np.bool_]) -> TrackedOrders:
    """Tracked orders with some of the orders alone, all of whose signs are known."""
    values, widths = data.values[kept], data.half_widths[kept]
    related = tuple(np.array(data.related_within)[kept].tolist()) if data.related_within else ()
    orders = data.orders[kept]
    return replace(data, orders=orders, values=values, half_widths=widths, undecided=(), related_within=related)


def measured_orders(data: OrderData) -> tuple[float, ...]:
    """Orders of a measurement, rising."""
    orders = data.orders.tolist() if isinstance(data, TrackedOrders) else [measured.order for measured in data]
    return tuple(sorted(dict.fromkeys(map(float, orders))))


def order_lines(measurement: Measurement, excited: Sequence[float]) -> OrderLines:
    """Lines of a measurement of orders that a model with the ``excited`` orders can be compared with.

    Raises
    ------
    UsageError
        An order asked for that was not measured or that the model does not excite, or nothing left to compare.
    """
    faults = order_faults(measurement, excited)
    if faults:
        raise UsageError("; ".join(f"{measurement.label}: {fault.message}" for fault in faults), kind=faults[0].kind)
    data: OrderData = measurement.data  # type: ignore[assignment]
    wanted = measurement.orders_used or tuple(order for order in measured_orders(data) if _among(order, excited))
    rows = [row for row in _rows(data) if _among(row[0], wanted)]
    orders, speeds, values, widths = (np.concatenate(part) for part in zip(*map(_columns, rows), strict=True))
    kept = _lines_in_bands(measurement, orders, speeds) & np.isfinite(values) & (values != 0)
    if not kept.any():
        raise UsageError(f"{measurement.label} has nothing to compare: {_speeds_there(speeds)}", kind="missing-data")
    times = np.concatenate([row[4] for row in rows])
    related = np.concatenate([np.full(len(row[1]), row[5]) for row in rows])
    order = np.lexsort((speeds[kept], orders[kept]))
    correlation = _correlation(orders[kept][order], times[kept][order], related[kept][order])
    orders, speeds, values, widths = (part[kept][order] for part in (orders, speeds, values, widths))
    phases = has_phases(data)
    values = values if phases else np.abs(values).astype(complex)
    deviations, known = _deviations(measurement, orders, values, widths)
    left_out = (
        () if measurement.orders_used else tuple(order for order in measured_orders(data) if not _among(order, wanted))
    )
    return OrderLines(orders, speeds, values, deviations, known, phases, left_out, correlation)


def order_faults(measurement: Measurement, excited: Sequence[float]) -> list[Fault]:
    """Faults of a measurement of orders, each with its entry, all at once."""
    data: OrderData = measurement.data  # type: ignore[assignment]
    there, faults = measured_orders(data), []
    if missing := [order for order in measurement.orders_used if not _among(order, there)]:
        text = f"order {_orders(missing)} was not measured; there are {_orders(there)}"
        faults.append(Fault(text, ("orders_used",), kind="unknown-order"))
    if silent := [order for order in measurement.orders_used if _among(order, there) and not _among(order, excited)]:
        text = f"the model does not excite order {_orders(silent)}; its orders are {_orders(excited)}"
        text = f"{text}; leave it out, or give the model what excites it"
        faults.append(Fault(text, ("orders_used",), kind="unknown-order"))
    if not measurement.orders_used and not any(_among(order, excited) for order in there):
        text = f"the model excites none of the measured orders {_orders(there)}; its orders are {_orders(excited)}"
        faults.append(Fault(text, ("orders",), kind="unknown-order"))
    speeds = np.concatenate([_columns(row)[1] for row in _rows(data)])
    if measurement.speeds is not None and not _inside(measurement.speeds, speeds).any():
        low, high = (edge * RPM for edge in measurement.speeds)
        text = f"nothing was measured from {low:g} to {high:g} rpm: {_speeds_there(speeds)}"
        faults.append(Fault(text, ("speeds",), kind="missing-data"))
    if not shows_phases(measurement):
        if measurement.reference_angle:
            text = "a reference angle is found from phases, but the phases of these orders have no reference"
            text = f"{text}; track them against a pulse or an encoder's index"
            faults.append(Fault(text, ("reference_angle",), kind="missing-data"))
        if measurement.delay:
            text = "a delay is found from phases, but these orders have none against a reference"
            faults.append(Fault(text, ("delay",), kind="missing-data"))
    return faults


Row = tuple[float, FloatArray, ComplexArray, FloatArray, FloatArray, float]
"""Order, speeds, values, half widths, times, and the time within which values are related."""


def _rows(data: OrderData) -> list[Row]:
    if isinstance(data, TrackedOrders):
        related = data.related_within or (0.0,) * len(data.orders)
        every = zip(data.orders.tolist(), data.values, data.half_widths, related, strict=True)
        return [(order, data.speeds, values, widths, data.times, within) for order, values, widths, within in every]
    return [
        (
            measured.order,
            measured.speeds,
            np.asarray(measured.amplitude if measured.values is None else measured.values, dtype=complex),
            np.full(len(measured.speeds), np.nan) if measured.half_widths is None else measured.half_widths,
            np.arange(float(len(measured.speeds))),
            0.0,
        )
        for measured in data
    ]


def _columns(row: Row) -> tuple[FloatArray, FloatArray, ComplexArray, FloatArray]:
    order, speeds, values, widths = row[:4]
    return np.full(len(speeds), order), np.asarray(speeds, dtype=float), values, widths


def _correlation(orders: FloatArray, times: FloatArray, related: FloatArray) -> scipy.sparse.csr_array | None:
    """Correlation (n_lines, n_lines) of the noise of lines, which falls in a straight line over the time apart."""
    if not (related > 0).any():
        return None
    apart = np.abs(times[:, None] - times) / np.where(related > 0, related, np.finfo(float).tiny)
    alike = np.where((orders[:, None] == orders) & (apart < 1), 1 - apart, 0.0)
    np.fill_diagonal(alike, 1.0)
    correlation = scipy.sparse.csr_array(alike)
    # Far apart, as an average over bins of speed leaves them, they are independent.
    return correlation if correlation.nnz > len(orders) else None


def _lines_in_bands(measurement: Measurement, orders: FloatArray, speeds: FloatArray) -> NDArray[np.bool_]:
    """Lines (n_lines,) in the bands of speed and frequency of a measurement."""
    hertz = orders * speeds / (2 * np.pi)
    kept = hertz > 0
    if measurement.speeds is not None:
        kept &= _inside(measurement.speeds, speeds)
    if measurement.band is not None:
        kept &= (hertz >= measurement.band[0]) & (hertz <= measurement.band[1])
    for low, high in measurement.excluded:
        kept &= (hertz < low) | (hertz > high)
    return np.asarray(kept)


def _inside(band: tuple[float, float], speeds: FloatArray) -> NDArray[np.bool_]:
    rounding = 1e-9
    return np.asarray((speeds >= band[0] * (1 - rounding)) & (speeds <= band[1] * (1 + rounding)))


def _deviations(
    measurement: Measurement, orders: FloatArray, values: ComplexArray, widths: FloatArray
) -> tuple[FloatArray, bool]:
    """Standard deviations (n_lines,) of real and imaginary part in SI, and whether they are known.

    From the half widths; where there is none, from the relative error stated, else as of the other lines. Without any
    of these the noise is supposed to be a share of the RMS amplitude of the order, since noise of a channel does not
    follow the amplitude from speed to speed.
    """
    stated = np.isfinite(widths) & (widths > 0)
    deviations = np.where(stated, widths / DEVIATIONS_PER_HALF_WIDTH, np.nan)
    if measurement.error is not None:
        return np.where(stated, deviations, measurement.error * np.abs(values)), True
    if stated.any():
        return np.where(stated, deviations, np.median(deviations[stated])), True
    # Without intervals the noise of an order is in proportion to its RMS over speed, and the fit finds the factor.
    level = np.empty(len(orders))
    for order in np.unique(orders):
        mine = orders == order
        level[mine] = np.sqrt(np.mean(np.abs(values[mine]) ** 2))
    return level, False


def _among(order: float, known: Sequence[float]) -> bool:
    return any(same_order(order, other) for other in known)


def _orders(orders: Sequence[float]) -> str:
    return comma_list([f"{order:g}" for order in orders], none="none")


def _speeds_there(speeds: FloatArray) -> str:
    return f"its speeds go from {speeds.min() * RPM:.4g} to {speeds.max() * RPM:.4g} rpm"


# Measured orders of a fit from files, and what a model cannot compare in them.


def read_order_data(
    file: Path, output: str, model_output: str, model: AssembledModel | None, configuration: str
) -> OrderData | None:
    """Orders of one channel of a file, SI: tracked orders, or a table by speed and order; None without a model.

    Raises
    ------
    UsageError
        The file has no such channel or columns, or the model no such output.
    ModelError
        Cells without a number.
    """
    if is_tracked_table(file):
        channels = {tracked.name: tracked for tracked in read_tracked_orders(file)}
        if output not in channels:
            hint = did_you_mean(output, channels) or f"; there are {', '.join(channels)}"
            raise UsageError(f'{file.name} has no channel "{output}"{hint}', kind="unknown-channel")
        return channels[output]
    if model is None:
        return None
    rig = model.configured(configuration) if configuration else model
    return read_orders(file, Channel(output, named_output(rig, model_output or output).unit), configuration)


def faults_of_orders(model: AssembledModel, measurement: Measurement) -> list[Fault]:
    """Faults of a measurement of orders by the model it is to be compared with, with the entry that each is in."""
    try:
        rig = model.configured(measurement.configuration) if measurement.configuration else model
        excited = excited_orders(rig, measurement.speed_of)
    except (UsageError, ModelError) as error:
        return [replace(fault_of(error, error.kind), path=("orders",))]
    return order_faults(measurement, excited)
