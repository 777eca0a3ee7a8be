"""Figures of the package: shown by notebooks, drawn into axes that a user gives."""

import pytest

import torsionnet as tn
from torsionnet import plot


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5])
def test_nodes_are_named_below_the_lowest_panel_of_each_column(count):
    figure = plot.mode_shapes(tn.load("six_cylinder_diesel").modes(), mode=range(1, count + 1))
    named = [
        axes.get_subplotspec().get_position(figure)
        for axes in figure.axes
        if axes.xaxis.get_tick_params()["labelbottom"]
    ]
    lowest = {}
    for axes in figure.axes:
        if axes.get_visible():
            place = axes.get_subplotspec().get_position(figure)
            lowest[place.x0] = min(lowest.get(place.x0, 1.0), place.y0)
    assert {(place.x0, place.y0) for place in named} >= {*lowest.items()}


def test_a_figure_shows_itself_in_a_notebook():
    rig = tn.load("dmf_rig")
    for figure in (plot.bode(rig.frequency_response("theta_1", "T_T", [1, 2, 5])), plot.schematic(rig)):
        assert figure._repr_png_()[:8] == b"\x89PNG\r\n\x1a\n"
