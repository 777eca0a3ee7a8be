"""Result of a campaign as plain data, for JSON."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from torsionnet.base.result_rows import Out
from torsionnet.bench.campaign.campaign_result import CampaignResult, CampaignVerdict, RecordRow
from torsionnet.bench.campaign.condition_spread import ConditionSpread
from torsionnet.bench.campaign.record_findings import RecordFinding
from torsionnet.bench.campaign.response_rows import ResponseRow, ResponseSpread
from torsionnet.identification.fit_record import FitRecord, fit_record
from torsionnet.identification.ranking import RankedCause


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
