"""Section of a report on passing the barred ranges of speed, slowly and quickly."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from torsionnet.base.equal_remarks import condition_words
from torsionnet.base.phrases import phrase
from torsionnet.linear.frequency_response import Channel
from torsionnet.machinery.verdicts.operating_instructions import PassedRange, passed_ranges
from torsionnet.machinery.verdicts.range_passage import EXCEEDED, KEPT, RangePassage, passage_table
from torsionnet.report.document_tree import Block, Paragraph, Picture, Section, Strong
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import results_table
from torsionnet.report.report_text import as_words, capital

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
    ranges: list[PassedRange] = []
    # The most used first: what is passed there is passed in the other conditions, too.
    for one in sorted(passed_ranges(found.checks), key=lambda one: -one.utilisation):
        if not any(_covers(other, one) for other in ranges):
            ranges.append(one)
    blocks = [block for number, one in enumerate(ranges[:MOST_RANGES], 1) for block in _range(subject, one, number)]
    if not blocks:
        return None
    return Section("passage", ("Passing the barred ranges",), (Paragraph((WHAT_IS_COUNTED,)), *blocks))


def _covers(one: PassedRange, other: PassedRange) -> bool:
    """Whether a barred range contains another one."""
    (low, high), (first, last) = one.span.rpm_outward, other.span.rpm_outward
    return low <= first and last <= high


def _range(subject: ReportData, barred: PassedRange, number: int) -> Iterator[Block]:
    """Blocks of the report on one barred range: what was found, the table of passages, and two of them drawn."""
    from torsionnet.machinery.verdicts.ranges_passed import range_passages

    check = barred.check
    case = next(one for one in subject.judged_cases if one.configuration == check.configuration)
    asked = barred.seconds_to_pass
    times = sorted({*(subject.request.plan.passage or (QUICK, SLOW)), *((asked,) if asked else ())})
    passages = range_passages(case.drivetrain, barred, times)
    if not passages:
        return
    low, high = barred.span.rpm_outward
    where = f", {condition_words(check.configuration)}" if check.configuration else ""
    yield Paragraph(
        (Strong(phrase("{low} to {high} rpm{where}:", low=low, high=high, where=where)), *_finding(passages, asked))
    )
    shown = passage_table(passages, subject.conventions)
    yield results_table(shown, phrase("Passage of {low} to {high} rpm{where}", low=low, high=high, where=where))
    yield _passage_picture(subject, _drawn(passages), f"{low} to {high} rpm{where}", number)
    notes = dict.fromkeys(note for one in passages for note in one.response.notes[:-1])
    if notes:
        yield Paragraph((f"{capital('; '.join(as_words(note) for note in notes))}.",))


def _finding(passages: tuple[RangePassage, ...], asked: float | None) -> tuple[str, ...]:
    """Sentences on the limit in passing, in the time that the limit names if it names one."""
    over = sorted({one.seconds for one in passages if one.row.verdict == EXCEEDED})
    if asked is not None:
        if asked in over:
            return (phrase(" in the {time:g} s that are asked for, the limit in passing is exceeded.", time=asked),)
        return (phrase(" in the {time:g} s that are asked for, the limit in passing is kept.", time=asked),)
    if over:
        return (phrase(" the limit in passing is exceeded in {times} s.", times=", ".join(f"{one:g}" for one in over)),)
    return (
        " limits in passing are kept."
        if any(one.row.verdict == KEPT for one in passages)
        else " no limit in passing is given.",
    )


def _drawn(passages: Sequence[RangePassage]) -> list[RangePassage]:
    """Quickest and slowest passage of the worst limit in the direction of the first one, once if they are the same."""
    first = passages[0]
    same = [one for one in passages if one.verdict is first.verdict and one.is_upward == first.is_upward]
    ends = [min(same, key=lambda one: one.seconds), max(same, key=lambda one: one.seconds)]
    return ends if ends[0] is not ends[1] else ends[:1]


def _passage_picture(subject: ReportData, passages: Sequence[RangePassage], what: str, number: int) -> Picture:
    """Figure of passages over time with the values allowed, the quick one beside the slow one."""
    from torsionnet.plot.passage_plot import passage_response

    verdict = passages[0].verdict
    channel = Channel(as_words(verdict.limit), verdict.unit)
    runs = [replace(one.response, values=one.values[:, None], outputs=(channel,)) for one in passages]
    limits = [{verdict.criterion: one.allowed, one.criterion_in_passing: one.allowed_in_passing} for one in passages]
    drawn = passage_response(runs, limits=limits, conventions=subject.conventions, title="")
    seconds = [one.seconds for one in passages]
    caption = phrase("Passage of {range} in {time:g} s.", range=what, time=seconds[0])
    if len(seconds) > 1:
        caption = phrase(
            "Passage of {range} in {quick:g} s and in {slow:g} s.", range=what, quick=seconds[0], slow=seconds[1]
        )
    return Picture(f"passage_{number}", drawn, (caption,), caption)
