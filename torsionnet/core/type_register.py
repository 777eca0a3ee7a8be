"""Registers of types, each type in a file of a package, that import only the files asked for."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator, MutableMapping, Sequence
from functools import cached_property
from typing import Generic, TypeVar

T = TypeVar("T")


class TypeRegister(MutableMapping[str, T], Generic[T]):
    """Register of types by kind, in alphabetical order, whatever the order in which files were imported.

    A type puts itself in when its file is imported. A kind that is asked for comes out of the file of that name, or of
    the one whose name begins with the kind and ``_of_`` or ``_answer``; where there is none, out of the first family
    that has it. Only if no family has, and when all kinds are listed, every file of the packages is imported.

    Parameters
    ----------
    packages : str or sequence of str
        Full names of the packages.
    families : sequence of str
        Files with several types, those first that are asked for most.
    """

    def __init__(self, packages: str | Sequence[str], families: Sequence[str] = ()) -> None:
        self.packages = (packages,) if isinstance(packages, str) else tuple(packages)
        self.families = families
        self._types: dict[str, T] = {}
        self._complete = False

    def __getitem__(self, kind: str) -> T:
        if kind not in self._types:
            own = [file for file in self._files if file == kind or file.startswith((f"{kind}_of_", f"{kind}_answer"))]
            for file in own or self.families:
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
    def _files(self) -> dict[str, str]:
        """Name of the package that holds each file of types, by file name."""
        return {
            module.name: package
            for package in self.packages
            for module in pkgutil.iter_modules(importlib.import_module(package).__path__)
        }

    def _import(self, file: str) -> None:
        importlib.import_module(f"{self._files[file]}.{file}")

    def _import_all(self) -> None:
        if not self._complete:
            for file in sorted(self._files):
                self._import(file)
            self._complete = True
