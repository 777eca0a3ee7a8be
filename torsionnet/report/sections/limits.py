"""What the parts bear: the conclusion, verdicts in all conditions, limits over speed, the rules they rest on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from torsionnet.core.number_text import aligned
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Heading,
    Listing,
    NumberText,
    Paragraph,
    Picture,
    Section,
    Strong,
    TableBlock,
)
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_words import plain, unit
from torsionnet.response.limit_check import LimitCheck, LimitVerdict

MOST_DRAWN = 8
"""Limits drawn over speed, each in its worst condition."""


def limits_section(subject: ReportData) -> Section | None:
    if not subject.limit_checks:
        return None
    blocks: list[Block] = [conclusion(subject)]
    names = list(dict.fromkeys(one.limit for check in subject.limit_checks for one in check.verdicts))
    blocks += [_verdicts(subject, name) for name in names]
    for number, name in enumerate(names[:MOST_DRAWN], 1):
        blocks += _picture(subject, name, number)
    blocks += _rules(subject)
    return Section("limits", ("Stresses and limits",), tuple(blocks))


def conclusion(subject: ReportData) -> TableBlock:
    """One sentence for every condition."""
    columns = (Heading("Configuration"), Heading("Verdict"), Heading("Conclusion", wide=True))
    rows = [(check.configuration, check.verdict, plain(check.conclusion)) for check in subject.limit_checks]
    return table("Conclusion on stresses and limits", columns, rows)


def _verdicts(subject: ReportData, name: str) -> TableBlock:
    """The worst speed of every condition and criterion of one limit."""
    found = [(check, one) for check in subject.limit_checks for one in check.verdicts if one.limit == name]
    columns = (
        Heading("Configuration"),
        Heading("Criterion"),
        Heading("Speed", "r/min", numeric=True),
        Heading("Value", numeric=True),
        Heading("Allowed", numeric=True),
        Heading("Unit"),
        Heading("Utilisation", "%", numeric=True),
        Heading("Verdict"),
        Heading("To be barred"),
    )
    worst = [_numbers(subject, check, one) for check, one in found]
    cells: list[list[Cell]] = [
        [check.configuration for check, _ in found],
        [plain(one.criterion) for _, one in found],
        list(aligned([row[0] for row in worst])),
        list(aligned([row[1] for row in worst])),
        list(aligned([row[2] for row in worst])),
        [unit(subject.conventions.unit(one.unit)) for _, one in found],
        [NumberText(row[3], 3) for row in worst],
        [one.verdict for _, one in found],
        [", ".join(map(str, one.barred)) for _, one in found],
    ]
    of = dict.fromkeys(one.of for _, one in found)
    return table(f"Limit {plain(name)}: {', '.join(map(plain, of))}", columns, list(zip(*cells, strict=True)))


def _numbers(subject: ReportData, check: LimitCheck, one: LimitVerdict) -> tuple[float | None, ...]:
    """Worst speed in r/min, value and value allowed there, utilisation in per cent."""
    at = one.worst
    if at is None:
        return (None, None, None, None)
    scale = subject.conventions.scale(one.unit)
    sizes = (float(one.values[at]) * scale, float(one.allowed[at]) * scale)
    return (float(check.rpm[at]), *sizes, 100 * float(one.utilisation[at]))


def _picture(subject: ReportData, name: str, number: int) -> list[Picture]:
    """The limit in the condition in which it is used most."""
    from torsionnet.plot.limit_check import limit_check

    use = [_most_used(check, name) for check in subject.limit_checks]
    if not np.isfinite(use).any():
        return []
    check = subject.limit_checks[int(np.nanargmax(use))]
    drawn = limit_check(replace(check, title=""), name, conventions=subject.conventions, title="")
    where = f" in configuration {check.configuration}" if check.configuration and len(use) > 1 else ""
    caption = (f"Limit {plain(name)} over speed{where}.",)
    return [Picture(f"limit_{number}", drawn, caption, f"{plain(name)} over speed with its limits{where}")]


def _most_used(check: LimitCheck, name: str) -> float:
    shares = [
        float(one.utilisation[one.worst]) for one in check.verdicts if one.limit == name and one.worst is not None
    ]
    return max(shares, default=float("nan"))


def _rules(subject: ReportData) -> list[Block]:
    """Source, formula and what is not covered, once for all limits that rest on it; and remarks."""
    texts = {text: names for check in subject.limit_checks for text, names in check.texts().items()}
    rules = tuple(
        (Strong(", ".join(map(plain, names))), f": {text.source}. {text.formula}. Not covered: {text.not_covered}.")
        for text, names in texts.items()
    )
    remarks = dict.fromkeys(
        f"{plain(one.limit)}, {plain(one.criterion)}: {plain(remark)}"
        for check in subject.limit_checks
        for one in check.verdicts
        for remark in one.remarks
    )
    blocks: list[Block] = [Paragraph(("What the limits rest on:",)), Listing(rules)]
    if remarks:
        blocks += [Paragraph(("Remarks:",)), Listing(tuple((remark,) for remark in remarks))]
    return blocks
