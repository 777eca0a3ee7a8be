r"""LaTeX of the texts and numbers of a report.

Special characters are escaped, and characters that pdfTeX cannot print are spelt out.
"""

from __future__ import annotations

import re
import unicodedata

from torsionnet.report.document_tree import BreakableMath, Cell, Code, Inline, Math, NumberText, Strong, inlines
from torsionnet.symbolic import symbol_names

SPECIAL = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "%": r"\%", "_": r"\_",
    "^": r"\textasciicircum{}", "~": r"\textasciitilde{}", "<": r"\textless{}", ">": r"\textgreater{}",
    "|": r"\textbar{}", '"': r"\textquotedbl{}", "`": r"\textasciigrave{}",
    "–": "--", "—": "---", "…": r"\ldots{}", "−": "$-$", "∞": r"$\infty$", "×": r"$\times$", "·": r"$\cdot$",
    "²": r"$^2$", "³": r"$^3$", "°": r"$^\circ$", "µ": r"$\mu$", "±": r"$\pm$", "\N{NO-BREAK SPACE}": "~",
    "‘": "`", "’": "'", "“": "``", "”": "''", "≤": r"$\le$", "≥": r"$\ge$", "→": r"$\to$",
}  # fmt: skip
"""LaTeX of characters with a meaning in LaTeX, and of some others, by character."""
GREEK = {
    unicodedata.lookup(f"GREEK {size} LETTER {name.upper().replace('LAMBDA', 'LAMDA')}"): rf"$\{name}$"
    for name in sorted(symbol_names.GREEK)
    for size in ("CAPITAL" if name[0].isupper() else "SMALL",)
}
"""LaTeX of Greek letters by letter."""
LONGEST_WORD, PIECE_LETTERS = 20, 10
"""Largest number of letters of a word in one piece, and number of letters after which a longer one may break."""
_BREAK = r"\allowbreak{}"
FIRST_UNKNOWN_LETTER = 0x180
"""First code point of the letters that the LaTeX fonts (T1) may lack; those below they have, or compose."""


def escaped(text: str) -> str:
    r"""LaTeX that prints a text of the report as it stands.

    >>> print(escaped("<b>A & B</b> $x_1$ 100%"))
    \textless{}b\textgreater{}A \& B\textless{}/b\textgreater{} \$x\_1\$ 100\%
    """
    return "".join(map(_char, unicodedata.normalize("NFC", text)))


def _char(char: str) -> str:
    known = SPECIAL.get(char) or GREEK.get(char)
    if known:
        return known
    if char in "\n\t" or (char.isprintable() and ord(char) < 0x7F):
        return char
    if char.isalpha() and ord(char) < FIRST_UNKNOWN_LETTER:
        return char
    return rf"[U+{ord(char):04X}]"


def inline(cell: Cell) -> str:
    r"""LaTeX of a cell, caption or paragraph of a report; a long word may break after its signs.

    >>> print(inline("in water=dry,coupling=warm"))
    in water=\allowbreak{}dry,\allowbreak{}coupling=\allowbreak{}warm
    """
    return "".join(map(_part, inlines(cell)))


def breakable(part: Inline) -> str:
    r"""LaTeX of a part of a table's cell, which may break over lines in a narrow column.

    Words may also break after signs, and long ones anywhere.

    >>> print(breakable("gear=V,clutch=open"))
    gear=\allowbreak{}V,\allowbreak{}clutch=\allowbreak{}open
    """
    if not isinstance(part, str):
        return _part(part)
    return " ".join(_BREAK.join(map(escaped, _syllables(word))) for word in part.split(" "))


def _syllables(word: str) -> list[str]:
    found = []
    for piece in _signed(word):
        size = PIECE_LETTERS if len(piece) > LONGEST_WORD else len(piece) or 1
        found += [piece[start : start + size] for start in range(0, len(piece), size)]
    return found


def _signed(word: str) -> list[str]:
    return re.split(r"(?<=[=,/_+])(?=.)", word)


def _part(part: Inline) -> str:
    match part:
        case Math(latex):
            return f"${latex}$"
        case BreakableMath(parts):
            return " ".join(f"${'{} ' if latex[:1] in ('+', '-', '=') else ''}{latex}$" for latex in parts)
        case Strong(text):
            return rf"\textbf{{{escaped(text)}}}"
        case Code(text):
            pieces = (escaped(piece).replace("--", "-{}-") for piece in re.split(r"(?<=[(,._/])", text))
            return rf"\texttt{{{_BREAK.join(pieces)}}}"
        case NumberText():
            return number(part)
    words = ([word] if len(word) <= LONGEST_WORD else _signed(word) for word in part.split(" "))
    return " ".join(_BREAK.join(map(escaped, word)) for word in words)


def number(value: NumberText, decimals: int = 0) -> str:
    """LaTeX of a number in a report; a gap makes up for the decimals that others in its column have."""
    text = value.mantissa
    if not text[-1:].isdigit():
        return escaped(text)
    if value.exponent is not None:
        return rf"${text}\cdot10^{{{value.exponent}}}$"
    missing = decimals - value.decimals_shown
    gap = rf"\phantom{{{'' if value.decimals_shown else '.'}{'0' * missing}}}" if missing > 0 else ""
    return f"${text}{gap}$"


def display_math(latex: str) -> str:
    """LaTeX of a formula on a line of its own: inner fractions in full size, room between rows of fractions."""
    large = re.sub(r"\\frac(?![a-z])", r"\\dfrac", latex)
    return large.replace(r" \\ ", r" \\[5pt] ") if r"\dfrac" in large and "matrix" in large else large
