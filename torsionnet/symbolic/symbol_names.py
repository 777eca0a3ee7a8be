r"""LaTeX names of parameters and nodes, ``k_1`` an italic letter with an index, ``tau`` a Greek one.

>>> symbol_latex("k_1"), symbol_latex("tau"), symbol_latex("I_MT"), symbol_latex("stiffness")
('k_{1}', '\\tau', 'I_{\\mathrm{MT}}', '\\mathrm{stiffness}')
>>> angle_latex("input_shaft")
'\\theta_{\\mathrm{input~shaft}}'
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

GREEK = frozenset(
    (
        *("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "kappa", "lambda", "mu", "nu", "xi"),
        *("pi", "rho", "sigma", "tau", "phi", "chi", "psi", "omega"),
        *("Gamma", "Delta", "Theta", "Lambda", "Xi", "Pi", "Sigma", "Phi", "Psi", "Omega"),
    )
)
_TRAILING = re.compile(r"([A-Za-z]+?)(\d+)")


def symbol_latex(name: str) -> str:
    r"""LaTeX of a parameter's name, the symbol before the first ``_``, its index after it.

    The part to which a parameter belongs stands at the end of the index.

    >>> symbol_latex("left.k"), symbol_latex("engine.cyl3.J_1")
    ('k_{\\mathrm{left}}', 'J_{1,\\mathrm{engine.cyl3}}')
    """
    owner, _, own = name.rpartition(".")
    base, _, index = own.partition("_")
    trailing = _TRAILING.fullmatch(base)
    if trailing and not index and _is_symbol(trailing[1]):
        base, index = trailing[1], trailing[2]
    shown = f"\\{base}" if base in GREEK else base if len(base) == 1 else rf"\mathrm{{{base}}}"
    shown_index = ",".join(_upright(piece.replace("_", ",")) for piece in (index, owner) if piece)
    return f"{shown}_{{{shown_index}}}" if shown_index else shown


def angle_latex(node: str) -> str:
    """LaTeX symbol for the angle of a node, theta with the node's name as index."""
    return rf"\theta_{{{_upright(node.replace('_', '~'))}}}"


def symbol_names(symbols: Iterable[Any]) -> dict[Any, str]:
    """LaTeX name of each symbol, for the argument ``symbol_names`` of sympy's printer."""
    return {symbol: symbol_latex(str(symbol)) for symbol in symbols}


def _is_symbol(base: str) -> bool:
    return len(base) == 1 or base in GREEK


def _upright(index: str) -> str:
    """LaTeX of an index, with numbers and single letters unchanged, words and abbreviations upright."""
    return index if index.isdigit() or len(index) == 1 else rf"\mathrm{{{index}}}"
