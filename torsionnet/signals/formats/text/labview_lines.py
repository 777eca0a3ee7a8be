"""Lines of LabVIEW's text files, of headers and rows told apart, and the separator of their cells."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from torsionnet.base.delimited.dialect import Dialect
from torsionnet.base.errors import Fault, ModelError, Position
from torsionnet.base.remedies import remedy

FIRST_LINE, END, X_VALUE, COMMENT = "LabVIEW Measurement", "***End_of_Header***", "X_Value", "Comment"
SPECIAL, SPECIAL_END = "***Start_Special***", "***End_Special***"
SEGMENT_KEYS = frozenset({"Channels", "Samples", "Y_Unit_Label", "Y_Dimension", "X_Dimension", "X0", "Delta_X"})
"""Entries that the header of a LabVIEW segment has for every channel, besides Date and Time."""
SEPARATORS = {"tab": "\t", "comma": ",", "semicolon": ";"}
"""Separators of cells by their names in a header of a LabVIEW file."""
_KEYS = SEGMENT_KEYS | {"Date", "Time", X_VALUE}


@dataclass
class HeadedLines:
    """Lines of a text file with their numbers, of which the last one taken can be given back."""

    lines: Iterator[str]
    number: int = 0
    _back: list[str] = field(default_factory=list)

    def take(self) -> str:
        """Next line of the LabVIEW file, an empty text at its end."""
        line = self._back.pop() if self._back else next(self.lines, "")
        self.number += bool(line)
        return line

    def give_back(self, line: str) -> None:
        """Put back the line that was taken last, so that it is read again."""
        self._back.append(line)
        self.number -= 1

    def data(self) -> Iterator[str]:
        """Yield the lines of numbers up to the next header, with blank lines only where more numbers follow."""
        blank = 0
        while line := self.take():
            if line.startswith(SPECIAL):
                while line and not line.startswith(SPECIAL_END):
                    blank, line = blank + 1, self.take()
                blank += bool(line)
            elif not line.strip():
                blank += 1
            elif line.startswith("***") or (line[0].isalpha() and re.split(r"[\t,;]", line)[0].strip() in _KEYS):
                self.give_back(line)
                return
            else:
                yield from ["\n"] * blank
                blank = 0
                yield line


def is_labview(lines: Sequence[str]) -> bool:
    """Whether a text begins as LabVIEW's measurement files do, or has a header with the same entries."""
    keys = {re.split(r"[\t,;]", line.lstrip("\ufeff"), maxsplit=1)[0].strip() for line in lines}
    return bool(lines) and (lines[0].startswith(FIRST_LINE) or END in keys or {"Delta_X", X_VALUE} <= keys)


def dialect_of(lines: Iterable[str], file: str, separator: str | None, decimal: str | None) -> Dialect:
    """Separator and decimal sign that a LabVIEW header gives, unless ``separator`` and ``decimal`` are given."""
    said: dict[str, tuple[int, str]] = {}
    between = "\t"
    for number, line in enumerate(lines, 1):
        found = re.match(r"(Separator|Decimal_Separator|Delta_X|X_Value)([\t,;])\s*([^\t\r\n]*)", line)
        if found:
            between = found[2] if found[1] != "Decimal_Separator" else between
            said.setdefault(found[1], (number, found[3].strip(" ,;") or found[3].strip()))
    number, word = said.get("Separator", (1, ""))
    known = SEPARATORS.get(word.casefold())
    if word and known is None and separator is None:
        raise line_error(f'Separator is "{word}"; expected Tab, Comma or Semicolon', file, number)
    sign = decimal or said.get("Decimal_Separator", (0, "."))[1] or ","
    if sign not in (".", ","):
        raise line_error(f'Decimal_Separator is "{sign}"; expected . or ,', file, said["Decimal_Separator"][0])
    chosen = separator or known or between
    if chosen == sign:
        raise line_error(
            "Separator and Decimal_Separator are the same sign; correct one, or give "
            f"{remedy('separator=')} and {remedy('decimal=')}",
            file,
            number,
        )
    return Dialect(chosen, sign)


def line_error(text: str, file: str, line: int, source: str = "", column: int = 1) -> ModelError:
    """Error on a line of a text file, with the position of that line."""
    position = Position(file, line, column, column + 1, source.rstrip()[:200].replace("\t", " "))
    return ModelError([Fault(text, position=position)], file)
