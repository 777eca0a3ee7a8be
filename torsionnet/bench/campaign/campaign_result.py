"""Result of a campaign: orders and responses of its records beside the calculated ones, repeatability, fit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.packages import NotebookResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.bench.campaign.campaign import Campaign
from torsionnet.bench.campaign.estimating_responses import (
    CampaignResponse,
    ResponseRow,
    ResponseSpread,
    response_lines,
    response_rows,
)
from torsionnet.bench.campaign.tracking_records import RecordFinding
from torsionnet.identification import Fit, Ranking
from torsionnet.identification.ranking import FitRecord, RankedCause, fit_record
from torsionnet.machinery.orders.order_comparison import AGREES, WITHIN_BOUND, compared_orders, order_comparison
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.signals.orders.tracked_orders import MeasuredOrder, TrackedOrders

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
    first, tests = records[0], [one.measured() for one in records]
    found = []
    for place, order in enumerate(first.orders.tolist()):
        alike = [test[place] for test in tests]
        low = max(float(one.speeds[0]) for one in alike)
        high = min(float(one.speeds[-1]) for one in alike)
        speeds = alike[0].speeds[(alike[0].speeds >= low) & (alike[0].speeds <= high)]
        if len(speeds) < FEWEST_COMMON:
            continue
        phased = all(one.values is not None for one in alike)
        curves = np.array(
            [np.interp(speeds, one.speeds, one.values if phased and one.values is not None else one.amplitude)
             for one in alike]
        )  # fmt: skip
        unknown = np.full(len(speeds), np.nan)
        widths = np.array(
            [unknown if one.half_widths is None else np.interp(speeds, one.speeds, one.half_widths) for one in alike]
        )
        # Variance over the records; of complex values half of it belongs to each of the two parts.
        apart = np.abs(curves - curves.mean(axis=0)) ** 2
        parts = 2 if phased else 1
        spread = float(np.sqrt(apart.sum(axis=0).mean() / (len(alike) - 1) / parts))
        # A 95 % interval is 1.96 standard deviations to either side.
        stated = float(np.sqrt(np.mean((widths / 1.96) ** 2)))
        size = float(np.sqrt(np.mean(np.abs(curves) ** 2)))
        found.append(ConditionSpread(first.name, condition, len(alike), order, size, spread, stated, first.unit))
    return tuple(found)


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
class RecordRow:
    """Record of a campaign with its condition, its speeds, and how many of its orders agree with the calculation."""

    name: Annotated[str, Out("record")]
    configuration: Annotated[str, Out("configuration")]
    condition: Annotated[str, Out("condition")]
    lowest: Annotated[float, Out("from", "rpm", digits=5, json="from_rpm")]
    highest: Annotated[float, Out("to", "rpm", digits=5, json="to_rpm")]
    points: Annotated[int, Out("points")]
    compared: Annotated[int, Out("orders compared", json="orders_compared")]
    agreeing: Annotated[int, Out("agree", json="orders_that_agree")]
    reference: Annotated[str, Out("phase 0 at", json="phase_reference")]
    files: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class CampaignRecordResult:
    """Tracked orders and frequency responses of one record, and those that the model has for its channels.

    Attributes
    ----------
    name : str
    files : tuple of path
        File of the tracked orders of each channel.
    orders : tuple of TrackedOrders
    calculated : OrderResponse, optional
        None where no channel shows a sensor of the model.
    response : CampaignResponse, optional
        Measured and calculated frequency responses, of a record that shows them.
    """

    name: str
    files: tuple[Path, ...]
    orders: tuple[TrackedOrders, ...]
    calculated: OrderResponse | None
    response: CampaignResponse | None = None


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

    campaign: Campaign
    records: Mapping[str, CampaignRecordResult]
    spreads: tuple[ConditionSpread, ...] = ()
    fit: Fit | None = None
    ranking: Ranking | None = None
    remarks: tuple[str, ...] = ()
    response_spreads: tuple[ResponseSpread, ...] = ()
    findings: tuple[RecordFinding, ...] = ()

    @property
    def fails(self) -> bool:
        """Whether a fault of a record is beyond the level at which the campaign fails."""
        return any(one.consequence == "fails" for one in self.findings)

    def tests(self, record: str) -> dict[str, tuple[MeasuredOrder, ...]]:
        """Measured orders of a record by the output of its calculated orders."""
        found, sensors = self.records[record], self.campaign.sensors
        known = [] if found.calculated is None else [channel.name for channel in found.calculated.outputs]
        return {sensors[one.name]: one.measured() for one in found.orders if sensors.get(one.name) in known}

    @property
    def verdicts(self) -> tuple[CampaignVerdict, ...]:
        """Verdicts on every order that was measured and calculated."""
        return tuple(self._verdicts())

    def _verdicts(self) -> Iterator[CampaignVerdict]:
        for name, found in self.records.items():
            if found.calculated is None:
                continue
            for output, measured in self.tests(name).items():
                for pair in compared_orders(found.calculated, output, measured):
                    apart = pair.agreement
                    yield CampaignVerdict(
                        name, output, pair.measured.order, apart.peak, apart.intervals, apart.verdict, apart.sentence
                    )

    def comparisons(self, conventions: Conventions = SI) -> Iterator[Table]:
        """Yield a table of measured and calculated orders for each record and output."""
        for name, found in self.records.items():
            if found.calculated is not None:
                for output, measured in self.tests(name).items():
                    table = order_comparison(found.calculated, output, measured, conventions)
                    yield Table(f"{name}: {table.title}", table.columns, table.rows, table.notes)

    @property
    def rows(self) -> tuple[RecordRow, ...]:
        """Rows of the table: for each record its condition, speeds and the number of orders that agree."""
        found, verdicts = [], self.verdicts
        for name, one in self.records.items():
            entry, files = self.campaign.plan.records[name], tuple(map(str, one.files))
            if not one.orders:
                unknown = float("nan")
                found.append(
                    RecordRow(name, entry.configuration, entry.condition, unknown, unknown, 0, 0, 0, "", files)
                )
                continue
            first = one.orders[0]
            own = [each for each in verdicts if each.record == name]
            found.append(RecordRow(
                name, entry.configuration, entry.condition, float(first.rpm.min()), float(first.rpm.max()),
                len(first.times), len(own), sum(each.verdict in GOOD for each in own), first.reference,
                files,
            ))  # fmt: skip
        return tuple(found)

    def table(self) -> Table:
        """Table of the records: condition, speeds, orders, how many of them agree with the calculation."""
        return result_table(self.campaign.title, self.rows, RecordRow, notes=self.remarks)

    @property
    def responses(self) -> Mapping[str, CampaignResponse]:
        """Measured and calculated frequency responses of the records that show them, by record."""
        return {name: one.response for name, one in self.records.items() if one.response is not None}

    @property
    def response_rows(self) -> tuple[ResponseRow, ...]:
        """Rows of the table of responses: how far test and model are apart, for each record and output."""
        return tuple(response_rows(self.responses))

    def response_table(self) -> Table:
        """Table of the frequency responses of each record and output beside those of the model."""
        title = f"{self.campaign.title}: frequency responses of test and model"
        return result_table(
            title, self.response_rows, ResponseRow, notes=() if self.campaign.of_orders else self.remarks
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


# Result of a campaign as plain data, for JSON.


@dataclass(frozen=True, eq=False)
class CampaignJson:
    """Result of a campaign as plain data, as ``torsionnet campaign --json`` prints it."""

    title: str
    records: tuple[RecordRow, ...]
    orders: tuple[CampaignVerdict, ...]
    repeatability: tuple[ConditionSpread, ...]
    fit: Annotated[FitRecord | None, Out(optional=True)]
    ranking: Annotated[tuple[RankedCause, ...] | None, Out(optional=True)]
    notes: tuple[str, ...]
    responses: tuple[ResponseRow, ...] = ()
    response_repeatability: tuple[ResponseSpread, ...] = ()
    checks: tuple[RecordFinding, ...] = ()


def campaign_json(result: CampaignResult) -> CampaignJson:
    """Result of a campaign as plain data for JSON; the orders and responses are in the files that it names."""
    fit = None if result.fit is None else fit_record(result.fit, {}, {}, result.ranking)
    alone = result.ranking.causes if result.ranking is not None and result.fit is None else None
    return CampaignJson(
        result.campaign.title, result.rows, result.verdicts, result.spreads, fit, alone, result.remarks,
        result.response_rows, result.response_spreads, result.findings,
    )  # fmt: skip
