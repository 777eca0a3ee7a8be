"""Complex orders of a record of a campaign, from its pulses and channels."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np

from torsionnet.base.atomic import write_text
from torsionnet.base.entries.spec import not_none
from torsionnet.base.equal_remarks import grouped_remarks
from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.base.notes import Note, NoteOrText, about_channel
from torsionnet.base.result_rows import Out
from torsionnet.bench.campaign.campaign import Campaign, file_name, kept_path, record_key, write_kept
from torsionnet.bench.campaign.campaign_file import (
    METHODS,
    CampaignChannel,
    CampaignChecks,
    CampaignOrders,
    CampaignRecord,
    tracked_entries,
)
from torsionnet.io.wheel_files import read_turning_record
from torsionnet.signals.calculus import with_gain
from torsionnet.signals.orders.cycle_average import CycleAverage
from torsionnet.signals.orders.mean_rotation import mean_rotation
from torsionnet.signals.orders.track_orders import PhaseMark, orders_of_test
from torsionnet.signals.orders.tracked_orders import TrackedOrders
from torsionnet.signals.orders.tracked_signals import Twist
from torsionnet.signals.orders.vold_kalman import VoldKalman
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.recording_files import record_or_blocks
from torsionnet.signals.resampling import Recordings
from torsionnet.signals.rotation.counter import PulseReading
from torsionnet.signals.rotation.rotations_of_wheels import rotations_of_wheels
from torsionnet.signals.rotation.wheel_channel import counted_reading, wheel_pulses
from torsionnet.signals.rotation.wheel_rotation import WheelRotation
from torsionnet.signals.uncertainty import step_of
from torsionnet.signals.value_faults import flat_tops, frozen_stretches


def record_orders(campaign: Campaign, name: str) -> tuple[TrackedOrders, ...]:
    """Complex orders of every channel, wheel and twist of a record of a campaign, with 95 % intervals, in SI.

    Raises
    ------
    ModelError
        The record lacks a channel, or its pulses do not fit their wheel.
    """
    plan, entry = campaign.plan, campaign.plan.records[name]
    try:
        wheels, mark = _pulses(campaign, entry)
        mean = mean_rotation(wheels[campaign.reference], cycle=not_none(plan.orders).cycle)
        tracked_by_name: dict[str, TrackedOrders] = {}
        for (asked, delay), names in _by_orders_and_delay(campaign).items():
            channels = {key: plan.channels[key] for key in names if plan.channels and key in plan.channels}
            turning = [key for key in names if key in wheels]
            twists = {key: plan.twists[key] for key in names if plan.twists and key in plan.twists}
            tracked = orders_of_test(
                _signals(campaign.file_of(entry), channels, delay, entry) if channels else None,
                wheels,
                mean,
                orders=asked,
                channels=list(channels),
                wheels=turning,
                twists=[Twist(each.first, each.second, each.stiffness or 0.0) for each in twists.values()],
                mark=mark,
                method=_method(not_none(plan.orders)),
            )
            tracked_by_name |= zip([*channels, *turning, *twists], tracked, strict=True)
    except UsageError as error:
        raise ModelError(
            [Fault(f"record {name}: {error}", ("records", name), kind=error.kind)], campaign.file.name
        ) from None
    except ModelError as error:
        faults = [replace(fault, message=f"record {name}: {fault.message}") for fault in error.faults]
        raise ModelError(faults, entry.file) from None
    return tuple(
        replace(tracked_by_name[key], name=key, title=f"{campaign.title}: {name}")
        for key in tracked_entries(campaign.plan)
    )


def record_rotations(campaign: Campaign, name: str) -> dict[str, WheelRotation]:
    """Rotations of the wheels of a record of a campaign, by name."""
    return _pulses(campaign, campaign.plan.records[name])[0]


def _by_orders_and_delay(campaign: Campaign) -> dict[tuple[tuple[float, ...], float], list[str]]:
    """Names of wheels, channels and twists by the orders that are tracked of them and by how late they come, in s."""
    names: dict[tuple[tuple[float, ...], float], list[str]] = {}
    for name, entry in tracked_entries(campaign.plan).items():
        delay = entry.delay if isinstance(entry, CampaignChannel) else 0.0
        names.setdefault((entry.orders or not_none(campaign.plan.orders).tracked, delay), []).append(name)
    return names


def _pulses(campaign: Campaign, entry: CampaignRecord) -> tuple[dict[str, WheelRotation], PhaseMark]:
    """Rotations of the wheels of a record by name, and the mark of the phases."""
    plan, phase = campaign.plan, campaign.plan.phase
    names = {"index": phase.index, "cam": phase.cam} if phase is not None else {}
    marks = {name: _reading(campaign, name) for name in names.values() if name}
    whole = read_turning_record(campaign.file_of(entry), plan.wheels, marks, **entry.arguments({}))
    record = whole.between(entry.start, entry.stop)
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


def _signals(path: Path, channels: Mapping[str, CampaignChannel], delay: float, entry: CampaignRecord) -> Recordings:
    """Channels of a record that come late by the same time in s, calibrated, in SI; a large file in blocks."""
    record = record_or_blocks(
        path,
        names=list(channels),
        **entry.arguments(channels),
    )
    if isinstance(record, Recording):
        return _calibrated(record, channels, delay).between(entry.start, entry.stop)
    return _blocks_between(record, channels, delay, entry)


def _blocks_between(
    blocks: Iterable[Recording], channels: Mapping[str, CampaignChannel], delay: float, entry: CampaignRecord
) -> Iterator[Recording]:
    for block in blocks:
        kept = _calibrated(block, channels, delay).between(entry.start, entry.stop)
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


# Checks of the records of a campaign: clipped samples, drop-outs and pulses that are missing or too many.

CHECKED = ("wheels", "channels", "responses", "checks")
"""Sections of a campaign's file from which the checks of a record follow."""
FILE = "checks.json"
"""Name of the file that keeps what the checks of a record find."""


@dataclass(frozen=True, eq=False)
class RecordFinding:
    """Fault that a check found in a channel of a record, with the share of samples or pulses and what follows."""

    record: Annotated[str, Out("record")]
    channel: Annotated[str, Out("channel")]
    check: Annotated[str, Out("check")]
    count: Annotated[int, Out("count")]
    share: Annotated[float, Out("share", "%", digits=3, factor=100, json="share")]
    consequence: Annotated[str, Out("consequence")]

    @property
    def remark(self) -> str:
        """Sentence on the finding for the remarks of a campaign."""
        fault = f"{self.check.replace('_', '-')} in {self.count} samples"
        what = f"{self.count} pulses missing or too many" if self.check == "pulses" else fault
        follows = {"left out": "; the record is left out", "fails": "; this is beyond what checks: allows"}
        return f"{self.record}: {self.channel}: {what}, {100 * self.share:.3g} %{follows.get(self.consequence, '')}"


def record_findings(campaign: Campaign, name: str, folder: Path) -> tuple[RecordFinding, ...]:
    """Faults of a record that its checks find; from the file where record and entries are the same.

    Raises
    ------
    ModelError
        The record lacks a channel.
    """
    kept = kept_path(folder, f"{file_name(name)}~checks", record_key(campaign, name, CHECKED))
    if not kept.is_dir():
        listing = json.dumps(list(_counted(campaign, name)))
        write_kept(kept, lambda filling: write_text(filling / FILE, listing))
    levels, listed = campaign.plan.checks or CampaignChecks(), []
    for channel, check, count, of in json.loads((kept / FILE).read_text(encoding="utf-8")):
        level, share = getattr(levels, check), count / of
        listed.append(RecordFinding(name, channel, check, count, share, level.consequence(share) if level else ""))
    return tuple(listed)


def _counted(campaign: Campaign, name: str) -> Iterator[tuple[str, str, int, int]]:
    """Yield channel, check, number of faulty samples or pulses and number of all, where there are faulty ones."""
    try:
        yield from _of_samples(campaign, name)
        if campaign.plan.checks is not None and campaign.plan.checks.pulses is not None and name in campaign.of_orders:
            for wheel, rotation in record_rotations(campaign, name).items():
                if rotation.repairs:
                    yield wheel, "pulses", rotation.repairs, len(rotation.times)
    except UsageError as error:
        raise ModelError(
            [Fault(f"record {name}: {error}", ("records", name), kind=error.kind)], campaign.file.name
        ) from None
    except ModelError as error:
        faults = [replace(fault, message=f"record {name}: {fault.message}") for fault in error.faults]
        raise ModelError(faults, campaign.plan.records[name].file) from None


def _of_samples(campaign: Campaign, name: str) -> Iterator[tuple[str, str, int, int]]:
    channels, asked = campaign.plan.channels or {}, campaign.plan.responses
    names = list(channels) if name in campaign.of_orders else []
    if asked is not None and name in campaign.of_responses:
        names = list(dict.fromkeys([*names, *asked.outputs, asked.input]))
    if not names:
        return
    entry = campaign.plan.records[name]
    of_names = {key: channels[key] for key in names if key in channels}
    record = record_or_blocks(campaign.file_of(entry), names=names, **entry.arguments(of_names))
    counts = {(key, check): 0 for key in names for check in ("clipping", "drop_outs")}
    samples = 0
    for block in [record] if isinstance(record, Recording) else record:
        samples += len(block)
        for signal in block:
            counts[signal.name, "clipping"] += sum(last - first + 1 for first, last in flat_tops(signal.values))
            counts[signal.name, "drop_outs"] += _dropped(block, signal.name)
    for (key, check), count in counts.items():
        if count:
            yield key, check, count, samples


def _dropped(block: Recording, name: str) -> int:
    """Number of samples of a channel that have no number, or in which it stands still while it moves around them."""
    values = block[name].values
    finite = np.isfinite(values)
    if not finite.all():
        return int(np.count_nonzero(~finite))
    still = frozen_stretches(values, block.sampling_rate, step_of(values))
    return sum(last - first + 1 for first, last in still)


# Remarks on the tracked orders of a campaign, each said once with the records and channels that it concerns.


def campaign_remarks(records: Mapping[str, Sequence[TrackedOrders]]) -> Iterator[str]:
    """Yield the remarks on the orders of records, with the names of records and channels unless they concern all.

    Parameters
    ----------
    records : mapping of str to sequence of TrackedOrders
        Orders of each channel, by the name of the record.

    Examples
    --------
    >>> import numpy as np
    >>> def orders(name, *notes):
    ...     return TrackedOrders(name, "angle", [1], [0], [100], np.ones((1, 1)), np.ones((1, 1)), notes=notes)
    >>> first = [orders("fly", "averaged", Note("1 pulse missing", channel="fly")), orders("torque", "averaged")]
    >>> list(campaign_remarks({"900 rpm": first, "950 rpm": [orders("fly", "averaged"), orders("torque", "averaged")]}))
    ['averaged', '900 rpm: fly: 1 pulse missing']
    """
    said = [
        (tracked.name, record, _within(note, tracked.name))
        for record, orders in records.items()
        for tracked in orders
        for note in tracked.notes
    ]
    every = {tracked.name for orders in records.values() for tracked in orders}
    for channels, names, note in grouped_remarks(said):
        where = [", ".join(names)] if len(names) < len(records) else []
        where += [", ".join(channels)] if set(channels) != every else []
        yield ": ".join([*where, note])


def _within(note: NoteOrText, channel: str) -> str:
    """Text of a note that stands behind the name of a channel."""
    is_own = isinstance(note, Note) and note.channel == channel
    return str(about_channel(note, "") if is_own else note)
