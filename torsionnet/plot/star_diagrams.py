"""Phase-vector (star) diagrams of the orders that a mode meets."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.style as style
from torsionnet.core.errors import UsageError
from torsionnet.response.star_diagram import StarDiagram

ACROSS = 4


def star_diagrams(stars: Sequence[StarDiagram], *, title: str | None = None) -> Figure:
    """One panel per order: the vectors of the cylinders in colour, their sum in black.

    Vectors end to end would not show which cylinder is which, so all start in the middle. Angles are those of the
    torques, zero to the right, counted to the left.

    Parameters
    ----------
    stars : sequence of StarDiagram
    title : str, optional
        By default that of the first.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        There are none.
    """
    if not stars:
        raise UsageError("there is no star diagram to draw: no order meets this mode in or near the operating range")
    across = min(ACROSS, len(stars))
    down = math.ceil(len(stars) / across)
    figure = style.new_figure(style.WIDTH, 0.6 + down * style.WIDTH / ACROSS * 1.16)
    panels = figure.subplots(down, across, squeeze=False).ravel()
    for panel, star in zip(panels, stars, strict=False):
        _draw(panel, star)
    for panel in panels[len(stars) :]:
        panel.set_visible(False)
    style.heading(figure, stars[0].title if title is None else title)
    return figure


def _draw(axes: Axes, star: StarDiagram) -> None:
    reach = 1.3 * max(1.0, abs(star.sum))
    axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set_visible(False)
    turn = np.linspace(0, 2 * np.pi, 181)
    axes.plot(np.cos(turn), np.sin(turn), color=style.FAINT, linewidth=0.8, zorder=1)
    together: dict[tuple[float, float], list[str]] = {}
    for number, (label, vector) in enumerate(zip(star.labels, star.vectors, strict=True)):
        if vector:
            _arrow(axes, vector, style.PALETTE[number % len(style.PALETTE)], 1.3)
            angle = round(float(np.degrees(np.angle(vector))), 3) % 360
            together.setdefault((math.cos(math.radians(angle)), math.sin(math.radians(angle))), []).append(label)
    for (x, y), labels in together.items():
        size = 1.16 if reach < 2 else 1 + 0.13 * reach
        axes.text(size * x, size * y, ",".join(labels), ha="center", va="center", fontsize=style.SMALL - 1)
    if abs(star.sum) > 1e-9:
        _arrow(axes, star.sum, style.INK, 2.0)
    text = f"{star.excitation} {star.order:g}\nsum {abs(star.sum):.3g}"
    axes.set_title(text, fontsize=style.SMALL, color=style.INK, pad=3)


def _arrow(axes: Axes, vector: complex, color: str, width: float) -> None:
    properties = {"arrowstyle": "-|>", "color": color, "linewidth": width, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (vector.real, vector.imag), xytext=(0, 0), arrowprops=properties, zorder=3)
