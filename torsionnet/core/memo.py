"""Cache of results that are computed once and kept beside frozen values."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import TypeVar

T = TypeVar("T")


class Memo:
    """Cache of results, by their type and a key, that copies of a value share; whoever shares the memo shares them.

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


RECENT_RESULTS, RECENT_BYTES = 300, 100_000_000
"""Largest number of recent results kept, and their largest size together in bytes: a few hundred sets of modes, or the
responses of some conditions."""


class RecentResults:
    """Recent results by their type and a key, kept up to a number and a size in bytes.

    What was not asked for longest goes first.
    """

    def __init__(self) -> None:
        self._results: OrderedDict[tuple[type, Hashable], tuple[object, int]] = OrderedDict()
        self._bytes = 0

    def once(self, kind: type[T], key: Hashable, make: Callable[[], T], size: Callable[[T], int]) -> T:
        """Result of this type for the key, made where none is kept; ``size`` gives the bytes of a new one.

        Examples
        --------
        >>> recent = RecentResults()
        >>> recent.once(str, 3, lambda: "worked out", len), recent.once(str, 3, lambda: "not again", len)
        ('worked out', 'worked out')
        """
        known, _ = self._results.get((kind, key), (None, 0))
        if isinstance(known, kind):
            self._results.move_to_end((kind, key))
            return known
        found = make()
        taken = size(found)
        if taken <= RECENT_BYTES:
            self._results[kind, key] = found, taken
            self._bytes += taken
        while len(self._results) > RECENT_RESULTS or self._bytes > RECENT_BYTES:
            _, (_, freed) = self._results.popitem(last=False)
            self._bytes -= freed
        return found
