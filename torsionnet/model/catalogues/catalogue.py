"""Catalogue of machine elements, a text file with a row for each size and a column for each entry."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from torsionnet.base.errors import Position


@dataclass(frozen=True)
class CatalogueCell:
    """Value in a catalogue, as a model file would write it, with its position; ``has_unit`` is that of its column."""

    column: str
    raw: str
    has_unit: bool
    is_number: bool
    place: Position
    heading: Position


@dataclass(frozen=True)
class CatalogueRow:
    """Row of a catalogue with the entries of one size: the entries of one size, without its empty cells."""

    file: str
    size: str
    cells: tuple[CatalogueCell, ...]
    path: Path = field(default=Path(), compare=False)

    def cell(self, column: str) -> CatalogueCell | None:
        """Cell of the row in the column of that name, None where there is none."""
        return next((cell for cell in self.cells if cell.column == column), None)

    def __str__(self) -> str:
        return f"{self.file}, size {self.size}"


@dataclass(frozen=True)
class Catalogue:
    """Catalogue in a file, for elements made in Python: ``catalogue=read_catalogue("x.csv"), size="A350"``.

    Attributes
    ----------
    path : Path
    sizes : tuple of str
        The sizes it has, in the order of its rows.
    """

    path: Path
    sizes: tuple[str, ...]
