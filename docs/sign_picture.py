"""Pictures of the page on sign conventions, drawn with the symbols of the schematic."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from torsionnet.plot.drawing import style
from torsionnet.plot.drawing.pieces import Piece, Stroke, Texts, arc, text_width
from torsionnet.plot.schematics import outlines
from torsionnet.plot.schematics import symbols as box_symbols
from torsionnet.plot.schematics.schematic import figure_of_drawing

EDGE = 12.0
RC = {"svg.hashsalt": "torsionnet", "svg.fonttype": "path"}


def write_all(folder: Path) -> None:
    """Write every picture as SVG, named after what it shows."""
    for name, draw in PICTURES.items():
        block = draw()
        x0, x1, y0, y1 = block.extent
        save(figure_of_drawing(block, (x0 - EDGE, x1 + EDGE, y0 - EDGE, y1 + EDGE)), folder / f"signs_{name}.svg")
    save(lag(), folder / "signs_lag.svg")


def save(figure: Figure, path: Path) -> None:
    with mpl.rc_context(RC):
        figure.savefig(path, metadata={"Date": None})


# Pieces


def turn(block: Piece, x: float, texts: Texts, look: str, *, y: float = 0.0) -> None:
    """Draw an arrow around the shaft in the positive sense, with its name above."""
    for stroke in outlines.torque_arrow(x):
        fill = look if stroke.fill else ""
        block.strokes.append(Stroke(tuple((u, v + y) for u, v in stroke.points), look, stroke.closed, fill))
    block.boxes.append((x - 8, x + 8, y - 19, y + 19))
    block.write(x, y + 20, texts)


def node(block: Piece, x: float, name: str, *, y: float = 0.0) -> None:
    """Draw a disc with the name of its node."""
    block.strokes += [stroke.shifted(0, y) for stroke in outlines.disc(x, 24)]
    block.boxes.append((x - 8, x + 8, y - 24, y + 24))
    block.write(x, y + 26, [(name, "node")])


def cut(block: Piece, x: float, *, y: float = 0.0) -> None:
    """Draw the line at which a shaft is imagined to be cut."""
    block.strokes.append(Stroke(((x, y - 26), (x, y + 14)), "housing"))
    block.boxes.append((x - 1, x + 1, y - 26, y + 14))
    block.write(x, y - 27, [("cut", "what")], upward=False)


def below(block: Piece, x: float, *lines: str) -> None:
    """Write sentences below a drawing."""
    block.write(x, block.extent[2] - 6, [(line, "value") for line in lines], upward=False)


def spin(block: Piece, x: float, y: float, radius: float, start: float, end: float, look: str) -> None:
    """Draw an arc with an arrow head, seen along the axis; angles in degrees."""
    path = arc(x, y, radius, radius, start, end)
    block.strokes.append(Stroke(path, look))
    sign = 1 if end > start else -1
    along = math.radians(end + 90 * sign)
    tip, across = path[-1], math.radians(end)
    head = [
        (tip[0] + 6 * math.cos(along), tip[1] + 6 * math.sin(along)),
        (tip[0] + 3.4 * math.cos(across), tip[1] + 3.4 * math.sin(across)),
        (tip[0] - 3.4 * math.cos(across), tip[1] - 3.4 * math.sin(across)),
    ]
    block.strokes.append(Stroke(tuple(head), look, closed=True, fill=look))
    block.boxes += [(u - 4, u + 4, v - 4, v + 4) for u, v in path]


def wheel(block: Piece, x: float, y: float, radius: float, name: str, *, inner: bool = False) -> None:
    """Draw a gear seen along its axis; a ring has its teeth inside."""
    teeth = radius - 3 if not inner else radius + 3
    outer, within = ((teeth, "thin", ""), (radius, "part", "")), ((radius, "part", outlines.WHEEL), (teeth, "thin", ""))
    circles = outer if inner else within
    for size, look, fill in circles:
        block.strokes.append(Stroke(arc(x, y, size, size, 0, 360, 48), look, closed=True, fill=fill))
        block.boxes.append((x - size, x + size, y - size, y + size))
    if name:
        block.write(x, y - 6, [(name, "value")])


# Pictures


def spring() -> Piece:
    block = Piece()
    block.line((-40, 0), (340, 0))
    node(block, 20, "first node a")
    node(block, 280, "second node b")
    spring_shape = outlines.zigzag(0, 48, 0)
    block.strokes += [outlines.rectangle(126, 174, -8, 8, style.PAPER, look="blank"), spring_shape.shifted(126, 0)]
    block.boxes.append((126, 174, -13, 13))
    for x, name in ((92, "a"), (208, "b")):
        turn(block, x, [(rf"$T_{{\mathrm{{{name}}}}}$", "input")], "input")
        cut(block, x - 14)
    turn(block, -34, [(r"$\theta_{\mathrm{a}}$", "sensor")], "sensor")
    turn(block, 334, [(r"$\theta_{\mathrm{b}}$", "sensor")], "sensor")
    below(
        block,
        150,
        "all angles in one sense; twist = angle of a minus angle of b",
        "at the first port: positive when node a drives the element",
        "at the other port: positive when the element drives node b",
        "without inertia or drag of its own, both readings are equal",
    )
    return block


def gears() -> Piece:
    block = Piece()
    wheel(block, 0, 0, 26, r"$z_{\mathrm{a}}$")
    wheel(block, 69, 0, 43, r"$z_{\mathrm{b}}$")
    spin(block, 0, 0, 34, 150, 60, "sensor")
    spin(block, 69, 0, 51, 55, 115, "sensor")
    block.write(-2, 42, [(r"$\omega_{\mathrm{a}} > 0$", "sensor")])
    block.write(72, 60, [(r"$\omega_{\mathrm{b}} < 0$", "sensor")])
    x = 240
    wheel(block, x, 0, 60, "", inner=True)
    wheel(block, x - 34, 0, 26, r"$z_{\mathrm{a}}$")
    block.write(x + 30, -6, [(r"$z_{\mathrm{b}}$", "value")])
    spin(block, x - 34, 0, 18, 140, 40, "sensor")
    spin(block, x, 0, 71, 115, 55, "sensor")
    block.write(x, 80, [(r"$\omega_{\mathrm{a}} > 0,\ \omega_{\mathrm{b}} > 0$", "sensor")])
    bottom = block.extent[2] - 6
    for middle, name, sign in ((42, "external mesh", "-"), (x, "internal mesh", "")):
        law = rf"$\tau = \omega_{{\mathrm{{a}}}}/\omega_{{\mathrm{{b}}}} = {sign}z_{{\mathrm{{b}}}}/z_{{\mathrm{{a}}}}$"
        block.write(middle, bottom, [(name, "name"), (law, "value")], upward=False)
    return block


def planetary() -> Piece:
    block = Piece()
    factor = 2.6
    for stroke in box_symbols.planetary_symbol(0, 0):
        points = tuple((factor * u, factor * v) for u, v in stroke.points)
        block.strokes.append(Stroke(points, stroke.look, stroke.closed, stroke.fill))
    block.boxes.append((-62, 62, -62, 62))
    spin(block, 0, 0, 70, 125, 65, "sensor")
    block.write(-6, 78, [(r"$\theta_{\mathrm{ring}},\ T_{\mathrm{ring}}$ out", "sensor")])
    labels = (
        (r"$\theta_{\mathrm{sun}},\ T_{\mathrm{sun}}$ in", 8, (14.0, 8.0)),
        (r"$\theta_{\mathrm{carrier}},\ T_{\mathrm{carrier}}$ out", -34, (32.5, -19.0)),
    )
    for text, y, (u, v) in labels:
        block.strokes.append(Stroke(((u, v), (84, y + 4)), "sensor"))
        block.write(88 + text_width(text, "sensor") / 2, y, [(text, "sensor")])
    below(
        block,
        40,
        "all angles in one sense, whatever the wheels do",
        r"$\theta_{\mathrm{sun}} + z\,\theta_{\mathrm{ring}} - (1+z)\,\theta_{\mathrm{carrier}} = 0$",
        r"$z = z_{\mathrm{ring}}/z_{\mathrm{sun}}$, and without inertia of the planets",
        r"$T_{\mathrm{carrier}} = (1+z)\,T_{\mathrm{sun}},\quad T_{\mathrm{ring}} = -z\,T_{\mathrm{sun}}$",
    )
    return block


def sensor() -> Piece:
    block = Piece()
    block.line((-18, 0), (120, 0))
    block.strokes += [*outlines.wheel(120, 0, 24), *outlines.wheel(120, -64, 40)]
    block.line((120, -64), (260, -64))
    block.boxes.append((113, 127, -104, 24))
    node(block, 2, "a")
    node(block, 240, "b", y=-64)
    for x, y, text in ((62, 0, "{torque: stage}"), (180, -64, "{torque: stage, at: b}")):
        block.strokes += [stroke.shifted(0, y) for stroke in outlines.sensor_mark(x, torque=True)]
        block.boxes.append((x - 5, x + 5, y - 5, y + 20))
        block.write(x, y + 20, [(text, "sensor")])
    block.write(120, 27, [("stage", "name")])
    below(
        block,
        130,
        r"at: the port by its name (second) or the node on it (b); left out, it is the first port",
        r"$T_{\mathrm{b}} = \tau\,T_{\mathrm{a}}$ for a massless stage",
    )
    return block


def clamp() -> Piece:
    block = Piece()
    block.line((-18, 0), (250, 0))
    node(block, 20, "a")
    block.strokes += [outlines.rectangle(80, 128, -8, 8, style.PAPER, look="blank"), outlines.zigzag(80, 128, 0)]
    block.strokes += [stroke.shifted(250, 0) for stroke in outlines.wall(0)]
    block.boxes += [(80, 128, -13, 13), (250, 258, -18, 18)]
    block.write(254, 22, [("brake", "name")])
    turn(block, 168, [(r"$T_{\mathrm{R}}$", "input")], "input")
    cut(block, 152)
    below(
        block,
        125,
        "{torque: brake}: what the drivetrain exerts on the clamp, positive when it would turn it",
        "the ground answers with the same torque in the opposite sense",
    )
    return block


def imposed() -> Piece:
    block = Piece()
    block.line((0, 0), (280, 0))
    turn(block, 6, [(r"$\theta_{\mathrm{E}}$", "input"), ("imposed angle", "what")], "input")
    block.strokes += [outlines.rectangle(100, 148, -8, 8, style.PAPER, look="blank"), outlines.zigzag(100, 148, 0)]
    block.boxes.append((100, 148, -13, 13))
    node(block, 240, "b")
    block.write(124, -14, [("shaft", "name")], upward=False)
    mark = 66
    block.strokes += outlines.sensor_mark(mark, torque=True)
    block.boxes.append((mark - 5, mark + 5, -5, 20))
    block.write(mark, 20, [(r"$T$", "sensor")])
    below(
        block,
        140,
        "node a moves by the given angle, positive in the common sense, whatever torque that takes",
        "{torque: shaft} says which torque: positive when node a drives the shaft",
    )
    return block


def lag() -> Figure:
    """Drawing of an input and a later output over time."""
    figure = Figure(figsize=(4.6, 2.8), layout="constrained", facecolor="white")
    axes = figure.subplots()
    t, phase = np.linspace(0, 2, 400), -60.0
    axes.plot(t, np.cos(2 * np.pi * t), color=style.PALETTE[1], label="input, phase 0")
    late = 0.8 * np.cos(2 * np.pi * t + np.radians(phase))
    axes.plot(t, late, color=style.PALETTE[0], linestyle="--", label="output, phase −60°")
    delay = -phase / 360
    axes.annotate("", (1 + delay, 1.12), (1, 1.12), arrowprops={"arrowstyle": "-|>", "color": style.MUTED})
    axes.text(1 + delay / 2, 1.2, "later", ha="center", fontsize=9, color=style.MUTED)
    axes.set(xlabel="time in periods", ylim=(-1.9, 1.5), xlim=(0, 2), yticks=[])
    axes.legend(loc="lower left", fontsize=8, framealpha=1)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
    return figure


PICTURES: dict[str, Callable[[], Piece]] = {
    "spring": spring,
    "gears": gears,
    "planetary": planetary,
    "sensor": sensor,
    "clamp": clamp,
    "imposed": imposed,
}
