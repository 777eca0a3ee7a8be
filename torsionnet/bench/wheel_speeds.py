"""Speeds of the wheels of a bench from their recorded pulses, to be drawn over time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from torsionnet.bench.plan import Plan
from torsionnet.bench.plan.toothed_wheel import ToothedWheel
from torsionnet.signals.recording import FloatArray, Recording, Signal


def with_wheel_speeds(record: Recording, plan: Plan) -> Recording:
    """Record with the speed of each node that carries a wheel, in rad/s from its pulses, in front of its signals.

    Speeds are averages over a turn of the wheel as the pulses count it, with lost and double ones; they are drawn, not
    analysed.
    """
    speeds = tuple(_speeds(record, plan))
    return replace(record, signals=(*speeds, *record.signals)) if speeds else record


def _speeds(record: Recording, plan: Plan) -> Iterator[Signal]:
    for channel in record.pulses:
        part = plan.channels.get(channel.name)
        if not isinstance(part, ToothedWheel) or part.wheel:
            continue
        teeth = (part.teeth or 1) - part.missing_teeth
        if teeth > 1 and len(channel) > teeth:
            times = record.time if record.signals else _grid(record)
            middle = (channel.times[teeth:] + channel.times[:-teeth]) / 2
            turning = 2 * np.pi / (channel.times[teeth:] - channel.times[:-teeth]) / part.gearing
            yield Signal(channel.name, "velocity", np.interp(times, middle, turning))


def _grid(record: Recording) -> FloatArray:
    """Times in s at the sampling rate of a record without signals, up to its last pulse, shape (n,)."""
    last = max(float(one.times[-1]) for one in record.pulses if len(one))
    return np.arange(int(last * record.sampling_rate) + 1) / record.sampling_rate
