"""Figures of the package: shown by notebooks, drawn into axes that a user gives."""

import torsionnet as tn
from torsionnet import plot


def test_a_figure_shows_itself_in_a_notebook():
    rig = tn.load("dmf_rig")
    for figure in (plot.bode(rig.frequency_response("theta_1", "T_T", [1, 2, 5])), plot.schematic(rig)):
        assert figure._repr_png_()[:8] == b"\x89PNG\r\n\x1a\n"
