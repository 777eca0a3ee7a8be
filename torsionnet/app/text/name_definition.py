"""Definition of what a model text names at a place, and the other places that name it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from torsionnet.app.text.named_places import NamedPlace, named_places
from torsionnet.app.text.text_edits import TextSpan


def place_at(places: Iterable[NamedPlace], offset: int) -> NamedPlace | None:
    """Place of which the name stands at an offset or ends there, None if there is none."""
    return next((one for one in places if one.span.start <= offset <= one.span.end), None)


def definition(text: str, offset: int, file: str = "", folder: Path | None = None) -> TextSpan | None:
    """Stretch where the thing named at an offset is defined, None where nothing is named or it is defined elsewhere."""
    places = named_places(text, file, folder)
    found = place_at(places, offset)
    same = (one.span for one in places if found is not None and one.is_definition and one.home == found.home)
    return next(same, None)


def references(text: str, offset: int, file: str = "", folder: Path | None = None) -> list[TextSpan]:
    """Stretches that name the same thing as the one at an offset, its definition included, in the order of the text."""
    places = named_places(text, file, folder)
    found = place_at(places, offset)
    return [] if found is None else [one.span for one in places if one.home == found.home]
