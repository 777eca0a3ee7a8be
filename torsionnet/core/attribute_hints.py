"""Errors of objects and of constructors that say what a name of another program is called here."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, TypeVar

from torsionnet.core.errors import did_you_mean

T = TypeVar("T", bound=type[Any])
_UNEXPECTED = re.compile(r"unexpected keyword argument '(\w+)'")


class AttributeHints:
    """Base class whose objects say, for an attribute that they have not, what to write instead."""

    if not TYPE_CHECKING:  # for type checkers an unknown attribute stays an error

        def __getattr__(self, name: str) -> object:
            if not name.startswith("_") and hasattr(type(self), name):
                return object.__getattribute__(self, name)  # a property that failed tells its own error
            from torsionnet.core.familiar_words import METHODS

            kind = type(self)
            table = next((METHODS[one.__name__] for one in kind.__mro__ if one.__name__ in METHODS), {})
            hint = python_hint(table, name, (one for one in dir(kind) if not one.startswith("_")))
            raise AttributeError(f"{kind.__name__!r} object has no attribute {name!r}{hint}", name=name, obj=self)


def with_argument_hints(cls: T) -> T:
    """Class whose constructor says what was meant by an argument that it does not have.

    >>> import torsionnet as tn
    >>> tn.Shaft("s", ("a", "b"), length=1, diameter=0.1)
    Traceback (most recent call last):
    TypeError: Shaft.__init__() got an unexpected keyword argument 'diameter'; did you mean "outer_diameter"?
    """
    if "__init__" not in vars(cls) or hasattr(vars(cls)["__init__"], "gives_hints"):
        return cls  # that of its base class says it, or it does already
    initialise: Callable[..., None] = cls.__init__

    @functools.wraps(initialise)
    def initialised(self: Any, *args: Any, **entries: Any) -> None:
        try:
            initialise(self, *args, **entries)
        except TypeError as error:
            found = _UNEXPECTED.search(str(error))
            if found is None or found[1] not in entries:
                raise
            from torsionnet.core.familiar_words import familiar_key

            known = [name for name in initialise.__annotations__ if name != "return"]
            meant, advice = familiar_key(found[1], known)
            hint = f"; {advice}" if advice else f'; did you mean "{meant}"?' if meant else did_you_mean(found[1], known)
            raise TypeError(f"{error}{hint}") from None

    initialised.gives_hints = True  # type: ignore[attr-defined]
    cls.__init__ = initialised
    return cls


def python_hint(table: Mapping[str, str], name: str, known: Iterable[str]) -> str:
    """End of the message of an AttributeError, ``; write ...`` or a question, empty where nothing is like the name.

    >>> python_hint({"Disk": "tn.Inertia(name, node, inertia)"}, "Disk", [])
    '; write tn.Inertia(name, node, inertia)'
    >>> python_hint({}, "bodee", ["bode"]), python_hint({}, "__path__", ["bode"])
    ('; did you mean "bode"?', '')
    """
    if name.startswith("_"):
        return ""
    return f"; write {table[name]}" if name in table else did_you_mean(name, known)
