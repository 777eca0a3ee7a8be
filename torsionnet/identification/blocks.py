"""Residuals of one measurement, weighted, with exact derivatives.

Complex lines become real vectors [Re, Im], divided by what noise alone would do to them. Lines next to each other share
noise, since windows smear it: weights do not use that (the noise of an encoder is not quite what theory says), but the
uncertainties of a fit do.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from copy import copy
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import toeplitz
from scipy.optimize import nnls

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.drivetrain import Drivetrain
from torsionnet.errors import UsageError
from torsionnet.identification.instrument import instrument_of
from torsionnet.identification.measurement import Measurement
from torsionnet.identification.memory import check_memory
from torsionnet.identification.noise import Noise, noise_between_lines, noise_between_windows
from torsionnet.identification.operator import WindowedEstimate, windowed_estimate
from torsionnet.identification.steps import steps_covariance
from torsionnet.response import FrequencyResponse
from torsionnet.response.frequency_response import Channel
from torsionnet.sensitivity import ParametricResponse, parametric_response
from torsionnet.signals.decimation import factor_for
from torsionnet.signals.estimators import estimate
from torsionnet.signals.recording import Recording
from torsionnet.signals.welch import PAPER, Welch

HANN = (1.0, 2 / 3, 1 / 6)
"""Correlation of neighbouring lines under a Hann window, taken for that of estimates whose window is not known."""
LOWEST_COHERENCE, HIGHEST_COHERENCE = 1e-3, 1 - 1e-6
SOURCE_ROUNDS = 5


@dataclass(eq=False)
class Block(ABC):
    """One measurement against the model.

    ``parameters`` of the model come first in the vectors handed in, then delay and gain where they are found along.
    """

    measurement: Measurement
    response: ParametricResponse

    @property
    @abstractmethod
    def frequencies(self) -> FloatArray:
        """Lines compared, Hz."""

    @property
    def described(self) -> str:
        """What is compared, in a few words."""
        return f"{len(self.frequencies)} lines"

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
    def correlation(self) -> FloatArray | None:
        """Of the weighted residuals, (2 n_b, 2 n_b); None where they are independent."""
        return None

    @property
    def shared(self) -> FloatArray | None:
        """Covariance of the weighted residuals (2 n_b, 2 n_b) beyond noise, in no weight; None if there is none."""
        return None

    def residuals(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Weighted model minus test (2 n_b,), and derivatives (2 n_b, n)."""
        predicted, slopes = self.predicted(values)
        size = self.deviations
        return _parts(predicted - self.measured) / size, _parts(slopes) / size[:, None]

    def measured_noise(self, values: FloatArray) -> Noise | None:
        """What noise there is whether or not the model is right; None where that cannot be told."""
        residual, _ = self.residuals(values)
        count = len(self.frequencies)
        return noise_between_lines(residual[:count] + 1j * residual[count:], self.likeness[:count, :count])

    @property
    def likeness(self) -> FloatArray:
        """Correlation of the weighted residuals as far as it is known, else what it can be at most."""
        return np.eye(2 * len(self.frequencies)) if self.correlation is None else self.correlation

    @abstractmethod
    def take_measured_noise(self, noise: Noise) -> None:
        """Weigh by noise as it was found."""

    @abstractmethod
    def take_noise(self, other: Block, left: float) -> None:
        """Weigh as another fit of the same measurement does; ``left`` is its reduced chi squared."""

    def varied(self, rig: Drivetrain, measurement: Measurement, parameters: tuple[str, ...]) -> Block:
        """The same test against another model, or in other parameters."""
        found, old = copy(self), self.response
        found.measurement = measurement
        output, into = measurement.model_output or measurement.output, measurement.model_input or measurement.input
        found.response = parametric_response(
            rig, output, into, old.frequencies, parameters, excitation=measurement.excitation
        )
        return found

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


def _parts(values: ComplexArray | FloatArray) -> FloatArray:
    return np.concatenate([values.real, values.imag])


@dataclass(eq=False)
class RecordBlock(Block):
    """A record, by the same-estimator route."""

    windowed: WindowedEstimate
    kept: NDArray[np.bool_]
    steps: FloatArray
    covariance: FloatArray = field(init=False)
    sources: tuple[float, float] = field(init=False, default=(0.0, 0.0))

    def __post_init__(self) -> None:
        self.covariance = self._part(self.windowed.output_covariance())

    @property
    def described(self) -> str:
        return f"{super().described} of {self.windowed.instrument}"

    @property
    def frequencies(self) -> FloatArray:
        return np.asarray(self.windowed.frequencies[self.kept])

    @property
    def measured(self) -> ComplexArray:
        return np.asarray(self.windowed.measured[self.kept])

    def predicted(self, values: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        G, slopes = self._distorted(values, self.windowed.fine)
        estimate_of = self.windowed.predicted(np.column_stack([G, slopes]))[self.kept]
        return estimate_of[:, 0], estimate_of[:, 1:]

    @property
    def deviations(self) -> FloatArray:
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def correlation(self) -> FloatArray:
        size = self.deviations
        return np.asarray(self.covariance / np.outer(size, size))

    @property
    def shared(self) -> FloatArray | None:
        size = self.deviations
        return np.asarray(self.steps / np.outer(size, size))

    def learn_noise(self, values: FloatArray) -> None:
        """Take what the model leaves unexplained in the output as noise, of the sensors of output and input."""
        G, _ = self._distorted(values, self.windowed.fine)
        level = self.windowed.unexplained(G)[self.kept]
        self.sources = on_output, on_input = two_sources(level, np.abs(self.measured) ** 2)
        self.covariance = on_output * self._part(self.windowed.output_covariance())
        if on_input:
            self.covariance = self.covariance + on_input * self._part(self.windowed.input_covariance(G))

    def measured_noise(self, values: FloatArray) -> Noise | None:
        G, _ = self._distorted(values, self.windowed.fine)
        supposed = (self.deviations**2).reshape(2, -1).sum(axis=0)
        independent = len(self.deviations) ** 2 / 2 / float(np.sum(self.correlation**2))
        between = noise_between_windows(self.windowed, G, self.kept, supposed, independent)
        return super().measured_noise(values) if between is None else between

    def take_measured_noise(self, noise: Noise) -> None:
        size = np.sqrt(np.tile(noise.ratio, 2))
        self.covariance = self.covariance * np.outer(size, size)

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
    """An estimated response; its lines count as independent."""

    data: FrequencyResponse
    form: str
    noise: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        size = self.data.magnitude[:, 0, 0]
        self.noise = size**2
        if self.data.coherence is not None:
            coherence = np.clip(self.data.coherence[:, 0, 0], LOWEST_COHERENCE, HIGHEST_COHERENCE)
            self.noise = size**2 * (1 - coherence) / (2 * coherence)

    @property
    def frequencies(self) -> FloatArray:
        return self.data.frequencies

    @property
    def measured(self) -> ComplexArray:
        return np.asarray(self.data.values[:, 0, 0])

    def predicted(self, values: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        return self._distorted(values, self.frequencies)

    def residuals(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        if self.form == "complex":
            return super().residuals(values)
        predicted, slopes = self.predicted(values)
        ratio, relative = np.log(predicted / self.measured), slopes / predicted[:, None]
        size = np.sqrt(self.noise) / np.abs(self.measured)
        return _parts(ratio / size), _parts(relative / size[:, None])

    @property
    def deviations(self) -> FloatArray:
        return np.tile(np.sqrt(self.noise), 2)

    @property
    def likeness(self) -> FloatArray:
        if self.correlation is not None or self.data.coherence is None:
            return super().likeness
        count = len(self.frequencies)
        return np.asarray(np.kron(np.eye(2), toeplitz(np.pad(HANN, (0, count))[:count])))

    def take_measured_noise(self, noise: Noise) -> None:
        self.noise = self.noise * noise.ratio

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


def make_block(model: Drivetrain, measurement: Measurement, parameters: tuple[str, ...], form: str) -> Block:
    """The block of one measurement.

    Raises
    ------
    UsageError
        Names that model or data lack, unlike units, no line in the band.
    """
    rig = model.configured(measurement.configuration) if measurement.configuration else model
    data = measurement.data
    if isinstance(data, FrequencyResponse):
        chosen = _chosen_lines(data.select(measurement.output, measurement.input), measurement)
        response = _response(rig, measurement, chosen.frequencies, parameters, (chosen.outputs[0], chosen.inputs[0]))
        return ResponseBlock(measurement, response, chosen, form)
    settings = measurement.settings or default_settings(data, measurement.band)
    band = measurement.band or _usable_band(data, measurement, settings)
    check_memory(measurement.label, data, settings, band)
    windowed = windowed_estimate(
        data,
        measurement.output,
        measurement.input,
        settings,
        band,
        measurement.settling,
        instrument_of(rig, measurement, data, settings),
    )
    kept = _kept(windowed.frequencies, measurement)
    units = tuple(Channel(name, data[name].unit) for name in (measurement.output, measurement.input))
    response = _response(rig, measurement, windowed.fine, parameters, (units[0], units[1]))
    rows = windowed.rows.only(kept)
    steps = steps_covariance(data, measurement.output, measurement.input, windowed.record, rows)
    return RecordBlock(measurement, response, windowed, kept, steps)


def default_settings(record: Recording, band: tuple[float, float] | None = None) -> Welch:
    """The source paper's windows; records faster than 1 kHz are decimated as far as the band allows."""
    factor = factor_for(record.sampling_rate, band[1] if band else 0.0)
    return Welch(PAPER.window, PAPER.seconds, PAPER.overlap, decimation=factor)


def _usable_band(data: Recording, measurement: Measurement, settings: Welch) -> tuple[float, float]:
    response = estimate(data, measurement.output, measurement.input, "H1", settings)
    top = response.frequencies[-1] if response.usable_up_to is None else response.usable_up_to
    return float(response.frequencies[0]), float(top)


def _chosen_lines(data: FrequencyResponse, measurement: Measurement) -> FrequencyResponse:
    from dataclasses import replace

    low, high = measurement.band or (0.0, data.usable_up_to or np.inf)
    inside = (data.frequencies >= low) & (data.frequencies <= high) & (data.frequencies > 0)
    kept = inside & np.isfinite(data.values[:, 0, 0]) & (data.values[:, 0, 0] != 0)
    for start, stop in measurement.excluded:
        kept &= (data.frequencies < start) | (data.frequencies > stop)
    if not kept.any():
        raise UsageError(_empty(data.frequencies, measurement))
    coherence = None if data.coherence is None else data.coherence[kept]
    return replace(data, frequencies=data.frequencies[kept], values=data.values[kept], coherence=coherence)


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
