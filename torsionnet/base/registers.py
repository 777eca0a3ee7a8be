"""Registers of types, each type in a file of a package, that import only the files asked for.

Here as well: cache of results that are computed once and kept beside frozen values; connected groups of names, joined
one pair after the other (union-find); values of a frozen object that are settled while it is made.
"""

from __future__ import annotations

import importlib
import pkgutil
import warnings
from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, MutableMapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any, Generic, TypeVar

from torsionnet.base.errors import TorsionnetWarning

T = TypeVar("T")


def settle(made: object, /, **values: Any) -> None:
    """Store values in the fields of a frozen dataclass, from its ``__post_init__`` or in a copy that is being made.

    What follows from the arguments, as the exact fraction of a float, has to be stored once. A frozen dataclass refuses
    every assignment, also its own, and Python has no other way in ``__post_init__`` than this one.
    """
    for name, value in values.items():
        object.__setattr__(made, name, value)


class TypeRegister(MutableMapping[str, T], Generic[T]):
    """Register of types by kind, in alphabetical order, whatever the order in which files were imported.

    A type puts itself in when its file is imported. A kind that is asked for comes out of the file of that name, or of
    its family; only if there is neither, and when all kinds are listed, every file of the packages is imported.

    Parameters
    ----------
    packages : str or sequence of str
        Full names of the packages.
    families : mapping from str to sequence of str
        Kinds in files of other names, by the file.
    group : str
        Group of entry points by which other packages add types, named as their kinds; empty: none do.
    """

    def __init__(
        self,
        packages: str | Sequence[str],
        families: Mapping[str, Sequence[str]] = MappingProxyType({}),
        group: str = "",
    ) -> None:
        self.packages = (packages,) if isinstance(packages, str) else tuple(packages)
        self.families = {kind: file for file, kinds in families.items() for kind in kinds}
        self.group = group
        self._types: dict[str, T] = {}
        self._complete = False

    def __getitem__(self, kind: str) -> T:
        file = self.families.get(kind, kind)
        if kind not in self._types and file in self._files:
            importlib.import_module(f"{self._files[file]}.{file}")
        if kind not in self._types:
            self._import_all()
        return self._types[kind]

    def __setitem__(self, kind: str, cls: T) -> None:
        self._types[kind] = cls

    def __delitem__(self, kind: str) -> None:
        del self._types[kind]

    def __iter__(self) -> Iterator[str]:
        self._import_all()
        return iter(sorted(self._types))

    def __len__(self) -> int:
        self._import_all()
        return len(self._types)

    @cached_property
    def _files(self) -> dict[str, str]:
        """Name of the package that holds each file of types, by file name."""
        return {
            module.name: package
            for package in self.packages
            for module in pkgutil.iter_modules(importlib.import_module(package).__path__)
        }

    def _import_all(self) -> None:
        if not self._complete:
            for file in sorted(self._files):
                importlib.import_module(f"{self._files[file]}.{file}")
            self._complete = True
            self._load_added()

    def _load_added(self) -> None:
        """Import what other packages add; one that fails, or that takes the kind of another type, is left out."""
        if not self.group:
            return
        from importlib.metadata import entry_points  # reads the metadata of every installed package

        for point in entry_points(group=self.group):
            known = dict(self._types)
            try:
                loaded = point.load()
            except Exception as error:  # noqa: BLE001  # whatever another package raises
                reason = f"{type(error).__name__}: {error}"
            else:
                taken = [kind for kind, cls in known.items() if self._types[kind] is not cls]
                reason = f'"{taken[0]}" is the kind of a type that is known already' if taken else ""
                if not reason and isinstance(loaded, type) and point.name not in self._types:
                    reason = f'it is no type registered as "{point.name}"'
            if reason:
                self._types = known
                package = point.dist.name if point.dist else point.value
                text = f'"{point.name}" of the package {package} ({point.value}) is left out: {reason}'
                warnings.warn(text, TorsionnetWarning, stacklevel=2)


@dataclass(eq=False, repr=False)
class Memo:
    """Cache of results, by their type and a key, that copies of a value share; whoever shares the memo shares them.

    Examples
    --------
    >>> memo = Memo()
    >>> memo.once(str, 3, lambda: "worked out"), memo.once(str, 3, lambda: "not again")
    ('worked out', 'worked out')
    """

    _kept: dict[tuple[type, Hashable], object] = field(default_factory=dict)

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


class Same:
    """Wrapper of an object for a key of results, equal only to wrappers of the very same object.

    The object need not be hashable.
    """

    def __init__(self, entry: object) -> None:
        self.entry = entry

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and self.entry is other.entry

    def __hash__(self) -> int:
        return id(self.entry)


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
        made = make()
        taken = size(made)
        if taken <= RECENT_BYTES:
            self._results[kind, key] = made, taken
            self._bytes += taken
        while len(self._results) > RECENT_RESULTS or self._bytes > RECENT_BYTES:
            _, (_, freed) = self._results.popitem(last=False)
            self._bytes -= freed
        return made


AnyKey = TypeVar("AnyKey", bound=Hashable)


class Groups(Generic[AnyKey]):
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

    def __init__(self, names: Iterable[AnyKey] = ()) -> None:
        self.home: dict[AnyKey, list[AnyKey]] = {name: [name] for name in names}

    def of(self, name: AnyKey) -> list[AnyKey]:
        """Group in which a name is, as a list."""
        return self.home.setdefault(name, [name])

    def join(self, first: AnyKey, *others: AnyKey) -> bool:
        """Merge the groups of these names, and return whether all were apart before.

        False if some of them were together before.
        """
        were_apart = True
        own = self.of(first)
        for other in others:
            group = self.of(other)
            if group is own:
                were_apart = False
                continue
            if len(own) < len(group):  # the smaller ones move, so that no name moves more than log n times
                moved, own = own, group
                own[:0] = moved
            else:
                moved = group
                own += moved
            self.home.update(dict.fromkeys(moved, own))
        return were_apart

    def groups(self) -> list[list[AnyKey]]:
        """List of all groups of connected names, in the order in which their names were first mentioned."""
        return list({id(group): group for group in self.home.values()}.values())
