"""Frequency responses as a result: conversions, units, tables, conventions."""

import json
import math

import numpy as np
import pytest
from support.models import geared_line

import torsionnet as tn
from torsionnet.linear.phase import phase_at_zero_frequency

F = np.array([1.0, 2.0, 5.0])


@pytest.fixture
def H():
    return geared_line().frequency_response(["angle", "g"], ["m", "g"], F)


def test_mobility_and_accelerance_are_rates_of_the_receptance(H):
    s = 2j * np.pi * F
    np.testing.assert_allclose(H.mobility().values, H.values * s[:, None, None])
    np.testing.assert_allclose(H.mobility().accelerance().values, H.values * (s**2)[:, None, None])
    np.testing.assert_allclose(H.accelerance().receptance().values, H.values)
    assert [part.kind() for part in (H, H.mobility(), H.accelerance())] == ["receptance", "mobility", "accelerance"]
    assert H.mobility().unit() == "rad/s/(N*m)"


def test_dynamic_stiffness_is_the_inverse_matrix(H):
    stiffness = H.dynamic_stiffness()
    np.testing.assert_allclose(stiffness.values @ H.values, np.broadcast_to(np.eye(2), (3, 2, 2)), atol=1e-12)
    assert (stiffness.kind(), stiffness.unit()) == ("dynamic stiffness", "N*m/rad")
    with pytest.raises(tn.UsageError, match="1 x 2"):
        H.select("angle").dynamic_stiffness()


def test_decibels_and_degrees(H):
    degrees = tn.Conventions(angle="deg", db_reference=1e-3)
    expected = 20 * np.log10(np.abs(H.values) * 180 / np.pi / 1e-3)
    np.testing.assert_allclose(H.decibels(degrees), expected)
    stiffness = H.dynamic_stiffness()
    np.testing.assert_allclose(
        stiffness.decibels(tn.Conventions(angle="deg")), 20 * np.log10(stiffness.magnitude * np.pi / 180)
    )


def test_torque_ratios_have_no_angle_unit():
    ratio = geared_line().frequency_response("T", "T_M", F)
    np.testing.assert_array_equal(ratio.decibels(tn.Conventions(angle="deg")), ratio.decibels())
    assert (ratio.unit(), ratio.kind()) == ("1", "torque ratio")


def test_table_names_units_and_conventions(H, tmp_path):
    conventions = tn.Conventions(angle="deg", frequency="rpm")
    text = H.select("angle", "m").to_csv(tmp_path / "h.csv", conventions)
    assert (tmp_path / "h.csv").read_text() == text
    rows = [line for line in text.splitlines() if not line.startswith("#")]
    assert rows[0] == "frequency [rpm],|angle/m| [deg/(N*m)],phase angle/m [deg]"
    first = [float(cell) for cell in rows[1].split(",")]
    assert first == pytest.approx([60, abs(H.values[0, 0, 0]) * 180 / np.pi, np.degrees(np.angle(H.values[0, 0, 0]))])
    assert "exp(+j omega t)" in text


def test_json_has_no_infinity():
    free = geared_line().switched(off=["brake", "stiff"])
    with pytest.warns(tn.TorsionnetWarning, match="turns freely"):
        data = json.loads(free.frequency_response("angle", "T_M", [0.0]).table().to_json())
    assert data["rows"][0][1] is None


def test_response_amplitudes_in_every_convention(H):
    one = np.abs(H.values[:, 0, 0]) * 7
    for amplitude, factor in (("peak", 1), ("RMS", 0.5**0.5), ("peak-to-peak", 2)):
        shown = H.select("angle", "m").response_amplitude([7.0], tn.Conventions(amplitude=amplitude))
        np.testing.assert_allclose(shown[:, 0], one * factor)


def test_select_by_name(H):
    np.testing.assert_array_equal(H.select("g", "m").values[:, 0, 0], H.values[:, 1, 0])
    with pytest.raises(tn.UsageError, match="angle, g"):
        H.select("h")


@pytest.mark.parametrize("wrong", [{"angle": "grad"}, {"frequency": "kHz"}, {"amplitude": "rms"}, {"db_reference": 0}])
def test_conventions_are_checked(wrong):
    with pytest.raises(tn.UsageError):
        tn.Conventions(**wrong)


@pytest.mark.slow
def test_repr_is_short(H):
    assert repr(H) == "<FrequencyResponse angle, g / m, g: 3 frequencies, 1 to 5 Hz>"
    assert H._repr_html_().count("<tr>") == 4


@pytest.mark.parametrize(
    ("value", "phase"), [(1 + 1e-67j, 0), (-1 - 1e-67j, 180), (1 - 1e-3j, -math.degrees(math.atan(1e-3))), (1e-9j, 90)]
)
def test_a_phase_of_rounding_is_none_at_rest(value, phase):
    assert phase_at_zero_frequency(value) == pytest.approx(phase, abs=1e-13)


def test_what_is_infinite_or_unknown_has_no_phase():
    assert math.isnan(phase_at_zero_frequency(complex(math.inf)))
    assert math.isnan(phase_at_zero_frequency(complex(math.nan)))
