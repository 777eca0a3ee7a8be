"""Text of numbers, units and missing values on the screen, in files and in documents.

Whoever shows a table asks here. A screen has plain characters only (``-`` for nothing, ``1e+06``), a document has
typeset ones (``–``, ``10⁶``), a file all digits and an empty cell.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

SMALLEST_PLAIN, LARGEST_PLAIN = 1e-4, 1e6
"""Smallest and largest size of a number that is typeset without a power of ten."""
UNBROKEN_PERCENT = "\N{NO-BREAK SPACE}%"
"""Percent sign behind its number, with a blank at which no line ends."""
MISSING, MISSING_TYPESET = "-", "–"
"""Dash for a missing value, on a screen and in a document."""
MOST_DECIMALS = 4
"""Largest number of decimals of an aligned column, as long as its largest value then has all its digits."""
COLUMN_LARGEST, COLUMN_SMALLEST, COLUMN_SPREAD = 1e5, 1e-3, 1e4
"""Largest and smallest value of a column, and their ratio, beyond which digits are set for each number alone."""
ZERO_ERROR_RATIO = 1e-6
"""Relative standard error below which an error is taken for zero: rounding of an exact fit leaves about as much."""
USUAL_DIGITS, FEWEST_DIGITS, MOST_DIGITS = 5, 2, 9
"""Significant digits of a value whose error is not known, and fewest and most digits that an error allows."""
RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
"""Raised digits and minus by the plain ones, for powers."""

TORQUE_MEGA_FROM = 1e8
"""Torque in N m from which on a column, text or axis has MN m."""


def is_missing(value: Any) -> bool:
    """Whether a value is None or NaN."""
    return value is None or (isinstance(value, float) and math.isnan(value))


def screen_text(value: Any, digits: int = 6) -> str:
    """Text of a value in plain characters; the parts of a tuple are joined to one text.

    >>> screen_text(1 / 3, 3), screen_text(None), screen_text(7, 2), screen_text(("k = ", 460.0, " N*m/rad"))
    ('0.333', '-', '7', 'k = 460 N*m/rad')
    """
    if isinstance(value, tuple):
        return "".join(screen_text(part, digits) for part in value)
    if is_missing(value):
        return MISSING
    return f"{value:.{digits}g}" if isinstance(value, float) else str(value)


def csv_value(value: Any) -> Any:
    """Number with all digits, or another value as it is, for a cell of a CSV file; empty where it is missing."""
    if isinstance(value, tuple):
        return screen_text(value)
    return "" if is_missing(value) else repr(value) if isinstance(value, float) else value


def json_finite(data: Any) -> Any:
    """Data for JSON, with null for every number that is not finite."""
    if isinstance(data, float):
        return data if math.isfinite(data) else None
    if isinstance(data, dict):
        return {key: json_finite(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [json_finite(value) for value in data]
    return data


def unit_in_brackets(unit: str) -> str:
    """Unit in brackets, ``[Hz]``, for the heading of a column; empty where there is no unit."""
    return "" if unit in ("", MISSING_TYPESET) else f"[{unit}]"


def typeset_unit(unit: str) -> str:
    """SI unit as it is printed in documents.

    >>> typeset_unit("rad/(N*m)"), typeset_unit("kg*m^2")
    ('rad/(N·m)', 'kg·m²')
    """
    return unit.replace("*", "·").replace("^2", "²").replace("^3", "³")


def prefix_of(unit: str, largest: float) -> tuple[str, float]:
    """Prefix of torques, stiffnesses and dampings in SI, and the factor that it stands for, by the largest of them.

    The one rule of texts, tables and pictures: kN m from 1000 N m, and MN m/rad from 1 000 000 N m/rad. Torques stay
    in kN m, as ships and turbines have them, up to ``TORQUE_MEGA_FROM``, which only modes of unit amplitude reach.

    >>> prefix_of("N*m", 388e3), prefix_of("N*m/rad", 6.2e7), prefix_of("N*m", 610.9), prefix_of("Hz", 5e3)
    (('k', 1000.0), ('M', 1000000.0), ('', 1.0), ('', 1.0))
    """
    if not unit.startswith("N*m"):
        return "", 1.0
    mega_from = TORQUE_MEGA_FROM if unit == "N*m" else 1e6
    return ("M", 1e6) if abs(largest) >= mega_from else ("k", 1e3) if abs(largest) >= 1e3 else ("", 1.0)


@dataclass(frozen=True)
class NumberText:
    """Number to be typeset, with a number of significant digits or of decimals.

    Examples
    --------
    >>> [(number.mantissa, number.exponent) for number in map(NumberText, (0.46, 13300.0, 1.106e6))]
    [('0.46', None), ('13300', None), ('1.106', 6)]
    """

    value: float | None
    digits: int = 4
    decimals: int | None = None

    @property
    def exponent(self) -> int | None:
        """Power of ten of the typeset number, None where it is written without."""
        if self.value is None or not math.isfinite(self.value) or self.value == 0:
            return None
        if SMALLEST_PLAIN <= abs(self.value) < LARGEST_PLAIN or self.decimals is not None:
            return None
        # Of the number as rounded: 9.9996 to four digits is 10.00.
        return math.floor(math.log10(float(f"{abs(self.value):.{self.digits - 1}e}")))

    @property
    def mantissa(self) -> str:
        """Digits of the typeset number as text, with an ASCII minus; a dash where there is none."""
        if self.value is None or math.isnan(self.value):
            return MISSING_TYPESET
        if math.isinf(self.value):
            return "-∞" if self.value < 0 else "∞"
        if self.decimals is not None:
            return _positive_zero(f"{self.value:.{self.decimals}f}")
        if self.exponent is not None:
            return _trimmed(f"{self.value / 10.0**self.exponent:.{self.digits - 1}f}")
        if self.value == 0:
            return "0"
        # 10^n <= |value| < 10^(n+1) has n + 1 digits before its point, the others are decimals.
        places = self.digits - 1 - math.floor(math.log10(abs(self.value)))
        return _trimmed(f"{round(self.value, places):.{max(0, places)}f}")

    @property
    def decimals_shown(self) -> int:
        """Number of digits that the typeset number has behind its point, for setting columns."""
        return len(self.mantissa.partition(".")[2]) if self.exponent is None else 0

    def __str__(self) -> str:
        """Number in one line of typeset characters.

        >>> str(NumberText(-2.5e-5)), str(NumberText(float("nan")))
        ('−2.5·10⁻⁵', '–')
        """
        text = self.mantissa.replace("-", "−")
        return text if self.exponent is None else f"{text}·10{str(self.exponent).translate(RAISED)}"


def _trimmed(text: str) -> str:
    return text.rstrip("0").rstrip(".") if "." in text else text


def _positive_zero(text: str) -> str:
    return text.removeprefix("-") if not text.strip("-0.") else text


def aligned_numbers(values: Sequence[float | None], digits: int = 4) -> list[NumberText]:
    """Numbers of one column with equally many decimals, so many that the smallest has three digits or more.

    >>> [number.mantissa for number in aligned_numbers([3.6909, 40.535, None])]
    ['3.691', '40.535', '–']
    """
    sizes = [abs(value) for value in values if value is not None and math.isfinite(value) and value != 0]
    if (
        not sizes
        or max(sizes) >= COLUMN_LARGEST
        or min(sizes) < COLUMN_SMALLEST
        or max(sizes) / min(sizes) > COLUMN_SPREAD
    ):
        return [NumberText(value, digits) for value in values]
    # The smallest value decides, up to MOST_DECIMALS or the decimals of the largest.
    decimals = digits - 1 - math.floor(math.log10(min(sizes)))
    decimals = min(max(decimals, 0), max(MOST_DECIMALS, digits - 1 - math.floor(math.log10(max(sizes)))))
    return [NumberText(value, digits, decimals if value else None) for value in values]


def digits_to_error(value: float, error: float) -> int:
    """Number of significant digits of a value down to the second digit of its standard error.

    >>> digits_to_error(169.9971, 0.0541), digits_to_error(4.0, math.inf), digits_to_error(1.5, 0.0)
    (6, 5, 5)
    """
    if not (math.isfinite(error) and error > 0 and value):
        return USUAL_DIGITS
    return min(max(math.floor(math.log10(abs(value))) - math.floor(math.log10(error)) + 2, FEWEST_DIGITS), MOST_DIGITS)


def value_with_error(value: float, error: float) -> str:
    """Text of a value and its standard error, ``0.8031 ± 0.0098``, to the second digit of the error.

    >>> value_with_error(0.80312, 0.0098), value_with_error(459.96, 1.73), value_with_error(4.0, 1e-12)
    ('0.8031 ± 0.0098', '460.0 ± 1.7', '4 ± 1e-12')
    """
    if not ZERO_ERROR_RATIO * abs(value) < error < math.inf:
        return f"{value:.6g} ± {error:.2g}"
    places = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{places}f} ± {error:.{places}f}"
