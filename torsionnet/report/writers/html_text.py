"""HTML of texts, formulas and numbers inside a line of a report.

Every text passes :func:`escaped`; nothing else reaches the page.
"""

from __future__ import annotations

import html
import re
import unicodedata
from functools import lru_cache

from torsionnet.base.errors import MissingExtraError
from torsionnet.report.document_tree import BreakableMath, Cell, Code, Inline, Math, NumberText, Strong, inlines

# MathML of formulas that are written in LaTeX.

_MATHRM = re.compile(r"\\mathrm\{([^{}\\]{2,})\}")


@lru_cache(maxsize=4096)
def mathml(latex: str, *, block: bool = False) -> str:
    r"""MathML element ``<math>`` of a formula in LaTeX.

    Raises
    ------
    MissingExtraError
        latex2mathml is not installed.

    Examples
    --------
    >>> mathml(r"k_{1}")
    '<math><mrow><msub><mi>k</mi><mrow><mn>1</mn></mrow></msub></mrow></math>'
    """
    try:
        from latex2mathml.converter import convert
    except ImportError:
        raise MissingExtraError(
            "formulas in HTML and PDF need latex2mathml: pip install latex2mathml (or write -o report.md, report.tex)"
        ) from None
    whole = _MATHRM.sub(lambda match: rf"\text{{{match[1].replace('~', ' ')}}}", latex)  # one word, not its letters
    text = convert(whole, display="block" if block else "inline")
    text = re.sub(r'<math xmlns="[^"]*" display="(\w+)">', r'<math display="\1">', text)
    return text.replace(' display="inline"', "").replace(' stretchy="true" fence="true"', "")


def escaped(text: str) -> str:
    """Text with the characters of HTML markup escaped, and control characters replaced.

    >>> escaped('<b>A & "B"</b>')
    '&lt;b&gt;A &amp; &quot;B&quot;&lt;/b&gt;'
    """
    return html.escape(without_controls(text))


def without_controls(text: str) -> str:
    """Text with its control characters replaced, which neither a page nor XML can hold."""
    return "".join("\N{REPLACEMENT CHARACTER}" if _is_control(char) else char for char in text)


def _is_control(char: str) -> bool:
    return (unicodedata.category(char) in ("Cc", "Cs") and char not in "\n\t") or char in "\ufffe\uffff"


def inline(cell: Cell) -> str:
    """HTML of a cell, caption or paragraph of a report."""
    return "".join(map(_part, inlines(cell)))


def _part(part: Inline) -> str:
    match part:
        case Math(latex):
            return mathml(latex)
        case BreakableMath(parts):
            return " ".join(_infix(mathml(latex), latex) for latex in parts)
        case Strong(text):
            return f"<strong>{escaped(text)}</strong>"
        case Code(text):
            return f"<code>{escaped(text)}</code>"
        case NumberText():
            return number(part)
    return escaped(part)


def _infix(text: str, latex: str) -> str:
    """MathML in which a leading sign stands between two terms, and keeps its distance from both."""
    return text.replace("<mo>", "<mo form=infix>", 1) if latex[:1] in ("+", "-", "=") else text


def number(value: NumberText, decimals: int = 0) -> str:
    """HTML of a number in a report; invisible digits make up for the decimals that others in its column have."""
    text = value.mantissa.replace("-", "−")
    if value.exponent is not None:
        return f"{text}·10<sup>{str(value.exponent).replace('-', '−')}</sup>"
    missing = decimals - value.decimals_shown
    if missing <= 0 or not text[-1:].isdigit():
        return text
    point = "" if value.decimals_shown else "."
    return f'{text}<span class="pad" aria-hidden="true">{point}{"0" * missing}</span>'
