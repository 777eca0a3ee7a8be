"""Values of plain (unquoted) YAML scalars by the core rules of YAML 1.2."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from functools import lru_cache

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
"""Length in characters of the longest text read as a decimal number, as floats have 17 digits; longer ones stay
text."""


@lru_cache(maxsize=4096)
def plain_value(text: str) -> Plain:
    """Value of an unquoted scalar of YAML, a number, text, true, false or nothing.

    A number that no float holds exactly as written stays text.

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
