"""MathML of formulas that are written in LaTeX."""

from __future__ import annotations

import re
from functools import lru_cache

from torsionnet.base.errors import MissingExtraError

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
