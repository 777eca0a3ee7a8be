"""Schematics cut into parts: where a cut may stand, and that the parts together hold what the whole holds."""

import pytest

import torsionnet as tn
from torsionnet import plot
from torsionnet.plot.drawing.pieces import Piece
from torsionnet.plot.schematics.arrangement import arranged_drawing, page_width
from torsionnet.report import make_report
from torsionnet.report.document_tree import Paragraph
from torsionnet.report.sections.elements import LEGEND

MM = 25.4


def texts(figure):
    return [text.get_text() for text in figure.axes[0].texts]


def test_a_cut_meets_no_symbol_and_few_lines():
    from torsionnet.plot.schematics.schematic import cut_heights

    discs = [(0, 10, 0, 80), (0, 10, 120, 200)]
    lines = [(20, 23, 0, 200), (30, 33, 60, 108)]  # one goes through, another ends between the discs
    assert cut_heights(Piece(boxes=discs), (0, 40, 0, 200), 250) == []
    (cut,) = cut_heights(Piece(boxes=discs, wires=lines), (0, 40, 0, 200), 150)
    assert 108 <= cut <= 116  # above the end of the second line


def test_a_branch_that_fits_nowhere_begins_with_its_piece():
    from torsionnet.plot.schematics.line_routes import BranchWidth, RouteStep, piece_starts

    steps = [RouteStep(40, 0, 0, (BranchWidth(0, 300),) if place == 3 else ()) for place in range(7)]
    assert piece_starts(0.0, steps, 200, 0) == [0, 3]


def test_a_level_line_is_not_cut():
    from torsionnet.plot.schematics.schematic import cut_heights

    drawing = Piece(boxes=[(0, 10, 0, 80), (0, 10, 120, 200)])
    drawing.line((0, 100), (40, 100))
    (cut,) = cut_heights(drawing, (0, 40, 0, 200), 150)
    assert abs(cut - 100) > 3


def test_no_place_for_a_cut_leaves_the_drawing_whole():
    from torsionnet.plot.schematics.schematic import cut_heights

    assert cut_heights(Piece(boxes=[(0, 10, 0, 400)]), (0, 10, 0, 400), 150) == []


def test_a_page_is_as_wide_as_its_smallest_text_prints_at_six_points():
    """127 mm are 360 points, in which text of 7 points prints at 6 where they are 420, 10 on each side for the margin."""
    assert page_width(127) == pytest.approx(400)


def test_names_of_ports_stand_ten_points_below_the_shaft():
    """That is through the middle of the box, which is 70 points high, unlike all else in the drawing."""
    elements = [tn.Inertia(f"j_{node}", node=node, inertia=1) for node in "src"]
    rig = tn.Drivetrain("p", [*elements, tn.Planetary("set", sun="s", ring="r", carrier="c", ratio=3)])
    drawing = arranged_drawing(rig, page_width(170))
    (shaft,) = {(low + high) / 2 for _, _, low, high in drawing.boxes if high - low == pytest.approx(70)}
    for label in drawing.labels:
        if label.text in ("sun", "ring"):
            (bottom,) = (
                low for x0, x1, low, high in drawing.boxes if x0 < label.x < x1 and low < label.y < high < low + 20
            )
            assert bottom == pytest.approx(shaft - 10)


def test_the_line_of_a_sensor_keeps_four_points_free_on_either_side():
    """Below the disc, 16 points wide, of an inertia on whose node a damper to ground is measured."""
    elements = [tn.Inertia("j", node="a", inertia=1), tn.Damper("d", nodes=("a", "ground"), damping=1)]
    elements += [tn.Spring(f"k_{node}", nodes=("a", node), stiffness=1) for node in "bc"]
    rig = tn.Drivetrain("p", elements, sensors={"T": {"torque": "d", "at": "a"}})
    boxes = arranged_drawing(rig, page_width(170)).boxes
    ((x0, x1, low, _),) = (box for box in boxes if box[1] - box[0] == pytest.approx(16))
    assert [box[:2] for box in boxes if box[3] == low] == [pytest.approx((x0 + 4, x1 - 4))]


def test_parts_hold_every_text_once_and_are_legible():
    from torsionnet.plot.schematics.schematic import schematic_parts

    rig = tn.load("wind_turbine_3mw").configured("free")
    parts = schematic_parts(rig, 135)
    assert len(parts) > 1
    assert sorted(text for one in parts for text in texts(one)) == sorted(texts(plot.schematic(rig, title="")))
    for one in parts:
        width, height = MM * one.get_size_inches()
        assert height * min(1, 170 / width) <= 235
        assert min(text.get_size() for text in one.axes[0].texts) * min(1, 170 / width) >= 6


def test_parts_are_counted_in_their_captions():
    """Signs are explained once, before the first part; a drawing that fits the page is no part."""
    captions = {}
    for model, more in (("wind_turbine_3mw", {"configurations": ["free"]}), ("dmf_rig", {})):
        signs, *pictures = make_report(model, sections=["schematic"], date=None, **more).sections[0].blocks
        assert signs == Paragraph((LEGEND,))
        captions[model] = [picture.caption for picture in pictures]
    parts = captions["wind_turbine_3mw"]
    assert parts == [(f"The drivetrain, part {n} of {len(parts)}.",) for n in range(1, len(parts) + 1)]
    assert captions["dmf_rig"] == [("The drivetrain.",)]
    assert len(parts) > 1
