"""Registers of types, each in a file of a package, that import no more files than are asked for."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator, MutableMapping, Sequence
from functools import cached_property
from typing import Generic, TypeVar

T = TypeVar("T")


class TypeRegister(MutableMapping[str, T], Generic[T]):
    """Kind -> type, in the order of the kinds, whatever the order in which files were imported.

    A type puts itself in when its file is imported. A kind that is asked for comes out of the file of that name; where
    there is none, out of the first family that has it. Only if no family has, and when all kinds are listed, every file
    of the package is imported.

    Parameters
    ----------
    package : str
        Full name of the package.
    families : sequence of str
        Files with several types, those first that are asked for most.
    """

    def __init__(self, package: str, families: Sequence[str] = ()) -> None:
        self.package = package
        self.families = families
        self._types: dict[str, T] = {}

    def __getitem__(self, kind: str) -> T:
        if kind not in self._types:
            for file in (kind,) if kind in self._files else self.families:
                self._import(file)
                if kind in self._types:
                    break
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
    def _files(self) -> tuple[str, ...]:
        path = importlib.import_module(self.package).__path__
        return tuple(sorted(module.name for module in pkgutil.iter_modules(path)))

    def _import(self, file: str) -> None:
        importlib.import_module(f"{self.package}.{file}")

    def _import_all(self) -> None:
        for file in self._files:
            self._import(file)
