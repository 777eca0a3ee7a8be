"""Components in a report: IACS UR M68 recomputed by hand from the model file, balance of heat in closed form."""

import math
from pathlib import Path

import numpy as np
import pytest
import yaml
from support.report_blocks import blocks, of, rows

import torsionnet as tn
from torsionnet.machinery.limits.coupling import steady_temperature
from torsionnet.machinery.limits.shaft_limit import RoundSection
from torsionnet.report import make_report
from torsionnet.report.document_tree import Listing, Paragraph, TableBlock

LIBRARY = Path(__file__).parents[2] / "library"
C_K = {"integral_flange": 1.0, "keyless": 0.55}
"""Of IACS UR M68 for the two shafts of the ship."""


@pytest.fixture(scope="module")
def ship():
    return make_report("two_stroke_ship", configurations=["normal"], sections=["components"], date=None)


def tables(report, words):
    return [one for one in of(TableBlock, blocks(report, "components")) if words in str(one.caption)]


def by_hand(name):
    """Diameter in mm, C_D, tau_C at rated speed and at lambda = 0.8, and tau_T there, N/mm2, from the model file."""
    data = yaml.safe_load((LIBRARY / "two_stroke_ship.yaml").read_text(encoding="utf-8"))
    limit = data["limits"][name]
    d = float(data["elements"][name]["outer_diameter"].removesuffix(" mm"))
    sigma = min(float(limit["tensile_strength"].removesuffix(" MPa")), 600)
    c_d, c_k = 0.35 + 0.93 / d**0.2, C_K[limit["feature"]]
    rated, slow = ((sigma + 160) / 18 * c_k * c_d * factor for factor in (1.38, 3 - 2 * 0.8**2))
    return d, c_d, c_k, rated, slow, 1.7 * slow / math.sqrt(c_k)


@pytest.mark.parametrize(("place", "name"), [(3, "intermediate"), (4, "tail")])
def test_factors_of_m68_by_hand(ship, place, name):
    (table,) = tables(ship, "IACS UR M68")
    found = {row[0]: float(row[place]) for row in rows(table)}
    d, c_d, c_k, rated, slow, passing = by_hand(name)
    assert found["Outer diameter"] == d
    assert found["Polar section modulus"] == pytest.approx(math.pi * d**3 / 16 / 1e3, rel=1e-3)
    assert found["Material factor"] == (560 + 160) / 18
    assert found["Size factor"] == pytest.approx(c_d, abs=1e-4)
    assert found["Design feature"] == c_k
    assert found["Permissible at rated speed"] == pytest.approx(rated, rel=1e-3)
    assert [value for key, value in found.items() if "0.8" in key] == pytest.approx([slow, passing], rel=1e-3)


def test_why_this_c_k(ship):
    (table,) = tables(ship, "IACS UR M68")
    said = next(row for row in rows(table) if row[0] == "Design feature")[-1]
    assert said == "intermediate: intermediate shaft: integral coupling flange; tail: propeller shaft: keyless taper " \
        "fitting of the propeller"  # fmt: skip


def test_worst_values_are_those_of_the_api(ship):
    check = tn.load("two_stroke_ship").configured("normal").check_limits()
    (table,) = tables(ship, "Components")
    for row in rows(table):
        criterion = {"Stress, continuous operation": "tau_C", "Stress, quick passage": "tau_T"}.get(
            row[1], "continuous"
        )
        one = check.of(row[0], criterion)
        scale = 1e-3 if one.unit == "N*m" else 1e-6
        expected = [one.values[one.worst] * scale, one.allowed[one.worst] * scale]
        assert [float(cell) for cell in row[6:8]] == pytest.approx(expected, rel=1e-3)
        assert float(row[8]) == pytest.approx(100 * one.utilisation[one.worst], rel=5e-3)
        assert float(row[9]) == pytest.approx(check.rpm[one.worst], abs=0.06)


def test_rated_speed_in_the_normal_condition(ship):
    """Stress of the shafts at 105 rpm from the order response, tau_C there by hand; tau_T ends at lambda = 0.8."""
    rig = tn.load("two_stroke_ship").configured("normal")
    run = rig.order_response(["torque(intermediate)", "torque(tail)"], speeds=[105 * math.pi / 30])
    (table,) = tables(ship, "Components")
    found = {(row[0], row[1].split()[-1]): row[3:6] for row in rows(table)}
    for place, name in enumerate(("intermediate", "tail")):
        d, _, _, rated, *_ = by_hand(name)
        stress = 16 * run.half_range[0, place] / (math.pi * (d / 1e3) ** 3) / 1e6
        value, allowed, used = map(float, found[name, "operation"])
        assert (value, allowed) == pytest.approx((stress, rated), rel=1e-3)
        assert used == pytest.approx(100 * value / allowed, rel=5e-3)
        assert found[name, "passage"][1:] == ("–", "–")


def test_every_throw_and_what_is_not_covered(ship):
    (table,) = tables(ship, "by throw")
    rig = tn.load("two_stroke_ship").configured("normal")
    run = rig.order_response([f"torque(crank{number})" for number in range(1, 6)])
    assert [float(row[3]) for row in rows(table)] == pytest.approx(run.half_range.max(axis=0) / 1e3, rel=5e-3)
    rated = rig.order_response(run.outputs[0].name, speeds=[105 * math.pi / 30])
    assert float(rows(table)[0][2]) == pytest.approx(rated.half_range[0, 0] / 1e3, rel=1e-3)
    assert [row[0] for row in rows(table)] == [f"crank{number}" for number in range(1, 6)]
    assert table.notes == (("The maker's limit is judged in every throw; crank2 uses it most.",),)
    assert "UR M53 is not covered" in str(of(Paragraph, blocks(ship, "components"))[-2].text)
    assert "maker of the engine" in str(of(Listing, blocks(ship, "components"))[0].items)


GENSET = LIBRARY / "engine_generator_set.yaml"
HEAT = "P_KV: 1.0 kW, ambient_temperature: 45 degC, largest_temperature: 90 degC"


def with_heat(more):
    """The generating set whose coupling has these entries in place of its power, judged at all speeds."""
    text = GENSET.read_text(encoding="utf-8").replace("    speed_band: 97..103 %\n", "", 1)
    return text.replace("P_KV: 1.0 kW", more.replace(", ", "\n    "))


class TestBalanceOfHeat:
    def test_closed_form(self):
        """Solution of C dt/dT = P - Lambda (t - t_a) after many time constants, by small steps."""
        power, transfer, ambient, capacity = 640.0, 16.0, 318.15, 5000.0
        temperature, step = ambient, 5.0
        for _ in range(20000):
            temperature += step * (power - transfer * (temperature - ambient)) / capacity
        assert steady_temperature(power, transfer, ambient) == pytest.approx(temperature, rel=1e-12)
        many = steady_temperature(np.array([0.0, 640.0]), transfer, ambient)
        assert many.tolist() == pytest.approx([ambient, ambient + 40])

    def checked(self, more):
        text = with_heat(more)
        return tn.loads(text).configured("firing=misfire,rubber=warm").check_limits("rubber")

    def test_rise_is_power_over_heat_transfer(self):
        check = self.checked(f"{HEAT}, heat_transfer: 16 W/K")
        rise, power = check.of("rubber", "temperature"), check.of("rubber", "P_KV")
        assert rise.values == pytest.approx(power.values / 16, rel=1e-12)
        assert set(rise.allowed) == {45.0}
        hottest = 45 + power.values.max() / 16
        assert f"steady temperature by balance of heat at most {hottest:.3g} degC" in rise.remarks

    def test_without_it_p_kv_is_reached_at_the_largest_temperature(self):
        check = self.checked(HEAT)
        assert check.of("rubber", "temperature").utilisation == pytest.approx(check.of("rubber", "P_KV").utilisation)

    @pytest.mark.parametrize(
        ("more", "words"),
        [
            ("P_KV: 1.0 kW, ambient_temperature: 45 degC", "both ambient_temperature and largest_temperature"),
            (HEAT.replace("45 degC", "95 degC"), r":106:26: .*contradicting-values"),
            (HEAT.replace("45 degC", "45"), r":105:26: .*45.*45.*missing-unit"),
            (f"{HEAT}, heat_transfer: 16 W", r":107:20: .*wrong-unit"),
        ],
    )
    def test_what_is_wrong_is_told(self, more, words):
        with pytest.raises(tn.ModelError, match=words):
            tn.loads(with_heat(more))

    def test_model_is_written_and_read_again(self):
        model = tn.loads(with_heat(HEAT))
        assert tn.loads(model.to_yaml()).definition.limits["rubber"] == model.definition.limits["rubber"]


def test_generator_coupling_and_damper():
    model = with_heat(HEAT)
    report = make_report(
        tn.loads(model), configurations=["firing=normal,rubber=warm"], sections=["components"], date=None
    )
    (table,) = tables(report, "Components")
    found = {row[1]: row for row in rows(table)}
    electrical, mechanical = (float(found[name][6]) for name in ("Electrical angle", "The same angle, mechanical"))
    assert electrical == pytest.approx(4 * mechanical, rel=1e-3)
    assert found["Electrical angle"][2] == "deg"
    assert float(found["Power loss per area, 0.9 m²"][7]) == 9
    assert any("by balance of heat at most" in name for name in found)
    assert not tables(report, "IACS UR M68")


@pytest.mark.slow
def test_gears_reverse_where_vibration_exceeds_the_mean():
    report = make_report("reciprocating_compressor_train", configurations=["full"], sections=["components"], date=None)
    (table,) = tables(report, "Components")
    row = next(row for row in rows(table) if "reversal" in row[1])
    check = tn.load("reciprocating_compressor_train").configured("full").check_limits("teeth").of("teeth", "hammer")
    assert float(row[8]) == pytest.approx(100 * np.nanmax(check.utilisation), rel=5e-3)


def test_no_limits_no_section():
    report = make_report("wind_turbine_3mw", kind="approval", sections=["components"], date=None)
    assert [one.name for one in report.sections] == []


def test_section_modulus_of_a_hollow_shaft():
    assert RoundSection(0.4, 0.2).modulus == pytest.approx(math.pi * (0.4**4 - 0.2**4) / 16 / 0.4)
