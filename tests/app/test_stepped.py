"""Stepped sines at several amplitudes on the command line, alone and over a model."""

import json

import numpy as np
import pytest
from support.command_line import runner

from torsionnet.app.cli.app import app
from torsionnet.signals import Recording, Signal, write_recording

MODEL = """torsionnet: 1
elements:
  J: {type: inertia, node: a, inertia: 0.05}
  shaft: {type: spring, nodes: [a, ground], stages: [{stiffness: 460, to: 0.12 rad}, {stiffness: 1500}], damping: 0.5}
  soft: {type: spring, nodes: [a, ground], stiffness: 1e-6}
sensors: {T: {torque: shaft}, gamma: {twist: shaft}, phi: {angle: a}, other: {twist: soft}}
"""


@pytest.fixture
def files(tmp_path):
    t = np.arange(0, 20, 1 / 500)
    twist = np.where(t < 10, 0.05, 0.2) * np.sin(2 * np.pi * 4 * t)
    torque = 460 * twist + 1040 * np.sign(twist) * np.maximum(np.abs(twist) - 0.12, 0)
    torque += 0.5 * np.gradient(twist, 1 / 500)
    record, model = tmp_path / "steps.npz", tmp_path / "rig.yaml"
    write_recording(Recording((Signal("T", "torque", torque), Signal("gamma", "angle", twist)), 500), record)
    model.write_text(MODEL, encoding="utf-8")
    return str(record), str(model)


def test_estimate_gives_stiffness_over_amplitude(files):
    """460, then 756.147 N m/rad by the describing function of two stages at .2 rad; 0.5 N m s/rad at 4 Hz."""
    answer = runner().invoke(app, ["estimate", files[0], "--output", "T", "--input", "gamma", "--stepped", "--json"])
    found = json.loads(answer.stdout)
    assert found["amplitude_rad"] == pytest.approx([0.05, 0.2], rel=1e-6)
    assert found["k1_Nm_per_rad"] == pytest.approx([460, 756.147], rel=1e-3)
    assert found["k2_Nm_per_rad"] == pytest.approx([0.5 * 2 * np.pi * 4] * 2, rel=2e-3)
    assert found["torque_amplitude_Nm"][0] == pytest.approx(0.05 * np.hypot(460, 4 * np.pi), rel=1e-4)


def test_compare_lays_them_over_an_element(files, tmp_path):
    picture = tmp_path / "steps.png"
    given = ["compare", *files, "--output", "T", "--input", "gamma", "--stepped", "--json", "--plot", str(picture)]
    answer = runner().invoke(app, given)
    found = json.loads(answer.stdout)
    assert found["element"] == "shaft"
    assert found["model_k1_Nm_per_rad"] == pytest.approx([460, 756.147259], rel=1e-6)
    assert found["k1_Nm_per_rad"] == pytest.approx(found["model_k1_Nm_per_rad"], rel=1e-3)
    assert found["model_k2_Nm_per_rad"] == pytest.approx([0.5 * 2 * np.pi * 4] * 2, rel=1e-6)
    assert picture.stat().st_size > 10_000


@pytest.mark.parametrize(
    ("more", "kind"),
    [
        (["--output", "gamma"], "wrong-count"),
        (["-o", "response.npz"], "needless-entry"),
    ],
)
def test_what_estimate_cannot_step_is_named(files, more, kind):
    answer = runner().invoke(app, ["estimate", files[0], "--output", "T", "--input", "gamma", "--stepped", *more])
    assert answer.exit_code == 2
    assert f"[{kind}]" in answer.stderr


@pytest.mark.parametrize("sensor", ["phi", "T", "other"])
def test_sensors_that_are_no_torque_and_twist_of_one_element_are_named(files, sensor):
    given = ["compare", *files, "--output", "T", "--input", "gamma", "--model-input", sensor, "--stepped"]
    answer = runner().invoke(app, given)
    assert answer.exit_code == 2
    assert "[unfit-channel]" in answer.stderr
