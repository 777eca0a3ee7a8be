"""Tables of text whose columns are aligned by blanks, as of reports and mails."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

_RUN = re.compile(r"\S+(?: \S+)*")
"""Expression of a text without two blanks side by side."""
_NUMBER = re.compile(r"[+\-−]?[\d.,'’]*\d(?:[eE][+\-]?\d+)?")
_RULE = re.compile(r"[\s\-=_+|]*")
"""Expression of a line that only separates others."""
MOST_WORDS = 2
"""Largest number of words of a line with one text that may be a row of a table; more are a sentence."""
CellText = tuple[str, int, int]
"""Text of a cell, its line and its column, from 1."""


@dataclass
class _Column:
    """Characters of a line, from start to end, that may be a column of a table."""

    start: int
    end: int

    def text(self, line: str) -> str:
        return line[self.start : self.end].strip()


def aligned_rows(body: Iterable[tuple[int, str]]) -> list[list[CellText]]:
    """Cells of a table by row, with their line and column; a line that is no row is one cell.

    Columns are apart where all rows have a blank, but for blanks within a heading or a name. Empty where the lines are
    no such table.

    >>> lines = ["Mass of 2020", "Name      J [kg m2]", "Cyl. 1        0,45", "Cyl. 2       14"]
    >>> rows = aligned_rows(enumerate(lines, 1))
    >>> [[text for text, _, _ in row] for row in rows]
    [['Mass of 2020'], ['Name', 'J [kg m2]'], ['Cyl. 1', '0,45'], ['Cyl. 2', '14']]
    """
    lines = [(number, line.replace("\t", " ")) for number, line in body if not _RULE.fullmatch(line)]
    runs = [_RUN.findall(line) for _, line in lines]
    most = max(map(len, runs), default=0)
    # The headings are the longest row without numbers; titles above are no rows.
    heads = [0 if any(map(_NUMBER.fullmatch, texts)) else len(texts) for texts in runs]
    begin = heads.index(max(heads)) if heads else 0
    while begin and 2 * heads[begin - 1] >= most and lines[begin - 1][0] == lines[begin][0] - 1:
        begin -= 1
    table = [line for line, texts in zip(lines[begin:], runs[begin:], strict=True) if _is_row(texts, most)]
    if most < 2 or 2 * len(table) <= len(lines):
        return []
    texts = [line for _, line in table]
    first = next((at for at, line in enumerate(texts) if any(map(_NUMBER.fullmatch, _RUN.findall(line)))), len(texts))
    columns = _joined(_apart(texts), texts[:first], texts[first:])
    inside = {number for number, _ in table}
    return [[_cell(column, number, line) for column in columns] if number in inside
            else [(line.strip(), number, len(line) - len(line.lstrip()) + 1)] for number, line in lines]  # fmt: skip


def _is_row(runs: Sequence[str], most: int) -> bool:
    """Whether a line is a row of a table: of at least half as many texts as the longest, or with a number."""
    if len(runs) == 1:
        return len(runs[0].split()) <= MOST_WORDS and any(map(_NUMBER.fullmatch, runs[0].split()))
    return 2 * len(runs) >= most or any(map(_NUMBER.fullmatch, runs))


def _apart(lines: Sequence[str]) -> list[_Column]:
    """Columns between the places at which every line has a blank."""
    width = max(map(len, lines))
    filled = "".join("x" if any(at < len(line) and line[at] != " " for line in lines) else " " for at in range(width))
    return [_Column(match.start(), match.end()) for match in re.finditer(r"x+", filled)]


def _joined(columns: Sequence[_Column], heads: Sequence[str], below: Sequence[str]) -> list[_Column]:
    """Columns without those that only blanks in a heading, a name or above a number set apart."""
    done = [columns[0]]
    for column in columns[1:]:
        before = done[-1]
        if _belong_together(before, column, heads, below):
            done[-1] = _Column(before.start, column.end)
        else:
            done.append(column)
    return done


def _belong_together(first: _Column, second: _Column, heads: Sequence[str], below: Sequence[str]) -> bool:
    headed = [any(one.text(line) for line in heads) for one in (first, second)]
    filled = [any(one.text(line) for line in below) for one in (first, second)]
    both = [line for line in (*heads, *below) if first.text(line) and second.text(line)]
    if (all(headed) and all(filled)) or any(_NUMBER.fullmatch(first.text(line)) and _NUMBER.fullmatch(second.text(line))
                                            for line in both):  # fmt: skip
        return False
    if not both:
        # A number beside its heading, not below it.
        return headed != [True, True] and filled != [True, True]
    return all("  " not in line[first.start : second.end].strip() for line in both)


def _cell(column: _Column, number: int, line: str) -> CellText:
    text = column.text(line)
    return " ".join(text.split()), number, (line.find(text, column.start) if text else column.start) + 1
