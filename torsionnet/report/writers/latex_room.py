r"""How much of a page a block needs at least, so that no heading stands alone at the end of one."""

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
from torsionnet.report.writers.latex_columns import pieces

HEADING, CAPTION, HEAD = 3.5, 2.5, 2.0
"""Lines of a heading with the room around it, of a caption, and of the head and foot of a table."""
FEW, BEGINNING = 14, 6
"""Rows of a table that stays on one page, and of a longer one that stand below its heading."""
LETTERS, PARAGRAPH, OTHER = 100, 3, 2
POINTS, ACROSS, HIGHEST = 12.0, 483.0, 48.0
"""Points of a line, of the width of a page, and lines that a figure fills at most."""


def room(block: Block) -> str:
    """What goes to the next page if less than the block needs is left of this one."""
    return rf"\room{{{needed(block):.0f}\baselineskip}}" + "\n"


def needed(block: Block) -> float:
    """Lines."""
    if isinstance(block, Section):
        return HEADING + (_beginning(block.blocks) if block.blocks else 0)
    if isinstance(block, TableBlock):
        rows = [row for group in block.groups for row in group.rows]
        lines = sum(max(map(_lines, row), default=1) for row in (rows if len(rows) <= FEW else rows[:BEGINNING]))
        parts = pieces(block)
        head = HEAD + max((len(heading) for heading in parts[0].headings), default=1)
        return min(CAPTION + head + lines, HIGHEST)
    if isinstance(block, Picture):
        width, height = (72 * float(size) for size in block.drawn.get_size_inches())
        return min(height * min(1.0, ACROSS / width) / POINTS, HIGHEST) + CAPTION
    if isinstance(block, Paragraph):
        return PARAGRAPH
    if isinstance(block, (Formula, Equations, Facts)):
        return 2 * PARAGRAPH
    return OTHER


def _beginning(blocks: tuple[Block, ...]) -> float:
    """The first block, and the beginning of what a sentence leads to."""
    first = needed(blocks[0])
    if isinstance(blocks[0], Paragraph) and len(blocks) > 1 and not isinstance(blocks[1], Picture):
        first += min(needed(blocks[1]), BEGINNING + CAPTION + HEAD)
    return first


def _lines(cell: object) -> float:
    """Rows of a matrix, or of a text that breaks."""
    if isinstance(cell, Math) and "matrix" in cell.latex:
        return 1.3 * (cell.latex.count(r"\\") + 1) + 1
    text = "".join(part for part in cell if isinstance(part, str)) if isinstance(cell, tuple) else cell
    return 1.15 * (1 + len(text) // (LETTERS // 2)) if isinstance(text, str) else 1.15
