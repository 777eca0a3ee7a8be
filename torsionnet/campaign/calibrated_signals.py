"""Signals of a campaign with their calibration applied, and records cut to the times that count."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from torsionnet.model.campaign.campaign_file import CampaignChannel, CampaignRecord
from torsionnet.response.recording import FloatArray, Recording, Signal


def with_gain(signal: Signal, channel: CampaignChannel) -> Signal:
    """Signal multiplied by the gain of its channel, with a note where that is not 1."""
    if channel.gain == 1:
        return signal
    return replace(
        signal, values=channel.gain * signal.values, notes=(*signal.notes, f"multiplied by {channel.gain:g}")
    )


def without_delay(signal: Signal, channel: CampaignChannel, time: FloatArray) -> Signal:
    """Signal without the delay of its channel, at the times (n,) in s of its record, by splines between its samples."""
    if not channel.delay:
        return signal
    from scipy.interpolate import CubicSpline

    # Beyond the last sample nothing is known: its value goes on for the time of the delay.
    values = CubicSpline(time, signal.values)(np.minimum(time + channel.delay, time[-1]))
    note = f"shifted {1e3 * channel.delay:g} ms to earlier times"
    return replace(signal, values=np.asarray(values, dtype=np.float64), notes=(*signal.notes, note))


def between_times(record: Recording, one: CampaignRecord) -> Recording:
    """Recording between the times from which and up to which a record of a campaign counts."""
    if one.start is None and one.stop is None:
        return record
    first, last = -np.inf if one.start is None else one.start, np.inf if one.stop is None else one.stop

    def kept(times: FloatArray) -> FloatArray:
        return np.asarray((times >= first) & (times <= last))

    inside = kept(record.time)
    times = record.time[inside]
    return replace(
        record,
        signals=tuple(replace(signal, values=signal.values[inside]) for signal in record),
        start=float(times[0]) if len(times) else record.start,
        times=None if record.times is None else times,
        pulses=tuple(replace(channel, times=channel.times[kept(channel.times)]) for channel in record.pulses),
    ).with_notes(f"cut to {first:g} to {last:g} s")
