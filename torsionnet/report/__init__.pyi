# Written by `make generate`.
from torsionnet.entry_classes import ReportPlan as ReportPlan
from torsionnet.entry_classes import Revision as Revision
from torsionnet.entry_classes import TitleBlock as TitleBlock
from torsionnet.report.document_tree import Picture as Picture
from torsionnet.report.document_tree import Report as Report
from torsionnet.report.plan import Pair as Pair
from torsionnet.report.report import make_report as make_report
from torsionnet.report.report import write_report as write_report
from torsionnet.report.report_request import Measured as Measured

__all__ = [
    "Measured",
    "Pair",
    "Picture",
    "Report",
    "ReportPlan",
    "Revision",
    "TitleBlock",
    "make_report",
    "write_report",
]
