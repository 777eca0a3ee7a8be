"""Meanings that columns of a mass-elastic sheet can have, and the words of makers for them, in English and German."""

from __future__ import annotations

import re
from collections.abc import Container
from dataclasses import dataclass

from torsionnet.base.units import DIMENSIONS, Dimension

# Words of headings and remarks that say whether the values of a sheet are referred to one speed.

_REFERRED = r"(?:referred|reduced|related|equivalent|reduziert\w*|bezogen\w*)"
_REAL = rf"(?:real|actual|true|unreduced|unreferred|tatsächlich\w*|(?:not|nicht)\ {_REFERRED})"
_TURNS = (
    r"(?:crank\w*|kurbel\w*|engine\w*|motor\w*|propeller\w*|generator\w*|turbine\w*|gear\w*|shaft|welle|pinion|wheel"
    r"|flywheel|speed|drehzahl|rpm|side|main|first|input|output|low|high|ratio|one|common|1|shaft\ \w+)"
)
_TO = rf"(?:to|auf)\ (?:(?:the|die|den|der|a)\ )?(?:{_TURNS}(?:\ {_TURNS}){{0,3}})"
_SIDE = re.compile(
    rf"\b(?:(?P<real>{_REAL})|(?:{_REFERRED}|ref|red)\ {_TO}|{_TO}\ {_REFERRED}"
    rf"|^(?:{_REFERRED}|ref|red)(?=\ )|(?:{_REFERRED}|ref|red)$)(?!\w)",
)
"""Words of a heading that say whether its values are referred; referred without a target at its begin or end."""
_VALUES = (
    rf"(?:(?:all|the|these|alle|die|this|mass[-\ ]elastic|torsional|inertia|stiffness|and|und|{_REFERRED})\ )*"
    r"(?:values?|data|figures|inertias?|moments?\ of\ inertia|stiffness(?:es)?|flexibilit(?:y|ies)|masses|table|sheet"
    r"|werte|daten|trägheitsmomente|drehmassen|massen|(?:dreh)?steifigkeiten|nachgiebigkeiten|damping)"
    r"(?:\ (?:and|und)\ (?:inertias?|(?:torsional\ )?stiffness(?:es)?|damping|(?:dreh)?steifigkeiten))*"
    r"(?:\ (?:in|of)\ (?:the|this)\ (?:sheet|table|system))?"
)
_ARE = r"(?:(?:is|are|were|have\ been|sind|ist|wurden)\ )?(?:(?:all|alle|here|each)\ )?"
_SENTENCE = re.compile(
    rf"(?:(?P<of>{_VALUES})\ )?{_ARE}(?:(?P<real>{_REAL})(?:\ (?P<ones>values|werte|ones))?"
    rf"|{_REFERRED}(?:\ (?P<these>values|werte))?(?:\ (?:to|auf)\ (?P<target>.+))?"
    rf"|(?:to|auf)\ (?P<before>.+)\ {_REFERRED})"
)
_TARGET = re.compile(rf"(?:(?:the|die|den|der|a)\ )?{_TURNS}(?:\ (?:{_TURNS}|of|the))*")
MOST_CHARACTERS = 150
"""Longest clause that is read as a sentence on values."""
_KEYWORD = re.compile(rf"\b{_REFERRED}\b")
_CLAUSES = re.compile(r"[;,()]|[.:](?=\s|$)")


def _folded(words: str) -> str:
    return " ".join(re.sub(r"[_\-.:,;()\[\]=\s]+", " ", words.casefold()).split())


def heading_side(words: str) -> tuple[str, bool | None]:
    """Words of a heading in the form that is compared, and whether they say referred (True), real (False), neither.

    Small letters, single blanks.

    >>> heading_side("J_red. (referred to crank)"), heading_side("Rel.-Damp.")
    (('j', True), ('rel damp', None))
    """
    plain = _folded(words)
    side: bool | None = None
    while matched := _SIDE.search(plain):
        side = not matched["real"]
        plain = " ".join(f"{plain[: matched.start()]} {plain[matched.end() :]}".split())
    return plain, side


def remark_side(text: str, names: Container[str] = ()) -> tuple[bool | None, bool]:
    """Whether a remark says that values are referred to one speed (True) or real (False), and whether it is unclear.

    It is unclear where it has such a word in another sense or sentence. ``names`` are those of masses at the speed to
    which values may be referred, in small letters.

    >>> remark_side("All values are referred to crankshaft speed"), remark_side("Values are real, in SI units")
    ((True, False), (False, False))
    >>> remark_side("Stiffnesses reduced by 10 percent"), remark_side("Drawing 12-345")
    ((None, True), (None, False))
    """
    sides, unclear = [], False
    for clause in filter(None, map(str.strip, _CLAUSES.split(text.casefold()))):
        plain = " ".join(clause.split())
        sentence = _SENTENCE.fullmatch(plain) if len(plain) <= MOST_CHARACTERS else None
        target = sentence and (sentence["target"] or sentence["before"])
        on_values = sentence and any(sentence[name] for name in ("of", "ones", "these", "target", "before"))
        if sentence and on_values and (not target or _TARGET.fullmatch(target) or target in names):
            sides.append(not sentence["real"])
        else:
            unclear |= _KEYWORD.search(plain) is not None
    agreed = sides[0] if len(set(sides)) == 1 else None
    return agreed, unclear or len(set(sides)) > 1


def referral_target(text: str) -> str:
    """Words of a heading or remark that say to what values are referred, in small letters; empty without them.

    >>> referral_target("J referred to the propeller shaft [kgm²]")
    'propeller shaft'
    """
    plain = _folded(text[:MOST_CHARACTERS])
    matched = re.search(rf"(?:{_REFERRED}|\b(?:ref|red))\ ({_TO})|({_TO})\ {_REFERRED}", plain)
    return re.sub(r"^(?:to|auf)\ (?:(?:the|die|den|der|a)\ )?", "", matched[1] or matched[2]) if matched else ""


DAMPING = "damping"
"""Meaning of a sheet's damping column that does not say whether it acts to ground or in the shaft."""


@dataclass(frozen=True)
class Meaning:
    """Meaning that a column of a mass-elastic sheet can have, with dimensions and words for it."""

    key: str
    shown: str
    dimensions: tuple[str, ...]
    words: re.Pattern[str]
    loosely: re.Pattern[str]
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


_SYMBOLS = r"[jiθkce]|[jikc]\ ?(?:t|p|x)|theta"
_FILLING = (
    rf"(?:{_SYMBOLS}|of|the|a|an|and|to|from|at|in|by|its|no|number|i|n|[in]\+1|next|previous|following|adjacent|adjoining"
    r"|between|mass|masses|moments?|mom|polar|torsion|torsional|torsionally|tors|rotational|rotating|rotary|rotation"
    r"|angular|shafts?|shafting|crankshaft|shaftline|line|sections?|elements?|stations?|station|part|component|body"
    r"|dynamic|dyn|static|stat|springs?|rate|constant|const|coefficient|coeff|coef|values?|calculated|viscous|gd2"
    r"|rotors?|dis[ck]s?|drehmassen?|polares|polaren|massen|der|des|die|das|zur|zum|welle|wellen|wellenstück|nächste[nr]?|naechste[nr]?|masse|dreh"
    r"|torsions|dynamische|statische|moment|werte?)"
)
"""Regular expression of a word that changes nothing in a heading: Torsional stiffness of the shaft."""
_BEFORE, _AFTER = rf"(?:{_FILLING}\ )*[a-zäöü]*", rf"[a-zäöü]*(?:\ {_FILLING})*"
_AMID = rf"[a-zäöü]*(?:\ {_FILLING})*\ ?[a-zäöü]*"


def _meaning(key: str, shown: str, dimensions: str, words: str, example: str) -> Meaning:
    """Meaning of a column, with the words of headings; < > and ~ stand for words that change nothing, at its places."""
    loosely = re.compile(re.sub("[<>~]", ".*", words), re.VERBOSE)
    words = words.replace("<", _BEFORE).replace(">", _AFTER).replace("~", _AMID)
    pattern = re.compile(words, re.VERBOSE)
    return Meaning(key, shown, tuple(filter(None, dimensions.split(","))), pattern, loosely, example)


_DAMP = r"(?:damp|dämpf|daempf)"
_SPEED = r"(?:speed|rpm|drehzahl)"
_TURNING = r"(?:crank\w*|engine|motor|kurbel\w*|propeller|reference|first\ mass|mass|the)"
MEANINGS = (
    _meaning("number", "number", "", r"(?:(?:mass|masse|station|shaft|item|pos|lfd|node)\ )?(?:no|nr|number|nummer|\#)"
             r"|pos|position|station|node|knoten", "No."),
    _meaning("from", "from mass", "", r"from(?:\ .*)?|von(?:\ .*)?|connected\ from|previous.*|start", "from"),
    _meaning("to", "to mass", "", r"to(?:\ .*)?|nach(?:\ .*)?|connect.*\ to|next.*|bis|anschluss.*|end", "to"),
    _meaning("inertia", "inertia", "inertia", r"<(?:inertia|trägheit|traegheit|drehmasse|schwungmoment|gd2)>"
             r"|j|θ|theta|mmi|moi|i|[ji]\ ?(?:[abdf-jl-z]|\d|tot|ges|mot)|mom\ of\ i", "J [kg*m^2]"),
    _meaning("psi", "relative damping psi", "1", rf"psi|ψ|rel~{_DAMP}>|verhältnismäss~{_DAMP}>|{_DAMP}~(?:psi|ψ)",
             "psi"),
    _meaning("magnifier", "dynamic magnifier", "1", r"<(?:magnif|vergrösserung)>(?:\ (?:factor|m))?|m|m\ dyn|q",
             "magnifier"),
    _meaning("eta", "loss factor", "1", r"<(?:loss\ factor|verlustfaktor|verlustwinkel)>(?:\ (?:eta|η))?|eta|η",
             "loss factor"),
    _meaning("zeta", "damping ratio", "1",
             rf"<(?:{_DAMP}\w*\ ratio|critical(?:\ {_DAMP}\w*(?:\ ratio)?)?|{_DAMP}ungsgrad|lehr\w*)>"
             r"(?:\ (?:zeta|ζ|d))?|(?:fraction|share|percent|%)\ of\ critical(?:\ damping)?|zeta|ζ|d", "zeta"),
    _meaning("absolute", "damping to ground", "damping", rf"<(?:abs|extern|äusser|aeusser|ground|mass)~{_DAMP}>"
             rf"|<{_DAMP}~(?:abs|extern|ground|mass)>|outer\ {_DAMP}>"
             r"|[bcd]\ (?:abs|ext|mass|ground)[a-z]*", "absolute damping [N*m*s/rad]"),
    _meaning("relative", "damping of the shaft", "damping", rf"<(?:rel|intern|inner|shaft|welle|material)~{_DAMP}>"
             rf"|<{_DAMP}~(?:rel|intern|shaft)>"
             r"|[bcd]\ (?:rel|int|shaft)[a-z]*", "relative damping [N*m*s/rad]"),
    _meaning(DAMPING, "damping", "damping,1", rf"<{_DAMP}>|b|c", "absolute damping [N*m*s/rad]"),
    _meaning("stiffness", "stiffness", "stiffness,compliance",
             r"<(?:stiff|rigidity|steifigkeit|federkonst|spring\ (?:rate|const)|complian|elasticity|flexib|nachgieb"
             r"|elastizit)>|[kce](?:[\ ]?(?:t|dyn|tdyn|t\ dyn|tot|\d))?", "k [N*m/rad]"),
    _meaning("outer", "outer diameter", "length",
             r"(?:outer|outside|extern|aussen|äusser|shaft|wellen)~(?:dia|durchm|ø)>(?:\ (?:d|od|da))?"
             r"|(?:dia|durchm)\w*(?:\ (?:outer|outside|ext|a|o|d))?|d|d\ ?[ao]|d\ outer|(?:shaft\ )?od|ø|aussen\ ?ø",
             "outer diameter [mm]"),
    _meaning("inner", "inner diameter", "length",
             r"(?:inner|inside|intern|innen)~(?:dia|durchm|ø)>(?:\ (?:d|id|di))?|bore>|bohrung>"
             r"|bore\ dia\w*|dia\w*\ (?:inner|inside|int|i)|d\ ?i|d\ inner|(?:shaft\ )?id", "inner diameter [mm]"),
    _meaning("length", "length", "length",
             r"(?:shaft\ )?length|<(?:länge|laenge)|length\ (?:of\ (?:the\ )?shaft|l)|l", "length [mm]"),
    _meaning("ratio", "speed ratio", "1", rf"{_SPEED}\ ?(?:ratio|factor|verhältnis|faktor)(?:\ {_SPEED})?"
             rf"(?:\ of(?:\ the)?\ (?:mass|shaft|station|element))?"
             rf"(?:\ (?:to|over|zu|zur)\ (?:{_SPEED}\ of\ )?{_TURNING}(?:\ {_TURNING}|\ {_SPEED})*)?"
             rf"|rel(?:ative)?\ speed|ratio\ of\ speeds?"
             r"|(?:speed\ )?(?:ratio\ )?(?:n\ ?/\ ?n\ ?\d?|mass/(?:crank\w*|engine|first|reference))", "speed ratio"),
    _meaning("gear ratio", "gear ratio", "1", r"<(?:gear|transmission)~ratio>|ratio>|<übersetzung>|i",
             "speed ratio"),
    _meaning("speed", "speed", "speed", rf"<(?:rated\ |nominal\ )?{_SPEED}>(?:\ (?:n|rpm))?|n", "speed [rpm]"),
    _meaning("name", "name", "", r"(?:(?:mass|station|element|shaft)\ )?(?:name|description|designation|text)"
             r"|bezeichnung|benennung|beschreibung|mass|masses|masse|element|component|part|item|bauteil"
             r"|drehmasse|komponente|what", "name"),
)  # fmt: skip
"""Meanings that columns of a sheet can have, the likeliest first where a heading fits several."""
BY_KEY = {meaning.key: meaning for meaning in MEANINGS}
"""Meanings of columns by their key, as ``inertia``."""

_LIMIT = re.compile(r"\b(?:max|min|maximum|minimum|critical|limit|permissible|permitted|allowable|zul|zulässig)\w*\b")


def meanings_of(words: str, *, loosely: bool = False) -> list[Meaning]:
    """Meanings that the words of a column's heading may have, the likeliest first.

    All words have to be known, unless ``loosely``.

    >>> [m.key for m in meanings_of("Massenträgheitsmoment")], [m.key for m in meanings_of("Mass")]
    (['inertia'], ['name'])
    >>> meanings_of("Inertia without water"), [m.key for m in meanings_of("Inertia without water", loosely=True)]
    ([], ['inertia'])
    """
    plain = heading_side(words)[0]
    return [meaning for meaning in MEANINGS if (meaning.loosely if loosely else meaning.words).fullmatch(plain)]


def is_limit(words: str) -> bool:
    """Whether the words of a heading are of a limit or rating, as max. torque or permissible stress."""
    return _LIMIT.search(words) is not None


def unknown_words(words: str, meaning: Meaning) -> list[str]:
    """Words of a heading that keep it from having a meaning which others of its words suggest.

    >>> unknown_words("Inertia without the water", BY_KEY["inertia"])
    ['without', 'water']
    """
    plain = heading_side(words)[0].split()
    unknown = [word for word in plain if not re.fullmatch(_FILLING, word) and not meaning.loosely.fullmatch(word)]
    return unknown or plain
