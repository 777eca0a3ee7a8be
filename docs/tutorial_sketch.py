"""Drawing from which the first tutorial starts: a plunger pump on its test stand, as an engineer would sketch it."""

from __future__ import annotations

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from sign_picture import save

INK, STEEL, RUBBER, PAPER = "#20304a", "#dfe5ee", "#5b5b5b", "white"
AXIS, WHEEL_AXIS = 0.0, -3.2
"""Heights of the centre lines of the motor and of the pump."""


def write(path: Path) -> None:
    """Write the drawing as SVG."""
    figure = Figure(figsize=(9.6, 4.6), facecolor=PAPER)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(-0.3, 23.7), ylim=(-8.3, 3.2), aspect="equal")
    axes.set_axis_off()
    _parts(axes)
    _labels(axes)
    save(figure, path)


def _parts(axes: Axes) -> None:
    for left, right, height in ((-0.1, 11.9, AXIS), (9.9, 23.4, WHEEL_AXIS)):
        axes.plot([left, right], [height, height], color=INK, lw=0.7, ls=(0, (14, 3, 3, 3)), zorder=5)
    _turned(axes, 0.4, 3.6, 1.25)  # motor
    _turned(axes, 3.6, 4.4, 0.22)
    _turned(axes, 4.4, 5.0, 0.55)  # torque meter: flange, measuring shaft, flange
    _turned(axes, 5.0, 5.8, 0.3)
    _turned(axes, 5.8, 6.4, 0.55)
    _turned(axes, 6.4, 7.0, 1.7)  # flywheel
    for side in (1, -1):  # rubber ring of the coupling
        corners = [(7.0, side * 1.35), (7.7, side * 1.1), (7.7, side * 0.55), (7.0, side * 0.8)]
        axes.add_patch(Polygon(corners, facecolor=RUBBER, edgecolor=INK, lw=1))
    _turned(axes, 7.7, 8.2, 1.15)  # driven half
    _turned(axes, 8.2, 10.3, 0.22)
    _turned(axes, 10.3, 11.3, 0.8)  # pinion
    _turned(axes, 10.3, 11.3, 2.4, WHEEL_AXIS)  # wheel
    _turned(axes, 11.3, 18.2, 0.3, WHEEL_AXIS)  # shaft to the pump
    _turned(axes, 18.2, 22.8, 1.5, WHEEL_AXIS)  # pump
    for left in (19.0, 20.3, 21.6):
        axes.add_patch(Rectangle((left - 0.3, WHEEL_AXIS + 1.5), 0.6, 0.9, facecolor=PAPER, edgecolor=INK, lw=1))


def _turned(axes: Axes, left: float, right: float, radius: float, axis: float = AXIS) -> None:
    """Draw a turned part in side view."""
    corner, width = (left, axis - radius), right - left
    axes.add_patch(Rectangle(corner, width, 2 * radius, facecolor=STEEL, edgecolor=INK, lw=1.2, zorder=2))


def _labels(axes: Axes) -> None:
    for x, y, text in (
        (2.0, 2.0, "motor\n0.06 kg m²"),
        (4.75, 0.85, "torque meter\n60 kN m/rad"),
        (7.2, 1.95, "flywheel, 0.10 kg m²"),
        (14.0, 1.1, "rubber coupling, 60 Shore: 450 N m/rad\ndriven half with pinion: 0.03 kg m²"),
        (12.6, -0.55, "23 teeth"),
        (12.9, -5.3, "69 teeth\n0.15 kg m²"),
        (15.4, -2.75, "steel Ø 45"),
        (20.5, 0.0, "three plungers\ncrankshaft 1.2 kg m²"),
    ):
        axes.text(x, y, text, ha="center", va="bottom", fontsize=9, color=INK, zorder=6)
    axes.annotate("", (8.0, 0.9), (10.2, 1.35), arrowprops={"arrowstyle": "-", "color": INK, "lw": 0.7})
    axes.annotate("", (11.3, -6.3), (18.2, -6.3), arrowprops={"arrowstyle": "<->", "color": INK, "lw": 0.9})
    for x in (11.3, 18.2):
        axes.plot([x, x], [-6.5, WHEEL_AXIS - 0.4], color=INK, lw=0.6)
    axes.text(14.75, -6.2, "620 mm", ha="center", va="bottom", fontsize=9, color=INK)
    axes.text(0.2, -6.0, "900 to 1800 r/min at the motor\npump: 3 pulses a turn", fontsize=9, color=INK, va="top")
    axes.text(23.4, -8.1, "drawing 2041", fontsize=8, color=INK, ha="right", va="bottom")
