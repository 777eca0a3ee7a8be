"""Residuals of one measurement, weighted, with exact derivatives.

Lines become real vectors, divided by what noise alone would do to them. Lines next to each other share
noise, since windows smear it: weights do not use that (the noise of an encoder is not quite what theory says), but the
uncertainties of a fit do.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.sparse import csr_array

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.drivetrain import Drivetrain
from torsionnet.errors import UsageError
from torsionnet.identification.forms import Form, apart, of_covariance, of_errors, parts
from torsionnet.identification.line_noise import (
    USUAL_OVERLAP,
    USUAL_WINDOW,
    averaging_of,
    line_correlation,
    line_noise,
)
from torsionnet.identification.measurement import Measurement
from torsionnet.identification.operator import WindowedEstimate, windowed_estimate
from torsionnet.identification.remembered import remembered_estimate
from torsionnet.identification.smoothing import UNCERTAIN, Smoothing, smoothing
from torsionnet.identification.steps import steps_covariance
from torsionnet.response import FrequencyResponse
from torsionnet.response.frequency_response import Channel
from torsionnet.sensitivity import ParametricResponse, parametric_response
from torsionnet.signals.estimators import estimate
from torsionnet.signals.recording import Recording
from torsionnet.signals.welch import PAPER, Welch

SOURCE_ROUNDS = 5
FAST = 1000.0
"""Hz; records above are decimated unless the settings say otherwise."""


@dataclass(eq=False)
class Block(ABC):
    """One measurement against the model.

    ``parameters`` of the model come first in the vectors handed in, then delay and gain where they are found along.
    """

    measurement: Measurement
    response: ParametricResponse
    form: Form = field(default="complex", kw_only=True)

    @property
    def count(self) -> int:
        """Number of residuals."""
        return len(self.frequencies) * (1 if self.form == "magnitude" else 2)

    @property
    @abstractmethod
    def frequencies(self) -> FloatArray:
        """Lines compared, Hz."""

    @property
    @abstractmethod
    def measured(self) -> ComplexArray:
        """What the test says at the lines."""

    @abstractmethod
    def predicted(self, values: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """What the model says (n_b,), and its derivatives (n_b, n)."""

    @property
    @abstractmethod
    def deviations(self) -> FloatArray:
        """Standard deviation of real and imaginary parts that noise alone makes, (2 n_b,)."""

    @property
    @abstractmethod
    def sizes(self) -> FloatArray:
        """The same of the residuals before they are weighted, (count,)."""

    @property
    def correlation(self) -> FloatArray | None:
        """Of the weighted residuals, (count, count); None where they are independent."""
        return None

    def under_noise(self, backward: FloatArray) -> FloatArray:
        """Covariance of backward (n, count) @ residuals by noise."""
        correlation = self.correlation
        return np.asarray(backward @ (backward.T if correlation is None else correlation @ backward.T))

    @property
    def squares(self) -> float:
        """Sum of the squared correlations of all pairs of residuals."""
        return float(self.count if self.correlation is None else np.sum(self.correlation**2))

    def under_shared(self, backward: FloatArray, values: FloatArray) -> FloatArray:
        """Covariance of backward (n, count) @ residuals by errors beyond noise that all lines share."""
        del values
        return np.zeros((len(backward), len(backward)))

    def residuals(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Weighted model against test (count,), and derivatives (count, n)."""
        residuals, slopes = apart(self.form, *self.predicted(values), self.measured)
        size = self.sizes
        return residuals / size, slopes / size[:, None]

    @property
    def remark(self) -> str:
        """What was assumed of the measurement, for the notes of a fit."""
        return ""

    @abstractmethod
    def take_noise(self, other: Block, left: float) -> None:
        """Weigh as another fit of the same measurement does; ``left`` is its reduced chi squared."""

    @property
    def extra(self) -> tuple[str, ...]:
        """Names of what is found along, after the parameters."""
        asked = (("delay", self.measurement.delay), ("gain", self.measurement.gain))
        return tuple(name for name, wanted in asked if wanted)

    def _distorted(self, values: FloatArray, f: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Model with delay and gain of the channel, (n_f,), and derivatives (n_f, n)."""
        count = len(self.response.names)
        found = self.response.at(values[:count])
        G, slopes = found.values[:, 0, 0], found.jacobian[:, 0, 0]
        extra = dict(zip(self.extra, values[count:], strict=True))
        turn = -2j * np.pi * f
        channel = extra.get("gain", 1.0) * np.exp(turn * extra.get("delay", 0.0))
        columns = [slopes * channel[:, None]]
        if "delay" in extra:
            columns.append((turn * G * channel)[:, None])
        if "gain" in extra:
            columns.append((G * channel / extra["gain"])[:, None])
        return np.asarray(G * channel), np.concatenate(columns, axis=1)


@dataclass(eq=False)
class RecordBlock(Block):
    """A record, by the same-estimator route."""

    windowed: WindowedEstimate
    kept: NDArray[np.bool_]
    steps: FloatArray
    given: ComplexArray | None = field(default=None, kw_only=True)
    covariance: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        self.covariance = self._part(self.windowed.output_covariance())

    @property
    def frequencies(self) -> FloatArray:
        return np.asarray(self.windowed.frequencies[self.kept])

    @property
    def measured(self) -> ComplexArray:
        return np.asarray(self.windowed.measured[self.kept]) if self.given is None else self.given

    def predicted(self, values: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        G, slopes = self._distorted(values, self.windowed.fine)
        estimate_of = self.windowed.predicted(np.column_stack([G, slopes]))[self.kept]
        return estimate_of[:, 0], estimate_of[:, 1:]

    @property
    def deviations(self) -> FloatArray:
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def sizes(self) -> FloatArray:
        return np.asarray(np.sqrt(np.diag(of_covariance(self.form, self.covariance, self.measured))))

    @property
    def correlation(self) -> FloatArray:
        size = self.sizes
        return np.asarray(of_covariance(self.form, self.covariance, self.measured) / np.outer(size, size))

    def under_shared(self, backward: FloatArray, values: FloatArray) -> FloatArray:
        del values
        weighted = backward / self.sizes
        return np.asarray(weighted @ of_covariance(self.form, self.steps, self.measured) @ weighted.T)

    def learn_noise(self, values: FloatArray) -> None:
        """Take what the model leaves unexplained in the output as noise of the two sensors."""
        G, _ = self._distorted(values, self.windowed.fine)
        level = self.windowed.unexplained(G)[self.kept]
        on_output, on_input = two_sources(level, np.abs(self.measured) ** 2)
        self.covariance = on_output * self._part(self.windowed.output_covariance())
        if on_input:
            self.covariance = self.covariance + on_input * self._part(self.windowed.input_covariance(G))

    def take_noise(self, other: Block, left: float) -> None:
        del left
        assert isinstance(other, RecordBlock)
        self.covariance = other.covariance

    def _part(self, whole: FloatArray) -> FloatArray:
        """Of the lines compared."""
        lines = np.flatnonzero(self.kept)
        both = np.concatenate([lines, len(self.windowed.frequencies) + lines])
        return np.asarray(whole[np.ix_(both, both)])


@dataclass(eq=False)
class ResponseBlock(Block):
    """A response without its record. Windows are taken to act on the model as they do under a stationary input."""

    data: FrequencyResponse
    smoothing: Smoothing | None = None
    noise: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        self.noise = line_noise(self.data, self.measurement.error)

    @property
    def frequencies(self) -> FloatArray:
        return self.data.frequencies

    @property
    def measured(self) -> ComplexArray:
        return np.asarray(self.data.values[:, 0, 0])

    @property
    def fine(self) -> FloatArray:
        """Frequencies at which the model is asked, Hz."""
        return self.frequencies if self.smoothing is None else self.smoothing.fine

    def curve(self, values: FloatArray) -> ComplexArray:
        """The model there, before windows act on it."""
        return self._distorted(values, self.fine)[0]

    def predicted(self, values: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        exact = self._distorted(values, self.fine)
        return exact if self.smoothing is None else self.smoothing.smoothed(*exact)

    @property
    def deviations(self) -> FloatArray:
        return np.tile(np.sqrt(self.noise), 2)

    @property
    def sizes(self) -> FloatArray:
        size = np.sqrt(self.noise) / (1.0 if self.form == "complex" else np.abs(self.measured))
        return size if self.form == "magnitude" else np.tile(size, 2)

    def under_noise(self, backward: FloatArray) -> FloatArray:
        lines = self._line_correlation
        if lines is None:
            return super().under_noise(backward)
        parts_of = np.split(backward, self.count // len(self.frequencies), axis=1)
        return np.asarray(sum(part @ (lines @ part.T) for part in parts_of))

    @property
    def squares(self) -> float:
        lines = self._line_correlation
        return self.count if lines is None else self.count / len(self.frequencies) * float((lines**2).sum())

    @property
    def _line_correlation(self) -> csr_array | None:
        """Of lines, the same for real and imaginary parts."""
        averaged = averaging_of(self.data) if self.measurement.error is None else self.data.estimation
        return None if averaged is None else line_correlation(self.frequencies, averaged)

    def under_shared(self, backward: FloatArray, values: FloatArray) -> FloatArray:
        if self.smoothing is None or self.smoothing.exact:
            return super().under_shared(backward, values)
        plain = self.curve(values)[self.smoothing.own]
        doubtful = parts(UNCERTAIN * (self.predicted(values)[0] - plain))[:, None]
        moved = backward @ (of_errors(self.form, doubtful, self.measured) / self.sizes[:, None])
        return np.asarray(moved @ moved.T)

    @property
    def remark(self) -> str:
        found = []
        if not self.data.has_phase:
            found.append("has no phase, so magnitudes are compared")
        if self.measurement.error is None and self.data.estimation is None and self._line_correlation is not None:
            usual = f"a {USUAL_WINDOW} window with {100 * USUAL_OVERLAP:.0f} % overlap"
            found.append(f"has a coherence but does not say how it was averaged: neighbours are related as by {usual}")
        if self.smoothing is not None and self.data.estimation is not None and self._cut:
            found.append(f"is used from {self._cut:.3g} Hz, as a sweep passed what is below within the first window")
        return f"{self.measurement.label} {'; '.join(found)}" if found else ""

    @property
    def _cut(self) -> float:
        """From where lines are used because the sweep hurried through those below; 0 if that cut nothing off."""
        return 0.0 if self.measurement.band else _settled(self.data)

    def take_noise(self, other: Block, left: float) -> None:
        assert isinstance(other, ResponseBlock)
        self.noise = other.noise * left


def two_sources(level: FloatArray, gain: FloatArray) -> tuple[float, float]:
    """Noise power of a sensor on the output, and of one on the input seen through the response, that fit a level best.

    One number each for all lines: the level of a single line rests on the few windows in which the sweep passes it,
    and weights made of that alone would favour lines that happen to agree.

    >>> [round(share, 2) for share in two_sources(np.array([1.2, 2.8, 5.1]), np.array([0.0, 1.0, 2.0]))]
    [1.18, 1.82]
    """
    tiny = np.finfo(float).tiny
    found, columns = np.maximum(level, tiny), np.column_stack([np.ones_like(gain), gain])
    shares = np.zeros(2)
    for _ in range(SOURCE_ROUNDS):
        rows = columns / found[:, None]
        scale = np.maximum(rows.max(axis=0), tiny)
        shares = nnls(rows / scale, level / found)[0] / scale
        found = np.maximum(columns @ shares, tiny)
    return max(float(shares[0]), tiny if not shares.any() else 0.0), float(shares[1])


def make_block(model: Drivetrain, measurement: Measurement, parameters: tuple[str, ...], form: Form) -> Block:
    """The block of one measurement.

    Raises
    ------
    UsageError
        Names that model or data lack, unlike units, no line in the band.
    """
    rig = model.configured(measurement.configuration) if measurement.configuration else model
    data = measurement.data
    if isinstance(data, Recording):
        settings = measurement.settings or default_settings(data)
        band = measurement.band or _usable_band(data, measurement, settings)
        windowed = windowed_estimate(data, measurement.output, measurement.input, settings, band, measurement.settling)
        kept = _kept(windowed.frequencies, measurement)
        units = tuple(Channel(name, data[name].unit) for name in (measurement.output, measurement.input))
        response = _response(rig, measurement, windowed.fine, parameters, (units[0], units[1]))
        rows = windowed.rows[kept]
        steps = steps_covariance(data, measurement.output, measurement.input, windowed.record, rows)
        return RecordBlock(measurement, response, windowed, kept, steps, form=form)
    chosen = _chosen_lines(data.select(measurement.output, measurement.input), measurement)
    form = form if chosen.has_phase else "magnitude"
    ends = chosen.outputs[0], chosen.inputs[0]
    remembered = remembered_estimate(chosen) if measurement.error is None else None
    if remembered is not None:
        windowed, kept, steps = remembered
        response = _response(rig, measurement, windowed.fine, parameters, ends)
        given = np.asarray(chosen.values[:, 0, 0])
        return RecordBlock(measurement, response, windowed, kept, steps, form=form, given=given)
    smooth = smoothing(chosen.frequencies, chosen.estimation) if chosen.estimation else None
    response = _response(rig, measurement, smooth.fine if smooth else chosen.frequencies, parameters, ends)
    return ResponseBlock(measurement, response, chosen, smooth, form=form)


def default_settings(record: Recording) -> Welch:
    """The source paper's windows; records faster than 1 kHz are decimated to between 200 and 400 Hz."""
    factor = int(record.sampling_rate // 200) if record.sampling_rate > FAST else 1
    return Welch(PAPER.window, PAPER.seconds, PAPER.overlap, decimation=factor)


def _usable_band(data: Recording, measurement: Measurement, settings: Welch) -> tuple[float, float]:
    response = estimate(data, measurement.output, measurement.input, "H1", settings)
    top = response.frequencies[-1] if response.usable_up_to is None else response.usable_up_to
    return float(response.frequencies[0]), float(top)


def _chosen_lines(data: FrequencyResponse, measurement: Measurement) -> FrequencyResponse:
    low, high = measurement.band or (_settled(data), data.usable_up_to or np.inf)
    inside = (data.frequencies >= low) & (data.frequencies <= high) & (data.frequencies > 0)
    kept = inside & np.isfinite(data.values[:, 0, 0]) & (data.values[:, 0, 0] != 0)
    for start, stop in measurement.excluded:
        kept &= (data.frequencies < start) | (data.frequencies > stop)
    if not kept.any():
        raise UsageError(_empty(data.frequencies, measurement))
    return data.at_lines(kept)


def _settled(data: FrequencyResponse) -> float:
    """From where lines of a sweep are smoothed by whole windows; with the record at hand that does not matter."""
    return data.estimation.settled_from if data.estimation and data.estimation.record is None else 0.0


def _kept(frequencies: FloatArray, measurement: Measurement) -> NDArray[np.bool_]:
    kept = np.ones(len(frequencies), dtype=bool)
    for start, stop in measurement.excluded:
        kept &= (frequencies < start) | (frequencies > stop)
    if not kept.any():
        raise UsageError(_empty(frequencies, measurement))
    return kept


def _empty(frequencies: FloatArray, measurement: Measurement) -> str:
    band = f"from {measurement.band[0]:g} to {measurement.band[1]:g} Hz " if measurement.band else ""
    have = f"its lines go from {frequencies[0]:g} to {frequencies[-1]:g} Hz" if len(frequencies) else "it has no lines"
    return f"{measurement.label} has nothing {band}to compare; {have}"


def _response(
    rig: Drivetrain,
    measurement: Measurement,
    frequencies: FloatArray,
    parameters: tuple[str, ...],
    channels: tuple[Channel, Channel],
) -> ParametricResponse:
    output, into = measurement.model_output or measurement.output, measurement.model_input or measurement.input
    response = parametric_response(rig, output, into, frequencies, parameters, excitation=measurement.excitation)
    theirs = (response.question.outputs[0].unit, response.question.measured[0].unit)
    for channel, unit in zip(channels, theirs, strict=True):
        if channel.unit and channel.unit != unit:
            msg = f"{measurement.label}: {channel.name} is in {channel.unit} in the data, in {unit} in the model"
            raise UsageError(msg)
    return response
