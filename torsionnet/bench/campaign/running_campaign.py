"""Calculation of a campaign, of which only what has changed is worked out again, and its result."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import Fault, ModelError
from torsionnet.base.packages import NotebookResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.bench.campaign.campaign import Campaign, file_name, kept_path, record_key, write_kept
from torsionnet.bench.campaign.campaign_file import tracked_entries
from torsionnet.bench.campaign.estimating_responses import (
    CampaignResponse,
    ComparedResponse,
    ResponseSpread,
    campaign_response,
    response_lines,
    response_measurements,
    response_rows,
    response_spread,
)
from torsionnet.bench.campaign.tracking_records import RecordFinding, campaign_remarks, record_findings, record_orders
from torsionnet.identification import Fit, Measurement, Unknown, identify, rank_causes
from torsionnet.identification.ranking import FitAnswer, RankedCause, Ranking
from torsionnet.io.tracked_order_tables import read_tracked_orders, write_tracked_orders
from torsionnet.machinery.orders.order_comparison import AGREES, WITHIN_BOUND, compared_orders, order_comparison
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.signals.orders.tracked_orders import MeasuredOrder, TrackedOrders

# Result of a campaign: orders and responses of its records beside the calculated ones, repeatability, fit.

# Spread of the orders of records that repeat one condition, beside the intervals that each of them states.

FEWEST_COMMON = 2
"""Fewest speeds that two records must share to be compared."""


@dataclass(frozen=True, eq=False)
class ConditionSpread:
    """Repeatability of one order of a channel over the records of one condition, in SI units of the channel."""

    channel: Annotated[str, Out("channel")]
    condition: Annotated[str, Out("condition")]
    records: Annotated[int, Out("records")]
    order: Annotated[float, Out("order")]
    amplitude: Annotated[float, Out("RMS amplitude", digits=4)]
    spread: Annotated[float, Out("standard deviation between records", digits=4)]
    stated: Annotated[float, Out("standard deviation stated", digits=4)]
    unit: Annotated[str, Out("unit")]

    @property
    def ratio(self) -> Annotated[float, Out("ratio", digits=3)]:
        """Standard deviation between records over that which the intervals state; about 1 where these tell all."""
        return self.spread / self.stated if self.stated else float("nan")


def condition_spread(condition: str, records: Sequence[TrackedOrders]) -> tuple[ConditionSpread, ...]:
    """Repeatability of each order of one channel over two records or more of a condition.

    The records are compared at the speeds of the first, between those of the others linearly, where all of them have
    been; complex values where all phases have a reference, else amplitudes.
    """
    first, tests = records[0], [record.measured() for record in records]
    spreads = []
    for place, order in enumerate(first.orders.tolist()):
        alike = [test[place] for test in tests]
        low = max(float(curve.speeds[0]) for curve in alike)
        high = min(float(curve.speeds[-1]) for curve in alike)
        speeds = alike[0].speeds[(alike[0].speeds >= low) & (alike[0].speeds <= high)]
        if len(speeds) < FEWEST_COMMON:
            continue
        phased = all(curve.values is not None for curve in alike)
        curves = np.array(
            [np.interp(speeds, curve.speeds, curve.values if phased and curve.values is not None else curve.amplitude)
             for curve in alike]
        )  # fmt: skip
        unknown = np.full(len(speeds), np.nan)
        widths = np.array(
            [
                unknown if curve.half_widths is None else np.interp(speeds, curve.speeds, curve.half_widths)
                for curve in alike
            ]
        )
        # Variance over the records; of complex values half of it belongs to each of the two parts.
        apart = np.abs(curves - curves.mean(axis=0)) ** 2
        parts = 2 if phased else 1
        spread = float(np.sqrt(apart.sum(axis=0).mean() / (len(alike) - 1) / parts))
        # A 95 % interval is 1.96 standard deviations to either side.
        stated = float(np.sqrt(np.mean((widths / 1.96) ** 2)))
        size = float(np.sqrt(np.mean(np.abs(curves) ** 2)))
        spreads.append(ConditionSpread(first.name, condition, len(alike), order, size, spread, stated, first.unit))
    return tuple(spreads)


GOOD = (AGREES, WITHIN_BOUND)
"""Verdicts on orders that count as agreement."""


@dataclass(frozen=True, eq=False)
class CampaignVerdict:
    """Verdict on one order of a record beside the calculation."""

    record: Annotated[str, Out("record")]
    output: Annotated[str, Out("output")]
    order: Annotated[float, Out("order")]
    difference: Annotated[float, Out("difference of peaks", "%", digits=4, json="difference_of_peaks_percent")]
    intervals: Annotated[float | None, Out("in half widths", digits=4, json="half_widths")]
    verdict: Annotated[str, Out("verdict")]
    explanation: Annotated[str, Out("explanation")]


@dataclass(frozen=True, eq=False)
class CampaignRecordResult:
    """Tracked orders and frequency responses of one record, and those that the model has for its channels.

    Attributes
    ----------
    name, configuration, condition : str
    files : tuple of path
        File of the tracked orders of each channel, and of the responses.
    orders : tuple of TrackedOrders
    calculated : OrderResponse, optional
        None where no channel shows a sensor of the model.
    tests : mapping of str to tuple of MeasuredOrder
        Measured orders by the output of the calculated ones.
    response : CampaignResponse, optional
        Measured and calculated frequency responses, of a record that shows them.
    """

    SHOWN: ClassVar = (
        "name", "configuration", "condition", "lowest", "highest", "points", "compared", "agreeing", "reference",
        "file_names",
    )  # fmt: skip

    name: Annotated[str, Out("record")]
    configuration: Annotated[str, Out("configuration")]
    condition: Annotated[str, Out("condition")]
    files: tuple[Path, ...]
    orders: tuple[TrackedOrders, ...]
    calculated: OrderResponse | None
    tests: Mapping[str, tuple[MeasuredOrder, ...]]
    response: CampaignResponse | None = None

    @property
    def lowest(self) -> Annotated[float, Out("from", "rpm", digits=5, json="from_rpm")]:
        """Lowest speed of the tracked orders in r/min."""
        return float(self.orders[0].rpm.min()) if self.orders else float("nan")

    @property
    def highest(self) -> Annotated[float, Out("to", "rpm", digits=5, json="to_rpm")]:
        """Highest speed of the tracked orders in r/min."""
        return float(self.orders[0].rpm.max()) if self.orders else float("nan")

    @property
    def points(self) -> Annotated[int, Out("points")]:
        """Number of speeds of the tracked orders."""
        return len(self.orders[0].times) if self.orders else 0

    @property
    def compared(self) -> Annotated[int, Out("orders compared", json="orders_compared")]:
        """Number of orders that were measured and calculated."""
        return len(self.verdicts)

    @property
    def agreeing(self) -> Annotated[int, Out("agree", json="orders_that_agree")]:
        """Number of orders that agree with the calculation."""
        return sum(verdict.verdict in GOOD for verdict in self.verdicts)

    @property
    def reference(self) -> Annotated[str, Out("phase 0 at", json="phase_reference")]:
        """Place in words at which phases of the tracked orders are 0."""
        return self.orders[0].reference if self.orders else ""

    @property
    def file_names(self) -> Annotated[tuple[str, ...], Out(json="files")]:
        """Paths of the files as text."""
        return tuple(map(str, self.files))

    @cached_property
    def verdicts(self) -> tuple[CampaignVerdict, ...]:
        """Verdicts on every order of the record that was measured and calculated."""
        verdicts = []
        for output, measured in self.tests.items():
            for pair in compared_orders(not_none(self.calculated), output, measured):
                apart = pair.agreement
                verdicts.append(
                    CampaignVerdict(
                        self.name, output, pair.measured.order, apart.peak, apart.intervals, apart.verdict,
                        apart.sentence,
                    )
                )  # fmt: skip
        return tuple(verdicts)


@dataclass(frozen=True, eq=False, repr=False)
class CampaignResult(NotebookResult):
    """Result of a campaign: orders and responses of its records beside the calculated ones, repeatability and fit.

    Attributes
    ----------
    campaign : Campaign
    records : mapping of str to CampaignRecordResult
    spreads : tuple of ConditionSpread
        Repeatability of each condition with several records.
    fit : Fit, optional
    ranking : Ranking, optional
    remarks : tuple of str
        Repairs of pulses, and what the comparison leaves out.
    response_spreads : tuple of ResponseSpread
        Repeatability of the frequency responses.
    findings : tuple of RecordFinding
        Faults that the checks of the records found.
    """

    SHOWN: ClassVar = (
        "campaign.title", "all_records", "verdicts", "spreads", "fit_answer", "causes", "remarks", "response_rows",
        "response_spreads", "findings",
    )  # fmt: skip

    campaign: Campaign
    records: Mapping[str, CampaignRecordResult]
    spreads: Annotated[tuple[ConditionSpread, ...], Out(json="repeatability")] = ()
    fit: Fit | None = None
    ranking: Ranking | None = None
    remarks: Annotated[tuple[str, ...], Out(json="notes")] = ()
    response_spreads: Annotated[tuple[ResponseSpread, ...], Out(json="response_repeatability")] = ()
    findings: Annotated[tuple[RecordFinding, ...], Out(json="checks")] = ()

    @property
    def fails(self) -> bool:
        """Whether a fault of a record is beyond the level at which the campaign fails."""
        return any(finding.consequence == "fails" for finding in self.findings)

    @property
    def verdicts(self) -> Annotated[tuple[CampaignVerdict, ...], Out(json="orders")]:
        """Verdicts on every order that was measured and calculated."""
        return tuple(verdict for record in self.records.values() for verdict in record.verdicts)

    @property
    def fit_answer(self) -> Annotated[FitAnswer | None, Out(json="fit", optional=True)]:
        """Fit with the ranking of causes."""
        return None if self.fit is None else FitAnswer(self.fit, self.ranking)

    @property
    def causes(self) -> Annotated[tuple[RankedCause, ...] | None, Out(json="ranking", optional=True)]:
        """Ranked causes of a misfit where nothing was fitted."""
        return self.ranking.causes if self.ranking is not None and self.fit is None else None

    def comparisons(self, conventions: Conventions = SI) -> Iterator[Table]:
        """Yield a table of measured and calculated orders for each record and output."""
        for name, outcome in self.records.items():
            if outcome.calculated is not None:
                for output, measured in outcome.tests.items():
                    table = order_comparison(outcome.calculated, output, measured, conventions)
                    yield Table(f"{name}: {table.title}", table.columns, table.rows, table.notes)

    @property
    def all_records(self) -> Annotated[tuple[CampaignRecordResult, ...], Out(json="records")]:
        """Results of the records, in the order of the campaign."""
        return tuple(self.records.values())

    def table(self) -> Table:
        """Table of the records: condition, speeds, orders, how many of them agree with the calculation."""
        return result_table(self.campaign.title, self.all_records, CampaignRecordResult, notes=self.remarks)

    @property
    def responses(self) -> Mapping[str, CampaignResponse]:
        """Measured and calculated frequency responses of the records that show them, by record."""
        return {name: record.response for name, record in self.records.items() if record.response is not None}

    @property
    def response_rows(self) -> Annotated[tuple[ComparedResponse, ...], Out(json="responses")]:
        """Rows of the table of responses: how far test and model are apart, for each record and output."""
        return tuple(response_rows(self.responses))

    def response_table(self) -> Table:
        """Table of the frequency responses of each record and output beside those of the model."""
        title = f"{self.campaign.title}: frequency responses of test and model"
        return result_table(
            title, self.response_rows, ComparedResponse, notes=() if self.campaign.of_orders else self.remarks
        )

    def response_lines(self, conventions: Conventions = SI) -> Table:
        """Table of test, model and coherence at each frequency in Hz, for each record and output."""
        return response_lines(self.responses, conventions)

    def response_repeatability(self) -> Table:
        """Table of the spread of responses between records of one condition, beside what their coherence states."""
        title = f"{self.campaign.title}: repeatability of frequency responses"
        return result_table(title, self.response_spreads, ResponseSpread)

    def verdict_table(self) -> Table:
        """Table of the verdicts on every order of every record."""
        return result_table(f"{self.campaign.title}: test and model", self.verdicts, CampaignVerdict)

    def repeatability(self) -> Table:
        """Table of the spread between records of one condition, beside what their intervals state."""
        return result_table(f"{self.campaign.title}: repeatability", self.spreads, ConditionSpread)


# Calculation of a campaign, of which only what has changed is worked out again.

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
