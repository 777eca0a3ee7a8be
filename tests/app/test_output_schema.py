"""What --json prints is what its schema says, nothing more and nothing less, for every command that has it."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.command_line import run
from support.loop_records import stage_record
from support.ship_plant import SHIP
from support.steady_campaign import CAMPAIGN, SPEED, STEADY_FAN, torque, write_steady_record
from support.wheel_tests import record, teeth
from support.written_models import FIT_OF_TWO_DISCS, TWO_DISCS, TWO_FANS

import torsionnet as tn
from torsionnet.app.cli.output import OUTPUTS
from torsionnet.io import write_frequency_response, write_recording
from torsionnet.signals.recording import Recording, Signal


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("outputs")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        Path("rig.yaml").write_text(TWO_DISCS, encoding="utf-8")
        Path("plant.yaml").write_text(TWO_FANS, encoding="utf-8")
        Path("ship.yaml").write_text(SHIP, encoding="utf-8")
        Path("driven.yaml").write_text(TWO_FANS + DRIVEN, encoding="utf-8")
        Path("governed.yaml").write_text(GOVERNED, encoding="utf-8")
        Path("gap.yaml").write_text(GAP, encoding="utf-8")
        Path("cubic.yaml").write_text(CUBIC, encoding="utf-8")
        Path("fit.yaml").write_text(FIT_OF_TWO_DISCS, encoding="utf-8")
        Path("spread.yaml").write_text(SPREAD, encoding="utf-8")
        test = FIT_OF_TWO_DISCS.replace("record: run_soft.npz", "response: test.csv").replace(
            "input: T_set, model_input: T", "input: T"
        )
        Path("short_fit.yaml").write_text(test, encoding="utf-8")
        response = tn.load("rig.yaml").configured("soft").frequency_response("phi", "T", np.linspace(1, 25, 60))
        noise = 0.01 * np.random.default_rng(1).standard_normal(response.values.shape)
        write_frequency_response(replace(response, values=response.values * (1 + noise)), "test.csv")
        Path("broken.yaml").write_text(
            "name: x\nelements: {a: {type: inertia, node: n, inertia: -1, frob: 2}}\n", encoding="utf-8"
        )
        run("bench", "rig.yaml", "-c", "soft", "-o", "run_soft.npz")
        Path("pulses.csv").write_text("n1\n" + "\n".join(str(1000 * count) for count in range(600)), encoding="utf-8")
        pair = record(teeth(), 100.0, angle=np.radians(100))
        write_recording(Recording((), 1e4, pulses=(pair.first, pair.second)), "wheel.npz")
        t = np.arange(500) / 100
        Path("decay.csv").write_text(
            "time [s],T [N*m]\n"
            + "".join(f"{a:.2f},{b:.6g}\n" for a, b in zip(t, np.exp(-t) * np.cos(40 * t), strict=True)),
            encoding="utf-8",
        )
        lines = (f"{a:.2f},{np.cos(60 * a):.6g},20" for a in t)
        Path("turning.csv").write_text("time [s],T [N*m],n [rad/s]\n" + "\n".join(lines), encoding="utf-8")
        write_recording(stage_record(1), "loops.npz")
        twist = np.where(t < 2.5, 0.05, 0.2) * np.sin(20 * t)
        steps = (Signal("T", "torque", 460 * twist), Signal("twist", "angle", twist))
        write_recording(Recording(steps, 100), "steps.npz")
        Path("fan").mkdir()
        Path("fan", "fan.yaml").write_text(STEADY_FAN, encoding="utf-8")
        Path("fan", "campaign.yaml").write_text(CAMPAIGN, encoding="utf-8")
        for seed, name in enumerate(("first", "again")):
            write_steady_record(folder / "fan" / f"{name}.npz", seed, torque(SPEED))
        yield folder


GOVERNED = """
torsionnet: 1
elements:
  rotor: {type: inertia, node: a, inertia: 2}
  governor: {type: controller, sense: {velocity: a}, act: a, law: -30, delay: 50 ms}
"""
CUBIC = """
torsionnet: 1
name: cubic spring
elements:
  mass: {type: inertia, node: a, inertia: 1 kg*m^2}
  spring: {type: spring, nodes: [a, ground], stiffness: 1 N*m/rad, cubic: 0.1 N*m/rad^3, damping: 0.05 N*m*s/rad}
"""
GAP = """
torsionnet: 1
elements:
  rotor: {type: inertia, node: a, inertia: 0.5}
  gap: {type: clearance, nodes: [a, ground], gap: 0.2, stiffness: 1e4, damping: 1}
sensors: {T: {torque: gap}, twist: {twist: gap}}
scenarios:
  push: {type: torques, duration: 0.3 s, rate: 1 kHz, torque: {a: 5 N*m}}
"""
SPREAD = """
torsionnet: 1
model: dmf_rig
vary: {k_2: {type: normal, deviation: 5 %}}
sampling: {count: 20}
quantities:
  f_1: {type: natural_frequency, mode: 1}
  H: {type: response, output: theta_1, input: T_M, band: 1..20 Hz, points: 3}
limits: {f_1: {below: 7.2}}
answers: {yield: {type: yield}}
"""
DRIVEN = "load: {absorbed_at: f, torque: 100 N*m, torque_exponent: 2, rated: 900 rpm, driven_by: {m: 1}}"
CALLS = {
    "calibrate-wheel": ["calibrate-wheel wheel.npz --pulses A --second-pickup B --pickup-angle 99deg --teeth 24"],
    "check": ["check dmf_rig broken.yaml"],
    "clocks": ["clocks pulses.csv pulses.csv --pulses n1=20 --tick 1us --same-start"],
    "library": ["library"],
    "modes": ["modes amt_rig -c all", "modes planetary_set"],
    "frf": [
        "frf dmf_rig --output theta_1 --input T_T",
        "frf amt_rig -c all --output theta_1 --input T_T --band 1 10",
    ],
    "sensitivity": ["sensitivity dmf_rig"],
    "equations": ["equations dmf_rig", "equations dmf_rig --tf theta_1/T_M --simplify 1% --band 0.5 20"],
    "limits": ["limits ship.yaml -c all", "limits ship.yaml -c all --limit crank"],
    "orders": ["orders plant.yaml --output f", "orders plant.yaml -c all --output m"],
    "critical-speeds": [
        "critical-speeds plant.yaml",
        "critical-speeds plant.yaml -c all --margin api618 --output f --line-frequency 50",
    ],
    "margins": ["margins governed.yaml"],
    "holzer": ["holzer plant.yaml --mode 1", "holzer marine_steam_turbine --at 3"],
    "static": ["static driven.yaml", "static driven.yaml -c all --speed 300rpm"],
    "damper": [
        "damper plant.yaml --vary shaft.damping=0.01..10 --output f",
        "damper dmf_rig --vary c_2 --output theta_1 --input T_T --band 1 30",
    ],
    "show": ["show dmf_rig", "show dmf_rig --equations --matrices"],
    "estimate": [
        "estimate run_soft.npz --output phi --input M",
        "estimate steps.npz --output T --input twist --stepped",
    ],
    "compare": [
        "compare run_soft.npz rig.yaml -c soft --output phi --input M",
        "compare steps.npz gap.yaml --output T --input twist --stepped",
    ],
    "simulate": ["simulate turbine_generator_ssr two_phases --sampling-rate 2kHz", "simulate gap.yaml push --check"],
    "periodic": ["periodic cubic.yaml --output a --frequencies 0.18:0.2:0.01 --torque a=0,0.18"],
    "spectrogram": ["spectrogram run_soft.npz --channel phi"],
    "loops": ["loops loops.npz --torque T --twist gamma"],
    "angle": ["angle pulses.csv --pulses n1=60 --tick 1us --orders 6"],
    "bench": ["bench rig.yaml -o again.npz"],
    "study": ["study spread.yaml"],
    "fit": ["fit fit.yaml", "fit short_fit.yaml --profile --rank"],
    "damping": [
        "damping decay.csv --kind decay --channel T --start 0",
        "damping decay.csv --kind decay --channel T --start 0 --model rig.yaml -c soft",
    ],
    "track": ["track turning.csv --reference-shaft n --channel T --orders 3"],
    "campaign": ["campaign fan/campaign.yaml"],
    "identify-modes": [
        "identify-modes run_soft.npz --output phi --input M --band 0 60 --model-order 4",
        "identify-modes run_soft.npz --output phi --input T_set --band 0 15 --model rig.yaml -c soft",
    ],
}


@pytest.mark.few(2)
@pytest.mark.parametrize("call", [call for calls in CALLS.values() for call in calls])
def test_output_follows_its_schema(folder, call, monkeypatch):
    import jsonschema

    monkeypatch.chdir(folder)
    schema = json.loads(run("schema", "--json-of", call.split()[0]).stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    printed = run(*call.split(), "--json", code=1 if "broken" in call else 6 if "--limit" in call else 0).stdout
    jsonschema.validate(json.loads(printed), schema)


def test_every_command_with_json_has_a_schema():
    assert CALLS.keys() == OUTPUTS.keys()
    listed = re.findall(r"^  ([a-z-]+) +[A-Z]", run("--help").stdout, re.MULTILINE)
    assert {name for name in listed if "Print JSON" in run(name, "--help").stdout} == OUTPUTS.keys()


def test_schema_goes_to_a_file(tmp_path):
    run("schema", "--json-of", "modes", "-o", str(tmp_path / "modes.json"))
    assert json.loads((tmp_path / "modes.json").read_text())["title"] == "torsionnet modes --json"
    assert "modes" in run("schema", "--json-of", "frobnicate", code=2).stderr
