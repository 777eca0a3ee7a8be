"""Complex orders of a record of a campaign, from its pulses and channels."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.bench.campaign.campaign import Campaign
from torsionnet.bench.campaign.campaign_file import (
    METHODS,
    CampaignChannel,
    CampaignOrders,
    CampaignRecord,
    tracked_entries,
)
from torsionnet.io.turning_records import read_turning_record
from torsionnet.signals.channel_corrections import with_gain
from torsionnet.signals.orders.cycle_average import CycleAverage
from torsionnet.signals.orders.mean_rotation import mean_rotation
from torsionnet.signals.orders.orders_of_test import PhaseMark, orders_of_test
from torsionnet.signals.orders.tracked_orders import TrackedOrders
from torsionnet.signals.orders.tracked_signals import Twist
from torsionnet.signals.orders.vold_kalman import VoldKalman
from torsionnet.signals.record_blocks import Recordings
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.large_records import record_or_blocks
from torsionnet.signals.rotation.pulse_reading import PulseReading
from torsionnet.signals.rotation.rotations_of_wheels import rotations_of_wheels
from torsionnet.signals.rotation.wheel_channel import counted_reading, wheel_pulses
from torsionnet.signals.rotation.wheel_rotation import WheelRotation


def record_orders(campaign: Campaign, name: str) -> tuple[TrackedOrders, ...]:
    """Complex orders of every channel, wheel and twist of a record of a campaign, with 95 % intervals, in SI.

    Raises
    ------
    ModelError
        The record lacks a channel, or its pulses do not fit their wheel.
    """
    plan, one = campaign.plan, campaign.plan.records[name]
    try:
        wheels, mark = _pulses(campaign, one)
        mean = mean_rotation(wheels[campaign.reference], cycle=not_none(plan.orders).cycle)
        found: dict[str, TrackedOrders] = {}
        for (asked, delay), names in _by_orders_and_delay(campaign).items():
            channels = {key: plan.channels[key] for key in names if plan.channels and key in plan.channels}
            turning = [key for key in names if key in wheels]
            twists = {key: plan.twists[key] for key in names if plan.twists and key in plan.twists}
            tracked = orders_of_test(
                _signals(campaign.file_of(one), channels, delay, one) if channels else None,
                wheels,
                mean,
                orders=asked,
                channels=list(channels),
                wheels=turning,
                twists=[Twist(each.first, each.second, each.stiffness or 0.0) for each in twists.values()],
                mark=mark,
                method=_method(not_none(plan.orders)),
            )
            found |= zip([*channels, *turning, *twists], tracked, strict=True)
    except UsageError as error:
        raise ModelError([Fault(f"record {name}: {error}", ("records", name))], campaign.file.name) from None
    except ModelError as error:
        faults = [replace(fault, message=f"record {name}: {fault.message}") for fault in error.faults]
        raise ModelError(faults, one.file) from None
    return tuple(
        replace(found[key], name=key, title=f"{campaign.title}: {name}") for key in tracked_entries(campaign.plan)
    )


def record_rotations(campaign: Campaign, name: str) -> dict[str, WheelRotation]:
    """Rotations of the wheels of a record of a campaign, by name."""
    return _pulses(campaign, campaign.plan.records[name])[0]


def _by_orders_and_delay(campaign: Campaign) -> dict[tuple[tuple[float, ...], float], list[str]]:
    """Names of wheels, channels and twists by the orders that are tracked of them and by how late they come, in s."""
    found: dict[tuple[tuple[float, ...], float], list[str]] = {}
    for name, one in tracked_entries(campaign.plan).items():
        delay = one.delay if isinstance(one, CampaignChannel) else 0.0
        found.setdefault((one.orders or not_none(campaign.plan.orders).tracked, delay), []).append(name)
    return found


def _pulses(campaign: Campaign, one: CampaignRecord) -> tuple[dict[str, WheelRotation], PhaseMark]:
    """Rotations of the wheels of a record by name, and the mark of the phases."""
    plan, phase = campaign.plan, campaign.plan.phase
    names = {"index": phase.index, "cam": phase.cam} if phase is not None else {}
    marks = {name: _reading(campaign, name) for name in names.values() if name}
    found = read_turning_record(campaign.file_of(one), plan.wheels, marks, **one.arguments({}))
    record = found.between(one.start, one.stop)
    rotations = rotations_of_wheels(record, plan.wheels, campaign.patterns, marks=marks)
    if phase is None:
        return rotations, PhaseMark()
    pulses = {key: wheel_pulses(record, name, marks[name]) for key, name in names.items() if name}
    place = "" if phase.tdc is None else f"top dead centre of cylinder {phase.cylinder}"
    of_wheel = not phase.cam or plan.wheels[campaign.reference].shows_tooth_0
    return rotations, PhaseMark(pulses.get("index"), pulses.get("cam"), phase.tdc or 0.0, place, of_wheel)


def _reading(campaign: Campaign, name: str) -> PulseReading:
    """Reading of the pulses of a mark: of the wheel that it is or whose index it is, else of the reference wheel."""
    wheels = campaign.plan.wheels
    if name in wheels:
        return wheels[name]
    of_index = {wheel.index: wheel for wheel in wheels.values()}
    return counted_reading(of_index.get(name, wheels[campaign.reference]))


def _signals(path: Path, channels: Mapping[str, CampaignChannel], delay: float, one: CampaignRecord) -> Recordings:
    """Channels of a record that come late by the same time in s, calibrated, in SI; a large file in blocks."""
    record = record_or_blocks(
        path,
        names=list(channels),
        **one.arguments(channels),
    )
    if isinstance(record, Recording):
        return _calibrated(record, channels, delay).between(one.start, one.stop)
    return _blocks_between(record, channels, delay, one)


def _blocks_between(
    blocks: Iterable[Recording], channels: Mapping[str, CampaignChannel], delay: float, one: CampaignRecord
) -> Iterator[Recording]:
    for block in blocks:
        kept = _calibrated(block, channels, delay).between(one.start, one.stop)
        if len(kept):
            yield kept


def _calibrated(record: Recording, channels: Mapping[str, CampaignChannel], delay: float) -> Recording:
    """Recording with gains applied, and shifted to earlier times by a delay in s."""
    signals = []
    for name, channel in channels.items():
        signal = with_gain(record[name], channel.gain)
        note = f"shifted {1e3 * delay:g} ms to earlier times"
        signals.append(replace(signal, notes=(*signal.notes, *([note] if delay else []))))
    times = None if record.times is None else record.times - delay
    return replace(record, signals=tuple(signals), start=record.start - delay, times=times)


def _method(orders: CampaignOrders) -> CycleAverage | VoldKalman:
    if orders.method == METHODS[1]:
        return orders.bandwidth or VoldKalman()
    return CycleAverage(cycles=orders.cycles or CycleAverage().cycles, step=orders.step or 0.0)
