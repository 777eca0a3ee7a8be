"""Section of a report on limits, with verdicts, limits over speed and the rules they rest on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from torsionnet.base.equal_remarks import configurations_in_words, grouped_remarks
from torsionnet.base.number_text import aligned_numbers
from torsionnet.base.phrases import phrase
from torsionnet.machinery.verdicts.limit_check import PASS, LimitCheck, LimitVerdict, gravest
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion
from torsionnet.machinery.verdicts.operating_instructions import instruction_table
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
from torsionnet.report.report_data import MOST_CASES, ReportData
from torsionnet.report.report_engines import engine_remarks
from torsionnet.report.report_tables import results_table, table
from torsionnet.report.report_text import as_words, capital, unit

MOST_DRAWN = 8
"""Largest number of limits that a report draws over speed, each in its worst condition."""
MOST_ROWS = 24
"""Largest number of conditions whose conclusion a report shows; the verdict is on all."""


def limits_section(subject: ReportData) -> Section | None:
    """Section of a report on stresses and limits; None for a model without limits."""
    found = subject.limit_conclusion
    if found is None:
        return None
    blocks: list[Block] = [verdict(found), conclusion(found), *_instructions(subject, found), *engine_remarks(subject)]
    names = list(dict.fromkeys(one.limit for check in found.checks for one in check.verdicts))
    blocks += [_verdicts(subject, found, name) for name in names]
    for number, name in enumerate(names[:MOST_DRAWN], 1):
        blocks += _picture(subject, found, name, number)
    blocks += _rules(found)
    return Section("limits", ("Stresses and limits",), tuple(blocks))


def verdict(found: LimitConclusion) -> Paragraph:
    """Paragraph with the verdict on the model's limits, and first of all what was not examined."""
    said = (text for finding in found.findings for text in (" ", capital(as_words(finding)), "."))
    return Paragraph((Strong("Verdict on stresses and limits:"), " ", Strong(found.verdict), ".", *said))


def conclusion(found: LimitConclusion) -> TableBlock:
    """Table with one sentence on the limits for every condition; of many conditions the gravest."""
    columns = (Heading("Configuration"), Heading("Verdict"), Heading("Conclusion", wide=True))
    kept = [one for one in found.checks if one.verdict != PASS] if len(found.checks) > MOST_ROWS else found.checks
    rows = [(check.configuration, check.verdict, as_words(check.finding())) for check in kept[:MOST_ROWS]]
    rest = len(found.checks) - len(rows)
    notes = [phrase("{count} further configurations are in the verdict.", count=rest)] if rest else []
    return table("Conclusion on stresses and limits", columns, rows, notes)


def _instructions(subject: ReportData, found: LimitConclusion) -> list[TableBlock]:
    """Table of operating instructions, where speeds are restricted."""
    instructions = instruction_table(found.checks, subject.conventions)
    return [results_table(instructions, "Operating instructions")] if instructions.rows else []


def _verdicts(subject: ReportData, judged: LimitConclusion, name: str) -> TableBlock:
    """Table of the worst speed of every condition and criterion of one limit, with value and value allowed there.

    Of many conditions the gravest.
    """
    checks = _gravest(judged, name)
    found = [(check, one) for check in checks for one in check.verdicts if one.limit == name]
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
        [as_words(one.criterion) for _, one in found],
        list(aligned_numbers([row[0] for row in worst])),
        list(aligned_numbers([row[1] for row in worst])),
        list(aligned_numbers([row[2] for row in worst])),
        [unit(subject.conventions.unit(one.unit)) for _, one in found],
        [NumberText(row[3], 3) for row in worst],
        [one.verdict for _, one in found],
        [one.restrictions for _, one in found],
    ]
    of = dict.fromkeys(one.of for _, one in found)
    many = phrase(
        "The {count} of {all} configurations in which it is used most.", count=len(checks), all=len(judged.checks)
    )
    notes = [many] if len(checks) < len(judged.checks) else []
    return table(
        phrase("Limit {name}: {elements}", name=as_words(name), elements=", ".join(map(as_words, of))),
        columns,
        list(zip(*cells, strict=True)),
        notes,
    )


def _gravest(found: LimitConclusion, name: str) -> list[LimitCheck]:
    """Checks of the limits in those conditions that the report shows of one limit, in their order."""

    def grave(check: LimitCheck) -> tuple[bool, float]:
        verdicts = [one.verdict for one in check.verdicts if one.limit == name]
        return gravest(verdicts) == PASS, -np.nan_to_num(_most_used(check, name))

    places = sorted(range(len(found.checks)), key=lambda place: (*grave(found.checks[place]), place))[:MOST_CASES]
    return [found.checks[place] for place in sorted(places)]


def _numbers(subject: ReportData, check: LimitCheck, one: LimitVerdict) -> tuple[float | None, ...]:
    """Worst speed in r/min, value and value allowed there, and utilisation in per cent, of a verdict.

    None each where there is none.
    """
    at = one.worst
    if at is None:
        return (None, None, None, None)
    scale = subject.conventions.scale(one.unit)
    sizes = (float(one.values[at]) * scale, float(one.allowed[at]) * scale)
    return (float(check.rpm[at]), *sizes, 100 * float(one.utilisation[at]))


def _picture(subject: ReportData, judged: LimitConclusion, name: str, number: int) -> list[Picture]:
    """Figures of a limit over speed in the condition in which the limit is used most."""
    from torsionnet.plot.limit_plot import limit_check

    use = [_most_used(check, name) for check in judged.checks]
    if not np.isfinite(use).any():
        return []
    check = judged.checks[int(np.nanargmax(use))]
    drawn = limit_check(replace(check, title=""), name, conventions=subject.conventions, title="")
    where = phrase(" in configuration {name}", name=check.configuration) if check.configuration and len(use) > 1 else ""
    caption = (phrase("Limit {name} over speed{where}.", name=as_words(name), where=where),)
    return [Picture(f"limit_{number}", drawn, caption, f"{as_words(name)} over speed with its limits{where}")]


def _most_used(check: LimitCheck, name: str) -> float:
    shares = [
        float(one.utilisation[one.worst]) for one in check.verdicts if one.limit == name and one.worst is not None
    ]
    return max(shares, default=float("nan"))


def _rules(found: LimitConclusion) -> list[Block]:
    """Blocks of the report on the rules that limits rest on.

    Source, formula and what is not covered; and the remarks.
    """
    texts = {text: names for check in found.checks for text, names in check.texts().items()}
    rules = tuple(
        (Strong(", ".join(map(as_words, names))), f": {text.source}. {text.formula}. Not covered: {text.not_covered}.")
        for text, names in texts.items()
    )
    remarks = _remarks(found)
    blocks: list[Block] = [Paragraph(("What the limits rest on:",)), Listing(rules)]
    if remarks:
        blocks += [Paragraph(("Remarks:",)), Listing(tuple((remark,) for remark in remarks))]
    return blocks


def _remarks(found: LimitConclusion) -> list[str]:
    """Texts of the remarks on limits, each once, with its configurations unless they are all."""
    known = list(dict.fromkeys(check.configuration for check in found.checks))
    said = (
        (f"{as_words(one.limit)}, {as_words(one.criterion)}", check.configuration, remark)
        for check in found.checks
        for one in check.verdicts
        for remark in one.remarks
    )
    remarks = []
    for abouts, names, remark in grouped_remarks(said):
        within = (
            phrase(" (in {configurations})", configurations=configurations_in_words(names, known))
            if len(names) < len(known)
            else ""
        )
        remarks.append(f"{'; '.join(abouts)}: {as_words(remark)}{within}")
    return remarks
