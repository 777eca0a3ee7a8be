"""The kinds of value an entry can have: each knows how to read, describe and write its value."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, Field, dataclass, field
from typing import Any, ClassVar, Generic, TypeAlias, TypeVar, cast, overload

from torsionnet.core.entries.renaming import Renaming
from torsionnet.core.errors import Fault, Path
from torsionnet.core.expressions import Expression

Json: TypeAlias = "Mapping[str, Json] | Sequence[Json] | str | int | float | bool | None"
"""What JSON and YAML can hold."""
Schema: TypeAlias = "dict[str, Json]"

T = TypeVar("T")
Stored_co = TypeVar("Stored_co", covariant=True)
"""What a field holds once its value has been coerced."""


class EntryError(ValueError):
    """A value that does not fit its entry; the paths of the faults lead from the entry to what is wrong."""

    def __init__(self, message: str | Fault | Iterable[Fault], path: Path = ()) -> None:
        if isinstance(message, str):
            message = Fault(message, path)
        self.faults: list[Fault] = [message] if isinstance(message, Fault) else list(message)
        super().__init__(self.fault.message)

    @property
    def fault(self) -> Fault:
        """The first of the faults; there is at least one."""
        return self.faults[0]


@dataclass(frozen=True, eq=False, repr=False)
class Spec(Generic[Stored_co]):
    """What an entry holds; the type parameter is how that is stored.

    A simple kind says how a value is coerced, one of several values how it is read.
    """

    description: str
    is_read_off: ClassVar[bool] = False
    """Whether it holds rows, and another entry beside it the value at which they are read."""

    def coerce(self, raw: object) -> Stored_co:
        """The value in its stored form; EntryError says what is wrong."""
        value, faults = self.read(raw)
        if faults:
            raise EntryError(faults)
        return cast("Stored_co", value)

    def read(self, raw: object) -> tuple[Stored_co | None, list[Fault]]:
        """The value, or what of it could be read, and every fault."""
        try:
            return self.coerce(raw), []
        except EntryError as error:
            return self.absent, error.faults

    @property
    def absent(self) -> Stored_co | None:
        """What is stored where nothing is said."""
        return None

    @property
    def may_be_empty(self) -> bool:
        """Whether the entry may be written without a value."""
        return False

    @property
    def example(self) -> str:
        """What to write, for the message that the entry is missing."""
        return self.description

    def plain(self, value: Any) -> Json:
        """The value as a file holds it."""
        data: Json = value
        return data

    def renamed(self, value: Any, names: Renaming) -> Any:
        """The value where everything it names is called otherwise; most kinds name parameters only."""
        return names.within(value)

    def schema(self) -> Schema:
        """JSON Schema of the value."""
        raise NotImplementedError

    def definitions(self) -> Schema:
        """What the schema refers to, by name."""
        return {}

    def expressions(self, value: Any) -> tuple[tuple[Path, Expression, str], ...]:
        """(path, expression, dimension name) of every expression in the value, for the checks."""
        del value
        return ()

    @property
    def accepted(self) -> str:
        """An annotation of what Python may give: full names, and those of :mod:`torsionnet.core.entries.accepted`."""
        return "object"


def reference(name: str) -> Schema:
    """JSON Schema that refers to a definition."""
    return {"$ref": f"#/$defs/{name}"}


class Plural(Spec[Stored_co]):
    """What holds several values, or none: where nothing is said, an empty collection is stored."""

    @property
    def absent(self) -> Stored_co:
        raise NotImplementedError


def present(value: T | None) -> T:
    """The value of an entry that may be left out, where others say that it is there."""
    if value is None:
        raise TypeError("the value of an entry is missing")
    return value


def under(key: str | int, spec: Spec[T], raw: object) -> T:
    """The value of a part of an entry; its faults get the key of that part."""
    try:
        return spec.coerce(raw)
    except EntryError as error:
        raise EntryError([fault.under(key) for fault in error.faults]) from None


def spec_of(declared: Field[Any]) -> Spec[object]:
    """The specification in a dataclass field's metadata."""
    spec = declared.metadata["spec"]
    if not isinstance(spec, Spec):
        raise TypeError(f"field {declared.name} has no specification")
    return spec


@overload
def entry(spec: Plural[T], default: object = ..., *, kw_only: bool = ..., must: bool = ...) -> T: ...
@overload
def entry(spec: Spec[T], default: None, *, kw_only: bool = ..., must: bool = ...) -> T | None: ...
@overload
def entry(spec: Spec[T], default: object = ..., *, kw_only: bool = ..., must: bool = ...) -> T: ...
def entry(spec: Spec[Any], default: Any = MISSING, *, kw_only: Any = MISSING, must: bool = False) -> Any:
    """Dataclass field described by ``spec``; without ``default``, or with ``must``, a file has to give it."""
    metadata = {"spec": spec, "must": must or default is MISSING}
    if default is MISSING:
        return field(metadata=metadata, kw_only=kw_only)
    return field(default=default, metadata=metadata, kw_only=kw_only)


def dotted(cls: type) -> str:
    """The full name of a class, for :attr:`Spec.accepted`."""
    return f"{cls.__module__}.{cls.__qualname__}"


def several(accepted: str) -> str:
    """The annotation of a list of what is accepted; a text is no list of characters."""
    return "Scalars" if accepted == "Scalar" else f"tuple[{accepted}, ...] | list[{accepted}]"
