"""Figures of a report as files in a folder beside it."""

from __future__ import annotations

import re
from pathlib import Path

from torsionnet.core.atomic import write_bytes
from torsionnet.report.document_tree import Report


def figure_folder(path: Path) -> Path:
    """``rig.tex`` has its figures in ``rig_figures``; what a link or LaTeX may not hold becomes ``_``.

    >>> figure_folder(Path("gear V 100%.tex")).name
    'gear_V_100__figures'
    """
    return path.with_name(re.sub(r"[^A-Za-z0-9.-]", "_", path.stem) + "_figures")


def write_figures(report: Report, path: Path, form: str) -> tuple[Path, ...]:
    """Write every figure as SVG or PDF; gives their paths."""
    from torsionnet.plot.rendering import rendered

    folder, written = figure_folder(path), []
    for picture in report.pictures:
        folder.mkdir(exist_ok=True)
        file = folder / f"{picture.name}.{form}"
        write_bytes(file, rendered(picture.drawn, form))
        written.append(file)
    return tuple(written)
