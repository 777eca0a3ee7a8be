"""Disturbances of analog channels: shunt calibration, drift of the zero, hum of the mains, drop-outs of telemetry."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.spec import not_none
from torsionnet.bench.plan import Acquisition, DropOuts, StrainGauge, Transducer
from torsionnet.signals.recording import FloatArray, Signal


def shunt_steps(part: Transducer, truth: Signal, acquisition: Acquisition) -> FloatArray:
    """Value that the shunt of a strain gauge adds to each sample, (n,) in SI; 0 while it is not connected."""
    added = np.zeros(len(truth.values))
    if isinstance(part, StrainGauge) and part.shunt is not None:
        added[shunt_span(part, len(added), acquisition)] = float(part.shunt.value.value)
    return added


def shunt_span(part: StrainGauge, count: int, acquisition: Acquisition) -> slice:
    """Samples for which the shunt is connected, of so many."""
    shunt = not_none(part.shunt)
    samples = min(count, round(shunt.duration * acquisition.rate))
    return slice(0, samples) if shunt.at == "start" else slice(count - samples, count)


def moving_zero(part: Transducer, count: int, acquisition: Acquisition) -> FloatArray:
    """Zero of a strain gauge at each of so many samples, (n,) in SI, that drifts from 0 to its change."""
    drift = part.zero_drift if isinstance(part, StrainGauge) else None
    if drift is None:
        return np.zeros(count)
    share = np.arange(count) / max(count - 1, 1)
    if drift.warming is not None:
        over = (count - 1) / acquisition.rate / drift.warming
        share = -np.expm1(-share * over) / -np.expm1(-over)
    return float(drift.change.value) * share


def hum_of_mains(part: Transducer, count: int, acquisition: Acquisition, rng: np.random.Generator) -> FloatArray:
    """Hum at each of so many samples, (n,) in SI, from a random phase."""
    if part.hum is None:
        return np.zeros(count)
    phase = 2 * np.pi * (part.hum.frequency * np.arange(count) / acquisition.rate + rng.random())
    return np.asarray(float(part.hum.amplitude.value) * np.cos(phase))


def drop_out_spans(
    part: Transducer, count: int, acquisition: Acquisition, rng: np.random.Generator
) -> tuple[slice, ...]:
    """Samples of each time without telemetry, rising; their beginnings are independent of each other."""
    lost = part.drop_outs
    if lost is None:
        return ()
    begins = np.sort(rng.integers(0, max(count, 1), rng.poisson(lost.rate * count / acquisition.rate)))
    length = max(1, round(lost.duration * acquisition.rate))
    return tuple(slice(begin, min(begin + length, count)) for begin in begins.tolist())


def without_telemetry(values: FloatArray, lost: DropOuts, spans: tuple[slice, ...]) -> FloatArray:
    """Values (n,) with the last one before each drop-out held, or zeros, in its place."""
    gone: NDArray[np.bool_] = np.zeros(len(values), dtype=bool)
    for span in spans:
        gone[span] = True
    if lost.reads == "zero":
        return np.where(gone, 0.0, values)
    last = np.maximum.accumulate(np.where(gone, -1, np.arange(len(values))))
    return np.where(last < 0, 0.0, values[np.maximum(last, 0)])  # before anything came the receiver shows zero
