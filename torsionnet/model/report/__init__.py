"""Entries of the ``report:`` section of a model file, which plan the report."""

from torsionnet.core.entries.scalars import parse_band
from torsionnet.model.report.report_plan import LANGUAGES, Pair, ReportPlan
from torsionnet.model.report.title_block import KINDS, SECTIONS, Revision, TitleBlock

__all__ = ["KINDS", "LANGUAGES", "SECTIONS", "Pair", "ReportPlan", "Revision", "TitleBlock", "parse_band"]
