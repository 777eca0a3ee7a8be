"""A report in other words: its own texts are replaced, names and texts of the model's author are not."""

from __future__ import annotations

from collections.abc import Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace

from torsionnet.report.document_tree import (
    Block,
    Cell,
    Details,
    Facts,
    Heading,
    Inline,
    Listing,
    Paragraph,
    Picture,
    Remark,
    Report,
    Section,
    Strong,
    TableBlock,
    TableGroup,
    Text,
)
from torsionnet.report.wording import Wording

WORDS = {"At", "Comparison", "Kind", "Leading term", "Limit", "Of", "Property", "Quantity", "Type"}
"""Columns in which the report's own words stand, not those of the model."""


@dataclass(frozen=True)
class Reworded:
    """Replaces texts; ``names`` are those of the model that stand in headings."""

    wording: Wording
    names: AbstractSet[str] = frozenset()

    def report(self, report: Report) -> Report:
        return replace(
            report,
            subtitle=self.wording(report.subtitle),
            facts=self.facts(report.facts),
            sections=tuple(map(self.section, report.sections)),
        )

    def section(self, section: Section) -> Section:
        return replace(section, title=self.text(section.title), blocks=tuple(map(self.block, section.blocks)))

    def block(self, block: Block) -> Block:
        match block:
            case Section():
                return self.section(block)
            case Paragraph(text) | Remark(text=text):
                return replace(block, text=self.text(text))
            case Listing(items):
                return Listing(tuple(map(self.text, items)))
            case Facts():
                return self.facts(block)
            case TableBlock():
                return self.table(block)
            case Picture():
                return replace(block, caption=self.text(block.caption))
            case Details(title, blocks, instead):
                return Details(self.text(title), tuple(map(self.block, blocks)), self.text(instead))
        return block

    def facts(self, facts: Facts) -> Facts:
        return Facts(tuple((self.wording(word), text) for word, text in facts.rows))

    def table(self, table: TableBlock) -> TableBlock:
        own = [self.has_words(table, column) for column in table.columns]
        more = [(self.wording(f"… and {table.more} more"),)] if table.more else []
        return replace(
            table,
            caption=self.text(table.caption),
            columns=tuple(map(self.heading, table.columns)),
            groups=tuple(TableGroup(self.rows(group.rows, own), self.cell(group.title)) for group in table.groups),
            notes=(*map(self.text, table.notes), *more),
            more=0,
        )

    @staticmethod
    def has_words(table: TableBlock, column: Heading) -> bool:
        """Whether words of the report stand in a column, as in the description of a mode."""
        return column.text in WORDS or (table.columns[0].text, column.text) == ("Mode", "Description")

    def rows(self, rows: tuple[tuple[Cell, ...], ...], own: Sequence[bool]) -> tuple[tuple[Cell, ...], ...]:
        return tuple(
            tuple(self.cell(cell) if words else cell for cell, words in zip(row, own, strict=True)) for row in rows
        )

    def heading(self, heading: Heading) -> Heading:
        return heading if heading.text in self.names else replace(heading, text=self.cell(heading.text))

    def text(self, text: Text) -> Text:
        return tuple(map(self.part, text))

    def cell(self, cell: Cell) -> Cell:
        return self.text(cell) if isinstance(cell, tuple) else self.part(cell)

    def part(self, part: Inline) -> Inline:
        match part:
            case str():
                return self.wording(part)
            case Strong(text):
                return Strong(self.wording(text))
        return part
