"""Section of a report on limits, with verdicts, limits over speed and the rules they rest on."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from torsionnet.base.equal_remarks import grouped_remarks
from torsionnet.base.number_text import aligned_numbers
from torsionnet.base.phrases import joined, phrase
from torsionnet.linear.frequency_response import Channel
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion
from torsionnet.machinery.verdicts.limit_verdict import PASS, LimitVerdict, RuleText, gravest
from torsionnet.machinery.verdicts.operating_instructions import PassedRange, instruction, passed_ranges, refused_ranges
from torsionnet.machinery.verdicts.range_passage import EXCEEDED, KEPT, RangePassage, passage_table
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
from torsionnet.report.report_instructions import instruction_blocks
from torsionnet.report.report_machines import engine_remarks
from torsionnet.report.report_tables import results_table, table, with_kilo_units
from torsionnet.report.report_text import (
    DIGITS,
    as_words,
    capital,
    criterion_words,
    in_clauses,
    limit_scale,
    limit_unit,
    unit,
)

MOST_DRAWN = 8
"""Largest number of limits that a report draws over speed, each in its worst condition."""
MOST_ROWS = 24
"""Largest number of conditions whose conclusion a report shows; the verdict is on all."""


def limits_section(subject: ReportData) -> Section | None:
    """Section of a report on stresses and limits; None for a model without limits."""
    judged = subject.limit_conclusion
    if judged is None:
        return None
    blocks: list[Block] = [
        verdict(judged),
        conclusion(subject, judged),
        *instruction_blocks(subject, judged),
        *engine_remarks(subject),
    ]
    names = list(dict.fromkeys(limit_verdict.limit for check in judged.checks for limit_verdict in check.verdicts))
    blocks += [_verdicts(subject, judged, name) for name in names]
    for number, name in enumerate(names[:MOST_DRAWN], 1):
        blocks += _picture(subject, judged, name, number)
    blocks += _rules(subject, judged)
    return Section("limits", ("Stresses and limits",), tuple(blocks))


def verdict(judged: LimitConclusion) -> Paragraph:
    """Paragraph with the verdict on the model's limits, and first of all what was not examined."""
    said = (text for finding in judged.findings for text in (" ", capital(as_words(finding)), "."))
    return Paragraph((Strong("Verdict on stresses and limits:"), " ", Strong(judged.verdict), ".", *said))


def conclusion(subject: ReportData, judged: LimitConclusion) -> TableBlock:
    """Table with one sentence on the limits for every condition; of many conditions the gravest."""
    columns = (Heading("Configuration"), Heading("Verdict"), Heading("Conclusion", wide=True))
    kept = (
        [check for check in judged.checks if check.verdict != PASS] if len(judged.checks) > MOST_ROWS else judged.checks
    )
    rows = [
        (subject.titles.of(check.configuration), check.verdict, as_words(check.finding())) for check in kept[:MOST_ROWS]
    ]
    rest = len(judged.checks) - len(rows)
    notes = [phrase("{count} further configurations are in the verdict.", count=rest)] if rest else []
    return table("Conclusion on stresses and limits", columns, rows, notes)


def _verdicts(subject: ReportData, judged: LimitConclusion, name: str) -> TableBlock:
    """Table of the worst speed of every condition and criterion of one limit, with value and value allowed there.

    Of many conditions the gravest.
    """
    checks = _gravest(judged, name)
    verdicts = [
        (check, limit_verdict) for check in checks for limit_verdict in check.verdicts if limit_verdict.limit == name
    ]
    columns = (
        Heading("Configuration"),
        Heading("Criterion"),
        Heading("Judged", "rpm"),
        Heading("Speed", "rpm", numeric=True),
        Heading("Value", numeric=True),
        Heading("Allowed", numeric=True),
        Heading("Unit"),
        Heading("Utilisation", "%", numeric=True),
        Heading("Verdict"),
        Heading("To be barred"),
    )
    worst = [_numbers(subject, check, limit_verdict) for check, limit_verdict in verdicts]
    cells: list[list[Cell]] = [
        [subject.titles.of(check.configuration) for check, _ in verdicts],
        [as_words(limit_verdict.criterion) for _, limit_verdict in verdicts],
        [judged_words(limit_verdict) for _, limit_verdict in verdicts],
        list(aligned_numbers([row[0] for row in worst])),
        list(aligned_numbers([row[1] for row in worst])),
        list(aligned_numbers([row[2] for row in worst])),
        [limit_unit(limit_verdict.unit, subject.conventions) for _, limit_verdict in verdicts],
        [NumberText(row[3], 3) for row in worst],
        [limit_verdict.verdict for _, limit_verdict in verdicts],
        [limit_verdict.restrictions or "" for _, limit_verdict in verdicts],
    ]
    of = dict.fromkeys(limit_verdict.of for _, limit_verdict in verdicts)
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


def judged_words(limit_verdict: LimitVerdict) -> str:
    """Text of the speeds in rpm in which a limit was judged, as 675 to 825."""
    ranges = [phrase("{low:.4g} to {high:.4g}", low=low, high=high) for low, high in limit_verdict.judged_rpm]
    return joined(", ", ranges) if ranges else ""


def _gravest(judged: LimitConclusion, name: str) -> list[LimitCheck]:
    """Checks of the limits in those conditions that the report shows of one limit, in their order."""

    def grave(check: LimitCheck) -> tuple[bool, float]:
        verdicts = [limit_verdict.verdict for limit_verdict in check.verdicts if limit_verdict.limit == name]
        # Failed ones first, of these the most used first.
        return gravest(verdicts) == PASS, -np.nan_to_num(_most_used(check, name))

    places = sorted(range(len(judged.checks)), key=lambda place: (*grave(judged.checks[place]), place))[:MOST_CASES]
    return [judged.checks[place] for place in sorted(places)]


def _numbers(subject: ReportData, check: LimitCheck, limit_verdict: LimitVerdict) -> tuple[float | None, ...]:
    """Worst speed in rpm, value and value allowed there, and utilisation in per cent, of a verdict.

    None each where there is none.
    """
    at = limit_verdict.worst
    if at is None:
        return (None, None, None, None)
    scale = limit_scale(limit_verdict.unit, subject.conventions)[0]
    sizes = (float(limit_verdict.values[at]) * scale, float(limit_verdict.allowed[at]) * scale)
    return (float(check.rpm[at]), *sizes, 100 * float(limit_verdict.utilisation[at]))


def _picture(subject: ReportData, judged: LimitConclusion, name: str, number: int) -> list[Picture]:
    """Figures of a limit over speed in the condition in which the limit is used most."""
    from torsionnet.plot.limit_plot import limit_check

    use = [_most_used(check, name) for check in judged.checks]
    if not np.isfinite(use).any():
        return []
    # One picture a limit, in the condition that comes nearest to what is allowed.
    check = judged.checks[int(np.nanargmax(use))]
    drawn = limit_check(replace(check, title=""), name, conventions=subject.conventions, title="")
    title = subject.titles.of(check.configuration) if len(use) > 1 else ""
    where = phrase(" in configuration {name}", name=title) if title else ""
    caption = (phrase("Limit {name} over speed{where}.", name=as_words(name), where=where),)
    return [Picture(f"limit_{number}", drawn, caption, f"{as_words(name)} over speed with its limits{where}")]


def _most_used(check: LimitCheck, name: str) -> float:
    shares = [
        float(limit_verdict.utilisation[limit_verdict.worst])
        for limit_verdict in check.verdicts
        if limit_verdict.limit == name and limit_verdict.worst is not None
    ]
    return max(shares, default=float("nan"))


def _rules(subject: ReportData, judged: LimitConclusion) -> list[Block]:
    """Blocks of the report on the rules that limits rest on.

    Source, formula and what is not covered; and the remarks.
    """
    texts = {text: names for check in judged.checks for text, names in check.texts().items()}
    rules = tuple(
        (Strong(", ".join(map(as_words, names))), f": {text.source}. {text.formula}.", _not_covered(text))
        for text, names in texts.items()
    )
    remarks = _remarks(subject, judged)
    blocks: list[Block] = [Paragraph(("What the limits rest on:",)), Listing(rules)]
    if remarks:
        blocks += [Paragraph(("Remarks:",)), Listing(tuple((remark,) for remark in remarks))]
    return blocks


def _not_covered(text: RuleText) -> str:
    return phrase(" Not covered: {what}.", what=in_clauses(text.not_covered)) if text.not_covered else ""


def _remarks(subject: ReportData, judged: LimitConclusion) -> list[str]:
    """Texts of the remarks on limits, each once, with its configurations unless they are all."""
    known = list(dict.fromkeys(check.configuration for check in judged.checks))
    said = (
        (
            joined(", ", (as_words(limit_verdict.limit), criterion_words(limit_verdict.criterion))),
            check.configuration,
            remark,
        )
        for check in judged.checks
        for limit_verdict in check.verdicts
        for remark in limit_verdict.remarks
    )
    remarks = []
    for abouts, names, remark in grouped_remarks(said):
        within = (
            phrase(" (in {configurations})", configurations=subject.titles.several(names, known))
            if len(names) < len(known)
            else ""
        )
        remarks.append(joined("", ("; ".join(abouts), ": ", as_words(remark), within)))
    return remarks


# Section of a report on passing the barred ranges of speed, slowly and quickly.

QUICK, SLOW = 10.0, 60.0
"""Times in s in which barred ranges are passed in a report unless others are asked for: with power to spare, and with
little, as under a fouled hull. They are examples; no rule that was found names a time."""
NOT_PASSED = "Not to be passed, neither slowly nor quickly:"
NOT_CALCULATED = "Passages not examined, to be passed all the same:"
"""Leads of the lists of ranges in which a limit forbids the passage, and of those whose passage is not calculated."""
BEYOND = (
    "Beyond the range, where it is left, vibration of this passage is above what is allowed in continuous operation: "
    "{limit} has up to {value} {unit} at {speed:.4g} rpm, {steady} in steady operation there."
)
"""Note on vibration that dies away outside of a range after it was passed."""
MOST_RANGES = 4
"""Largest number of barred ranges whose passage a report shows."""
WHAT_IS_COUNTED = (
    "The speed runs evenly through each range, from steady vibration outside of it; the mean is left out. Values are "
    "half ranges within one cycle. A cycle counts as above the value allowed where its largest amplitude is (mean "
    "crossing peak counting, ASTM E1049)."
)
"""Sentences that say what the tables on passages hold."""
ASSUMED_TIMES = (
    " No rule at hand says how long a passage takes: {quick:g} s, with power to spare, and {slow:g} s, with little, "
    "are assumed."
)
ASSUMED_BESIDES = (
    " Besides the times that limits ask for, {quick:g} s, with power to spare, and {slow:g} s, with little, are "
    "assumed."
)
GIVEN_TIMES = " The times of the passages are those of the model."
"""Sentences that say where the times of passages come from."""


def passage_section(subject: ReportData) -> Section | None:
    """Section of a report on passing barred ranges; None for a model without a range to be passed."""
    judged = subject.limit_conclusion
    if judged is None:
        return None
    ranges: list[PassedRange] = []
    # The most used first: the others lie in these, or are only named.
    every = passed_ranges(judged.checks)
    for barred in sorted(every, key=lambda barred: -barred.utilisation):
        if len(ranges) < MOST_RANGES and not any(_covers(other, barred) for other in ranges):
            ranges.append(barred)
    of_ranges = [list(_range(subject, barred, number)) for number, barred in enumerate(ranges, 1)]
    blocks = [block for some in of_ranges for block in some]
    assumed = ASSUMED_TIMES if all(barred.seconds_to_pass is None for barred in ranges) else ASSUMED_BESIDES
    times = GIVEN_TIMES if subject.request.plan.passage else phrase(assumed, quick=QUICK, slow=SLOW)
    lead: list[Block] = [Paragraph((WHAT_IS_COUNTED, times))] if blocks else []
    refused = [_refused(subject, barred) for barred in refused_ranges(judged.checks)[:MOST_ROWS]]
    missing = [_named_range(subject, barred) for barred, some in zip(ranges, of_ranges, strict=True) if not some]
    missing += [_named_range(subject, barred) for barred in every if barred not in ranges]
    if not blocks and not refused and not missing:
        return None
    others = (*_listed(NOT_PASSED, refused), *_listed(NOT_CALCULATED, missing[:MOST_ROWS]))
    return Section("passage", ("Passing the barred ranges",), (*others, *lead, *blocks))


def _listed(lead: str, ranges: Sequence[str]) -> list[Block]:
    """Sentence and list of ranges; empty without any."""
    return [Paragraph((Strong(lead),)), Listing(tuple((words,) for words in ranges))] if ranges else []


def _named_range(subject: ReportData, barred: PassedRange) -> str:
    """Text of a range in a condition, with the limits that bar it, one of several criteria once."""
    limits = ", ".join(dict.fromkeys(as_words(limit_verdict.limit) for limit_verdict in barred.verdicts))
    where = _condition(subject, barred)
    return phrase("{range}{where}: {limits}", range=barred.span, where=where, limits=limits)


def _condition(subject: ReportData, barred: PassedRange) -> str:
    title = subject.titles.of(barred.check.configuration)
    return f", {title}" if title else ""


def _refused(subject: ReportData, refused: PassedRange) -> str:
    """Text of a range that must not be passed in a condition, and of the limit that forbids it."""
    advice = instruction(refused, subject.titles.of)
    scale, shown = limit_scale(advice.unit, subject.conventions)
    # Without a limit of its own for a passage that of continuous operation holds.
    allowed = advice.allowed if math.isnan(advice.allowed_in_passing) else advice.allowed_in_passing
    return phrase(
        "{range}{where}: {limit} has {value} {unit} at {speed:.4g} rpm, {allowed} allowed",
        range=refused.span,
        where=f", {advice.condition}" if refused.check.configuration else "",
        limit=as_words(advice.limits[0]),
        value=NumberText(advice.value * scale, DIGITS),
        allowed=NumberText(allowed * scale, DIGITS),
        unit=unit(shown),
        speed=advice.rpm,
    )


def _covers(barred: PassedRange, other: PassedRange) -> bool:
    """Whether a barred range contains another one."""
    (low, high), (first, last) = barred.span.rpm_outward, other.span.rpm_outward
    return low <= first and last <= high


def _range(subject: ReportData, barred: PassedRange, number: int) -> Iterator[Block]:
    """Blocks of the report on one barred range: what was found, the table of passages, and two of them drawn."""
    from torsionnet.machinery.verdicts.range_passage import range_passages

    check = barred.check
    case = next(case for case in subject.judged_cases if case.configuration == check.configuration)
    asked = barred.seconds_to_pass
    times = sorted({*(subject.request.plan.passage or (QUICK, SLOW)), *((asked,) if asked else ())})
    passages = range_passages(case.drivetrain, barred, times)
    if not passages:
        return
    low, high = barred.span.rpm_outward
    where = _condition(subject, barred)
    yield Paragraph(
        (Strong(phrase("{low} to {high} rpm{where}:", low=low, high=high, where=where)), *_finding(passages, asked))
    )
    shown = with_kilo_units(passage_table(passages, subject.conventions, barred))
    yield results_table(shown, phrase("Passage of {low} to {high} rpm{where}", low=low, high=high, where=where))
    yield _passage_picture(
        subject, _drawn(passages), phrase("{low} to {high} rpm{where}", low=low, high=high, where=where), number
    )
    notes = dict.fromkeys(note for passage in passages for note in passage.response.notes[:-1])
    if notes:
        _, first, *rest = (part for note in notes for part in ("; ", as_words(note)))
        yield Paragraph((capital(first), *rest, "."))
    yield from _sentence_on_vibration_outside(subject, passages)


def _sentence_on_vibration_outside(subject: ReportData, passages: Sequence[RangePassage]) -> Iterator[Paragraph]:
    """Sentence on the largest vibration outside of a range, if any there is above what is allowed when it lasts."""
    left = [(passage, beyond) for passage in passages if (beyond := passage.beyond) is not None]
    if left:
        passage, (rpm, value, steady) = max(left, key=lambda pair: pair[1][1])
        scale, shown = limit_scale(passage.unit, subject.conventions)
        about = {"limit": as_words(passage.named), "speed": rpm, "unit": unit(shown)}
        sizes = {name: NumberText(size * scale, DIGITS) for name, size in (("value", value), ("steady", steady))}
        yield Paragraph((phrase(BEYOND, **about, **sizes),))


def _finding(passages: tuple[RangePassage, ...], asked: float | None) -> tuple[str, ...]:
    """Sentences on the limit in passing, in the time that the limit names if it names one."""
    over = sorted({passage.seconds for passage in passages if passage.outcome == EXCEEDED})
    if asked is not None:
        if asked in over:
            return (phrase(" in the {time:g} s that are asked for, the limit in passing is exceeded.", time=asked),)
        return (phrase(" in the {time:g} s that are asked for, the limit in passing is kept.", time=asked),)
    if over:
        return (
            phrase(
                " the limit in passing is exceeded in {times} s.", times=", ".join(f"{seconds:g}" for seconds in over)
            ),
        )
    return (
        " limits in passing are kept."
        if any(passage.outcome == KEPT for passage in passages)
        else " no limit in passing is given.",
    )


def _drawn(passages: Sequence[RangePassage]) -> list[RangePassage]:
    """Quickest and slowest passage of the worst limit in the direction of the first one, once if they are the same."""
    first = passages[0]
    same = [
        passage for passage in passages if passage.verdict is first.verdict and passage.is_upward == first.is_upward
    ]
    ends = [min(same, key=lambda passage: passage.seconds), max(same, key=lambda passage: passage.seconds)]
    return ends if ends[0] is not ends[1] else ends[:1]


def _passage_picture(subject: ReportData, passages: Sequence[RangePassage], what: str, number: int) -> Picture:
    """Figure of passages over time with the values allowed, the quick one beside the slow one."""
    from torsionnet.plot.histories import passage_response

    verdict = passages[0].verdict
    channel = Channel(as_words(verdict.limit), verdict.unit)
    runs = [replace(passage.response, values=passage.values[:, None], outputs=(channel,)) for passage in passages]
    limits = [
        {verdict.criterion: passage.allowed, passage.criterion_in_passing: passage.allowed_in_passing}
        for passage in passages
    ]
    drawn = passage_response(runs, limits=limits, conventions=subject.conventions, title="")
    seconds = [passage.seconds for passage in passages]
    caption = phrase("Passage of {range} in {time:g} s.", range=what, time=seconds[0])
    if len(seconds) > 1:
        caption = phrase(
            "Passage of {range} in {quick:g} s and in {slow:g} s.", range=what, quick=seconds[0], slow=seconds[1]
        )
    return Picture(f"passage_{number}", drawn, (caption,), caption)
