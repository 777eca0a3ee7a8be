"""Numbers of sections, tables, figures and formulas, the same in every file format of a report."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from torsionnet.report.document_tree import Block, Details, Formula, Picture, Section, TableBlock


@dataclass(frozen=True)
class NumberedBlock:
    """Block of a report with its number and the blocks inside it.

    Attributes
    ----------
    block : Block
    number : str
        ``2.1`` of a section, ``3`` of a table, figure or formula, else empty.
    inner : tuple of NumberedBlock
        What stands in a section, or folded away.
    """

    block: Block
    number: str = ""
    inner: tuple[NumberedBlock, ...] = ()

    @property
    def kind(self) -> str:
        """Name of the block's class, by which templates choose what to write."""
        return type(self.block).__name__

    @property
    def level(self) -> int:
        """Depth of a block's section in the report, as the number of sections around it."""
        return self.number.count(".")


def number_blocks(blocks: Sequence[Block], *, folds: bool = False) -> tuple[NumberedBlock, ...]:
    """Blocks of a report with their numbers; without ``folds`` the blocks that are folded away are left out."""
    return _Numbers(Counter(), folds).of(blocks)


@dataclass(frozen=True)
class _Numbers:
    """Counter of tables, figures and formulas in the order of the text.

    What is folded away counts for itself, after an S: paper, which leaves it out, has the same numbers without it.
    """

    counts: Counter[str]
    folds: bool
    series: str = ""

    def of(self, blocks: Sequence[Block], above: str = "") -> tuple[NumberedBlock, ...]:
        found, sections = [], 0
        for block in blocks:
            if isinstance(block, Section):
                sections += 1
                number = f"{above}{sections}"
                found.append(NumberedBlock(block, number, self.of(block.blocks, f"{number}.")))
            elif isinstance(block, Details):
                folded = _Numbers(self.counts, self.folds, "S").of(block.blocks) if self.folds else ()
                found.append(NumberedBlock(block, inner=folded))
            elif isinstance(block, TableBlock | Picture | Formula):
                what = self.series + type(block).__name__
                self.counts[what] += 1
                found.append(NumberedBlock(block, f"{self.series}{self.counts[what]}"))
            else:
                found.append(NumberedBlock(block))
        return tuple(found)
