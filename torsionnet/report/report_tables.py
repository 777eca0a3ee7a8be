"""Tables of a report from rows of cells: equal rows are merged, empty columns left out, formulas kept on the page."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import groupby
from typing import Any

from torsionnet.base.expressions import Compound, Expression, Name, Number
from torsionnet.base.number_text import aligned_numbers, prefix_of
from torsionnet.base.phrases import joined
from torsionnet.base.table import Column, Table
from torsionnet.report.document_tree import Cell, Heading, Inline, Math, NumberText, TableBlock, TableGroup, inlines
from torsionnet.report.report_text import KILO, as_words, capital, unit
from torsionnet.study.study import ShownUnits
from torsionnet.symbolic.symbol_names import symbol_latex

# Tables of a report from rows of cells: equal rows are merged, empty columns left out.

MOST_DIGITS = 4
"""Number of significant digits that the smallest number in a column of a report's table has."""
JUDGED = ("value", "allowed", "in passing", "largest value", "steady")
"""Headings of the columns of verdicts and passages whose unit stands in a column of its own."""
HEADING_SYMBOLS: dict[str, Cell] = {
    "J": Math("J"),
    "J referred": (Math("J"), " referred"),
    "theta": Math(r"\theta"),
    "J w^2 theta": Math(r"J\omega^{2}\theta"),
    "to the next by": "Link",
    "k": Math("k"),
    "k referred": (Math("k"), " referred"),
    "|lambda|/2pi": Math(r"\left|\lambda\right|/2\pi"),
    "|lambda| /2pi": ("Of ", Math(r"\left|\lambda\right|/2\pi")),
    "damped Im lambda/2pi": Math(r"\mathrm{Im}\,\lambda/2\pi"),
}
"""Symbols in place of headings of table columns, by the heading's text on the screen."""


def table(
    caption: Cell,
    columns: Sequence[Heading],
    rows: Sequence[tuple[Cell, ...]],
    notes: Sequence[Cell] = (),
    most: int | None = None,
    *,
    merge: bool = True,
) -> TableBlock:
    """Table of a report from headings and rows of cells, without groups, cut after ``most`` rows.

    Equal rows are merged unless ``merge`` is false, empty columns left out.
    """
    merged = merge_equal_rows(rows) if merge else tuple(rows)
    kept = merged[:most] if most else merged
    used = [index for index, _ in enumerate(columns) if any(row[index] not in ("", ()) for row in kept)]
    return TableBlock(
        inlines(caption),
        tuple(columns[index] for index in used),
        (TableGroup(tuple(tuple(row[index] for index in used) for row in kept)),),
        tuple(map(inlines, notes)),
        len(merged) - len(kept),
    )


def results_table(
    numbers: Table,
    caption: Cell,
    *,
    notes: bool = True,
    most: int | None = None,
    words: Callable[[str], Cell] = as_words,
    heads: Callable[[str], Cell] = capital,
) -> TableBlock:
    """Table of a report from a table of results, with headings, units and numbers as a reader sees them.

    ``words`` and ``heads`` make of texts and of headings what a reader sees.
    """
    columns = []
    cells: list[list[Cell]] = []
    largest = _largest_by_unit(numbers)
    for index, column in enumerate(numbers.columns):
        values = [row[index] for row in numbers.rows]
        heading = HEADING_SYMBOLS[column.name] if column.name in HEADING_SYMBOLS else heads(column.name)
        if numbers.is_numeric(index):
            prefix, factor = prefix_of(column.unit, largest[column.unit])
            columns.append(Heading(heading, unit(prefix + column.unit) if column.unit else "", numeric=True))
            cells.append(_number_cells(values, column.digits, factor))
        else:
            columns.append(Heading(heading, unit(column.unit) if column.unit else ""))
            is_unit = column.name == "unit"
            cells.append([unit(value) if is_unit and value else _text(value, words) for value in values])
    rows = list(zip(*cells, strict=True))
    return table(caption, columns, rows, [as_words(note) for note in numbers.notes] if notes else [], most)


def with_kilo_units(numbers: Table) -> Table:
    """Table of verdicts with torques in kN m and powers in kW, as those of one component are in all tables.

    Examples
    --------
    >>> shown = with_kilo_units(Table("", (Column("allowed"), Column("unit")), ((95e3, "N*m"), (4.2e7, "Pa"))))
    >>> shown.rows
    ((95.0, 'kN*m'), (42000000.0, 'Pa'))
    """
    at = [heading.name for heading in numbers.columns].index(UNIT)
    rows = tuple(
        tuple(
            f"k{value}" if place == at else value / 1e3 if isinstance(value, float) and column.name in JUDGED else value
            for place, (column, value) in enumerate(zip(numbers.columns, row, strict=True))
        )
        if row[at] in KILO or row[at] == "N*m"
        else row
        for row in numbers.rows
    )
    return replace(numbers, rows=rows)


def _largest_by_unit(numbers: Table) -> dict[str, float]:
    """Largest size in each unit of a table: columns of one unit have one prefix, so that they can be added up."""
    largest: dict[str, float] = {}
    for index, column in enumerate(numbers.columns):
        if numbers.is_numeric(index):
            sizes = [abs(row[index]) for row in numbers.rows if row[index] is not None and not math.isnan(row[index])]
            largest[column.unit] = max([largest.get(column.unit, 0.0), *sizes])
    return largest


def with_decimals(block: TableBlock, decimals: Mapping[str, int]) -> TableBlock:
    """Copy of a report's table whose numbers have a fixed number of decimals, by the unit of their column."""
    fixed = [decimals.get(column.unit) for column in block.columns]
    groups = tuple(
        replace(
            group,
            rows=tuple(
                tuple(
                    replace(cell, decimals=count) if count is not None and isinstance(cell, NumberText) else cell
                    for cell, count in zip(row, fixed, strict=True)
                )
                for row in group.rows
            ),
        )
        for group in block.groups
    )
    return replace(block, groups=groups)


def _number_cells(values: Sequence[Any], digits: int, factor: float) -> list[Cell]:
    """Numbers of a column divided by a factor, as cells with a number of significant digits.

    Empty texts where the column has no number.
    """
    if all(isinstance(value, int) for value in values):
        return [str(value) for value in values]
    known = [None if value is None or math.isnan(value) else float(value) / factor for value in values]
    return (
        ["" for _ in values]
        if not any(value is not None for value in known)
        else list(aligned_numbers(known, min(digits, MOST_DIGITS)))
    )


def _text(value: Any, words: Callable[[str], Cell]) -> Cell:
    return "" if value is None else words(f"{value:.6g}" if isinstance(value, float) else str(value))


def merge_equal_rows(rows: Sequence[tuple[Cell, ...]]) -> tuple[tuple[Cell, ...], ...]:
    """Rows of a table in which neighbours that differ in their first cell only are one row that names them all.

    Examples
    --------
    >>> rows = [("dry", NumberText(1.0)), ("wet", NumberText(1.0)), ("warm", NumberText(2.0))]
    >>> [row[0] for row in merge_equal_rows(rows)]
    ['dry, wet', 'warm']
    """
    merged: list[tuple[Cell, ...]] = []
    for row in rows:
        named = merged and len(row) > 1 and row[0] and merged[-1][0]
        if named and shown_cells(row[1:]) == shown_cells(merged[-1][1:]):
            merged[-1] = ((*inlines(merged[-1][0]), ", ", *inlines(row[0])), *merged[-1][1:])
        else:
            merged.append(row)
    return tuple((join_texts(row[0]), *row[1:]) if row else row for row in merged)


def shown_cells(row: Sequence[Cell]) -> list[tuple[object, ...]]:
    """Content of the cells of a row as a reader sees it, numbers by their digits, for comparison of rows."""
    return [
        tuple((part.mantissa, str(part.exponent)) if isinstance(part, NumberText) else part for part in inlines(cell))
        for cell in row
    ]


def join_texts(cell: Cell) -> Cell:
    """Cell of a table whose neighbouring texts are put together."""
    parts: list[Inline] = []
    for is_text, run in groupby(inlines(cell), lambda part: isinstance(part, str)):
        pieces = tuple(run)
        parts += (joined("", map(str, pieces)),) if is_text and len(pieces) > 1 else pieces
    return parts[0] if len(parts) == 1 else tuple(parts)


# Tables of a study's results in the units in which its author wrote the numbers.

UNIT = "unit"
"""Heading of a table's column of units, which belong to the numbers beside it."""


def in_shown_units(numbers: Table, units: ShownUnits) -> Table:
    """Table of a study's results in the units of its author, by the names in its headings or in its rows.

    Examples
    --------
    >>> table = Table("peaks", (Column("theta", "rad"), Column("mode")), ((0.5, 1),))
    >>> shown = in_shown_units(table, ShownUnits({"theta": "mrad"}, {"theta": "rad"}))
    >>> shown.columns[0].unit, shown.rows[0]
    ('mrad', (500.0, 1))
    """
    scales = _column_scales(numbers.columns, units)
    columns = tuple(replace(column, unit=unit) for column, (_, unit) in zip(numbers.columns, scales, strict=True))
    rows = tuple(
        tuple(_scaled(value, scale) for value, (scale, _) in zip(row, scales, strict=True)) for row in numbers.rows
    )
    places = [place for place, column in enumerate(numbers.columns) if column.name == UNIT]
    if places:
        rows = tuple(_row_in_shown_units(row, places, units) for row in rows)
    return _units_in_headings(replace(numbers, columns=columns, rows=rows), places)


def _units_in_headings(numbers: Table, places: Sequence[int]) -> Table:
    """Table in which a unit that is the same in all rows stands in the headings instead of a column of its own."""
    same = {place: numbers.rows[0][place] for place in places if len({row[place] for row in numbers.rows}) == 1}
    columns = list(numbers.columns)
    for place, column in enumerate(columns):
        at = _unit_of(place, places)
        if at in same and any(isinstance(row[place], float) for row in numbers.rows):
            columns[place] = replace(column, unit=same[at])
    kept = [place for place in range(len(columns)) if place not in same]
    return replace(numbers, columns=tuple(columns)).chosen(kept)


def _unit_of(place: int, places: Sequence[int]) -> int:
    """Index of the column of units that belongs to a column of numbers, -1 without any.

    The next one, behind all of them the last.
    """
    return next((unit_place for unit_place in places if unit_place >= place), places[-1]) if places else -1


def _column_scales(columns: Sequence[Column], units: ShownUnits) -> list[tuple[float, str]]:
    """Factor and unit in which every column of a table is shown.

    A column without a unit of its own name takes the one of equal SI unit.
    """
    named = {column.unit: column.name for column in columns if column.unit and units.si.get(column.name) == column.unit}
    scales = []
    for column in columns:
        name = column.name if units.si.get(column.name) == column.unit else named.get(column.unit)
        known = bool(column.unit) and name is not None
        scales.append((units.scale(name), units.unit(name)) if known and name else (1.0, column.unit))
    return scales


def _row_in_shown_units(row: tuple[Any, ...], places: Sequence[int], units: ShownUnits) -> tuple[Any, ...]:
    """Row of a table with units in it, converted to the units of the study."""
    names = [value for value in row if isinstance(value, str) and value in units.si]
    shown = list(row)
    for place, value in enumerate(row):
        at = _unit_of(place, places)
        meant = {(units.unit(quantity), units.scale(quantity)) for quantity in names if units.si[quantity] == row[at]}
        if len(meant) == 1:  # otherwise it is open which of them the numbers are of
            unit, scale = meant.pop()
            shown[place] = unit if place in places else _scaled(value, scale)
    return tuple(shown)


def _scaled(value: Any, scale: float) -> Any:
    return value * scale if isinstance(value, float) else value


# Width of formulas, counted in letters, so that none runs off the page.

WIDEST_FORMULA, WIDEST_MATRIX = 72, 60
"""Largest width in letters of a formula, and of the rows of a symbolic matrix, that fits a page."""


def formula_letters(expression: Any) -> int:
    """Width of a formula, as the number of letters that stand side by side.

    A fraction is as wide as the wider of its halves.

    >>> import sympy
    >>> a, b, c = sympy.symbols("a b c")
    >>> formula_letters(a + b), formula_letters((a + b) / c), formula_letters(1 / (a + 1 / (b + c)))
    (5, 5, 9)
    """
    if expression.is_Add:
        return sum(formula_letters(term) + 3 for term in expression.args) - 3
    if expression.is_Mul:
        above, below = _halves(expression)
        return max(_product(above), _product(below))
    if expression.is_Pow:
        if expression.exp.is_negative:
            return formula_letters(1 / expression)
        return formula_letters(expression.base) + (2 if expression.base.is_Add else 0) + 1
    text = str(expression)
    return len(text.replace("_", "")) if expression.is_Symbol else len(text)


def _halves(product: Any) -> tuple[list[Any], list[Any]]:
    above: list[Any] = []
    below: list[Any] = []
    for factor in product.args:
        if factor.is_Pow and factor.exp.is_negative:
            below.append(1 / factor)
        else:
            above.append(factor)
    return above, below


def _product(factors: list[Any]) -> int:
    return sum(formula_letters(factor) + (2 if factor.is_Add and len(factors) > 1 else 0) for factor in factors)


def matrix_letters(matrix: Any) -> int:
    """Width of a symbolic matrix, as the number of letters from left to right."""
    rows = [[formula_letters(cell) for cell in row] for row in matrix.tolist()]
    return sum(max(column) + 2 for column in zip(*rows, strict=True)) if rows else 0


# LaTeX of a model file's expressions, in the order in which they were written.

SUM, PRODUCT, QUOTIENT, ATOM = 1, 2, 3, 4
PRECEDENCE = {"+": SUM, "-": SUM, "negative": SUM, "*": PRODUCT, "/": QUOTIENT, "**": QUOTIENT}
"""Precedence of an operation in LaTeX, by the sign of the operation; operations not listed bind like names and
numbers."""


def expression_latex(tree: Expression) -> str:
    r"""LaTeX of an expression of parameters, in the order in which it was written.

    >>> from torsionnet.base.expression_reading import scalar
    >>> expression_latex(scalar("I_1 - I_MT")), expression_latex(scalar("pi*G*d**4/(32*L)"))
    ('I_{1} - I_{\\mathrm{MT}}', '\\frac{\\pi G d^{4}}{32 L}')
    >>> expression_latex(scalar("-r_p/(2*(a + b)*3)"))
    '- \\frac{r_{p}}{2 \\left(a + b\\right) \\cdot 3}'
    """
    match tree:
        case Number(value=value):
            return str(value) if isinstance(value, Fraction) and value.denominator == 1 else f"{float(value):.6g}"
        case Name(name=name):
            return symbol_latex(name)
        case Compound("pi"):
            return r"\pi"
        case Compound("negative", (operand,)):
            return f"- {_enclosed(operand, PRODUCT)}"
        case Compound("sqrt", (operand,)):
            return rf"\sqrt{{{expression_latex(operand)}}}"
        case Compound("**", (base, Number(value=exponent))):
            return f"{_enclosed(base, ATOM)}^{{{exponent}}}"
        case Compound("/", (Compound("negative", (above,)), below)):
            return rf"- \frac{{{expression_latex(above)}}}{{{expression_latex(below)}}}"
        case Compound("/", (above, below)):
            return rf"\frac{{{expression_latex(above)}}}{{{expression_latex(below)}}}"
        case Compound("*", (left, right)):
            times = r" \cdot " if _begins_with_number(right) else " "
            return f"{_enclosed(left, PRODUCT)}{times}{_enclosed(right, PRODUCT)}"
        case Compound(sign, (left, right)):
            needed = PRODUCT if sign == "-" or _sign(right) == "negative" else SUM
            return f"{expression_latex(left)} {sign} {_enclosed(right, needed)}"
    raise TypeError(tree)


def _sign(tree: Expression) -> str:
    return tree.sign if isinstance(tree, Compound) else ""


def _begins_with_number(tree: Expression) -> bool:
    if isinstance(tree, Compound) and tree.sign in "+-*/":
        return _begins_with_number(tree.operands[0])
    return isinstance(tree, Number)


def _enclosed(tree: Expression, needed: int) -> str:
    text = expression_latex(tree)
    return text if PRECEDENCE.get(_sign(tree), ATOM) >= needed else rf"\left({text}\right)"
