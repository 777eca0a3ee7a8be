"""Detection of a table of text that ends early, within its last row or within its last number."""

from __future__ import annotations

import re
from collections.abc import Sequence

COMPARED_ROWS = 3
"""Number of rows above the last one that must all have equally many decimals before a shorter number counts as cut;
with fewer, numbers of varying length would be taken for cut ones."""
_DECIMALS = re.compile(r"[+-]?\d*[.,](?P<decimals>\d+)(?P<exponent>[eEdD][+-]?\d+)?")
_BEGUN = re.compile(r"[+-]?(?:\d+[.,]?\d*|[.,]\d*)?(?:[eEdD][+-]?)?")


def truncation_message(
    cells: Sequence[str], above: Sequence[Sequence[str]], names: Sequence[str], *, own: bool = False
) -> str:
    """Message that the last row of a file without a final line end is cut; empty where the row may be complete.

    ``above`` are rows before it; a file of this package's ``own`` ends with the end of a line.

    >>> truncation_message(["0.2", "-1."], [["0.1", "-1.12"]] * 3, ["time", "T"])
    'the file ends early: the last number of T is cut'
    >>> truncation_message(["0.2"], [["0.1", "-1.12", "3"]], ["time", "T", "phi"])
    'the file ends early: the last row lacks T, phi, and its time may be cut'
    """
    if len(cells) < len(names):
        known = names[len(cells) - 1]
        return f"the file ends early: the last row lacks {', '.join(names[len(cells) :])}, and its {known} may be cut"
    if len(cells) > len(names):
        return ""
    last, others = cells[-1], [row[-1] for row in above if len(row) == len(names)]
    if own or _is_begun(last, others) or _is_shorter(last, others):
        return f"the file ends early: the last number of {names[-1]} is cut"
    return ""


def _is_begun(cell: str, others: Sequence[str]) -> bool:
    """Whether a cell is only the beginning of a number: ``-``, ``1.2e-``, or nothing where there were numbers."""
    if not cell:
        return bool(others) and all(others)
    return _BEGUN.fullmatch(cell) is not None and cell[-1] not in "0123456789.,"


def _is_shorter(cell: str, others: Sequence[str]) -> bool:
    """Whether a number has fewer decimals, or no exponent, where all rows above have equally many."""
    forms = {_form(other) for other in others}
    if len(others) < COMPARED_ROWS or len(forms) != 1:
        return False
    (form,) = forms
    return form is not None and (_form(cell) or (0, 0)) < form


def _form(cell: str) -> tuple[int, int] | None:
    """Number of digits behind the decimal sign of a number, and of characters of its exponent."""
    found = _DECIMALS.fullmatch(cell)
    return (len(found["decimals"]), len(found["exponent"] or "")) if found else None
