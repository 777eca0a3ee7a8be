"""The report on a model: what it says as a tree, and the writers that make HTML, LaTeX, Markdown or PDF of it.

>>> from torsionnet.document import make_report
>>> report = make_report("dmf_rig", sections=["modes", "validity"], date=None)
>>> [section.name for section in report.sections]
['modes', 'validity']
"""

from __future__ import annotations

from torsionnet.document.report import make_report, write_report
from torsionnet.document.request import Measured
from torsionnet.document.tree import Report

__all__ = ["Measured", "Report", "make_report", "write_report"]
