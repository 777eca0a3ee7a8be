"""A record against the model, both estimated alike."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.stats import norm

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.identification.block import Block
from torsionnet.identification.noise import Noise, noise_between_windows
from torsionnet.identification.operator import WindowedEstimate
from torsionnet.identification.residual_forms import of_covariance

SOURCE_ROUNDS = 5


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


def two_sources(level: FloatArray, gain: FloatArray) -> tuple[float, float]:
    """Noise power of a sensor on the output, and of one on the input seen through the response, that fit a level best.

    One number each for all lines: the level of a single line rests on the few windows in which the sweep passes it,
    and weights made of that alone would favour lines that happen to agree. Neither is below 0; one that is found within
    its own uncertainty of 0 is taken as the mean of all it may be, as no sensor is free of noise by chance.

    >>> [round(share, 2) for share in two_sources(np.array([1.0, 3.0, 5.0]), np.array([0.0, 1.0, 2.0]))]
    [1.0, 2.0]
    """
    tiny = np.finfo(float).tiny
    found, columns = np.maximum(level, tiny), np.column_stack([np.ones_like(gain), gain])
    shares = np.zeros(2)
    for _ in range(SOURCE_ROUNDS):
        rows = columns / found[:, None]
        scale = np.maximum(rows.max(axis=0), tiny)
        shares = nnls(rows / scale, level / found)[0] / scale
        found = np.maximum(columns @ shares, tiny)
    shares = _probable(level, columns, found)
    return max(float(shares[0]), tiny if not shares.any() else 0.0), float(shares[1])


def _probable(level: FloatArray, columns: FloatArray, found: FloatArray) -> FloatArray:
    """Means of the two shares over what they may be: normal, but not below 0. Together they make up the level."""
    rows = columns / found[:, None]
    scale = np.maximum(np.linalg.norm(rows, axis=0), np.finfo(float).tiny)
    inverse = np.linalg.pinv(rows / scale)
    best, spread = inverse @ (level / found), np.sqrt(np.mean((level / found - 1) ** 2) * (inverse**2).sum(axis=1))
    far = best / np.maximum(spread, 1e-12 * np.abs(best).max())
    shares = np.maximum(best + spread * np.exp(norm.logpdf(far) - norm.logcdf(far)), 0.0) / scale
    return np.asarray(shares * np.mean(level / np.maximum(columns @ shares, np.finfo(float).tiny)))
