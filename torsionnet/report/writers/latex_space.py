r"""Space on a page that a block needs at least in LaTeX, so that no heading stands alone at the end of a page."""

from __future__ import annotations

from torsionnet.report.document_tree import (
    Block,
    Equations,
    Facts,
    Formula,
    Math,
    Paragraph,
    Picture,
    Section,
    TableBlock,
)
from torsionnet.report.writers.latex_columns import table_pieces

HEADING_LINES, CAPTION_LINES, TABLE_HEAD_LINES = 3.5, 2.5, 2.0
"""Heights, in lines, of a heading with its room, of a caption, and of the head and foot of a LaTeX table."""
MOST_UNBROKEN_ROWS, ROWS_BELOW_HEADING = 14, 6
"""Largest number of rows of a LaTeX table on one page, and rows of a longer one that stay below its heading."""
LETTERS_PER_LINE, PARAGRAPH_LINES, OTHER_LINES = 100, 3, 2
"""Number of letters in a line of LaTeX, and of lines that a paragraph or another block needs at least."""
LINE_POINTS, PAGE_POINTS, MOST_LINES = 12.0, 483.0, 48.0
"""Height of a line and width of a page in points, and number of lines that a figure fills at most."""


def room_command(block: Block) -> str:
    """LaTeX command that begins a new page if less is left of the page than the block needs."""
    return rf"\room{{{lines_needed(block):.0f}\baselineskip}}" + "\n"


def lines_needed(block: Block) -> float:
    """Height, in lines, that a block needs at least on the page on which it begins."""
    if isinstance(block, Section):
        return HEADING_LINES + (_beginning(block.blocks) if block.blocks else 0)
    if isinstance(block, TableBlock):
        rows = [row for group in block.groups for row in group.rows]
        lines = sum(
            max(map(_lines, row), default=1)
            for row in (rows if len(rows) <= MOST_UNBROKEN_ROWS else rows[:ROWS_BELOW_HEADING])
        )
        parts = table_pieces(block)
        head = TABLE_HEAD_LINES + max((len(heading) for heading in parts[0].headings), default=1)
        return min(CAPTION_LINES + head + lines, MOST_LINES)
    if isinstance(block, Picture):
        width, height = (72 * float(size) for size in block.figure.get_size_inches())
        return min(height * min(1.0, PAGE_POINTS / width) / LINE_POINTS, MOST_LINES) + CAPTION_LINES
    if isinstance(block, Paragraph):
        return PARAGRAPH_LINES
    if isinstance(block, (Formula, Equations, Facts)):
        return 2 * PARAGRAPH_LINES
    return OTHER_LINES


def _beginning(blocks: tuple[Block, ...]) -> float:
    """Height, in lines, of the first block, and of the next one's beginning if the first is a sentence on it."""
    first = lines_needed(blocks[0])
    if isinstance(blocks[0], Paragraph) and len(blocks) > 1 and not isinstance(blocks[1], Picture):
        first += min(lines_needed(blocks[1]), ROWS_BELOW_HEADING + CAPTION_LINES + TABLE_HEAD_LINES)
    return first


def _lines(cell: object) -> float:
    """Height of a table cell in lines: rows of a matrix, or lines of a text that breaks."""
    if isinstance(cell, Math) and "matrix" in cell.latex:
        return 1.3 * (cell.latex.count(r"\\") + 1) + 1
    text = "".join(part for part in cell if isinstance(part, str)) if isinstance(cell, tuple) else cell
    return 1.15 * (1 + len(text) // (LETTERS_PER_LINE // 2)) if isinstance(text, str) else 1.15
