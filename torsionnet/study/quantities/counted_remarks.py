"""Counter of the warnings of a study by their text, with a bound on the number of texts."""

from __future__ import annotations

from collections import Counter

MOST_REMARKS, OTHERS = 50, "other remarks, which differ in numbers or names"
"""Most different texts of warnings counted, as texts with numbers could be millions, and the text for the rest."""


def remark(known: Counter[str], text: str, count: int) -> None:
    """Count a warning by its text, or beyond :data:`MOST_REMARKS` texts under :data:`OTHERS`.

    >>> texts = Counter({f"text {number}": 1 for number in range(MOST_REMARKS)})
    >>> remark(texts, "one more", 2)
    >>> texts["one more"], texts[OTHERS]
    (0, 2)
    """
    known[text if text in known or len(known) < MOST_REMARKS else OTHERS] += count
