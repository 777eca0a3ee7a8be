"""Section of a report with the verdict on every component, the operating instructions, and what is not covered."""

from __future__ import annotations

from collections.abc import Iterator

from torsionnet.base.equal_remarks import condition_words
from torsionnet.base.number_text import aligned_numbers
from torsionnet.base.phrases import phrase
from torsionnet.machinery.verdicts.governing_peaks import line_name, little_damped
from torsionnet.machinery.verdicts.limit_check import STARTS, listed_names
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion, WorstLimit
from torsionnet.machinery.verdicts.operating_instructions import instruction_table
from torsionnet.model.elements import Shaft
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Heading,
    Listing,
    NumberText,
    Paragraph,
    Section,
    Strong,
    TableBlock,
    Text,
)
from torsionnet.report.engineering_units import engineering_unit
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import results_table, table
from torsionnet.report.report_text import as_words, capital, unit

NO_LIMITS = (
    "No limits are given, so nothing is judged: what the components bear stands in the entry limits: of the model file."
)
"""Sentence of a calculation without limits in place of a verdict."""

LITTLE_DAMPED = (
    "{name}, {share:.3g} % of the limit: at {speed:.4g} rpm {order} is in resonance with mode {mode}, whose calculated "
    "damping ratio is only {damping:.1g} %. The value depends on this damping; a measurement is advised."
)
"""Sentence on a governing value that stands at a resonance with little damping."""


def conclusion_section(subject: ReportData) -> Section:
    """Section of a report with verdict, worst condition of every limit, operating instructions and what is open."""
    found = subject.limit_conclusion
    blocks: list[Block] = [Paragraph((NO_LIMITS,))] if found is None else [*_judged(subject, found)]
    return Section("conclusion", ("Conclusion and operating instructions",), tuple(blocks))


def _judged(subject: ReportData, found: LimitConclusion) -> Iterator[Block]:
    yield Paragraph((Strong("Verdict:"), " ", Strong(found.verdict), "; ", Strong(STARTS)))
    findings = [capital(as_words(finding)) for finding in found.findings]
    yield Listing(tuple((text,) for text in [*findings, *_by_small_damping(subject, found)]))
    yield _components(subject, found)
    instructions = instruction_table(found.checks, subject.conventions)
    if instructions.rows:
        yield results_table(instructions, "Operating instructions")
    else:
        yield Paragraph((Strong("Operating instructions:"), " ", *instructions.notes))
    yield Paragraph(("Not covered:",))
    yield Listing(tuple(_not_covered(subject, found)))


def _by_small_damping(subject: ReportData, found: LimitConclusion) -> Iterator[str]:
    """Sentences on governing values that stand at a resonance of a mode with little damping."""
    peaks = subject.governing_peaks.peaks if subject.governing_peaks else ()
    for worst, peak in little_damped(found.worst(), peaks):
        yield phrase(
            LITTLE_DAMPED,
            name=capital(as_words(worst.verdict.limit)),
            share=100 * (worst.utilisation or 0.0),
            speed=peak.rpm,
            order=as_words(line_name(peak)),
            mode=peak.critical.mode.number,
            damping=100 * peak.critical.mode.damping_ratio,
        )


def _components(subject: ReportData, found: LimitConclusion) -> TableBlock:
    """Table with a row for each criterion of each limit: its verdict, and the condition and speed where it is worst."""
    worst = found.worst()
    sizes = [_sizes(subject, one) for one in worst]
    columns = (
        Heading("Component"),
        Heading("Limit"),
        Heading("Verdict"),
        Heading("Worst condition"),
        Heading("Speed", "rpm", numeric=True),
        Heading("Value", numeric=True),
        Heading("Allowed", numeric=True),
        Heading("Unit"),
        Heading("Utilisation", "%", numeric=True),
    )
    cells: list[list[Cell]] = [
        [_component(one) for one in worst],
        [as_words(one.verdict.criterion) for one in worst],
        [one.gravest for one in worst],
        [condition_words(one.check.configuration) for one in worst],
        list(aligned_numbers([one.rpm for one in worst], 3)),
        list(aligned_numbers([value for value, _, _ in sizes], 3)),
        list(aligned_numbers([allowed for _, allowed, _ in sizes], 3)),
        [unit(shown) if shown else "" for _, _, shown in sizes],
        ["" if one.utilisation is None else NumberText(100 * one.utilisation, 3) for one in worst],
    ]
    caption = "Verdict on every component, at its worst condition and speed"
    return table(caption, columns, list(zip(*cells, strict=True)))


def _component(worst: WorstLimit) -> str:
    name, of = as_words(worst.verdict.limit), as_words(worst.verdict.of)
    return name if of in name else f"{name} ({of})"


def _sizes(subject: ReportData, worst: WorstLimit) -> tuple[float | None, float | None, str]:
    """Value, value allowed and their unit at the worst speed of a limit; None each where it was not judged."""
    one, at = worst.verdict, worst.verdict.worst
    if at is None:
        return None, None, ""
    scale, shown = engineering_unit(one.unit, subject.conventions, float(one.allowed[at]))
    return float(one.values[at]) * scale, float(one.allowed[at]) * scale, shown


def _not_covered(subject: ReportData, found: LimitConclusion) -> Iterator[Text]:
    """Points that the verdict does not cover: conditions, excitations, and what each rule leaves out."""
    if found.not_examined:
        yield (phrase("Conditions not examined: {names}.", names=listed_names(found.not_examined)),)
    for words in found.left_out:
        yield (f"{capital(as_words(words))}.",)
    definition = subject.model.definition
    judged = {getattr(limit, "element", "") for limit in definition.limits.values()}
    open_shafts = [name for name, one in definition.elements.items() if isinstance(one, Shaft) and name not in judged]
    if open_shafts:
        yield (
            phrase(
                "Shafts without a limit, which are not judged: {names}.",
                names=listed_names([*map(as_words, open_shafts)]),
            ),
        )
    of_rules: dict[str, dict[str, None]] = {}
    for check in found.checks:
        for text, names in check.texts().items():
            of_rules.setdefault(text.not_covered, {}).update(dict.fromkeys(names))
    for uncovered, limits in of_rules.items():
        yield (Strong(", ".join(map(as_words, limits))), f": {uncovered}.")
