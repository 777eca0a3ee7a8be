"""Section of a report on periodic motion where laws of motion act in full: all branches, and where sweeps jump."""

from __future__ import annotations

from collections.abc import Iterator

from torsionnet.base.number_text import aligned_numbers
from torsionnet.base.phrases import phrase
from torsionnet.machinery.orders.refined_response import is_periodic
from torsionnet.motion.periodic.periodic_response import PeriodicOrders
from torsionnet.motion.periodic.periodic_result import FoundMotion, PeriodicResponse
from torsionnet.report.document_tree import Block, Cell, Heading, Paragraph, Picture, Remark, Section, TableBlock
from torsionnet.report.report_data import FEW_CASES, Case, ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, capital, unit

SEVERAL = (
    "Laws of motion act in full: at one speed there may be several steady motions. Which of them is met depends on "
    "where the machine comes from; unstable ones are not met. Orders and limits are those of the largest stable motion."
)
"""Sentences that say what the section shows."""
CAPTION = (
    "All periodic motions over speed, peak to peak{where}: unstable ones dashed, those of unknown stability dotted; "
    "circles where a branch folds, diamonds where its period doubles."
)
"""Caption of the picture."""
JUMPS = "Where slow sweeps jump and periods double{where}"
"""Caption of the table."""
NO_JUMPS = "No sweep jumps, and no period doubles{where}."
"""Sentence in place of an empty table."""


def periodic_motions_section(subject: ReportData) -> Section | None:
    """Section of a report on periodic motions; None for a model whose laws of motion are taken as linear."""
    if not subject.has_excitations or not subject.order_outputs:
        return None
    if not any(is_periodic(case.drivetrain, None) for case in subject.cases):
        return None  # before responses are solved that no other section may need
    runs = zip(subject.cases, subject.order_responses, strict=True)
    blocks = [
        block
        for case, run in list(runs)[:FEW_CASES]
        if isinstance(run, PeriodicOrders)
        for block in _motions(subject, case, run)
    ]
    if not blocks:
        return None
    return Section("periodic_motions", ("Periodic motions",), (Paragraph((SEVERAL,)), *blocks))


def _motions(subject: ReportData, case: Case, run: PeriodicOrders) -> Iterator[Block]:
    """Blocks of the report on the motions of one configuration: branches drawn, jumps, and what is not known."""
    from torsionnet.plot.order_response_plot import periodic_response

    several = case.title and len(subject.cases) > 1
    where = phrase(" in configuration {name}", name=case.title) if several else ""
    drawn = periodic_response(run.motions, conventions=subject.conventions, title="")
    caption = phrase(CAPTION, where=where)
    yield Picture(f"periodic_motions_{subject.cases.index(case) + 1}", drawn, (caption,), caption)
    turns = sorted(_turns(run.motions), key=lambda turn: turn[1].at)
    if turns:
        yield _turn_table(subject, run.motions, turns, where)
    else:
        yield Paragraph((phrase(NO_JUMPS, where=where),))
    yield from (Remark("warning", (capital(note), ".")) for note in run.open_notes)


def _turns(motions: PeriodicResponse) -> Iterator[tuple[str, FoundMotion]]:
    """Places at which sweeps jump or periods double, each with the word for it."""
    folds = {motion.at: motion for motion in motions.turns("fold")}
    yield from ((way.capitalize(), folds[at]) for way, at in motions.jumps)
    yield from (("Period doubles", motion) for motion in motions.turns("doubling"))
    yield from (("Symmetry is lost", motion) for motion in motions.turns("symmetry"))
    yield from (("Second frequency", motion) for motion in motions.motions if motion.turn == "second frequency")


def _turn_table(
    subject: ReportData, motions: PeriodicResponse, turns: list[tuple[str, FoundMotion]], where: str
) -> TableBlock:
    columns = [Heading("What"), Heading("Speed", "rpm", numeric=True)]
    cells: list[list[Cell]] = [
        [phrase(word) for word, _ in turns],
        list(aligned_numbers([motions.shown(motion.at) for _, motion in turns])),
    ]
    for channel in motions.outputs:
        scale = subject.conventions.scale(channel.unit)
        shown = unit(subject.conventions.unit(channel.unit))
        columns.append(Heading((as_words(channel.name), ", ", phrase("peak to peak")), shown, numeric=True))
        cells.append(list(aligned_numbers([scale * motions.peak_to_peak(motion, channel.name) for _, motion in turns])))
    return table(phrase(JUMPS, where=where), columns, list(zip(*cells, strict=True)), merge=False)
