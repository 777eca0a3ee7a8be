"""Edits of the elements and values of a model text, whose comments, order and spacing stay."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from torsionnet.core.entries.spec import Json
from torsionnet.core.errors import Path, UsageError
from torsionnet.text.text_edits import TextEdit
from torsionnet.text.text_faults import LocatedFault


@dataclass(frozen=True)
class Removal:
    """Edits that remove an element from a model text, and the faults that the text would have then."""

    edits: tuple[TextEdit, ...]
    faults: tuple[LocatedFault, ...]


def value_edit(text: str, path: Path, value: Json, file: str = "") -> list[TextEdit]:
    """Edits that give an entry of a model text another value; UsageError where that cannot be."""
    del text, path, value, file
    raise UsageError("values cannot be set yet")


def inserted_element(
    text: str, name: str, entries: Mapping[str, Json], after: str | None = None, file: str = ""
) -> list[TextEdit]:
    """Edits that insert an element into a model text, after another one or as the last."""
    del text, name, entries, after, file
    raise UsageError("elements cannot be inserted yet")


def without_element(text: str, name: str, file: str = "") -> Removal:
    """Edits that remove an element with its comments, and what still names it as faults of the new text."""
    del text, name, file
    raise UsageError("elements cannot be removed yet")
