"""Headings of sheets taken apart into words, unit and factor (as x 10^-6), so that no part is passed over.

Reading of units in the spellings of mass-elastic sheets. With powers of ten, points for products, and in headings
without brackets.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from fractions import Fraction

from torsionnet.base.delimited.dialect import plain_unit, split_heading
from torsionnet.base.units import DIMENSIONS, Dimension, Real, UnitError, parse_unit

# Reading of units in the spellings of mass-elastic sheets.

_RAISED_UNIT = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_UNIT_POWER = r"(?:10\s*(?:\^|\*\*)?\s*\(?(?P<ten{0}>[+-]?[1-9]\d?)\)?|1?\s?[eE](?P<e{0}>[+-]?\d\d?))"
"""Regular expression of a power of ten before or after a unit; the braces number its groups."""
_BEFORE = re.compile(rf"[x×*·]?\s*{_UNIT_POWER.format(1)}\s*[*·x×]?\s*(?P<unit>[A-Za-z(1µμ°].*)")
_AFTER = re.compile(rf"(?P<unit>.*\S)\s*[*·x×]\s*{_UNIT_POWER.format(2)}")
_DOUBTFUL = re.compile(r"10\s?[eE][+-]?\d+")
_KNOWN = {DIMENSIONS[name] for name in ("inertia", "stiffness", "compliance", "damping", "length")}


@dataclass(frozen=True)
class SheetUnit:
    """Unit of a sheet column, with its factor to SI and its dimension.

    ``text`` and ``power`` (of ten) are for a model file.
    """

    factor: Real
    dimension: Dimension
    text: str
    power: int = 0

    def times(self, factor: Fraction) -> SheetUnit:
        """Unit multiplied by a factor; without a text where that is no power of ten."""
        digits = len(str(max(factor.numerator, factor.denominator))) - 1
        power = digits if factor > 1 else -digits
        scaled = self.factor * factor if isinstance(self.factor, Fraction) else self.factor * float(factor)
        text, added = (self.text, power) if factor == Fraction(10) ** power else ("", 0)
        return SheetUnit(scaled, self.dimension, text, self.power + added)


def sheet_unit(text: str) -> SheetUnit:
    """Unit that a text of a sheet names, with its factor to SI and its dimension; raises UnitError.

    >>> unit = sheet_unit("10⁻⁹ rad/N.m")
    >>> unit.factor, str(unit.dimension), sheet_unit("kg.m2").text, sheet_unit("lb-in/rad").text
    (Fraction(1, 1000000000), 'rad/(N*m)', 'kg*m^2', 'lbf*in/rad')
    """
    bare = text.strip().strip("[]").strip()
    if _DOUBTFUL.match(bare):
        raise UnitError(
            f'"{bare}" is ambiguous: it may be 1e... or 10 times as much; write 1e-9 or 10^-9', kind="ambiguous-number"
        )
    plain = re.sub(r"10([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+)", lambda match: "10^" + match[1].translate(_RAISED_UNIT), bare)
    match = _BEFORE.fullmatch(plain) or _AFTER.fullmatch(plain)
    power = next(int(group) for name, group in match.groupdict().items() if name != "unit" and group) if match else 0
    spelled = _spelled(match["unit"] if match else plain)
    unit = parse_unit(spelled)
    factor = unit.factor * (Fraction(10) ** power if isinstance(unit.factor, Fraction) else 10.0**power)
    return SheetUnit(factor, unit.dimension, spelled, power)


def _spelled(text: str) -> str:
    """Unit of a sheet in a spelling that ``parse_unit`` can read.

    Points and hyphens are products, all after a slash is below it.
    """
    spelled = re.sub(r"(?<=[A-Za-z0-9²³])\s*[.\-]\s*(?=[A-Za-z])", "*", plain_unit(text))
    spelled = re.sub(r"\blbs\b", "lb", re.sub(r"\bsec(?=\b|\d)", "s", spelled))
    spelled = re.sub(r"\b(mm|cm|m|s|in|ft)([23])\b", r"\1^\2", spelled)
    if _dimension(spelled) in _KNOWN:
        return spelled
    above, slash, below = spelled.partition("/")
    gathered = f"{above}/({below.strip()})" if slash and "/" not in below and "(" not in below else spelled
    # A pound is a force where the unit makes no sense with it as a mass: lb-in/rad, but lb-ft2.
    forms = (gathered, *(re.sub(r"\blb\b", "lbf", form) for form in (spelled, gathered)))
    return next((form for form in forms if _dimension(form) in _KNOWN), spelled)


def _dimension(text: str) -> Dimension | None:
    try:
        return parse_unit(text).dimension
    except UnitError:
        return None


def named_unit(heading: str) -> tuple[str, str]:
    """Name and unit, as two texts, in a heading, also where no bracket separates them or more text follows.

    >>> named_unit("compliance 1e-9 rad/Nm"), named_unit("Inertia, kgm2"), named_unit("D outer")
    (('compliance', '1e-9 rad/Nm'), ('Inertia', 'kgm2'), ('D outer', ''))
    >>> named_unit("k [MNm/rad] (referred to crank)")
    ('k (referred to crank)', 'MNm/rad')
    """
    name, unit = split_heading(heading)
    if unit or heading.rstrip().endswith("]"):
        return name, unit
    bracketed = re.fullmatch(r"(?P<name>.*?\S)\s*\((?P<unit>.*)\)", heading.strip())
    if bracketed and _is_unit(bracketed["unit"]):
        return bracketed["name"], bracketed["unit"]
    for bracket in re.finditer(r"\s*[\[(]([^\[\]()]*)[\])]", heading.strip()):
        if _is_unit(bracket[1]):
            return (heading.strip()[: bracket.start()] + heading.strip()[bracket.end() :]).strip(), bracket[1]
    words = re.split(r"(?<=\S)(?:\s*,\s*|\s+/\s+|\s+)", heading.strip())
    for count in range(len(words) - 1, 0, -1):
        tail = " ".join(words[-count:])
        if _is_unit(tail):
            return " ".join(words[:-count]), tail
    return heading.strip(), ""


def _is_unit(text: str) -> bool:
    try:
        unit = sheet_unit(text)
    except UnitError:
        return False
    return unit.dimension != DIMENSIONS["1"] or text.strip() == "%"


_EXPONENT = r"[+\-−]?\d\d?"
_POWER = (
    rf"(?P<doubtful>10\s?[eE]\s?{_EXPONENT})"
    rf"|10\s*(?:(?:\^|\*\*|exp)\s*[({{]?\s*(?P<ten>{_EXPONENT})\s*[)}}]?|(?P<raised>[⁺⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]{{1,2}})"
    r"|(?P<signed>[+\-−]\d\d?))"
    rf"|(?:(?:1(?:[.,]0+)?\s?)|\b)[eE](?P<e>{_EXPONENT})"
    r"|(?P<word>(?i:millions?|mill\.|mio\.?|millionen|thousands?|tausend|tsd\.?))(?![A-Za-z])(?:\s+of\b)?"
)
"""Regular expression of a power of ten: 10^6, 10⁶, 1e6, E6, millions, and 10e6, which may be 10^6 or 10^7."""
_FACTOR = rf"(?:{_POWER}|(?P<plain>(?:\d{{1,3}}(?:[ ,.'’]000)+|\d+(?:[.,]\d+)?)(?![A-Za-z])))(?!\d)"
"""Regular expression of a factor, a power of ten or a plain number such as 1,000,000."""
_TIMES = r"(?:(?:(?<![A-Za-z])|(?<=\b[A-Za-z]))[xX]|[×*·⋅]|(?i:\b(?:times|mal|multiplied\s+by)\b))"
_BY = r"(?:[/÷]|(?i:\b(?:divided\s+by|over)\b))"
_OPERATED = re.compile(rf"\s*(?:{_TIMES}|(?P<by>{_BY}))\s*{_FACTOR}")
_ALONE = re.compile(rf"(?i:in\s+)?(?:{_TIMES}|(?P<by>{_BY}))?\s*{_FACTOR}\s*{_TIMES}?")
_LOOSE = re.compile(rf"(?<![\w.])(?i:in\s+)?(?:{_POWER})(?:\s*{_TIMES})?(?!\w)")
_AHEAD = re.compile(rf"(?i:in\s+)?{_FACTOR}\s*[x×*·⋅]?\s*(?P<rest>[A-Za-zµμ°(%].*)")
_BEHIND = re.compile(rf"(?P<rest>.*[^\s,;])[\s,;]+(?i:in\s+)?{_FACTOR}")
_PER = re.compile(rf"(?P<above>[mµμu]?rad|deg)\s*/\s*\(?\s*{_FACTOR}\s*[x×*·⋅]?\s*(?P<rest>[A-Za-z][^()]*)\)?")
_BRACKET = re.compile(r"(?P<open>[\[(])(?P<inside>(?:[^\[\]()]|\([^()]*\))*)[\])]")
_DISC = re.compile(
    r"(?<![^\W_])(?:(?P<diameter>[GP]\.?\s?D)|W\.?\s?[RK])\s?\^?\s?[2²]"
    r"(?P<divided>(?(diameter)\s*/\s*(?:4(?![\d.])|\(\s*4\s*[.*·]?\s*g\s*\))|\s*/\s*g\b))?",
    re.IGNORECASE,
)
"""Regular expression of GD2, PD2 (four times the inertia), divided by 4 too, and of WR2 and WK2 (the inertia)."""
_CONNECTED = re.compile(r"(?:\s+in|\s*[/,;])\s*$", re.IGNORECASE)
_TAIL = re.compile(r"(?:^|(?<=[\s,/(]))[^\s,/]")
_THOUSAND, _MILLION = Fraction(10**3), Fraction(10**6)
_RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺−", "0123456789-+-")
_NO_TAILS = frozenset({"psi"})
"""Units that rather are words at the end of a heading, as all of one letter but m."""
_OF_SHEETS = {DIMENSIONS[name] for name in ("inertia", "stiffness", "compliance", "damping")}
MOST_CHARACTERS = 150
"""Longest text that is read as a heading; longer ones are none."""
NO_UNIT = frozenset({"", "-", "–", "—", "1"})
"""Texts that stand in the place of a unit where there is none."""


@dataclass(frozen=True)
class HeadingFactor:
    """Factor in the heading of a column, which multiplies the quantity or its unit.

    Behind a quantity or a unit, ``K x 10^-6``, it may mean that the cells are K times 1e-6 (reading ``values``), or
    that they are in 1e-6 units (reading ``unit``). Directly before a unit, ``10^6 N m/rad``, it is a part of the unit.

    Attributes
    ----------
    text : str
        As written.
    value : Fraction or None
        Number by which is multiplied, 1e-6 of ``K/10^6``; None where the text has two values, as 10E6.
    before_unit : bool
        Whether its place makes it a part of the unit.
    """

    text: str
    value: Fraction | None
    before_unit: bool = False

    def scale(self, reading: str) -> Fraction:
        """Number by which a cell is multiplied in a reading, ``unit`` or ``values``."""
        assert self.value
        return self.value if reading == "unit" else 1 / self.value


@dataclass(frozen=True)
class SheetHeading:
    """Heading of a column of a sheet, taken apart.

    Attributes
    ----------
    words : str
        What is neither unit nor factor.
    unit_text : str
        Unit as written, without a factor; empty without one.
    unit : SheetUnit or None
        None without one, and where ``unit_text`` is no unit.
    factor : HeadingFactor or None
        Factor of the quantity or the unit.
    disc : str
        ``GD`` for GD2 or PD2, four times the inertia; ``WR`` for WR2, WK2 and GD2/4, the inertia itself.
    second : str
        A further unit, factor or disc, of which a heading has only one.
    """

    words: str
    unit_text: str = ""
    unit: SheetUnit | None = None
    factor: HeadingFactor | None = None
    disc: str = ""
    second: str = ""


def read_heading(text: str) -> SheetHeading:
    """Heading of a column taken apart into words, unit and factor.

    >>> heading = read_heading("K x 10^-6 (lb-in/rad)")
    >>> heading.words, heading.unit_text, heading.factor.value, heading.factor.before_unit
    ('K', 'lb-in/rad', Fraction(1, 1000000), False)
    >>> heading = read_heading("Stiffness, millions of lb-in/rad")
    >>> heading.words, heading.unit_text, heading.factor.value, heading.factor.before_unit
    ('Stiffness', 'lb-in/rad', Fraction(1000000, 1), True)
    """
    if len(text) > MOST_CHARACTERS:
        return SheetHeading("")
    parts = _Parts()
    words = _DISC.sub(parts.disc_words, _BRACKET.sub(parts.bracket, text.strip()))
    words = _OPERATED.sub(parts.times, words).strip()
    words = _CONNECTED.sub("", parts.tail(words))
    loose = _LOOSE.search(words)
    if loose and words != loose[0]:
        parts.take(loose[0], factor=_factor(loose, parts.unit is not None and bool(loose["word"])))
        words = f"{words[: loose.start()]} {words[loose.end() :]}"
    for unread in parts.unread:
        if parts.unit_text:
            words += f" ({unread})"
        else:
            parts.unit_text = unread
    return SheetHeading(" ".join(words.split()), parts.unit_text, parts.unit, parts.factor, parts.disc, parts.second)


def has_power(text: str) -> bool:
    """Whether a text has a power of ten, or millions or thousands, as a remark may say of values.

    >>> has_power("K values times 10^6"), has_power("10^3 revolutions"), has_power("Drawing 12/345")
    (True, True, False)
    """
    matches = (*_OPERATED.finditer(text), *_LOOSE.finditer(text))
    return any((match.groupdict().get("plain") or "1").strip("0") == "1" for match in matches)


@dataclass
class _Parts:
    """Parts of a heading that were taken out of its text."""

    unit_text: str = ""
    unit: SheetUnit | None = None
    factor: HeadingFactor | None = None
    disc: str = ""
    second: str = ""
    unread: list[str] = field(default_factory=list)

    def take(self, text: str, unit: tuple[str, SheetUnit] | None = None, factor: HeadingFactor | None = None) -> None:
        if (unit and self.unit) or (factor and self.factor):
            self.second = self.second or text.strip()
            return
        self.unit_text, self.unit = unit or (self.unit_text, self.unit)
        self.factor = factor or self.factor

    def bracket(self, match: re.Match[str]) -> str:
        """Text that stays of a bracket: none of one with a unit, a factor, or a sign for no unit."""
        inside = match["inside"].strip()
        measured = None if match["open"] == "(" and _is_symbol(inside) else _measured(inside)
        if measured:
            self.take(inside, *measured)
        elif inside not in NO_UNIT and (alone := _ALONE.fullmatch(inside)):
            self.take(inside, factor=_factor(alone, bool(alone["word"])))
        elif match["open"] == "[" and inside not in NO_UNIT and not _DISC.search(inside):
            self.unread.append(inside)
        elif inside not in NO_UNIT:
            return f" {match[0]} "
        return " "

    def disc_words(self, match: re.Match[str]) -> str:
        self.second = self.second or (match[0] if self.disc else "")
        self.disc = "GD" if match["diameter"] and not match["divided"] else "WR"
        return " "

    def times(self, match: re.Match[str]) -> str:
        self.take(match[0], factor=_factor(match))
        return " "

    def tail(self, words: str) -> str:
        """Words of a heading without the unit at their end, the longest that can be read as one."""
        if self.unit is not None:
            return words
        for start in _TAIL.finditer(words):
            tail = words[start.start() :]
            measured = _measured(tail)
            if measured is None or tail in _NO_TAILS or _is_symbol(tail):
                continue
            dimension = measured[0][1].dimension
            after_slash = words[: start.start()].endswith("/")
            if dimension in _OF_SHEETS or (start.start() and not after_slash and (
                    dimension != DIMENSIONS["1"] or "%" in tail)):  # fmt: skip
                self.take(tail, *measured)
                return words[: start.start()].strip()
        return words


def _is_symbol(text: str) -> bool:
    """Whether a text is a letter, the symbol of a quantity (J, K) rather than a unit; m is a unit."""
    return len(text) == 1 and text not in "m%"


def _measured(text: str) -> tuple[tuple[str, SheetUnit], HeadingFactor | None] | None:
    """Unit with its factor, if any, that a text consists of; None for other texts."""
    per = _PER.fullmatch(text)
    if per:
        unit = f"{per['above']}/({per['rest'].strip()})"
        return ((unit, read), _factor(per, before_unit=True, below=True)) if (read := _unit(unit)) else None
    for pattern in (_AHEAD, _BEHIND):
        if (match := pattern.fullmatch(text)) and (read := _unit(match["rest"])):
            factor = _factor(match, pattern is _AHEAD or bool(match["word"]))
            return (match["rest"].strip(), read), factor
    operated = _OPERATED.search(text)
    if operated:
        rest = f"{text[: operated.start()]} {text[operated.end() :]}".strip(" ,;*·x×")
        return ((rest, read), _factor(operated)) if (read := _unit(rest)) else None
    whole, after = _unit(text), _unit(text[3:]) if text.casefold().startswith("in ") else None
    if after and (whole is None or whole.dimension not in _OF_SHEETS or after.dimension in _OF_SHEETS):
        return (text[3:], after), None  # "in mm", but inches in "in lb/rad"
    return ((text, whole), None) if whole else None


def _unit(text: str) -> SheetUnit | None:
    try:
        unit = sheet_unit(text)
    except UnitError:
        return None
    return None if unit.power else unit


def _factor(match: re.Match[str], before_unit: bool = False, below: bool = False) -> HeadingFactor:
    """Factor that was matched, and whether it stands directly before its unit; ``below`` a slash it divides."""
    groups = match.groupdict()
    power = next((groups[name] for name in ("ten", "raised", "signed", "e") if groups[name]), None)
    value: Fraction | None = None
    if power:
        value = Fraction(10) ** int(power.translate(_RAISED))
    elif groups["word"]:
        value = _THOUSAND if groups["word"].casefold().startswith("t") else _MILLION
    elif groups.get("plain"):
        value = _plain_factor(groups["plain"])
    divides = below or bool(groups.get("by"))
    text = (
        " ".join(match[0].removesuffix(groups.get("rest") or "").split()) if not groups.get("by") else match[0].strip()
    )
    return HeadingFactor(text, 1 / value if value and divides else value or None, before_unit)


def _plain_factor(text: str) -> Fraction | None:
    """Value of a whole or decimal number; None for 106, a 10 that may have lost the line of its power."""
    digits = re.sub(r"[ ,.'’](?=000)", "", text).replace(",", ".")
    return None if re.fullmatch(r"10[2-9]|10[1-9]\d", digits) else Fraction(digits)
