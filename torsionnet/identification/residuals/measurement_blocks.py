"""Choice of the kind of residuals, and of the frequency lines compared, for each measurement of a fit."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.identification.orders.order_block import order_block
from torsionnet.identification.orders.parametric_orders import parameters_of_drivetrain
from torsionnet.identification.plan.fit_entries import FitSettings
from torsionnet.identification.residuals.equation_block import equation_block
from torsionnet.identification.residuals.measurement import Instrument, Measurement, choose_instrument
from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.identification.residuals.response_blocks import RecordBlock, ResponseBlock, lowest_settled_frequency
from torsionnet.identification.residuals.sampled_response import (
    Form,
    SensorSteps,
    between_samples,
    find_sensor_steps,
    smoothing,
)
from torsionnet.identification.residuals.stepped_block import stepped_block
from torsionnet.identification.residuals.windowed_estimate import (
    MOST_ROW_BYTES,
    NUMBERS_PER_BATCH,
    WindowedEstimate,
    windowed_estimate,
)
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.linear.sensitivity.parametric import ParametricResponse, parametric_response
from torsionnet.signals.estimators import estimate
from torsionnet.signals.recording import Recording
from torsionnet.signals.resampling import factor_for
from torsionnet.signals.stepped_levels import SteppedStiffness
from torsionnet.signals.welch import PAPER, Welch

# Memory demand of a fit of records, estimated before it starts.

MOST_BYTES = 2e9
"""Largest memory demand of one measurement in bytes, above which it is refused, as it would also take hours."""
FLOAT_BYTES, COMPLEX_BYTES = 8, 16
"""Bytes of a real and of a complex number in double precision."""


@dataclass(frozen=True)
class MemoryDemand:
    """Memory demand of one record in a fit, in bytes held throughout and in bytes held for a time.

    Attributes
    ----------
    kept, passing : float
        Bytes held during the whole fit, and temporarily.
    lines : int
        Number of lines compared.
    """

    kept: float
    passing: float
    lines: int

    @property
    def most(self) -> float:
        """Peak memory for the record in bytes, held and temporary together."""
        return self.kept + self.passing


def memory_demand(record: Recording, settings: Welch, band: tuple[float, float]) -> MemoryDemand:
    """Memory demand in bytes of a record whose lines in a band (Hz) are compared, within a factor of two."""
    rate, samples = record.sampling_rate / settings.decimation, len(record) / settings.decimation
    lines = max(0, int((min(band[1], rate / 2) - band[0]) * settings.seconds) + 1)
    # Most of it: covariance of real and imaginary parts of all lines, and the rows from samples to lines.
    covariance = FLOAT_BYTES * (2 * lines) ** 2
    pieces = 3 * COMPLEX_BYTES * lines * settings.samples(rate)
    rows = COMPLEX_BYTES * lines * samples
    held = 2 * rows if rows <= MOST_ROW_BYTES else 0  # else row by row
    transforms = 4 * COMPLEX_BYTES * max(2 * samples, min(NUMBERS_PER_BATCH, 2 * samples * lines))
    return MemoryDemand(
        3 * FLOAT_BYTES * len(record) + 2 * covariance, max(pieces, held + transforms) + 4 * covariance, lines
    )


def total_memory(demands: Iterable[MemoryDemand]) -> float:
    """Peak memory in bytes for all records of a fit, which are processed one after the other."""
    listed = list(demands)
    return sum(demand.kept for demand in listed) + max((demand.passing for demand in listed), default=0.0)


def check_memory(label: str, record: Recording, settings: Welch, band: tuple[float, float]) -> None:
    """Raise an error for a measurement that takes more than ``MOST_BYTES`` of memory.

    Raises
    ------
    UsageError
        With advice on settings that take less.
    """
    demand = memory_demand(record, settings, band)
    if demand.most > MOST_BYTES:
        size = demand.most / 1e9
        raise UsageError(
            f"{label}: comparing {demand.lines} lines from {band[0]:g} to {band[1]:g} Hz takes {size:.1f} GB of "
            "memory; give a narrower band or shorter windows (seconds)",
            kind="too-large",
        )


UNSTATED_UNIT = "1"
"""Unit of both channels of a response whose file says only that they have the same unit."""


def make_block(
    rig: AssembledModel, measurement: Measurement, parameters: tuple[str, ...], form: Form
) -> MeasurementBlock:
    """Weighted residuals between a model, configured as for the test, and one measurement, ready for a fit.

    Raises
    ------
    UsageError
        Names that model or data lack, unlike units, no line in the band, or a record that takes too much memory.
    """
    data = measurement.data
    if isinstance(data, Recording) and measurement.equations:
        return equation_block(rig, measurement, data, parameters)
    if isinstance(data, Recording):
        return _of_record(rig, measurement, data, parameters_of_drivetrain(rig, parameters), form)
    if isinstance(data, FrequencyResponse):
        return _of_response(rig, measurement, data, parameters_of_drivetrain(rig, parameters), form)
    if isinstance(data, SteppedStiffness):
        return stepped_block(rig, measurement, data, parameters, form)
    return order_block(rig, measurement, parameters, form)


def _of_record(
    rig: AssembledModel, measurement: Measurement, data: Recording, parameters: tuple[str, ...], form: Form
) -> MeasurementBlock:
    settings = measurement.settings or default_settings(data, measurement.band)
    band = measurement.band or _usable_band(data, measurement, settings)
    check_memory(measurement.label, data, settings, band)
    names, instrument = (measurement.output, measurement.input), choose_instrument(rig, measurement, data, settings)
    windowed = windowed_estimate(data, *names, settings, band, measurement.settling, instrument)
    kept = _kept(windowed.frequencies, measurement)
    units = tuple(Channel(name, data[name].unit) for name in names)
    response = _response(rig, measurement, windowed.fine, parameters, (units[0], units[1]))
    steps = find_sensor_steps(data, *names, settings.decimation)
    return _between_samples(RecordBlock(measurement, response, windowed, kept, steps, form=form), response)


def _between_samples(block: MeasurementBlock, response: ParametricResponse) -> MeasurementBlock:
    """Residuals against the response of the model between the samples of the data."""
    if block.measurement.between and block.course is None:
        text = "between is for records, and for responses estimated here, which know their sampling rate"
        raise UsageError(f"{block.measurement.label}: {text}", kind="needless-entry")
    block.response = between_samples(response, block.course, block.corrected_course)
    return block


def _of_response(
    rig: AssembledModel, measurement: Measurement, data: FrequencyResponse, parameters: tuple[str, ...], form: Form
) -> MeasurementBlock:
    chosen = _chosen_lines(data.select(measurement.output, measurement.input), measurement)
    form = form if chosen.has_phase else "magnitude"
    ends = chosen.outputs[0], chosen.inputs[0]
    remembered = _remembered_estimate(chosen) if measurement.error is None else None
    if remembered is not None:
        windowed, kept, steps = remembered
        response = _response(rig, measurement, windowed.fine, parameters, ends)
        course = windowed.record[windowed.input].course(windowed.record.sampling_rate)
        given = np.asarray(chosen.values[:, 0, 0]) * course.share(chosen.frequencies)  # as before its correction
        block = RecordBlock(measurement, response, windowed, kept, steps, form=form, estimated_lines=given)
        return _between_samples(block, response)
    smooth = smoothing(chosen.frequencies, chosen.estimation) if chosen.estimation else None
    response = _response(rig, measurement, smooth.fine if smooth else chosen.frequencies, parameters, ends)
    return _between_samples(ResponseBlock(measurement, response, chosen, smooth, form=form), response)


def default_settings(record: Recording, band: tuple[float, float] | None = None) -> Welch:
    """Welch settings with the window of the source paper, and a decimation for records above 1 kHz."""
    factor = factor_for(record.sampling_rate, band[1] if band else 0.0)
    return Welch(PAPER.window, PAPER.seconds, PAPER.overlap, decimation=factor)


def _usable_band(data: Recording, measurement: Measurement, settings: Welch) -> tuple[float, float]:
    response = estimate(data, measurement.output, measurement.input, "H1", settings)
    top = response.frequencies[-1] if response.usable_up_to is None else response.usable_up_to
    return float(response.frequencies[0]), float(top)


def _chosen_lines(data: FrequencyResponse, measurement: Measurement) -> FrequencyResponse:
    low, high = measurement.band or (lowest_settled_frequency(data), data.usable_up_to or np.inf)
    inside = (data.frequencies >= low) & (data.frequencies <= high) & (data.frequencies > 0)
    kept = inside & np.isfinite(data.values[:, 0, 0]) & (data.values[:, 0, 0] != 0)
    for start, stop in measurement.excluded:
        kept &= (data.frequencies < start) | (data.frequencies > stop)
    if not kept.any():
        raise UsageError(_empty(data.frequencies, measurement), kind="missing-data")
    return data.at_lines(kept)


def _kept(frequencies: FloatArray, measurement: Measurement) -> NDArray[np.bool_]:
    kept = np.ones(len(frequencies), dtype=bool)
    for start, stop in measurement.excluded:
        kept &= (frequencies < start) | (frequencies > stop)
    if not kept.any():
        raise UsageError(_empty(frequencies, measurement), kind="missing-data")
    return kept


def _empty(frequencies: FloatArray, measurement: Measurement) -> str:
    band = f"from {measurement.band[0]:g} to {measurement.band[1]:g} Hz " if measurement.band else ""
    have = f"its lines go from {frequencies[0]:g} to {frequencies[-1]:g} Hz" if len(frequencies) else "it has no lines"
    return f"{measurement.label} has nothing {band}to compare; {have}"


def _response(
    rig: AssembledModel,
    measurement: Measurement,
    frequencies: FloatArray,
    parameters: tuple[str, ...],
    channels: tuple[Channel, Channel],
) -> ParametricResponse:
    output, into = measurement.model_output or measurement.output, measurement.model_input or measurement.input
    response = parametric_response(rig, output, into, frequencies, parameters, driven_by=measurement.excitation)
    theirs = (response.request.outputs[0].unit, response.request.inputs[0].unit)
    if all(channel.unit == UNSTATED_UNIT for channel in channels):
        if theirs[0] != theirs[1]:
            pair = f"{channels[0].name}/{channels[1].name} is a ratio of like signals in the data"
            raise UsageError(
                f"{measurement.label}: {pair}, of {theirs[0]} over {theirs[1]} in the model", kind="wrong-unit"
            )
        return response
    for channel, unit in zip(channels, theirs, strict=True):
        if channel.unit and channel.unit != unit:
            raise UsageError(
                f"{measurement.label}: {channel.name} is in {channel.unit} in the data, in {unit} in the model",
                kind="wrong-unit",
            )
    return response


def _remembered_estimate(
    chosen: FrequencyResponse,
) -> tuple[WindowedEstimate, NDArray[np.bool_], SensorSteps] | None:
    """Windowed estimate from the record kept with a response, mask of the lines compared, and the sensor's steps.

    None without a record, where the input was not swept (an average over a stationary input is smoothed in the same way
    wherever the record begins), for estimators that are not linear in the transfer function, and for records that would
    take too much memory.
    """
    origin, f = chosen.estimation, chosen.frequencies
    output, driven = chosen.outputs[0].name, chosen.inputs[0].name
    if origin is None or not isinstance(record := origin.record, Recording) or not origin.swept:
        return None
    signal = {("H1", 0): driven, ("H2", 0): output, ("Hr", 1): "".join(origin.references)}.get(
        (origin.estimator, len(origin.references)), ""
    )
    if not {output, driven, signal} <= set(record.names):
        return None
    instrument = Instrument(origin.estimator, signal, plain=True)
    detrend: Any = origin.detrend
    settings, band = Welch(origin.window, origin.seconds, origin.overlap, detrend), (float(f[0]), float(f[-1]))
    if memory_demand(record, settings, band).most > MOST_BYTES:
        return None
    windowed = windowed_estimate(record, output, driven, settings, band, instrument=instrument)
    kept = np.asarray(np.isclose(windowed.frequencies[:, None], f, rtol=1e-9).any(axis=1), dtype=np.bool_)
    if np.count_nonzero(kept) != len(f):
        return None
    return windowed, kept, SensorSteps(origin.steps.get(output, 0.0), origin.decimation)


# Settings by which a record is averaged, from the entries of a file and from the record.


def welch_settings(settings: FitSettings) -> Welch:
    """Welch settings that the entries of a file give, the others by default.

    Raises
    ------
    UsageError
        A length, overlap or trend that there is not.
    """
    given = {name: value for name, _ in settings.specs() if (value := getattr(settings, name)) is not None}
    return replace(PAPER if given.pop("preset", "") else Welch(), **given)


def record_settings(
    record: Recording, band: tuple[float, float] | None, settings: Welch | None, decimation: int | None
) -> Welch:
    """Welch settings of one record, decimated as far as the band in Hz allows where no decimation is given."""
    if settings is None:
        return default_settings(record, band)
    if decimation is not None:
        return settings
    return replace(settings, decimation=factor_for(record.sampling_rate, band[1] if band else 0.0))
