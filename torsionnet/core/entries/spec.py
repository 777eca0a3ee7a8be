"""Specifications of entries, which read, check, describe and write their values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, Field, dataclass, field
from typing import Any, ClassVar, Generic, TypeAlias, TypeVar, cast, overload

from torsionnet.core.entries.renaming import Renaming
from torsionnet.core.errors import Fault, Path
from torsionnet.core.expressions import Expression

Json: TypeAlias = "Mapping[str, Json] | Sequence[Json] | str | int | float | bool | None"
"""Type of everything that JSON and YAML can hold."""
Schema: TypeAlias = "dict[str, Json]"

T = TypeVar("T")
Stored_co = TypeVar("Stored_co", covariant=True)
"""Type variable of the form in which a field stores the value of its entry."""


class EntryError(ValueError):
    """Error of a value that does not fit its entry; paths of its faults are relative to the entry."""

    def __init__(self, message: str | Fault | Iterable[Fault], path: Path = ()) -> None:
        if isinstance(message, str):
            message = Fault(message, path)
        self.faults: list[Fault] = [message] if isinstance(message, Fault) else list(message)
        super().__init__(self.fault.message)

    @property
    def fault(self) -> Fault:
        """First of the faults of the value, of which there is at least one."""
        return self.faults[0]


@dataclass(frozen=True, eq=False, repr=False)
class Spec(Generic[Stored_co]):
    """Specification of an entry; the type parameter is the type in which its value is stored.

    A simple kind says how a value is coerced, one of several values how it is read.
    """

    description: str
    is_read_off: ClassVar[bool] = False
    """Whether the entry holds rows, and another entry beside it the value at which they are interpolated."""

    def coerce(self, raw: object) -> Stored_co:
        """Value of the entry in its stored form, from what a file or a call gives.

        Raises EntryError with the faults of a value that does not fit.
        """
        value, faults = self.read(raw)
        if faults:
            raise EntryError(faults)
        return cast("Stored_co", value)

    def read(self, raw: object) -> tuple[Stored_co | None, list[Fault]]:
        """Value of the entry in its stored form, or the part of it that could be read, and every fault."""
        try:
            return self.coerce(raw), []
        except EntryError as error:
            return self.absent, error.faults

    def curve_fault(self, value: float) -> str | None:
        """Message if a value in SI units lies beyond the curve that the entry is read from; None without one."""
        del value
        return None

    @property
    def absent(self) -> Stored_co | None:
        """Value that is stored where the entry is not given."""
        return None

    @property
    def may_be_empty(self) -> bool:
        """Whether the entry may be written without a value."""
        return False

    @property
    def example(self) -> str:
        """Example of a value, for the message that the entry is missing."""
        return self.description

    def plain(self, value: Any) -> Json:
        """Value as plain data for a file."""
        data: Json = value
        return data

    def key_names(self, raw: object) -> Mapping[Any, Spec[Any]]:
        """Specification of each key of the entry that names another thing, as a node."""
        del raw
        return {}

    def entry_specs(self, raw: object) -> Mapping[Any, Spec[Any]]:
        """Specification of each entry within the entry as a file gives it, by key or index.

        Empty where the entry is read as a whole.
        """
        del raw
        return {}

    def renamed(self, value: Any, names: Renaming) -> Any:
        """Value in which all names that it refers to are renamed; most kinds refer to parameters only."""
        return names.within(value)

    def schema(self) -> Schema:
        """JSON Schema of the value."""
        raise NotImplementedError

    def definitions(self) -> Schema:
        """Definitions that the JSON Schema of the entry refers to, by name."""
        return {}

    def expressions(self, value: Any) -> tuple[tuple[Path, Expression, str], ...]:
        """Triples (path, expression, dimension name) of every expression in the value, for the checks."""
        del value
        return ()

    @property
    def accepted(self) -> str:
        """Type annotation of accepted Python values, with names of :mod:`torsionnet.core.entries.accepted_types`."""
        return "object"


def reference(name: str) -> Schema:
    """JSON Schema that refers to the definition of that name."""
    return {"$ref": f"#/$defs/{name}"}


class Plural(Spec[Stored_co]):
    """Base of specifications of entries that hold several values.

    An entry that is not given is stored as an empty one.
    """

    @property
    def absent(self) -> Stored_co:
        raise NotImplementedError


def not_none(value: T | None) -> T:
    """Value of an optional entry where the caller knows that it is given; TypeError where it is None."""
    if value is None:
        raise TypeError("the value of an entry is missing")
    return value


def coerce_part(key: str | int, spec: Spec[T], raw: object) -> T:
    """Stored form of one part of an entry, read by the specification of that part.

    Its faults get the key of that part.
    """
    try:
        return spec.coerce(raw)
    except EntryError as error:
        raise EntryError([fault.under(key) for fault in error.faults]) from None


def spec_of(declared: Field[Any]) -> Spec[object]:
    """Specification that a dataclass field carries in its metadata."""
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


def full_name(cls: type) -> str:
    """Name of a class with its module, for :attr:`Spec.accepted`."""
    return f"{cls.__module__}.{cls.__qualname__}"


def list_annotation(accepted: str) -> str:
    """Text of the type annotation of a list of accepted values; a text does not count as a list of characters."""
    return "Scalars" if accepted == "Scalar" else f"tuple[{accepted}, ...] | list[{accepted}]"
