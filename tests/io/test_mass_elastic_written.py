"""Mass-elastic sheets written of models, real and referred, read back; and the commands that do it."""

import warnings

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.app.cli import main
from torsionnet.base.errors import TorsionnetWarning, UsageError
from torsionnet.io import read_mass_elastic, write_mass_elastic
from torsionnet.io.mass_elastic_files import to_mass_elastic

WHOLE = {
    "amt_rig": "gear=V",
    "direct_drive_wind_turbine": "damped",
    "dmf_rig": None,
    "engine_generator_set": "firing=normal,rubber=warm",
    "geared_branch": None,
    "marine_steam_turbine": "damped",
    "oil_engine": None,
    "six_cylinder_diesel": "viscous_and_hysteretic",
    "turbine_generator_ssr": None,
    "two_stroke_ship": "normal",
}


def rig(name):
    configuration = WHOLE[name]
    return tn.load(name) if configuration is None else tn.load(name).configured(configuration)


def poles(drivetrain):
    return np.sort_complex(drivetrain.modes().eigenvalues)


@pytest.mark.parametrize("name", WHOLE)
@pytest.mark.parametrize("referred", [False, True])
def test_modes_come_back(tmp_path, name, referred):
    model = rig(name)
    write_mass_elastic(model, tmp_path / "x.csv", referred_to=model.nodes[-1] if referred else None)
    back, there = poles(read_mass_elastic(tmp_path / "x.csv")), poles(model)
    np.testing.assert_allclose(back, there, rtol=1e-12, atol=1e-12 * np.abs(there).max())


def test_referred_values_are_scaled_by_the_square_of_the_ratio():
    """J n^2 and k n^2 on a shaft of speed ratio n = 1/4: by hand."""
    elements = [
        tn.Inertia("a", node="a", inertia=2),
        tn.Gear("stage", nodes=("a", "b"), ratio=4),
        tn.Spring("shaft", nodes=("b", "c"), stiffness=800, damping=32),
        tn.Inertia("c", node="c", inertia=64),
    ]
    text = to_mass_elastic(tn.Drivetrain("x", elements), referred_to="a")
    rows = {line.split(",")[0]: line.split(",") for line in text.splitlines() if not line.startswith("#")}
    heading = text.splitlines()[2].split(",")
    at = {name.partition(" ")[0]: place for place, name in enumerate(heading)}
    assert rows["c"][at["J"]] == "4.0"
    assert rows["c"][heading.index("speed ratio")] == "0.25"
    assert (rows["b"][at["k"]], rows["b"][at["relative"]]) == ("50.0", "2.0")
    assert "values are referred to a" in text.splitlines()[1]


def test_loops_springs_to_ground_and_parallel_ones(tmp_path):
    elements = [tn.Inertia(f"J_{node}", node=node, inertia=1 + place) for place, node in enumerate("abc")]
    elements += [
        tn.Spring("first", nodes=("a", "b"), stiffness=100),
        tn.HystereticSpring("beside", nodes=("b", "a"), stiffness=50, loss_factor=0.1),
        tn.Spring("second", nodes=("b", "c"), stiffness=200),
        tn.Spring("closing", nodes=("c", "a"), stiffness=70),
        tn.Damper("friction", nodes=("c", "b"), damping=3),
        tn.Spring("mount", nodes=("c", "ground"), stiffness=30, damping=1),
    ]
    model = tn.Drivetrain("net", elements)
    write_mass_elastic(model, tmp_path / "x.csv")
    np.testing.assert_allclose(poles(read_mass_elastic(tmp_path / "x.csv")), poles(model), rtol=1e-12)


def test_what_a_sheet_has_no_column_for():
    with pytest.raises(UsageError, match="no column for"):
        to_mass_elastic(tn.load("planetary_set"))
    with pytest.raises(UsageError, match=r'(?s)did you mean "engine".*unknown-node'):
        to_mass_elastic(tn.load("oil_engine"), referred_to="enigne")


def test_a_shaft_with_consistent_inertia_is_lumped_with_a_warning(tmp_path):
    shaft = tn.Shaft("pipe", nodes=("a", "b"), outer_diameter="70 mm", length=2, segments=2)
    ends = [tn.Inertia("J", node="a", inertia=3), tn.Inertia("I", node="b", inertia=1)]
    with pytest.warns(TorsionnetWarning, match="pipe is lumped"):
        write_mass_elastic(tn.Drivetrain("x", [*ends, shaft]), tmp_path / "x.csv")
    lumped = tn.Shaft("pipe", nodes=("a", "b"), outer_diameter="70 mm", length=2, segments=2, inertia="lumped")
    there = poles(tn.Drivetrain("x", [*ends, lumped]))
    np.testing.assert_allclose(poles(read_mass_elastic(tmp_path / "x.csv")), there, rtol=1e-12, atol=1e-8)


def test_one_command_makes_a_running_model(tmp_path, capsys):
    sheet, model = tmp_path / "engine.csv", tmp_path / "engine.yaml"
    sheet.write_text("mass;J [kg m²];k [MNm/rad];Remark\nCyl. 1;0,45;2,1;x\nFlywheel;14;;\n", encoding="utf-8")
    assert main(["import", str(sheet), "-o", str(model)]) == 0
    said = capsys.readouterr().err
    assert '"J [kg m²]": inertia [kg m²]' in said
    assert '"Remark" was not understood' in said
    assert main(["modes", str(model), "--json"]) == 0
    expected = np.sqrt(2.1e6 * (1 / 0.45 + 1 / 14)) / (2 * np.pi)
    assert f"{expected:.6f}"[:8] in capsys.readouterr().out


def test_export_writes_sheets(tmp_path, capsys):
    target = tmp_path / "x.csv"
    assert main(["export", "geared_branch", "-o", str(target), "--referred-to", "motor"]) == 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        there = poles(tn.load("geared_branch"))
    np.testing.assert_allclose(poles(read_mass_elastic(target)), there, rtol=1e-12, atol=1e-9)
    assert main(["export", "geared_branch", "-o", str(tmp_path / "x.m"), "--referred-to", "motor"]) == 2
    assert "[needless-entry]" in capsys.readouterr().err


def test_a_controller_is_no_rigid_connection_to_ground(tmp_path):
    masses = [tn.Inertia("J", node="a", inertia=3), tn.Inertia("I", node="b", inertia=1)]
    governor = tn.Controller("governor", sense={"velocity": "b"}, act="a", law=-4)
    rig = tn.Drivetrain("x", [*masses, tn.Spring("k", nodes=("a", "b"), stiffness=100), governor])
    with pytest.raises(UsageError, match="no-counterpart"):
        write_mass_elastic(rig, tmp_path / "x.csv")
