"""Fields of results as they are declared, and the JSON and its schema that follow from them."""

from __future__ import annotations

import dataclasses
import types
from collections.abc import Collection, Mapping
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin, get_type_hints

from torsionnet.base.notes import Note, NoteOrText
from torsionnet.base.result_rows import COMPLEX, NUMBER, NUMBERS, PAIR, Out

if TYPE_CHECKING:
    from torsionnet.base.entries.spec import Schema

PLAIN: dict[object, Schema] = {
    str: {"type": "string"},
    bool: {"type": "boolean"},
    int: {"type": "integer", "minimum": 0},
    float: NUMBER,
    complex: COMPLEX,
    NoteOrText: {"type": "string"},
    str | None: {"type": ["string", "null"]},
    float | None: NUMBER,
    tuple[float, float]: PAIR,
}
"""JSON Schema of each plain Python type; numbers that are infinite or not determined are null."""


class OutField(NamedTuple):
    """Name, type and declaration of a field or property of a result class."""

    name: str
    type: Any
    out: Out

    @property
    def key(self) -> str | None:
        """Key of the result field in JSON, None where JSON leaves it out."""
        return None if self.out.json is None else self.out.json or self.name.rpartition(".")[2]

    def schema(self, without: Collection[str] = ()) -> Schema:
        """JSON Schema of the values of the result field; an optional field has no null, as its key is left out then."""
        schema = self.out.schema or json_schema(self.type, without)
        choices: Any = schema.get("anyOf", [])
        return choices[0] if self.out.optional and choices[1:] == [{"type": "null"}] else schema


@cache
def out_fields(kind: type) -> tuple[OutField, ...]:
    """Fields of a result class in the order of JSON; of its properties those that are declared.

    A class that holds more than it shows names what it shows in ``SHOWN``: fields, properties and methods without
    arguments, in this order, and with a dot those of a part, as ``"pattern.teeth"``, which are None where there is no
    part.
    """
    if names := getattr(kind, "SHOWN", ()):
        return tuple(_declared(name, _annotation(kind, name)) for name in names)
    hints = get_type_hints(kind, include_extras=True)
    fields: list[OutField] = []
    for field in dataclasses.fields(kind):
        _insert(fields, _declared(field.name, hints[field.name]), len(fields))
    for name, member in ((name, member) for base in reversed(kind.__mro__) for name, member in vars(base).items()):
        if isinstance(member, property):
            declared = _declared(name, _returned(kind, name))
            if declared.out != Out():
                _insert(fields, declared, 0)
    return tuple(fields)


def printed_fields(kind: type, without: Collection[str] = ()) -> list[OutField]:
    """Fields of a result class that JSON has, but for those with these names."""
    return [field for field in out_fields(kind) if field.key is not None and field.name not in without]


def shown_value(result: object, name: str) -> Any:
    """Value of a field of a result; of a name with dots that of its part, None where there is no part."""
    for part in name.split("."):
        value = None if result is None else getattr(result, part)
        result = value() if isinstance(value, types.MethodType) else value
    return result


def _annotation(kind: type, name: str) -> Any:
    """Type and declaration of a field or property, also of a part whose type may be Annotated or ``| None``."""
    first, _, rest = name.partition(".")
    hints = get_type_hints(kind, include_extras=True)
    annotation = hints[first] if first in hints else _returned(kind, first)
    if not rest:
        return annotation
    whole = _declared(first, annotation).type
    (part,) = (option for option in get_args(whole) or (whole,) if option is not type(None))
    return _annotation(part, rest)


def _returned(kind: type, name: str) -> Any:
    """Type that a property, a value kept once it is calculated, or a method is declared to return."""
    member: Any = getattr(kind, name)
    getter = member.fget if isinstance(member, property) else getattr(member, "func", member)
    return get_type_hints(getter, include_extras=True).get("return")


def _insert(fields: list[OutField], field: OutField, otherwise: int) -> None:
    """Insert a result field behind the one that it follows, or at the place given."""
    places = [place for place, other in enumerate(fields, 1) if other.name == field.out.after]
    fields.insert(places[0] if places else otherwise, field)


def _declared(name: str, annotation: Any) -> OutField:
    if get_origin(annotation) is Annotated:
        declared, *more = get_args(annotation)
        return OutField(name, declared, next((extra for extra in more if isinstance(extra, Out)), Out()))
    return OutField(name, annotation, Out())


def to_json(value: Any, without: Collection[str] = ()) -> Any:
    """Plain data of a result: objects, lists, numbers; complex numbers as pairs of real and imaginary part.

    Fields with names in ``without`` are left out, those of its parts too.
    """
    if isinstance(value, Note):
        return str(value)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        pairs = ((declared, shown_value(value, declared.name)) for declared in printed_fields(type(value), without))
        return {
            str(declared.key): to_json(field, without)
            for declared, field in pairs
            if not (declared.out.optional and field is None)
        }
    if isinstance(value, Mapping):
        return {key: to_json(part, without) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [to_json(part, without) for part in value]
    if isinstance(value, complex):
        return [value.real, value.imag]
    if hasattr(value, "tolist"):  # an array, or a number of numpy
        return to_json(value.tolist()) if value.dtype.kind == "c" else value.tolist()
    return value


def record_schema(properties: Mapping[str, Schema], optional: Collection[str] = ()) -> Schema:
    """JSON Schema of an object with these keys and no others."""
    return {
        "type": "object",
        "properties": dict(properties),
        "required": [name for name in properties if name not in optional],
        "additionalProperties": False,
    }


def json_schema(kind: Any, without: Collection[str] = ()) -> Schema:
    """JSON Schema of the JSON data that values of a type make, without the fields with these names.

    A result class, a plain type, or tuples, lists and mappings of them.

    Raises
    ------
    TypeError
        Nothing says what values of the type look like.

    Examples
    --------
    >>> json_schema(tuple[str, ...])
    {'type': 'array', 'items': {'type': 'string'}}
    """
    if kind in PLAIN:
        return PLAIN[kind]
    arguments = get_args(kind)
    match get_origin(kind):
        case origin if origin in (Union, types.UnionType):
            (inner,) = (option for option in arguments if option is not type(None))
            return {"anyOf": [json_schema(inner, without), {"type": "null"}]}
        case origin if origin in (tuple, list):
            return {"type": "array", "items": json_schema(arguments[0], without)}
        case origin if isinstance(origin, type) and issubclass(origin, Mapping):
            return {"type": "object", "additionalProperties": json_schema(arguments[1], without)}
        case origin if origin is Literal:
            return {"enum": list(arguments)}
        # NDArray is an alias of its own from numpy 2.5 on, before it was ndarray itself.
        case origin if getattr(origin, "__name__", "") in ("ndarray", "NDArray"):
            return NUMBERS
    if not dataclasses.is_dataclass(kind):
        raise TypeError(f"no JSON Schema is known of {kind}; give one by Out(schema=...)")
    fields = printed_fields(kind, without)  # type: ignore[arg-type]
    return record_schema(
        {str(field.key): field.schema(without) for field in fields},
        [str(field.key) for field in fields if field.out.optional],
    )
