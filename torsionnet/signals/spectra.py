"""Auto and cross spectra of recordings by Welch's method, in bounded memory, and spectrograms.

Transfer functions (H1, H2, Hs, Hr) and coherences from arrays of auto and cross spectral densities. All follow scipy's
convention ``S_ab = mean(conj(A) B)``. With ``y = H x`` that gives ``S_xy = S_xx H^T`` and ``S_yy = S_yx H^T``, hence
``H1 = S_xy / S_xx`` and ``H2 = S_yy / S_yx``. ``S_yy / S_xy`` has the phase of the opposite sign.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.notes import NoteOrText
from torsionnet.base.result_rows import NUMBER_ROWS, Out
from torsionnet.linear.frequency_response import Channel
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.resampling import (
    Recordings,
    blocks_in_order,
    check_count,
    check_processable,
    decimate,
    decimated,
    stacked,
)
from torsionnet.signals.welch import Welch, effective_averages, without_trend

# Matrix of averaged auto and cross spectral densities of signals over frequency.

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
                raise UsageError(
                    f'no signal is named "{name}"{did_you_mean(name, known)}; there is {", ".join(known)}',
                    kind="unknown-channel",
                )
        return [known.index(name) for name in wanted]

    def between(self, first: Iterable[str], second: Iterable[str]) -> ComplexArray:
        """Cross spectral densities of two groups of signals, SI units per Hz, (n_f, n_first, n_second), complex."""
        rows, columns = self.indices(first), self.indices(second)
        return self.matrix[np.ix_(range(len(self.frequencies)), rows, columns)]


VALUES_PER_BATCH = 1_000_000
"""Number of values in segments that are Fourier transformed together, which limits the memory."""


def cross_spectra(
    recordings: Recordings, settings: Welch | None = None, names: Iterable[str] | None = None
) -> CrossSpectra:
    """Auto and cross spectral densities averaged over the segments of one or more recordings, (n_f, n, n).

    Parameters
    ----------
    recordings : Recording or iterable of Recording
        Blocks of a long record that follow on each other are read as one; others are averaged as repeated tests.
        Only one block at a time is kept in memory.
    settings : Welch, optional
    names : iterable of str, optional
        Signals wanted; all by default.

    Raises
    ------
    UsageError
        No recording is long enough for one segment, or a recording cannot be processed.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> noise = np.random.default_rng(1).normal(size=10_000)
    >>> record = Recording((Signal("T", "torque", noise),), sampling_rate=100)
    >>> spectra = cross_spectra(record)
    >>> spectra.averages, round(float(spectra.matrix.real.mean()), 3)
    (246, 0.02)
    """
    settings = settings or Welch()
    blocks = _selected(recordings, names)
    total = _Total(settings)
    for block, follows in blocks_in_order(decimated(blocks, settings.decimation)):
        total.add(block, follows)
    return total.mean()


def _selected(recordings: Recordings, names: Iterable[str] | None) -> Iterator[Recording]:
    wanted = None if names is None else tuple(dict.fromkeys(names))
    for block in [recordings] if isinstance(recordings, Recording) else recordings:
        yield block if wanted is None else block.select(wanted)


class _Total:
    """Sum of the cross spectra of segments so far, with the samples left over for the next block."""

    def __init__(self, settings: Welch) -> None:
        self.settings = settings
        self.first: Recording | None = None
        self.runs: list[int] = []
        self.sum: ComplexArray = np.zeros(0, dtype=complex)
        self.weights: FloatArray = np.zeros(0)
        self.waiting: FloatArray = np.zeros(0)
        self.samples = 0

    def add(self, block: Recording, follows: bool) -> None:
        self.first = self.first or block
        values = stacked(block)
        self.samples += values.shape[1]
        if follows:
            values = np.concatenate([self.waiting, values], axis=1)
        else:
            self.runs.append(0)
        self.waiting = values
        if values.shape[1] >= self.settings.samples(block.sampling_rate):
            if not len(self.weights):
                self._begin(block)
            self._add_segments(values)

    def _begin(self, block: Recording) -> None:
        """Create window and sums for the first block that is long enough for a segment."""
        self.weights = self.settings.weights(block.sampling_rate)
        self.step = self.settings.step(block.sampling_rate)
        count, size = len(self.weights) // 2 + 1, len(block.signals)
        self.sum = np.zeros((count, size, size), dtype=complex)

    def _add_segments(self, values: FloatArray) -> None:
        length = len(self.weights)
        segments = np.lib.stride_tricks.sliding_window_view(values, length, axis=1)[:, :: self.step]
        count, batch = segments.shape[1], max(1, VALUES_PER_BATCH // (length * len(values)))
        for begin in range(0, count, batch):
            plain = without_trend(segments[:, begin : begin + batch], self.settings.detrend)
            lines = np.fft.rfft(plain * self.weights, axis=-1).transpose(2, 0, 1)
            # Sum over the segments of X^* Y for all pairs of signals.
            self.sum += lines.conj() @ lines.transpose(0, 2, 1)
        self.runs[-1] += count
        self.waiting = values[:, count * self.step :]

    def mean(self) -> CrossSpectra:
        count = sum(self.runs)
        if self.first is None or count == 0:
            have = self.samples / self.first.sampling_rate if self.first else 0
            text = f"the record of {have:g} s is too short for one window of {self.settings.seconds:g} s"
            raise UsageError(f"{text}; take shorter windows (seconds)", kind="too-short")
        rate, length = self.first.sampling_rate, len(self.weights)
        # One-sided densities 2/(f_s sum w^2) a segment, without the 2 at 0 and at half the sampling rate.
        scale = np.full(len(self.sum), 2 / (rate * (self.weights @ self.weights) * count))
        scale[0] /= 2
        if length % 2 == 0:
            scale[-1] /= 2
        kept = slice(0 if self.settings.detrend == "none" else 1, None)
        return CrossSpectra(
            frequencies=np.asarray(np.fft.rfftfreq(length, 1 / rate)[kept], dtype=np.float64),
            matrix=(self.sum * scale[:, None, None])[kept],
            channels=tuple(Channel(signal.name, signal.unit, signal.course(rate)) for signal in self.first),
            averages=count,
            effective_averages=sum(effective_averages(self.weights, self.step, run) for run in self.runs if run),
            settings=self.settings,
            sampling_rate=rate,
            title=self.first.title,
            notes=self.first.notes,
        )


# Transfer functions (H1, H2, Hs, Hr) and coherences from arrays of auto and cross spectral densities.


def h1(s_xx: ComplexArray, s_xy: ComplexArray) -> ComplexArray:
    """Transfer functions by H1, (n_f, n_out, n_in), least squares on the outputs, unbiased if only these are noisy."""
    if s_xx.shape[1] == 1:
        return _quotient(s_xy.transpose(0, 2, 1), s_xx)
    return _complex((np.linalg.pinv(s_xx, hermitian=True) @ s_xy).transpose(0, 2, 1))


def h2(s_yy: ComplexArray, s_yx: ComplexArray) -> ComplexArray:
    """Transfer functions by H2, (n_f, n_out, n_in), least squares on the inputs, unbiased if only these are noisy.

    It needs as many outputs as inputs, or more.
    """
    if s_yx.shape[2] == 1:
        return _quotient(np.einsum("foo->fo", s_yy)[:, :, None], s_yx)
    return _complex((np.linalg.pinv(s_yx) @ s_yy).transpose(0, 2, 1))


def hr(s_rx: ComplexArray, s_ry: ComplexArray) -> ComplexArray:
    """Transfer functions by Hr, (n_f, n_out, n_in), from references without the noise of inputs and outputs.

    It needs as many references as inputs, or more: ``S_ry = S_rx H^T``, by least squares. The method of instrumental
    variables; see Schoukens, Godfrey and Schoukens (2018), IEEE Control Systems 38(4), on noisy inputs.
    """
    if s_rx.shape[1] == s_rx.shape[2] == 1:
        return _quotient(s_ry.transpose(0, 2, 1), s_rx)
    return _complex((np.linalg.pinv(s_rx) @ s_ry).transpose(0, 2, 1))


def hs(s_xx: ComplexArray, s_xy: ComplexArray, s_yy: ComplexArray, noise_ratio: float | FloatArray) -> ComplexArray:
    """Transfer functions by Hs, (n_f, n_out, n_in), total least squares for each output, noise on both sides.

    ``noise_ratio`` is the spectral density of the output's noise over that of each input's noise, a number or
    (n_f, n_out): towards infinity the result becomes H1, towards zero H2.
    """
    ratio = np.broadcast_to(noise_ratio, (len(s_xx), s_xy.shape[2])).astype(np.float64)
    columns = []
    for o in range(s_xy.shape[2]):
        column = _hs_single if s_xx.shape[1] == 1 else _hs_several
        columns.append(column(s_xx, s_xy[:, :, o], s_yy[:, o, o].real, ratio[:, o]))
    return np.stack(columns, axis=1)


def _hs_single(s_xx: ComplexArray, s_xy: ComplexArray, s_yy: FloatArray, ratio: FloatArray) -> ComplexArray:
    gap = ratio * s_xx[:, 0, 0].real - s_yy
    root = np.hypot(gap, 2 * np.sqrt(ratio) * np.abs(s_xy[:, 0]))
    # Two forms of one root; either cancels where the other does not.
    from_input = _quotient(2 * ratio * s_xy[:, 0], gap + root)
    from_output = _quotient(root - gap, 2 * s_xy[:, 0].conj())
    return _complex(np.where(gap >= 0, from_input, from_output)[:, None])


def _hs_several(s_xx: ComplexArray, s_xy: ComplexArray, s_yy: FloatArray, ratio: FloatArray) -> ComplexArray:
    # Total least squares: with inputs and output scaled to equal noise, the eigenvector of the smallest eigenvalue.
    scaled = (s_xy / np.sqrt(ratio)[:, None])[:, :, None]
    below = np.concatenate([scaled.conj().transpose(0, 2, 1), (s_yy / ratio)[:, None, None]], axis=2)
    joint = np.concatenate([np.concatenate([s_xx, scaled], axis=2), below], axis=1)
    smallest = np.linalg.eigh(joint).eigenvectors[:, :, 0]
    return _quotient(-np.sqrt(ratio)[:, None] * smallest[:, :-1], smallest[:, -1:])


def ordinary_coherence(s_xx: ComplexArray, s_xy: ComplexArray, s_yy: ComplexArray) -> FloatArray:
    """Ordinary coherence, the share of each output's power that is linear in one input alone, (n_f, n_out, n_in)."""
    inputs, outputs = np.einsum("fii->fi", s_xx).real, np.einsum("foo->fo", s_yy).real
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray((np.abs(s_xy) ** 2 / inputs[:, :, None] / outputs[:, None, :]).transpose(0, 2, 1))


def multiple_coherence(s_xx: ComplexArray, s_xy: ComplexArray, s_yy: ComplexArray) -> FloatArray:
    """Multiple coherence, the share of each output's power that is linear in all inputs together, (n_f, n_out)."""
    explained = np.einsum("fio,foi->fo", s_xy.conj(), h1(s_xx, s_xy)).real
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(explained / np.einsum("foo->fo", s_yy).real)


def independence(s_xx: ComplexArray) -> FloatArray:
    """Smallest eigenvalue of the normalised input spectra, (n_f,), from 1 (uncorrelated) to 0 (inseparable)."""
    sizes = np.sqrt(np.einsum("fii->fi", s_xx).real)
    scaled = np.divide(s_xx, sizes[:, :, None] * sizes[:, None, :], out=np.zeros_like(s_xx), where=s_xx != 0)
    return np.asarray(np.linalg.eigvalsh(scaled)[:, 0])


def _quotient(above: ComplexArray | FloatArray, below: ComplexArray | FloatArray) -> ComplexArray:
    with np.errstate(divide="ignore", invalid="ignore"):
        return _complex(above / below)


def _complex(values: NDArray[np.generic]) -> ComplexArray:
    return np.asarray(values, dtype=np.complex128)


# Spectrograms of signals, which give their amplitude over frequency and time.


@dataclass(frozen=True, eq=False)
class Spectrogram:
    """Amplitude (n_f, n_t) of a signal over frequency and time, in the signal's unit.

    Attributes
    ----------
    frequencies : (n_f,) array
        Frequencies, Hz.
    times : (n_t,) array
        Middle of each segment, s.
    amplitude : (n_f, n_t) array
        Peak amplitude of a sine that would give this line, in the unit of the signal.
    name : str
    unit : str
    notes : tuple of str or Note
    """

    SHOWN: ClassVar = ("name", "unit", "notes", "times", "frequencies", "amplitude")

    frequencies: Annotated[FloatArray, Out(json="frequencies_Hz")]
    times: Annotated[FloatArray, Out(json="times_s")]
    amplitude: Annotated[FloatArray, Out(schema=NUMBER_ROWS)]
    name: Annotated[str, Out(json="channel")]
    unit: str
    notes: tuple[NoteOrText, ...] = ()

    def decibels(self, zero_level: float = 1.0) -> FloatArray:
        """Amplitude in dB over a reference amplitude in the signal's unit, (n_f, n_t)."""
        with np.errstate(divide="ignore"):
            return np.asarray(20 * np.log10(self.amplitude / zero_level))

    @property
    def ridge(self) -> FloatArray:
        """Frequency in Hz of the strongest line at each time, (n_t,)."""
        return np.asarray(self.frequencies[self.amplitude.argmax(axis=0)])


def spectrogram(recording: Recording, name: str, settings: Welch | None = None) -> Spectrogram:
    """Spectrogram of one signal from short-time spectra, by default of 2 s, Hamming, with 80 % overlap.

    The mean of the whole record is removed first unless the settings' ``detrend`` is ``none``. Segments that would
    reach beyond an end of the record are left out. In a sweep a line is lower than the sine's amplitude as soon as
    the frequency moves by more than about a bin within a segment.

    Raises
    ------
    UsageError
        The record is shorter than a segment, or the segments overlap so much that no machine keeps the lines.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> time = np.arange(2000) / 200
    >>> record = Recording((Signal("T", "torque", 10 * np.sin(2 * np.pi * 30 * time)),), sampling_rate=200)
    >>> seen = spectrogram(record, "T")
    >>> seen.ridge[0].item(), seen.decibels().max().round(3).item()
    (30.0, 20.0)
    """
    from scipy.signal import ShortTimeFFT

    settings = settings or Welch()
    chosen = recording.select([name])
    check_processable(chosen)
    chosen = decimate(chosen, settings.decimation)
    rate, count = chosen.sampling_rate, len(chosen)
    if count < settings.samples(rate):
        text = f"the record of {chosen.duration:g} s is too short for one window of {settings.seconds:g} s"
        raise UsageError(f"{text}; take shorter windows (seconds)", kind="too-short")
    weights, step = settings.weights(rate), settings.step(rate)
    slices = (count - len(weights)) // step + 1
    about = f"{count} samples in windows of {settings.seconds:g} s with {100 * settings.overlap:g} % overlap"
    check_count(slices * (len(weights) / 2 + 1), count, about, "take less overlap")
    transform = ShortTimeFFT(weights, step, rate, scale_to="magnitude", fft_mode="onesided")
    middle = len(weights) // 2
    values = without_trend(chosen[name].values, settings.detrend)
    lines = np.abs(transform.stft(values, 0, slices, k_offset=middle))
    mirrored = slice(1, -1 if len(weights) % 2 == 0 else None)
    lines[mirrored] *= 2  # a sine's other half is at the negative frequency
    return Spectrogram(
        frequencies=np.asarray(transform.f, dtype=np.float64),
        times=chosen.start + (middle + step * np.arange(slices)) / rate,
        amplitude=np.asarray(lines, dtype=np.float64),
        name=name,
        unit=chosen[name].unit,
        notes=(*chosen.notes, f"spectrogram, {settings}"),
    )
