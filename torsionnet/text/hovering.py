"""Explanation of the word at a place in a model text."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path as FolderPath

from torsionnet.text.text_edits import TextSpan


@dataclass(frozen=True)
class Hover:
    """Explanation in Markdown of a stretch of a model text."""

    markdown: str
    span: TextSpan


def hover(text: str, offset: int, file: str = "", folder: FolderPath | None = None) -> Hover | None:
    """Explanation of what stands at an offset of a model text, None where there is nothing to say."""
    del text, offset, file, folder
    return None
