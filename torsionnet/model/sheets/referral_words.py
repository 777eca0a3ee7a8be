"""Words of headings and remarks that say whether the values of a sheet are referred to one speed."""

from __future__ import annotations

import re
from collections.abc import Container

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
