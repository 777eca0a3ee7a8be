"""Speed bands of limits: where they were judged, what is only passed, and what is judged below a band that is not reached.

Torques are those of two masses on a spring by hand, with a damper at one of them.
"""

import math

import numpy as np
import pytest
from support.limit_cases import RPM, hump, m68, stressed

import torsionnet as tn
from torsionnet.machinery import LimitConclusion
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_verdict import without_contradictions
from torsionnet.machinery.verdicts.operating_instructions import (
    instruction_table,
    operating_instructions,
    passed_ranges,
    refused_ranges,
)
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan
from torsionnet.model.condition_titles import ConditionTitles

STIFFNESS, DAMPING, AMPLITUDE = 60e3, 400.0, 1e3
SET = """torsionnet: 1
name: set
elements:
  engine: {{type: inertia, node: e, inertia: 40}}
  coupling: {{type: spring, nodes: [e, g], stiffness: 60 kN*m/rad}}
  rotor: {{type: inertia, node: g, inertia: 30}}
  field: {{type: damper, nodes: [g, ground], damping: 400}}
sensors: {{T_cpl: {{torque: coupling}}}}
speeds: {{of: e, range: 250..900 rpm, step: 5 rpm, rated: 750 rpm}}
excitations: {{gas: {{type: harmonic, node: e, orders: {{1: {{amplitude: 1 kN*m}}}}}}}}
limits:
  crank: {{rule: curve, output: T_cpl, value: {crank}, transient_factor: 1.1, source: own}}
  rubber: {{rule: curve, output: T_cpl, value: 1 kN*m, speed_band: 90..110 %, source: own}}
  flicker: {{rule: machine_angle, node: g, pole_pairs: 4, angle: {angle}, speed_band: 110..115 %, source: own}}
"""


def torque(rpm):
    """Amplitude in the coupling in N m by order 1."""
    s = 1j * np.asarray(rpm) * RPM
    one, two = 40 * s**2 + STIFFNESS, 30 * s**2 + DAMPING * s + STIFFNESS
    first = AMPLITUDE * two / (one * two - STIFFNESS**2)
    return np.abs(STIFFNESS * (first - first * STIFFNESS / two))


def first_above(allowed):
    """Lowest speed from 250 rpm on at which the torque by hand is above a value in N m."""
    speeds = np.arange(250, 900, 0.01)
    return speeds[torque(speeds) > allowed][0]


@pytest.fixture(scope="module")
def passing():
    return tn.loads(SET.format(crank="30 kN*m", angle="0.5 rad")).check_limits()


@pytest.fixture(scope="module")
def failing():
    return tn.loads(SET.format(crank="2 kN*m", angle="1 mrad")).check_limits()


class TestBandThatIsReached:
    def test_other_speeds_are_only_passed_and_that_is_said(self, passing):
        """At 250 rpm and above the rubber has more than its 1 kN m, but for the band from 675 rpm on."""
        assert torque([500, 640]).min() > 1e3 > torque(np.arange(675, 825)).max()
        assert passing.of("rubber").verdict == "pass"
        assert passing.of("rubber").judged_rpm == (pytest.approx((675, 825)),)
        assert passing.of("crank", "continuous").judged_rpm == (pytest.approx((250, 900)),)
        said = "rubber continuous judged in the speed band alone, 675 to 825 rpm of e"
        assert said in passing.findings
        assert said in LimitConclusion((passing,)).sentence

    def test_nothing_outside_of_it_is_permitted(self, passing):
        assert [span.rpm_outward for span in passing.permitted] == [(675, 863)]
        *_, last = instruction_table([passing]).notes
        assert last == (
            "Speeds outside of 675 to 862.5 rpm of e are to be passed without stopping: rubber, flicker not judged there."
        )
        free = " ".join(instruction_table([passing]).notes)
        assert "from 250 to 900 rpm" not in free

    def test_a_limit_over_all_speeds_has_no_such_words(self):
        found = tn.loads(
            SET.format(crank="30 kN*m", angle="0.5 rad")
            .replace("90..110 %", "0..150 %")
            .replace("110..115 %", "0..150 %")
        )
        check = found.check_limits("rubber")
        assert not [text for text in check.findings if "band" in text]


class TestBandThatIsNotReached:
    """The crankshaft may not pass its resonance: what remains lies below the band of the rubber."""

    def test_the_limit_is_judged_at_what_remains(self, failing):
        low = first_above(1e3)
        assert low < first_above(2e3) < 675
        assert failing.of("crank", "in passing").verdict == "fail"
        assert failing.highest / RPM == pytest.approx(low, rel=2e-3)
        assert failing.of("rubber").verdict == "fail"
        ((first, last), band) = failing.of("rubber").judged_rpm
        assert (first, last) == pytest.approx((250, first_above(2e3)), rel=2e-2)
        assert band == pytest.approx((675, 825))

    def test_no_speed_above_its_limit_is_left_free(self, failing):
        (row,) = operating_instructions([failing])
        assert row.action == f"not to be run or passed: not above {row.from_rpm} rpm"
        assert torque(row.from_rpm) <= 1e3
        assert row.besides == "it begins where rubber, continuous is exceeded"
        ((low, high),) = [span.rpm_outward for span in failing.permitted]
        assert torque(np.arange(low, math.floor(failing.highest / RPM) + 1)).max() <= 1e3
        assert high == row.from_rpm + 1

    def test_a_generator_that_is_not_connected_is_not_judged(self, failing):
        assert failing.of("flicker").judged_rpm == (pytest.approx((825, 862.5)),)

    def test_all_that_is_not_kept_is_named(self, failing):
        first, *_ = instruction_table([failing]).notes
        assert first.startswith("Not kept in normal operation: crank, rubber, flicker; only the remaining speeds")


FLICKER_END = 740.0


def electrical(rpm):
    """Electrical angle of the rotor in rad: 4 pole pairs times the mechanical one."""
    s = 1j * rpm * RPM
    one, two = 40 * s**2 + STIFFNESS, 30 * s**2 + DAMPING * s + STIFFNESS
    return 4 * abs(AMPLITUDE * STIFFNESS / (one * two - STIFFNESS**2))


@pytest.fixture(scope="module")
def flickering():
    text = SET.format(crank="30 kN*m", angle=f"{electrical(FLICKER_END)} rad").replace("110..115 %", "90..115 %")
    return tn.loads(text).check_limits()


class TestFlicker:
    """What is too large in the low part of the generator's band is not run; it is passed without harm."""

    def test_the_rest_of_the_band_is_permitted(self, flickering):
        assert electrical(675) > electrical(FLICKER_END) > electrical(862)
        assert flickering.of("flicker").verdict == flickering.verdict == "fail"
        assert flickering.highest is None
        assert [(one.low / RPM, one.high / RPM) for one in flickering.permitted] == [
            pytest.approx((FLICKER_END, 862.5), rel=1e-3)
        ]
        assert flickering.permits(750 * RPM)

    def test_it_may_be_passed(self, flickering):
        (row,) = operating_instructions([flickering])
        assert (row.from_rpm, row.to_rpm) == (675, 740)
        assert row.action == "not to be run with load; it may be passed"
        assert row.besides == ""
        assert passed_ranges([flickering]) == refused_ranges([flickering]) == ()

    def test_rated_speed_is_told_where_no_condition_permits_it(self, flickering):
        assert "permitted in no condition" not in LimitConclusion((flickering,), ConditionTitles({})).sentence
        text = SET.format(crank="30 kN*m", angle=f"{electrical(760)} rad").replace("110..115 %", "90..115 %")
        found = LimitConclusion((tn.loads(text).check_limits(),), ConditionTitles({})).findings
        assert "rated speed, 750 rpm of e, is permitted in no condition examined" in found


class TestSettled:
    """One word for one condition."""

    def both(self, stress, other, misfire=False):
        from dataclasses import replace

        line = {name: replace(one, limit="line") for name, one in stressed(other, m68(), misfire=misfire).items()}
        found = stressed(stress, m68(), misfire=misfire)
        verdicts = (*found.values(), *line.values())
        return without_contradictions(verdicts, found["tau_C"].speeds)

    def test_a_range_that_another_shaft_must_not_pass_is_not_barred(self):
        found = self.both(hump(90, 50), hump(120, 52))
        words = {(one.limit, one.criterion): one.verdict for one in found}
        assert words[("shaft", "tau_C")] == words[("line", "tau_C")] == words[("line", "tau_T")] == "fail"
        assert words[("shaft", "tau_T")] == "pass"

    def test_one_below_stays_barred(self):
        found = self.both(hump(90, 30), hump(130, 60))
        assert [one.verdict for one in found if one.limit == "shaft" and one.criterion == "tau_C"] == ["barred range"]

    def test_no_limit_is_kept_by_a_reduced_speed_where_another_one_fails(self):
        found = self.both(hump(70, 100), hump(130, 50), misfire=True)
        assert "reduced speed" not in [one.verdict for one in found]
        alone = self.both(hump(70, 100), hump(10, 50), misfire=True)
        assert "reduced speed" in [one.verdict for one in alone]

    def test_a_range_above_the_highest_speed_reduces_it_too(self):
        """The shaft ends at 94 rpm; what the line would bar above is not passed."""
        found = stressed(hump(70, 97, width=0.5), m68(), misfire=True)
        other = stressed(hump(90, 50), m68(), misfire=True)["tau_C"]
        from dataclasses import replace

        above = replace(other, limit="line", barred=(SpeedSpan(95 * RPM, 96 * RPM),))
        (*_, last) = without_contradictions((found["tau_C"], above), found["tau_C"].speeds)
        assert (last.verdict, last.highest / RPM) == ("reduced speed", pytest.approx(95))


def test_a_speed_for_safe_navigation_decides_and_is_named():
    """70 N/mm^2 at 88 rpm are above tau_C; with a cylinder out the range may be passed, but 88 rpm has to stay free."""
    found = stressed(hump(70, 88), m68(safe_speed="88 rpm"), misfire=True)["tau_C"]
    check = LimitCheck(found.speeds, "crank", (found,), misfiring=True, rated=100 * RPM, propels=True)
    assert check.verdict == "fail"
    (row,) = operating_instructions([check])
    assert row.action == "pass without stopping"
    assert row.besides.startswith("the speed for safe navigation, 88 rpm, does not stay free")
    assert row.besides.endswith("the passage is not judged: no limit in passing is given")
    free = stressed(hump(70, 88), m68(safe_speed="70 rpm"), misfire=True)["tau_C"]
    (other,) = operating_instructions([LimitCheck(free.speeds, "crank", (free,), misfiring=True, rated=100 * RPM)])
    assert "safe navigation" not in other.besides
