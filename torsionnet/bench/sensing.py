"""From true motion and torque to what a recorder stores."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from torsionnet.bench.exciting import rounded
from torsionnet.core.entries.spec import present
from torsionnet.model.bench import Acquisition, Encoder, Transducer
from torsionnet.response.recording import FloatArray, Signal

ORDER = 4
"""Of the anti-alias filter in the analog channels."""
PAD_CYCLES = 20
"""Cycles of its cut-off before the record for which the filter has seen the first value."""


def sensed(truth: Signal, part: Transducer | Encoder, acquisition: Acquisition, rng: np.random.Generator) -> Signal:
    """What one channel records of a true signal."""
    late = replace(truth, values=delayed(truth.values, part.delay * acquisition.rate))
    return encoded(late, part, rng) if isinstance(part, Encoder) else transduced(late, part, acquisition, rng)


def encoded(truth: Signal, encoder: Encoder, rng: np.random.Generator) -> Signal:
    """Whole steps of an incremental encoder whose count is 0 at the first sample.

    Where between two edges the shaft stands then is a matter of chance.
    """
    step = 2 * np.pi / encoder.steps
    place = rng.random()
    counts = np.floor((truth.values - truth.values[0]) / step + place)
    way = "in quadrature" if encoder.quadrature else "one step each"
    note = f"encoder of {encoder.lines} lines, {way}: steps of {np.degrees(step):.6g} deg"
    return replace(truth, values=step * counts, notes=(*truth.notes, note))


def transduced(truth: Signal, part: Transducer, acquisition: Acquisition, rng: np.random.Generator) -> Signal:
    """Gain, noise, offset, anti-alias filter, range and analog input of a transducer."""
    values, notes = part.gain * truth.values, list(truth.notes)
    if part.noise is not None:
        values = values + float(part.noise.value) * rng.standard_normal(len(values))
    if part.offset is not None:
        values = values + float(part.offset.value)
    if acquisition.anti_alias is not None:
        values = filtered(values, acquisition)
    if part.range is not None:
        limit = float(part.range.value)
        clipped = int(np.count_nonzero(np.abs(values) > limit))
        if clipped:
            notes.append(f"warning: {truth.name} clipped at its range of {limit:g} {truth.unit} in {clipped} samples")
        values = np.clip(values, -limit, limit)
        if acquisition.bits is not None:
            values = rounded(values, 2 * limit / 2**acquisition.bits)
    return replace(truth, values=values, notes=tuple(notes))


def filtered(values: FloatArray, acquisition: Acquisition) -> FloatArray:
    """Low-pass in front of the analog input, settled at the first value; it delays, as the real one does."""
    from scipy.signal import butter, sosfilt, sosfilt_zi

    sections = butter(ORDER, present(acquisition.anti_alias), fs=acquisition.rate, output="sos")
    settled = sosfilt_zi(sections) * values[0]
    return np.asarray(sosfilt(sections, values, zi=settled)[0])


def delayed(values: FloatArray, samples: float) -> FloatArray:
    """Values later by a number of samples, whole or not, that begins at rest; cubic between samples."""
    if samples == 0:
        return values
    from scipy.interpolate import CubicSpline

    places = np.arange(len(values)) - samples
    return np.asarray(
        np.where(places > 0, CubicSpline(np.arange(len(values)), values)(np.maximum(places, 0)), values[0])
    )
