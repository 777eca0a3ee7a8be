"""Section of a report on passing the barred ranges of speed, slowly and quickly."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from torsionnet.report.document_tree import Block, Paragraph, Picture, Section, Strong
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import results_table
from torsionnet.report.report_text import as_words, capital
from torsionnet.response.equal_remarks import condition_words
from torsionnet.response.frequency_response import Channel
from torsionnet.response.limits.operating_instructions import PassedRange, passed_ranges
from torsionnet.response.limits.range_passage import EXCEEDED, KEPT, RangePassage, passage_table

QUICK, SLOW = 10.0, 60.0
"""Times in s in which barred ranges are passed in a report unless others are asked for: with power to spare, and with
little, as under a fouled hull. They are examples; no rule that was found names a time."""
MOST_RANGES = 4
"""Largest number of barred ranges whose passage a report shows."""
WHAT_IS_COUNTED = (
    "The speed runs evenly through each range, from steady vibration outside of it; the mean is left out. Values are "
    "half ranges within one cycle. A cycle counts as above the value allowed where its largest amplitude is (mean "
    "crossing peak counting, ASTM E1049)."
)
"""Sentences that say what the tables on passages hold."""


def passage_section(subject: ReportData) -> Section | None:
    """Section of a report on passing barred ranges; None for a model without a range to be passed."""
    found = subject.limit_conclusion
    if found is None:
        return None
    normal, out = (passed_ranges([one for one in found.checks if one.misfiring == out]) for out in (False, True))
    ranges = [*normal, *(one for one in out if not any(_covers(other, one) for other in normal))]
    blocks = [block for number, one in enumerate(ranges[:MOST_RANGES], 1) for block in _range(subject, one, number)]
    if not blocks:
        return None
    return Section("passage", ("Passing the barred ranges",), (Paragraph((WHAT_IS_COUNTED,)), *blocks))


def _covers(one: PassedRange, other: PassedRange) -> bool:
    """Whether a barred range contains another one, whose limits are used no more than its own."""
    holds = (
        one.span.rpm_outward[0] <= other.span.rpm_outward[0] and other.span.rpm_outward[1] <= one.span.rpm_outward[1]
    )
    return holds and other.utilisation <= one.utilisation


def _range(subject: ReportData, barred: PassedRange, number: int) -> Iterator[Block]:
    """Blocks of the report on one barred range: what was found, the table of passages, and the slowest one drawn."""
    from torsionnet.solve.running.range_passage import range_passages

    check, _ = barred.worst
    case = next(one for one in subject.judged_cases if one.configuration == check.configuration)
    asked = barred.seconds_to_pass
    times = sorted({*(subject.request.plan.passage or (QUICK, SLOW)), *((asked,) if asked else ())})
    passages = range_passages(case.drivetrain, barred, times)
    if not passages:
        return
    low, high = barred.span.rpm_outward
    where = f", {condition_words(check.configuration)}" if check.configuration else ""
    yield Paragraph((Strong(f"{low} to {high} rpm{where}:"), *_finding(passages, asked)))
    shown = passage_table(passages, subject.conventions)
    yield results_table(shown, f"Passage of {low} to {high} rpm{where}")
    slowest = max(passages, key=lambda one: one.seconds)  # the first of these is that of the worst limit
    yield _picture(subject, slowest, f"{low} to {high} rpm{where}", number)
    notes = dict.fromkeys(note for one in passages for note in one.response.notes[:-1])
    if notes:
        yield Paragraph((f"{capital('; '.join(as_words(note) for note in notes))}.",))


def _finding(passages: tuple[RangePassage, ...], asked: float | None) -> tuple[str, ...]:
    """Sentences on the limit in passing, in the time that the limit names if it names one."""
    over = sorted({one.seconds for one in passages if one.row.verdict == EXCEEDED})
    if asked is not None:
        if asked in over:
            return (f" in the {asked:g} s that are asked for, the limit in passing is exceeded.",)
        return (f" in the {asked:g} s that are asked for, the limit in passing is kept.",)
    if over:
        return (f" the limit in passing is exceeded in {', '.join(f'{one:g}' for one in over)} s.",)
    return (
        " limits in passing are kept."
        if any(one.row.verdict == KEPT for one in passages)
        else " no limit in passing is given.",
    )


def _picture(subject: ReportData, passage: RangePassage, what: str, number: int) -> Picture:
    """Figure of a passage over time with the values allowed."""
    from torsionnet.plot.passage_response import passage_response

    run, verdict = passage.response, passage.verdict
    single = replace(run, values=passage.values[:, None], outputs=(Channel(as_words(verdict.limit), verdict.unit),))
    lines = {verdict.criterion: passage.allowed, passage.criterion_in_passing: passage.allowed_in_passing}
    drawn = passage_response(single, limits=lines, conventions=subject.conventions, title="")
    caption = (f"Passage of {what} in {passage.seconds:g} s.",)
    return Picture(f"passage_{number}", drawn, caption, f"Passage of {what} in {passage.seconds:g} s.")
