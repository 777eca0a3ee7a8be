"""Tables of numbers as CSV, with a description above them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from torsionnet.core.atomic import replacing
from torsionnet.response.recording import FloatArray

PIECE = 20_000
"""Rows that are made into text at a time."""


def write_columns(path: Path, description: str, headings: Sequence[str], columns: Sequence[FloatArray]) -> None:
    """A line of description, one of headings, and the columns beside each other, all digits."""
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="\n") as file:
        file.write(f"# {description}\n{','.join(headings)}\n")
        for first in range(0, len(columns[0]), PIECE):
            rows = zip(*(column[first : first + PIECE].tolist() for column in columns), strict=True)
            file.writelines(",".join(map(repr, row)) + "\n" for row in rows)
