"""Writing of definitions as the text of a model file."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from typing import Any

from torsionnet.base.atomic import write_text
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
"""Number of nested levels that each section of a file has in block style, one entry a line; deeper levels are in flow
style."""


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
    return block_text(data, _BLOCK_LEVELS)


def block_text(data: Mapping[str, Any], levels: Mapping[str, int], *, lists: bool = False) -> str:
    """YAML text of plain data, with as many ``levels`` of block style as wanted by key and flow style below.

    Lists are in flow style, unless ``lists`` are to be in block style as mappings are.

    >>> print(block_text({"a": {"b": [1, 2]}, "c": [{"d": 3, "e": []}]}, {"a": 1, "c": 2}, lists=True), end="")
    a:
      b: [1, 2]
    c:
      - d: 3
        e: []
    """
    return "".join(
        f"{line}\n" for key, value in data.items() for line in _lines(key, value, levels.get(key, 0), "", lists)
    )


def _lines(key: str, value: Any, levels: int, indent: str, lists: bool) -> Iterator[str]:
    """Lines of an entry of a file, with as many levels of block style as wanted, flow style below."""
    if not levels or not value or not isinstance(value, Mapping | list if lists else Mapping):
        yield f"{indent}{scalar_text(key)}: {flow_text(value)}"
        return
    yield f"{indent}{scalar_text(key)}:"
    if isinstance(value, Mapping):
        for inner, entry in value.items():
            yield from _lines(inner, entry, levels - 1, f"{indent}  ", lists)
        return
    for item in value:
        if levels > 1 and item and isinstance(item, Mapping):
            sign = "- "
            for inner, entry in item.items():
                for line in _lines(inner, entry, levels - 2, "", lists):
                    yield f"{indent}  {sign}{line}"
                    sign = "  "
        else:
            yield f"{indent}  - {flow_text(item)}"


def flow_text(value: Any) -> str:
    """Text of plain data in flow style, on one line.

    >>> flow_text({"type": "spring", "nodes": ["a", "b"], "stiffness": "3:1"})
    '{type: spring, nodes: [a, b], stiffness: "3:1"}'
    """
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{scalar_text(key)}: {flow_text(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(flow_text(entry) for entry in value)}]"
    return scalar_text(value)
