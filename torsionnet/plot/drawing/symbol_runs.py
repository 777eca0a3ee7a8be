"""Runs of a label's text in one style, of which a label with symbols as in mathematics has several."""

from __future__ import annotations

import math
import re
from functools import lru_cache
from typing import NamedTuple

from torsionnet.plot.drawing.text_widths import font_widths

INDEX_SIZE = 0.7
"""Size of an index as a multiple of that of its symbol."""
X_HEIGHT = 100 * 1120 / 2048
"""Height of a small letter in hundredths of the size of the font."""
BEHIND_INDEX, BEFORE_INDEX = 0.05 * X_HEIGHT, 0.025 * INDEX_SIZE * X_HEIGHT
"""Room behind an index and, of an upright symbol, before it, in hundredths of the size of the text."""

LETTERS = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ", "eta": "η", "theta": "θ",
    "iota": "ι", "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "pi": "π", "rho": "ρ", "sigma": "σ",
    "tau": "τ", "upsilon": "υ", "phi": "φ", "chi": "χ", "psi": "ψ", "omega": "ω", "Gamma": "Γ", "Delta": "Δ",
    "Theta": "Θ", "Lambda": "Λ", "Xi": "Ξ", "Pi": "Π", "Sigma": "Σ", "Upsilon": "Υ", "Phi": "Φ", "Psi": "Ψ",
    "Omega": "Ω", "varepsilon": "ε",
}  # fmt: skip
"""Greek letters by their names."""
_SYMBOL = re.compile(r"\\?([A-Za-z]+)(?:_\{\\mathrm\{(.*)\}\})?")


class TextRun(NamedTuple):
    """Piece of a label in one style: ``plain``, ``symbol`` (in italics but for capital Greek), or ``index``."""

    text: str
    style: str

    @property
    def is_italic(self) -> bool:
        """Whether the run is set in italics."""
        return self.style == "symbol" and not "Α" <= self.text <= "Ω"


def symbol_runs(text: str) -> list[TextRun]:
    r"""Runs of a label in which symbols stand between dollars, as ``labels.symbol`` writes them.

    >>> [tuple(run) for run in symbol_runs("$k_{\\mathrm{1}}$ = 460 N·m/rad")]
    [('k', 'symbol'), ('1', 'index'), (' = 460 N·m/rad', 'plain')]
    """
    found: list[TextRun] = []
    for place, part in enumerate(text.split("$")):
        match = _SYMBOL.fullmatch(part) if place % 2 else None
        if match is None:
            found += [TextRun(part, "plain")] if part else []
            continue
        found.append(TextRun(LETTERS.get(match[1], match[1]), "symbol"))
        if match[2]:
            found.append(TextRun(match[2].replace("\\_", "_"), "index"))
    return found


@lru_cache(maxsize=4096)
def symbols_width(text: str) -> float:
    """Width of a label with symbols in hundredths of the size of its font, rounded up as matplotlib does."""
    width, upright = 0.0, False
    for run in symbol_runs(text):
        own = font_widths("italic" if run.is_italic else "").symbol_width(run.text)
        if run.style == "index":
            own = INDEX_SIZE * own + BEHIND_INDEX + (BEFORE_INDEX if upright else 0.0)
        upright = not run.is_italic
        width += own
    return float(math.ceil(width))
