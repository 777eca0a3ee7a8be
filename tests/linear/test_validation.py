"""Cases from textbooks, papers and other programs, each against what they print and what exact arithmetic gives.

The dashpot matrix of ``forced_sopanen_windmill`` (modal damping) has no negative entry off its diagonal once the sign
is turned, and no negative row sum: dampers between the nodes and to ground make it up exactly.
"""

import numpy as np
import pytest
from validation.build import build, case_names, damper_matrix, drill_string_from_geometry, read_case, spring_name

ALL = {name: read_case(name) for name in case_names()}
MODAL = {name: case for name, case in ALL.items() if "expected" in case}
DAMPED = {name: case for name, case in MODAL.items() if "damping_ratios" in case["expected"]}
FRF = [(name, sample) for name, case in MODAL.items() for sample in case["expected"].get("frf", ())]
UNITS_PER_HZ = {"natural_frequencies_hz": 1, "natural_frequencies_cpm": 60, "natural_frequencies_rad_s": 2 * np.pi}
PUBLISHED = [(name, key) for name, case in MODAL.items() for key in UNITS_PER_HZ if key in case.get("published", {})]


def modes_of(name):
    return build(ALL[name]).modes()


def of_kind(modes, values, kind):
    return np.asarray(values)[np.array(modes.kinds) == kind]


def relative(case):
    return case["tolerance"]["computed_rel"]


@pytest.mark.parametrize("name", MODAL)
def test_natural_frequencies(name):
    case, modes = ALL[name], modes_of(name)
    found = modes.natural_frequencies
    if name in DAMPED:
        found = of_kind(modes, found, "oscillatory")
    np.testing.assert_allclose(found, case["expected"]["natural_frequencies_hz"], rtol=relative(case))


@pytest.mark.parametrize("name", [name for name in MODAL if "undamped_natural_frequencies_hz" in ALL[name]["expected"]])
def test_undamped_natural_frequencies(name):
    case = ALL[name]
    expected = case["expected"]["undamped_natural_frequencies_hz"]
    np.testing.assert_allclose(modes_of(name).undamped_natural_frequencies, expected, rtol=relative(case))


@pytest.mark.parametrize("name", MODAL)
def test_number_of_rigid_body_modes(name):
    expected, modes = ALL[name]["expected"], modes_of(name)
    drag = "zero_eigenvalues" in expected and expected["zero_eigenvalues"] < 2 * expected["rigid_body_modes"]
    assert np.count_nonzero(modes.undamped_natural_frequencies == 0) == expected["rigid_body_modes"]
    assert modes.kinds.count("rigid body") == expected["rigid_body_modes"]
    assert modes.kinds.count("real pole") == drag


@pytest.mark.parametrize("name", DAMPED)
def test_damping(name):
    case, modes = ALL[name], modes_of(name)
    expected = case["expected"]
    ratios = of_kind(modes, modes.damping_ratios, "oscillatory")
    np.testing.assert_allclose(ratios, expected["damping_ratios"], rtol=relative(case))
    damped = of_kind(modes, modes.damped_frequencies, "oscillatory")
    np.testing.assert_allclose(damped, expected["damped_frequencies_hz"], rtol=relative(case))
    poles = of_kind(modes, modes.eigenvalues, "real pole")
    np.testing.assert_allclose(poles, expected["real_eigenvalues_rad_s"], rtol=relative(case))


@pytest.mark.parametrize(("name", "key"), PUBLISHED)
def test_printed_frequencies(name, key):
    published = ALL[name]["published"]
    found = modes_of(name).undamped_natural_frequencies * UNITS_PER_HZ[key]
    printed = [np.nan if value is None else float(value) for value in published[key]]
    off = np.abs(found[: len(printed)] - printed)
    assert np.nanmax(off) <= published["tolerance"]


def test_printed_damping_of_nrel_5mw():
    published, modes = ALL["nrel_5mw_drivetrain_2mass"]["published"], modes_of("nrel_5mw_drivetrain_2mass")
    ratios = of_kind(modes, modes.damping_ratios, "oscillatory")
    np.testing.assert_allclose(ratios, published["damping_ratios"], rtol=0, atol=published["tolerance"])


def test_closed_form_of_rayleigh_damping():
    modes, exact = modes_of("rayleigh_damped_fixed_free_6"), ALL["rayleigh_damped_fixed_free_6"]["closed_form"]
    np.testing.assert_allclose(modes.natural_frequencies, exact["natural_frequencies_hz"], rtol=1e-12)
    np.testing.assert_allclose(modes.damping_ratios, exact["damping_ratios"], rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "sample"),
    FRF,
    ids=lambda value: value if isinstance(value, str) else f"{value['input']}-{value['output']}",
)
def test_receptance(name, sample):
    response = build(ALL[name]).frequency_response(sample["output"], sample["input"], [sample["freq_hz"]])
    np.testing.assert_allclose(response.values.item(), complex(sample["re"], sample["im"]), rtol=relative(ALL[name]))


def test_drill_string_from_its_geometry():
    case = ALL["friswell_9_9_drillstring_5el"]
    found = drill_string_from_geometry(case).modes().natural_frequencies
    np.testing.assert_allclose(found, case["expected"]["natural_frequencies_hz"], rtol=relative(case))


def test_two_planet_modes_of_the_planetary_set_coincide():
    case, modes = ALL["kahraman_planetary_torsional_fixed_ring"], modes_of("kahraman_planetary_torsional_fixed_ring")
    (pair,) = case["expected"]["repeated_modes"]
    still = modes.shape_at("carrier"), modes.shape_at("sun")
    np.testing.assert_allclose(np.abs(still)[:, pair], 0, atol=1e-9)


class TestForcedChain:
    """Four harmonics of torque on the first of five discs."""

    case = ALL["forced_ot_docs_chain5"]
    amplitudes = (200, 50, 5, 2)

    def forced(self, outputs):
        model = build(ALL[self.case["model"]])
        response = model.frequency_response(outputs, "n0", np.array(self.case["omega_rad_s"]) / (2 * np.pi))
        return (response.values[:, :, 0] * np.array(self.amplitudes)[:, None]).T

    def test_angles(self):
        found = self.forced([f"n{index}" for index in range(5)])
        np.testing.assert_allclose(found, self.case["response_rad"], rtol=relative(self.case))

    def test_shaft_torques(self):
        found = self.forced([f"torque({spring_name(spring)})" for spring in ALL[self.case["model"]]["springs"]])
        printed = np.array(self.case["shaft_torque_Nm"])  # k times the angle of the second end minus that of the first
        np.testing.assert_allclose(found, -printed, rtol=relative(self.case))


class TestForcedWindTurbine:
    """Cogging and ripple harmonics on the generator of a direct-drive wind turbine with modal damping."""

    case = ALL["forced_sopanen_windmill"]
    base = ALL[case["model"]]

    def model(self):
        nodes = [node["name"] for node in self.base["nodes"]]
        return build(self.base, damper_matrix(nodes, self.case["damping_matrix_C"]))

    def torques(self, omega):
        outputs = [f"torque({spring_name(spring)})" for spring in self.base["springs"]]
        response = self.model().frequency_response(
            outputs, self.case["excitation"]["node"], np.asarray(omega) / (2 * np.pi)
        )
        return response.magnitude[:, :, 0].T

    @pytest.mark.parametrize("point", case["reference_from_openTorsion_0.3.2"], ids=lambda point: f"{point['rpm']}rpm")
    def test_shaft_torques(self, point):
        found = self.torques(point["omega_rad_s"]) * point["amplitude_Nm"]
        np.testing.assert_allclose(found, point["per_harmonic_abs_Nm"], rtol=relative(self.case))
        np.testing.assert_allclose(found.sum(axis=1), point["vibratory_torque_sum_Nm"], rtol=relative(self.case))

    def test_resonances_of_the_twelfth_harmonic(self):
        published = self.case["published_resonances_rpm"]
        for rpm in published["values"]:
            near = np.linspace(0.8 * rpm, 1.2 * rpm, 801)
            peaks = near[np.argmax(self.torques(12 * 2 * np.pi * near), axis=1)]
            np.testing.assert_allclose(peaks, rpm, rtol=0, atol=published["tolerance"])
