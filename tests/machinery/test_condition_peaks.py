"""Peaks of a condition against closed forms: modes, generalised forces and amplitudes of a small plant by hand.

Three equal discs on two equal springs, free: modes (1, 0, -1) with omega^2 = k/J and (1, -2, 1) with 3 k/J.
"""

import math

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.units import RPM
from torsionnet.machinery.verdicts.condition_peaks import condition_peaks
from torsionnet.machinery.verdicts.order_peaks import largest_orders, local_maxima

J, K, C = 2.0, 2e4, 4.0
"""Inertia of each disc in kg m^2, stiffness in N m/rad and damping in N m s/rad of each spring."""
TORQUES = {1: (30.0, 0.0), 2: (20.0, 90.0), 3: (5.0, -90.0)}
"""Amplitude in N m and phase in degrees of order 2 on each disc."""
PLANT = f"""
torsionnet: 1
name: three discs
elements:
  one: {{type: inertia, node: a, inertia: {J}}}
  two: {{type: inertia, node: b, inertia: {J}}}
  three: {{type: inertia, node: c, inertia: {J}}}
  first: {{type: spring, nodes: [a, b], stiffness: {K}, damping: {C}}}
  second: {{type: spring, nodes: [b, c], stiffness: {K}, damping: {C}}}
speeds: {{of: a, range: 300..1000 rpm, step: 20 rpm, rated: 910 rpm}}
excitations:
  here: {{type: harmonic, node: a, orders: {{2: {{amplitude: 30}}, 1: {{amplitude: 400}}}}}}
  there: {{type: harmonic, node: b, orders: {{2: {{amplitude: 20, phase: 90 deg}}}}}}
  end: {{type: harmonic, node: c, orders: {{2: {{amplitude: 5, phase: -90 deg}}}}}}
limits:
  first: {{rule: curve, output: torque(first), value: 2 kN*m, transient_factor: 1.5, source: maker}}
"""
SHAPES = {1: np.array([1.0, 0.0, -1.0]), 2: np.array([-0.5, 1.0, -0.5])}
"""Mode shapes by hand, the largest angle 1."""
OMEGA = {1: math.sqrt(K / J), 2: math.sqrt(3 * K / J)}
"""Undamped natural frequencies in rad/s."""


@pytest.fixture(scope="module")
def plant():
    return tn.loads(PLANT)


@pytest.fixture(scope="module")
def peaks(plant):
    return condition_peaks(plant, plant.check_limits(), plant.critical_speeds(), 910 / RPM)


def response(rpm, order, torques):
    """Complex torque of the first spring in N m: (K + j w C - w^2 M) theta = T, three equations solved as they are."""
    w = order * rpm / RPM
    stiff = (K + 1j * w * C) * np.array([[1, -1, 0], [-1, 2, -1], [0, -1, 1]])
    theta = np.linalg.solve(stiff - w**2 * J * np.eye(3), np.array(torques, dtype=complex))
    return (K + 1j * w * C) * (theta[0] - theta[1])


def phasors():
    return [size * np.exp(1j * math.radians(phase)) for size, phase in TORQUES.values()]


@pytest.mark.parametrize("mode", [1, 2])
@pytest.mark.parametrize(("name", "place"), [("here", 0), ("there", 1), ("end", 2)])
def test_generalised_force_equilibrium_amplitude_and_magnifier(peaks, name, place, mode):
    """Sum of phi T, over omega^2 sum J phi^2; 1/(2 zeta) with zeta = omega C/(2 K), as damping follows stiffness."""
    found = [one for one in peaks.criticals if one.key == (mode, f"{name} 2")]
    force = abs(SHAPES[mode][place]) * TORQUES[place + 1][0]
    if not force:
        assert not found  # the torque is at the node of the mode
        return
    (record,) = found
    critical = record.critical
    inertia = J * float(SHAPES[mode] @ SHAPES[mode])
    assert critical.generalised_force == pytest.approx(force, rel=1e-9)
    assert critical.equilibrium_amplitude == pytest.approx(force / (OMEGA[mode] ** 2 * inertia), rel=1e-9)
    assert critical.mode.amplification == pytest.approx(K / (OMEGA[mode] * C), rel=1e-9)
    assert critical.natural_speed == pytest.approx(OMEGA[mode] / 2, rel=1e-9)


@pytest.mark.parametrize("name", ["here 2", "there 2"])
def test_amplitude_and_sum_at_the_peak_are_those_of_the_equations(peaks, name):
    for record in (one for one in peaks.criticals if one.name == name):
        rpm, place = record.point.rpm, ["here 2", "there 2"].index(name)
        own = [torque if number == place else 0 for number, torque in enumerate(phasors())]
        assert record.amplitude == pytest.approx(abs(response(rpm, 2, own)), rel=1e-9)
        sums = abs(response(rpm, 2, phasors())) + abs(response(rpm, 1, (400, 0, 0)))
        assert abs(response(rpm, 2, phasors())) < record.point.value <= sums * (1 + 1e-9)
        assert record.utilisation == pytest.approx(record.point.value / 2000, rel=1e-12)
        assert record.point.in_passing == 3000
        beside = [abs(response(rpm + step, 2, own)) for step in (-1, 1)]
        assert record.is_peak
        assert max(beside) < record.amplitude


def test_resonant_amplitude_is_near_the_forced_one(peaks):
    """Equilibrium amplitude times magnifier, times the torque of the spring in the mode, with little of the others."""
    record = next(one for one in peaks.criticals if one.key == (1, "here 2"))
    twist = SHAPES[1][0] - SHAPES[1][1]
    assert K * twist * record.critical.resonant_amplitude == pytest.approx(record.amplitude, rel=0.03)


def test_sum_of_several_sources_is_the_one_of_the_frequency(peaks):
    record = next(one for one in peaks.criticals if one.key == (1, "here 2"))
    (summed,) = [one for one in record.point.check.summed if len(one.places) > 1]
    assert summed.name == "here 2 + there 2 + end 2"
    expected = abs(response(record.point.rpm, 2, phasors()))
    assert record.point.order(summed.places) == pytest.approx(expected, rel=1e-9)
    named = largest_orders(record.point.check, record.point.verdict, record.point.at)
    whole = response(record.point.rpm, 2, phasors())
    assert dict(named)[summed.name] == pytest.approx(whole, rel=1e-9)  # with its phase


def test_a_plateau_is_no_peak(peaks):
    """Order 1 is critical at 955 rpm in mode 1 and beyond the range in mode 2; its rise to the end makes no peak."""
    found = [one for one in peaks.criticals if one.name == "here 1"]
    assert [(one.critical.mode.number, one.is_peak) for one in found] == [(1, True)]
    # Mode 2 at 1654 rpm is out of reach; nothing has the value at the end of the range.
    assert all(one.point is None or one.point.rpm < 999 for one in peaks.criticals)


def test_peaks_of_the_sum_and_who_makes_them(peaks):
    made = [(one.order, one.mode, one.is_peak) for one in peaks.sums]
    # Order 2 meets mode 2 at 827 rpm, on the flank of order 1, and makes no maximum of the sum there.
    assert made == [("here 2 + there 2 + end 2", 1, True), ("here 1", 1, True)]
    speeds = [one.point.rpm for one in peaks.sums]
    assert speeds == pytest.approx([OMEGA[1] / 2 * RPM, OMEGA[1] * RPM], rel=0.02)


def test_rated_speed(peaks):
    point = peaks.points.rpm[peaks.rated]
    assert point == pytest.approx(910)
    assert {one.rated.rpm for one in peaks.criticals if one.rated} == {point}


def test_local_maxima_leave_out_the_ends():
    assert local_maxima(np.array([5.0, 1.0, 3.0, 2.0, 7.0])) == [2]
    assert local_maxima(np.array([1.0, 2.0, 3.0])) == []


@pytest.fixture(scope="module")
def ship():
    return tn.load("two_stroke_ship").configured("misfire")


@pytest.fixture(scope="module")
def out(ship):
    check = ship.check_limits()
    return check, condition_peaks(ship, check, ship.critical_speeds())


class TestCases:
    """Orders beside a half range are those of the cylinder that is out in that case."""

    def test_sum_of_the_orders_has_the_half_range_judged(self, ship, out):
        check, _ = out
        verdict = check.of("tail", "tau_C")
        run = ship.order_response("torque(tail)", speeds=check.speeds[::40])
        assert len(check.cases) == len(run.labels)
        for number, at in enumerate(range(0, len(check.speeds), 40)):
            case = run.labels.index(check.cases[verdict.amplitudes.cases[at]])
            modulus = verdict.values[at] / run.half_range[number, 0]
            own = run.alternatives[run.labels[case]].values[number, :, 0]
            assert np.abs(verdict.amplitudes.phasors[at]) == pytest.approx(np.abs(own) * modulus, rel=1e-6, abs=1e-6)
            assert (verdict.orders[at] >= np.abs(own) * modulus * (1 - 1e-9)).all()

    def test_force_is_that_of_the_same_cylinder(self, out):
        _, peaks = out
        engine = [one for one in peaks.criticals if one.point is not None and one.critical.excitation == "engine"]
        assert engine
        for record in engine:
            assert record.critical.case == record.point.case
            assert record.critical.generalised_force == dict(record.critical.force_by_case)[record.point.case]

    def test_a_case_that_is_unknown_keeps_the_worst(self, out):
        critical = next(one.critical for one in out[1].criticals if one.point is not None)
        assert critical.in_case("misfire of cylinder 99") is critical


HEAVY, LIGHT, LITTLE = 400.0, 1.0, 0.1
"""Inertias in kg m^2 of a wheel and of a disc behind the spring K, and the damping of that spring in N m s/rad."""
RINGING = f"""
torsionnet: 1
name: a disc that rings
elements:
  wheel: {{type: inertia, node: a, inertia: {HEAVY}}}
  disc: {{type: inertia, node: b, inertia: {LIGHT}}}
  spring: {{type: spring, nodes: [a, b], stiffness: {K}, damping: {LITTLE}}}
speeds: {{of: a, range: 600..800 rpm, step: 10 rpm}}
excitations:
  teeth: {{type: harmonic, node: a, orders: {{2: {{amplitude: 10}}, 2.03: {{amplitude: 10}}, 3: {{amplitude: 0.1}}}}}}
limits:
  spring: {{rule: curve, output: torque(spring), value: 100 N*m, source: maker}}
"""


@pytest.fixture(scope="module")
def ringing():
    model = tn.loads(RINGING)
    return condition_peaks(model, model.check_limits(), model.critical_speeds())


class TestRinging:
    """The torques act where the mode hardly moves, by 1/400 of its largest angle, but hardly anything damps it."""

    @staticmethod
    def twisting(order, rpm, torque=10.0):
        """Torque in N m of the spring: one degree of freedom, the twist, with the inertia J1 J2/(J1 + J2)."""
        w, reduced = order * rpm / RPM, HEAVY * LIGHT / (HEAVY + LIGHT)
        stiffness = K + 1j * w * LITTLE
        return abs(stiffness * torque * reduced / HEAVY / (stiffness - w**2 * reduced))

    def test_a_small_force_with_a_large_magnifier_is_a_critical_speed(self, ringing):
        natural = math.sqrt(K * (HEAVY + LIGHT) / (HEAVY * LIGHT))
        speeds = {"teeth 2": natural / 2 * RPM, "teeth 2.03": natural / 2.03 * RPM}
        assert {one.name for one in ringing.criticals} == set(speeds)
        for one in ringing.criticals:
            assert one.critical.excited is False
            assert one.point.rpm == pytest.approx(speeds[one.name], rel=1e-4)
            assert one.amplitude == pytest.approx(self.twisting(one.critical.order, one.point.rpm), rel=1e-6)
            assert one.amplitude == pytest.approx(10 / (HEAVY + LIGHT) * LIGHT * K / (natural * LITTLE), rel=1e-3)

    def test_peaks_near_each_other_are_told_once_each(self, ringing):
        made = [(one.order, one.mode, round(one.point.rpm)) for one in ringing.sums]
        natural = math.sqrt(K * (HEAVY + LIGHT) / (HEAVY * LIGHT)) * RPM
        assert made == [("teeth 2.03", 1, round(natural / 2.03)), ("teeth 2", 1, round(natural / 2))]
