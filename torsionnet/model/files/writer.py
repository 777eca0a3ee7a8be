"""Writing of definitions as the text of a model file."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from typing import Any

from torsionnet.core.atomic import write_text
from torsionnet.model.definition import Definition
from torsionnet.model.files.quoting import scalar_text

_BLOCK_LEVELS = {
    "parameters": 1,
    "elements": 1,
    "parts": 3,
    "use": 1,
    "inputs": 1,
    "sensors": 1,
    "configurations": 2,
    "operating_point": 1,
}
"""Levels of block style in each section of a file; deeper levels are in flow style."""


def dump(definition: Definition, path: str | os.PathLike[str] | None = None) -> str:
    """Text of a model file that reads back to an equal definition, also written to ``path`` if given.

    Each entry stands on one line; comments of a file the definition came from are not kept.
    """
    text = _text(definition.to_data())
    if path is not None:
        write_text(path, text)
    return text


def flat_text(definition: Definition) -> str:
    """Text of a model file without parts: names of what they hold are written with dots.

    >>> from torsionnet.model.files.reader import read_text
    >>> shaft = "{ports: [end], elements: {s: {type: spring, nodes: [end, ground], stiffness: 8}}}"
    >>> use = "{left: {part: shaft, at: {end: a}}}"
    >>> disc = "{disc: {type: inertia, node: a, inertia: 2}}"
    >>> text = f"{{torsionnet: 1, name: wheel, elements: {disc}, parts: {{shaft: {shaft}}}, use: {use}}}"
    >>> flat_text(read_text(text, "")[0]).splitlines()[-1]
    '  left.s: {type: spring, nodes: [a, ground], stiffness: 8}'
    """
    return _text(definition.flat_data())


def _text(data: Mapping[str, Any]) -> str:
    return "".join(
        f"{line}\n" for key, value in data.items() for line in _lines(key, value, _BLOCK_LEVELS.get(key, 0), "")
    )


def _lines(key: str, value: Any, levels: int, indent: str) -> Iterator[str]:
    """Lines of an entry of a model file, with as many levels of block style as wanted, flow style below."""
    if not levels or not isinstance(value, Mapping) or not value:
        yield f"{indent}{scalar_text(key)}: {_flow(value)}"
        return
    yield f"{indent}{scalar_text(key)}:"
    for inner, entry in value.items():
        yield from _lines(inner, entry, levels - 1, f"{indent}  ")


def _flow(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{scalar_text(key)}: {_flow(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_flow(entry) for entry in value)}]"
    return scalar_text(value)
