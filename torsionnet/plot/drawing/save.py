"""Writing figures to SVG, PNG and PDF files."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.backends.backend_svg import FigureCanvasSVG
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
    >>> from torsionnet.base.errors import UsageError
    >>> try:
    ...     save(schematic(tn.load("amt_rig")), "rig.jpg")
    ... except UsageError as error:
    ...     print(error)
    cannot write "rig.jpg": give a file ending in .svg, .png or .pdf
    """
    form = Path(path).suffix.lower().removeprefix(".")
    if form not in METADATA:
        raise UsageError(f'cannot write "{path}": give a file ending in .svg, .png or .pdf', kind="wrong-file")
    buffer = io.BytesIO()
    with mpl.rc_context(SETTINGS):
        figure.savefig(buffer, format=form, dpi=DPI, metadata=METADATA[form])
    write_bytes(path, buffer.getvalue())


# Figures as bytes of a file, and as SVG elements for an HTML page.

_ID = re.compile(r'id="([^"]+)"')
_PATH = re.compile(r'(?<= )d="([^"]+)"')
_SURPLUS = re.compile(r"-?\d+\.\d{3,}")
_USED = re.compile(r'(?:xlink:href="#|url\(#)([^")]+)')
_STYLE = re.compile(r"<defs>\s*<style[^>]*>\*\{stroke-linejoin: round; stroke-linecap: butt\}</style>\s*</defs>\s*")


def figure_bytes(figure: Figure, form: str, dpi: int = DPI) -> bytes:
    """Bytes of a figure as ``svg``, ``png`` (with ``dpi`` dots per inch) or ``pdf``; equal figures give equal bytes."""
    buffer = io.BytesIO()
    with mpl.rc_context(SETTINGS):
        if form == "svg":
            _write_svg(figure, buffer)
        else:
            figure.savefig(buffer, format=form, dpi=dpi, metadata=METADATA[form])
    return buffer.getvalue()


def _write_svg(figure: Figure, buffer: io.BytesIO) -> None:
    """Write a figure as SVG in one pass: savefig draws a figure with a layout twice, first without output."""
    canvas, dpi = figure.canvas, figure.dpi
    try:
        write: Callable[..., Any] = FigureCanvasSVG(figure).print_svg
        write(buffer, metadata=METADATA["svg"])
    finally:
        figure.set_canvas(canvas)
        figure.set_dpi(dpi)


def _two_decimals(match: re.Match[str]) -> str:
    """Text of a coordinate rounded to two decimals: a hundredth of a point is finer than any printer."""
    return f"{float(match[0]):.2f}".rstrip("0").rstrip(".")


def inline_svg(figure: Figure, prefix: str) -> str:
    """Text of the ``<svg>`` element that shows a figure on an HTML page.

    Its ids begin with ``prefix``, unused ids are removed.
    """
    text = figure_bytes(figure, "svg").decode()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text, flags=re.DOTALL)
    text = re.sub(r"<!--.*?-->\s*", "", text, flags=re.DOTALL)
    # The rule for all elements would hold for the whole page; on the figure itself it says the same.
    text = _STYLE.sub("", text).replace("<svg ", '<svg stroke-linejoin="round" stroke-linecap="butt" ', 1)
    used = dict.fromkeys(_USED.findall(text))
    names = {name: f"{prefix}{number:x}" for number, name in enumerate(used)}
    text = _ID.sub(lambda match: f'id="{names[match[1]]}"' if match[1] in names else "", text)
    text = re.sub(r'(xlink:href="#|url\(#)([^")]+)', lambda match: f"{match[1]}{names[match[2]]}", text)
    text = _PATH.sub(lambda match: f'd="{_SURPLUS.sub(_two_decimals, " ".join(match[1].split()))}"', text)
    return re.sub(r">\s+<", ">\n<", re.sub(r" +(?=/?>)", "", text)).strip()
