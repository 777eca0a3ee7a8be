"""Imports of a package's public names at first use, so that starting up stays quick.

Each package hands a table of its public names to :func:`lazy_exports`. The stub beside it, in which type checkers and
editors find the same names (SPEC 1 of Scientific Python), is written by ``make generate``.

Here as well: errors of objects and of constructors that say what a name of another program is called here; showing of
results in a notebook as tables, and as a picture where there is one.

Pauses of Python's garbage collector of reference cycles.

Reading and checking a large model makes a million small objects that all stay, none in a cycle. The collector goes
through all of them again and again as they become more, which takes a third of the time.
"""

from __future__ import annotations

import gc
import importlib
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import wraps
from inspect import getattr_static, signature
from types import FunctionType, MethodType, ModuleType
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, Self, TypeVar

from torsionnet.base.errors import TorsionnetError, did_you_mean


def imported(place: str) -> Any:
    """Object of a module by its place ``module:name``; the module is imported when it is first asked for.

    >>> imported("torsionnet.base.errors:Fault").__name__
    'Fault'
    """
    module, _, name = place.partition(":")
    return getattr(importlib.import_module(module), name)


class AttributeHints:
    """Base class whose objects say, for an attribute that they have not, what to write instead."""

    if not TYPE_CHECKING:  # for type checkers an unknown attribute stays an error

        def __getattr__(self, name: str) -> object:
            if not name.startswith("_") and hasattr(type(self), name):
                return object.__getattribute__(self, name)  # a property that failed tells its own error
            from torsionnet.base.familiar_words import METHODS

            kind = type(self)
            table = next((METHODS[base.__name__] for base in kind.__mro__ if base.__name__ in METHODS), {})
            hint = python_hint(table, name, (own for own in dir(kind) if not own.startswith("_")))
            raise AttributeError(f"{kind.__name__!r} object has no attribute {name!r}{hint}", name=name, obj=self)


class ArgumentHints:
    """Base class whose constructors say, for an argument that they do not know, what was meant.

    >>> import torsionnet as tn
    >>> tn.Shaft("s", ("a", "b"), length=1, diameter=0.1)
    Traceback (most recent call last):
    TypeError: Shaft.__init__() got an unexpected keyword argument 'diameter'; did you mean "outer_diameter"?
    """

    if not TYPE_CHECKING:  # for type checkers the constructor alone says which arguments there are

        def __new__(cls, *_args: object, **entries: object) -> Self:
            known = cls.__init__.__annotations__
            for name in entries:
                if name not in known:
                    hint = _argument_hint(name, [argument for argument in known if argument != "return"])
                    raise TypeError(f"{cls.__name__}.__init__() got an unexpected keyword argument {name!r}{hint}")
            return super().__new__(cls)


def _argument_hint(name: str, known: list[str]) -> str:
    from torsionnet.base.familiar_words import familiar_key

    meant, advice = familiar_key(name, known)
    return f"; {advice}" if advice else f'; did you mean "{meant}"?' if meant else did_you_mean(name, known)


class LazyMethod:
    """Function that is a method of a class, from a module imported at the first call or when the class is asked for it.

    Made of a module's name by naming what is in it, as ``LazyMethod("torsionnet").linear.modes.natural_modes.modes``:
    what type checkers read as the function itself, if they have the module's import.
    """

    def __init__(self, place: str) -> None:
        self._place = place
        self._function: Any = None
        self._hinting: Any = None

    def __getattr__(self, name: str) -> LazyMethod:
        if name.startswith("_"):  # no function is private
            raise AttributeError(name)
        return LazyMethod(f"{self._place}.{name}")

    def __get__(self, instance: object, owner: type | None = None) -> FunctionType | MethodType:
        if self._function is None:
            module, _, name = self._place.rpartition(".")
            method = self._function = getattr(importlib.import_module(module), name)
            own = _parameters(method)

            @wraps(method)  # the signature is that of the method, for inspect and for editors
            def hinting(instance: object, /, *arguments: object, **options: object) -> Any:
                # An argument that it does not take is told with the method that does, or with what was meant.
                for name in options:
                    if name not in own:
                        hint = _method_hint(type(instance), name, own)
                        raise TypeError(f"{method.__name__}() got an unexpected keyword argument {name!r}{hint}")
                return method(instance, *arguments, **options)

            self._hinting = hinting
        return self._function if instance is None else MethodType(self._hinting, instance)


def _method_hint(owner: type, name: str, own: list[str]) -> str:
    """End of the message on an argument that a method does not take: what other does, or what it takes."""
    from torsionnet.base.familiar_words import METHODS, familiar_key

    advice = METHODS.get(owner.__name__, {}).get(name, "")
    meant, _ = familiar_key(name, own)
    lazy = [method for method in dir(owner) if isinstance(getattr_static(owner, method), LazyMethod)]
    takers = [f"{method}()" for method in lazy if name in _parameters(getattr(owner, method))]
    if advice:
        return f"; write {advice}"
    if takers and not meant:
        return f"; it is one of {', '.join(takers)}"
    return _argument_hint(name, own) or f"; it takes {', '.join(own) or 'none'}"


def _parameters(method: Callable[..., Any]) -> list[str]:
    """Names of what a method takes, without the object that it is of."""
    return [*signature(method).parameters][1:]


def python_hint(table: Mapping[str, str], name: str, known: Iterable[str]) -> str:
    """End of the message of an AttributeError, ``; write ...`` or a question, empty where nothing is like the name.

    >>> python_hint({"Disk": "tn.Inertia(name, node, inertia)"}, "Disk", [])
    '; write tn.Inertia(name, node, inertia)'
    >>> python_hint({}, "bodee", ["bode"]), python_hint({}, "__path__", ["bode"])
    ('; did you mean "bode"?', '')
    """
    if name.startswith("_"):
        return ""
    from torsionnet.base.familiar_words import ANYWHERE

    said = table.get(name) or ANYWHERE.get(name)
    return f"; write {said}" if said else did_you_mean(name, known)


TABLES: dict[str, dict[str, str]] = {}
"""Place of each public name, ``module:name`` or a module, by package and name."""


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

    Notes
    -----
    No public name is that of a module in the package, whose import would put the module in its place.

    Examples
    --------
    >>> names, get, _ = lazy_exports("torsionnet.base", {"Fault": "torsionnet.base.errors"}, ["torsionnet.base.units"])
    >>> names, get("Fault").__name__, get("units").__name__
    (['Fault', 'units'], 'Fault', 'torsionnet.base.units')
    """
    table = {name: f"{home}:{name}" for name, home in homes.items()}
    table |= {module.rpartition(".")[2]: module for module in modules}
    TABLES[package] = table
    there = sys.modules[package].__dict__

    def attribute(name: str) -> object:
        if name not in table:
            from torsionnet.base.familiar_words import PYTHON

            hint = python_hint(PYTHON.get(package, {}), name, dir(sys.modules[package]))
            raise AttributeError(f"module {package!r} has no attribute {name!r}{hint}", name=name)
        home, _, inside = table[name].partition(":")
        module = importlib.import_module(home)
        value = there[name] = getattr(module, inside) if inside else module
        return value

    return list(table), attribute, lambda: sorted(table)


MOST_ROWS = 30
"""Largest number of rows of a table in a notebook, as many as fit on a screen."""
DOTS_PER_INCH = 100
"""Resolution of a picture in a notebook in dots per inch, sharp at the size at which it is shown."""


class NotebookTable(Protocol):
    """Interface of a table that a notebook shows, as :class:`torsionnet.base.table.Table`."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def title(self) -> str: ...
    @property
    def rows(self) -> Sequence[Any]: ...
    @property
    def notes(self) -> tuple[str, ...]: ...
    def to_html(self) -> str: ...
    def to_dataframe(self) -> Any: ...


AnyTable = TypeVar("AnyTable", bound=NotebookTable)


class NotebookResult(AttributeHints):
    """Base class of results that a notebook shows as tables, and as a picture where ``picture`` names one."""

    picture: ClassVar[str] = ""
    """Name of the function of :mod:`torsionnet.plot` that draws the result alone; empty: none does."""

    def table(self) -> NotebookTable:
        """Table of the result that a notebook shows."""
        raise NotImplementedError

    def to_dataframe(self) -> Any:
        """Table of the result as a pandas.DataFrame, with title, units by column and notes in its ``attrs``."""
        return self.table().to_dataframe()

    def notebook_tables(self) -> Iterable[NotebookTable]:
        """Tables of the result that a notebook shows."""
        return (self.table(),)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {getattr(self, 'title', '')}>".replace(" >", ">")

    def _repr_html_(self) -> str:
        return "\n".join([*(thinned(table).to_html() for table in self.notebook_tables()), self._picture()])

    def _picture(self) -> str:
        return drawn(lambda plot: getattr(plot, self.picture)(self)) if self.picture else ""


UNSAVED: Mapping[str, bool] = {"unsaved": True}
"""Metadata of a field that stays in memory and has its default when the result is read back."""


def one_of(*places: str) -> Mapping[str, tuple[str, ...]]:
    """Metadata of a field of a saved result that holds one of several classes, given as "module:name"."""
    return {"one_of": places}


class SavedResult(NotebookResult):
    """Base class of results that JSON files keep with all their numbers."""

    def to_json(self, path: str | os.PathLike[str] | None = None) -> str:
        """Result as JSON text in SI units with all its numbers, also written to ``path``; see :meth:`from_json`."""
        from torsionnet.base.atomic import write_text
        from torsionnet.base.saved_results import saved_text

        text = saved_text(self)
        if path is not None:
            write_text(path, text)
        return text

    @classmethod
    def from_json(cls, source: str | os.PathLike[str]) -> Self:
        """Result of this class from the text that :meth:`to_json` has made, or from the file with it.

        Raises
        ------
        UsageError
            There is no such file, it holds another result, or it is damaged.
        """
        from torsionnet.base.saved_results import read_saved

        return read_saved(cls, source)


def drawn(draw: Callable[[ModuleType], Any]) -> str:
    """HTML with the picture of the figure that ``draw`` makes with :mod:`torsionnet.plot`.

    Empty where nothing is to draw.
    """
    try:
        return figure_html(draw(importlib.import_module("torsionnet.plot")))  # plots are made from results
    except TorsionnetError:  # as of a response without frequencies
        return ""


def thinned(table: AnyTable) -> AnyTable:
    """Copy of a table with at most ``MOST_ROWS`` rows, evenly chosen, and a note on how many there are."""
    step = -(-len(table.rows) // MOST_ROWS)
    if step <= 1:
        return table
    rows = table.rows[::step]
    return replace(table, rows=rows, notes=(*table.notes, f"{len(rows)} of {len(table.rows)} lines"))


def figure_html(figure: Any) -> str:
    """HTML element with the picture of a matplotlib figure, which needs no other file."""
    import base64  # with io only where a picture is drawn, as everything imports this module
    import io

    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DOTS_PER_INCH)
    return f'<img src="data:image/png;base64,{base64.b64encode(buffer.getvalue()).decode("ascii")}" alt="">'


OBJECTS_BETWEEN_COLLECTIONS = 20_000
"""New objects after which the collector looks for cycles: Python's own 700 cost a document a twentieth of its time, and
this many take a few megabytes."""


@contextmanager
def gc_paused() -> Iterator[None]:
    """Context manager or decorator that pauses the garbage collector of reference cycles.

    >>> with gc_paused():
    ...     gc.isenabled()
    False
    """
    if not gc.isenabled():
        yield
        return
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


@contextmanager
def rare_collections() -> Iterator[None]:
    """Context manager in which the garbage collector of reference cycles runs less often, for long calculations.

    >>> with rare_collections():
    ...     gc.get_threshold()[0]
    20000
    """
    before = gc.get_threshold()
    gc.set_threshold(OBJECTS_BETWEEN_COLLECTIONS, *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)
