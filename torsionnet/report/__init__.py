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
        "make_report": "torsionnet.report.report",
        "write_report": "torsionnet.report.report",
    },
)
