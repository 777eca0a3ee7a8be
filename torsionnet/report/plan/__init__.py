"""Entries of the ``report:`` section of a model file, which plan the report."""

from typing import TYPE_CHECKING

from torsionnet.base.entries.scalars import parse_band
from torsionnet.base.packages import imported
from torsionnet.model.channels import Pair
from torsionnet.report.plan.report_plan import KINDS, LANGUAGES, SECTIONS, ReportPlan

if TYPE_CHECKING:
    from torsionnet.report.plan.title_block import Revision, TitleBlock

__all__ = ["KINDS", "LANGUAGES", "SECTIONS", "Pair", "ReportPlan", "Revision", "TitleBlock", "parse_band"]


def __getattr__(name: str) -> object:
    """Classes of the title block, which few reports have, imported at first use."""
    if name in ("Revision", "TitleBlock"):
        return imported(f"torsionnet.report.plan.title_block:{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}", name=name)
