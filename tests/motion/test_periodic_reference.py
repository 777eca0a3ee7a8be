"""Reference points of periodic motions, found by shooting and by harmonic balance elsewhere, as a user asks for them."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from support.periodic_rigs import car, free_clearance, gear_pair, rubbing_mass, two_stage_rig

from torsionnet.motion.periodic.periodic_result import PeriodicResponse

SHARE = 1e-5
"""Share asked of swings, folds, doublings and order amplitudes."""
MULTIPLIER = 1e-3
"""Error asked of multipliers."""
FREQUENCY = 2e-5
"""Share asked of the frequency of a flat maximum."""
RPM = pi / 30


def _close(found: float, wanted: float, share: float = SHARE) -> None:
    assert abs(found - wanted) <= share * abs(wanted), (found, wanted)


def _places(found: PeriodicResponse, kind: str) -> list[float]:
    return sorted(found.shown(one.at) for one in found.turns(kind) if one.periods == 1)


def _swings(found: PeriodicResponse, at: float, output: str | None = None) -> dict[float, complex | None]:
    """Peaks to peaks of the single motions at a place, smallest first, each with its multiplier if it is unstable."""
    here = sorted(
        (one for one in found.motions_at(at) if one.periods == 1), key=lambda one: found.peak_to_peak(one, output)
    )
    return {found.peak_to_peak(one, output): None if one.is_stable else complex(one.multipliers[0]) for one in here}


def _agree(found: dict[float, complex | None], wanted: dict[float, complex | None]) -> None:
    assert len(found) == len(wanted)
    for (ours, multiplier), (size, expected) in zip(found.items(), wanted.items(), strict=True):
        _close(ours, size)
        assert (multiplier is None) == (expected is None)
        assert expected is None or abs(multiplier - expected) < MULTIPLIER


@pytest.mark.nightly
def test_every_point_of_the_flywheel_of_two_stages():
    found = two_stage_rig().periodic_response(
        "twist(dmf)", frequencies=[4.4, 4.55, 6.8, 10, 11, 15, 16], excitation={"T_M": {0: 40, 1: 60}}, subharmonics=2
    )
    for at, wanted in (
        (4.55, {0.36518296: None, 0.37959069: None, 0.42562942: 1.688174}),
        (6.8, {0.38880600: -1.472278}),
        (10, {0.73213888: None}),
        (11, {0.28332701: None, 0.46625248: 1.729186, 1.05091845: None}),
    ):
        _agree(_swings(found, at), wanted)
    for ours, wanted in zip(_places(found, "fold"), (4.4822400, 4.6295254, 10.7001659, 11.9120877), strict=True):
        _close(ours, wanted)
    for ours, wanted in zip(_places(found, "doubling"), (6.532795, 7.190820, 14.507730, 15.893847), strict=True):
        _close(ours, wanted)
    (met,), (low,) = found.stable_at(15), found.stable_at(6.8)
    assert met.periods == low.periods == 2
    _close(found.peak_to_peak(low), 0.41144030)
    _close(found.peak_to_peak(met), 0.17535737)
    _close(found.amplitude_of_order(met, 0.5), 0.07017413)
    _close(found.amplitude_of_order(met, 1), 0.04118129)


GRAZES = 0.8312552
"""W at which a motion of the gear pair touches the end of the dead zone."""


def test_every_point_of_the_gear_pair():
    found = gear_pair().periodic_response(
        "x", frequencies=np.array([0.6, 0.7, 0.8, GRAZES, 0.9]) / (2 * pi), excitation={"x": {0: 0.1, 1: 0.032}}
    )
    # just before the upper fold the small motion touches the end of the dead zone
    _close(max(float(one.lowest[0]) for one in found.motions_at(GRAZES / (2 * pi))), 1.0)
    lower, upper = _places(found, "fold")
    _close(lower * 2 * pi, 0.61151368)
    _close(upper * 2 * pi, 0.84100728)
    for at, wanted in (
        (0.8, {(1.01322782, 1.18677218): None, (0.92125862, 1.26666619): 1.991761, (0.76157005, 1.33300931): None}),
        (0.7, {(1.03783780, 1.16216220): None, (0.77097848, 1.34631129): 1.875917, (0.61891971, 1.38635167): None}),
    ):
        motions = sorted(found.motions_at(at / (2 * pi)), key=found.peak_to_peak)
        for motion, ((lowest, highest), multiplier) in zip(motions, wanted.items(), strict=True):
            _close(float(motion.lowest[0]), lowest)
            _close(float(motion.highest[0]), highest)
            assert motion.is_stable is (multiplier is None)
            # damping alone fixes the product of two multipliers, exp(-c 2 pi/W)
            size = np.exp(-0.1 * pi / at) if multiplier is None else multiplier
            assert abs(abs(motion.multipliers[0]) - size) < MULTIPLIER


@pytest.mark.parametrize(
    ("force", "frequency", "amplitude", "described", "first"),
    [
        (0.5, 15.79710, 0.014137210, 15.79863, 0.014136769),
        pytest.param(3, 13.15039, 0.027808712, 13.12238, 0.027853900, marks=pytest.mark.nightly),
        (10, 10.10376, 0.52849625, 10.10550, 0.52841794),
    ],
)
@pytest.mark.slow
def test_friction_has_its_largest_swing_at_a_frequency(force, frequency, amplitude, described, first):
    shares = 1e-3 * np.array([-2, -1, 0, 1, 2])
    for harmonics, place, size in (("auto", frequency, amplitude), (1, described, first)):
        found = rubbing_mass().periodic_response(
            "x", frequencies=place * (1 + shares), excitation={"x": force}, harmonics=harmonics
        )
        motions = [found.motions_at(at)[0] for at in place * (1 + shares)]
        swings = [abs(one.amplitudes[1, 0]) if harmonics == 1 else found.peak_to_peak(one) / 2 for one in motions]
        # A polynomial of fourth degree through the five, and where its slope is zero.
        course = np.polynomial.Polynomial.fit(shares, np.array(swings) / size, 4)
        (top,) = [one.real for one in course.deriv().roots() if abs(one.imag) < 1e-9 and abs(one) < 1e-3]
        assert abs(top) < FREQUENCY
        _close(float(course(top)) * size, size, 1e-6)


@pytest.mark.slow
def test_every_point_of_the_clearance_between_free_masses():
    found = free_clearance().periodic_response(
        "twist(gap)", frequencies=[27, 30, 40, 45, 50], excitation={"a": {0: 25, 1: 40}, "b": {0: -25}}, subharmonics=2
    )
    low, high = _places(found, "fold")
    _close(low, 27.466157)
    _close(high, 34.161250)
    places = _places(found, "doubling")  # one more is that of the large motion below 30 Hz
    for wanted in (27.505812, 48.316462):
        _close(min(places, key=lambda at: abs(at - wanted)), wanted)
    for at, motions in (
        (50, [(0.01267718, 0.02633979, -0.922627)]),
        (40, [(0.00584299, 0.02858168, -1.221775)]),
        (
            30,
            [
                (-0.01024941, 0.03218109, -1.315239),
                (-0.02690664, 0.03900662, 2.505880),
                (-0.04250085, 0.05268038, None),
            ],
        ),
    ):
        single = sorted((one for one in found.motions_at(at) if one.periods == 1), key=found.peak_to_peak)
        for motion, (lowest, highest, multiplier) in zip(single, motions, strict=True):
            _close(float(motion.lowest[0]), lowest)
            _close(float(motion.highest[0]), highest)
            assert multiplier is None or abs(motion.multipliers[0] - multiplier) < MULTIPLIER
            assert motion.is_stable is (multiplier is None or abs(multiplier) < 1)
    for at, lowest, highest in ((40, -0.00153571, 0.02895156), (45, 0.00605751, 0.02761135)):
        (met,) = found.stable_at(at)
        assert met.periods == 2
        _close(float(met.lowest[0]), lowest)
        _close(float(met.highest[0]), highest)


CAR = {
    800: ([0.19337599], [8333.743]),
    900: ([0.22084508], [8855.099]),
    1000: ([0.23560961], [9967.141]),
    1100: ([0.24898647], [11597.61]),
    1120: ([0.18463360, 0.21192727, 0.25114580], []),
    1150: ([0.15954798, 0.22471678, 0.25328758], [5552.713, None, 13089.60]),
    1200: ([0.12767932], [4598.465]),
    1300: ([0.08927163], [3252.107]),
    1500: ([0.05291269], [983.655]),
    1700: ([0.03577206], []),
    2000: ([0.02358744], [274.390]),
    2500: ([0.01448843], [182.870]),
    3000: ([0.00980586], [178.552]),
}
"""Peaks to peaks of the twist of the flywheel in rad, and peaks of the gearbox's acceleration in rad/s^2, over rpm."""


@pytest.mark.slow
def test_every_point_of_the_car():
    gas = {"type": "harmonic", "node": "engine", "orders": {
        2: {"amplitude": "300 N*m"}, 4: {"amplitude": "60 N*m", "phase": "-90 deg"}}}  # fmt: skip
    rig = car(excitations={"gas": gas}, operating_point={"torque": {"engine": "60 N*m", "vehicle": "-60 N*m"}})
    speeds = [rpm * RPM for rpm in (*CAR, 1600)]
    outputs = ["twist(dmf)", "acceleration(gearbox)"]
    found = rig.periodic_response(outputs, speeds=speeds, speed_of="engine", subharmonics=2)
    for rpm, (swings, peaks) in CAR.items():
        single = [one for one in found.motions_at(rpm * RPM) if one.periods == 1]
        single.sort(key=lambda one: found.peak_to_peak(one, "twist(dmf)"))
        for motion, wanted in zip(single, swings, strict=True):
            _close(found.peak_to_peak(motion, "twist(dmf)"), wanted)
        for motion, wanted in zip(single, peaks, strict=False):
            assert wanted is None or abs(max(motion.highest[1], -motion.lowest[1]) - wanted) <= SHARE * wanted
    for rpm, multiplier in ((1120, 2.0121), (1150, 1.6770), (1700, -1.5884)):
        (worst,) = [one for one in found.motions_at(rpm * RPM) if not one.is_stable]
        assert abs(worst.multipliers[0] - multiplier) < MULTIPLIER
    for rpm, size, first, second in (
        (1700, 0.09489966, 0.03709959, 0.01857517),
        (1600, 0.09359238, 0.03742745, 0.02088838),
    ):
        (met,) = found.stable_at(rpm * RPM)
        _close(found.peak_to_peak(met, "twist(dmf)"), size)
        _close(found.amplitude_of_order(met, 1, "twist(dmf)"), first)
        _close(found.amplitude_of_order(met, 2, "twist(dmf)"), second)
    jumps = {way: at / RPM for way, at in found.jumps}
    _close(jumps["run-up"], 1180.922)
    _close(jumps["run-down"], 1102.2643)


def test_every_point_of_the_half_order():
    found = gear_pair(0.06).periodic_response(
        "x", frequencies=np.array([1.8, 1.85, 1.9, 2.5]) / (2 * pi), excitation={"x": {0: 0.12, 1: 0.6}}, subharmonics=2
    )
    (doubling,) = [one for one in found.turns("doubling") if one.periods == 1]
    _close(doubling.at * 2 * pi, 1.9318359)
    _close(float(doubling.lowest[0]), 0.89464288)
    _close(float(doubling.highest[0]), 1.30165093)
    for at, lowest, highest, half in (
        (1.9, 0.84913817, 1.45737458, 0.16103843),
        (1.85, 0.80286119, 1.51853955, 0.22882425),
    ):
        (met,) = found.stable_at(at / (2 * pi))
        _close(float(met.lowest[0]), lowest)
        _close(float(met.highest[0]), highest)
        _close(found.amplitude_of_order(met, 0.5), half)
    (again,) = [one for one in found.motions_at(1.8 / (2 * pi)) if one.periods == 2]
    assert abs(again.multipliers[0] + 1.135307) < MULTIPLIER
