"""Arguments of a command as fields of a class: words, type and help stand beside the name that holds the value.

What the type of a field says already (a flag, repeatable, required, a number) is not said again. An option of several
commands is a constant in ``cli/options.py``; several that go together are a class of their own, and a field of that.

>>> class Run(Arguments):
...     seed: int | None = option("--seed", type=int)
...     names: tuple[str, ...] = option("--name")
>>> [one.opts for one in parameters(Run)], Run(seed=3).names
([['--seed'], ['--name']], ())
"""

from __future__ import annotations

import types
from collections.abc import Iterator
from typing import Any, get_args, get_origin, get_type_hints

import click


class Declaration:
    """What :class:`click.Option` or :class:`click.Argument` are made with."""

    def __init__(self, makes: type[click.Parameter], words: tuple[str, ...], settings: dict[str, Any]) -> None:
        self.makes, self.words, self.settings = makes, words, settings

    def parameter(self, name: str, hint: Any) -> click.Parameter:
        """What click reads, handed over under the name given."""
        return self.makes([*self.words, name], **{**self._implied(hint), **self.settings})

    def absent(self, hint: Any) -> Any:
        """The value where nothing is said."""
        return self.settings.get("default", () if get_origin(hint) is tuple else False if hint is bool else None)

    def _implied(self, hint: Any) -> dict[str, Any]:
        """What the type of the value says."""
        if self.makes is click.Argument:
            return {"nargs": -1, "required": True} if get_origin(hint) is tuple else {}
        if hint is bool:
            return {"is_flag": True}
        if get_origin(hint) is tuple:
            return {"multiple": True}
        optional = isinstance(hint, types.UnionType)
        number = float if float in (hint, *get_args(hint)) else None
        return {"type": number, "required": not optional and "default" not in self.settings}


def option(*words: str, **settings: Any) -> Any:
    """An option of these words; settings are those of :class:`click.Option`."""
    return Declaration(click.Option, words, settings)


def argument(metavar: str) -> Any:
    """An argument by its place."""
    return Declaration(click.Argument, (), {"metavar": metavar})


class Arguments:
    """Arguments that are handed over together; those that are not given have their defaults."""

    def __init__(self, **values: Any) -> None:
        for name, hint, declared in _fields(type(self)):
            if declared is None:
                vars(self)[name] = hint(**values)
            else:
                vars(self)[name] = values.get(name, declared.absent(hint))


def parameters(declared: type[Arguments]) -> Iterator[click.Parameter]:
    """What click reads for a class of arguments, bases first."""
    for name, hint, one in _fields(declared):
        if one is None:
            yield from parameters(hint)
        else:
            yield one.parameter(name, hint)


def _fields(declared: type[Arguments]) -> Iterator[tuple[str, Any, Declaration | None]]:
    """Names, types, declarations; a field without one is a class of arguments itself."""
    for name, hint in get_type_hints(declared).items():
        found = getattr(declared, name, None)
        if isinstance(found, Declaration):
            yield name, hint, found
        elif isinstance(hint, type) and issubclass(hint, Arguments):
            yield name, hint, None
