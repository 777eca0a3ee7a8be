"""Calculation of a campaign, of which only what has changed is worked out again."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from torsionnet.campaign.campaign import Campaign
from torsionnet.campaign.campaign_remarks import campaign_remarks
from torsionnet.campaign.campaign_result import CampaignRecordResult, CampaignResult
from torsionnet.campaign.condition_spread import ConditionSpread, condition_spread
from torsionnet.campaign.tracking_records import record_orders
from torsionnet.core.errors import UsageError
from torsionnet.core.version import __version__
from torsionnet.identification import Fit, Measurement, Ranking, Unknown, identify, rank_causes
from torsionnet.io.tracked_order_tables import read_tracked_orders, write_tracked_orders
from torsionnet.model.campaign.campaign_file import tracked_entries
from torsionnet.response.measured.tracked_orders import TrackedOrders
from torsionnet.response.order_response import OrderResponse

HASHED_BYTES = 2**20
"""Bytes of a record that are hashed together, which limits the memory."""
KEY_LENGTH = 16
"""Digits of a key, enough to tell all versions of a record apart."""

Advance = Callable[[str, int, int], None]
"""Function that is told what is being done, how many records are done, and of how many."""


def run_campaign(
    campaign: Campaign, folder: str | os.PathLike[str] | None = None, *, progress: Advance | None = None
) -> CampaignResult:
    """Result of a campaign: orders of its records beside the calculated ones, repeatability, fit.

    Tracked orders are written into a folder as soon as a record is done; a later run reads them where record, wheels,
    channels and orders are the same.

    Parameters
    ----------
    campaign : Campaign
    folder : path, optional
        By default beside the file of the campaign, under its name with the ending ``.orders``.
    progress : callable, optional
        Called with what is done, the number of records done and the number of all.

    Raises
    ------
    ModelError
        A record lacks a channel, or its pulses do not fit their wheel.
    """
    place = Path(folder) if folder is not None else campaign.folder / f"{campaign.file.stem}.orders"
    show = progress or (lambda *_: None)
    records, count = {}, len(campaign.plan.records)
    for done, name in enumerate(campaign.plan.records):
        show(f"record {name}", done, count)
        files = _tracked(campaign, name, place)
        orders = tuple(files.values())
        records[name] = CampaignRecordResult(name, tuple(files), orders, _calculated(campaign, name, orders))
    show("comparison", count, count)
    tracked = {name: found.orders for name, found in records.items()}
    spreads, remarks = _spreads(campaign, tracked), tuple(campaign_remarks(tracked))
    fit, ranking = _fitted(campaign, records)
    return CampaignResult(campaign, records, spreads, fit, ranking, remarks)


def _tracked(campaign: Campaign, name: str, folder: Path) -> dict[Path, TrackedOrders]:
    """Tracked orders of a record by their files; from the files where record and entries are the same."""
    kept = folder / f"{_file_name(name)}-{_key(campaign, name)}"
    if not kept.is_dir():
        found = record_orders(campaign, name)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            _write(found, kept)
        except OSError as error:
            raise UsageError(f"{folder} cannot be a folder of tracked orders: {error.strerror}") from None
        for old in folder.glob(f"{_file_name(name)}-{'[0-9a-f]' * KEY_LENGTH}"):
            if old != kept:
                shutil.rmtree(old, ignore_errors=True)
    orders = {file: read_tracked_orders(file)[0] for file in kept.glob("*.csv")}
    order = list(tracked_entries(campaign.plan))
    return dict(sorted(orders.items(), key=lambda pair: order.index(pair[1].name)))


def _write(found: tuple[TrackedOrders, ...], folder: Path) -> None:
    """Write the orders of each channel into a folder of its own name only when all are there."""
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=".writing-") as begun:
        filling = Path(begun) / folder.name
        filling.mkdir()
        for number, one in enumerate(found):
            write_tracked_orders([one], filling / f"{number + 1}-{_file_name(one.name)}.csv")
        filling.rename(folder)


def _file_name(name: str) -> str:
    """Name of a record or channel without characters that a name of a file cannot have."""
    return re.sub(r"[^\w.+-]", "_", name)


def _key(campaign: Campaign, name: str) -> str:
    """Key of what the orders of a record follow from: the bytes of its file, entries, pitch patterns, version."""
    plan = replace(campaign.plan, fit=None).written_entries()
    one = campaign.plan.records[name]
    asked = {key: plan.get(key) for key in ("wheels", "reference", "phase", "channels", "twists", "orders")}
    asked |= {"start": one.start, "stop": one.stop, "version": __version__, "title": campaign.title}
    digest = hashlib.sha256(json.dumps(asked, sort_keys=True, default=str).encode())
    for pattern in campaign.patterns.values():
        digest.update(pattern.positions.tobytes())
    with campaign.file_of(one).open("rb") as stream:
        while block := stream.read(HASHED_BYTES):
            digest.update(block)
    return digest.hexdigest()[:KEY_LENGTH]


def _calculated(campaign: Campaign, name: str, orders: tuple[TrackedOrders, ...]) -> OrderResponse | None:
    sensors = campaign.sensors
    outputs = list(dict.fromkeys(sensors[one.name] for one in orders if one.name in sensors))
    if not outputs:
        return None
    model = campaign.model_of(campaign.plan.records[name])
    measured = np.unique(np.concatenate([one.speeds for one in orders]))
    run, plan = model.order_response(outputs, refine=True), model.definition.speeds
    inside = plan is not None and run.speeds.min() <= measured.min() and measured.max() <= run.speeds.max()
    return run if inside else model.order_response(outputs, speeds=measured)


def _spreads(campaign: Campaign, orders: dict[str, tuple[TrackedOrders, ...]]) -> tuple[ConditionSpread, ...]:
    groups: dict[tuple[str, str], list[str]] = {}
    for name, record in campaign.plan.records.items():
        groups.setdefault((record.configuration, record.condition), []).append(name)
    found: list[ConditionSpread] = []
    for (configuration, condition), names in groups.items():
        if len(names) > 1:
            words = ", ".join(text for text in (configuration, condition) if text)
            for channels in zip(*(orders[name] for name in names), strict=True):
                found += condition_spread(words, channels)
    return tuple(found)


def _fitted(campaign: Campaign, records: dict[str, CampaignRecordResult]) -> tuple[Fit | None, Ranking | None]:
    plan, sensors = campaign.plan.fit, campaign.sensors
    if plan is None:
        return None, None
    measurements = [
        Measurement(
            one, name=f"{name}: {one.name}", output=one.name, model_output=sensors[one.name],
            configuration=campaign.plan.records[name].configuration, reference_angle=plan.reference_angle,
        )
        for name, found in records.items() for one in found.orders if one.name in sensors
    ]  # fmt: skip
    if not plan.parameters:
        return None, rank_causes(campaign.model, measurements)
    unknowns = {
        name: Unknown(one.start, one.bounds, one.prior, one.per_configuration) if one else Unknown()
        for name, one in plan.parameters.items()
    }
    fit = identify(campaign.model, measurements, unknowns)
    return fit, rank_causes(fit) if plan.rank else None
