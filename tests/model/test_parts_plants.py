"""The plants of a test folder, written once without parts and once with them: modes and responses are the same."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

import torsionnet as tn
from torsionnet.model.files.library import library_parts
from torsionnet.model.files.reader import read_text

TESTS = Path(__file__).parents[1]
FREQUENCIES = np.geomspace(0.3, 300, 60)
PLANTS = {
    "marine": ("marine.yaml", {"T1": "cyl1.T", "T4": "cyl4.T", "T_prop": "T_prop"}),
    "front_wheel_drive_car": ("front_wheel_drive_car.yaml", {"T_E": "T_E", "T_block": "T_block"}),
    "wind_turbine_3mw": ("wind_turbine_3mw.yaml", {"T_A": "T_A", "T_aero": "T_aero", "T_G": "T_G"}),
}
SENSORS = {
    "marine": {"T_crank": "torque(cyl5.shaft)", "T_cpl": "T_cpl", "T_mesh": "T_mesh", "T_tail": "T_tail"},
    "front_wheel_drive_car": {
        "T_hl": "torque(left.shaft)",
        "T_hr": "torque(right.shaft)",
        "a_sec": "a_sec",
        "roll": "roll",
    },
    "wind_turbine_3mw": {"T_ms": "T_ms", "T_hs": "T_hs", "T_arm": "T_arm", "w_g": "w_g"},
}


def both(name):
    return tn.load(TESTS / "plants" / f"{name}.yaml"), tn.load(TESTS / "parts" / PLANTS[name][0])


def with_choices(plain, parts):
    for label in plain.configurations:
        yield label, plain.configured(label), parts.configured(label)


@pytest.mark.slow
@pytest.mark.parametrize("name", PLANTS)
def test_a_plant_with_parts_is_the_same_plant(name):
    plain, parts = both(name)
    assert set(plain.configurations) == set(parts.configurations)
    inputs, sensors = PLANTS[name][1], SENSORS[name]
    for label, one, other in with_choices(plain, parts):
        wanted, found = (np.sort_complex(model.modes().eigenvalues) for model in (one, other))
        np.testing.assert_allclose(found, wanted, rtol=1e-10, atol=1e-9, err_msg=label)
        wanted = one.frequency_response(list(sensors), list(inputs), FREQUENCIES).values
        found = other.frequency_response(list(sensors.values()), list(inputs.values()), FREQUENCIES).values
        far_below = 1e-12 * np.abs(wanted).max(axis=0)
        assert np.all(np.abs(found - wanted) <= 1e-12 * np.abs(wanted) + far_below), label


@pytest.mark.parametrize("name", PLANTS)
def test_it_takes_less_than_half_of_the_lines(name):
    lines = {folder: (TESTS / folder / f"{name}.yaml").read_text().count("\n") for folder in ("plants", "parts")}
    assert lines["parts"] < 0.47 * lines["plants"]


@pytest.mark.parametrize("name", library_parts())
def test_a_part_of_the_library_joins_masses(name):
    part = yaml.safe_load(library_parts()[name].read_text(encoding="utf-8"))
    assert part["source"]
    assert all("description" in one for one in part["parameters"].values())
    masses = {f"mass_{port}": {"type": "inertia", "node": port, "inertia": 1} for port in part["ports"]}
    model = {
        "torsionnet": 1,
        "elements": masses,
        "use": {"x": {"part": name, "at": {one: one for one in part["ports"]}}},
    }
    definition, faults = read_text(json.dumps(model), "x.json")
    assert [str(fault) for fault in faults if fault.severity == "error"] == []
    assert {f"x.{element}" for element in part["elements"]} <= definition.elements.keys()
