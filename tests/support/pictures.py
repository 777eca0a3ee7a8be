"""Schematics to look at, and what can be wrong in them."""

import itertools
from functools import cache

import pytest
from validation.build import build, case_names, read_case

import torsionnet as tn
from support.drawn_models import MODELS, inertia
from support.library_cases import LARGE
from support.models import EVERY_ELEMENT


def alone(kind):
    element = EVERY_ELEMENT[kind]
    nodes = [node for node in dict.fromkeys(element.ports.values()) if node != "ground"]
    return tn.Drivetrain(kind, [element, *(inertia(f"J_{node}", node) for node in nodes)])


# The chain of 200 has a test of its own; here it would take as long as all others together.
CASES = [case for case in case_names() if "nodes" in read_case(case) and len(read_case(case)["nodes"]) < 100]
EXAMPLES = {
    **{name: lambda name=name: tn.load(name) for name in tn.library_models()},
    **{case: lambda case=case: build(read_case(case)) for case in CASES},
    **{kind: lambda kind=kind: alone(kind) for kind in EVERY_ELEMENT},
    **MODELS,
}
REPEATED = {*CASES[1:], *(f"random {seed}" for seed in range(2, 8)), *LARGE}
"""Examples whose like is among the others: cases beside the library's models, random ones beside the first, plants."""
SOME_EXAMPLES = [name for name in EXAMPLES if name not in REPEATED]
each_example = pytest.mark.parametrize(
    "example", [pytest.param(name, marks=[pytest.mark.slow] * (name in REPEATED)) for name in EXAMPLES]
)


@cache
def drawn(example):
    """The schematic of an example, made once for all tests that look at it."""
    from torsionnet.plot import schematic

    return drawable(schematic(EXAMPLES[example]()))


def texts(figure):
    return [text.get_text() for text in figure.axes[0].texts]


def collisions(figure):
    """Pairs of texts whose boxes overlap by more than half a pixel, as drawn."""
    renderer = figure.canvas.get_renderer()
    shown = [(text.get_text(), text.get_window_extent(renderer)) for text in figure.axes[0].texts]
    return [
        (first, second)
        for (first, a), (second, b) in itertools.combinations(shown, 2)
        if min(a.x1, b.x1) - max(a.x0, b.x0) > 0.5 and min(a.y1, b.y1) - max(a.y0, b.y0) > 0.5
    ]


def outside(figure):
    """Texts that are not wholly in the picture; a drawing leaves the renderer they are measured with."""
    boxes = [(text.get_text(), text.get_window_extent()) for text in figure.axes[0].texts]
    page = figure.bbox
    return [text for text, box in boxes if box.x0 < page.x0 or box.x1 > page.x1 or box.y0 < page.y0 or box.y1 > page.y1]


def crossed(figure):
    """Texts with a line through them, or on a filled symbol other than the box whose port or content they name."""
    renderer, back = figure.canvas.get_renderer(), figure.axes[0].transData.inverted()
    boxes = [
        (text.get_text(), text.get_window_extent(renderer).transformed(back).padded(-1.0))
        for text in figure.axes[0].texts
    ]
    texts_crossed = []
    for patch in figure.axes[0].patches:
        path, around = patch.get_path(), patch.get_path().get_extents()
        texts_crossed += [
            text
            for text, box in boxes
            if meet(around, box)  # far quicker to say, and nearly always no
            and path.intersects_bbox(box, filled=patch.get_fill())
            and not (patch.get_fill() and contains(around, box))
        ]
    return texts_crossed


def meet(one, other):
    return one.x0 <= other.x1 and other.x0 <= one.x1 and one.y0 <= other.y1 and other.y0 <= one.y1


def contains(outer, inner):
    return outer.x0 <= inner.x0 and inner.x1 <= outer.x1 and outer.y0 <= inner.y0 and inner.y1 <= outer.y1


def on_paper(figure):
    """Size in points of the smallest text when the figure is printed 170 mm wide."""
    scale = min(1.0, 170 / 25.4 / figure.get_size_inches()[0])
    return scale * min(text.get_fontsize() for text in figure.axes[0].texts)


def is_round(patch):
    box = patch.get_path().get_extents()
    return abs(box.width - box.height) < 0.01 and len(patch.get_path().vertices) > 20


def drawable(figure):
    """The figure on a canvas, whose renderer measures texts where they stand; nothing has to be drawn for that."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    FigureCanvasAgg(figure)
    return figure
