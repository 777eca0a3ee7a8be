"""Complex orders of a record of a campaign, from its pulses and channels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from torsionnet.campaign.campaign import Campaign
from torsionnet.core.errors import Fault, ModelError, UsageError
from torsionnet.io.recording_files import read_recording
from torsionnet.model.campaign.campaign_file import METHODS, CampaignOrders, CampaignRecord, tracked_entries
from torsionnet.response.measured.tracked_orders import TrackedOrders
from torsionnet.response.recording import FloatArray, Recording
from torsionnet.signals.orders.cycle_average import CycleAverage
from torsionnet.signals.orders.mean_rotation import MeanRotation, mean_rotation
from torsionnet.signals.orders.phase_reference import PhaseReference, phase_reference
from torsionnet.signals.orders.track_orders import track_orders
from torsionnet.signals.orders.tracked_signals import Twist
from torsionnet.signals.orders.vold_kalman import VoldKalman
from torsionnet.signals.rotation.pulse_reading import PulseReading
from torsionnet.signals.rotation.wheel_channel import counted_reading, wheel_pulses
from torsionnet.signals.rotation.wheel_rotation import WheelRotation, wheel_rotation


def record_orders(campaign: Campaign, name: str) -> tuple[TrackedOrders, ...]:
    """Complex orders of every channel, wheel and twist of a record of a campaign, with 95 % intervals, in SI.

    Raises
    ------
    ModelError
        The record lacks a channel, or its pulses do not fit their wheel.
    """
    plan, one = campaign.plan, campaign.plan.records[name]
    try:
        record = _between(_recording(campaign, one), one.start, one.stop)
        wheels = {wheel: _rotation(campaign, record, wheel) for wheel in plan.wheels}
        mean = mean_rotation(wheels[campaign.reference], cycle=plan.orders.cycle)
        reference = _phase(campaign, record, wheels[campaign.reference], mean)
        signals = _calibrated(record, campaign) if plan.channels else None
        found: dict[str, TrackedOrders] = {}
        for asked, names in _by_orders(campaign).items():
            channels = [one for one in names if one in (plan.channels or {})]
            turning = [one for one in names if one in wheels]
            twists = {one: plan.twists[one] for one in names if plan.twists and one in plan.twists}
            tracked = track_orders(
                signals if channels else None, mean, channels, [wheels[one] for one in turning],
                [(Twist(one.first, one.second, one.stiffness or 0.0), wheels[one.first], wheels[one.second])
                 for one in twists.values()],
                orders=asked, method=_method(plan.orders), reference=reference,
            )  # fmt: skip
            found |= zip([*channels, *turning, *twists], tracked, strict=True)
    except UsageError as error:
        raise ModelError([Fault(f"record {name}: {error}", ("records", name))], campaign.file.name) from None
    except ModelError as error:
        faults = [replace(fault, message=f"record {name}: {fault.message}") for fault in error.faults]
        raise ModelError(faults, one.file) from None
    return tuple(
        replace(found[key], name=key, title=f"{campaign.title}: {name}") for key in tracked_entries(campaign.plan)
    )


def _by_orders(campaign: Campaign) -> dict[tuple[float, ...], list[str]]:
    """Names of wheels, channels and twists by the orders that are tracked of them."""
    found: dict[tuple[float, ...], list[str]] = {}
    for name, one in tracked_entries(campaign.plan).items():
        found.setdefault(one.orders or campaign.plan.orders.tracked, []).append(name)
    return found


def _recording(campaign: Campaign, one: CampaignRecord) -> Recording:
    """Recording of the channels of a campaign, and of its pulses, in SI."""
    plan = campaign.plan
    readings: dict[str, PulseReading] = {
        name: counted_reading(wheel) for name, wheel in plan.wheels.items() if not wheel.is_of_a_signal
    }
    sampled = [name for name, wheel in plan.wheels.items() if wheel.is_of_a_signal]
    sampled += [wheel.second for wheel in plan.wheels.values() if wheel.second]
    indices = {wheel.index for wheel in plan.wheels.values()}
    if plan.phase is not None:
        indices |= {plan.phase.index, plan.phase.cam}
    readings |= {name: PulseReading() for name in sorted(indices - {""}) if name not in readings}
    channels = plan.channels or {}
    return read_recording(
        campaign.file_of(one),
        names=list(dict.fromkeys([*readings, *sampled, *channels])),
        quantities={name: channel.quantity for name, channel in channels.items() if channel.quantity},
        units={name: channel.unit for name, channel in channels.items() if channel.unit},
        pulse_readings=readings,
    )


def _between(record: Recording, start: float | None, stop: float | None) -> Recording:
    """Recording between two times in s."""
    if start is None and stop is None:
        return record
    first, last = -np.inf if start is None else start, np.inf if stop is None else stop

    def kept(times: FloatArray) -> FloatArray:
        return np.asarray((times >= first) & (times <= last))

    inside = kept(record.time)
    times = record.time[inside]
    return replace(
        record,
        signals=tuple(replace(one, values=one.values[inside]) for one in record),
        start=float(times[0]) if len(times) else record.start,
        times=None if record.times is None else times,
        pulses=tuple(replace(one, times=one.times[kept(one.times)]) for one in record.pulses),
    ).with_notes(f"cut to {first:g} to {last:g} s")


def _calibrated(record: Recording, campaign: Campaign) -> Recording:
    """Recording with gains applied, and delays of channels removed by samples between the recorded ones."""
    from scipy.interpolate import CubicSpline

    signals = []
    for name, channel in (campaign.plan.channels or {}).items():
        signal = record[name]
        values, notes = channel.gain * signal.values, list(signal.notes)
        if channel.gain != 1:
            notes.append(f"multiplied by {channel.gain:g}")
        if channel.delay:
            # Beyond the last sample nothing is known: its value goes on for the time of the delay.
            early = CubicSpline(record.time, values)(np.minimum(record.time + channel.delay, record.time[-1]))
            values = np.asarray(early, dtype=np.float64)
            notes.append(f"shifted {1e3 * channel.delay:g} ms to earlier times")
        signals.append(replace(signal, values=values, notes=tuple(notes)))
    return replace(record, signals=tuple(signals))


def _rotation(campaign: Campaign, record: Recording, name: str) -> WheelRotation:
    wheel = campaign.plan.wheels[name]
    index = record.pulses_of(wheel.index) if wheel.index else None
    return wheel_rotation(wheel_pulses(record, name, wheel), wheel, campaign.patterns.get(name), index=index)


def _method(orders: CampaignOrders) -> CycleAverage | VoldKalman:
    if orders.method == METHODS[1]:
        return orders.bandwidth or VoldKalman()
    return CycleAverage(cycles=orders.cycles or CycleAverage().cycles, step=orders.step or 0.0)


def _phase(campaign: Campaign, record: Recording, wheel: WheelRotation, mean: MeanRotation) -> PhaseReference:
    phase = campaign.plan.phase
    if phase is None:
        return phase_reference(mean, wheel)
    marks: Mapping[str, str] = {"index": phase.index, "cam": phase.cam}
    pulses = {key: record.pulses_of(name) for key, name in marks.items() if name}
    return phase_reference(
        mean, wheel, index=pulses.get("index"), cam=pulses.get("cam"), offset=phase.tdc or 0.0,
        place="" if phase.tdc is None else f"top dead centre of cylinder {phase.cylinder}",
        wheel_has_mark=not phase.cam or campaign.plan.wheels[campaign.reference].missing_teeth > 0,
    )  # fmt: skip
