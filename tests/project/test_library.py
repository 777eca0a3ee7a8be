"""Every library model: sound, documented, right against the validation case of the same system."""

import re

import numpy as np
import pytest
from support.library_cases import library_cases
from validation.build import read_case

import torsionnet as tn
from torsionnet.model.files.library import library_folder

CASES = {
    "direct_drive_wind_turbine": "sopanen_windmill_3mass",
    "drill_string": "friswell_9_9_drillstring_5el",
    "geared_branch": "friswell_geared_branch_unit_ratio",
    "marine_steam_turbine": "gunter_chen_8_1_marine_steam_turbine",
    "oil_engine": "khurmi_three_rotor_oil_engine",
    "planetary_set": "kahraman_planetary_torsional_fixed_ring",
    "six_cylinder_diesel": "mendes_2008_six_cyl_diesel",
    "turbine_generator_ssr": "ieee_fbm_ssr_6mass",
    "wind_turbine_5mw": "nrel_5mw_drivetrain_2mass",
}
IN_TEST_PAPER = {"amt_rig", "dmf_rig"}
IN_TEST_COMPONENT_BENCH = {"dmf_component"}
RUNNING = {
    "bulk_carrier",
    "engine_generator_set",
    "front_wheel_drive_car",
    "marine_medium_speed",
    "reciprocating_compressor_train",
    "two_stroke_ship",
    "wind_turbine_3mw",
}
"""Plants of own data, checked by hand calculations in test_running_plants."""
MODELS = tuple(tn.library_models())


def test_every_model_is_checked_against_something():
    assert set(MODELS) == set(CASES) | IN_TEST_PAPER | IN_TEST_COMPONENT_BENCH | RUNNING


@pytest.mark.parametrize("name", library_cases())
def test_is_sound_in_every_configuration(name):
    model = tn.load(name)
    for variant in (model, *map(model.configured, model.configurations)):
        assert all(fault.severity == "note" for fault in variant.check())


@pytest.mark.few(9)
@pytest.mark.parametrize("name", MODELS)
def test_says_what_it_is(name):
    model = tn.load(name)
    assert model.source
    assert model.description
    undescribed = [key for key, parameter in model.parameter_definitions.items() if not parameter.description]
    assert undescribed == []


@pytest.mark.parametrize("name", MODELS)
def test_editors_find_the_schema(name):
    first = tn.library_models()[name].read_text(encoding="utf-8").splitlines()[0]
    assert first == "# yaml-language-server: $schema=torsionnet.schema.json"


def test_readme_has_a_row_for_every_model():
    readme = (library_folder() / "README.md").read_text(encoding="utf-8").partition("## Catalogues")[0]
    assert sorted(re.findall(r"^\| `(\w+)` \|", readme, flags=re.MULTILINE)) == sorted(MODELS)


@pytest.mark.few(4)
@pytest.mark.parametrize("name", MODELS)
def test_reads_back_what_it_writes(name):
    model = tn.load(name)
    assert tn.loads(model.to_yaml()) == model


@pytest.mark.parametrize("name", library_cases())
def test_every_input_reaches_every_sensor(name):
    model = tn.load(name)
    response = model.frequency_response(list(model.sensors), list(model.inputs), [0.7, 13.0])
    assert np.isfinite(response.values).all()
    assert (response.magnitude > 0).all()


@pytest.mark.parametrize("name", CASES)
def test_natural_frequencies_of_its_case(name):
    case = read_case(CASES[name])
    expected = case["expected"]
    undamped = expected.get("undamped_natural_frequencies_hz", expected["natural_frequencies_hz"])
    modes = tn.load(name).modes()
    np.testing.assert_allclose(modes.undamped_natural_frequencies, undamped, rtol=case["tolerance"]["computed_rel"])


@pytest.mark.parametrize("name", ["six_cylinder_diesel", "wind_turbine_5mw"])
def test_damping_of_its_case(name):
    case, modes = read_case(CASES[name]), tn.load(name).modes()
    ratios = modes.damping_ratios[np.array(modes.kinds) == "oscillatory"]
    np.testing.assert_allclose(ratios, case["expected"]["damping_ratios"], rtol=case["tolerance"]["computed_rel"])


def test_modal_damping_of_the_direct_drive_wind_turbine():
    np.testing.assert_allclose(tn.load("direct_drive_wind_turbine").modes().damping_ratios[1:], 0.02, rtol=1e-5)


@pytest.mark.parametrize("name", ["direct_drive_wind_turbine", "marine_steam_turbine"])
def test_undamped_configuration(name):
    modes = tn.load(name).configured("undamped").modes()
    np.testing.assert_allclose(modes.natural_frequencies, modes.undamped_natural_frequencies, rtol=1e-9)
    np.testing.assert_array_equal(modes.damping_ratios[1:], 0)


def test_hysteretic_losses_damp_all_modes_of_the_diesel_engine_alike():
    """A loss factor in every spring gives half of it as damping ratio, on top of the cylinders' friction."""
    engine = tn.load("six_cylinder_diesel")
    viscous, both = (engine.configured(name).modes() for name in ("viscous", "viscous_and_hysteretic"))
    added = (both.damping_ratios - viscous.damping_ratios)[np.array(viscous.kinds) == "oscillatory"]
    np.testing.assert_allclose(added, 0.035 / 2, rtol=1e-2)


@pytest.mark.parametrize(
    ("name", "speeds_rpm"),
    [
        ("marine_steam_turbine", {"propeller": 85, "lp_wheel": -799.8, "lp_turbine": 3403.6, "hp_turbine": 6650.1}),
        ("wind_turbine_5mw", {"generator": 1173.7}),
    ],
)
def test_mean_speeds(name, speeds_rpm):
    speeds = tn.load(name).mean_speeds
    for node, rpm in speeds_rpm.items():
        assert speeds[node] * 30 / np.pi == pytest.approx(rpm, abs=0.05)
