"""Walk over the blocks of a report, the same for all formats: what stands where and its number are decided here alone.

A format is a :class:`BlockWriter` that says how each kind of block looks. Sections, tables, figures and formulas have
the same numbers in every format.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from torsionnet.report.document_tree import (
    Block,
    BreakableMath,
    Details,
    Equations,
    Facts,
    Formula,
    Listing,
    Paragraph,
    Picture,
    Remark,
    Section,
    TableBlock,
    Text,
    TitleTable,
)
from torsionnet.report.wording import Wording
from torsionnet.report.writers.table_layout import InlineWriter, TableLayout


@dataclass(frozen=True)
class CountedLabel:
    """Label of a table or figure: its kind, the word for it in the report's language, and its number."""

    kind: str
    word: str
    number: str

    def __str__(self) -> str:
        return f"{self.word} {self.number}"


class BlockWriter(ABC):
    """Writer of the blocks of a report in one format, one after the other in the order of the text.

    Attributes
    ----------
    inline : InlineWriter
        Writer of the texts inside a line.
    word : Wording
        Words of the report's language.
    """

    inline: InlineWriter

    def __init__(self, word: Wording) -> None:
        self.word = word
        self._counts: Counter[str] = Counter()

    def blocks(self, blocks: Sequence[Block], above: str = "", series: str = "") -> str:
        """Text of blocks in the format; ``above`` stands before the numbers of sections, ``series`` before others."""
        written, sections = [], 0
        for block in blocks:
            sections += isinstance(block, Section)
            written.append(self._block(block, f"{above}{sections}", series))
        return self.joined(written)

    def _block(self, block: Block, section: str, series: str) -> str:
        match block:
            case Section():
                heading = self.heading(block, section, section.count("."))
                return self.section(block, heading, self.blocks(block.blocks, f"{section}.", series))
            case Paragraph(text):
                return self.paragraph(text)
            case Listing(items):
                return self.listing(items)
            case Facts(rows):
                return self.facts(rows)
            case Remark(kind, text):
                return self.remark(kind, self.word(kind.capitalize()), text)
            case Formula(latex):
                return self.formula(latex, self._number("Formula", series))
            case Equations(rows):
                return self.equations(rows)
            case TableBlock():
                return self.table(TableLayout(block), self._label("Table", series))
            case Picture():
                return self.picture(block, self._label("Figure", series))
            case Details():
                return self.details(block)

    def _label(self, kind: str, series: str) -> CountedLabel:
        return CountedLabel(kind, self.word(kind), self._number(kind, series))

    def _number(self, kind: str, series: str) -> str:
        self._counts[series + kind] += 1
        return f"{series}{self._counts[series + kind]}"

    def details(self, block: Details) -> str:
        """Long part that a page folds away; on paper the sentence that takes its place."""
        return self.paragraph(block.instead)

    def folded(self, block: Details) -> str:
        """Blocks of a long part for a page that folds it away.

        Its tables, figures and formulas count for themselves, after an S: paper, which leaves them out, has the same
        numbers without them.
        """
        return self.blocks(block.blocks, series="S")

    def joined(self, written: Sequence[str]) -> str:
        """Blocks one after the other."""
        return "\n\n".join(written)

    def section(self, _block: Section, heading: str, inner: str, /) -> str:
        """Section of its heading and the blocks in it."""
        return heading + inner

    @abstractmethod
    def heading(self, block: Section, number: str, level: int, /) -> str:
        """Heading of a section with its number, as 2.1; ``level`` counts the sections around it."""

    @abstractmethod
    def paragraph(self, text: Text) -> str:
        """Paragraph of text."""

    @abstractmethod
    def listing(self, items: Sequence[Text]) -> str:
        """List of points."""

    @abstractmethod
    def facts(self, rows: Sequence[tuple[str, Text]]) -> str:
        """Terms with what is to be said on each."""

    @abstractmethod
    def remark(self, kind: str, word: str, text: Text, /) -> str:
        """Remark of a kind, error, warning or note, with the word for it."""

    @abstractmethod
    def formula(self, latex: str, number: str, /) -> str:
        """Numbered formula on a line of its own."""

    @abstractmethod
    def equations(self, rows: Sequence[BreakableMath]) -> str:
        """Long equations one below the other."""

    @abstractmethod
    def table(self, layout: TableLayout, label: CountedLabel, /) -> str:
        """Table with its caption and notes."""

    @abstractmethod
    def picture(self, block: Picture, label: CountedLabel, /) -> str:
        """Figure with its caption."""

    @abstractmethod
    def title_block(self, block: TitleTable) -> str:
        """Title block with its fields, its revisions and the lines to sign."""
