"""Results saved as JSON with all their numbers, and read back as objects of the same class.

Arrays are lists, complex ones ``{"real": ..., "imag": ...}``, empty ones their shape; fractions, and numbers that JSON
lacks, are texts as "3/2", "nan" and "-inf"; mappings whose keys are no texts are lists of pairs. What a class keeps in
memory alone, as the record behind an estimate, its fields mark as ``UNSAVED``.
"""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import json
import math
import os
import sys
import types
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, TypeVar, Union, get_args, get_origin, get_type_hints

from torsionnet.base.errors import UsageError, unreadable_file
from torsionnet.base.notes import Note, NoteOrText

CLASS = "result"
"""Key of the name of the class in the JSON data of a result."""
Saved = TypeVar("Saved")


def saved_text(result: object) -> str:
    """JSON text of a result with all its numbers."""
    return json.dumps({CLASS: type(result).__name__, **_plain(result)}, ensure_ascii=False) + "\n"


def read_saved(kind: type[Saved], source: str | os.PathLike[str]) -> Saved:
    """Result of a class from the text that :func:`saved_text` has made, or from the file with it.

    Raises
    ------
    UsageError
        There is no such file, it holds another result, or it is damaged.
    """
    name, data = json_object(source)
    held = data.get(CLASS)
    if held != kind.__name__:
        holds = f"results of the class {held}" if held else "no saved result"
        raise UsageError(f"{name} holds {holds}, not what {kind.__name__}.to_json writes", kind="wrong-file")
    try:
        result: Saved = _object(kind, data)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise UsageError(
            f"{name} is not as {kind.__name__}.to_json has written it: {error}", kind="wrong-file"
        ) from None
    return result


def json_object(source: str | os.PathLike[str]) -> tuple[str, dict[str, Any]]:
    """Name of a JSON text, or of the file with it, for messages, and its data; empty where they are no object.

    Raises
    ------
    UsageError
        There is no such file, or it is no JSON.
    """
    is_text = isinstance(source, str) and source.lstrip().startswith("{")
    name = "the text" if is_text else str(source)
    try:
        data = json.loads(str(source) if is_text else Path(source).read_text(encoding="utf-8"))
    except OSError as error:
        raise unreadable_file(name, error) from None
    except ValueError as error:
        raise UsageError(f"{name} is no JSON text: {error}", kind="wrong-file") from None
    return name, data if isinstance(data, dict) else {}


def _saved_fields(kind: Any) -> list[dataclasses.Field[Any]]:
    return [field for field in dataclasses.fields(kind) if field.init and "unsaved" not in field.metadata]


def _plain(value: Any) -> Any:
    """Data for JSON of a value of a result."""
    if dataclasses.is_dataclass(value):
        return {field.name: _plain(getattr(value, field.name)) for field in _saved_fields(value)}
    if hasattr(value, "tolist"):  # an array, or a number of numpy
        if value.ndim > 1 and not value.size:  # of which lists would keep a part of the shape
            return {"shape": list(value.shape)}
        if value.dtype.kind == "c":
            return {"real": _plain(value.real.tolist()), "imag": _plain(value.imag.tolist())}
        return _plain(value.tolist())
    if isinstance(value, complex):
        return {"real": _plain(value.real), "imag": _plain(value.imag)}
    if isinstance(value, Mapping):
        if all(isinstance(key, str) for key in value):
            return {key: _plain(part) for key, part in value.items()}
        return [[_plain(key), _plain(part)] for key, part in value.items()]
    if isinstance(value, list | tuple):
        return [_plain(part) for part in value]
    is_text = isinstance(value, Fraction) or (isinstance(value, float) and not math.isfinite(value))
    return str(value) if is_text else value


def _object(kind: Any, data: Mapping[str, Any]) -> Any:
    """Object of a dataclass from its data; a field that is missing has its default."""
    return kind(
        **{
            field.name: _read_value(_type(kind, field), data[field.name])
            for field in _saved_fields(kind)
            if field.name in data
        }
    )


def _type(kind: Any, field: dataclasses.Field[Any]) -> Any:
    """Declared type of a field, whose module may import it for type checkers alone: then ``PARTS`` says from where.

    A field that holds one of several classes, of modules that import this one, says their places by ``one_of``.
    """
    if "one_of" in field.metadata:
        places = (place.split(":") for place in field.metadata["one_of"])
        return Union[tuple(getattr(importlib.import_module(module), name) for module, name in places)]  # noqa: UP007
    home = next(base for base in kind.__mro__ if field.name in inspect.get_annotations(base))
    parts = {
        name: getattr(importlib.import_module(module), name)
        for name, module in getattr(kind, "PARTS", {}).items()
        if name in str(field.type)
    }
    declared = types.SimpleNamespace(__annotations__={field.name: field.type})
    return get_type_hints(declared, vars(sys.modules[home.__module__]), parts)[field.name]


def _read_value(kind: Any, data: Any) -> Any:
    """Value of a declared type from its data."""
    if kind == NoteOrText:
        return data if isinstance(data, str) else Note(**data)
    arguments = get_args(kind)
    match get_origin(kind):
        case origin if origin is Annotated:
            return _read_value(arguments[0], data)
        case origin if origin in (Union, types.UnionType):
            return None if data is None else _read_value(_fitting(arguments, data), data)
        case origin if origin is tuple:
            # tuple[T, ...] has one type for all parts.
            kinds = arguments[:1] * len(data) if arguments[1:] == (...,) else arguments
            return tuple(_read_value(own, part) for own, part in zip(kinds, data, strict=True))
        case origin if isinstance(origin, type) and issubclass(origin, Mapping):
            pairs = data.items() if isinstance(data, Mapping) else data
            return {_read_value(arguments[0], key): _read_value(arguments[1], part) for key, part in pairs}
        case origin if getattr(origin, "__name__", "") in ("ndarray", "NDArray"):
            return _array(get_args(arguments[-1]) or arguments[-1:], data)
    if dataclasses.is_dataclass(kind):
        return _object(kind, data)
    if kind is complex and isinstance(data, Mapping):
        return complex(float(data["real"]), float(data["imag"]))
    return kind(data) if kind in (float, complex, Fraction) else data


def _fitting(kinds: tuple[Any, ...], data: Any) -> Any:
    """Type of several that data are of: the dataclass with these fields, or what is no dataclass."""
    others = [option for option in kinds if option is not type(None)]
    if isinstance(data, Mapping):
        names = [
            (option, {field.name for field in _saved_fields(option)})
            for option in others
            if dataclasses.is_dataclass(option)
        ]
        return next((option for option, known in names if known == set(data)), others[0])
    return next((option for option in others if not dataclasses.is_dataclass(option)), others[0])


def _array(dtype: tuple[Any, ...], data: Any) -> Any:
    import numpy as np  # base is read by commands that do without

    if isinstance(data, Mapping) and "shape" in data:
        return np.empty(data["shape"], dtype[0])
    if isinstance(data, Mapping):
        return np.array(data["real"], dtype=float) + 1j * np.array(data["imag"], dtype=float)
    return np.array(data, dtype=dtype[0])
