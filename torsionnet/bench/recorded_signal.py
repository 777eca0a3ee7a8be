"""Signal that a channel of a bench records: errors of transducers, encoders and telemetry applied to the truth."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from torsionnet.base.entries.spec import not_none
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.bench.plan import Acquisition, DropOuts, Encoder, Exciter, StrainGauge, Transducer
from torsionnet.signals.excitation import Excitation
from torsionnet.signals.recording import FloatArray, Signal

# Set-point and torque of the exciter that follows an excitation.

TURN = 2 * np.pi  # rad


@dataclass(frozen=True, eq=False)
class ExciterOutput:
    """Set-point at the analog output and torque at the motor over time, both (n,) in N m, with notes on clipping."""

    set_point: FloatArray
    torque: FloatArray
    notes: tuple[NoteOrText, ...] = ()


def exciter_output(excitation: Excitation, exciter: Exciter, sampling_rate: float) -> ExciterOutput:
    """Set-point and torque of an exciter that follows an excitation.

    The set-point is raised beforehand if it is compensated, clipped at the rated torque and rounded to the steps of
    the analog output; the torque follows it with a first-order lag and is bent by the harmonics.
    """
    wanted = excitation.samples(sampling_rate)
    raised = (
        compensated_set_point(wanted, not_none(exciter.bandwidth), sampling_rate) if exciter.compensated else wanted
    )
    set_point, notes = _limited(raised, exciter)
    followed = (
        first_order_lag(set_point, exciter.bandwidth, sampling_rate, wanted[0]) if exciter.bandwidth else set_point
    )
    torque = with_harmonics(followed, excitation, exciter.harmonics or {})
    return ExciterOutput(set_point, torque, notes)


def compensated_set_point(wanted: FloatArray, bandwidth: float, sampling_rate: float) -> FloatArray:
    """Set-point with which a first-order lag delivers the torque wanted at every sample, (n,) in N m.

    The lag's step y[n+1] = a y[n] + (1 - a) u[n] solved for u; the last sample is held.
    """
    a = _decay(bandwidth, sampling_rate)
    raised = (wanted[1:] - a * wanted[:-1]) / (1 - a)
    return np.append(raised, wanted[-1:])


def first_order_lag(set_point: FloatArray, bandwidth: float, sampling_rate: float, rest: float) -> FloatArray:
    """Torque behind a first-order lag, 3 dB down at ``bandwidth`` (Hz), with the set-point held between samples.

    Before the first sample the torque is steady at ``rest``.
    """
    from scipy.signal import lfilter

    a = _decay(bandwidth, sampling_rate)
    return np.asarray(rest + lfilter([0.0, 1 - a], [1.0, -a], set_point - rest))


def _decay(bandwidth: float, sampling_rate: float) -> float:
    return float(np.exp(-TURN * bandwidth / sampling_rate))


def with_harmonics(torque: FloatArray, excitation: Excitation, shares: dict[int, float]) -> FloatArray:
    """Torque with harmonics added, in N m: Chebyshev polynomials turn a sine of full amplitude into its multiples.

    ``shares`` are relative amplitudes by harmonic. The mean of even harmonics is left out: the control holds the mean.
    """
    if not any(shares.values()) or not excitation.amplitude:
        return torque
    # T_n(cos x) = cos(n x), and the share is cos x for a sine of full amplitude.
    share = (torque - excitation.mean) / excitation.amplitude
    coefficients = np.zeros(max(shares) + 1)
    coefficients[list(shares)] = list(shares.values())
    even = chebyshev.chebval(share, coefficients * (np.arange(len(coefficients)) % 2 == 0))
    added = chebyshev.chebval(share, coefficients) - even.mean()
    return np.asarray(torque + excitation.amplitude * added)


def _limited(set_point: FloatArray, exciter: Exciter) -> tuple[FloatArray, tuple[NoteOrText, ...]]:
    notes: list[NoteOrText] = []
    ends = [end for end in (exciter.limit, exciter.full_scale) if end is not None]
    if ends:
        limit = min(ends)
        clipped = np.count_nonzero(np.abs(set_point) > limit)
        if clipped:
            what = "rated torque" if limit == exciter.limit else "range of the analog output"
            share = f"{100 * clipped / len(set_point):.2g} % of the time"
            peak = f"it asks for {np.abs(set_point).max():.4g} N*m"
            notes.append(warning(f"set-point clipped at the {what} of {limit:g} N*m {share}; {peak}"))
            set_point = np.clip(set_point, -limit, limit)
    if exciter.bits is not None:
        # The range from -full_scale to full_scale in 2^bits steps.
        set_point = quantised(set_point, 2 * not_none(exciter.full_scale) / 2**exciter.bits)
    return set_point, tuple(notes)


def quantised(values: FloatArray, step: float) -> FloatArray:
    """Values rounded to the nearest step of an analog-digital converter."""
    return np.asarray(step * np.round(values / step))


# Disturbances of analog channels: shunt calibration, drift of the zero, hum of the mains, drop-outs of telemetry.


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


def with_creep(part: Transducer, values: FloatArray, acquisition: Acquisition) -> FloatArray:
    """Values (n,) with what creep adds of them, which has settled at the first one."""
    creep = part.creep if isinstance(part, StrainGauge) else None
    if creep is None:
        return values
    return values + creep.share * first_order_lag(values, 1 / (TURN * creep.time), acquisition.rate, values[0])


def moving_zero(part: Transducer, count: int, acquisition: Acquisition) -> FloatArray:
    """Zero of a strain gauge at each of so many samples, (n,) in SI, that drifts from 0 to its change."""
    drift = part.zero_drift if isinstance(part, StrainGauge) else None
    if drift is None:
        return np.zeros(count)
    share = np.arange(count) / max(count - 1, 1)
    if drift.warming is not None:
        # 1 - exp(-t/tau), scaled to the full change at the end of the record.
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
    # A Poisson number at the mean rate, spread evenly.
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
    # Place of the last value that came, carried on over each gap.
    last = np.maximum.accumulate(np.where(gone, -1, np.arange(len(values))))
    return np.where(last < 0, 0.0, values[np.maximum(last, 0)])  # before anything came the receiver shows zero


ANTI_ALIAS_ORDER = 4
"""Order of the Butterworth anti-alias filter of the analog channels."""


def recorded_signal(
    truth: Signal, part: Transducer | Encoder, acquisition: Acquisition, rng: np.random.Generator
) -> Signal:
    """Signal that one channel records of a true signal, with the errors of its transducer or encoder."""
    late = replace(truth, values=_delayed(truth.values, part.delay * acquisition.rate))
    return _encoded(late, part, rng) if isinstance(part, Encoder) else _transduced(late, part, acquisition, rng)


def _encoded(truth: Signal, encoder: Encoder, rng: np.random.Generator) -> Signal:
    """Angle counted by an incremental encoder in whole steps, 0 at the first sample.

    The position of the shaft between two edges at the first sample is random.
    """
    step = 2 * np.pi / encoder.steps
    # Share of a step by which the shaft stands beyond an edge at first.
    place = rng.random()
    counts = np.floor((truth.values - truth.values[0]) / step + place)
    way = "in quadrature" if encoder.quadrature else "one step each"
    note = f"encoder of {encoder.lines} lines, {way}: steps of {np.degrees(step):.6g} deg"
    return replace(truth, values=step * counts, notes=(*truth.notes, note))


def _transduced(truth: Signal, part: Transducer, acquisition: Acquisition, rng: np.random.Generator) -> Signal:
    """Signal of a transducer: gain, noise, offset, anti-alias filter, range and quantisation applied."""
    hum, lost = rng.spawn(2)  # generators of their own, so that no fault changes the noise
    # In the order of the chain: creep, gain, noise, zero, anti-alias filter, range and steps, telemetry.
    value = with_creep(part, truth.values, acquisition) + shunt_steps(part, truth, acquisition)
    values, notes = part.gain * value, list(truth.notes)
    if part.noise is not None:
        values = values + float(part.noise.value) * rng.standard_normal(len(values))
    if part.offset is not None:
        values = values + float(part.offset.value)
    values = values + moving_zero(part, len(values), acquisition) + hum_of_mains(part, len(values), acquisition, hum)
    if acquisition.anti_alias is not None:
        values = _filtered(values, acquisition)
    if part.range is not None:
        limit = float(part.range.value)
        clipped = int(np.count_nonzero(np.abs(values) > limit))
        if clipped:
            notes.append(warning(f"{truth.name} clipped at its range of {limit:g} {truth.unit} in {clipped} samples"))
        values = np.clip(values, -limit, limit)
        if acquisition.bits is not None:
            values = quantised(values, 2 * limit / 2**acquisition.bits)
    if part.drop_outs is not None:
        values = without_telemetry(values, part.drop_outs, drop_out_spans(part, len(values), acquisition, lost))
    return replace(truth, values=values, notes=tuple(notes))


def _filtered(values: FloatArray, acquisition: Acquisition) -> FloatArray:
    """Values behind the anti-alias low-pass, which has settled at the first value; delayed as in a real one."""
    from scipy.signal import butter, sosfilt, sosfilt_zi

    sections = butter(ANTI_ALIAS_ORDER, not_none(acquisition.anti_alias), fs=acquisition.rate, output="sos")
    settled = sosfilt_zi(sections) * values[0]
    return np.asarray(sosfilt(sections, values, zi=settled)[0])


def _delayed(values: FloatArray, samples: float) -> FloatArray:
    """Values delayed by a number of samples, whole or not, by cubic interpolation; the first value before the start."""
    if samples == 0:
        return values
    from scipy.interpolate import CubicSpline

    places = np.arange(len(values)) - samples
    return np.asarray(
        np.where(places > 0, CubicSpline(np.arange(len(values)), values)(np.maximum(places, 0)), values[0])
    )
