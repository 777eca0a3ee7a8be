r"""Tables in LaTeX as ``longtable``, so that long ones break over pages with their head repeated."""

from __future__ import annotations

from collections.abc import Sequence

from torsionnet.report.document_tree import Cell, NumberText, TableBlock, inlines
from torsionnet.report.writers.latex_columns import (
    MATRIX_LETTERS,
    PAGE_LETTERS,
    Columns,
    is_matrix,
    length_name,
    table_pieces,
)
from torsionnet.report.writers.latex_text import breakable, display_math, escaped, inline, number


def table_latex(block: TableBlock, continued: str = "(continued)") -> str:
    """LaTeX of a table with caption, head and notes; one that is too wide for the page goes on below."""
    decimals = [block.decimals(index) for index in range(len(block.columns))]
    lines = []
    for place, columns in enumerate(table_pieces(block)):
        caption = rf"\caption*{{{escaped(continued)}}}" if place else rf"\caption{{{inline(block.caption)}}}"
        lines += _piece(block, columns, caption, decimals)
    return "\n".join([*lines, *(rf"{{\footnotesize {inline(note)}\par}}" for note in block.foot_notes)])


def _piece(block: TableBlock, columns: Columns, caption: str, decimals: Sequence[int]) -> list[str]:
    head = " & ".join(
        _heading(lines, numeric=block.columns[index].numeric)
        for index, lines in zip(columns.indices, columns.headings, strict=True)
    )
    lines = [rf"\begin{{longtable}}{{{columns.spec(block)}}}"]
    lines[:0] = _measured(block, columns, decimals)
    lines += [rf"{caption}\\", r"\toprule", rf"{head} \\", r"\midrule", r"\endfirsthead"]
    lines += [r"\toprule", rf"{head} \\", r"\midrule", r"\endhead", r"\bottomrule", r"\endlastfoot"]
    for number_, group in enumerate(block.groups):
        if group.title:
            lines += [r"\addlinespace"] if number_ else []
            lines.append(rf"\multicolumn{{{len(columns.indices)}}}{{@{{}}l}}{{\textbf{{{inline(group.title)}}}}} \\*")
        lines += [f"{_row(row, columns, decimals)} \\\\{_gap(row)}" for row in group.rows]
    return [*lines, r"\end{longtable}"]


def _measured(block: TableBlock, columns: Columns, decimals: Sequence[int]) -> list[str]:
    """LaTeX lines that measure the columns that do not break, so that one run of pdfTeX is enough.

    What they leave of the line is the room of the columns whose texts break: letters counted are not quite their width.
    """
    lines = []
    left = [r"\linewidth", rf"{2 * (1 - len(columns.indices))}\tabcolsep"]
    for place, (index, width, heading) in enumerate(
        zip(columns.indices, columns.widths, columns.headings, strict=True)
    ):
        if width is None:
            cells = (_cell(cell, decimals[index], None) for cell in block.column(index))
            texts = dict.fromkeys([_heading(heading, numeric=block.columns[index].numeric), *filter(None, cells)])
            lines.append(rf"\measured{{{length_name(place)}}}" + "".join(rf"\widen{{{text}}}" for text in texts))
            left.append(f"-{length_name(place)}")
    if broken := sum(width for width in columns.widths if width is not None):
        most = rf"{broken / PAGE_LETTERS:.3f}\linewidth"
        room = "".join(rf"\addtolength{{\textroom}}{{{length}}}" for length in left)
        lines.append(rf"\setlength{{\textroom}}{{0pt}}{room}\ifdim\textroom>{most}\setlength{{\textroom}}{{{most}}}\fi")
    return lines


def _heading(lines: tuple[Cell, ...], *, numeric: bool) -> str:
    shown = [rf"\textbf{{{inline(line)}}}" for line in lines]
    if len(shown) == 1:
        return shown[0]
    side = "r" if numeric else "l"
    stacked = r" \\ ".join(shown)
    return rf"\begin{{tabular}}[b]{{@{{}}{side}@{{}}}}{stacked}\end{{tabular}}"


def _gap(row: tuple[Cell, ...]) -> str:
    """LaTeX of the vertical room below a table row; a row with a matrix needs some."""
    return "[9pt]" if any(is_matrix(cell) for cell in row) else ""


def _row(row: tuple[Cell, ...], columns: Columns, decimals: Sequence[int]) -> str:
    cells = zip(columns.indices, columns.widths, strict=True)
    return " & ".join(_cell(row[index], decimals[index], width) for index, width in cells)


def _cell(cell: Cell, decimals: int, width: float | None) -> str:
    if isinstance(cell, NumberText):
        return number(cell, decimals)
    if is_matrix(cell):
        return rf"\fitted{{{MATRIX_LETTERS / PAGE_LETTERS:.2f}\linewidth}}{{{display_math(inline(cell)[1:-1])}}}"
    text = inline(cell) if width is None else "".join(map(breakable, inlines(cell)))
    return display_math(text)
