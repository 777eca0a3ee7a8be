"""Packages whose names are imported where they are first used, so that starting up stays quick."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping


def names_on_demand(package: str, homes: Mapping[str, str]) -> Callable[[str], object]:
    """The ``__getattr__`` of a package.

    Parameters
    ----------
    package : str
        Its full name.
    homes : mapping
        Public name -> module it comes from; a module that ends in the name itself is what is offered.

    Examples
    --------
    >>> offered = names_on_demand("torsionnet", {"units": "torsionnet.core.units", "Fault": "torsionnet.core.errors"})
    >>> offered("Fault").__name__, offered("units").__name__
    ('Fault', 'torsionnet.core.units')
    """

    def attribute(name: str) -> object:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}", name=name)
        module = importlib.import_module(homes[name])
        return module if homes[name].endswith(f".{name}") else getattr(module, name)

    return attribute
