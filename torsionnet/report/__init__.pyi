# Written by `make generate`.
from torsionnet.report.report import make_report as make_report
from torsionnet.report.report import write_report as write_report

__all__ = [
    "make_report",
    "write_report",
]
