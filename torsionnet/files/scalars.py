"""What a plain (unquoted) word of YAML means, and when a text needs quotes to stay one."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from functools import lru_cache

import yaml

Plain = None | bool | int | float | str

_WORDS: dict[str, Plain] = {"": None, "~": None}
_WORDS |= dict.fromkeys(("null", "Null", "NULL"))
_WORDS |= dict.fromkeys(("true", "True", "TRUE"), True) | dict.fromkeys(("false", "False", "FALSE"), False)

# The numbers YAML has and a drivetrain has not: as words they are refused wherever a value is read.
_WORDS |= {f"{sign}.{form}": f"{sign}inf" for sign in ("", "+", "-") for form in ("inf", "Inf", "INF")}
_WORDS |= dict.fromkeys((".nan", ".NaN", ".NAN"), "nan")

_INTEGER = re.compile(r"[-+]?(0|[1-9][0-9]{0,17})")
_DECIMAL = re.compile(r"[-+]?((0|[1-9][0-9]*)(\.[0-9]*)?|\.[0-9]+)([eE][-+]?[0-9]{1,3})?")
_LONGEST_DECIMAL = 40

# What other readers (YAML 1.1, or other rules of 1.2) may take for a number, a truth value or a date.
_MISREAD = re.compile(r"[-+]?(0o[0-7]+|0x[0-9a-fA-F]+|[0-9][0-9_.]*([eE][-+]?[0-9]+)?)|y|Y|n|N")
_PLAIN_TEXT = re.compile(r"(?:-?[^\W_]|\()[\w ./^*+()·²³°-]*")
_ESCAPES = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\t": "\\t", "\r": "\\r"}


@lru_cache(maxsize=4096)
def plain_value(text: str) -> Plain:
    """The value of an unquoted scalar; a number that no float holds exactly as written stays text.

    >>> [plain_value(text) for text in ("1", "0.1", "1e3", "no", "3:1", "017", "true", "0.1234567890123456789")]
    [1, 0.1, 1000.0, 'no', '3:1', '017', True, '0.1234567890123456789']
    """
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text):
        return int(text)
    if len(text) <= _LONGEST_DECIMAL and _DECIMAL.fullmatch(text):
        value = float(text)
        if math.isfinite(value) and Fraction(repr(value)) == Fraction(text):
            return value
    return text


def written(value: Plain) -> str:
    """A scalar as a model file holds it: text in quotes wherever YAML 1.1 or 1.2 would make something else of it.

    >>> [written(value) for value in ("motor", "0.46 kN*m/rad", "no", "3:1", "12", 1e-5, True)]
    ['motor', '0.46 kN*m/rad', '"no"', '"3:1"', '"12"', '1.0e-05', 'true']
    """
    if value is None or isinstance(value, bool):
        return "null" if value is None else str(value).lower()
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
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"  # noqa: PLR2004
