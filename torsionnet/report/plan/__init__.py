"""Entries of the ``report:`` section of a model file, which plan the report."""

from torsionnet.base.entries.scalars import parse_band
from torsionnet.model.response_pair import Pair
from torsionnet.report.plan.report_plan import LANGUAGES, ReportPlan
from torsionnet.report.plan.title_block import KINDS, SECTIONS, Revision, TitleBlock

__all__ = ["KINDS", "LANGUAGES", "SECTIONS", "Pair", "ReportPlan", "Revision", "TitleBlock", "parse_band"]
