"""Cache of results that are computed once and kept beside frozen values."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import TypeVar

T = TypeVar("T")


class Memo:
    """Cache of results by their type and a key; whoever shares the memo shares them.

    Examples
    --------
    >>> memo = Memo()
    >>> memo.once(str, 3, lambda: "worked out"), memo.once(str, 3, lambda: "not again")
    ('worked out', 'worked out')
    """

    def __init__(self) -> None:
        self._kept: dict[tuple[type, Hashable], object] = {}

    def once(self, kind: type[T], key: Hashable, make: Callable[[], T]) -> T:
        """Cached result of this type under the key, computed by ``make`` if there is none.

        Raises
        ------
        TypeError
            The key cannot be hashed.
        """
        known = self._kept.get((kind, key))
        if not isinstance(known, kind):
            known = self._kept[kind, key] = make()
        return known
