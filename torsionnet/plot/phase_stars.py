"""Plot of the phase stars of an engine, a row for each mode and a column for each group of orders."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.machinery.phasors.vector_sums import VectorSums, order_names
from torsionnet.plot.star_diagram_plot import draw_star

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
    >>> from torsionnet.machinery.phasors.order_vectors import vector_sums
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
