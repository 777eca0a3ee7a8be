"""Imports of a package's public names at first use, so that starting up stays quick.

Each package hands a table of its public names to :func:`lazy_exports`. The stub beside it, in which type checkers and
editors find the same names (SPEC 1 of Scientific Python), is written by ``make generate``.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterable, Mapping
from types import ModuleType

from torsionnet.core.attribute_hints import python_hint

TABLES: dict[str, dict[str, str]] = {}
"""Place of each public name, ``module:name`` or a module, by package and name."""


class LazyPackage(ModuleType):
    """Package that keeps a public name for its function where a module beside it has the same name.

    Importing the module plot.bode would otherwise put it in the place of the function plot.bode.
    """

    def __setattr__(self, name: str, value: object) -> None:
        if not (isinstance(value, ModuleType) and ":" in TABLES[self.__name__].get(name, "")):
            super().__setattr__(name, value)


def lazy_exports(
    package: str, homes: Mapping[str, str], modules: Iterable[str] = ()
) -> tuple[list[str], Callable[[str], object], Callable[[], list[str]]]:
    """Return ``__all__``, ``__getattr__`` and ``__dir__`` of a package that imports its names at first use.

    Parameters
    ----------
    package : str
        Its full name.
    homes : mapping
        Public name -> module that it comes from.
    modules : iterable of str
        Modules offered under the last part of their name.

    Examples
    --------
    >>> names, get, _ = lazy_exports("torsionnet.core", {"Fault": "torsionnet.core.errors"}, ["torsionnet.core.units"])
    >>> names, get("Fault").__name__, get("units").__name__
    (['Fault', 'units'], 'Fault', 'torsionnet.core.units')
    """
    table = {name: f"{home}:{name}" for name, home in homes.items()}
    table |= {module.rpartition(".")[2]: module for module in modules}
    TABLES[package] = table
    there = sys.modules[package].__dict__

    def attribute(name: str) -> object:
        if name not in table:
            from torsionnet.core.familiar_words import PYTHON

            hint = python_hint(PYTHON.get(package, {}), name, dir(sys.modules[package]))
            raise AttributeError(f"module {package!r} has no attribute {name!r}{hint}", name=name)
        home, _, inside = table[name].partition(":")
        found = importlib.import_module(home)
        value = there[name] = getattr(found, inside) if inside else found
        return value

    sys.modules[package].__class__ = LazyPackage
    return list(table), attribute, lambda: sorted(table)
