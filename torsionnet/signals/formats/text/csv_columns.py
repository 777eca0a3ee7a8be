"""Tables of numbers as CSV with a line of description above them, which this module also reads."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from torsionnet.base.atomic import atomic_replacement
from torsionnet.signals.recording import FloatArray

ROWS_PER_PIECE = 20_000
"""Rows of a CSV file that are converted to text at a time, as more take more memory, fewer more time."""


def description_in(comments: Iterable[str], key: str) -> str | None:
    """Description after ``key`` in the first comment of a CSV file that has it; None where none has.

    >>> description_in(["% a comment", '# torsionnet_recording: {"title": "run 7"}'], "torsionnet_recording")
    '{"title": "run 7"}'
    """
    found = (re.match(rf"#\s*{key}:\s*(.*)", comment) for comment in comments)
    return next((match[1] for match in found if match), None)


def write_columns(
    path: Path, key: str, description: str, headings: Sequence[str], columns: Sequence[FloatArray]
) -> None:
    """Write a CSV file of a line of description, headings, and the columns beside each other with all digits."""
    with atomic_replacement(path) as temporary, temporary.open("w", encoding="utf-8", newline="\n") as file:
        file.write(f"# {key}: {description}\n{','.join(headings)}\n")
        for first in range(0, len(columns[0]), ROWS_PER_PIECE):
            rows = zip(*(column[first : first + ROWS_PER_PIECE].tolist() for column in columns), strict=True)
            file.writelines(",".join(map(repr, row)) + "\n" for row in rows)
