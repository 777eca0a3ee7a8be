"""Verdicts on measured orders beside calculated ones: made-up tests with known offset, delay, sign and intervals."""

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest
import scipy
from support.command_line import run
from support.twin_engines import plant

from torsionnet.machinery.orders.order_comparison import compared_orders, order_agreement, order_comparison
from torsionnet.machinery.orders.order_pair import OrderPair, common_turn
from torsionnet.signals.orders.differences import amplitude_scores, complex_scores
from torsionnet.signals.orders.tracked_orders import MeasuredOrder

RPM = np.pi / 30
SPEEDS = np.linspace(400, 800, 81) * RPM
WIDTH = 1.96 * 0.05  # half of the 95 % interval for a standard deviation of 0.05 of each part


def resonance(order, speeds=SPEEDS, at=600 * RPM, zeta=0.03):
    """Amplification of one mass on a spring, by hand."""
    ratio = np.asarray(speeds) / at
    return order / 6 / (1 - ratio**2 + 2j * zeta * ratio)


def noise(seed, shape=SPEEDS.shape, sigma=0.05):
    rng = np.random.default_rng(seed)
    return sigma * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))


def pair(test, model, order=6.0, width=WIDTH, phase=True, bound=False):
    widths = None if width is None else np.full(len(SPEEDS), width)
    measured, calculated = (test, model) if phase else (abs(test) + 0j, abs(model) + 0j)
    return OrderPair(order, SPEEDS, measured, calculated, phase, widths, SPEEDS, abs(model), bound)


class TestVerdict:
    def test_zero_of_the_angle_five_degrees_late(self):
        """phi of the test is phi - 5 degrees: X exp(j 6 phi) is read as X exp(+j 30 degrees)."""
        model = resonance(6)
        found = order_agreement(pair(model * np.exp(1j * np.radians(30)) + noise(1), model))
        assert found.verdict == "reference offset"
        assert math.degrees(found.offset) == pytest.approx(5, abs=0.05)
        assert re.search(r"the zero of the angle lies (4.9|5).* degrees later", found.sentence)
        assert found.phase_at_peak == pytest.approx(30, abs=1)
        assert found.phase_rms == pytest.approx(30, abs=1)

    def test_signal_two_milliseconds_late(self):
        """x(t - tau): order 6 at the speed Omega turns by -6 Omega tau."""
        model = resonance(6)
        test = model * np.exp(-6j * SPEEDS * 2e-3) + noise(2)
        found = order_agreement(pair(test, model))
        assert (found.verdict, found.delay) == ("time delay", pytest.approx(2e-3, rel=0.005))
        assert "ms late" in found.sentence

    def test_wrong_sign(self):
        found = order_agreement(pair(-resonance(6) + noise(3), resonance(6)))
        assert found.verdict == "wrong sign"
        assert abs(found.phase_at_peak) == pytest.approx(180, abs=2)

    def test_one_speed_tells_no_offset_from_a_delay(self):
        near = np.abs(SPEEDS - 600 * RPM) < 3 * RPM
        model = resonance(6)
        test = model * np.exp(1j * np.radians(30)) + noise(4)
        full = pair(test, model)
        found = order_agreement(
            OrderPair(6.0, SPEEDS[near], test[near], model[near], True, np.full(near.sum(), WIDTH), SPEEDS, abs(model))
        )
        assert found.verdict in ("offset or delay", "reference offset")
        assert order_agreement(full).verdict == "reference offset"

    def test_amplitudes_ten_percent_above(self):
        found = order_agreement(pair(1.1 * resonance(6) + noise(5), resonance(6)))
        assert (found.verdict, found.factor) == ("constant factor", pytest.approx(1.1, rel=0.002))
        assert found.peak == pytest.approx(10, abs=1)  # (measured - calculated)/calculated

    @pytest.mark.parametrize("phase", [True, False])
    def test_peak_at_another_speed(self, phase):
        found = order_agreement(pair(resonance(6, at=630 * RPM) + noise(6), resonance(6), phase=phase))
        assert found.verdict == "peak at another speed"
        assert found.sentence == "peak at 630 rpm instead of 600 rpm (+5 %)"

    def test_damping_twice_as_large_is_no_shift(self):
        found = order_agreement(pair(resonance(6, zeta=0.06) + noise(7), resonance(6)))
        assert found.verdict == "damping differs"
        assert found.peak == pytest.approx(-50, abs=1)
        height, width, damping = map(float, re.findall(r"[\d.]+", found.sentence))
        assert (height, width, damping) == pytest.approx((0.5, 2, 2), rel=0.05)

    def test_without_an_interval_nothing_agrees(self):
        found = order_agreement(pair(resonance(6) + noise(8), resonance(6), width=None))
        assert (found.verdict, found.intervals) == ("no interval", None)
        signs = order_agreement(pair(-resonance(6), resonance(6), width=None))
        assert signs.sentence.endswith("the signal has the opposite sign")

    @pytest.mark.parametrize(("factor", "verdict"), [(0.3, "within the bound"), (1.2, "above the bound")])
    def test_bound_counts_one_side_only(self, factor, verdict):
        found = order_agreement(pair(factor * resonance(6), resonance(6), phase=False, bound=True))
        assert found.verdict == verdict


class TestIntervals:
    @pytest.mark.parametrize("phase", [True, False])
    def test_a_true_model_agrees_in_95_of_100_tests(self, phase):
        """Independent errors; the amplitude passes through zero, where it is not normal."""
        model = resonance(6) - 1.0
        count = sum(order_agreement(pair(model + noise(k), model, phase=phase)).verdict == "agrees" for k in range(300))
        assert 0.92 * 300 <= count <= 0.98 * 300

    @pytest.mark.parametrize("phase", [True, False])
    @pytest.mark.parametrize(("calculated", "bound", "verdict"), [
        (1e-6, False, "not resolved"), (1e-6, True, "not resolved"), (0.03, False, "not resolved"), (0.0, False, "not resolved"),
        (5.0, True, "within the bound"), (5.0, False, "agrees"),
    ])  # fmt: skip
    def test_an_order_below_its_interval_is_not_resolved(self, phase, calculated, bound, verdict):
        """Noise alone, 95 % of it within 1.25 half widths, agrees with any model that has next to nothing there."""
        model = np.full(len(SPEEDS), calculated, dtype=complex)
        test = (model if verdict == "agrees" else 0.0) + noise(9)
        found = order_agreement(pair(test, model, phase=phase, bound=bound))
        assert found.verdict == verdict
        assert ("does not tell this order from zero" in found.sentence) == (
            verdict == "not resolved" and calculated > 0
        )

    def test_a_narrow_peak_is_resolved_though_most_speeds_are_not(self):
        model = resonance(6, zeta=0.002) * 1e-3
        assert np.sum(abs(model) > WIDTH) < 5
        assert order_agreement(pair(model + noise(1), model)).verdict == "agrees"

    def test_overlapping_windows_change_no_verdict(self):
        """Errors averaged over eight neighbours, as those of a tracker with a narrow band: fewer independent ones."""
        model, count = resonance(6), 0
        for seed in range(200):
            white = noise(seed, (len(SPEEDS) + 7,), 0.05 * np.sqrt(8))
            smooth = np.convolve(white, np.ones(8) / 8, mode="valid")
            count += order_agreement(pair(model + smooth, model)).verdict == "agrees"
        assert 0.9 * 200 <= count <= 0.995 * 200

    def test_distance_in_half_widths(self):
        """Of two normal parts, 95 % lie within sqrt(chi2_2(0.95))/1.96 = 1.249 half widths."""
        model = np.tile(resonance(6), 1)
        apart = np.concatenate([pair(model + noise(k), model).in_intervals for k in range(60)])
        assert np.mean(apart < np.sqrt(scipy.stats.chi2.ppf(0.95, 2)) / 1.96) == pytest.approx(0.95, abs=0.01)
        assert order_agreement(pair(model + noise(1), model)).intervals == pytest.approx(np.sqrt(2) / 1.96, rel=0.2)

    def test_scores_of_small_amplitudes_follow_the_rice_distribution(self):
        sizes = np.array([0.02, 0.05, 0.1, 0.2, 0.4])
        scores = amplitude_scores(sizes, np.full(5, 0.06), np.full(5, WIDTH))
        sigma = WIDTH / 1.959964
        below = scipy.stats.rice.cdf(sizes / sigma, 0.06 / sigma)
        assert scores[:4] == pytest.approx(scipy.stats.norm.ppf(below[:4]), abs=1e-6)

    @pytest.mark.parametrize("true", [10.5, 12.0, 30.0])
    def test_scores_of_large_amplitudes_are_nearly_those_of_rice(self, true):
        """The mean is about 1/(2 true) standard deviations above the true amplitude, 0.04 at 12."""
        sizes = true + np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
        expected = scipy.stats.norm.ppf(scipy.stats.rice.cdf(sizes, true))
        scores = amplitude_scores(0.05 * sizes, np.full(5, 0.05 * true), np.full(5, 0.05 * 1.959964))
        assert scores == pytest.approx(expected, abs=0.1 / true)

    def test_scores_of_complex_values(self):
        """Standard deviations of each part that the test lies away: half widths are 1.96 of them."""
        scores = complex_scores(np.array([3 + 1j, 1 - 2j]), np.array([1 + 1j, 1 + 2j]), np.array([1.959964, 3.919928]))
        assert scores == pytest.approx([2, -2j], abs=1e-5)


class TestSeveralOrders:
    def test_one_offset_explains_all_orders(self):
        """Order 6 alone leaves 5 and 65 degrees open; 4.5 and 6 together do not."""
        pairs = []
        for order in (4.5, 6.0, 7.5):
            model = resonance(order)
            pairs.append(pair(model * np.exp(1j * order * np.radians(65)) + noise(int(2 * order)), model, order))
        assert "the zero of the angle lies 65 degrees later" in common_turn(pairs)

    def test_one_delay_explains_all_orders(self):
        pairs = []
        for order in (4.5, 6.0, 7.5):
            model = resonance(order)
            pairs.append(pair(model * np.exp(1j * order * SPEEDS * 8e-3) + noise(int(2 * order)), model, order))
        assert "the signal comes 8 ms early" in common_turn(pairs)

    def test_nothing_to_explain(self):
        pairs = [pair(resonance(o) + noise(int(o)), resonance(o), o) for o in (3.0, 6.0)]
        assert common_turn(pairs) == ""


PLANT = """torsionnet: 1
name: two engines on a fan
elements:
  one: {type: inertia, node: a, inertia: 0.5 kg*m^2}
  shaft: {type: spring, nodes: [a, b], stiffness: 40 kN*m/rad, damping: 20 N*m*s/rad}
  two: {type: inertia, node: b, inertia: 2 kg*m^2}
speeds: {of: a, range: 300..900 rpm, step: 5 rpm}
excitations:
  pump: {type: harmonic, node: a, orders: {6: {amplitude: 20 N*m, phase: 40 deg}, 3: {amplitude: 10 N*m}}}
"""


def torque(rpm, order, size, degrees=0.0):
    s = 1j * order * np.asarray(rpm) * RPM
    kappa = 4e4 + 20 * s
    return kappa * size * np.exp(1j * np.radians(degrees)) / (0.5 * s**2) / (1 + kappa * (1 / 0.5 + 1 / 2) / s**2)


class TestCommand:
    def write(self, tmp_path, turn=0.0, header="phase [deg],half_width [N*m]"):
        (tmp_path / "plant.yaml").write_text(PLANT)
        lines = [f"speed [rpm],order,amplitude [N*m],{header}"]
        for order, size, phase in ((3, 10, 0), (6, 20, 40)):
            for rpm in np.arange(302, 898, 7):
                value = torque(rpm, order, size, phase) * np.exp(1j * order * np.radians(turn))
                lines.append(f"{rpm},{order},{abs(value)},{np.degrees(np.angle(value))},0.2")
        (tmp_path / "test.csv").write_text("\n".join(lines))

    def test_phase_and_interval_of_a_table(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        self.write(tmp_path)
        options = ["--output", "torque(shaft)", "--measured", "test.csv"]
        (found,) = json.loads(run("orders", "plant.yaml", *options, "--json").stdout)
        for row in found["outputs"][0]["measured"]:
            assert row["verdict"] == "agrees"
            assert np.abs(row["phases_deg"]).max() < 0.2
        self.write(tmp_path, turn=11.0)
        text = " ".join(run("orders", "plant.yaml", *options).stdout.split())
        assert text.count("reference offset") == 2
        assert (
            "all orders together: the zero of the angle lies 11 degrees later than in the calculation (or 120 degrees more)"
            in text
        )

    def test_half_width_of_another_unit_is_refused(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        self.write(tmp_path, header="phase [deg],half_width [rad]")
        options = ["--output", "torque(shaft)", "--measured", "test.csv"]
        assert "one of torque" in run("orders", "plant.yaml", *options, code=1).stderr


class TestBounds:
    def test_engines_at_unknown_angles_give_the_sum_of_magnitudes(self):
        """Order 1.5 of two engines; at a declared phase each engine's share is known."""
        found = plant().order_response("torque(sh)")
        known = plant(star=", phase: 0 deg").order_response("torque(sh)")
        sizes = sum(np.abs(known.of_order(1.5, excitation=name)) for name in ("port", "star"))
        test = MeasuredOrder(1.5, found.speeds, 0.99 * sizes, sizes.astype(complex), 0.001 * sizes)
        (pair,) = compared_orders(found, None, [test])
        assert pair.calculated == pytest.approx(sizes, rel=1e-9)
        assert (pair.pair.has_phase, pair.agreement.verdict) == (False, "within the bound")
        notes = " ".join(order_comparison(found, None, [test]).notes)
        assert "upper bounds, over the worst angle of star, and have no phase" in notes
        more = MeasuredOrder(1.5, found.speeds, 1.02 * sizes, None, 0.001 * sizes)
        assert compared_orders(found, None, [more])[0].agreement.verdict == "above the bound"

    def test_a_misfire_of_any_cylinder_has_no_phase(self):
        found = plant(star=", phase: 0 deg", port=", misfire: each").order_response("torque(sh)")
        singly = [
            plant(star=", phase: 0 deg", port=f", misfire: [{one}]").order_response("torque(sh)") for one in (1, 2, 3)
        ]
        largest = np.max([np.abs(one.of_order(0.5)) for one in singly], axis=0)
        (pair,) = compared_orders(found, None, [MeasuredOrder(0.5, found.speeds, largest, largest.astype(complex))])
        assert pair.calculated == pytest.approx(largest, rel=1e-9)
        assert not pair.pair.has_phase
        assert "over the worst of 3 cases" in " ".join(order_comparison(found, None, [pair.measured]).notes)


@pytest.mark.parametrize("phased", [True, False])
def test_an_order_whose_cylinders_cancel_is_zero(phased):
    """Order 0.5 of three cylinders that fire evenly: what rounding leaves is no share of anything."""
    found = plant(star=", phase: 0 deg", port=", misfire: [1]").order_response("torque(sh)")
    at = [number for number, line in enumerate(found.lines) if float(line.relative) == 0.5]
    assert at
    values = found.values.copy()
    values[:, at] *= 1e-15  # as a sum over cylinders that cancel
    cancelled = replace(found, values=values)
    size = np.ones(len(found.speeds))
    (one,) = compared_orders(
        cancelled, None, [MeasuredOrder(0.5, found.speeds, size, size.astype(complex) if phased else None, 0.1 * size)]
    )
    assert not one.calculated.any()
    assert math.isnan(one.agreement.peak)
    assert math.isnan(one.agreement.rms)
    assert one.agreement.sentence == "the calculated order is zero"
    shown = str(order_comparison(cancelled, None, [one.measured]))
    assert "e+1" not in shown
    assert "e+0" not in shown
