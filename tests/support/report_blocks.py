"""Blocks, tables and words of a report, as tests ask for them."""

from torsionnet.report.document_tree import (
    BreakableMath,
    Code,
    Details,
    Math,
    NumberText,
    Section,
    Strong,
    TableBlock,
    inlines,
)


def blocks(report, name):
    """Every block of a section, those of sections in it included; numbers in its tables are aligned."""
    stack = [section for section in report.sections if section.name == name]
    listed = []
    while stack:
        block = stack.pop(0)
        if isinstance(block, (Section, Details)):
            stack = [*block.blocks, *stack]
        else:
            listed.append(block)
    for table in of(TableBlock, listed):
        check_alignment(table)
    return listed


def check_alignment(table):
    """Columns of numbers, and no others, are aligned at the point; one of values of all kinds is wide."""
    for place, column in enumerate(table.columns):
        cells = [row[place] for group in table.groups for row in group.rows]
        if column.numeric:
            assert not any(letter.isalpha() for cell in cells for letter in words(cell)), column
        else:
            assert column.wide or not any(isinstance(cell, NumberText) for cell in cells), column


def of(kind, found):
    return [block for block in found if isinstance(block, kind)]


def words(cell):
    """A cell without markup, formulas as they are in LaTeX."""
    return "".join(map(_words, inlines(cell)))


def _words(part):
    match part:
        case Math(latex):
            return latex
        case BreakableMath(parts):
            return " ".join(parts)
        case Strong(text) | Code(text):
            return text
        case NumberText():
            return part.mantissa
    return part


def rows(table):
    return [tuple(words(cell) for cell in row) for group in table.groups for row in group.rows]
