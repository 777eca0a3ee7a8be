"""The schematic as SVG: well-formed, one group for each part of a drivetrain, in the layout of the reports."""

import math
import random
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from copy import copy
from dataclasses import replace
from heapq import heappop, heappush
from itertools import pairwise

import numpy as np
import pytest
from support.drawn_models import MODELS, inertia
from support.patience import PATIENCE
from support.pictures import texts

import torsionnet as tn
from torsionnet import plot
from torsionnet.base.errors import UsageError
from torsionnet.plot.drawing.pieces import ROLES, X_HEIGHT, font_widths, is_math, symbol_runs, symbols_width, text_width
from torsionnet.plot.schematics import arrangement
from torsionnet.plot.schematics import wires as wiring
from torsionnet.plot.schematics.svg_drawing import _id, schematic_svg

ARRANGED = arrangement._arranged
SVG = "{http://www.w3.org/2000/svg}"
# Attributes that Content-Security-Policy `style-src 'self'` lets pass: presentation attributes, no style.
ALLOWED = {
    "viewBox", "width", "height", "role", "aria-label", "class", "id", "fill", "stroke", "stroke-width", "stroke-linecap",
    "stroke-linejoin", "stroke-dasharray", "text-anchor", "font-family", "font-size", "font-style", "font-weight",
    "x", "y", "dy", "d", "data-element", "data-node", "data-input", "data-sensor",
}  # fmt: skip


def examined(model, **asked):
    """The drawing and its root, after what holds for every schematic."""
    drawing = schematic_svg(model, **asked)
    root = ET.fromstring(drawing.svg)
    ids = [each.get("id") for each in root.iter() if each.get("id")]
    assert len(ids) == len(set(ids))
    assert list(drawing.elements) == list(model.elements)
    assert list(drawing.nodes) == list(model.nodes)
    assert {*drawing.elements.values(), *drawing.nodes.values()} <= set(ids)
    assert len({*drawing.elements.values(), *drawing.nodes.values()}) == len(model.elements) + len(model.nodes)
    for kind, named in (("element", drawing.elements), ("node", drawing.nodes)):
        groups = {
            each.get(f"data-{kind}"): each for each in root.iter(f"{SVG}g") if each.get(f"data-{kind}") is not None
        }
        assert {name: group.get("id") for name, group in groups.items()} == dict(named)
        assert all(group.get("class").split()[0] == kind for group in groups.values())
        assert all(name in group.find(f"{SVG}title").text for name, group in groups.items())
    assert {name for each in root.iter() for name in each.attrib} <= ALLOWED
    assert {each.tag.removeprefix(SVG) for each in root.iter()} <= {"svg", "g", "title", "path", "text", "tspan"}
    return drawing, root


def shown(root):
    return sorted("".join(each.itertext()) for each in root.iter(f"{SVG}text"))


def joined(root):
    """The texts of groups as one, without the breaks of their lines."""
    return (
        "".join(text for each in group.iter(f"{SVG}text") for text in each.itertext()) for group in root.iter(f"{SVG}g")
    )


def plain(text):
    """A label as it is read, without the markup of mathtext."""
    return "".join(run.text for run in symbol_runs(text)) if "$" in text else text


EXAMPLES = {**{name: lambda name=name: tn.load(name) for name in tn.library_models()}, **MODELS}


class TestGroups:
    @pytest.mark.few(4, 14)
    @pytest.mark.parametrize("example", EXAMPLES)
    def test_each_part_has_its_group_and_texts_are_those_of_the_report(self, example):
        model = EXAMPLES[example]()
        drawing, root = examined(model)
        figure = plot.schematic(model, title="")
        assert shown(root) == sorted(plain(text) for text in texts(figure))
        inches = np.array(drawing.size) / 72
        scale = min(1.0, 24.0 / inches[1])  # pictures for print are no taller than 24 inches
        np.testing.assert_allclose(figure.get_size_inches(), inches * scale, rtol=1e-12)

    def test_an_element_is_drawn_in_its_own_group(self):
        model = tn.load("two_stroke_ship")
        drawing, root = examined(model)
        groups = {each.get("id"): each for each in root.iter(f"{SVG}g") if each.get("id")}
        crank = groups[drawing.elements["crank1"]]
        assert {"crank1", "kcrank = 910 MN·m/rad"} <= set(shown(crank))
        assert crank.find(f"{SVG}title").text.startswith("crank1, spring, cyl1 to cyl2: k_crank = 910 MN·m/rad")
        assert shown(groups[drawing.nodes["flywheel"]]) == ["flywheel"]
        # Each mass is one disc: the one filled shape of its group.
        for name in ("m1", "wheel", "screw"):
            filled = [
                each for each in groups[drawing.elements[name]].iter(f"{SVG}path") if "fill-body" in each.get("class")
            ]
            assert len(filled) == 1

    def test_parts_hidden_in_one_symbol_share_its_strokes_and_have_ids_of_their_own(self):
        drawing, root = examined(tn.load("planetary_set"))
        box = next(each for each in root.iter(f"{SVG}g") if each.get("id") == drawing.elements["sun_mesh_1"])
        inside = next(each for each in box.iter(f"{SVG}g") if each.get("id") == drawing.elements["ring_mesh_3"])
        assert inside.find(f"{SVG}path") is not None or any(True for _ in inside.iter(f"{SVG}path"))
        around = next(each for each in root.iter(f"{SVG}g") if each.get("id") == drawing.nodes["planet_2"])
        assert box in list(around.iter(f"{SVG}g"))

    def test_a_configuration_shows_its_own_elements(self):
        rig = tn.load("amt_rig")
        found = {name: set(schematic_svg(rig.configured(name)).elements) for name in rig.configurations}
        assert found == {name: set(rig.configured(name).elements) for name in rig.configurations}

    def test_a_page_too_narrow_is_refused(self):
        with pytest.raises(UsageError, match="at least 100 mm"):
            schematic_svg(tn.load("dmf_rig"), width=50)


def renamed(element, **entries):
    """A copy with entries that an element of this type refuses."""
    found = copy(element)
    for name, value in entries.items():
        object.__setattr__(found, name, value)
    return found


class TestHostileNames:
    """Models refuse such names; the drawing does not rely on it."""

    NAMES = (
        "<script>alert(1)</script>",
        '"><svg onload=x>',
        "a b",
        "a_20_b",
        "it's & that",
        "]]>",
        "日本",
        "x\u0001y",
        "1",
        "-",
    )

    @pytest.mark.parametrize("name", NAMES)
    def test_names_are_text_and_nothing_else(self, name):
        plain = tn.Drivetrain(
            name, [inertia("J", "a"), tn.Spring("k", nodes=("a", "b"), stiffness=3), inertia("J2", "b")]
        )
        elements = {
            "J": plain.elements["J"],
            name: renamed(plain.elements["k"], name=name, nodes=("a", f"{name} end")),
            "J2": renamed(plain.elements["J2"], node=f"{name} end"),
        }
        drawing = schematic_svg(plain.with_definition(replace(plain.definition, elements=elements)))
        root = ET.fromstring(drawing.svg)
        seen = name.replace("\u0001", "\ufffd")  # XML has no such character
        assert root.get("aria-label") == f"schematic of {seen}"
        written = "".join(joined(root)).replace(" ", "")
        assert seen.replace(" ", "") in written
        assert f"{seen}end".replace(" ", "") in written
        marked = {each.get("data-element") for each in root.iter(f"{SVG}g")} - {None}
        assert marked == {"J", seen, "J2"}
        ids = {*drawing.elements.values(), *drawing.nodes.values()}
        assert len(ids) == len(drawing.elements) + len(drawing.nodes)
        assert all(re.fullmatch(r"(element|node)-[A-Za-z0-9_.-]+", one) for one in ids)
        assert {each.tag.removeprefix(SVG) for each in root.iter()} <= {"svg", "g", "title", "path", "text", "tspan"}
        assert {attribute for each in root.iter() for attribute in each.attrib} <= ALLOWED

    def test_ids_differ_though_names_are_alike(self):
        taken = set()
        ids = [_id("element", name, taken) for name in ("a b", "a_20_b", "a b", "A B")]
        assert len(set(ids)) == 4


class TestWidths:
    TEXTS = (
        "shaft", "AVATAR To", "Ø 30 mm × 20 mm", "460 N·m/rad", "difficult fly offer", "$k_{\\mathrm{1}}$ = 460 N·m/rad",
        "$\\tau$ = −3/2 = −1.5", "$\\Omega_{\\mathrm{a}}$", "$J_{\\mathrm{WA\\_x}}$", "housing of a, b", "left.k = 9.2 kN·m/rad", "",
    )  # fmt: skip

    @pytest.mark.parametrize("role", ROLES)
    def test_widths_are_those_of_matplotlib(self, role):
        import matplotlib
        from matplotlib.textpath import text_to_path

        from torsionnet.plot.schematics.schematic import _font

        for text in self.TEXTS:
            if text and not (is_math(text, role) and role == "node"):
                expected, _, _ = text_to_path.get_text_width_height_descent(
                    text, _font(role, ROLES[role].size), is_math(text, role)
                )
                # Ligatures and pairs, too; where matplotlib rounds otherwise, by a hundredth of the size at most. Before
                # 3.11 it rounded each letter to pixels.
                room = 0.011 if matplotlib.__version_info__ >= (3, 11) else 0.25
                assert text_width(text, role) == pytest.approx(expected, abs=room * ROLES[role].size)

    def test_widths_are_known_units_of_the_font(self):
        from matplotlib.textpath import TextPath

        # The digits of DejaVu Sans are 1303 of 2048 units wide, those of its bold face 1425.
        for face, units in (("", 1303), ("italic", 1303), ("bold", 1425)):
            assert {font_widths(face).advances[font_widths(face).glyphs[ord(digit)]] for digit in "0123456789"} == {
                units
            }
        assert pytest.approx(TextPath((0, 0), "x", size=100).get_extents().y1) == X_HEIGHT
        assert symbols_width("$x$") == math.ceil(font_widths("italic").symbol_width("x"))
        assert font_widths("").width("AV") < font_widths("").width("A") + font_widths("").width("V")

    def test_matplotlib_is_not_loaded(self):
        code = (
            "import sys, torsionnet as tn\n"
            "from torsionnet.plot.schematics.svg_drawing import schematic_svg\n"
            "schematic_svg(tn.load('amt_rig'))\n"
            "sys.exit(any(name in sys.modules for name in ('matplotlib', 'sympy', 'scipy')))"
        )
        assert subprocess.run([sys.executable, "-c", code], check=False, timeout=PATIENCE).returncode == 0


def plain_search(cost, start, goal):
    """The cheapest way by Dijkstra's method over (column, row, heading), slow and simple."""
    begin = (*start, 0)
    best, came, queue = {begin: 0}, {}, [(0, begin)]
    while queue:
        spent, state = heappop(queue)
        if spent > best[state]:
            continue
        x, y, heading = state
        if (x, y) == goal and heading % 2 == 1:
            way = [(x, y)]
            while state in came:
                state = came[state]
                way.append(state[:2])
            return way[::-1]
        for turn, (dx, dy) in enumerate(((1, 0), (0, 1), (-1, 0), (0, -1))):
            there = x + dx, y + dy
            if (turn - heading) % 4 == 2 or not (0 <= there[0] < cost.shape[0] and 0 <= there[1] < cost.shape[1]):
                continue
            total = spent + int(cost[there]) + wiring.CORNER * (turn != heading)
            if cost[there] > 0 and total < best.get((*there, turn), 1 << 60):
                best[*there, turn], came[*there, turn] = total, state
                heappush(queue, (total, (*there, turn)))
    return None


@pytest.mark.parametrize("seed", range(4))
def test_wires_go_the_cheapest_way(seed):
    rng, found = random.Random(seed), 0
    for _ in range(40):
        columns, rows = rng.randint(3, 24), rng.randint(3, 24)
        cost = np.array([[rng.choice((1, 1, 1, 1, 1, 2, 12, -1)) for _ in range(rows)] for _ in range(columns)])
        start, goal = ((rng.randrange(columns), rng.randrange(rows)) for _ in range(2))
        cost[start] = cost[goal] = 1
        way = wiring._shortest(wiring.Grid(0.0, 0.0, cost), start, goal)
        assert way == plain_search(cost, start, goal)
        found += way is not None
    assert found > 20


def test_of_two_ways_around_a_wall_the_same_one_is_always_taken():
    """Above and below the wall it is as far to the gap behind it."""
    cost = np.ones((12, 11), dtype=int)
    cost[3, 2:9] = -1
    cost[6, :] = -1
    cost[6, 5] = 1
    way = wiring._shortest(wiring.Grid(0.0, 0.0, cost), (0, 5), (9, 7))
    assert way == plain_search(cost, (0, 5), (9, 7))
    mirrored = wiring._shortest(wiring.Grid(0.0, 0.0, cost), (0, 5), (9, 3))
    assert mirrored == plain_search(cost, (0, 5), (9, 3))
    assert (6, 5) in way


def test_what_is_drawn_alike_is_laid_out_once(monkeypatch):
    """Another stiffness takes the layout of before with titles of its own; sizes, symbols and names lay out anew."""
    laid_out = []
    monkeypatch.setattr(arrangement, "_arranged", lambda *given: laid_out.append(given) or ARRANGED(*given))
    rigs = [
        line(stiffness="4 kN*m/rad"),
        line(stiffness="5 kN*m/rad"),
        line(inertia="9 kg*m^2"),
        line(damping="3 N*m*s/rad"),
        line(name="last"),
    ]
    for rig, count in zip(rigs, (1, 1, 2, 3, 4), strict=True):
        _, root = examined(rig)
        assert len(laid_out) == count
        titles = [each.text for each in root.iter(f"{SVG}title")]
        assert any(text.endswith(f"k = {5 if rig is rigs[1] else 4} kN·m/rad") for text in titles) or rig is rigs[3]


def test_a_second_picture_has_each_word_once():
    rig = tn.load("amt_rig")
    first, second = ([text.get_text() for text in tn.plot.schematic(rig).axes[0].texts] for _ in range(2))
    assert second == first


def line(stiffness="4 kN*m/rad", inertia="2 kg*m^2", damping=None, name="end"):
    """So many discs that they are drawn without texts."""
    count = arrangement.MOST_NAMED_NODES + 1
    nodes = [*(f"n{k}" for k in range(count - 1)), name]
    loss = {} if damping is None else {"damping": damping}
    return tn.Drivetrain(
        "line",
        [
            *(tn.Inertia(f"disc{k}", node=node, inertia=1) for k, node in enumerate(nodes[:-1])),
            tn.Inertia("wheel", node=name, inertia=inertia),
            *(tn.Spring(f"shaft{k}", nodes=pair, stiffness="7 kN*m/rad") for k, pair in enumerate(pairwise(nodes[1:]))),
            tn.Spring("first", nodes=tuple(nodes[:2]), stiffness=stiffness, **loss),
        ],
    )
