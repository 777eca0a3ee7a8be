"""Section of a report on the equations of motion in symbols, and on their matrices in symbols and numbers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from torsionnet.base.phrases import phrase
from torsionnet.report.document_tree import (
    Block,
    BreakableMath,
    Cell,
    Code,
    Details,
    Equations,
    Formula,
    Heading,
    Math,
    NumberText,
    Paragraph,
    Remark,
    Section,
    Strong,
    TableBlock,
    Text,
)
from torsionnet.report.report_data import FEW_CASES, MOST_SYMBOLIC, Case, ReportData, SymbolicEquations, titles_of
from torsionnet.report.report_tables import WIDEST_FORMULA, WIDEST_MATRIX, formula_letters, matrix_letters, table
from torsionnet.report.report_text import as_words, first_names
from torsionnet.symbolic.equations import (
    bracketed_matrix,
    column_latex,
    complex_stiffness,
    equation_terms,
    matrix_latex,
    to_latex,
)
from torsionnet.symbolic.formula_text import latex
from torsionnet.symbolic.symbol_names import angle_latex, symbol_latex

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.linear.assembly.symbolic import SymbolicAction
    from torsionnet.linear.frequency_response import FloatArray
    from torsionnet.symbolic.symbolic_system import SymbolicSystem


MATRIX_UNITS = {"M": "kg·m²", "C": "N·m·s/rad", "K": "N·m/rad"}
"""Units of the entries of the inertia, damping and stiffness matrix."""
DERIVATIVES = {"M": r"\ddot{\mathbf{q}}", "C": r"\dot{\mathbf{q}}", "K": r"\mathbf{q}"}
"""LaTeX of the coordinates, or of their derivative, that each of the matrices M, C and K is multiplied with."""
MATRIX_NAMES = {"M": "inertia", "C": "viscous damping", "K": "stiffness"}
"""Name of the quantity that each of the matrices M, C and K holds."""
WIDEST_NUMBER_MATRIX = 84
"""Width in characters of a matrix of numbers that roughly fits the page."""
MOST_UNFOLDED_ENTRIES = 60
"""Number of matrix entries up to which a list of them is in full view, and beyond which it is folded away."""
COMPLEX_NOTE = "Stiffness that depends on frequency, or is complex, is not included."
"""Note under matrices of numbers that lack a frequency-dependent stiffness."""
MOST_ENTRIES = 200
"""Largest number of matrix entries that a report lists."""
MOST_MATRIX_ROWS = 24
"""Largest number of matrix rows, of all configurations together, that a report prints in numbers."""
MOST_NUMERIC_COORDINATES = 12
"""Largest number of coordinates of a system whose matrices a report prints in numbers."""


def equations_section(subject: ReportData) -> Section:
    """Section of a report with the equations of motion, in symbols for models of few coordinates."""
    if (n := subject.n_coordinates) > MOST_SYMBOLIC:
        lead = phrase(
            "The model has {count} coordinates; its equations are given by the entries of their matrices.", count=n
        )
        return Section("equations", ("Equations of motion",), (Paragraph((lead,)), *_entries(subject)))
    # With many forms only the first is written out; the others are folded away.
    few = subject.symbolic_equations if len(subject.symbolic_equations) <= FEW_CASES else subject.symbolic_equations[:1]
    others = subject.symbolic_equations[len(few) :]
    blocks: list[Block] = []
    for form in few:
        written = _form(form, several=len(subject.symbolic_equations) > 1)
        if _is_short(form.system):
            blocks += written
        else:
            title = phrase(
                "Equations of motion in symbols{where}",
                where=f", configuration {_where(form.cases)}" if len(few) > 1 else "",
            )
            lead = "In symbols the equations are too long to be read; the report as HTML has them."
            blocks.append(Details((title,), tuple(written), (lead,)))
    if others:
        title = phrase(
            "Equations of motion of the other {count} configurations", count=sum(len(form.cases) for form in others)
        )
        inner = tuple(block for form in others for block in _form(form, several=True))
        blocks.append(Details((title,), inner, (title, ": in the report as HTML.")))
    blocks += _matrix_tables(subject)
    return Section("equations", ("Equations of motion",), tuple(blocks))


def _is_short(system: SymbolicSystem) -> bool:
    """Whether every entry of a system's symbolic matrices fits a line of the report."""
    return all(
        formula_letters(cell) <= WIDEST_FORMULA for key in MATRIX_UNITS for cell in getattr(system, key) if cell != 0
    )


def _where(cases: tuple[Case, ...]) -> str:
    return titles_of(cases)


def _form(form: SymbolicEquations, *, several: bool) -> list[Block]:
    """Blocks of the report on one system of equations of motion.

    Line by line, and as a sum of matrices if these fit.
    """
    system = form.system
    blocks: list[Block] = []
    if several:
        blocks.append(Paragraph((Strong(phrase("Configuration {name}", name=_where(form.cases))),)))
    rows = tuple(BreakableMath(tuple(equation_terms(system, row))) for row in range(len(system.coordinates)))
    blocks += [Paragraph(_introduction(system)), Equations(rows)]
    if all(matrix_letters(getattr(system, key)) <= WIDEST_MATRIX for key in MATRIX_UNITS):
        blocks += _matrices(system)
    blocks += _laws(system)
    if system.conditions:
        zero = [Math(f"{latex(condition)} = 0") for condition in system.conditions]
        parts: list[Any] = []
        for number, condition in enumerate(zero):
            parts += ([", "] if number else []) + [condition]
        blocks.append(Remark("note", ("The values fulfil, and the equations presume, ", *parts, ".")))
    return blocks


def _matrices(system: SymbolicSystem) -> list[Block]:
    """Formulas of the equations of motion as a sum of matrices, and of each matrix that has an entry."""
    filled = [key for key in MATRIX_UNITS if any(getattr(system, key))]
    terms = [rf"\mathbf{{{key}}}\,{DERIVATIVES[key]}" for key in filled]
    dynamic = complex_stiffness(system)
    terms += [r"\mathbf{D}(\omega)\,\mathbf{q}"] if any(dynamic) else []
    loads = [r"\mathbf{B}\,\mathbf{u}"] if system.inputs else []
    loads += [
        rf"{column_latex([latex(value) for value in action.row])}\,{_torque(action)}" for action in system.actions
    ]
    load = " + ".join(loads) or r"\mathbf{0}"
    q = to_latex(system, "q")
    blocks: list[Block] = [Paragraph(("In matrices:",))]
    blocks.append(Formula(rf"{' + '.join(terms) or '0'} = {load}, \qquad \mathbf{{q}} = {q}"))
    blocks += [Formula(rf"\mathbf{{{key}}} = {to_latex(system, key)}") for key in filled]
    if any(dynamic):
        blocks.append(Formula(rf"\mathbf{{D}}(\omega) = {matrix_latex(dynamic.tolist())}"))
    if system.inputs:
        both = [rf"\mathbf{{{key}}} = {to_latex(system, key)}" for key in ("B", "u")]
        blocks.append(Formula(r", \qquad ".join(both)))
    return blocks


def _laws(system: SymbolicSystem) -> list[Block]:
    """Formulas of the torques of controllers, as Laplace transforms of their laws."""
    import sympy

    laws: list[Block] = []
    for action in system.actions:
        sensed = column_latex([latex(value) for value in action.sensed])
        law = latex(action.law(sympy.Symbol("s")))
        laws.append(Formula(rf"{_torque(action)} = {law}\,{sensed}^{{\mathsf{{T}}}}\,{to_latex(system, 'q')}"))
    return laws


def _torque(action: SymbolicAction) -> str:
    return symbol_latex(f"T_{action.owner}")


def _introduction(system: Any) -> Text:
    reflected = any(key.has(symbol) for key in (system.M, system.C, system.K) for symbol in system.T.free_symbols)
    text = "Angles of the coordinates, a dot for a derivative with respect to time."
    more = " What lies behind a gear stage appears reflected, with the square of its ratio."
    return (text, more) if reflected else (text,)


def _matrix_tables(subject: ReportData) -> list[Block]:
    """Table of the matrices M, C and K in numbers in SI units, of every configuration of the report.

    A matrix that is the same in all cases stands once.
    """
    of_cases = [
        (key, [getattr(case.drivetrain.assembly.system, key) for case in subject.cases]) for key in MATRIX_UNITS
    ]
    if (
        len(subject.cases) * subject.n_coordinates > MOST_MATRIX_ROWS
        or subject.n_coordinates > MOST_NUMERIC_COORDINATES
        or any(_number_width(matrix) > WIDEST_NUMBER_MATRIX for _, all_of in of_cases for matrix in all_of)
    ):
        return _entries(subject)
    rows = []
    for key, matrices in of_cases:
        alike = all(np.array_equal(matrices[0], other) for other in matrices[1:])
        shown = [("all" if len(matrices) > 1 else "", matrices[0])] if alike else [
            (case.title, matrix) for case, matrix in zip(subject.cases, matrices, strict=True)
        ]  # fmt: skip
        for number, (where, matrix) in enumerate(shown):
            head = (Math(rf"\mathbf{{{key}}}"), MATRIX_NAMES[key]) if not number else ("", "")
            rows.append((*head, where, Math(numbers_latex(matrix)), MATRIX_UNITS[key]))
    columns = (Heading("Matrix"), Heading("Of"), Heading("Configuration"), Heading("Value"), Heading("Unit"))
    dynamic = any(case.drivetrain.assembly.system.dynamic for case in subject.cases)
    notes = [COMPLEX_NOTE] if dynamic else []
    return [table("Matrices in numbers, in the order of the coordinates", columns, rows, notes)]


def numbers_latex(matrix: FloatArray) -> str:
    """LaTeX of a matrix of numbers, with a power of ten in front where that makes the matrix shorter."""
    if not matrix.any():
        return r"\mathbf{0}"
    sizes = np.abs(matrix[matrix != 0])
    power = 3 * math.floor(math.log10(sizes.max()) / 3)
    power = power if abs(power) > 3 else 0
    rows = [[_cell(value / 10.0**power) for value in row] for row in matrix.tolist()]
    return (rf"10^{{{power}}} \cdot " if power else "") + bracketed_matrix(rows)


def _cell(value: float) -> str:
    number = NumberText(value, 5)
    return number.mantissa + (rf" \cdot 10^{{{number.exponent}}}" if number.exponent is not None else "")


def _number_width(matrix: FloatArray) -> int:
    return sum(
        max((len(f"{value:.4g}") for value in column_latex), default=0) + 2 for column_latex in matrix.T.tolist()
    )


def _entries(subject: ReportData) -> list[Block]:
    """Table of the nonzero entries on and above the diagonals of M, C and K, in numbers in SI units."""
    case = subject.cases[0]
    system, names = case.drivetrain.assembly.system, case.drivetrain.assembly.kinematics.coordinates
    matrices = [getattr(system, key) for key in MATRIX_UNITS]
    filled = np.triu(np.any([matrix != 0 for matrix in matrices], axis=0))
    rows = [
        (
            as_words(names[i]),
            as_words(names[j]),
            *(NumberText(float(m[i, j]), 5) if m[i, j] else "" for m in matrices),
        )
        for i, j in np.argwhere(filled).tolist()
    ]
    columns = (
        Heading("Row"),
        Heading("Column"),
        *(Heading((Math(rf"\mathbf{{{key}}}"),), shown, numeric=True) for key, shown in MATRIX_UNITS.items()),
    )
    where = phrase(" in configuration {name}", name=case.title) if case.title else ""
    notes: list[Cell] = ["The matrices are symmetric: entries below the diagonal are those above it."]
    notes += ["In other configurations other values and ratios take their places."] if len(subject.cases) > 1 else []
    notes += [COMPLEX_NOTE] if any(case.drivetrain.assembly.system.dynamic for case in subject.cases) else []
    notes.append(_export())
    entries = table(
        phrase("Entries of the matrices of inertia, viscous damping and stiffness{where}", where=where),
        columns,
        rows,
        notes,
        most=MOST_ENTRIES,
    )
    if len(rows) <= MOST_UNFOLDED_ENTRIES:
        return [entries]
    text = phrase("{count} entries of M, C and K are not zero", count=len(rows))
    return [Details((text,), (entries,), (text, "; the report as HTML lists them. ", *_export()))]


def _export() -> Text:
    return (Code("torsionnet export MODEL -o matrices.mat"), " writes them for Matlab and Octave.")


# Section of a report on kinematic relations, nodes that follow others and by which ratio.

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
            # In symbols while the matrix fits the page, else in numbers.
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
    heads = [case.title for case in cases] if len(cases) > 1 else ["Ratio"]
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
