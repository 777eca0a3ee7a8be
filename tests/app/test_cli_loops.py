"""Command ``torsionnet loops``: table, data, picture and the component as a model file."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from support.command_line import run
from support.loop_records import backlash_record, course, loop_record, stage_record

import torsionnet as tn
from torsionnet.io.loop_element import loop_element
from torsionnet.signals import Signal, loops, write_recording
from torsionnet.signals.torque_loops.loop_result import LoopValue, TorqueLoops


def call(tmp_path, record, *more, code=0):
    write_recording(record, tmp_path / "bench.npz")
    return run("loops", tmp_path / "bench.npz", "--torque", "T", "--twist", "gamma", *more, code=code)


def test_the_component_of_a_record_is_a_model_that_loads(tmp_path):
    file = tmp_path / "flywheel.yaml"
    found = json.loads(
        call(tmp_path, stage_record(1), "--write-model", file, "-o", tmp_path / "loops.json", "--json").stdout
    )
    (loop,) = found["loops"]
    again = TorqueLoops.from_json(tmp_path / "loops.json")
    assert again.loops[0].cycles == loop["cycles"] == 5
    rubbing = [replace(one, friction=LoopValue(2.0 * one.number)) for one in again.loops[0].stages]
    element = loop_element(replace(again, loops=(replace(again.loops[0], stages=tuple(rubbing)),)))
    assert element.definition.parameters["M"].description.endswith("stages rub with 2, 4")
    rig = tn.load(file)
    text = file.read_text(encoding="utf-8")
    assert "95 %" in text
    assert "5 cycles of T over gamma in bench.npz" in text
    values = {name: float(one.value.evaluate({})) for name, one in rig.definition.parameters.items()}
    both = {one["number"]: one for one in loop["stages"] if one["side"] == "both"}
    assert values["k_2"] == pytest.approx(both[2]["stiffness_Nm_per_rad"]["value"], rel=1e-5)
    assert values == pytest.approx({"k_1": 460, "g_1": 0.12, "k_2": 1500, "M": 6}, rel=0.01)


def test_free_play_becomes_a_clearance_and_sides_that_differ_rows(tmp_path):
    file = tmp_path / "part.yaml"
    call(tmp_path, backlash_record(1), "--write-model", file)
    contact = tn.load(file).elements["contact"]
    assert contact.kind == "clearance"
    twist, sense = course(4.6, 800)
    torque = 0.25 * twist * np.where(twist > 0, 400, 300) + 1500 * np.maximum(0.25 * twist - 0.1, 0) + 2 * sense
    noise = np.random.default_rng(0).normal(0, 0.1, len(twist))
    call(tmp_path, loop_record(torque + noise, 0.25 * twist), "--write-model", file)
    springs = tn.load(file).elements["springs"]
    rows = np.array([[float(cell.evaluate({})) for cell in row] for row in springs.torque_over_twist])
    assert rows[2] == pytest.approx([0.1, 40.0], rel=0.01)
    slopes = np.diff(rows[:, 1]) / np.diff(rows[:, 0])
    assert slopes == pytest.approx([300, 400, 1900], rel=0.01)
    call(tmp_path, loop_record(-torque - noise, -0.25 * twist), "--write-model", file)
    mirrored = [cell.evaluate({}) for cell in tn.load(file).elements["springs"].torque_over_twist[1]]
    assert mirrored == pytest.approx([-0.1, -40.0], rel=0.01)
    torque = 0.1 * twist * np.where(twist > 0, 900, 700) + 4 * sense + noise
    springs = loop_element(loops(loop_record(torque, 0.1 * twist), "T", "gamma")).definition.elements["springs"]
    assert [float(cell.evaluate({})) for cell in springs.torque_over_twist[1]] == pytest.approx([0, 0], abs=0.1)


def test_corrections_are_options_and_what_is_missing_is_told(tmp_path):
    wide = call(tmp_path, stage_record(2, drift=9.0))
    assert "more than the friction torque" in wide.stderr
    taken = call(tmp_path, stage_record(2, drift=9.0), "--drift", "--angle-unit", "deg")
    assert "more than the friction torque" not in taken.stderr
    assert "deg" in taken.stdout
    twist, sense = course(4.6, 800, sine=True)
    record = loop_record(900 * 0.1 * twist + 5 * sense, 0.1 * twist)
    assert "lateness of the torque" in call(tmp_path, record).stdout
    moved = call(tmp_path, record, "--delay", "T=1.2ms").stdout
    assert "torque moved 1.2 ms" in moved
    assert "lateness of the torque" not in moved
    refused = call(tmp_path, loop_record(np.linspace(0, 9, 900), np.linspace(0, 0.1, 900)), code=2)
    assert "[no-reversal]" in refused.stderr
    alone = stage_record(2)
    torque, twist = alone.signals
    ends = (Signal("a", "angle", twist.values + alone.time), Signal("b", "angle", alone.time))
    write_recording(replace(alone, signals=(torque, *ends)), tmp_path / "two.npz")
    between = run("loops", tmp_path / "two.npz", "--torque", "T", "--twist", "a", "--twist", "b", "--json").stdout
    (own,), (other,) = (json.loads(one)["loops"] for one in (call(tmp_path, alone, "--json").stdout, between))
    for name in ("amplitude_rad", "secant_stiffness_Nm_per_rad"):
        assert other[name]["value"] == pytest.approx(own[name]["value"], rel=1e-9)
    thrice = call(tmp_path, stage_record(2), "--twist", "gamma", "--twist", "gamma", code=2)
    assert "once or twice" in thrice.stderr
