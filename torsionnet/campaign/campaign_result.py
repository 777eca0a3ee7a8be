"""Result of a campaign: complex orders of its records beside the calculated ones, repeatability, fit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from torsionnet.campaign.campaign import Campaign
from torsionnet.campaign.condition_spread import ConditionSpread
from torsionnet.core.notebook import NotebookResult
from torsionnet.core.result_rows import Out
from torsionnet.identification import Fit, Ranking
from torsionnet.response.conventions import SI, Conventions
from torsionnet.response.measured.order_agreement import AGREES, WITHIN_BOUND
from torsionnet.response.measured.tracked_orders import TrackedOrders
from torsionnet.response.order_comparison import MeasuredOrder, compared_orders, order_comparison
from torsionnet.response.order_response import OrderResponse
from torsionnet.response.table import Table, result_table

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
    """Tracked orders of one record, and the calculated orders of the sensors that its channels show.

    Attributes
    ----------
    name : str
    files : tuple of path
        File of the tracked orders of each channel.
    orders : tuple of TrackedOrders
    calculated : OrderResponse, optional
        None where no channel shows a sensor of the model.
    """

    name: str
    files: tuple[Path, ...]
    orders: tuple[TrackedOrders, ...]
    calculated: OrderResponse | None


@dataclass(frozen=True, eq=False, repr=False)
class CampaignResult(NotebookResult):
    """Result of a campaign: orders of its records beside the calculated ones, repeatability and fit.

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
    """

    campaign: Campaign
    records: Mapping[str, CampaignRecordResult]
    spreads: tuple[ConditionSpread, ...] = ()
    fit: Fit | None = None
    ranking: Ranking | None = None
    remarks: tuple[str, ...] = ()

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
            entry, first = self.campaign.plan.records[name], one.orders[0]
            own = [each for each in verdicts if each.record == name]
            found.append(RecordRow(
                name, entry.configuration, entry.condition, float(first.rpm.min()), float(first.rpm.max()),
                len(first.times), len(own), sum(each.verdict in GOOD for each in own), first.reference,
                tuple(map(str, one.files)),
            ))  # fmt: skip
        return tuple(found)

    def table(self) -> Table:
        """Table of the records: condition, speeds, orders, how many of them agree with the calculation."""
        return result_table(self.campaign.title, self.rows, RecordRow, notes=self.remarks)

    def verdict_table(self) -> Table:
        """Table of the verdicts on every order of every record."""
        return result_table(f"{self.campaign.title}: test and model", self.verdicts, CampaignVerdict)

    def repeatability(self) -> Table:
        """Table of the spread between records of one condition, beside what their intervals state."""
        return result_table(f"{self.campaign.title}: repeatability", self.spreads, ConditionSpread)
