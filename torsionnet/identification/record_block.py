"""A record against the model, both estimated alike."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.identification.block import Block
from torsionnet.identification.input_noise import noise_of_input
from torsionnet.identification.noise import Noise, noise_between_windows
from torsionnet.identification.operator import WindowedEstimate
from torsionnet.identification.residual_forms import of_covariance


@dataclass(eq=False)
class RecordBlock(Block):
    """A record, or a response that remembers its own, by the same-estimator route.

    Attributes
    ----------
    given : (n_b,) complex array, optional
        Lines of a response estimated before, in the place of those that are estimated of the record.
    """

    windowed: WindowedEstimate
    kept: NDArray[np.bool_]
    steps: FloatArray
    given: ComplexArray | None = field(default=None, kw_only=True)
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

    @property
    def sensors(self) -> tuple[str, str, float]:
        """Output, input and sampling rate, which set the noise of a record."""
        return self.windowed.output, self.windowed.input, self.windowed.record.sampling_rate

    def unexplained(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What the model leaves of the output over unit white noise, and what such noise of the input does, (n_b,)."""
        G, _ = self._distorted(values, self.windowed.fine)
        return self.windowed.unexplained(G)[self.kept], np.abs(self.measured) ** 2

    def input_noise(self, values: FloatArray, on_output: float) -> tuple[float, float] | None:
        """Power of the noise of the input, seen where the excitation is elsewhere, and its standard error."""
        G, _ = self._distorted(values, self.windowed.fine)
        return noise_of_input(self.windowed, G, on_output)

    def take_sources(self, values: FloatArray, on_output: float, on_input: float) -> None:
        """Weigh by noise of these powers on output and input."""
        G, _ = self._distorted(values, self.windowed.fine)
        self.sources = on_output, on_input
        self.covariance = on_output * self._part(self.windowed.output_covariance())
        if on_input:
            self.covariance = self.covariance + on_input * self._part(self.windowed.input_covariance(G))

    def measured_noise(self, values: FloatArray) -> Noise | None:
        G, _ = self._distorted(values, self.windowed.fine)
        supposed = (self.deviations**2).reshape(2, -1).sum(axis=0)
        independent = self.count * len(self.frequencies) / self.squares
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
