"""Units of torsional engineering, read exactly: ``"13.3 kNm/rad"`` is the fraction 13300 in N*m/rad.

One table of atoms, SI prefixes only where an engineer writes them, and concatenated units (``kNm``, ``Nms``,
``kgm²``) only from a list, never guessed. The radian is dimensionless; the cycle is not, so ``50 Hz`` can never be
taken for 50 rad/s. ``/`` binds left to right: ``N*m/rad/s`` is N*m/(rad*s), and ``rad/N*m`` is (rad/N)*m.

>>> parse_quantity("13.3 kNm/rad").value
Fraction(13300, 1)
>>> parse_quantity("0.5 kg*m^2 GD2").value
Fraction(1, 8)
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from numbers import Integral
from numbers import Real as RealNumber

from torsionnet.base.errors import (
    WRITE,
    Fault,
    FaultyValueError,
    Remedy,
    did_you_mean,
    nearest,
    question,
)

__all__ = ["convert"]

Real = Fraction | float
RPM = 60 / (2 * math.pi)
"""Speed of 1 rad/s in r/min, 60/(2 pi)."""
_MAX_LENGTH, _MAX_EXPONENT, _MAX_DECIMAL_EXPONENT, _MAX_DEPTH = 100, 6, 330, 10
_SAFE_LENGTH = 40
"""Characters of a quantity up to which its value is far inside the range of floats, with so few digits and so short a
unit."""


class UnitError(FaultyValueError):
    """Error of a unit or quantity that cannot be read, or has the wrong dimension."""


@dataclass(frozen=True)
class Dimension:
    """Physical dimension as exponents of kg, m, s, cycle and kelvin; the radian counts as 1.

    >>> str(Dimension(kg=Fraction(1), m=Fraction(2)))
    'kg*m^2'
    """

    kg: Fraction = Fraction(0)
    m: Fraction = Fraction(0)
    s: Fraction = Fraction(0)
    cycle: Fraction = Fraction(0)
    K: Fraction = Fraction(0)

    def __mul__(self, other: Dimension) -> Dimension:
        kg, m, s = self.kg + other.kg, self.m + other.m, self.s + other.s
        return Dimension(kg, m, s, self.cycle + other.cycle, self.K + other.K)

    def __truediv__(self, other: Dimension) -> Dimension:
        kg, m, s = self.kg - other.kg, self.m - other.m, self.s - other.s
        return Dimension(kg, m, s, self.cycle - other.cycle, self.K - other.K)

    def __pow__(self, power: Fraction | int) -> Dimension:
        return Dimension(self.kg * power, self.m * power, self.s * power, self.cycle * power, self.K * power)

    def __str__(self) -> str:
        if self in _SI_TEXT:
            return _SI_TEXT[self]
        parts = [(name, getattr(self, name)) for name in ("kg", "m", "s", "cycle", "K")]
        return "*".join(name if e == 1 else f"{name}^{e}" if e.denominator == 1 else f"{name}^({e})"
                        for name, e in parts if e)  # fmt: skip


@dataclass(frozen=True)
class Unit:
    """Unit as a factor to SI and a dimension; the factor is exact unless it contains pi."""

    factor: Real
    dimension: Dimension
    text: str


@dataclass(frozen=True)
class Quantity:
    """Value in SI units with its dimension; ``dimension`` is None for a bare number, ``text`` is what was written."""

    value: Real
    dimension: Dimension | None
    text: str


_Atom = tuple[Real, Dimension]
_NUMBER = Dimension()
_MASS, _LENGTH, _TIME = Dimension(kg=Fraction(1)), Dimension(m=Fraction(1)), Dimension(s=Fraction(1))
_CYCLE, _RATE = Dimension(cycle=Fraction(1)), _NUMBER / _TIME
_FORCE = _MASS * _LENGTH / _TIME**2
_PRESSURE, _ENERGY = _FORCE / _LENGTH**2, _FORCE * _LENGTH
_LB, _G0, _INCH = Fraction("0.45359237"), Fraction("9.80665"), Fraction("0.0254")
_PREFIXES = {"G": Fraction(10**9), "M": Fraction(10**6), "k": Fraction(1000), "": Fraction(1),
             "c": Fraction(1, 100), "m": Fraction(1, 1000), "u": Fraction(1, 10**6),
             "n": Fraction(1, 10**9)}  # fmt: skip

# name: (factor, dimension, prefixes an engineer writes)
_BASE: dict[str, tuple[Real, Dimension, str]] = {
    "g": (Fraction(1, 1000), _MASS, "km"), "t": (Fraction(1000), _MASS, ""), "lb": (_LB, _MASS, ""),
    "lbm": (_LB, _MASS, ""), "oz": (_LB / 16, _MASS, ""), "slug": (_LB * _G0 / (12 * _INCH), _MASS, ""),
    "m": (Fraction(1), _LENGTH, "kcmu"), "in": (_INCH, _LENGTH, ""), "ft": (12 * _INCH, _LENGTH, ""),
    "s": (Fraction(1), _TIME, "mun"), "min": (Fraction(60), _TIME, ""), "h": (Fraction(3600), _TIME, ""),
    "d": (Fraction(86400), _TIME, ""),
    "N": (Fraction(1), _FORCE, "GMkm"), "daN": (Fraction(10), _FORCE, ""), "kgf": (_G0, _FORCE, ""),
    "kp": (_G0, _FORCE, ""), "lbf": (_LB * _G0, _FORCE, ""), "ozf": (_LB * _G0 / 16, _FORCE, ""),
    "kip": (1000 * _LB * _G0, _FORCE, ""), "J": (Fraction(1), _ENERGY, "Mk"),
    "Pa": (Fraction(1), _PRESSURE, "GMk"), "psi": (_LB * _G0 / _INCH**2, _PRESSURE, ""),
    "ksi": (1000 * _LB * _G0 / _INCH**2, _PRESSURE, ""), "bar": (Fraction(10**5), _PRESSURE, ""),
    "W": (Fraction(1), _ENERGY / _TIME, "GMk"),
    "rad": (Fraction(1), _NUMBER, "mu"), "deg": (math.pi / 180, _NUMBER, ""), "rev": (2 * math.pi, _NUMBER, ""),
    "gon": (math.pi / 200, _NUMBER, ""), "arcmin": (math.pi / 10800, _NUMBER, ""), "%": (Fraction(1, 100), _NUMBER, ""),
    "ppm": (Fraction(1, 10**6), _NUMBER, ""),
    "rpm": (math.pi / 30, _RATE, ""), "r/min": (math.pi / 30, _RATE, ""),
    "rps": (2 * math.pi, _RATE, ""), "Hz": (Fraction(1), _CYCLE / _TIME, "Mkm"),
    "cpm": (Fraction(1, 60), _CYCLE / _TIME, ""), "cycle": (Fraction(1), _CYCLE, ""),
    "K": (Fraction(1), Dimension(K=Fraction(1)), ""),
}  # fmt: skip
_ATOMS: dict[str, _Atom] = {
    prefix + name: (_PREFIXES[prefix] * factor, dimension)
    for name, (factor, dimension, prefixes) in _BASE.items()
    for prefix in ("", *prefixes)
}
# Units written without an operator: each entry spells out its factors, nothing is guessed.
_JOINED = {"Nm": "N m", "daNm": "daN m", "kNm": "kN m", "MNm": "MN m", "GNm": "GN m", "mNm": "mN m", "Nmm": "N mm",
           "Ncm": "N cm", "Nms": "N m s", "kNms": "kN m s", "MNms": "MN m s", "mNms": "mN m s", "kgfm": "kgf m",
           "kgm^2": "kg m m", "kgcm^2": "kg cm cm", "kgmm^2": "kg mm mm", "gcm^2": "g cm cm", "gmm^2": "g mm mm",
           "tm^2": "t m m", "kgm2": "kg m m"}  # fmt: skip
ANGLES = frozenset(name for name, (_, dimension) in _ATOMS.items() if dimension == _NUMBER and name not in ("%", "ppm"))
"""Names of the units that stand for an angle."""
_ANGULAR = {*ANGLES, "rpm", "r/min", "rps", *(name for name, (_, dimension) in _ATOMS.items() if dimension.cycle)}


for _joined, _factors in _JOINED.items():
    _joined_factor, _joined_dimension = Fraction(1), _NUMBER
    for _name in _factors.split():
        _joined_factor *= Fraction(_ATOMS[_name][0])
        _joined_dimension *= _ATOMS[_name][1]
    _ATOMS[_joined] = _joined_factor, _joined_dimension
KNOWN_UNITS = tuple(_ATOMS)
"""Names of all units that stand alone, with their prefixes, in the order of the table."""
_LEAST_SUGGESTED = 3
"""Fewest letters of a misread unit for which any similar one is suggested: shorter ones resemble many."""
_SQUARED = "|".join(sorted((name[:-2] for name in _JOINED if name.endswith("^2")), key=len, reverse=True))
_TOKEN = re.compile(
    rf"\s*(?:(?P<power>(?:\^|\*\*)\s*(?P<exponent>[+-]?\d+|\([+-]?\d+(?:/\d+)?\)))|(?P<atom>(?:{_SQUARED})(?:\^|\*\*)2"
    r"(?!\d)|%|r/min(?![A-Za-z])|[A-Za-z_]+\d*)|(?P<one>1(?![\d.]))|(?P<sign>[*/()]))",
)
_MEAN = {"lbin": "lbf*in", "inlb": "lbf*in", "lbft": "lbf*ft", "ftlb": "lbf*ft", "sec": "s", "Kg": "kg", "KNm": "kNm",
         "NM": "Nm", "degree": "deg", "rads": "rad/s", "inch": "in", "°": "deg", "r": "rev", "KN": "kN"}  # fmt: skip
AMBIGUOUS = {"kgm": '"kg*m" or "kgm^2"', "U": '"rpm" or "rev"'}
"""Units that may be meant, as messages list them, by a text that could be any of them."""
CELSIUS = "degC"
"""Name of the unit of a temperature in °C, not of a difference: it stands alone after a number, and has an offset
instead of a factor."""
_ICE = Fraction("273.15")
_SIGNS = str.maketrans({"·": "*", "⋅": "*", "∙": "*", "×": "*", "µ": "u", "μ": "u", "°": "deg",
                        "\N{NO-BREAK SPACE}": " ", "\N{NARROW NO-BREAK SPACE}": " ", "−": "-"})  # fmt: skip
_RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_DISC = re.compile(r"^(.*\S)(?:\s+|\s*\*\s*)(GD|WR|WK)\^?2$")


def _plain(text: str) -> str:
    text = text.translate(_SIGNS)
    return re.sub("[⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+", lambda raised: "^" + raised[0].translate(_RAISED), text).strip()


def _tokens(text: str, written: str) -> list[re.Match[str]]:
    """Atoms, ones, signs, parentheses and powers of a unit, in their order; ``written`` is for messages."""
    tokens: list[re.Match[str]] = []
    position = 0
    while position < len(text):
        token = _TOKEN.match(text, position)
        if token is None:
            hint = _hint(text[position:], written)[0]
            raise _refusal(written, f'cannot be read from "{text[position:].strip()}" on{hint}')
        tokens.append(token)
        position = token.end()
    return tokens


def _refusal(written: str, what: str) -> UnitError:
    return UnitError(f'the unit "{written}" {what}', kind="unknown-unit")


def _product(tokens: list[re.Match[str]], written: str, depth: int = 0) -> tuple[Real, Dimension, bool]:
    """Factor and dimension of a product of units up to its closing parenthesis, and whether a power is in it.

    ``product := power (("*" | "/" | nothing) power)*``. Tokens, the next one last, are taken out as they are read.
    """
    factor: Real = Fraction(1)
    dimension, sign, has_power = _NUMBER, "*", False
    while True:
        # operand := atom | "1" | "(" product ")"
        token = tokens.pop() if tokens else None
        if token is None or token["power"] or token[0].strip() in ("*", "/", ")"):
            raise _refusal(written, "has an empty part: a unit is missing before or after an operator or parenthesis")
        name, is_raised = token["atom"], False
        if name:
            known = name.replace("**", "^")
            if known not in _ATOMS:
                hint, meant = _hint(known)
                text = f'"{known}" is not a known unit{hint}'
                raise UnitError(Fault(text, kind="unknown-unit", about=known, meant=meant))
            other, second = _ATOMS[known]
        elif token["one"]:
            other, second = Fraction(1), _NUMBER
        else:
            if depth == _MAX_DEPTH:
                raise _refusal(written, f"has more than {_MAX_DEPTH} nested parentheses")
            other, second, is_raised = _product(tokens, written, depth + 1)
            if not tokens:
                raise _refusal(written, 'lacks a ")"')
            tokens.pop()
        # power := operand ("^" exponent)?
        if tokens and tokens[-1]["power"]:
            if is_raised or name in _JOINED:
                raise _refusal(
                    written, "leaves open what the power belongs to; write products with * and one power per unit"
                )
            text = tokens.pop()["exponent"].strip("()")
            if len(text) > len("-6/6") or text.endswith("/0") or abs(Fraction(text)) > _MAX_EXPONENT:
                raise _refusal(written, f"has the exponent {text}; at most {_MAX_EXPONENT} is allowed")
            exponent, is_raised = Fraction(text), True
            other = other ** (int(exponent) if exponent.denominator == 1 else exponent)
            second = second**exponent
        # "/" divides by the next power only
        factor = factor / other if sign == "/" else factor * other
        dimension = dimension / second if sign == "/" else dimension * second
        has_power |= is_raised
        sign = tokens[-1][0].strip() if tokens else ")"
        if sign == ")":
            return factor, dimension, has_power
        if sign in ("*", "/"):
            tokens.pop()


def _hint(name: str, written: str = "") -> tuple[str, str]:
    """End of the message on an unknown unit, and the one unit that was probably meant, both of which may be empty."""
    bare = name.rstrip("0123456789")
    if name == CELSIUS:
        return "; degC stands alone after a temperature, as in 60 degC; differences are in K", ""
    if name in AMBIGUOUS:
        return f"; did you mean {AMBIGUOUS[name]}?", ""
    if name in _MEAN:
        return question(_MEAN[name]), _MEAN[name]
    if bare != name and bare in _ATOMS:
        meant = f"{bare}^{name[len(bare) :]}"
        return question(meant), meant
    if bare in ("GD", "WR", "WK"):
        return f"; {name} stands once, at the end, after a unit of inertia", ""
    if name.startswith(("-", ".")):
        products = re.sub(r"(?<=[A-Za-z0-9²³])[.\-](?=[A-Za-z])", "*", written)
        products = re.sub(r"(?<=[A-Za-z])([23])(?=$|[*/)])", r"^\1", products)  # s2 is s^2
        forms = [] if re.search(r"[.\-]", products) else [products, with_forces(products)]
        return '; write "*" between units' + next((f", as in {text}" for text in forms if _is_known(text)), ""), ""
    near = [known for known in _ATOMS if len(name) >= _LEAST_SUGGESTED or (len(name) > 1 and set(name) <= set(known))]
    meant = nearest(name, near)
    return question(meant), meant


def with_forces(text: str) -> str:
    """Text of a unit or quantity with units of force for pounds, ounces and kilograms."""
    return re.sub(r"\b(lb|oz|kg)\b", r"\1f", text)


def _is_known(text: str) -> bool:
    try:
        return parse_unit(text).dimension in DIMENSIONS.values()
    except UnitError:
        return False


@lru_cache(maxsize=1024)
def parse_unit(text: str) -> Unit:
    """Unit that a text names, with its factor to SI and its dimension; raises :class:`UnitError`.

    >>> parse_unit("lbf·in·s²").dimension == parse_unit("kg*m^2").dimension
    True
    >>> try:
    ...     parse_unit("kNn/rad")
    ... except UnitError as error:
    ...     print(error)
    "kNn" is not a known unit; did you mean "kN"?
    """
    if not text.strip() or len(text) > _MAX_LENGTH:
        raise UnitError(
            "the unit is empty" if not text.strip() else f"a unit has at most {_MAX_LENGTH} characters",
            kind="unknown-unit",
        )
    plain = _plain(text)
    disc = _DISC.match(plain)
    # GD² in kgf*m² is, by the custom of its catalogues, a mass in kg: G is read from scales, it is no force.
    tokens = _tokens(re.sub(r"\b(kg|lb)f(?=m?\b)", r"\1", disc[1]) if disc else plain, text)
    is_angular = any(token["atom"] in _ANGULAR for token in tokens)
    tokens.reverse()
    factor, dimension, _ = _product(tokens, text)
    if tokens:
        raise _refusal(text, 'has a ")" too many')
    if disc and dimension != DIMENSIONS["inertia"]:
        what = f"has {disc[2]}2 after something that is no inertia; write for example kg*m^2 {disc[2]}2"
        raise _refusal(text, what)
    if dimension == _RATE and not is_angular:
        raise _refusal(text, "leaves open what turns or repeats; write rad/s, rpm, rev/s or Hz")
    # GD^2 with the diameter is four times the inertia with the radius.
    return Unit(factor / 4 if disc and disc[2] == "GD" else factor, dimension, text)


def has_angle(text: str) -> bool:
    """Whether a unit as written has an angle in it, which counts as 1 in dimensions.

    >>> has_angle("kN*m/rad"), has_angle("N*m"), has_angle("deg"), has_angle("")
    (True, False, True, False)
    """
    return any(token[0].strip() in ANGLES for token in _tokens(_plain(text), text))


NUMERAL = re.compile(r"([+-]?)([0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE]([+-]?[0-9]+))?")


def parse_number(text: str) -> Fraction:
    """Exact value of a decimal numeral; a huge exponent is refused, not calculated.

    >>> parse_number("2.5e-3")
    Fraction(1, 400)
    """
    numeral = NUMERAL.fullmatch(text)
    if numeral is None:
        raise UnitError(Fault(f'expected a number, got "{text}"', kind="not-a-number"))
    return Fraction(*_ratio(numeral))


def _ratio(numeral: re.Match[str]) -> tuple[int, int]:
    sign, mantissa, exponent = numeral.groups()
    if mantissa[0] == "0" and mantissa[1:2].isdigit():
        text = f'"{numeral[0]}" begins with 0, which some programs read as octal; leave the 0 out'
        raise UnitError(Fault(text, kind="ambiguous-number"))
    if exponent and (len(exponent) > len("+0330") or abs(int(exponent)) > _MAX_DECIMAL_EXPONENT):
        raise UnitError(f'"{numeral[0]}" is too large or too small a number', kind="not-finite")
    whole, _, decimals = mantissa.partition(".")
    # Digits times a power of ten, in whole numbers throughout.
    power = int(exponent or 0) - len(decimals)
    digits = int(sign + whole + decimals)
    return (digits * 10**power, 1) if power >= 0 else (digits, 10**-power)


@lru_cache(maxsize=4096)
def parse_quantity(text: str) -> Quantity:
    """Value in SI units and dimension of a number with or without a unit; raises :class:`UnitError`.

    >>> parse_quantity("0.078 kgm²").value
    Fraction(39, 500)
    >>> try:
    ...     parse_quantity("13,3 kN*m/rad")
    ... except UnitError as error:
    ...     print(error)
    "13,3 kN*m/rad" has a decimal comma; write 13.3 kN*m/rad
    """
    if len(text) > _MAX_LENGTH:
        raise UnitError(f"a quantity has at most {_MAX_LENGTH} characters", kind="unknown-unit")
    written = text.strip()
    numeral = NUMERAL.match(written)
    if numeral is None:
        infinite = written.lower().lstrip("+-.") in ("inf", "infinity", "nan")
        text = f'expected a number, got "{written}"' + ("; it has to be finite" if infinite else "")
        raise UnitError(Fault(text, kind="not-a-number"))
    rest = written[numeral.end() :]
    if rest and _STRAY.match(rest):
        raise UnitError(misread(written))
    if rest and _plain(rest) == CELSIUS:
        return _celsius(numeral, written)
    unit = parse_unit(rest.strip()) if rest else None
    above, below = _ratio(numeral)
    factor: Real = unit.factor if unit else 1
    # Fraction * Fraction would take most of the time of reading a model.
    value: Real
    if isinstance(factor, float):
        try:
            value = above / below * factor
        except OverflowError:
            value = math.inf  # which is out of range
    else:
        value = Fraction(above * factor.numerator, below * factor.denominator)
    if numeral[3] or len(written) > _SAFE_LENGTH:
        _check_range(value, written)
    return Quantity(value, unit.dimension if unit else None, written)


def _celsius(numeral: re.Match[str], written: str) -> Quantity:
    value = Fraction(*_ratio(numeral)) + _ICE
    _check_range(value, written)
    if value < 0:
        raise UnitError(f'"{written}" is below absolute zero', kind="out-of-range")
    return Quantity(value, DIMENSIONS["temperature"], written)


_STRAY = re.compile(r"[,:;.'’_]|\s*(?!1\s*/)[0-9]")


def misread(written: str) -> Fault:
    """Fault of a number whose digits do not stand together."""
    if re.match(r"[+-]?[0-9]+:[0-9]", written):
        text = f'expected a number, got "{written}"; write the ratio as a number (3.0) or give teeth: [z1, z2]'
        return Fault(text, kind="not-a-number", remedy=Remedy(WRITE, "3.0", old=written))
    either = re.match(r"([+-]?[1-9][0-9]{0,2}),([0-9]{3})(?![0-9,.])", written)
    if either:
        whole, rest = f"{either[1]}{either[2]}", written[either.end() :]
        return Fault(
            f'"{written}" is ambiguous; write {either[1]}.{either[2]}{rest} or {whole}{rest}', kind="ambiguous-number"
        )
    comma = re.match(r"([+-]?[0-9]+),([0-9]+)(?![0-9,.])", written)
    if comma:
        meant = f"{comma[1]}.{comma[2]}{written[comma.end() :]}"
        return Fault(f'"{written}" has a decimal comma; write {meant}', kind="decimal-comma")
    grouped = re.match(r"([+-]?[0-9]{1,3}(?:[,.'’_\s][0-9]{3})+)(?:[.,]([0-9]+))?", written)
    if grouped:
        decimals = f".{grouped[2]}" if grouped[2] else ""
        number = f"{re.sub('[^0-9+-]', '', grouped[1])}{decimals}"
        text = f'"{written}" has thousands separators; write {number}'
        digits = re.match(r"[-+0-9_' .,]*[0-9]", written)
        return Fault(text, remedy=Remedy(WRITE, number, old=digits[0] if digits else written), kind="ambiguous-number")
    text = f'expected a number and a unit, got "{written}"; digits stand together, with one decimal point'
    return Fault(text, kind="not-a-number")


def _check_range(value: Real, written: str) -> None:
    try:
        size = abs(float(value))
    except OverflowError:
        size = math.inf
    if math.isinf(size) or (size == 0.0 and value):
        raise UnitError(f'"{written}" is too large or too small a number', kind="not-finite")


def exact(value: Real | RealNumber) -> Fraction:
    """Fraction equal to the shortest decimal that gives the float.

    Raises :class:`UnitError` beyond the range of a float.

    >>> exact(0.1)
    Fraction(1, 10)
    """
    try:
        size = float(value)
    except OverflowError:
        raise UnitError("the number is too large", kind="not-finite") from None
    if not math.isfinite(size) or (size == 0.0 and value):  # the zero of sympy is not equal to 0, but false
        raise UnitError(f"expected a finite number that is not too small, got {value}", kind="not-a-number")
    if isinstance(value, Fraction):
        return value
    # numpy's integers and floats come here, too, and write themselves differently.
    if type(value) is not float and isinstance(value, Integral):
        return Fraction(int(value))
    return Fraction(*Decimal(float.__repr__(size)).as_integer_ratio())


def numeral_of(value: Fraction) -> str:
    """Text of a fraction as a decimal numeral if that is exact and short, else as a quotient.

    >>> numeral_of(Fraction(1, 8)), numeral_of(Fraction(1, 3))
    ('0.125', '1/3')
    """
    if value.denominator == 1 and abs(value) < 10**16:
        return str(value)
    try:
        short = repr(float(value))
    except OverflowError:
        return str(value)
    return short if Fraction(short) == value else str(value)


# The names of dimensions with the SI unit that messages show; the later of two equal dimensions wins in ``str``.
_EXPECTED = {"inertia": "kg*m^2", "cubic stiffness": "N*m/rad^3", "stiffness": "N*m/rad", "torque": "N*m",
             "damping": "N*m*s/rad",
             "compliance": "rad/(N*m)", "angle": "rad", "speed": "rad/s", "acceleration": "rad/s^2", "length": "m",
             "mass": "kg", "density": "kg/m^3", "pressure": "Pa", "shear modulus": "Pa", "frequency": "Hz", "time": "s",
             "power": "W", "heat flux": "W/m^2", "heat transfer": "W/K", "area": "m^2", "temperature": "K",
             "force": "N", "linear stiffness": "N/m", "velocity": "m/s", "per velocity": "s/m", "1": "1"}  # fmt: skip
_SI_TEXT: dict[Dimension, str] = {}
DIMENSIONS: dict[str, Dimension] = {"inertia": _MASS * _LENGTH**2}
"""Dimension of each physical quantity of a model, by the name of the quantity."""
DIMENSIONS |= {name: parse_unit(text).dimension for name, text in _EXPECTED.items()}
_SI_TEXT |= {DIMENSIONS[name]: text for name, text in _EXPECTED.items()}


def expected_unit(dimension_name: str) -> str:
    """SI unit of a named dimension as text for messages.

    >>> expected_unit("stiffness")
    'N*m/rad'
    """
    if dimension_name not in _EXPECTED:
        raise UnitError(
            f'no dimension is named "{dimension_name}"{did_you_mean(dimension_name, _EXPECTED)}', kind="unknown-word"
        )
    return _EXPECTED[dimension_name]


def convert(value: float, unit: str, to: str) -> float:
    """Value converted from one unit to another of the same dimension.

    >>> convert(1.0, "kNm/deg", "N*m/rad") == 180000 / math.pi
    True
    >>> convert(50.0, "Hz", "rad/s")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    torsionnet.base.units.UnitError: "Hz" (Hz) cannot be converted to "rad/s" (rad/s); a cycle is 2*pi rad: ...
    """
    source, target = parse_unit(unit), parse_unit(to)
    if source.dimension == target.dimension:
        return float(value * float(source.factor / target.factor))
    apart = source.dimension / target.dimension
    hint = "; a cycle is 2*pi rad: 1 Hz is 60 rpm" if apart == _CYCLE ** int(apart.cycle) else ""
    raise UnitError(
        f'"{unit}" ({source.dimension}) cannot be converted to "{to}" ({target.dimension}){hint}', kind="wrong-unit"
    )


def __dir__() -> list[str]:
    return sorted(__all__)
