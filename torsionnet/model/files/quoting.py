"""Writing of YAML scalars, with quotes wherever a reader might take a text for something else."""

from __future__ import annotations

import math
import re

import yaml

from torsionnet.model.files.located_yaml import Plain, plain_value

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
