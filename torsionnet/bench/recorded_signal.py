"""Signal that a channel of a bench records: errors of transducers, encoders and telemetry applied to the truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from torsionnet.base.entries.spec import not_none
from torsionnet.base.notes import warning
from torsionnet.bench.exciter_torque import quantised
from torsionnet.bench.gauge_chain import drop_out_spans, hum_of_mains, moving_zero, shunt_steps, without_telemetry
from torsionnet.bench.plan import Acquisition, Encoder, Transducer
from torsionnet.signals.recording import FloatArray, Signal

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
    place = rng.random()
    counts = np.floor((truth.values - truth.values[0]) / step + place)
    way = "in quadrature" if encoder.quadrature else "one step each"
    note = f"encoder of {encoder.lines} lines, {way}: steps of {np.degrees(step):.6g} deg"
    return replace(truth, values=step * counts, notes=(*truth.notes, note))


def _transduced(truth: Signal, part: Transducer, acquisition: Acquisition, rng: np.random.Generator) -> Signal:
    """Signal of a transducer: gain, noise, offset, anti-alias filter, range and quantisation applied."""
    hum, lost = rng.spawn(2)  # generators of their own, so that no fault changes the noise
    values, notes = part.gain * (truth.values + shunt_steps(part, truth, acquisition)), list(truth.notes)
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
