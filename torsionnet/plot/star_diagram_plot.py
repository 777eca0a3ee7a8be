"""Plot of phase-vector (star) diagrams of the orders that excite a mode."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.errors import UsageError
from torsionnet.machinery.phasors.vector_sums import StarDiagram, VectorSums, order_names
from torsionnet.plot.drawing.style import GivenAxes

PANELS_PER_ROW = 4
"""Number of star diagrams side by side; more would be too small for the numbers of the cylinders."""
LONGEST_TITLE = 80
"""Largest number of letters in a line of the title above star diagrams."""
COVERING_COSINE = 0.95
"""Cosine of the angle between a cylinder's vector and the sum, above which the sum would cover that vector's label."""


def star_diagrams(stars: Sequence[StarDiagram], *, title: str | None = None, ax: GivenAxes = None) -> Figure:
    """Figure of the cylinders' phase vectors in colour and their sum in black, a diagram for orders of equal vectors.

    Orders with equal vectors share a diagram. Angles are those of the torques, zero to the right, counter-clockwise;
    the circle is one cylinder at the largest amplitude.

    Parameters
    ----------
    stars : sequence of StarDiagram
    title : str, optional
        By default that of the first.
    ax : sequence of Axes, optional
        Axes to draw into, one for each group of orders with equal vectors; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        There are none.
    """
    if not stars:
        raise UsageError(
            "there is no star diagram to draw: no order meets this mode in or near the operating range",
            kind="missing-data",
        )
    groups = _alike(stars)
    across = min(PANELS_PER_ROW, len(groups))
    height = 0.6 + math.ceil(len(groups) / across) * style.WIDTH / PANELS_PER_ROW * 1.16
    orders_of = [", ".join(f"{star.order:g}" for star in group) for group in groups]
    shows = [f"orders {orders}" for orders in orders_of]
    sheet, _ = style.grid_panels(style.WIDTH, height, shows, ax, columns=across)
    for panel, group, orders in zip(sheet.panels, groups, orders_of, strict=True):
        draw_star(panel, group[0])
        text = f"{group[0].excitation} {orders}\nsum {abs(group[0].sum):.3g}"
        panel.set_title(text, fontsize=style.SMALL, color=style.INK, pad=3)
    words = "numbers: cylinders; black: their sum; circle: one cylinder"
    sheet.label_all(x=words, fontsize=style.SMALL, color=style.MUTED)
    return sheet.titled(textwrap.fill(stars[0].title if title is None else title, LONGEST_TITLE))


def _alike(stars: Sequence[StarDiagram]) -> list[list[StarDiagram]]:
    """Lists of star diagrams, each of the diagrams of one excitation with equal vectors."""
    groups: list[list[StarDiagram]] = []
    for star in stars:
        for group in groups:
            same = group[0].excitation == star.excitation and group[0].labels == star.labels
            if same and np.allclose(group[0].vectors, star.vectors, atol=1e-6):
                group.append(star)
                break
        else:
            groups.append([star])
    return groups


def draw_star(axes: Axes, star: StarDiagram) -> None:
    """Draw in the axes the phase vectors of one star diagram with the cylinders' numbers, and the sum in black."""
    limit = 1.3 * max(1.0, abs(star.sum))
    axes.set(xlim=(-limit, limit), ylim=(-limit, limit), aspect="equal", xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set_visible(False)
    turn = np.linspace(0, 2 * np.pi, 181)
    axes.plot(np.cos(turn), np.sin(turn), color=style.FAINT, linewidth=0.8, zorder=1)
    together: dict[float, list[str]] = {}
    for number, (label, vector) in enumerate(zip(star.labels, star.vectors, strict=True)):
        if vector:
            _arrow(axes, vector, style.PALETTE[number % len(style.PALETTE)], 1.3)
            together.setdefault(round(float(np.angle(vector)), 4) % round(2 * math.pi, 4), []).append(label)
    for angle, labels in together.items():
        x, y = math.cos(angle), math.sin(angle)
        # The sum's arrow would cover a text that lies in its direction.
        covered = abs(star.sum) > 1 and math.cos(angle - float(np.angle(star.sum))) > COVERING_COSINE
        beside = (-9 * y, -9 * abs(x)) if covered else (7 * x, 7 * y)
        axes.annotate(",".join(labels), (x, y), xytext=beside, textcoords="offset points", ha="left" if covered else
                      "center", va="center", fontsize=style.SMALL - 1)  # fmt: skip
    if abs(star.sum) > 1e-9:
        _arrow(axes, star.sum, style.INK, 2.0)


def _arrow(axes: Axes, vector: complex, color: str, width: float) -> None:
    properties = {"arrowstyle": "-|>", "color": color, "linewidth": width, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (vector.real, vector.imag), xytext=(0, 0), arrowprops=properties, zorder=3)


# Plot of the phase stars of an engine, a row for each mode and a column for each group of orders.

PANEL = 1.05
"""Height in inches of the panel of one phase star."""
MOST_ORDERS_NAMED = 3
"""Largest number of orders of a group that are named above its column; the others are in the table."""


def phase_stars(
    sums: VectorSums, *, modes: Sequence[int] | None = None, groups: Sequence[Sequence[float]] | None = None
) -> Figure:
    """Figure of the cylinders' phase vectors and, in black, their sum, a row per mode, a column per group of orders.

    Angles are those of the torques, zero to the right, counter-clockwise; the circle is one cylinder at the largest
    amplitude of the mode. Of a group the star of its first order is drawn.

    Parameters
    ----------
    sums : VectorSums
    modes : sequence of int, optional
        By default all.
    groups : sequence of sequences of float, optional
        By default all groups.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.machinery.phasors.vector_sums import vector_sums
    >>> ship = tn.load("two_stroke_ship").configured("normal")
    >>> len(phase_stars(vector_sums(ship, "engine", modes=[1, 2])).axes)
    8
    """
    rows, columns = tuple(modes or sums.modes), tuple(groups or sums.groups())
    figure = style.new_figure(style.WIDTH, 0.3 + (PANEL + 0.2) * len(rows))
    panels = figure.subplots(len(rows), len(columns), squeeze=False)
    for line, mode in zip(panels, rows, strict=True):
        for panel, group in zip(line, columns, strict=True):
            star = sums.stars[mode, group[0]]
            draw_star(panel, star)
            more = ", …" if len(group) > MOST_ORDERS_NAMED else ""
            orders = order_names(group[:MOST_ORDERS_NAMED]) + more
            head = f"order {orders}\n" if mode == rows[0] else ""
            panel.set_title(f"{head}mode {mode}: {abs(star.sum):.3g}", fontsize=style.SMALL - 1, pad=2)
    return figure
