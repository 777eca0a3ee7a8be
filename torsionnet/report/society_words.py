"""Replacement of words and symbols in a finished report by those of a classification society."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import Any

from torsionnet.machinery.limits.society_rules import Society
from torsionnet.report.document_tree import BreakableMath, Code, Equations, Formula, Math, NumberText

AS_THEY_ARE = (Math, BreakableMath, Code, NumberText, Formula, Equations)
"""Classes of report parts, such as formulas and code, in which a society's words replace nothing."""
KEPT_FIELDS = frozenset({"name", "figure", "unit", "kind"})
"""Names of fields of a report's parts in which a society's words replace nothing."""


def in_society_words(part: Any, society: Society) -> Any:
    """Copy of a part of a report in which a society's words and symbols replace the report's own.

    Examples
    --------
    >>> from torsionnet.machinery.limits.society_rules import SOCIETIES
    >>> from torsionnet.report.document_tree import Paragraph
    >>> in_society_words(Paragraph(("tau_C is exceeded: barred range",)), SOCIETIES["lr"])
    Paragraph(text=('tau_c is exceeded: restricted speed range',))
    """
    if isinstance(part, str):
        return society.in_words(part)
    if isinstance(part, tuple):
        return tuple(in_society_words(one, society) for one in part)
    if not is_dataclass(part) or isinstance(part, (type, *AS_THEY_ARE)):
        return part
    kept = {one.name: getattr(part, one.name) for one in fields(part) if one.name not in KEPT_FIELDS}
    return replace(part, **{name: in_society_words(value, society) for name, value in kept.items()})
