"""Calculation of a campaign, of which only what has changed is worked out again."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from torsionnet.base.errors import Fault, ModelError
from torsionnet.bench.campaign.campaign import Campaign, file_name, kept_path, record_key, write_kept
from torsionnet.bench.campaign.campaign_file import tracked_entries
from torsionnet.bench.campaign.campaign_result import (
    CampaignRecordResult,
    CampaignResult,
    ConditionSpread,
    condition_spread,
)
from torsionnet.bench.campaign.estimating_responses import (
    ResponseSpread,
    campaign_response,
    response_measurements,
    response_spread,
)
from torsionnet.bench.campaign.tracking_records import RecordFinding, campaign_remarks, record_findings, record_orders
from torsionnet.identification import Fit, Measurement, Unknown, identify, rank_causes
from torsionnet.identification.ranking import Ranking
from torsionnet.io.tracked_order_tables import read_tracked_orders, write_tracked_orders
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.signals.orders.tracked_orders import TrackedOrders

TRACKED = ("wheels", "reference", "phase", "channels", "twists", "orders")
"""Sections of a campaign's file from which the orders of a record follow."""
Advance = Callable[[str, int, int], None]
"""Function that is told what is being done, how many records are done, and of how many."""


def run_campaign(
    campaign: Campaign, folder: str | os.PathLike[str] | None = None, *, progress: Advance | None = None
) -> CampaignResult:
    """Result of a campaign: orders and responses of its records beside the calculated ones, repeatability, fit.

    Tracked orders and estimated responses are written into a folder as soon as a record is done; a later run reads
    them where the record and the entries that matter to it are the same.

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
    records, findings, count = {}, list[RecordFinding](), len(campaign.plan.records)
    for done, name in enumerate(campaign.plan.records):
        show(f"record {name}", done, count)
        checked = record_findings(campaign, name, place)
        findings += checked
        if not any(finding.consequence == "left out" for finding in checked):
            records[name] = _record_result(campaign, name, place)
    if not records:
        texts = [finding.remark for finding in findings]
        raise ModelError([Fault(text, ("checks",), kind="missing-data") for text in texts], campaign.file.name)
    show("comparison", count, count)
    remarks = tuple(campaign_remarks({name: outcome.orders for name, outcome in records.items() if outcome.orders}))
    remarks += tuple(finding.remark for finding in findings)
    fit, ranking = _fitted(campaign, records)
    return CampaignResult(
        campaign,
        records,
        _spreads(campaign, records),
        fit,
        ranking,
        remarks,
        _response_spreads(campaign, records),
        tuple(findings),
    )  # fmt: skip


def _record_result(campaign: Campaign, name: str, folder: Path) -> CampaignRecordResult:
    """Orders and responses of a record, as far as it shows them, beside those of the model."""
    files = _tracked(campaign, name, folder) if name in campaign.of_orders else {}
    response = campaign_response(campaign, name, folder) if name in campaign.of_responses else None
    orders, plan, sensors = tuple(files.values()), campaign.plan.records[name], campaign.sensors
    calculated = _calculated(campaign, name, orders)
    known = [] if calculated is None else [channel.name for channel in calculated.outputs]
    tests = {sensors[tracked.name]: tracked.measured() for tracked in orders if sensors.get(tracked.name) in known}
    paths = (*files, *([response.file] if response else []))
    return CampaignRecordResult(name, plan.configuration, plan.condition, paths, orders, calculated, tests, response)


def _tracked(campaign: Campaign, name: str, folder: Path) -> dict[Path, TrackedOrders]:
    """Tracked orders of a record by their files; from the files where record and entries are the same."""
    kept = kept_path(folder, file_name(name), record_key(campaign, name, TRACKED))
    if not kept.is_dir():
        tracked = record_orders(campaign, name)
        write_kept(kept, lambda filling: _write(tracked, filling))
    orders = {file: read_tracked_orders(file)[0] for file in kept.glob("*.csv")}
    order = list(tracked_entries(campaign.plan))
    return dict(sorted(orders.items(), key=lambda pair: order.index(pair[1].name)))


def _write(tracked: tuple[TrackedOrders, ...], folder: Path) -> None:
    for number, orders in enumerate(tracked):
        write_tracked_orders([orders], folder / f"{number + 1}-{file_name(orders.name)}.csv")


def _calculated(campaign: Campaign, name: str, orders: tuple[TrackedOrders, ...]) -> OrderResponse | None:
    sensors = campaign.sensors
    outputs = list(dict.fromkeys(sensors[tracked.name] for tracked in orders if tracked.name in sensors))
    if not outputs:
        return None
    model = campaign.model_of(campaign.plan.records[name])
    measured = np.unique(np.concatenate([tracked.speeds for tracked in orders]))
    # The speeds of the model are refined at resonances; they serve where they include the measured ones.
    run, plan = model.order_response(outputs, refine=True), model.definition.speeds
    inside = plan is not None and run.speeds.min() <= measured.min() and measured.max() <= run.speeds.max()
    return run if inside else model.order_response(outputs, speeds=measured)


def _spreads(campaign: Campaign, records: Mapping[str, CampaignRecordResult]) -> tuple[ConditionSpread, ...]:
    spreads: list[ConditionSpread] = []
    for words, names in _repeated(campaign, records, campaign.of_orders):
        for channels in zip(*(records[name].orders for name in names), strict=True):
            spreads += condition_spread(words, channels)
    return tuple(spreads)


def _response_spreads(campaign: Campaign, records: Mapping[str, CampaignRecordResult]) -> tuple[ResponseSpread, ...]:
    spreads: list[ResponseSpread] = []
    for words, names in _repeated(campaign, records, campaign.of_responses):
        responses = [response.measured for name in names if (response := records[name].response) is not None]
        spreads += response_spread(words, responses)
    return tuple(spreads)


def _repeated(
    campaign: Campaign, records: Mapping[str, CampaignRecordResult], shown: Sequence[str]
) -> Iterator[tuple[str, list[str]]]:
    """Configuration and condition in words, and the records that repeat them."""
    groups: dict[tuple[str, str], list[str]] = {}
    for name in shown:
        if name in records:
            record = campaign.plan.records[name]
            groups.setdefault((record.configuration, record.condition), []).append(name)
    for words, names in groups.items():
        if len(names) > 1:
            yield ", ".join(filter(None, words)), names


def _fitted(campaign: Campaign, records: Mapping[str, CampaignRecordResult]) -> tuple[Fit | None, Ranking | None]:
    plan, sensors = campaign.plan.fit, campaign.sensors
    if plan is None:
        return None, None
    measurements = [
        Measurement(
            orders, name=f"{name}: {orders.name}", output=orders.name, model_output=sensors[orders.name],
            configuration=campaign.plan.records[name].configuration, reference_angle=plan.reference_angle,
        )
        for name, outcome in records.items() for orders in outcome.orders if orders.name in sensors
    ]  # fmt: skip
    for name, outcome in records.items():
        measurements += response_measurements(campaign, name) if outcome.response else ()
    if not plan.parameters:
        return None, rank_causes(campaign.model, measurements)
    unknowns = {
        name: Unknown(unknown.start, unknown.bounds, unknown.prior, unknown.per_configuration) if unknown else Unknown()
        for name, unknown in plan.parameters.items()
    }
    fit = identify(campaign.model, measurements, unknowns)
    return fit, rank_causes(fit) if plan.rank else None
