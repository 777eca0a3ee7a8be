"""Factors of the rule of a limit, each with where it comes from, and the symbols that a rule writes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias


@dataclass(frozen=True)
class RuleSymbol:
    """Symbol of a rule, with its index, its exponent, the argument at which it is taken, and whether it is a root.

    Examples
    --------
    >>> str(RuleSymbol("tau", "C", at="0.8")), str(RuleSymbol("C", "K", root=True)), str(RuleSymbol("d", power="-0.2"))
    ('tau_C(0.8)', 'sqrt(C_K)', 'd^-0.2')
    """

    letter: str
    index: str = ""
    power: str = ""
    at: str = ""
    root: bool = False

    def __str__(self) -> str:
        text = self.letter + (f"_{self.index}" if self.index else "") + (f"^{self.power}" if self.power else "")
        text += f"({self.at})" if self.at else ""
        return f"sqrt({text})" if self.root else text


RuleWords: TypeAlias = tuple[str | RuleSymbol, ...]
"""Words and formulas about a rule, symbols apart from the text between them."""


@dataclass(frozen=True)
class RuleFactor:
    """Factor of a limit's rule, in SI units, with its symbol and where it comes from.

    Attributes
    ----------
    name : tuple of str and RuleSymbol
        What it is, in words.
    symbol : RuleSymbol
        As the rule writes it, such as C_K.
    value : float
        SI units.
    unit : str
        SI unit; "1" for none.
    origin : tuple of str and RuleSymbol
        Where the value comes from: an entry of the model, or the formula or table of the rule.

    Examples
    --------
    >>> origin = ("propeller shaft, keyless taper fitting",)
    >>> RuleFactor(("design feature",), RuleSymbol("C", "K"), 0.55, "1", origin).value
    0.55
    """

    name: RuleWords
    symbol: RuleSymbol
    value: float
    unit: str
    origin: RuleWords


@dataclass(frozen=True)
class RuleText:
    """Text on the rule of a limit, with its source, its formula, what it does not cover, and its factors."""

    source: str
    formula: str
    not_covered: str
    factors: tuple[RuleFactor, ...] = ()
