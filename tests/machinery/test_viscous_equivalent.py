"""Springs and dampers in the place of laws over frequency: equal where they are made to be, and in files."""

import numpy as np
import pytest
from click.testing import CliRunner
from support.modelica_reader import Model as ModelicaModel

import torsionnet as tn
from torsionnet.app.cli.app import app
from torsionnet.base.errors import UsageError
from torsionnet.io import to_modelica
from torsionnet.machinery.design.damper_design import viscous_equivalent

F = [2.0, 11.0, 40.0]
TABLE = [[1, 900, 6], [20, 1500, 3], [60, 2000, 1]]


def rig(referred_to=None):
    return tn.Drivetrain(
        "rig",
        [
            tn.Inertia("J_a", node="a", inertia=0.3),
            tn.HystereticSpring("rubber", nodes=("a", "b"), stiffness="k", loss_factor="eta", damping=0.5, referred_to=referred_to),
            tn.Gear("gear", nodes=("b", "c"), ratio=2),
            tn.Inertia("J_c", node="c", inertia=0.7),
            tn.TabulatedSpring("air", nodes=("c", "d"), table=TABLE),
            tn.Inertia("J_d", node="d", inertia=1.1),
        ],
        parameters={"k": 1200.0, "eta": 0.2},
        inputs={"T": {"torque": "a"}},
        sensors={"out": {"angle": "d"}, "T_r": {"torque": "rubber"}},
    )  # fmt: skip


@pytest.mark.parametrize("referred_to", [None, "c"])
@pytest.mark.parametrize("place", range(len(F)))
def test_equal_at_its_frequency_and_nowhere_else(place, referred_to):
    model = rig(referred_to)
    equivalent = viscous_equivalent(model, F[place])
    found, expected = (one.frequency_response(["out", "T_r"], "T", F).values for one in (equivalent, model))
    relative = np.abs(found / expected - 1).max(axis=(1, 2))
    assert relative[place] < 1e-11
    assert all(relative[other] > 1e-3 for other in range(len(F)) if other != place)
    assert not equivalent.assembly.system.dynamic
    assert model.assembly.system.dynamic  # the model itself is left alone


def test_coefficients_by_hand():
    """c = k eta/(2 pi f) beside what is given; the table read at 11 Hz, between its rows."""
    system = viscous_equivalent(rig(), 11.0).assembly.system
    assert sorted(system.damping[system.damping != 0]) == pytest.approx(
        sorted([0.5 + 1200 * 0.2 / (2 * np.pi * 11), np.interp(11, [1, 20], [6, 3])])
    )
    assert np.interp(11, [1, 20], [900, 1500]) in system.stiffness.tolist()


def test_parameters_stay_open_in_modelica():
    """Changed there, they do what they would have done here."""
    text = to_modelica(viscous_equivalent(rig(), 11.0))
    assert "parameter Real eta" in text
    changed = viscous_equivalent(rig().configured(k=800, eta=0.4), 11.0)
    read = ModelicaModel(text, k=800, eta=0.4)
    found = np.array([read.responses(2j * np.pi * f) for f in F])
    np.testing.assert_allclose(found, changed.frequency_response(["out", "T_r"], "T", F).values, rtol=1e-9)


@pytest.mark.parametrize("ending", ["m", "mo", "csv"])
def test_a_file_that_could_not_be_written_before(ending, tmp_path):
    model = tmp_path / "rig.yaml"
    model.write_text(rig().to_yaml(), encoding="utf-8")
    target = tmp_path / f"rig.{ending}"
    command = ["export", str(model), "-o", str(target)]
    refused = CliRunner().invoke(app, command)
    assert refused.exit_code != 0
    assert "; --viscous-at HZ " in refused.output
    assert not target.exists()
    written = CliRunner().invoke(app, [*command, "--viscous-at", "11"])
    assert written.exit_code == 0, written.output
    assert target.exists()
    assert "with their values at 11 Hz" in written.output


@pytest.mark.parametrize("frequency", [0.0, -1.0, float("nan"), float("inf")])
def test_no_frequency(frequency):
    with pytest.raises(UsageError, match="above 0 Hz"):
        viscous_equivalent(rig(), frequency)


def test_a_shaft_beyond_its_first_resonance_is_no_spring():
    shaft = tn.ContinuousShaft("s", nodes=("a", "b"), outer_diameter=0.05, length=20.0)
    model = tn.Drivetrain("long", [tn.Inertia("J", node="a", inertia=1), shaft, tn.Inertia("J_b", node="b", inertia=1)])
    with pytest.raises(UsageError, match=r"(?s)155.*\-35235\.6.*not-applicable"):
        viscous_equivalent(model, 155.0)
