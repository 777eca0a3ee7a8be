"""Section of a report on loops of a component bench: pictures, stages, loss, what was corrected and what was not."""

from __future__ import annotations

from collections.abc import Iterator

from torsionnet.base.notes import Note
from torsionnet.base.number_text import NumberText
from torsionnet.base.phrases import phrase
from torsionnet.report.document_tree import Block, Cell, Heading, Listing, Math, Paragraph, Picture, Section, TableBlock
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import unit
from torsionnet.signals.torque_loops.loop_result import LoopValue, TorqueLoop, TorqueLoops

DIGITS = 4
"""Significant digits of what loops show."""
CAPTION = "Torque {torque} over twist {twist}: mean branches, the fitted spring line dashed, dots where stages begin."
LOOPS = "Loops, each with its 95 % interval over cycles"
STAGES = "Stages, each with its 95 % interval over cycles"
NOTES = "What was corrected, and what was not:"


def loops_section(subject: ReportData) -> Section:
    """Section of a report with picture, tables and remarks of each record of loops."""
    blocks = [
        block for number, loops in enumerate(subject.request.loops, 1) for block in _record(subject, loops, number)
    ]
    return Section("loops", ("Loops of the component bench",), tuple(blocks))


def _record(subject: ReportData, loops: TorqueLoops, number: int) -> Iterator[Block]:
    from torsionnet.plot.signal_plots import torque_loops

    caption = phrase(CAPTION, torque=loops.torque, twist=loops.twist)
    drawn = torque_loops(loops, conventions=subject.conventions, title="")
    yield Picture(f"loops_{number}", drawn, (caption,), caption)
    yield _loops(subject, loops)
    stages = [loop for loop in loops.loops if loop.stages and not loop.bends]
    if stages:
        yield _stages(subject, max(stages, key=lambda loop: loop.amplitude.value))
    if loops.notes:
        yield Paragraph((NOTES,))
        yield Listing(tuple((loop.text if isinstance(loop, Note) else loop,) for loop in loops.notes))


def _value(value: LoopValue | None, scale: float = 1.0) -> tuple[Cell, Cell]:
    """Cells of a value and of the half width of its interval."""
    if value is None:
        return "", ""
    half = "" if value.half_width is None else NumberText(scale * value.half_width, 2)
    return NumberText(scale * value.value, DIGITS), half


def _loops(subject: ReportData, loops: TorqueLoops) -> TableBlock:
    angle, scale = subject.conventions.unit("rad"), subject.conventions.scale("rad")
    columns = [Heading("Mean torque", unit("N*m"), numeric=True), Heading("Amplitude", unit(angle), numeric=True)]
    quantities: tuple[tuple[Cell, str], ...] = (
        ("Secant stiffness", "N*m/rad"), ("Loss of a cycle", "J"), (Math(r"\eta_s"), ""), (Math(r"\eta_1"), ""),
        ("Friction torque", "N*m"),
    )  # fmt: skip
    for words, name in quantities:
        columns += [Heading(words, unit(name), numeric=True), Heading("±", unit(name), numeric=True)]
    rows = [
        (
            NumberText(loop.mean_torque, DIGITS), NumberText(scale * loop.amplitude.value, DIGITS),
            *_value(loop.secant_stiffness), *_value(loop.loss), *_value(loop.eta_s), *_value(loop.eta_1),
            *_value(loop.friction),
        )
        for loop in loops.loops
    ]  # fmt: skip
    return table(LOOPS, columns, rows, merge=False)


def _stages(subject: ReportData, loop: TorqueLoop) -> TableBlock:
    angle, scale = subject.conventions.unit("rad"), subject.conventions.scale("rad")
    columns = [Heading("Side"), Heading("Stage", numeric=True)]
    for words, name in (("Stiffness", "N*m/rad"), ("Begins", angle), ("Friction torque", "N*m")):
        columns += [Heading(words, unit(name), numeric=True), Heading("±", unit(name), numeric=True)]
    rows = [
        (
            phrase(stage.side), str(stage.number), *_value(stage.stiffness), *_value(stage.begins, scale),
            *_value(stage.friction),
        )
        for stage in loop.stages
    ]  # fmt: skip
    return table(STAGES, columns, rows, merge=False)
