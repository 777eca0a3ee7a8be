"""Report on a model as a tree, and writers of the tree as HTML, LaTeX, Markdown or pdf.

>>> from torsionnet.report import make_report
>>> report = make_report("dmf_rig", sections=["modes", "validity"], date=None)
>>> [section.name for section in report.sections]
['modes', 'validity']
"""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Measured": "torsionnet.report.report_request",
        "Pair": "torsionnet.report.plan",
        "Picture": "torsionnet.report.document_tree",
        "Report": "torsionnet.report.document_tree",
        "ReportPlan": "torsionnet.report.plan",
        "Revision": "torsionnet.report.plan",
        "TitleBlock": "torsionnet.report.plan",
        "make_report": "torsionnet.report.report",
        "write_report": "torsionnet.report.report",
    },
)
