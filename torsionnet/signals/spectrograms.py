"""Spectrograms of signals, which give their amplitude over frequency and time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.base.result_rows import NUMBER_ROWS, Out
from torsionnet.signals.decimation import check_processable, decimate
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.resampling import check_count
from torsionnet.signals.welch import Welch, without_trend


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

    def decibels(self, reference: float = 1.0) -> FloatArray:
        """Amplitude in dB over a reference amplitude in the signal's unit, (n_f, n_t)."""
        with np.errstate(divide="ignore"):
            return np.asarray(20 * np.log10(self.amplitude / reference))

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
        raise UsageError(f"{text}; take shorter windows (seconds)")
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
