r"""Tables in LaTeX: ``longtable``, so that long ones break over pages with their head repeated."""

from __future__ import annotations

import re
from collections.abc import Sequence

from torsionnet.document.tree import Cell, Code, Heading, Inline, Math, Number, Strong, Table, Terms, inlines
from torsionnet.document.writers.latex_text import displayed, escaped, inline, number

PAGE, FEWEST, GAP = 104, 14, 2
"""Letters across the page in the size of tables, of the narrowest wide column, and of the gap between two."""

_MARKUP = re.compile(r"(begin|end)\{bmatrix\}|\\[a-zA-Z]+|[{}_^~\\ &]")


def table_latex(block: Table) -> str:
    """A table with caption, head and notes."""
    decimals = [_decimals(block, index) for index in range(len(block.columns))]
    head = " & ".join(rf"\textbf{{{_heading(column)}}}" for column in block.columns)
    lines = [rf"\begin{{longtable}}{{{_spec(block)}}}"]
    lines += [rf"\caption{{{inline(block.caption)}}}\\", r"\toprule", rf"{head} \\", r"\midrule", r"\endfirsthead"]
    lines += [r"\toprule", rf"{head} \\", r"\midrule", r"\endhead", r"\bottomrule", r"\endlastfoot"]
    for number_, group in enumerate(block.groups):
        if group.title:
            lines += [r"\addlinespace"] if number_ else []
            lines.append(rf"\multicolumn{{{len(block.columns)}}}{{@{{}}l}}{{\textbf{{{inline(group.title)}}}}} \\*")
        lines += [f"{_row(row, decimals)} \\\\{_gap(row)}" for row in group.rows]
    lines.append(r"\end{longtable}")
    notes = [*map(inline, block.notes), *([escaped(f"… and {block.more} more")] if block.more else [])]
    return "\n".join([*lines, *(rf"{{\footnotesize {note}\par}}" for note in notes)])


def _heading(column: Heading) -> str:
    unit = f" [{column.unit}]" if column.unit and column.unit != "–" else ""
    return inline(column.text) + escaped(unit)


def _gap(row: tuple[Cell, ...]) -> str:
    """Matrices need room below them."""
    return "[7pt]" if any(isinstance(cell, Math) and "matrix" in cell.latex for cell in row) else ""


def _row(row: tuple[Cell, ...], decimals: Sequence[int]) -> str:
    return " & ".join(_cell(cell, places) for cell, places in zip(row, decimals, strict=True))


def _cell(cell: Cell, decimals: int) -> str:
    return number(cell, decimals) if isinstance(cell, Number) else displayed(inline(cell))


def _decimals(block: Table, index: int) -> int:
    return max((cell.decimals_shown for cell in _column(block, index) if isinstance(cell, Number)), default=0)


def _column(block: Table, index: int) -> list[Cell]:
    return [row[index] for group in block.groups for row in group.rows]


def _spec(block: Table) -> str:
    """Columns as wide as what stands in them; wide ones share what is left."""
    natural = [_width(block, index) for index in range(len(block.columns))]
    fixed = {index for index, column in enumerate(block.columns) if not column.wide}
    room = PAGE - GAP * len(natural)
    if sum(natural) <= room:
        return "@{}" + "".join("r" if column.numeric else "l" for column in block.columns) + "@{}"
    left = max(room - sum(natural[index] for index in fixed), FEWEST * (len(natural) - len(fixed)))
    if len(fixed) == len(natural):  # nothing gives way by itself: the widest text does
        widest = max((i for i, column in enumerate(block.columns) if not column.numeric), key=lambda i: natural[i])
        fixed, left = fixed - {widest}, max(room - sum(natural) + natural[widest], FEWEST)
    wanted = sum(natural[index] for index in range(len(natural)) if index not in fixed)
    parts = []
    for index, column in enumerate(block.columns):
        share = left * natural[index] / wanted / (PAGE * 1.02) if wanted else 0
        narrow = "r" if column.numeric else "l"
        parts.append(narrow if index in fixed else rf">{{\raggedright\arraybackslash}}p{{{share:.3f}\linewidth}}")
    return "@{}" + "".join(parts) + "@{}"


def _width(block: Table, index: int) -> int:
    heading = block.columns[index]
    title = len(_shown(heading.text)) + (len(heading.unit) + 3 if heading.unit else 0)
    return max([title, *(len(_shown(cell)) for cell in _column(block, index))])


def _shown(cell: Cell) -> str:
    """Roughly what a cell looks like, for counting letters."""
    return "".join(map(_letters, inlines(cell)))


def _letters(part: Inline) -> str:
    match part:
        case Math(latex):
            return max((re.sub(_MARKUP, "", row) for row in latex.split(r"\\")), key=len)
        case Terms(parts):
            return "   ".join(_letters(Math(latex)) for latex in parts)
        case Strong(text) | Code(text):
            return text
        case Number():
            return part.mantissa + ("·10^-9" if part.exponent is not None else "")
    return part
