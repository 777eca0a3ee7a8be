"""Checks of the records of a campaign: clipped samples, drop-outs and pulses that are missing or too many."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np

from torsionnet.base.atomic import write_text
from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.base.result_rows import Out
from torsionnet.bench.campaign.campaign import Campaign
from torsionnet.bench.campaign.campaign_checks import CampaignChecks
from torsionnet.bench.campaign.kept_files import file_name, kept_path, record_key, write_kept
from torsionnet.bench.campaign.tracking_records import record_rotations
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.large_records import record_or_blocks
from torsionnet.signals.sensor_resolution import step_of
from torsionnet.signals.standstill import frozen_stretches
from torsionnet.signals.value_faults import flat_tops

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
        found = json.dumps(list(_counted(campaign, name)))
        write_kept(kept, lambda filling: write_text(filling / FILE, found))
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
        raise ModelError([Fault(f"record {name}: {error}", ("records", name))], campaign.file.name) from None
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
    one = campaign.plan.records[name]
    of_names = {key: channels[key] for key in names if key in channels}
    record = record_or_blocks(campaign.file_of(one), names=names, **one.arguments(of_names))
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
