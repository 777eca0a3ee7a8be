"""What pictures of studies have in common."""

from __future__ import annotations

from matplotlib.axes import Axes

import torsionnet.plot.style as style
from torsionnet.core.number_text import bracketed, typeset_unit

LIMIT_COLOR = "#B00020"
WITHIN, BEYOND = style.PALETTE[0], LIMIT_COLOR


def axis_label(name: str, unit: str) -> str:
    """A name with its unit."""
    return f"{name} {bracketed(typeset_unit(unit))}".rstrip()


def titled(axes: Axes, text: str) -> None:
    """A short title over one of several panels."""
    axes.set_title(text, fontsize=style.FONT, color=style.INK)


def key(axes: Axes, *, columns: int = 1) -> None:
    """A legend without a frame, where best it stands."""
    axes.legend(fontsize=style.SMALL, frameon=False, ncols=columns)
