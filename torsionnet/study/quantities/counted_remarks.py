"""What was warned of in a study, counted by its words."""

from __future__ import annotations

from collections import Counter

MOST_REMARKS, OTHERS = 50, "other remarks, which differ in numbers or names"


def remark(known: Counter[str], text: str, count: int = 1) -> None:
    """Count a remark; where there are many already, only that there are others.

    >>> texts = Counter({f"text {number}": 1 for number in range(MOST_REMARKS)})
    >>> remark(texts, "one more", 2)
    >>> texts["one more"], texts[OTHERS]
    (0, 2)
    """
    known[text if text in known or len(known) < MOST_REMARKS else OTHERS] += count
