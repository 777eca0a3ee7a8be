"""Modes as a result: words, energies, tables, warnings."""

import json

import numpy as np
import pytest
from support.models import geared_line

import torsionnet as tn
from torsionnet.solve.modes.eigen import undamped_modes


def test_energy_shares_by_hand():
    """Two equal inertias on a spring: each has half the kinetic energy, the spring all of the strain."""
    model = tn.Drivetrain(
        "two",
        [
            tn.Inertia("a", node="a", inertia=2),
            tn.Spring("k", nodes=("a", "b"), stiffness=8, damping=0.1),
            tn.Inertia("b", node="b", inertia=2),
        ],
    )
    shares = model.modes().energy_shares(1)
    assert shares["a"] == pytest.approx((0.5, 0, 0))
    assert shares["k"] == pytest.approx((0, 1, 1))


def test_words_about_modes():
    rigid, first, second = (
        tn.Drivetrain(
            "three",
            [
                *(tn.Inertia(f"j{n}", node=n, inertia=1) for n in "abc"),
                tn.Spring("left", nodes=("a", "b"), stiffness=100),
                tn.Spring("right", nodes=("b", "c"), stiffness=100),
            ],
        )
        .modes()
        .descriptions
    )
    assert rigid == "rigid-body rotation"
    assert first == "strain in left 50 %, right 50 %; 1 node of vibration at b"
    assert second == "strain in left 50 %, right 50 %; 2 nodes of vibration in left, in right"


def test_nodes_of_vibration_are_counted_over_the_gears():
    """The n-th elastic mode of a tree has n nodes; two branches of two gear stages each meet at the bull gear."""
    described = tn.load("marine_steam_turbine").modes().descriptions[2:]
    counts = [int(text.split("; ")[1].split()[0]) for text in described]
    assert counts == [1, 2, 3, 4, 5]
    assert not any("node of vibration" in text for text in tn.load("planetary_set").modes().descriptions)


def test_overdamped_mode_has_ratio_one_and_a_time_constant():
    modes = tn.load("amt_rig").configured("V", c_O=360).modes()
    assert modes.kinds == ("oscillatory", "real pole", "real pole")
    assert modes.damping_ratios[1:].tolist() == [1, 1]
    assert "time constant 0.0222 s" in modes.descriptions[1]


def test_rigid_body_has_no_damping_ratio():
    modes = geared_line().switched(off=["brake", "stiff"]).modes()
    assert modes.kinds[0] == "rigid body"
    assert (modes.natural_frequencies[0], np.isnan(modes.damping_ratios[0])) == (0, True)


def test_every_form_of_the_table_holds_the_same_numbers(tmp_path):
    modes = tn.load("dmf_rig").modes()
    modes.to_csv(tmp_path / "modes.csv")
    lines = [line for line in (tmp_path / "modes.csv").read_text().splitlines() if not line.startswith("#")]
    assert float(lines[1].split(",")[1]) == modes.natural_frequencies[0]
    data = json.loads(modes.to_json())
    assert data["rows"][0][1] == modes.natural_frequencies[0]
    assert data["columns"][1]["unit"] == "Hz"
    assert "7.10526" in modes.table().to_text()
    assert "<td>7.10526</td>" in modes._repr_html_()
    assert repr(modes) == "<Modes: 2 modes at 7.105, 80.98 Hz>"


def test_conventions_change_what_is_shown():
    modes = tn.load("dmf_rig").modes()
    table = modes.table(tn.Conventions(frequency="cpm"))
    assert table.columns[1].unit == "cpm"
    assert table.rows[0][1] == pytest.approx(60 * modes.natural_frequencies[0])


def test_shapes_cover_eliminated_nodes():
    modes = geared_line().modes()
    np.testing.assert_allclose(modes.shape_at("o"), modes.shape_at("g") / 3, rtol=1e-13)
    np.testing.assert_allclose(modes.shape_at("p"), modes.shape_at("m"), rtol=1e-13)
    assert np.abs(modes.shapes).max(axis=0) == pytest.approx(1)
    with pytest.raises(tn.UsageError, match="no node"):
        modes.shape_at("M")


@pytest.mark.parametrize(("low", "high", "settles"), [(30, 60, True), (60, 30, False)])
def test_law_without_fixed_point_is_reported(low, high, settles):
    """Where a stiffness drops just above the frequency it would give, the mode runs from its own table."""
    table = [[0.1, low, 0], [1.0, low, 0], [1.000001, high, 0], [9, high, 0]]
    bush = tn.TabulatedSpring("k", nodes=("a", "ground"), table=table)
    model = tn.Drivetrain("t", [tn.Inertia("j", node="a", inertia=1), bush])
    if settles:
        assert model.modes().converged.all()
    else:
        with pytest.warns(tn.TorsionnetWarning, match="did not settle for the mode"):
            assert not model.modes().converged[0]


def test_a_table_that_feeds_energy_makes_an_unstable_mode():
    """lambda^2 + c lambda + k = 0 with c = -1 frozen at the mode's own frequency."""
    bush = tn.TabulatedSpring("b", nodes=("a", "ground"), table=[[0, 100, -1.0], [50, 100, -1.0]])
    modes = tn.Drivetrain("t", [tn.Inertia("j", node="a", inertia=1), bush]).modes()
    assert modes.eigenvalues[0].real == pytest.approx(0.5, rel=1e-2)
    assert modes.damping_ratios[0] == pytest.approx(-0.05, rel=1e-2)
    assert modes.descriptions[0].startswith("unstable, it grows")


def test_warnings_point_at_the_line_of_the_user():
    free = geared_line().switched(off=["brake", "stiff"])
    with pytest.warns(tn.TorsionnetWarning) as caught:
        free.frequency_response("angle", "T_M", [0.0])
    assert caught[0].filename == __file__


def test_without_damping_the_natural_frequencies_are_the_undamped_ones():
    elements = [
        tn.Inertia("a", node="a", inertia=1),
        tn.Spring("ab", nodes=("a", "b"), stiffness=3e3),
        tn.Spring("bc", nodes=("b", "c"), stiffness=1e3),  # b has no inertia
        tn.Inertia("c", node="c", inertia=2),
        tn.Gear("cd", nodes=("c", "d"), ratio=-3),
        tn.Inertia("d", node="d", inertia=0.2),
    ]
    modes = tn.Drivetrain("free", elements).modes()
    expected = undamped_modes(tn.Drivetrain("free", elements).assembly.system)[0] / (2 * np.pi)
    assert modes.undamped_natural_frequencies == pytest.approx(expected, rel=1e-14, abs=0)
    assert len(expected) == 2
