"""Matrix of averaged auto and cross spectral densities of signals over frequency."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.notes import NoteOrText
from torsionnet.linear.frequency_response import Channel
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.welch import Welch

ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class CrossSpectra:
    """Averaged one-sided auto and cross spectral densities of signals, a complex matrix (n_f, n, n) over frequency.

    Attributes
    ----------
    frequencies : (n_f,) array
        Frequencies, Hz.
    matrix : (n_f, n, n) complex array
        ``matrix[:, a, b]`` is the mean of ``conj(A) B``: its phase is the lead of ``b`` over ``a``.
    channels : tuple of Channel
    averages : int
        Number of segments.
    effective_averages : float
        Number of independent segments with the same uncertainty.
    settings : Welch
    sampling_rate : float
        Sampling rate of the signals after decimation, Hz.
    title : str
    notes : tuple of str or Note
    """

    frequencies: FloatArray
    matrix: ComplexArray
    channels: tuple[Channel, ...]
    averages: int
    effective_averages: float
    settings: Welch
    sampling_rate: float
    title: str = ""
    notes: tuple[NoteOrText, ...] = ()

    def indices(self, names: Iterable[str]) -> list[int]:
        """Indices of the named signals in rows and columns of the matrix of spectral densities."""
        known = [channel.name for channel in self.channels]
        wanted = list(names)
        for name in wanted:
            if name not in known:
                raise UsageError(f'no signal is named "{name}"{did_you_mean(name, known)}; there is {", ".join(known)}')
        return [known.index(name) for name in wanted]

    def between(self, first: Iterable[str], second: Iterable[str]) -> ComplexArray:
        """Cross spectral densities of two groups of signals, SI units per Hz, (n_f, n_first, n_second), complex."""
        rows, columns = self.indices(first), self.indices(second)
        return self.matrix[np.ix_(range(len(self.frequencies)), rows, columns)]
