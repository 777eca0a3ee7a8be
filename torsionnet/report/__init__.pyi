# Written by `make generate`.
from torsionnet.report.document_tree import Report as Report
from torsionnet.report.report import make_report as make_report
from torsionnet.report.report import write_report as write_report
from torsionnet.report.report_request import Measured as Measured

__all__ = [
    "Measured",
    "Report",
    "make_report",
    "write_report",
]
