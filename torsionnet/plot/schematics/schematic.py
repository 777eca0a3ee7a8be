"""Schematic of a drivetrain as a matplotlib figure, with its connected parts beside each other on a page."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from torsionnet.plot.schematics.arrangement import (
    MILLIMETRES_PER_INCH,
    PAPER_WIDTH,
    arranged,
    framed,
    page_width,
    titled,
)
from torsionnet.plot.schematics.canvas import figure_of_drawing
from torsionnet.plot.schematics.drawing_parts import cut_heights, part_between
from torsionnet.plot.schematics.part_boxes import with_part_boxes
from torsionnet.plot.schematics.pens import POINTS_PER_INCH

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


def schematic(
    drivetrain: Drivetrain, *, title: str | None = None, width: float = PAPER_WIDTH, boxes: bool = False
) -> Figure:
    r"""Figure of the schematic of a drivetrain, with shafts from left to right, inertias as discs, inputs and sensors.

    Shafts run from left to right in the order of the model's nodes, whose names stand above them. Inertias are discs
    whose height grows with the logarithm of the inertia; gear stages and branches go on on lines of their own, and an
    element that closes a loop is led back to its node. Curved arrows are inputs, dots and diamonds are sensors of
    motion and of torque. Lines wider than the page go on below, a branch without room begins a line of its own, with
    flags at both ends. Gears on one moving housing that make up sun, planets and ring are drawn as a planetary set.

    Parameters
    ----------
    drivetrain : Drivetrain
        Only elements that are switched on are drawn. With more than 40 nodes only the nodes are named.
    title : str, optional
        By default name and configuration of the drivetrain.
    width : float, optional
        Width of the page in mm, at least 100: lines are broken so that the smallest text has 6 points when the figure
        is printed that wide. By default the text width of an A4 page.

    boxes : bool, optional
        Draw each part that the model uses as one box; else all that is in it.

    Returns
    -------
    matplotlib.figure.Figure
        One axes without ticks; a unit is a point. Its own width is at most 7/6 of the page's.

    Raises
    ------
    UsageError
        The page is narrower than 100 mm.

    Examples
    --------
    >>> import torsionnet as tn
    >>> figure = schematic(tn.load("amt_rig"))
    >>> [text.get_text() for text in figure.axes[0].texts if "460" in text.get_text()]
    ['$k_{\\mathrm{1}}$ = 460 N·m/rad']
    """
    page = page_width(width)
    whole = arranged(with_part_boxes(drivetrain) if boxes else drivetrain, page)
    return figure_of_drawing(whole, framed(titled(whole, drivetrain.title if title is None else title, page)))


def schematic_parts(drivetrain: Drivetrain, tallest: float, *, width: float = PAPER_WIDTH) -> tuple[Figure, ...]:
    """Figures of the parts of a drivetrain's schematic, from top to bottom, each at most ``tallest`` mm high in print.

    Parameters
    ----------
    drivetrain : Drivetrain
    tallest : float
        mm, at the size in which a part as wide as the page is printed.
    width : float, optional
        Width of the page in mm.

    Examples
    --------
    >>> import torsionnet as tn
    >>> len(schematic_parts(tn.load("wind_turbine_3mw").configured("free"), 235))
    2
    """
    whole = arranged(drivetrain, page_width(width))
    x0, x1, y0, y1 = framed(whole.extent)
    printed = min(1.0, width / MILLIMETRES_PER_INCH * POINTS_PER_INCH / (x1 - x0))
    most = tallest / MILLIMETRES_PER_INCH * POINTS_PER_INCH / printed
    edges = [y1, *cut_heights(whole, (x0, x1, y0, y1), most), y0]
    return tuple(
        figure_of_drawing(part_between(whole, low, high), (x0, x1, low, high)) for high, low in pairwise(edges)
    )
