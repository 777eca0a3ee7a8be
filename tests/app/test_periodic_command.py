"""Command ``periodic`` with questions that have no answer: each is refused by its kind, and names what it is about."""

from __future__ import annotations

import pytest
from support.command_line import run

RATTLE = """torsionnet: 1
name: rattling gears
elements:
  wheel: {type: inertia, node: a, inertia: 0.12 kg*m^2}
  car: {type: inertia, node: b, inertia: 0.9 kg*m^2}
  mesh: {type: clearance, nodes: [a, b], gap: 2 deg, stiffness: 8 kN*m/rad}
  oil: {type: damper, nodes: [a, b], damping: 3 N*m*s/rad}
inputs: {T_a: {torque: a}}
operating_point: {torque: {a: 25 N*m, b: -25 N*m}}
speeds: {of: a, range: 2400..3000 rpm, step: 300 rpm}
excitations: {shaker: {type: harmonic, node: a, orders: {1: {amplitude: 40 N*m}}}}
"""
SHAKER = "shaker: {type: harmonic, node: a, orders: {1: {amplitude: 40 N*m}}}"
OTHER = SHAKER + ", other: {type: harmonic, node: a, orders: {1.4142135: {amplitude: 5 N*m}}}"
MISFIRE = (
    "shaker: {type: reciprocating_engine, speed_of: a, cycle: 2, cylinders: {1: a}, firing_order: [1], bore: 80 mm, stroke: 90 mm, "
    "rod_length: 150 mm, gas: {harmonics: {1: {amplitude: 1 bar, phase: 0 deg}}, motored_harmonics: {1: {amplitude: 0.5 bar, phase: 0 deg}}}, misfire: each}"
)
HERTZ = 'shaker: {type: harmonic, node: a, frequencies: {"37 Hz": {amplitude: 40 N*m}}}'


@pytest.mark.parametrize(
    ("old", "new", "kind", "named"),
    [
        ("clearance, nodes: [a, b], gap: 2 deg", "spring, nodes: [a, b]", "no-effect", "no laws of motion"),
        (SHAKER, HERTZ, "no-period", "shaker 37 Hz"),
        (SHAKER, MISFIRE, "no-period", "say which cylinder misfires"),
        (SHAKER, OTHER, "no-period", "1.4142135"),
        ("b: -25 N*m", "b: -20 N*m", "unbalanced-torques", "5 N*m"),
        ("speeds: {of: a, range: 2400..3000 rpm, step: 300 rpm}\n", "", "missing-entry", "speeds"),
        ("excitations: {" + SHAKER + "}\n", "", "missing-entry", "excitations"),
    ],
)
def test_models_without_periodic_motion(tmp_path, old, new, kind, named):
    assert old in RATTLE
    (tmp_path / "rattle.yaml").write_text(RATTLE.replace(old, new))
    code = 1 if kind == "unbalanced-torques" else 2
    said = run("periodic", str(tmp_path / "rattle.yaml"), "--output", "twist(mesh)", code=code).stderr
    assert f"[{kind}]" in said
    assert named in said


DRIVEN = ("--torque", "T_a=25,40")


@pytest.mark.parametrize(
    ("options", "kind", "named"),
    [
        (("--frequencies", "0,10", *DRIVEN), "out-of-range", "above 0"),
        (("--frequencies", "ten", *DRIVEN), "wrong-form", "ten"),
        (("--frequencies", "40,50"), "missing-entry", "--torque"),
        (("--frequencies", "40,50", "--torque", "T_a=25"), "no-effect", "harmonic 1"),
        (("--frequencies", "40,50", "--torque", "T_a=x"), "wrong-form", "T_a"),
        (("--frequencies", "40,50", "--torque", "T_b=25,40"), "unknown-channel", "T_a"),
        (("--frequencies", "40,50", "--torque", "T_a=10,40"), "unbalanced-torques", "-15"),
        (("--frequencies", "40,50", *DRIVEN, "--excitation", "shaker"), "contradicting-entries", "--excitation"),
        (DRIVEN, "missing-entry", "--frequencies"),
        (("--excitation", "shakr"), "unknown-name", "shaker"),
        (("--output", "twist(mehs)"), "unknown-element", "mesh"),
    ],
)
def test_options_without_an_answer(tmp_path, options, kind, named):
    (tmp_path / "rattle.yaml").write_text(RATTLE)
    said = run("periodic", str(tmp_path / "rattle.yaml"), "--output", "twist(mesh)", *options, code=2).stderr
    assert f"[{kind}]" in said
    assert named in said


def test_a_word_that_is_none_is_told_at_its_place(tmp_path):
    path = tmp_path / "rattle.yaml"
    path.write_text(RATTLE.replace("step: 300 rpm", "step: 300 rpm, nonlinear: cubic"))
    said = run("check", str(path), code=1).stdout
    assert "rattle.yaml:10:66: error: " in said
    assert "[unknown-word]" in said


def test_state_of_simulations_is_read_and_refused(tmp_path):
    from torsionnet.app.cli.commands.under_load import _initial_state
    from torsionnet.motion import MotionStart

    assert _initial_state(()) is None
    assert _initial_state(("rest",)) == "rest"
    assert _initial_state(("a=0.1,0", "b=0,-2")) == MotionStart({"a": 0.1, "b": 0.0}, {"a": 0.0, "b": -2.0})
    (tmp_path / "rattle.yaml").write_text(RATTLE)
    asked = ("periodic", str(tmp_path / "rattle.yaml"), "--output", "twist(mesh)", "--frequencies", "50,51", *DRIVEN)
    for state, kind in (("sleep", "unknown-word"), ("a=0.1", "wrong-form"), ("c=0.1,0", "unknown-node")):
        assert f"[{kind}]" in run(*asked, "--initial-state", state, code=2).stderr
