"""Tables of a report with the operating instructions and with what limits permit in passing at starts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import groupby

from torsionnet.base.number_text import NumberText, aligned_numbers
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.engine_entries import EngineEntries
from torsionnet.machinery.verdicts.limit_check import LimitCheck, PassedLimit, RunUpCheck
from torsionnet.machinery.verdicts.limit_checking import at_load
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion
from torsionnet.machinery.verdicts.limit_verdict import OPEN
from torsionnet.machinery.verdicts.operating_instructions import Instruction, last_notes, operating_instructions
from torsionnet.report.document_tree import Block, Cell, Heading, Paragraph, Strong, TableBlock, TableGroup
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, capital, limit_scale, unit

# Table of a report with the operating instructions, those of every condition by themselves.

COLUMNS = (
    Heading("From", "rpm", numeric=True),
    Heading("To", "rpm", numeric=True),
    Heading("Action", wide=True),
    Heading("Limits"),
    Heading("At", "rpm", numeric=True),
    Heading("Value", numeric=True),
    Heading("Allowed", numeric=True),
    Heading("In passing", numeric=True),
    Heading("Unit"),
)
DIGITS = 4
"""Significant digits of speeds and values, so that shares of what is allowed can be calculated from them."""
VALUES = (
    "Of the limits of a range the first decides; the value is its largest in the range, at the speed beside it, with "
    "what is allowed there in continuous operation and in passing."
)
"""Note on the numbers of the operating instructions."""


TOO_NEAR = "Separation margins are not kept, as the verdict says: no instruction makes up for that."
"""Note on natural frequencies that are too near to an excitation at speeds that no instruction bars."""


def instruction_blocks(subject: ReportData, judged: LimitConclusion, *, apart: bool = True) -> list[Block]:
    """Blocks of a report with the operating instructions; where nothing is restricted, a sentence that says so.

    ``apart`` tells whether separation margins are kept.
    """
    rows = operating_instructions(judged.checks, subject.titles.of)
    known = [check.configuration for check in judged.checks]
    last = last_notes(judged.checks, lambda names: subject.titles.several(names, known))
    last += [] if apart else [phrase(TOO_NEAR)]
    if not rows:
        said = (text for note in last for text in (" ", note))
        return [Paragraph((Strong("Operating instructions:"), *said))]
    groups = [
        TableGroup(tuple(_row(advice, subject) for advice in those), capital(title) if len(judged.checks) > 1 else "")
        for title, those in groupby(rows, key=lambda advice: advice.condition)
    ]
    notes = [_tachometer(rows), VALUES, *last]
    return [TableBlock(("Operating instructions",), COLUMNS, tuple(groups), tuple((note,) for note in notes))]


def _row(advice: Instruction, subject: ReportData) -> tuple[Cell, ...]:
    scale, shown = limit_scale(advice.unit, subject.conventions)
    sizes = (advice.value, advice.allowed, advice.allowed_in_passing)
    return (
        "" if advice.from_rpm is None else str(advice.from_rpm),
        "–" if advice.to_rpm is None else str(advice.to_rpm),
        advice.instruction,
        joined("; ", map(as_words, advice.limits)),
        NumberText(advice.rpm, DIGITS),
        *("–" if math.isnan(size) else NumberText(size * scale, DIGITS) for size in sizes),
        unit(shown),
    )


def _tachometer(rows: Sequence[Instruction]) -> str:
    """Sentence on the shaft whose speed is meant, and on the error of its tachometer that the ranges include."""
    speeds = phrase("Speeds are those of {shaft}, rounded outward to 1 rpm", shaft=as_words(rows[0].shaft))
    tolerance = max(advice.tolerance for advice in rows)
    if not tolerance:
        return joined("", (speeds, "."))
    error = phrase("; ranges are wider by {error:g} % for the tachometer.", error=100 * tolerance)
    return capital(joined("", (speeds, error)))


# Table of a report on starts: what the limits permit in passing, over the speeds of a run-up at its load.

OTHER_SHARE = 0.05
"""Relative difference of utilisation from which on a condition has a row beside the first one, as it differs in what an
analyst would round to."""
AS_IF_LASTING = (
    "Each value is that of steady vibration, as if the speed lasted; a start that rises quickly stays below it."
)
AT_ITS_RATE = (
    "The speed rises by {rate:.3g} rpm a second. Where steady vibration is above what is allowed, the value is that of "
    "this passage; any other is that of steady vibration, which is larger."
)
NOT_JUDGED = "Not judged: beside the value is what is allowed in continuous operation, as none is said in passing."
AT_ONE_LOAD = "Gas given for one load acts that share of the way from the pressure without injection or delivery to it."
NO_HEAT = "Heat of couplings and dampers is not judged in starts."
"""Notes on the values in the table of starts."""
MOST_PASSED, LEAST_PASSED = 8, 0.05
"""Largest number of critical speeds that a start is said to pass, and share of the largest amplitude below which they
are left out."""


def run_up_blocks(subject: ReportData, judged: LimitConclusion) -> Iterator[Block]:
    """Table of a report with the limits in passing over the speeds of each run-up; nothing where none is given.

    Each criterion has a row in the normal condition, or the first one with that run-up, and one in its worst condition
    where that differs.
    """
    by_run_up: dict[tuple[float, ...], list[LimitCheck]] = {}
    # The normal condition first, with which the others are compared.
    normal = subject.normal_case.configuration
    for check in sorted(judged.checks, key=lambda each: each.configuration != normal):
        if check.run_up:
            by_run_up.setdefault((*check.run_up.rpm, check.run_up.load, check.run_up.rate or 0.0), []).append(check)
    for checks in by_run_up.values():
        yield _table(subject, checks)


def _table(subject: ReportData, checks: list[LimitCheck]) -> Block:
    rows = list(_judged_cases(checks))
    scaled = [_in_units(subject, passed) for _, passed in rows]
    columns = (
        Heading("Component"), Heading("Limit"), Heading("Condition"), Heading("Speed", "rpm", numeric=True),
        Heading("Value", numeric=True), Heading("In passing", numeric=True), Heading("Unit"),
        Heading("Utilisation", "%", numeric=True), Heading("Verdict"),
    )  # fmt: skip
    cells = zip(
        [_component(passed) for _, passed in rows],
        [as_words(passed.steady.criterion) for _, passed in rows],
        [subject.titles.of(check.configuration) for check, _ in rows],
        aligned_numbers([passed.rpm for _, passed in rows], 3),
        aligned_numbers([value for value, _, _ in scaled], 3),
        aligned_numbers([allowed for _, allowed, _ in scaled], 3),
        [unit(shown) if shown else "" for _, _, shown in scaled],
        ["" if passed.utilisation is None else NumberText(100 * passed.utilisation, 3) for _, passed in rows],
        [passed.verdict for _, passed in rows],
        strict=True,
    )
    run_up = _run_up(checks[0])
    low, high = run_up.rpm
    caption = phrase(
        "Starts: {low:g} to {high:g} rpm of {shaft} at {load:g} % of the load, against what is allowed in passing",
        low=low, high=high, shaft=as_words(run_up.reference), load=100 * run_up.load,
    )  # fmt: skip
    note = AS_IF_LASTING if run_up.rate is None else phrase(AT_ITS_RATE, rate=run_up.rate * RPM)
    notes = [note, NOT_JUDGED] if any(passed.verdict == OPEN for _, passed in rows) else [note]
    engines = [one for one in subject.model.definition.excitations.values() if isinstance(one, EngineEntries)]
    if any(engine.load is None and engine.gas and not engine.gas.is_by_pressure for engine in engines):
        notes.append(AT_ONE_LOAD)
    if {"coupling", "damper"}.intersection(limit.kind for limit in subject.model.definition.limits.values()):
        notes.append(NO_HEAT)
    return table(caption, columns, list(cells), [*notes, *_passed_criticals(subject, checks[0])])


def _passed_criticals(subject: ReportData, check: LimitCheck) -> Iterator[str]:
    """Yield the sentence on the critical speeds that a start passes in a condition, those of the largest amplitude."""
    from torsionnet.machinery.criticals.critical_speed_search import critical_speeds

    run_up, case = _run_up(check), subject.judged_case(check)
    at_this_load, _ = at_load(case.drivetrain, run_up.load)
    speeds = critical_speeds(at_this_load, speeds=[run_up.low, run_up.high], reach=0.0)
    excited = [critical for critical in speeds.crossings if critical.excited and run_up.low <= critical.natural_speed]
    largest = sorted(excited, key=lambda critical: -critical.resonant_amplitude)[:MOST_PASSED]
    # Without damping all are infinite.
    strong = [one for one in largest if one.resonant_amplitude >= LEAST_PASSED * largest[0].resonant_amplitude]
    condition = subject.titles.of(check.configuration)
    if strong:
        yield phrase(
            "In {condition}, starts pass critical speeds, the largest at resonance first: {names}."
            if condition
            else "Starts pass critical speeds, the largest at resonance first: {names}.",
            condition=condition,
            names=joined(", ", [
                phrase("{order}, mode {mode} at {speed:.1f}", order=as_words(f"{one.excitation} {one.line}"),
                       mode=one.mode.number, speed=one.natural_speed * RPM)
                for one in strong
            ]),
        )  # fmt: skip


def _run_up(check: LimitCheck) -> RunUpCheck:
    assert check.run_up is not None
    return check.run_up


def _judged_cases(checks: list[LimitCheck]) -> Iterator[tuple[LimitCheck, PassedLimit]]:
    """Yield each criterion in the first condition that judges it, then in the worst one if it is clearly worse."""
    of_criterion: dict[tuple[str, str], list[tuple[LimitCheck, PassedLimit]]] = {}
    for check in checks:
        for passed in _run_up(check).verdicts:
            of_criterion.setdefault((passed.steady.limit, passed.steady.criterion), []).append((check, passed))
    for of_one in of_criterion.values():
        first, worst = of_one[0], max(of_one, key=lambda pair: pair[1].utilisation or 0.0)
        yield first
        if (worst[1].utilisation or 0.0) > (1 + OTHER_SHARE) * (first[1].utilisation or 0.0):
            yield worst


def _component(passed: PassedLimit) -> str:
    name, of = as_words(passed.steady.limit), as_words(passed.steady.of)
    return name if of in name else f"{name} ({of})"


def _in_units(subject: ReportData, passed: PassedLimit) -> tuple[float | None, float | None, str]:
    """Value, value allowed and their unit for engineers; None each where they are not known."""
    if passed.value is None or passed.allowed is None:
        return None, None, ""
    scale, shown = limit_scale(passed.steady.unit, subject.conventions)
    return passed.value * scale, passed.allowed * scale, shown
