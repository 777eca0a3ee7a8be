"""Lag between two signals of a record, and what the windows of Welch's method lose by it.

A window sees the output that an input causes for as long as both lie in it: with a lag tau the mean of the windows'
products is less by the window's correlation with itself, 1 - tau/T for a plain one, and the coherence by its square.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from torsionnet.base.notes import Note, warning
from torsionnet.base.remedies import remedy
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.welch import Welch

DRIVEN_AMPLITUDE = 0.03
"""Share of the largest amplitude in the input's spectrum from which a frequency tells the lag."""
LEAST_CONCENTRATION = 0.5
"""Share of the lines that must agree on a lag; fewer show the phase of resonances, or noise."""
LEAST_LAG_PERIODS = 2.0
"""Least lag in periods of the driven bandwidth, as the phase of one resonance looks like a shorter one."""
NOTED_LOSS = 0.05
"""Share of a response that a lag must cost by the windows for a warning."""


def lag_between(record: Recording, output: str, input: str) -> float:
    """Lag in s of an output behind an input, from the phase over all driven frequencies; 0 where they tell none.

    Examples
    --------
    >>> noise = np.random.default_rng(1).standard_normal(4000)
    >>> late = Signal("y", "angle", np.concatenate([np.zeros(40), noise[:-40]]))
    >>> lag_between(Recording((Signal("x", "torque", noise), late), 100.0), "y", "x")
    0.4
    """
    size = 2 * len(record)
    X, Y = (np.fft.rfft(record[name].values - record[name].values.mean(), size) for name in (input, output))
    driven = np.abs(X) >= DRIVEN_AMPLITUDE * np.abs(X).max(initial=0.0)
    cross = np.where(driven, X.conj() * Y, 0.0)
    turns = np.divide(cross, np.abs(cross), out=np.zeros_like(cross), where=cross != 0)
    count = int(np.count_nonzero(turns))
    if not count:
        return 0.0
    # One side of the spectrum: its transform is the envelope, which does not mind a constant phase.
    envelope = np.abs(np.fft.ifft(turns, size)) * size / count
    place = int(np.argmax(envelope))
    lag = (place if place < size // 2 else place - size) / record.sampling_rate
    bandwidth = count * record.sampling_rate / size
    is_clear = envelope[place] >= LEAST_CONCENTRATION and abs(lag) * bandwidth >= LEAST_LAG_PERIODS
    return float(lag) if is_clear else 0.0


def kept_share(settings: Welch, rate: float, lag: float) -> float:
    """Share of a response that windows keep where the output lags by so many seconds.

    >>> round(kept_share(Welch("boxcar", 2.0), 100.0, 0.4), 3)
    0.8
    """
    weights = settings.weights(rate)
    away = min(round(abs(lag) * rate), len(weights))
    return float(weights[away:] @ weights[: len(weights) - away] / (weights @ weights))


def lag_warnings(record: Recording, outputs: tuple[str, ...], input: str, settings: Welch) -> list[Note]:
    """Warnings on outputs that lag so far behind the input that windows lose more than 5 % of the response."""
    found = []
    for output in outputs:
        lag = lag_between(record, output, input)
        kept = kept_share(replace(settings, decimation=1), record.sampling_rate, lag)
        if kept <= 1 - NOTED_LOSS:
            behind = f"{output} lags {input} by {lag:.3g} s" if lag > 0 else f"{input} lags {output} by {-lag:.3g} s"
            lost = (
                f"they lose {100 * (1 - kept):.0f} % of |{output}/{input}|, and the coherence is at most {kept**2:.2f}"
            )
            text = f"{behind}, windows last {settings.seconds:g} s: {lost}"
            mended = f"take longer windows, or align the signals ({remedy('align=True')})"
            found.append(warning(f"{text}; {mended}"))
    return found


def aligned(record: Recording, output: str, input: str) -> tuple[Recording, float]:
    """Record with an output earlier by its lag behind an input, in whole samples, and that lag in s."""
    samples = round(lag_between(record, output, input) * record.sampling_rate)
    first, last = max(samples, 0), len(record) + min(samples, 0)

    def moved(signal: Signal) -> Signal:
        start = first if signal.name == output else first - samples
        return replace(signal, values=signal.values[start : start + last - first])

    return replace(record, signals=tuple(map(moved, record))), samples / record.sampling_rate
