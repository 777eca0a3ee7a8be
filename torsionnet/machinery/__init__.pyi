# Written by `make generate`.
from torsionnet.machinery.orders.worst_response import WorstResponse as WorstResponse
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion as LimitConclusion
from torsionnet.machinery.verdicts.margin_rules import MarginClause as MarginClause
from torsionnet.machinery.verdicts.margin_rules import MarginRule as MarginRule

__all__ = [
    "LimitConclusion",
    "MarginClause",
    "MarginRule",
    "WorstResponse",
]
