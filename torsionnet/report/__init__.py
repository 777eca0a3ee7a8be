"""The report on a model: what it says as a tree, and the writers that make HTML, LaTeX, Markdown or PDF of it.

>>> from torsionnet.report import make_report
>>> report = make_report("dmf_rig", sections=["modes", "validity"], date=None)
>>> [section.name for section in report.sections]
['modes', 'validity']
"""

from __future__ import annotations

import warnings

import torsionnet.plot as plot
from torsionnet.report.document_tree import Report
from torsionnet.report.report import make_report, write_report
from torsionnet.report.request import Measured

__all__ = ["Measured", "Report", "make_report", "write_report"]


def __getattr__(name: str) -> object:
    """Pictures, which had their place here before they got a package of their own."""
    if name not in plot.__all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}", name=name)
    warnings.warn(f"torsionnet.report.{name} is torsionnet.plot.{name} now", DeprecationWarning, stacklevel=2)
    return getattr(plot, name)
