"""Running machinery: excitation by orders, critical speeds, order responses, passages, limits and dampers."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "LimitConclusion": "torsionnet.machinery.verdicts.limit_conclusion",
        "MarginClause": "torsionnet.machinery.verdicts.margin_rules",
        "MarginRule": "torsionnet.machinery.verdicts.margin_rules",
        "WorstResponse": "torsionnet.machinery.orders.worst_response",
    },
)
