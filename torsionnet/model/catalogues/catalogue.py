"""A catalogue: a text file with a row for each size, its columns named as entries, each with its unit."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from torsionnet.core.errors import Position


@dataclass(frozen=True)
class CatalogueCell:
    """A value as a model file would write it, and where it stands; ``has_unit`` tells whether its column has one."""

    column: str
    raw: str
    has_unit: bool
    is_number: bool
    place: Position
    heading: Position


@dataclass(frozen=True)
class CatalogueRow:
    """A row of a catalogue: what it says of one size, its empty cells left out."""

    file: str
    size: str
    cells: tuple[CatalogueCell, ...]
    path: Path = field(default=Path(), compare=False)

    def cell(self, column: str) -> CatalogueCell | None:
        return next((cell for cell in self.cells if cell.column == column), None)

    def __str__(self) -> str:
        return f"{self.file}, size {self.size}"


@dataclass(frozen=True)
class Catalogue:
    """A catalogue in a file, for elements made in Python: ``catalogue=read_catalogue("x.csv"), size="A350"``.

    Attributes
    ----------
    path : Path
    sizes : tuple of str
        The sizes it has, in the order of its rows.
    """

    path: Path
    sizes: tuple[str, ...]
