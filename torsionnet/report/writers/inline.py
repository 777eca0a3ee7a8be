"""Texts, formulas and numbers inside a line of a report, told apart once; a format only says how each of them looks.

Which digits a number has and how many places are missing to those of its column is decided here too, and where a long
word may be broken.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod

from torsionnet.report.document_tree import BreakableMath, Cell, Code, Inline, Math, NumberText, Strong, inlines

LONGEST_WORD = 20
"""Largest number of letters of a word that stays in one piece; a longer one may break after its signs."""
_MARKUP = re.compile(r"(begin|end)\{bmatrix\}|\\[a-zA-Z]+|[{}_^~\\ &]")


def signed_pieces(word: str) -> list[str]:
    """Pieces of a word behind whose signs a line may end.

    >>> signed_pieces("water=dry,coupling=warm")
    ['water=', 'dry,', 'coupling=', 'warm']
    """
    return re.split(r"(?<=[=,/_+])(?=.)", word)


class InlineWriter(ABC):
    """Writer of the texts, formulas and numbers inside a line of a report, in one format."""

    def __call__(self, cell: Cell) -> str:
        """Cell, caption or paragraph of a report in the format."""
        return "".join(map(self._part, inlines(cell)))

    def _part(self, part: Inline) -> str:
        match part:
            case Math(latex):
                return self.math(latex)
            case BreakableMath(terms):
                return self.terms(terms)
            case Strong(text):
                return self.strong(text)
            case Code(text):
                return self.code(text)
            case NumberText():
                return self.number(part)
        return self.text(part)

    def cell(self, cell: Cell, decimals: int) -> str:
        """Cell of a table in the format, a number with room for as many decimals as others in its column have."""
        return self.number(cell, decimals) if isinstance(cell, NumberText) else self(cell)

    def number(self, value: NumberText, decimals: int = 0) -> str:
        """Number in the format, with room for as many decimals as others in its column have."""
        if value.exponent is not None:
            return self.power(value.mantissa, str(value.exponent))
        missing = decimals - value.decimals_shown
        if missing <= 0 or not value.mantissa[-1:].isdigit():
            return self.digits(value.mantissa, "")
        return self.digits(value.mantissa, ("" if value.decimals_shown else ".") + "0" * missing)

    @abstractmethod
    def text(self, text: str) -> str:
        """Text of the report or of a model, in which nothing may act as markup."""

    @abstractmethod
    def math(self, latex: str) -> str:
        """Formula inside a line, which is given as LaTeX."""

    @abstractmethod
    def terms(self, terms: tuple[str, ...]) -> str:
        """Long formula inside a line, which may break between its terms."""

    @abstractmethod
    def strong(self, text: str) -> str:
        """Text in bold."""

    @abstractmethod
    def code(self, text: str) -> str:
        """Text to be typed as it stands."""

    @abstractmethod
    def digits(self, digits: str, gap: str, /) -> str:
        """Number without a power of ten; ``gap`` is what it lacks of the point and the decimals of its column."""

    @abstractmethod
    def power(self, digits: str, exponent: str, /) -> str:
        """Number with a power of ten."""


class CountedLetters(InlineWriter):
    """Text of a cell roughly as it is printed, for counting letters.

    Examples
    --------
    >>> CountedLetters()(("at ", Math(r"\\theta_{1}"), " ", NumberText(2.5e-7)))
    'at 1 2.5·10^-9'
    """

    def text(self, text: str) -> str:
        return text

    strong = code = text

    def math(self, latex: str) -> str:
        return max(map(_row_of_formula, latex.split(r"\\")), key=len)

    def terms(self, terms: tuple[str, ...]) -> str:
        return "   ".join(map(self.math, terms))

    def digits(self, digits: str, _gap: str) -> str:
        return digits

    def power(self, digits: str, _exponent: str) -> str:
        return f"{digits}·10^-9"


def _row_of_formula(latex: str) -> str:
    """Text of one row of a LaTeX formula for counting letters, with gaps between columns and around operators."""
    bare = re.sub(_MARKUP, "", latex.replace("&", "ooo").replace(r"\cdot", "o"))
    return re.sub(r"(?<=[^ ])[-+=](?=[^ ])", "- ", bare)


visible_text = CountedLetters()
"""Text of a cell roughly as it is printed, for counting letters."""
