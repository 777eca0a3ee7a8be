"""Separation margin rules between natural frequencies and excitation frequencies, each with its source."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from torsionnet.base.errors import UsageError, suggestion_or

CITED_REMARK = "as commonly cited; check your edition"
"""Text of the remark on the source of margin rules that are not copied from a standard."""
LARGEST_MARGIN = 1.0
"""Largest separation margin as a share of the excitation frequency; more is probably meant in percent."""


@dataclass(frozen=True)
class MarginClause:
    """Separation margin, as a share of the excitation frequency, for (whole) orders from ``lowest`` to ``highest``."""

    lowest: float
    highest: float
    margin: float
    whole: bool = False

    def covers(self, order: float) -> bool:
        """Whether a clause of a margin rule applies to an excitation order."""
        return self.lowest <= order <= self.highest and not (self.whole and order != round(order))


@dataclass(frozen=True)
class MarginRule:
    """Rule for the least distance of natural from excitation frequencies, relative to the excitation frequency.

    Attributes
    ----------
    name : str
    source : str
        Source of the numbers, and what the rule leaves out.
    clauses : tuple of MarginClause
        Margins by order of the shaft of the excitation.
    fixed : float or None
        Margin for excitation at a fixed frequency such as the line frequency; None if not covered.

    Examples
    --------
    >>> rule = margin_rule("api618")
    >>> rule.required(1), rule.required(6), rule.required(0.5), rule.required(0)
    (0.1, 0.05, None, 0.1)
    """

    name: str
    source: str
    clauses: tuple[MarginClause, ...]
    fixed: float | None = None

    def required(self, order: float) -> float | None:
        """Separation margin, as a share of the excitation frequency, that a rule requires for an excitation order.

        Order 0 is a fixed frequency, one below 0 a slip; None if the rule does not cover it.
        """
        if order <= 0:
            return self.fixed
        return next((clause.margin for clause in self.clauses if clause.covers(order)), None)

    def __str__(self) -> str:
        return f"{self.name}: {self.source}"


_ANY = (MarginClause(0, float("inf"), 0.10),)
_TEN = "10 % from every excitation frequency in the operating range, 1x and 2x line frequency among them"
PRESETS: Mapping[str, MarginRule] = {
    rule.name: rule
    for rule in (
        MarginRule("api610", f"API 610 / ISO 13709, torsional analysis of pumps: {_TEN}; {CITED_REMARK}", _ANY, 0.10),
        MarginRule("api617", f"API 617, train torsional analysis of compressors: {_TEN}; {CITED_REMARK}", _ANY, 0.10),
        MarginRule(
            "api618",
            "API 618, reciprocating compressors: 10 % at 1x, 5 % at its whole multiples up to 10x, 10 % from 1x "
            f"and 2x line frequency; half orders and orders above 10 are not covered; {CITED_REMARK}",
            (MarginClause(1, 1, 0.10), MarginClause(2, 10, 0.05, whole=True)),
            0.10,
        ),
        MarginRule("api684", f"API RP 684 (now TR 684-1), rotordynamic tutorial: {_TEN}; {CITED_REMARK}", _ANY, 0.10),
        MarginRule("line_frequency", "10 % from 1x and 2x line frequency only; no standard is meant", (), 0.10),
    )
}


def margin_rule(given: str | float | MarginRule | None) -> MarginRule | None:
    """Separation margin rule from the name of a preset, a share such as 0.15 or ``15 %``, or a rule.

    Raises
    ------
    UsageError
        No such preset, or a share that is not between 0 and 1.

    Examples
    --------
    >>> margin_rule("15 %").required(2.5)
    0.15
    """
    if given is None or isinstance(given, MarginRule):
        return given
    if isinstance(given, str) and given in PRESETS:
        return PRESETS[given]
    share = _share(given)
    if share is None:
        hint = suggestion_or(str(given), PRESETS, f"there are {', '.join(PRESETS)}, or give a share as 15 %")
        raise UsageError(f'no margin rule is named "{given}"{hint}', kind="unknown-word")
    if not 0 < share < LARGEST_MARGIN:
        raise UsageError(f"a margin is a share between 0 and 1, as 10 % or 0.1; got {given}", kind="out-of-range")
    every = MarginClause(0, float("inf"), share)
    return MarginRule("own", f"{100 * share:g} % from every excitation frequency, as given", (every,), share)


def _share(given: str | float) -> float | None:
    """Margin as a share, read from a text such as ``15 %`` or ``0.15``, None if it is not a number."""
    text = str(given).strip()
    try:
        return float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
    except ValueError:
        return None
