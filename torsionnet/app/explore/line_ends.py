"""Byte order mark and line ends of a file, which its text in an editor lacks and the stored file has again."""

from __future__ import annotations

import codecs
import re
from collections import Counter
from dataclasses import dataclass
from difflib import SequenceMatcher

_LINE = re.compile("([^\r\n]*)(\r\n|\r|\n|$)")
MOST_COMPARED = 4_000_000
"""Largest product of line counts of two texts that are compared line by line; it takes about a second."""


@dataclass(frozen=True)
class LineEnds:
    r"""Byte order mark and line ends of a file as it was read.

    Lines that stay keep their own ends, new ones get the usual end of the file.

    Examples
    --------
    >>> ends = LineEnds.of("a: 1\r\nb: 2\nc: 3\r\n", has_mark=False)
    >>> ends.usual, ends.given_back("a: 1\nnew: 0\nb: 2\n")
    ('\r\n', 'a: 1\r\nnew: 0\r\nb: 2\n')
    """

    has_mark: bool = False
    lines: tuple[tuple[str, str], ...] = ()
    usual: str = "\n"

    @classmethod
    def of(cls, text: str, *, has_mark: bool) -> LineEnds:
        """Line ends of a text that has been read from a file."""
        lines = _lines(text)
        counted = Counter(end for _, end in lines if end).most_common(1)
        return cls(has_mark, lines, counted[0][0] if counted else "\n")

    def given_back(self, text: str) -> str:
        """Text with the line ends of the file, from one that has none but line feeds."""
        if len({end for _, end in self.lines if end}) <= 1:
            return text if self.usual == "\n" else text.replace("\n", self.usual)
        now = text.split("\n")
        ends = dict(self._kept(now))
        return "".join(f"{line}{ends.get(at, self.usual)}" for at, line in enumerate(now[:-1])) + now[-1]

    def bytes_of(self, text: str) -> bytes:
        """Bytes of the file for a text that has none but line feeds."""
        return (codecs.BOM_UTF8 if self.has_mark else b"") + self.given_back(text).encode()

    def _kept(self, now: list[str]) -> list[tuple[int, str]]:
        """Index of each line that the file had before, and its line end there."""
        before = [line for line, _ in self.lines]
        same = 0
        while same < min(len(before), len(now)) and before[same] == now[same]:
            same += 1
        found = [(at, self.lines[at][1]) for at in range(same)]
        rest, changed = before[same:], now[same:]
        if len(rest) * len(changed) <= MOST_COMPARED:
            for block in SequenceMatcher(None, rest, changed, autojunk=False).get_matching_blocks():
                found += [(same + block.b + k, self.lines[same + block.a + k][1]) for k in range(block.size)]
        return [(at, end) for at, end in found if end]


UNIX = LineEnds()
"""Line ends of a file that does not exist: line feeds, and no byte order mark."""


def plain_line_ends(text: str) -> str:
    r"""Text with line feeds as its only line ends.

    >>> plain_line_ends("a\r\nb\rc\n")
    'a\nb\nc\n'
    """
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _lines(text: str) -> tuple[tuple[str, str], ...]:
    found = [(one[1], one[2]) for one in _LINE.finditer(text)]
    # An empty match stands at the end of every text.
    return tuple(found[:-1] if len(found) > 1 and not found[-2][1] else found)
