"""Writing figures to SVG, PNG and PDF files."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from torsionnet.base.atomic import write_bytes
from torsionnet.base.errors import UsageError

DPI = 150
"""Dots per inch of PNG files: a picture of a page's width has 1080 dots, as many as a screen shows."""
# Without the date, and with a fixed salt for the names inside an SVG, equal figures give equal files.
METADATA: dict[str, dict[str, Any]] = {
    "svg": {"Date": None},
    "png": {"Software": None},
    "pdf": {"CreationDate": None},
}
SETTINGS: dict[Any, Any] = {"svg.hashsalt": "torsionnet", "svg.fonttype": "path", "pdf.fonttype": 42}


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure as SVG, PNG (150 dpi) or PDF, by the ending of the file.

    The file is written whole or not at all, and equal figures give equal bytes.

    Raises
    ------
    UsageError
        Any other ending.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.plot import schematic, save
    >>> save(schematic(tn.load("amt_rig")), "rig.jpg")
    Traceback (most recent call last):
    torsionnet.base.errors.UsageError: cannot write "rig.jpg": give a file ending in .svg, .png or .pdf
    """
    form = Path(path).suffix.lower().removeprefix(".")
    if form not in METADATA:
        raise UsageError(f'cannot write "{path}": give a file ending in .svg, .png or .pdf')
    buffer = io.BytesIO()
    with mpl.rc_context(SETTINGS):
        figure.savefig(buffer, format=form, dpi=DPI, metadata=METADATA[form])
    write_bytes(path, buffer.getvalue())
