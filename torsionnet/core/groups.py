"""Connected groups of names, joined one pair after the other (union-find)."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import Generic, TypeVar

T = TypeVar("T", bound=Hashable)


class Groups(Generic[T]):
    """Connected groups of names (union-find); a name that was never joined is alone.

    ``home`` has the group of every name mentioned; in it, those of the first of a join stand before the others.

    Examples
    --------
    >>> parts = Groups(["motor", "wheel", "pump"])
    >>> parts.join("wheel", "motor"), parts.join("motor", "wheel")
    (True, False)
    >>> parts.groups(), parts.of("motor")[0]
    ([['wheel', 'motor'], ['pump']], 'wheel')
    """

    def __init__(self, names: Iterable[T] = ()) -> None:
        self.home: dict[T, list[T]] = {name: [name] for name in names}

    def of(self, name: T) -> list[T]:
        """Group in which a name is, as a list."""
        return self.home.setdefault(name, [name])

    def join(self, first: T, *others: T) -> bool:
        """Merge the groups of these names, and return whether all were apart before.

        False if some of them were together before.
        """
        self.of(first)
        were_apart = [self._joined(first, other) for other in others]
        return all(were_apart)

    def _joined(self, first: T, second: T) -> bool:
        one, two = self.of(first), self.of(second)
        if one is two:
            return False
        if len(one) < len(two):  # the smaller ones move, so that no name moves more than log n times
            moved, kept = one, two
            kept[:0] = moved
        else:
            moved, kept = two, one
            kept += moved
        self.home.update(dict.fromkeys(moved, kept))
        return True

    def groups(self) -> list[list[T]]:
        """List of all groups of connected names, in the order in which their names were first mentioned."""
        return list({id(group): group for group in self.home.values()}.values())
