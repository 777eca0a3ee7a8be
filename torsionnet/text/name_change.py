"""Renaming of what a model text names at a place, everywhere in the text."""

from __future__ import annotations

from pathlib import Path as FolderPath

from torsionnet.core.errors import UsageError
from torsionnet.text.name_definition import place_at
from torsionnet.text.named_places import named_places
from torsionnet.text.text_edits import TextEdit, TextSpan


def renamable(text: str, offset: int, file: str = "", folder: FolderPath | None = None) -> TextSpan | None:
    """Stretch of the name at an offset if it can be renamed, else None."""
    found = place_at(named_places(text, file, folder), offset)
    return None if found is None else found.span


def rename(text: str, offset: int, new: str, file: str = "", folder: FolderPath | None = None) -> list[TextEdit]:
    """Edits that give what is named at an offset another name everywhere in the text.

    Raises
    ------
    UsageError
        Nothing is named here, or the new name is none or is taken.
    """
    places = named_places(text, file, folder)
    found = place_at(places, offset)
    if found is None:
        raise UsageError("nothing stands here that has a name; put the cursor on a node, a parameter or an element")
    return [TextEdit(one.span, new) for one in places if one.home == found.home]
