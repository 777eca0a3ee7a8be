"""Limits: permissible stresses against numbers worked out by hand, verdicts on responses made for the purpose."""

import csv
import json
import math
import re

import numpy as np
import pytest
from support.command_line import run
from support.limit_cases import RPM, STEEL, hump, m68, stressed
from support.ship_plant import PAGE_SHIP, SHIP

import torsionnet as tn
from torsionnet.machinery.limits.curve import crankshaft_throws
from torsionnet.machinery.limits.evidence import LimitSubject
from torsionnet.machinery.limits.iacs_m68 import IacsM68
from torsionnet.machinery.limits.m68_factors import permissible, size_factor, usual_range


class TestPermissibleStress:
    """IACS UR M68 for sigma_B = 600 N/mm^2, d = 400 mm."""

    @pytest.mark.parametrize(
        ("c_k", "ratio", "tau_c"), [(1, 0.5, 66.562), (0.55, 0.5, 36.609), (1, 1.0, 36.742), (1, 1.05, 36.742)]
    )
    def test_continuous_operation(self, c_k, ratio, tau_c):
        found = permissible(600e6, c_k * size_factor(0.4), np.array([ratio]))[0]
        assert found / 1e6 == pytest.approx(tau_c, abs=6e-4)

    def test_size_factor(self):
        assert size_factor(0.4) == pytest.approx(0.63059, abs=5e-6)

    @pytest.mark.parametrize(
        ("feature", "shaft", "tau_t"), [("integral_flange", "intermediate", 113.156), ("keyless", "propeller", 83.919)]
    )
    def test_passing(self, feature, shaft, tau_t):
        found = stressed(hump(10, 50), m68(feature=feature, shaft=shaft))["tau_T"]
        at = int(np.argmin(abs(np.arange(20.0, 104.01, 0.5) - 50)))
        assert found.allowed[at] / 1e6 == pytest.approx(tau_t, abs=1e-3)
        assert np.isnan(found.allowed[np.arange(20.0, 104.01, 0.5) > 80]).all()

    def test_barred_range(self):
        span = usual_range(50.0, 100.0)
        assert span.low / 50 == pytest.approx(0.91429, abs=5e-6)
        assert span.high / 50 == pytest.approx(1.09375, abs=5e-6)

    @pytest.mark.parametrize(
        ("shaft", "material", "given", "counts"),
        [("intermediate", "carbon", 700, 600), ("intermediate", "carbon_manganese", 700, 600),
         ("intermediate", "alloy", 900, 800), ("propeller", "alloy", 700, 600), ("thrust", "carbon", 450, 450)],
    )  # fmt: skip
    def test_tensile_strength_is_capped(self, shaft, material, given, counts):
        feature = {"intermediate": "shrink_fit", "propeller": "keyed", "thrust": "thrust_collar"}[shaft]
        limit = IacsM68(element="x", shaft=shaft, feature=feature, material=material, tensile_strength=given * 1e6)
        assert limit.strength == counts * 1e6

    @pytest.mark.parametrize(
        ("shaft", "feature", "c_k"),
        [("intermediate", "integral_flange", 1.0), ("intermediate", "shrink_fit", 1.0), ("intermediate", "tapered_keyway", 0.6),
         ("intermediate", "cylindrical_keyway", 0.45), ("intermediate", "radial_hole", 0.5), ("intermediate", "longitudinal_slot", 0.3),
         ("thrust", "thrust_collar", 0.85), ("thrust", "roller_bearing", 0.85), ("propeller", "flange", 0.55),
         ("propeller", "keyless", 0.55), ("propeller", "keyed", 0.55), ("propeller", "forward_of_aft_bearing", 0.8)],
    )  # fmt: skip
    def test_design_features(self, shaft, feature, c_k):
        assert IacsM68(element="x", shaft=shaft, feature=feature, **STEEL).feature_factor == c_k

    def test_a_slot_of_other_proportions(self):
        limit = IacsM68(element="x", shaft="intermediate", feature="longitudinal_slot", stress_concentration=5, **STEEL)
        assert limit.feature_factor == pytest.approx(1.45 / 5)

    def test_a_hollow_shaft_is_stressed_more_and_its_larger_end_counts(self):
        solid = stressed(hump(30, 50), m68())["tau_C"].values
        hollow = stressed(hump(30, 50), m68(diameter="400 mm", bore="200 mm"))["tau_C"].values
        assert hollow / solid == pytest.approx(1 / (1 - 0.5**4), rel=1e-12)
        assert solid.max() == pytest.approx(30e6, rel=1e-12)


class TestBarredRanges:
    def test_none_is_needed_below_tau_c(self):
        found = stressed(hump(60, 50), m68())
        assert {one.verdict for one in found.values()} == {"pass"}
        assert found["tau_C"].utilisation.max() == pytest.approx(60 / 66.562, rel=1e-3)

    def test_the_usual_range_around_the_critical_speed(self):
        found = stressed(hump(90, 50), m68())
        (span,) = found["tau_C"].barred
        assert found["tau_C"].verdict == "barred range"
        assert found["tau_T"].verdict == "pass"
        assert (span.low / RPM, span.high / RPM) == pytest.approx((0.91429 * 50, 1.09375 * 50), abs=1e-3)

    def test_wider_where_tau_c_is_exceeded_beyond_it(self):
        stress = hump(100, 50, width=8)
        (span,) = stressed(stress, m68())["tau_C"].barred
        tau = lambda rpm: float(permissible(600e6, size_factor(0.4), np.array([rpm / 100]))[0] / 1e6)  # noqa: E731
        assert stress(span.low / RPM) == pytest.approx(tau(span.low / RPM), rel=2e-3)
        assert stress(span.high / RPM) == pytest.approx(tau(span.high / RPM), rel=2e-3)
        assert span.low < 0.91429 * 50 * RPM

    def test_wider_by_the_tolerance_of_the_tachometer(self):
        (without,) = stressed(hump(90, 50), m68())["tau_C"].barred
        (with_it,) = stressed(hump(90, 50), m68(tachometer_tolerance="2 %"))["tau_C"].barred
        assert with_it.low == pytest.approx(0.98 * without.low)
        assert with_it.high == pytest.approx(1.02 * without.high)

    def test_too_much_for_passing_fails(self):
        found = stressed(hump(130, 50), m68())
        assert found["tau_T"].verdict == "fail"
        assert found["tau_C"].verdict == "barred range"

    def test_none_above_0_8_in_normal_firing(self):
        found = stressed(hump(70, 88), m68())["tau_C"]
        assert found.verdict == "fail"
        assert "above lambda = 0.8" in found.remarks[0]

    def test_the_rule_of_thumb_stops_at_0_8(self):
        found = stressed(hump(60, 76, width=1), m68())["tau_C"]
        (span,) = found.barred
        assert found.verdict == "barred range"
        assert span.high == pytest.approx(80 * RPM)
        assert usual_range(76, 100).high > 80

    def test_misfiring_it_may_be_above_where_navigation_stays_safe(self):
        stress = hump(70, 88)
        assert stressed(stress, m68(), misfire=True)["tau_C"].verdict == "barred range"
        assert "safe_speed" in stressed(stress, m68(), misfire=True)["tau_C"].remarks[0]
        assert stressed(stress, m68(safe_speed="70 rpm"), misfire=True)["tau_C"].verdict == "barred range"
        lost = stressed(stress, m68(safe_speed="88 rpm"), misfire=True)["tau_C"]
        assert lost.verdict == "fail"
        assert "safe_speed" in lost.remarks[0]

    def test_speeds_up_to_rated_that_nobody_looked_at_are_named(self):
        found = stressed(hump(10, 50), m68(), rpm=np.arange(20.0, 80.1, 0.5))["tau_C"]
        assert found.verdict == "pass"
        assert "speeds examined end at lambda = 0.8: nothing is said" in found.remarks[0]
        assert stressed(hump(10, 50), m68())["tau_C"].remarks == ()

    def test_safe_navigation_at_a_speed_that_is_not_examined(self):
        """No barred range could ever hold it."""
        with pytest.raises(tn.ModelError, match=r"limits\.shaft\.safe_speed: .*180.*20.*out-of-range"):
            stressed(hump(70, 88), m68(safe_speed="180 rpm"), misfire=True)
        for end in ("20 rpm", "104 rpm"):
            assert "tau_C" in stressed(hump(70, 88), m68(safe_speed=end), misfire=True)

    def test_above_1_05_nothing_is_judged_and_that_is_said(self):
        found = stressed(hump(500, 110, width=0.5), m68(), rpm=np.arange(60.0, 115.01, 0.5))["tau_C"]
        assert found.verdict == "pass"
        assert any(
            "speeds from 105.5 to 115 rpm: lambda above 1.05 is not covered" in remark for remark in found.remarks
        )

    def test_keyways_and_weak_steel_are_remarked_on(self):
        found = stressed(hump(60, 50), m68(feature="tapered_keyway", material="carbon", tensile_strength="450 MPa"))
        assert any("keyways" in remark for remark in found["tau_C"].remarks)
        assert any("500 N/mm^2" in remark for remark in found["tau_C"].remarks)

    def test_a_sharp_peak_is_remarked_on(self):
        found = stressed(hump(60, 50, width=0.3), m68())["tau_C"]
        assert any("smaller step" in remark for remark in found.remarks)

    def test_every_verdict_names_its_source_and_what_it_leaves_out(self):
        text = stressed(hump(60, 50), m68())["tau_C"].text
        assert "IACS UR M68" in text.source
        assert "2025" in text.source
        assert "C_D = 0.63059" in text.formula
        assert "1.05" in text.not_covered


def two_masses(limits, damping=40.0, load=True, more=(), **entries):
    """A motor that shakes, a coupling, a gear and a fan; its first critical speed of order 2 is near 600 r/min."""
    elements = [
        tn.Inertia("motor", node="a", inertia=1.0),
        tn.HystereticSpring("rubber", nodes=("a", "b"), stiffness=20e3, loss_factor=0.15),
        tn.Gear("mesh", nodes=("b", "c"), ratio=-2),
        tn.Inertia("wheel", node="c", inertia=2.0),
        tn.Shaft("shaft", nodes=("c", "d"), outer_diameter="60 mm", length="1 m", inertia="none"),
        tn.Inertia("fan", node="d", inertia=6.0),
        tn.Damper("air", nodes=("d", "ground"), damping=damping),
        tn.ViscousDamper("nose", node="a", ring_inertia=0.3, damping=20),
        *more,
    ]
    given = (
        {"load": {"absorbed_at": "d", "power": "100 kW", "torque_exponent": 2, "driven_by": {"a": 1}}} if load else {}
    )
    return tn.Drivetrain(
        "two masses", elements, speeds={"of": "a", "range": "300..1500 rpm", "step": "5 rpm", "rated": "1500 rpm"},
        excitations={"motor": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": 100}, 2: {"amplitude": 250}}}},
        limits=limits, **given, **entries,
    )  # fmt: skip


class TestOtherRules:
    def test_coupling_torques_and_heat(self):
        limits = {"rubber": {"rule": "coupling", "element": "rubber", "T_KN": "700 N*m", "T_Kmax": 5e3, "T_KW": 600,
                             "P_KV": "2 kW", "vibratory_twist": "5 deg", "twist": "20 deg"}}  # fmt: skip
        rig = two_masses(limits)
        check = rig.check_limits()
        run_, mean = (
            rig.order_response(["torque(rubber)", "twist(rubber)"], speeds=check.speeds),
            rig.mean_response("torque(rubber)", speeds=check.speeds),
        )
        half = run_.half_range
        of = lambda criterion: check.of("rubber", criterion)  # noqa: E731
        assert of("T_KN").values == pytest.approx(abs(mean.values[:, 0]))
        assert of("T_Kmax").values == pytest.approx(abs(mean.values[:, 0]) + half[:, 0])
        assert of("T_KW").values == pytest.approx(half[:, 0])
        assert of("vibratory twist").values == pytest.approx(half[:, 1])
        assert of("P_KV").values == pytest.approx(rig.dissipated_power("rubber", speeds=check.speeds).of("rubber"))
        assert of("twist").values.max() > of("vibratory twist").values.max()
        assert "whole torque" in of("P_KV").text.formula
        # 100 kW at 1500 r/min are 636.6 N m
        assert of("T_KN").values[-1] == pytest.approx(100e3 / (1500 * RPM))
        assert of("T_KN").verdict == "pass"

    def test_din_740_2_weighs_orders_above_10_hz(self):
        entry = {"rule": "coupling", "element": "rubber", "T_KW": 600}
        rig = two_masses({"plain": entry, "din": {**entry, "frequency_factor": "din_740_2"}})
        check = rig.check_limits()
        run_ = rig.order_response("torque(rubber)", speeds=check.speeds)
        weighted = run_.values[:, :, 0] * np.sqrt(np.maximum(run_.frequencies, 10) / 10)
        wave = np.real(weighted @ np.exp(1j * np.outer([1, 2], np.linspace(0, 2 * np.pi, 2001))))
        assert check.of("din").values == pytest.approx(np.ptp(wave, axis=1) / 2, rel=1e-4)
        assert (check.of("din").values > 1.2 * check.of("plain").values)[-1]
        assert "DIN 740-2" in check.of("din").text.formula
        assert "DIN" not in check.of("plain").text.formula

    def test_speeds_are_to_be_barred_where_vibratory_torque_is_too_large(self):
        check = two_masses({"rubber": {"rule": "coupling", "element": "rubber", "T_KW": 600}}).check_limits()
        found = check.of("rubber")
        assert found.verdict == "barred range"
        (span,) = found.barred
        inside = (check.speeds > span.low) & (check.speeds < span.high)
        assert (found.values[inside] > 600).all()
        assert (found.values[~inside] <= 600).all()
        assert check.barred == found.barred

    def test_the_rated_speed_cannot_be_barred(self):
        table = {"300 rpm": "100 kN*m", "1400 rpm": "100 kN*m", "1500 rpm": "10 N*m"}
        limits = {"top": {"rule": "curve", "output": "torque(rubber)", "over_speed": table, "source": "maker"}}
        found = two_masses(limits).check_limits().of("top")
        assert found.verdict == "fail"
        assert "no range to be barred" in found.remarks[0]
        assert not found.barred

    def test_nor_can_all_speeds(self):
        entry = {"rule": "coupling", "element": "rubber", "T_KW": 1}
        assert two_masses({"rubber": entry}).check_limits().of("rubber").verdict == "fail"

    def test_factors_for_temperature(self):
        entry = {"rule": "coupling", "element": "rubber", "T_KW": 600, "P_KV": 1000, "torque_temperature_factor": 1.4,
                 "power_temperature_factor": 0.7}  # fmt: skip
        check = two_masses({"rubber": entry}).check_limits()
        assert check.of("rubber", "T_KW").allowed[0] == pytest.approx(600 / 1.4)
        assert check.of("rubber", "P_KV").allowed[0] == pytest.approx(700)

    def test_orders_are_those_of_the_worst_case_at_each_speed(self):
        """A case has one order, whose amplitude is its half range."""
        rpm = np.arange(20.0, 104.01, 2)
        cases = np.stack([hump(92, 51.2)(rpm), hump(75, 70)(rpm)], axis=1)
        for limit, name in (({"rule": "coupling", "element": "shaft", "T_KW": 1e9}, "T_KW"), (m68(), "tau_C")):
            found = stressed(lambda _: cases.max(axis=1), limit, rpm, misfire=True, cases=cases)[name]
            assert np.abs(found.amplitudes.phasors[:, 0]) == pytest.approx(found.values)
            assert set(found.amplitudes.cases) == {0, 1}

    def test_without_load_what_needs_mean_torque_is_not_judged(self):
        limits = {"rubber": {"rule": "coupling", "element": "rubber", "T_KN": 1e3, "T_KW": 1e5},
                  "mesh": {"rule": "gear", "element": "mesh", "vibratory_share": "30 %"}}  # fmt: skip
        check = two_masses(limits, load=False).check_limits()
        assert check.of("rubber", "T_KN").verdict == "not judged"
        assert "load:" in check.of("rubber", "T_KN").remarks[0]
        assert check.of("rubber", "T_KW").verdict == "pass"
        assert {check.of("mesh", criterion).verdict for criterion in ("T_v", "hammer")} == {"not judged"}
        assert check.verdict == "not judged"

    def test_gears_hammer_where_torque_reverses(self):
        rig = two_masses({"mesh": {"rule": "gear", "element": "mesh", "at": "c", "vibratory_share": "30 %"}})
        check = rig.check_limits()
        hammer, share = check.of("mesh", "hammer"), check.of("mesh", "T_v")
        mean = abs(rig.mean_response("torque(mesh, c)", speeds=check.speeds).values[:, 0])
        half = rig.order_response("torque(mesh, c)", speeds=check.speeds).half_range[:, 0]
        above = half > mean
        assert above.any()
        inside = np.any([(check.speeds >= one.low) & (check.speeds <= one.high) for one in hammer.barred], axis=0)
        assert (inside == above).all()
        # 100 kW at 750 r/min of the wheel
        assert share.allowed == pytest.approx(0.3 * 100e3 / (750 * RPM))

    def test_a_damper_by_power_per_area_and_twist(self):
        entry = {
            "rule": "damper",
            "element": "nose",
            "power_per_area": "5 kW/m^2",
            "area": "0.2 m^2",
            "vibratory_twist": "2 deg",
        }
        rig = two_masses({"nose": entry})
        check = rig.check_limits()
        assert check.of("nose", "P").allowed[0] == pytest.approx(1000)
        rate = rig.order_response("twist(nose)", speeds=check.speeds)
        gamma = 2 * math.pi * rate.frequencies * abs(rate.values[:, :, 0])
        assert check.of("nose", "P").values == pytest.approx(20 * (gamma**2).sum(axis=1) / 2, rel=1e-6)
        assert check.of("nose", "vibratory twist").values == pytest.approx(rate.half_range[:, 0])

    def test_flicker_in_electrical_degrees(self):
        rig = two_masses({"rotor": {"rule": "machine_angle", "node": "a", "pole_pairs": 4, "angle": "3.5 deg"}})
        check = rig.check_limits()
        found = check.of("rotor")
        assert found.values == pytest.approx(4 * rig.order_response("angle(a)", speeds=check.speeds).half_range[:, 0])
        assert found.allowed[0] == pytest.approx(math.radians(3.5))

    @pytest.mark.parametrize("mean_stress", ["goodman", "haigh", "none"])
    def test_fatigue(self, mean_stress):
        entry = {"rule": "fatigue", "element": "shaft", "fatigue_strength": "150 MPa", "stress_concentration": 1.6,
                 "mean_stress": mean_stress, "ultimate_strength": "420 MPa", "mean_sensitivity": 0.2, "safety": 1.5,
                 "cycles": 2e5, "slope": 5, "yield_strength": "250 MPa"}  # fmt: skip
        rig = two_masses({"shaft": entry})
        check = rig.check_limits()
        mean = abs(rig.mean_response("stress(shaft)", speeds=check.speeds).values[:, 0])
        tau_w = 150e6 * 10 ** (1 / 5)
        expected = {"goodman": tau_w * (1 - mean / 420e6), "haigh": tau_w - 0.2 * mean, "none": tau_w}[mean_stress]
        assert check.of("shaft", "tau_W").allowed == pytest.approx(expected / 1.6 / 1.5 + 0 * mean)
        half = rig.order_response("stress(shaft)", speeds=check.speeds).half_range[:, 0]
        assert check.of("shaft", "tau_W").values == pytest.approx(half)
        assert check.of("shaft", "tau_F").values == pytest.approx(mean + half)
        safety = np.min(expected / 1.6 / half)
        assert f"safety against fatigue {safety:.3g}" in check.of("shaft", "tau_W").remarks

    def test_a_spring_with_a_diameter_given_by_the_limit(self):
        entry = {
            "rule": "fatigue",
            "element": "rubber",
            "diameter": "50 mm",
            "fatigue_strength": "150 MPa",
            "mean_stress": "none",
        }
        rig = two_masses({"rubber": entry})
        check = rig.check_limits()
        half = rig.order_response("torque(rubber)", speeds=check.speeds).half_range[:, 0]
        assert check.of("rubber").values == pytest.approx(half * 16 / (math.pi * 0.05**3))

    def test_curves_over_speed_and_speed_ratio(self):
        limits = {
            "one": {"rule": "curve", "output": "torque(rubber)", "value": "2 kN*m", "source": "maker"},
            "speed": {"rule": "curve", "output": "torque(rubber)", "source": "maker", "transient_factor": 1.5,
                      "over_speed": {"300 rpm": "2 kN*m", "1500 rpm": "1 kN*m"}},
            "ratio": {"rule": "curve", "output": "stress(shaft)", "source": "maker",
                      "over_lambda": {0.2: "60 MPa", 1: "30 MPa"}},
        }  # fmt: skip
        check = two_masses(limits).check_limits()
        assert check.of("one").allowed == pytest.approx(2000.0 + 0 * check.speeds)
        assert check.of("speed", "continuous").allowed == pytest.approx(2000 - 1000 * (check.rpm - 300) / 1200)
        assert check.of("speed", "in passing").allowed == pytest.approx(3000 - 1500 * (check.rpm - 300) / 1200)
        assert check.of("ratio").allowed == pytest.approx(60e6 - 30e6 * (check.rpm / 1500 - 0.2) / 0.8)

    def test_each_order_alone(self):
        entry = {
            "rule": "curve",
            "output": "torque(rubber)",
            "value": "2 kN*m",
            "source": "maker",
            "measure": "each_order",
        }
        rig = two_masses({"all": entry, "first": {**entry, "orders": [1]}})
        check = rig.check_limits()
        amplitudes = abs(rig.order_response("torque(rubber)", speeds=check.speeds).values[:, :, 0])
        assert check.of("all").values == pytest.approx(amplitudes.max(axis=1))
        assert check.of("first").values == pytest.approx(amplitudes[:, 0])

    def test_outside_of_a_table_nothing_is_judged_and_that_is_said(self):
        entry = {
            "rule": "curve",
            "output": "torque(rubber)",
            "source": "maker",
            "over_speed": {"900 rpm": 1000, "1200 rpm": 500},
        }
        rig = two_masses({"part": entry})
        found = rig.check_limits().of("part")
        assert np.isfinite(found.allowed).sum() == 61
        assert "judged from 900 to 1200 rpm; the rest is outside of the table" in found.remarks
        (told,) = [fault for fault in rig.check() if fault.kind == "beyond-table"]
        assert re.search("900 to 1200 rpm, .* 300 to 1500 rpm", str(told))
        assert (told.path, told.on_key) == (("limits", "part", "over_speed"), True)

    def test_what_is_switched_off_is_not_judged(self):
        limits = {"rubber": {"rule": "coupling", "element": "rubber", "T_KW": 600},
                  "brake": {"rule": "curve", "output": "torque(brake)", "value": 1e3, "source": "maker"}}  # fmt: skip
        rig = two_masses(limits, more=[tn.Spring("brake", nodes=("a", "ground"), stiffness=1e3, enabled=False)])
        found = rig.check_limits().of("brake")
        assert found.verdict == "not judged"
        assert "switched off" in found.remarks[0]

    def test_names_of_limits_are_checked(self):
        rig = two_masses({"rubber": {"rule": "coupling", "element": "rubber", "T_KW": 600, "P_KV": 100}})
        with pytest.raises(tn.UsageError, match=r'(?s)did you mean "rubber".*unknown-name'):
            rig.check_limits("ruber")
        with pytest.raises(tn.UsageError, match="say which criterion"):
            rig.check_limits("rubber").of("rubber")
        with pytest.raises(tn.UsageError, match="missing-entry"):
            two_masses({}).check_limits()


BASE = """\
torsionnet: 1
name: shaft
elements:
  motor: {type: inertia, node: a, inertia: 2}
  shaft: {type: shaft, nodes: [a, b], outer_diameter: 100 mm, length: 1 m}
  spring: {type: spring, nodes: [b, c], stiffness: 1e5}
  load: {type: inertia, node: c, inertia: 3}
speeds: {of: a, range: 300..800 rpm, step: 10 rpm, rated: 750 rpm}
excitations: {fan: {type: harmonic, node: c, orders: {2: {amplitude: 10}}}}
limits:
"""
M68 = "shaft: intermediate, feature: integral_flange, material: carbon, tensile_strength: 560 MPa"


@pytest.mark.parametrize(
    ("entry", "kind"),
    [
        (f"{{rule: iacs_m86, element: shaft, {M68}}}", "unknown-word"),
        (f"{{element: shaft, {M68}}}", "missing-entry"),
        (f"{{rule: iacs_m68, element: shafft, {M68}}}", "unknown-element"),
        (f"{{rule: iacs_m68, element: spring, {M68}}}", "not-applicable"),
        (f"{{rule: iacs_m68, element: shaft, {M68.replace('flange', 'flang')}}}", "unknown-word"),
        (f"{{rule: iacs_m68, element: shaft, {M68.replace('integral_flange', 'keyless')}}}", "unfit-rule"),
        (f"{{rule: iacs_m68, element: shaft, {M68.replace('carbon', 'karbon')}}}", "unknown-word"),
        (f"{{rule: iacs_m68, element: shaft, {M68.replace('560 MPa', '560')}}}", "unfit-rule"),
        (f"{{rule: iacs_m68, element: shaft, {M68.replace('560', '800')}}}", "unfit-rule"),
        (f"{{rule: iacs_m68, element: shaft, {M68.replace('560 MPa', '560 kN')}}}", "wrong-unit"),
        (f"{{rule: iacs_m68, element: shaft, {M68}, hole_diameter: 10 mm}}", "needless-entry"),
        (f"{{rule: iacs_m68, element: shaft, {M68}, bore: 90 mm, diameter: 80 mm}}", "contradicting-values"),
        ("{rule: coupling, element: spring}", "missing-entry"),
        ("{rule: coupling, element: spring, T_KV: 10}", "unknown-entry"),
        ("{rule: coupling, element: spring, P_KV: 1.2 kN*m}", "wrong-unit"),
        ("{rule: gear, element: shaft, at: x, vibratory_share: 30 %}", "unknown-word"),
        ("{rule: gear, element: shaft, hammer: false}", "missing-entry"),
        ("{rule: damper, element: spring, power_per_area: 5 kW/m^2}", "missing-entry"),
        ("{rule: machine_angle, node: q, pole_pairs: 2, angle: 3 deg}", "unknown-node"),
        ("{rule: fatigue, element: shaft, fatigue_strength: 150 MPa}", "missing-entry"),
        ("{rule: fatigue, element: shaft, fatigue_strength: 150 MPa, mean_stress: none, cycles: 1e5}", "missing-entry"),
        ("{rule: curve, output: torque(shaft), source: x}", "missing-entry"),
        ("{rule: curve, output: torque(shaft), value: 40 MPa, source: x}", "wrong-unit"),
        ("{rule: curve, output: torque(shaft), value: 40}", "missing-entry"),
        ("{rule: curve, output: torque(shafft), value: 40, source: x}", "unknown-element"),
        ("{rule: curve, output: stress(spring), value: 40, source: x}", "missing-entry"),
        ("{rule: curve, output: torque(shaft), over_speed: {300 rpm: 1}, source: x}", "wrong-form"),
        ("{rule: curve, output: torque(shaft), over_speed: {300 mm: 1, 400 rpm: 2}, source: x}", "wrong-unit"),
    ],
)  # fmt: skip
def test_wrong_limits_are_named_with_their_place(entry, kind):
    with pytest.raises(tn.ModelError, match=f"<text>:11:.*{kind}"):
        tn.loads(f"{BASE}  wrong: {entry}\n")


def test_a_limit_without_its_rule_is_marked_at_its_name():
    with pytest.raises(tn.ModelError, match=r":11:3: .*missing-entry"):
        tn.loads(f"{BASE}  wrong: {{element: shaft}}\n")


def test_lines_of_fatigue_begin_at_a_thousand_cycles():
    entry = "{rule: fatigue, element: shaft, fatigue_strength: 150 MPa, mean_stress: none, slope: 5, cycles: %d}"
    tn.loads(f"{BASE}  few: {entry % 1000}\n")
    with pytest.raises(tn.ModelError, match="1000"):
        tn.loads(f"{BASE}  few: {entry % 999}\n")


def test_lambda_needs_a_rated_speed():
    text = BASE.replace(", rated: 750 rpm", "")
    for entry in (f"{{rule: iacs_m68, element: shaft, {M68}}}", "{rule: gear, element: shaft, vibratory_share: 30 %}",
                  "{rule: curve, output: torque(shaft), over_lambda: {0: 1, 2: 1}, source: x}"):  # fmt: skip
        with pytest.raises(tn.ModelError, match="<text>:11:") as caught:
            tn.loads(f"{text}  wrong: {entry}\n")
        assert "rated" in str(caught.value)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("feature: longitudinal_slot, slot_length: 85 mm", "length/d < 0.8"),
        ("feature: longitudinal_slot, slot_width: 14 mm", "width/d > 0.15"),
        ("feature: radial_hole, hole_diameter: 31 mm", "up to 0.3 d"),
    ],
)
def test_holes_and_slots_beyond_the_footnotes_have_another_factor(more, message):
    text = M68.replace("feature: integral_flange", more)
    with pytest.raises(tn.ModelError, match="<text>:11:") as caught:
        tn.loads(f"{BASE}  slot: {{rule: iacs_m68, element: shaft, {text}}}\n")
    assert message in str(caught.value)
    if "slot" in more:
        text = text.replace("slot_", "stress_concentration: 4.8, slot_")
        tn.loads(f"{BASE}  slot: {{rule: iacs_m68, element: shaft, {text}}}\n")


def test_a_slot_that_becomes_too_long_in_a_configuration_is_not_judged():
    text = BASE.replace("100 mm", "d").replace("elements:", "parameters: {d: 120 mm}\nelements:")
    limit = M68.replace("integral_flange", "longitudinal_slot, slot_length: 85 mm, slot_width: 20 mm")
    rig = tn.loads(
        f"{text}  slot: {{rule: iacs_m68, element: shaft, {limit}}}\nconfigurations: {{thin: {{d: 100 mm}}}}\n"
    )
    assert rig.check_limits().of("slot", "tau_C").verdict == "pass"
    found = rig.configured("thin").check_limits().of("slot")
    assert found.verdict == "not judged"
    assert "length/d < 0.8" in found.remarks[0]


def test_limits_are_written_as_they_were_read():
    rig = tn.loads(SHIP)
    again = tn.loads(json.dumps(rig.definition.to_data()))
    assert again.definition.limits == rig.definition.limits
    assert again.configured("normal").check_limits().barred == rig.configured("normal").check_limits().barred


class TestThrows:
    """A maker's torque is judged in every throw of its crankshaft, each against the order response there."""

    THROWS = ("k12", "k23", "k34", "k45", "k56", "k6f")

    def test_the_largest_of_all_throws_counts_and_is_named(self):
        ship = tn.loads(SHIP).configured("normal")
        found = ship.check_limits("crank", refine=False).of("crank")
        run = ship.order_response([f"torque({name})" for name in self.THROWS], speeds=found.speeds)
        assert found.values == pytest.approx(run.half_range.max(axis=1), rel=1e-9)
        most = self.THROWS[int(run.half_range[found.worst].argmax())]
        assert found.of == f"torque({most})" != "torque(k6f)"
        assert found.orders == pytest.approx(run.sizes.max(axis=2), rel=1e-9, abs=1e-6)

    def test_one_throw_alone_where_the_author_says_so(self):
        text = SHIP.replace("output: torque(k6f),", "output: torque(k6f), throws: one,")
        ship = tn.loads(text).configured("normal")
        found = ship.check_limits("crank", refine=False).of("crank")
        run = ship.order_response("torque(k6f)", speeds=found.speeds)
        assert found.values == pytest.approx(run.half_range[:, 0], rel=1e-9)
        assert found.of == "torque(k6f)"

    def test_another_crankshaft_and_other_outputs_have_limits_of_their_own(self):
        """Four cylinders on two shafts: c1 to c3 and d1 to d2, both on the wheel."""
        springs = {"a": "c1, c2", "b": "c2, c3", "flange": "c3, w", "e": "d1, d2", "other": "d2, w", "out": "w, p"}
        elements = [tn.Spring(name, nodes=tuple(nodes.split(", ")), stiffness=1) for name, nodes in springs.items()]
        active = {one.name: one for one in elements}
        nodes = tuple(dict.fromkeys(node for one in elements for node in one.ports.values()))
        cranks = frozenset({"c1", "c2", "c3", "d1", "d2"})
        view = LimitSubject(active, active, nodes, nodes, {}, (), None, False, {}, cranks=cranks)
        assert crankshaft_throws(view, "a") == ["a", "b"]
        assert crankshaft_throws(view, "flange") == ["a", "b", "flange"]
        assert crankshaft_throws(view, "other") == ["e", "other"]
        assert crankshaft_throws(view, "out") == []


@pytest.mark.slow
def test_a_misfire_of_each_cylinder_is_judged_by_the_worst_of_them():
    """Torque, weighted torque and heat against every cylinder alone."""
    more = """\
  weighted: {rule: coupling, element: k6f, T_KW: 2 MN*m, P_KV: 20 kW, frequency_factor: din_740_2}
  single: {rule: curve, output: torque(k6f), value: 2 MN*m, measure: each_order, source: maker}
"""
    text = SHIP.replace("engine.misfire: [2]", "engine.misfire: each").replace("limits:\n", f"limits:\n{more}")
    text = text.replace("step: 1 rpm", "step: 2 rpm")
    worst = tn.loads(text).configured("misfire").check_limits(refine=False)
    alone = [
        tn.loads(text.replace("misfire: each", f"misfire: [{number}]")).configured("misfire").check_limits(refine=False)
        for number in range(1, 7)
    ]
    for place, one in enumerate(worst.verdicts):
        expected = np.max([check.verdicts[place].values for check in alone], axis=0)
        assert one.values == pytest.approx(expected, rel=1e-9), one.criterion
    assert worst.misfiring
    assert any(re.search(r"worst at [\d.]+ rpm: .*cylinder [1-6]", remark) for remark in worst.of("crank").remarks)


class TestShip:
    """From the model file to a verdict on barred ranges with two commands."""

    @pytest.fixture(scope="class")
    @staticmethod
    def folder(tmp_path_factory):
        folder = tmp_path_factory.mktemp("ship")
        (folder / "ship.yaml").write_text(SHIP, encoding="utf-8")
        (folder / "page.yaml").write_text(PAGE_SHIP, encoding="utf-8")
        return folder

    def test_two_commands(self, folder):
        assert run("check", folder / "page.yaml").exit_code == 0
        found = run("limits", folder / "page.yaml", "-c", "all", "--csv", folder / "all.csv")
        assert found.exit_code == 0, found.output
        assert "normal: limits hold with 46 to 57 rpm of fly barred" in found.output
        last = found.stdout.splitlines()[-1]
        assert last.startswith("direct-drive ship, six-cylinder two-stroke engine: barred range: starts and stops not")
        assert "; limits hold with 46 to 57 rpm" in last
        assert "IACS UR M68" in found.output
        lines = (folder / "all.csv").read_text(encoding="utf-8").splitlines()
        rows = list(csv.reader(line for line in lines if line[0] != "#"))
        assert rows[0][:5] == ["configuration", "limit", "of", "criterion", "speed [rpm]"]
        assert 1 + 2 * 5 * 313 < len(rows) < 1 + 2 * 5 * 2 * 313

    def test_the_peak_is_that_of_the_order_response(self, folder):
        rig = tn.load(folder / "ship.yaml").configured("normal")
        check = rig.check_limits()
        tau = check.of("intermediate", "tau_C")
        wanted = ["stress(int_shaft, fly)", "stress(int_shaft, flange)"]
        ends = rig.order_response(wanted, speeds=check.speeds).half_range
        assert tau.values == pytest.approx(ends.max(axis=1), rel=1e-12)

    def test_a_limit_that_fails_gives_exit_code_5(self, folder):
        text = SHIP.replace("0.2: 1500 kN*m, 1.05: 900 kN*m", "0.2: 150 kN*m, 1.05: 90 kN*m")
        (folder / "weak.yaml").write_text(text, encoding="utf-8")
        found = run("limits", folder / "weak.yaml", "-c", "normal", code=5)
        assert "crank do not hold" in found.output

    def test_json_of_one_limit(self, folder):
        found = json.loads(
            run("limits", folder / "ship.yaml", "-c", "misfire", "--limit", "crank", "--json", code=6).stdout
        )
        assert found[0]["misfiring"] is True
        assert [one["limit"] for one in found[0]["limits"]] == ["crank"]
        assert found[0]["limits"][0]["source"] == "letter of the maker"

    @pytest.mark.slow
    def test_the_picture_has_limit_lines_and_shaded_ranges(self, folder):
        from torsionnet.plot import limit_check as drawn

        figure = drawn(tn.load(folder / "ship.yaml").configured("normal").check_limits())
        first, _, last = figure.axes
        labels = first.get_legend_handles_labels()[1]
        assert {"all orders", "engine 6", "tau_C", "tau_T", "to be barred"} <= set(labels)
        assert "to be barred" not in last.get_legend_handles_labels()[1]
        assert first.get_ylabel() == "nominal shear stress, half range\n[N/mm²]"
        with pytest.raises(tn.UsageError, match='no limit "x"'):
            drawn(tn.load(folder / "ship.yaml").configured("normal").check_limits(), "x")
