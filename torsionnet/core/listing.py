"""Text of lists of names in a sentence."""

from __future__ import annotations

from collections.abc import Iterable


def comma_list(names: Iterable[object], most: int | None = None, more: str = " and {} more", none: str = "") -> str:
    """Text of names with commas between them, shortened to the first of them where there are many.

    Parameters
    ----------
    names : iterable
        What is named.
    most : int, optional
        How many are named; by default all.
    more : str, optional
        What follows them where there are more, and how many more where it has braces.
    none : str, optional
        What is said where there is nothing to name.

    Examples
    --------
    >>> comma_list("abcd"), comma_list("abcd", 2), comma_list("abcd", 2, ", ..."), comma_list("", none="none")
    ('a, b, c, d', 'a, b and 2 more', 'a, b, ...', 'none')
    """
    words = [str(name) for name in names]
    rest = 0 if most is None else len(words) - most
    return (", ".join(words[:most]) or none) + (more.format(rest) if rest > 0 else "")
