"""Schematics: whatever the element types, something right is drawn; a torque stands beside what carries it."""

import itertools

import numpy as np
import pytest
from support.campaigns import examples
from support.drawn_models import MODELS, inertia
from support.made_up_elements import GLYPHS, SHAPES, Absorber, Maxwell, OnePort, Zener, with_glyph
from support.models import EVERY_ELEMENT
from support.pictures import EXAMPLES, SOME_EXAMPLES, collisions, crossed, drawable, drawn, is_round, outside, texts

import torsionnet as tn
from torsionnet import plot
from torsionnet.plot.drawing.labels import symbol
from torsionnet.plot.schematics.outlines import BODY
from torsionnet.plot.schematics.symbols import inline_glyph


@pytest.mark.parametrize("kind", EVERY_ELEMENT)
def test_symbols_fill_the_room_that_is_kept_for_them(kind):
    """From end to end of the line, and as far up or down as their half width says; the marks of chains reach less far."""
    glyph = inline_glyph(EVERY_ELEMENT[kind], {})
    x, y = np.array([point for stroke in glyph.strokes for point in stroke.points]).T
    assert (x.min(), x.max()) == (0, pytest.approx(glyph.length))
    assert {0.0, glyph.length} <= set(x[y == 0])
    least, most = (-7, 1) if EVERY_ELEMENT[kind].glyph in ("spring", "damper") else (-2, 0)
    assert least <= np.abs(y).max() - glyph.half_width <= most


def between(*elements, **more):
    """The elements with an inertia on each of their nodes."""
    ports = [node for element in elements for node in element.ports.values() if node != "ground"]
    return tn.Drivetrain("made up", [*elements, *(inertia(f"J_{node}", node) for node in dict.fromkeys(ports))], **more)


def strokes(figure):
    return [patch.get_path().vertices for patch in figure.axes[0].patches]


def middle(patch):
    box = patch.get_path().get_extents()
    return np.array([(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2])


def is_symbol(patch):
    """Black, and neither a straight line nor a dot."""
    import matplotlib as mpl

    from torsionnet.plot.drawing import style

    box = patch.get_path().get_extents()
    return patch.get_edgecolor() == mpl.colors.to_rgba(style.INK) and 4.9 <= min(box.width, box.height) < 80


GLYPHS_AND_SHAPES = [
    pytest.param(glyph, shape, marks=[pytest.mark.nightly] * ((row + column) % 4 > 0))
    for (row, glyph), (column, shape) in itertools.product(enumerate(GLYPHS), enumerate(SHAPES))
]
"""Every glyph with every shape of ports; each of them a few times by day."""


class TestMadeUpElements:
    @pytest.mark.few(2, 20)
    @pytest.mark.parametrize(("glyph", "shape"), GLYPHS_AND_SHAPES)
    def test_any_glyph_with_any_ports_is_drawn_with_its_name(self, glyph, shape):
        element = SHAPES[shape](glyph)
        ports = dict.fromkeys(node for node in element.ports.values() if node != "ground")
        sensors = {f"T_{port}": {"torque": "made", "at": port} for port in element.ports}
        model = between(element, inputs={"T": {"torque": "a"}}, sensors=sensors if len(ports) > 1 else {})
        figure = drawable(plot.schematic(model))
        shown = texts(figure)
        assert "made" in shown
        assert {*ports, *(symbol(name) for name in model.sensors)} <= set(shown)
        assert collisions(figure) == crossed(figure) == outside(figure) == []
        # Each inertia is one symbol; what else stands near the name is the element.
        x, y = next(text.get_position() for text in figure.axes[0].texts if text.get_text() == "made")
        discs = [text.get_position() for text in figure.axes[0].texts if text.get_text().startswith("J_")]
        near = sum(np.abs(np.subtract(place, [x, y])).max() < 70 for place in discs)
        assert (
            sum(is_symbol(patch) and np.abs(middle(patch) - [x, y]).max() < 70 for patch in figure.axes[0].patches)
            > near
        )

    def test_a_disc_is_a_disc_as_high_as_its_inertia(self):
        import matplotlib as mpl

        from torsionnet.plot.drawing import style

        rotor = with_glyph(OnePort, "disc")
        figure = plot.schematic(tn.Drivetrain("r", [rotor("small", "a", 1), rotor("large", "a", 100)]))
        boxes = [patch.get_path().get_extents() for patch in figure.axes[0].patches if patch.get_fill()]
        low, high = sorted(box.height for box in boxes if box.width == pytest.approx(13))
        assert 20 < low < high
        assert mpl.colors.to_hex(figure.axes[0].patches[0].get_facecolor()) in (BODY, style.PAPER)

    @pytest.mark.parametrize(
        ("element", "side_by_side"),
        [
            (tn.Spring("e", nodes=("a", "b"), stiffness=300, damping=4), True),
            (tn.Spring("e", nodes=("a", "b"), stiffness=300, damping={"zeta": 0.1, "at": "2 Hz"}), True),
            (Maxwell("e", nodes=("a", "b")), False),
            (Maxwell("e", nodes=("a", "ground")), False),
        ],
    )
    def test_a_dashpot_stands_where_the_law_has_it(self, element, side_by_side):
        found = strokes(plot.schematic(between(element)))
        (spring,) = (points for points in found if len(points) == 12)
        (pot,) = (points for points in found if len(points) == 4 and is_cup(points))
        overlap = min(spring[:, 0].max(), pot[:, 0].max()) - max(spring[:, 0].min(), pot[:, 0].min())
        assert (overlap > 0) == side_by_side

    @pytest.mark.parametrize("glyph", ["spring", "damper"])
    @pytest.mark.parametrize(("cls", "stands_on_ground"), [(OnePort, True), (Absorber, False)])
    def test_what_is_on_one_node_ends_where_its_laws_do(self, cls, stands_on_ground, glyph):
        """Four short slanted lines are the ground; a mass of its own is one filled rectangle more."""
        import matplotlib as mpl

        lone, found = tn.Drivetrain("lone", [inertia("J", "a")]), {}
        for name, model in {"lone": lone, "made": between(with_glyph(cls, glyph)("e", node="a"))}.items():
            patches = plot.schematic(model).axes[0].patches
            lines = [patch.get_path().vertices for patch in patches if not patch.get_fill()]
            slanted = [points for points in lines if len(points) == 2 and (np.ptp(points, axis=0) > 1).all()]
            filled = [patch for patch in patches if mpl.colors.to_hex(patch.get_facecolor()) == BODY]
            found[name] = np.array([len(slanted), len(filled)])
        hatches, masses = found["made"] - found["lone"]
        assert (hatches >= 4, masses) == (stands_on_ground, not stands_on_ground)

    def test_a_spring_beside_a_series_of_two(self):
        found = strokes(plot.schematic(between(Zener("e", nodes=("a", "b")))))
        upper, lower = sorted((points for points in found if len(points) == 12), key=lambda points: -points[0, 1])
        (pot,) = (points for points in found if len(points) == 4 and is_cup(points))
        assert upper[:, 1].min() > lower[:, 1].max()
        assert np.ptp(upper[:, 0]) > 1.9 * np.ptp(lower[:, 0])
        assert pot[:, 0].min() > lower[-2, 0]

    def test_a_spring_without_damping_has_no_dashpot(self):
        found = strokes(plot.schematic(between(tn.Spring("e", nodes=("a", "b"), stiffness=300))))
        assert not any(is_cup(points) for points in found if len(points) == 4)


def is_cup(points):
    """Three sides of a rectangle, whichever way it opens."""
    sides = np.abs(np.diff(points, axis=0))
    return np.isclose(sides, 0).any(axis=1).all() and np.isclose(sides[0], sides[2]).all() and sides[0].max() > 5


class TestRatios:
    @pytest.mark.parametrize(("ratio", "text"), [("-tau", "−$\\tau$ = −4.94"), ("-i", "$\\tau$ = −$i$ = −4.94")])
    def test_a_ratio_is_not_said_to_be_its_own_negative(self, ratio, text):
        model = between(tn.Gear("g", nodes=("a", "b"), ratio=ratio), parameters={ratio[1:]: 4.94})
        assert [shown for shown in texts(plot.schematic(model)) if "4.94" in shown] == [text]


def mark_of(figure, name):
    """Where the diamond of a sensor is: on the shaft below its name, or beside it."""
    text = next(text for text in figure.axes[0].texts if text.get_text() == symbol(name))
    x, y = text.get_position()
    what = next(other.get_text() for other in figure.axes[0].texts if 0 < y - other.get_position()[1] < 14
                and abs(other.get_position()[0] - x) < 1)  # fmt: skip
    edges = [patch.get_path().get_extents() for patch in figure.axes[0].patches if is_diamond(patch)]
    places = [((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2) for box in edges]
    return what, min(places, key=lambda place: abs(place[0] - x) + abs(place[1] - y))


def is_diamond(patch):
    box = patch.get_path().get_extents()
    return patch.get_fill() and box.width == pytest.approx(9) and box.height == pytest.approx(9)


def things_on_the_line(figure, y):
    """x of junctions, discs and wheels that a line at this height runs through."""
    places = []
    for patch in figure.axes[0].patches:
        box = patch.get_path().get_extents()
        junction = is_round(patch) and box.width < 6
        solid = patch.get_fill() and box.height > 20 and 10 < box.width < 16
        if (junction or solid) and box.y0 < y < box.y1:
            places.append((box.x0 + box.x1) / 2)
    return places


def tapped():
    """A hub with branches, parallel shafts, a gear that is not alone, a loop and an element to ground, all measured."""
    names = ("shaft", "branch", "p1", "p2", "g1", "g2", "loop", "bearing", "end")
    return tn.Drivetrain(
        "measured everywhere",
        [
            inertia("engine", "e"),
            tn.Spring("shaft", nodes=("e", "hub"), stiffness=10),
            inertia("disc", "hub"),
            tn.Damper("bearing", nodes=("hub", "ground"), damping=1),
            tn.Spring("branch", nodes=("hub", "x"), stiffness=20),
            inertia("pump", "x"),
            tn.Spring("p1", nodes=("hub", "y"), stiffness=30),
            tn.Spring("p2", nodes=("hub", "y"), stiffness=40),
            inertia("wheel", "y"),
            tn.Gear("g1", nodes=("y", "z"), ratio=2),
            tn.Gear("g2", nodes=("y", "w"), ratio=3),
            inertia("load", "z"),
            inertia("fan", "w"),
            tn.Spring("loop", nodes=("z", "w"), stiffness=3),
            tn.Spring("end", nodes=("w", "ground"), stiffness=3),
        ],
        sensors={f"T_{number}": {"torque": name} for number, name in enumerate(names)}
        | {"T_at_x": {"torque": "branch", "at": "x"}, "T_at_z": {"torque": "g1", "at": "z"}},
    )


class TestTorquesStandBesideTheirElement:
    @pytest.mark.slow
    def test_flags_of_a_hub(self):
        figure = drawable(plot.schematic(tapped()))
        assert collisions(figure) == crossed(figure) == []
        said = {name: mark_of(figure, name)[0] for name in tapped().sensors}
        assert {said[name] for name in ("T_0", "T_1", "T_6", "T_7", "T_8", "T_at_x", "T_at_z")} == {"torque"}
        assert (said["T_2"], said["T_3"]) == ("torque of p1", "torque of p2")
        assert (said["T_4"], said["T_5"]) == ("torque of g1", "torque")

    @pytest.mark.slow
    def test_before_the_branches_nothing_claims_to_be_the_torque_behind_them(self):
        checked = 0
        names = examples(SOME_EXAMPLES, EXAMPLES)
        for example in (*(name for name in names if name not in MODELS), "hybrid", "crowded", "moving housing"):
            checked += self.check(EXAMPLES[example](), drawn(example))
        assert self.check(tapped(), drawable(plot.schematic(tapped()))) > 0
        assert checked > 10

    @staticmethod
    def check(model, figure):
        checked = 0
        for name, sensor in model.sensors.items():
            if sensor.quantity not in ("torque", "twist") or symbol(name) not in texts(figure):
                continue
            what, (x, y) = mark_of(figure, name)
            labels = [text.get_position() for text in figure.axes[0].texts if text.get_text() == sensor.of]
            near = [place for place in labels if abs(place[1] - y) < 60]
            if what != sensor.quantity or not near or isinstance(model.elements[sensor.of], tn.Gear):
                continue
            low, high = sorted((x, near[0][0]))
            assert not [place for place in things_on_the_line(figure, y) if low + 1 < place < high - 1], name
            checked += 1
        return checked
