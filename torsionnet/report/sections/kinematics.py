"""Section of a report on kinematic relations, nodes that follow others and by which ratio."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from torsionnet.base.phrases import phrase
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Details,
    Heading,
    Math,
    NumberText,
    Paragraph,
    Section,
    TableBlock,
    Text,
)
from torsionnet.report.formula_widths import formula_letters
from torsionnet.report.report_data import FEW_CASES, ReportData, SymbolicEquations
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, first_names
from torsionnet.symbolic.formula_text import latex
from torsionnet.symbolic.symbol_names import angle_latex

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain

MOST_ROWS, MOST_COLUMNS, MOST_NAMES, LONGEST_RATIO = 40, 6, 12, 24
"""Largest number of rows, configurations and names in tables of ratios, and largest number of letters of a ratio."""


def kinematics_section(subject: ReportData) -> Section:
    """Section of a report on nodes that follow other nodes by rigid connections."""
    rig = subject.cases[0].drivetrain
    kept = rig.assembly.kinematics.coordinates
    if not subject.is_large:
        names: Text = ("; the coordinates are ", *_angles(kept), ".") if kept else ("; nothing can move.",)
    else:
        names = (
            phrase(
                "; the coordinates are the angles of {nodes}.",
                nodes=first_names([as_words(node) for node in kept], MOST_NAMES),
            ),
        )
    count = phrase(
        "The model has {count} nodes, {independent} of them independent", count=len(rig.nodes), independent=len(kept)
    )
    blocks: list[Block] = [Paragraph((count, *names))]
    dependent = [node for node in rig.nodes if node not in kept]
    if not dependent:
        blocks.append(Paragraph(("No node is rigidly tied to another, and none is clamped.",)))
    elif subject.is_large:
        blocks.append(_numeric(rig, dependent))
    else:
        few = (
            subject.symbolic_equations
            if len(subject.symbolic_equations) <= FEW_CASES
            else subject.symbolic_equations[:1]
        )
        blocks += [
            _relations(form) if _is_short_matrix(form) else _numeric(form.cases[0].drivetrain, dependent)
            for form in few
        ]
        others = subject.symbolic_equations[len(few) :]
        if others:
            title = phrase(
                "Kinematic relations of the other {count} configurations", count=sum(len(form.cases) for form in others)
            )
            tables = tuple(_relations(form) for form in others)
            blocks.append(Details((title,), tables, (title, ": in the report as HTML.")))
    return Section("kinematics", ("Kinematic relations",), tuple(blocks))


def _is_short_matrix(form: SymbolicEquations) -> bool:
    """Whether the ratios in symbols are short enough to be read."""
    return max((formula_letters(cell) for cell in form.system.T if cell != 0), default=0) <= LONGEST_RATIO


def _angles(nodes: tuple[str, ...]) -> Text:
    shown: list[Any] = []
    for number, node in enumerate(nodes):
        shown += ([", "] if number else []) + [Math(angle_latex(node))]
    return tuple(shown)


def _relations(form: SymbolicEquations) -> TableBlock:
    system, first = form.system, form.cases[0].drivetrain
    cases = form.cases[:MOST_COLUMNS]
    cases = cases[:1] if all(_same_ratios(cases[0].drivetrain, case.drivetrain) for case in cases) else cases
    rows = []
    for index, node in enumerate(system.nodes):
        if node in system.coordinates:
            continue
        terms = [(system.T[index, column], name) for column, name in enumerate(system.coordinates)]
        given = [(coefficient, name) for coefficient, name in terms if coefficient != 0]
        numbers = [_ratio(case.drivetrain, node, given) for case in cases]
        rows.append((as_words(node), Math(f"{angle_latex(node)} = {_sum(given)}"), _owners(first, node), *numbers))
    heads = [case.configuration for case in cases] if len(cases) > 1 else ["Ratio"]
    columns = [Heading("Node"), Heading("Angle"), Heading("By", wide=True)]
    columns += [Heading(head, numeric=True) for head in heads]
    note = "Ratio: angle of the node over that of the coordinate."
    return table("Nodes that follow others", columns, rows, [note], most=MOST_ROWS)


def _same_ratios(rig: Drivetrain, other: Drivetrain) -> bool:
    return bool(np.array_equal(rig.assembly.T, other.assembly.T))


def _ratio(rig: Drivetrain, node: str, given: list[tuple[Any, str]]) -> Cell:
    """Cell with the ratio, in numbers, of a node that follows one coordinate; a dash for several."""
    if len(given) > 1:
        return "–"
    row = rig.assembly.T[rig.assembly.node_index[node]]
    return NumberText(float(row[rig.assembly.kinematics.coordinates.index(given[0][1])]) if given else 0.0, 5)


def _sum(given: list[tuple[Any, str]]) -> str:
    text = ""
    for coefficient, name in given:
        negative = bool(coefficient.could_extract_minus_sign())
        size = -coefficient if negative else coefficient
        shown = "" if size == 1 else rf"\left({latex(size)}\right) " if size.is_Add else f"{latex(size)} "
        text += f"{'-' if negative else '+' if text else ''} {shown}{angle_latex(name)} "
    return text.strip() or "0"


def _owners(rig: Drivetrain, node: str) -> str:
    kinematics = rig.assembly.kinematics
    owners = [*(f"input {name}" for name in kinematics.imposed), *(name for name, _ in kinematics.constraints)]
    origin = sorted(kinematics.reduction.origin(node))
    return first_names([as_words(name) for name in dict.fromkeys(owners[index] for index in origin)], 4)


def _numeric(rig: Drivetrain, dependent: list[str]) -> TableBlock:
    rows: list[tuple[Cell, ...]] = []
    for node in dependent[:MOST_ROWS]:
        row = rig.assembly.kinematics.reduction.solved[node]
        follows = (
            ", ".join(f"{float(value):.6g} × {as_words(name)}" for name, value in list(row.items())[:4]) or "at rest"
        )
        rows.append((as_words(node), follows, _owners(rig, node)))
    rows += [("", "", "")] * (len(dependent) - len(rows))
    columns = (Heading("Node"), Heading("Follows"), Heading("By", wide=True))
    return table("Nodes that follow others", columns, rows, most=MOST_ROWS)
