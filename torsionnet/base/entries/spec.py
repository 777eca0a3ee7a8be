"""Specifications of entries, which read, check, describe and write their values.

Here as well: renaming of a part's own names to the names that they have in the model using the part; entries that hold
words, whole numbers, yes or no.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import MISSING, Field, dataclass, field, fields, is_dataclass, replace
from numbers import Integral
from typing import Any, ClassVar, Generic, TypeAlias, TypeVar, cast, overload

from torsionnet.base.errors import QUOTE, WRITE, EntryPath, Fault, Remedy, got, unfit_word
from torsionnet.base.expressions import Expression


@dataclass(frozen=True, eq=False)
class Renaming:
    """Map from names of a part to names in the model that uses it.

    Attributes
    ----------
    prefix : str
        Comes before every name of the part's own, as ``left.``.
    nodes : mapping
        Nodes that keep or get another name: ports, and the ground.
    channels : collection of str
        Sensors and inputs of the part.
    ports : mapping
        Element of the part -> its ports with their nodes.
    excitations : collection of str
        Excitations of the part.
    """

    prefix: str
    nodes: Mapping[str, str]
    channels: Collection[str] = ()
    ports: Mapping[str, Mapping[str, str]] | None = None
    excitations: Collection[str] = ()

    def own(self, name: str) -> str:
        """Name in the model of an element, parameter, sensor, ... of the part."""
        return self.prefix + name

    def element(self, name: str) -> str:
        """Name in the model of an element of the part."""
        return self.own(name)

    def parameter(self, name: str) -> str:
        """Name in the model of a parameter of the part."""
        return self.own(name)

    def channel(self, name: str) -> str:
        """Name in the model of a sensor or input of the part."""
        return self.own(name)

    def excitation(self, name: str) -> str:
        """Name in the model of an excitation of the part."""
        return self.own(name)

    def part(self, name: str) -> str:
        """Name in the model of a part that the part uses, which is the same."""
        return name

    def port(self, part: str, name: str) -> str:
        """Name of a port of a part that the part uses, which is the same."""
        del part
        return name

    def part_parameter(self, part: str, name: str) -> str:
        """Name of a parameter of a part that the part uses, which is the same."""
        del part
        return name

    def changed_entry(self, name: str) -> str:
        """Name in the model of what an alternative changes, a parameter or an entry as ``engine.misfire``."""
        return self.own(name)

    def configuration(self, name: str) -> str:
        """Name in the model of a choice of alternatives, which is the same."""
        return name

    def node(self, name: str) -> str:
        """Name in the model of a node of the part."""
        return self.nodes.get(name) or self.prefix + name

    def at(self, element: str, place: str | None) -> str | None:
        """Name in the model of a place on an element: the name of a port stays, that of a node changes."""
        named = (self.ports or {}).get(element, {})
        return place if place is None or place in named else self.node(place)

    def expression(self, value: Expression) -> Expression:
        """Expression of the part's parameters with their names in the model."""
        return value.renamed(self.parameter)

    def within(self, value: Any) -> Any:
        """Value of an entry in its stored form, with the names in all its expressions changed.

        The value itself where there are none.
        """
        if isinstance(value, Expression):
            return self.expression(value)
        if type(value) is tuple:
            renamed = tuple(map(self.within, value))
            return value if all(new is old for new, old in zip(renamed, value, strict=True)) else renamed
        if isinstance(value, dict):
            entries = {key: self.within(part) for key, part in value.items()}
            return value if all(entries[key] is value[key] for key in value) else entries
        if hasattr(value, "renamed"):
            return value.renamed(self)
        if is_dataclass(value) and not isinstance(value, type):
            changes = {own.name: self.within(getattr(value, own.name)) for own in fields(value) if own.init}
            changes = {key: new for key, new in changes.items() if new is not getattr(value, key)}
            return replace(value, **changes) if changes else value
        return value


Json: TypeAlias = "Mapping[str, Json] | Sequence[Json] | str | int | float | bool | None"
"""Type of everything that JSON and YAML can hold."""
Schema: TypeAlias = "dict[str, Json]"

T = TypeVar("T")
Stored_co = TypeVar("Stored_co", covariant=True)
"""Type variable of the form in which a field stores the value of its entry."""


class EntryError(ValueError):
    """Error of a value that does not fit its entry; paths of its faults are relative to the entry."""

    def __init__(self, message: str | Fault | Iterable[Fault], path: EntryPath = (), *, kind: str = "") -> None:
        if isinstance(message, str):
            message = Fault(message, path, kind=kind)
        self.faults: list[Fault] = [message] if isinstance(message, Fault) else list(message)
        super().__init__(self.fault.message)
        if self.fault.kind:
            self.add_note(f"[{self.fault.kind}]")

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
    absent: ClassVar[Any] = None
    """Value that is stored where the entry is not given."""
    is_read_off: ClassVar[bool] = False
    """Whether the entry holds rows, and another entry beside it the value at which they are interpolated."""
    keys_within: ClassVar[tuple[str, ...]] = ()
    """Keys by which the value may be given within the entry, as a damping by its measure."""

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

    def expressions(self, value: Any) -> tuple[tuple[EntryPath, Expression, str], ...]:
        """Triples (path, expression, dimension name) of every expression in the value, for the checks."""
        del value
        return ()

    @property
    def accepted(self) -> str:
        """Type annotation of accepted Python values, with names of :mod:`torsionnet.base.entries.accepted_types`."""
        return "object"


def reference(name: str) -> Schema:
    """JSON Schema that refers to the definition of that name."""
    return {"$ref": f"#/$defs/{name}"}


class Plural(Spec[Stored_co]):
    """Base of specifications of entries that hold several values.

    An entry that is not given is stored as an empty one, ``absent``.
    """


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


MODEL_NAME = "the name of a library model or the path of a model file"
"""Description of the name of a model, for entries and messages."""
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*(\.[A-Za-z][A-Za-z0-9_]*)*")
NAME_SCHEMA: Schema = {"pattern": f"^{_NAME.pattern}$"}
"""JSON Schema of the name of a node, an element, an input or a sensor."""
_TRUTH = {**dict.fromkeys(("yes", "on", "y"), "true"), **dict.fromkeys(("no", "off", "n"), "false")}
"""True or false by the words that stand for it in other programs."""


def name_fault(name: str) -> Fault | None:
    """Fault that ``name`` cannot name a node, an element, an input or a sensor, or None if it can.

    What belongs to a part that is used in a model has the name of the use before a dot.

    >>> name_fault("hub"), name_fault("left.hub")
    (None, None)
    """
    return None if _NAME.fullmatch(name) else _no_name(name)


def single_name_fault(name: str) -> Fault | None:
    """Fault that a name is not one word without a dot, or None, as for a use or a part."""
    return _no_name(name) if "." in name else name_fault(name)


def _no_name(name: str) -> Fault:
    text = f'"{name}" is not a valid name; use letters, digits and _, beginning with a letter'
    return Fault(text, kind="invalid-name", about=name)


@dataclass(frozen=True, eq=False, repr=False)
class Text(Spec[str]):
    """Entry of free text, or of the name of something."""

    what: str = "text"

    def coerce(self, raw: object) -> str:
        if not isinstance(raw, str):
            raise EntryError(Fault(f"expected {self.what}, {got(raw)}", remedy=Remedy(QUOTE), kind="wrong-form"))
        return raw

    def schema(self) -> Schema:
        return {"type": "string", "description": self.description}

    @property
    def accepted(self) -> str:
        return "str"


@dataclass(frozen=True, eq=False, repr=False)
class OneOf(Spec[str]):
    """Entry of one word out of a fixed list."""

    options: tuple[str, ...]

    def coerce(self, raw: object) -> str:
        if raw not in self.options:
            text = f"expected {' or '.join(self.options)}, {got(raw)}"
            raise EntryError(unfit_word(text, str(raw), self.options))
        return str(raw)

    def schema(self) -> Schema:
        return {"enum": list(self.options), "description": self.description}

    @property
    def accepted(self) -> str:
        return f"typing.Literal[{', '.join(map(repr, self.options))}]"


@dataclass(frozen=True, eq=False, repr=False)
class Count(Spec[int]):
    """Entry of a whole number in a range."""

    lower: int = 1
    upper: int = 1000

    def coerce(self, raw: object) -> int:
        if isinstance(raw, bool) or not isinstance(raw, Integral) or not self.lower <= int(raw) <= self.upper:
            raise EntryError(
                f"expected a whole number from {self.lower} to {self.upper}, {got(raw)}", kind="out-of-range"
            )
        return int(raw)

    def schema(self) -> Schema:
        return {"type": "integer", "minimum": self.lower, "maximum": self.upper, "description": self.description}

    @property
    def accepted(self) -> str:
        return "WholeNumber"


class Flag(Spec[bool]):
    """Entry of true or false."""

    def coerce(self, raw: object) -> bool:
        if not isinstance(raw, bool):
            remedy = Remedy(WRITE, _TRUTH[raw.lower()]) if isinstance(raw, str) and raw.lower() in _TRUTH else None
            raise EntryError(Fault(f"expected true or false, {got(raw)}", remedy=remedy, kind="wrong-form"))
        return raw

    def schema(self) -> Schema:
        return {"type": "boolean", "description": self.description}

    @property
    def accepted(self) -> str:
        return "bool"
