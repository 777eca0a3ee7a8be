"""Meanings that columns of a mass-elastic sheet can have, and the words of makers for them, in English and German."""

from __future__ import annotations

import re
from dataclasses import dataclass

from torsionnet.core.units import DIMENSIONS, Dimension

DAMPING = "damping"
"""Meaning of a sheet's damping column that does not say whether it acts to ground or in the shaft."""


@dataclass(frozen=True)
class Meaning:
    """Meaning that a column of a mass-elastic sheet can have, with dimensions and words for it."""

    key: str
    shown: str
    dimensions: tuple[str, ...]
    words: re.Pattern[str]
    example: str

    @property
    def is_text(self) -> bool:
        """Whether a column of this meaning holds text, not numbers."""
        return not self.dimensions

    @property
    def needs_unit(self) -> bool:
        """Whether the values of a column of this meaning need a unit."""
        return bool(self.dimensions) and self.dimensions != ("1",)

    def fits(self, dimension: Dimension | None) -> bool:
        """Whether a column whose unit has this dimension may have this meaning; None is no unit."""
        if dimension is None:
            return True
        return any(DIMENSIONS[name] == dimension for name in self.dimensions)


def _meaning(key: str, shown: str, dimensions: str, words: str, example: str) -> Meaning:
    pattern = re.compile(words, re.VERBOSE)
    return Meaning(key, shown, tuple(filter(None, dimensions.split(","))), pattern, example)


_DAMP = r"(?:damp|dämpf|daempf)"
MEANINGS = (
    _meaning("number", "number", "", r"(?:(?:mass|masse|station|shaft|item|pos|lfd|node)\ )?(?:no|nr|number|nummer|\#)"
             r"|pos|position|station|node|knoten", "No."),
    _meaning("from", "from mass", "", r"from(?:\ .*)?|von(?:\ .*)?|connected\ from|previous.*|start", "from"),
    _meaning("to", "to mass", "", r"to(?:\ .*)?|nach(?:\ .*)?|connect.*\ to|next.*|bis|anschluss.*|end", "to"),
    _meaning("inertia", "inertia", "inertia", r".*(?:inertia|trägheit|traegheit|drehmasse|schwungmoment|gd\ ?[2²]"
             r"|w[rk]\ ?[2²]).*|j|θ|theta|mmi|moi|i|j\ (?!max).{1,4}", "J [kg*m^2]"),
    _meaning("psi", "relative damping psi", "1", rf"psi|ψ|rel.*{_DAMP}.*|verhältnismäss.*{_DAMP}.*|{_DAMP}.*(?:psi|ψ)",
             "psi"),
    _meaning("magnifier", "dynamic magnifier", "1", r".*magnif.*|.*vergrösserung.*|m|m\ dyn|q", "magnifier"),
    _meaning("eta", "loss factor", "1", r".*(?:loss\ factor|verlustfaktor|verlustwinkel).*|eta|η", "loss factor"),
    _meaning("zeta", "damping ratio", "1", rf".*(?:{_DAMP}\w*\ ratio|critical|{_DAMP}ungsgrad|lehr).*|zeta|ζ|d",
             "zeta"),
    _meaning("absolute", "damping to ground", "damping", rf".*(?:abs|extern|äusser|aeusser|ground|mass).*{_DAMP}.*"
             rf"|{_DAMP}.*(?:abs|extern|ground|mass).*|outer\ {_DAMP}.*"
             r"|[bcd]\ (?:abs|ext|mass|ground)\w*", "absolute damping [N*m*s/rad]"),
    _meaning("relative", "damping of the shaft", "damping", rf".*(?:rel|intern|inner|shaft|welle|material).*{_DAMP}.*"
             rf"|{_DAMP}.*(?:rel|intern|shaft).*"
             r"|[bcd]\ (?:rel|int|shaft)\w*", "relative damping [N*m*s/rad]"),
    _meaning(DAMPING, "damping", "damping,1", rf".*{_DAMP}.*|b|c", "absolute damping [N*m*s/rad]"),
    _meaning("stiffness", "stiffness", "stiffness,compliance",
             r".*(?:stiff|rigidity|steifigkeit|federkonst|spring\ (?:rate|const)|complian|elasticity|flexib|nachgieb"
             r"|elastizit).*|[kce](?:[\ ]?(?:t|dyn|tdyn|t\ dyn|tot|\d))?", "k [N*m/rad]"),
    _meaning("outer", "outer diameter", "length",
             r"(?:outer|outside|extern|aussen|äusser|shaft|wellen).*(?:dia|durchm|ø).*"
             r"|(?:dia|durchm)\w*(?:\ (?:outer|outside|ext|a|o))?|d|d\ ?[ao]|d\ outer|(?:shaft\ )?od|ø|aussen\ ?ø",
             "outer diameter [mm]"),
    _meaning("inner", "inner diameter", "length", r"(?:inner|inside|intern|innen).*(?:dia|durchm|ø).*|bore.*|bohrung.*"
             r"|dia\w*\ (?:inner|inside|int|i)|d\ ?i|d\ inner|(?:shaft\ )?id", "inner diameter [mm]"),
    _meaning("length", "length", "length", r"(?:shaft\ )?length|länge|laenge|l", "length [mm]"),
    _meaning("ratio", "speed ratio", "1", r".*(?:speed|rpm|drehzahl).*(?:ratio|factor|verhältnis|faktor)|rel.*speed"
             r"|ratio\ of\ speeds?|n\ ?/\ ?n\ ?\d?", "speed ratio"),
    _meaning("gear ratio", "gear ratio", "1", r".*(?:gear|transmission).*ratio.*|ratio|.*übersetzung.*|i",
             "speed ratio"),
    _meaning("speed", "speed", "speed", r".*(?:speed|drehzahl|rpm).*|n", "speed [rpm]"),
    _meaning("name", "name", "", r"(?:(?:mass|station|element|shaft)\ )?(?:name|description|designation|text)"
             r"|bezeichnung|benennung|beschreibung|mass|masses|masse|element|component|part|item|bauteil"
             r"|drehmasse|komponente|what", "name"),
)  # fmt: skip
"""Meanings that columns of a sheet can have, the likeliest first where a heading fits several."""
BY_KEY = {meaning.key: meaning for meaning in MEANINGS}
"""Meanings of columns by their key, as ``inertia``."""

_REFERRED = re.compile(
    r"\b(?:referred|reduced|reduziert\w*|red|bezogen\w*|equivalent)\b|\bref(?:\.|\b)(?!\s*(?:no|nr|erence))"
)
_REAL = re.compile(
    r"\b(?:real|actual|true|unreduced|unreferred|tatsächlich\w*|(?:not|nicht) (?:referred|reduced|reduziert|bezogen))\b"
)
_SIDE_WORDS = re.compile(
    r"\b(?:referred|reduced|reduziert\w*|red|bezogen\w*|equivalent|ref|real|actual|true|unreduced|unreferred|tatsächlich\w*)\b"
    r"|\b(?:to|auf)(?: (?:the|die))? (?:crank\w*|kurbel\w*|engine\w*|motor\w*|propeller\w*|shaft \w+)"
)


def is_referred(text: str) -> bool | None:
    """Whether a text says that values are referred to one speed (True) or real (False); None if it says neither.

    >>> is_referred("J red."), is_referred("all values are real"), is_referred("Drehmasse")
    (True, False, None)
    """
    folded = text.casefold()
    if _REAL.search(folded):
        return False
    return True if _REFERRED.search(folded) else None


def plain_heading(text: str) -> str:
    """Heading of a sheet's column in the form that is compared with words.

    Small letters, single blanks, no note on referring.

    >>> plain_heading("J_red. (referred to crank)"), plain_heading("Rel.-Damp.")
    ('j', 'rel damp')
    """
    bare = re.sub(r"[_\-.:,;()\[\]\s]+", " ", text.casefold()).strip()
    return " ".join(_SIDE_WORDS.sub(" ", bare).split())


def meanings_of(heading: str) -> list[Meaning]:
    """Meanings that the words of a column's heading may have, the likeliest first.

    >>> [meaning.key for meaning in meanings_of("Massenträgheitsmoment")], [one.key for one in meanings_of("Mass")]
    (['inertia'], ['name'])
    """
    plain = plain_heading(heading)
    return [meaning for meaning in MEANINGS if meaning.words.fullmatch(plain)]
