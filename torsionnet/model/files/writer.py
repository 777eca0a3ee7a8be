"""Writing of definitions as the text of a model file."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterator, Mapping
from typing import Any

import yaml

from torsionnet.base.atomic import write_text
from torsionnet.model.definition import Definition
from torsionnet.model.files.located_yaml import Plain, plain_value

# Writing of YAML scalars, with quotes wherever a reader might take a text for something else.

# What other readers (YAML 1.1, or other rules of 1.2) may take for a number, a truth value or a date.
_MISREAD = re.compile(r"[-+]?(0o[0-7]+|0x[0-9a-fA-F]+|[0-9][0-9_.]*([eE][-+]?[0-9]+)?)|y|Y|n|N")
_PLAIN_TEXT = re.compile(r"(?:-?[^\W_]|\()[\w ./^*+()·²³°-]*")
_ESCAPES = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\t": "\\t", "\r": "\\r"}


def scalar_text(value: Plain) -> str:
    """Text of a scalar as a model file holds it; in quotes wherever YAML 1.1 or 1.2 would make something else of it.

    >>> [scalar_text(value) for value in ("motor", "0.46 kN*m/rad", "no", "3:1", "12", 1e-5, math.inf, True)]
    ['motor', '0.46 kN*m/rad', '"no"', '"3:1"', '"12"', '1.0e-05', '.inf', 'true']
    """
    if value is None or isinstance(value, bool):
        return "null" if value is None else str(value).lower()
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else ".inf" if value > 0 else "-.inf"
    if isinstance(value, float):
        mantissa, exponent, power = repr(value).partition("e")
        return f"{mantissa}{'' if '.' in mantissa or not exponent else '.0'}{exponent}{power}"
    if isinstance(value, int):
        return str(value)
    return value if _stays_text(value) else f'"{"".join(_escaped(char) for char in value)}"'


def _stays_text(text: str) -> bool:
    if not _PLAIN_TEXT.fullmatch(text) or text != text.strip() or not text.isprintable():
        return False
    if not isinstance(plain_value(text), str) or _MISREAD.fullmatch(text):
        return False
    rules = yaml.SafeLoader.yaml_implicit_resolvers.get(text[0], ())
    return not any(rule.match(text) for _, rule in rules)


def _escaped(char: str) -> str:
    if char in _ESCAPES or char.isprintable():
        return _ESCAPES.get(char, char)
    code = ord(char)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


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
