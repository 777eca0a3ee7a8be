"""Entries of the ``report:`` section of a model file, which plan the report."""

from torsionnet.core.entries.band import parse_band
from torsionnet.model.report.report_pair import Pair
from torsionnet.model.report.report_plan import LANGUAGES, ReportPlan
from torsionnet.model.report.sections import KINDS, SECTIONS
from torsionnet.model.report.title_block import Revision, TitleBlock

__all__ = ["KINDS", "LANGUAGES", "SECTIONS", "Pair", "ReportPlan", "Revision", "TitleBlock", "parse_band"]
