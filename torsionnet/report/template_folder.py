"""Content of a template folder, which holds the letterhead, style and wording of a company."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from torsionnet.base.errors import ModelError, Position
from torsionnet.report.wording import Wording

STYLE = "style.css"
"""Name of the file with the style sheet in a template folder."""


class TemplateFolderError(ModelError):
    """Error that a file in a template folder cannot be used."""

    outcome = "Nothing was written."


@dataclass(frozen=True)
class TemplateFolder:
    """Texts, images, wording and language that a template folder holds.

    Attributes
    ----------
    path : Path
    texts : mapping
        ``page.html``, ``page.tex``, ``page.md`` and ``style.css``, those that are there.
    images : mapping
        Name -> bytes.
    wording : Wording
    language : str
    """

    path: Path = field(default_factory=Path)
    texts: Mapping[str, str] = field(default_factory=dict)
    images: Mapping[str, bytes] = field(default_factory=dict)
    wording: Wording = field(default_factory=Wording)
    language: str = "en"

    def file(self, name: str) -> str:
        """Path of a file of the template folder as messages name it."""
        return str(self.path / name)

    def position(self, name: str, line: int, column: int = 1) -> Position:
        """Position of a fault in one of the template folder's texts, by line and column from 1."""
        lines = self.texts[name].splitlines()
        source = lines[line - 1] if 0 < line <= len(lines) else ""
        first = column if column > 1 else len(source) - len(source.lstrip()) + 1
        return Position(self.file(name), line, first, len(source) + 1 if column == 1 else column + 1, source)
