"""The picture on the page of sign conventions: torque at a cut, gear ratio, lag."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, Rectangle

BLUE, RED, GREY = "#0072B2", "#D55E00", "#555555"


def draw(path: Path) -> None:
    """Write the picture as SVG."""
    figure = Figure(figsize=(8.0, 5.6), layout="constrained", facecolor="white")
    grid = figure.subplot_mosaic([["cut", "cut"], ["gear", "lag"]], height_ratios=[1, 1.25])
    cut(grid["cut"])
    gear(grid["gear"])
    lag(grid["lag"])
    with mpl.rc_context({"svg.hashsalt": "torsionnet", "svg.fonttype": "path"}):
        figure.savefig(path, metadata={"Date": None})


def bare(axes: Axes, width: float, height: float, title: str) -> None:
    axes.set(xlim=(0, width), ylim=(0, height), aspect="equal")
    axes.axis("off")
    axes.set_title(title, fontsize=10, loc="left")


def arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], color: str, **more: object) -> None:
    look = {"arrowstyle": "-|>", "mutation_scale": 14, "linewidth": 1.8, "color": color}
    axes.add_patch(FancyArrowPatch(start, end, **look | more))


def cut(axes: Axes) -> None:
    bare(axes, 16, 4.2, "Torque through an element is positive when it drives from the first node to the second")
    for x, node in ((2.2, "first node a"), (13.8, "second node b")):
        axes.add_patch(Rectangle((x - 0.35, 0.8), 0.7, 2.4, facecolor="#e8eef4", edgecolor=GREY))
        axes.text(x, 3.5, node, ha="center", fontsize=9)
    axes.plot([2.55, 5.4], [2, 2], color=GREY, linewidth=2)
    axes.plot([10.6, 13.45], [2, 2], color=GREY, linewidth=2)
    axes.add_patch(Rectangle((5.4, 1.2), 5.2, 1.6, facecolor="white", edgecolor=GREY, linewidth=1.5))
    axes.text(8, 2, "element: spring, coupling,\ngear, ...", ha="center", va="center", fontsize=9)
    for start, end, text in (((3.0, 1.2), (4.9, 1.2), "torque at a"), ((11.1, 1.2), (13.0, 1.2), "torque at b")):
        arrow(axes, start, end, RED)
        axes.text((start[0] + end[0]) / 2, 0.55, text, ha="center", fontsize=9, color=RED)
    for x in (3.95, 12.05):
        axes.plot([x, x], [1.6, 2.4], color=BLUE, linestyle="--", linewidth=1.2)
        axes.text(x, 2.55, "cut", ha="center", fontsize=8, color=BLUE)
    axes.text(8, 0.15, "massless element: torque at b = ratio x torque at a", ha="center", fontsize=9, color=GREY)


def gear(axes: Axes) -> None:
    bare(axes, 8, 6, "Ratio = speed of first / speed of second")
    for center, radius, label in (((2.0, 2.8), 1.3, "first\n$z_a$"), ((5.4, 2.8), 2.1, "second\n$z_b$")):
        axes.add_patch(Circle(center, radius, facecolor="#e8eef4", edgecolor=GREY, linewidth=1.5))
        axes.text(*center, label, ha="center", va="center", fontsize=9)
    arrow(axes, (1.2, 4.2), (2.8, 4.2), BLUE, connectionstyle="arc3,rad=-0.35")
    arrow(axes, (6.4, 4.95), (4.4, 4.95), BLUE, connectionstyle="arc3,rad=0.35")
    axes.text(2.0, 4.75, r"$\omega_a$", ha="center", fontsize=11, color=BLUE)
    axes.text(5.4, 5.45, r"$\omega_b$", ha="center", fontsize=11, color=BLUE)
    text = r"external mesh: $\tau = \omega_a/\omega_b = -z_b/z_a < 0$"
    axes.text(4, 0.1, text, ha="center", fontsize=9)


def lag(axes: Axes) -> None:
    t = np.linspace(0, 2, 400)
    phase = -60.0
    axes.plot(t, np.cos(2 * np.pi * t), color=RED, label="input, phase 0")
    axes.plot(t, 0.8 * np.cos(2 * np.pi * t + np.radians(phase)), color=BLUE, linestyle="--", label="output, -60 deg")
    delay = -phase / 360
    axes.annotate("", (1 + delay, 1.12), (1, 1.12), arrowprops={"arrowstyle": "-|>", "color": GREY})
    axes.text(1 + delay / 2, 1.2, "later", ha="center", fontsize=9, color=GREY)
    axes.set(xlabel="time in periods", ylim=(-1.9, 1.5), xlim=(0, 2), yticks=[])
    axes.set_title(r"$e^{+j\omega t}$: what comes later has a negative phase", fontsize=10, loc="left")
    axes.legend(loc="lower left", fontsize=8, framealpha=1)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
