"""Declarations of command-line arguments as fields of a class.

Option words, type and help stand beside the name of the value.

The type of a field implies a flag, a repeatable or required option, or a number. An option of several commands is a
constant in ``app/cli/options.py``; options that go together are a class of their own, and a field of that class.

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
    """Settings from which a field of a class becomes a :class:`click.Option` or :class:`click.Argument`."""

    def __init__(self, makes: type[click.Parameter], words: tuple[str, ...], settings: dict[str, Any]) -> None:
        self.makes, self.words, self.settings = makes, words, settings

    def parameter(self, name: str, hint: Any) -> click.Parameter:
        """Click option or argument made from the settings, whose value has the name given.

        ``hint`` is the type of the field.
        """
        return self.makes([*self.words, name], **{**self._implied(hint), **self.settings})

    def default(self, hint: Any) -> Any:
        """Value of the field if its option is not on the command line."""
        return self.settings.get("default", () if get_origin(hint) is tuple else False if hint is bool else None)

    def _implied(self, hint: Any) -> dict[str, Any]:
        """Settings of click that follow from the type of the field, by name."""
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
    """Declaration of a field as an option with its words, as ``--seed``.

    Settings are those of :class:`click.Option`.
    """
    return Declaration(click.Option, words, settings)


def argument(metavar: str, **settings: Any) -> Any:
    """Declaration of a field as a positional argument, shown in the help by its metavar.

    Settings are those of :class:`click.Argument`.
    """
    return Declaration(click.Argument, (), {"metavar": metavar, **settings})


class Arguments:
    """Base of classes whose fields are command-line arguments; fields that are not given have their defaults."""

    def __init__(self, **values: Any) -> None:
        for name, hint, declared in _fields(type(self)):
            if declared is None:
                vars(self)[name] = hint(**values)
            else:
                vars(self)[name] = values.get(name, declared.default(hint))


def parameters(declared: type[Arguments]) -> Iterator[click.Parameter]:
    """Click options and arguments of a class of arguments, those of base classes first."""
    for name, hint, one in _fields(declared):
        if one is None:
            yield from parameters(hint)
        else:
            yield one.parameter(name, hint)


def _fields(declared: type[Arguments]) -> Iterator[tuple[str, Any, Declaration | None]]:
    """Name, type and declaration of each field of a class of arguments.

    None as the declaration of a field that is a class of arguments.
    """
    for name, hint in get_type_hints(declared).items():
        found = getattr(declared, name, None)
        if isinstance(found, Declaration):
            yield name, hint, found
        elif isinstance(hint, type) and issubclass(hint, Arguments):
            yield name, hint, None
