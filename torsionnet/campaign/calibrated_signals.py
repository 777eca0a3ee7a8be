"""Signals of a campaign with their calibration applied."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from torsionnet.model.campaign.campaign_file import CampaignChannel
from torsionnet.response.recording import FloatArray, Signal


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
