"""Explanation of the word at a place in a model text."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from torsionnet.app.text.explaining.entry_under import entry_under
from torsionnet.app.text.explaining.hover_entries import key_words, value_words
from torsionnet.app.text.explaining.hover_things import thing_words
from torsionnet.app.text.name_definition import place_at
from torsionnet.app.text.named_places import NamesInText
from torsionnet.app.text.text_edits import TextSpan
from torsionnet.base.entries.declared import files_beside


@dataclass(frozen=True)
class Hover:
    """Explanation in Markdown, without HTML, of a stretch of a model text."""

    markdown: str
    span: TextSpan


def hover(text: str, offset: int, file: str = "", folder: Path | None = None) -> Hover | None:
    """Explanation of what stands at an offset of a model text, None where there is nothing to say.

    Of a name what it stands for, of a key what the entry is, of a value what it is in SI units. Catalogues lie in
    ``folder``.

    Examples
    --------
    >>> text = "parameters: {k: 2 kN*m/rad}\\nelements: {shaft: {type: spring, nodes: [a, b], stiffness: 3*k}}"
    >>> print(hover(text, text.index("3*k")).markdown)
    `stiffness`: `3*k` = 6000 N*m/rad
    <BLANKLINE>
    with `k` = 2000 N*m/rad
    """
    names = NamesInText.of(text, file)
    place = place_at(names.places, offset)
    if place is not None:
        words = thing_words(place, names)
        if words:
            return Hover(words, place.span)
    found = entry_under(names, offset)
    if found is None:
        return None
    with files_beside(folder):
        words = key_words(found) if found.on_key else value_words(found)
    return Hover(words, found.span) if words else None
