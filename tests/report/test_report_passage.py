"""Section on passing barred ranges, and the time that a limit asks for."""

from dataclasses import replace

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.units import RPM
from torsionnet.machinery.verdicts.operating_instructions import operating_instructions, passed_ranges
from torsionnet.machinery.verdicts.range_passage import passage_table, range_passages
from torsionnet.report import make_report
from torsionnet.report.document_tree import Paragraph, Picture, TableBlock, inlines
from torsionnet.report.plan.report_plan import ReportPlan

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def ship():
    return tn.load("bulk_carrier").configured("normal")


@pytest.fixture(scope="module")
def check(ship):
    return ship.check_limits(speeds=np.arange(30, 108.01, 0.5) / RPM)


def section(model, **report):
    definition = model.definition
    plan = replace(definition.report or ReportPlan(), **report) if report else definition.report
    made = make_report(
        model.with_definition(replace(definition, report=plan)), sections=["passage"], kind="approval", date=None
    )
    return made.sections


def test_a_ship_with_a_barred_range(ship):
    (found,) = section(ship, passage=(8.0,))
    assert inlines(found.title) == ("Passing the barred ranges",)
    (table,) = [one for one in found.blocks if isinstance(one, TableBlock)]
    rows = [row for group in table.groups for row in group.rows]
    assert [row[1] for row in rows] == ["up", "up", "down", "down"]
    assert {row[0] for row in rows} == {"propeller shaft", "intermediate"}
    assert len([one for one in found.blocks if isinstance(one, Picture)]) == 1
    texts = [str(one) for one in found.blocks if isinstance(one, Paragraph)]
    assert any("limits in passing are kept" in text for text in texts)
    # Notes of the response are said, but for the error of the calculation.
    assert any("Parameters that follow the speed" in text for text in texts)
    assert not any("estimated error" in text for text in texts)


def test_without_a_barred_range_there_is_none():
    assert not section(tn.load("two_stroke_ship").configured("normal"))
    assert not section(tn.load("wind_turbine_3mw"))


def test_without_notes_on_the_response_there_is_no_text_behind_the_picture():
    fan = tn.loads(
        """
torsionnet: 1
name: fan
elements:
  rotor: {type: inertia, node: a, inertia: 2}
  wheel: {type: inertia, node: b, inertia: 1}
  shaft: {type: spring, nodes: [a, b], stiffness: 10 kN*m/rad, damping: 2}
speeds: {of: a, range: 400..700 rpm, step: 5 rpm}
excitations: {blades: {type: harmonic, node: b, orders: {2: {amplitude: 10}}}}
limits: {shaft: {rule: curve, output: torque(shaft), value: 100 N*m, source: maker}}
"""
    )
    (found,) = section(fan, passage=(100.0,))
    assert isinstance(found.blocks[-1], Picture)


def test_rows_are_those_of_the_response(ship, check):
    (barred,) = passed_ranges([check])
    found = range_passages(ship, barred, [8.0])
    one = next(one for one in found if one.verdict.limit == "intermediate" and one.is_upward)
    modulus = np.pi * 0.44**3 / 16
    run = one.response
    torque = ship.passage_response("torque(int_shaft)", [0, run.times[-1]], run.speeds[[0, -1]])
    assert one.largest == pytest.approx(torque.peak().half_range / modulus, rel=1e-3)
    assert one.allowed_there == pytest.approx(float(np.interp(one.rpm, check.rpm, one.verdict.allowed)), rel=1e-6)
    assert one.in_passing == pytest.approx(1.7 * one.allowed_there, rel=1e-3)
    assert one.largest < one.steady
    assert one.outcome == "kept"
    # The range itself takes the time asked for; the run-up before and behind it comes on top.
    inside = (run.speeds >= one.low) & (run.speeds <= one.high)
    assert run.times[inside].max() - run.times[inside].min() == pytest.approx(8, rel=0.02)
    # Cycles are those of order 6 while the half range is above tau_C.
    assert one.cycles == pytest.approx(6 * one.rpm / 60 * one.seconds_above, rel=0.25)


def test_a_slower_passage_has_more_cycles(ship, check):
    (barred,) = passed_ranges([check])
    quick, slow = (range_passages(ship, barred, [time])[0] for time in (8.0, 24.0))
    assert slow.cycles > 2 * quick.cycles
    assert slow.largest > quick.largest


def with_time(model, seconds):
    limits = dict(model.definition.limits)
    limits["intermediate"] = replace(limits["intermediate"], passing_time=seconds)
    return model.with_definition(replace(model.definition, limits=limits))


def test_a_passing_time_is_in_the_instructions_and_is_judged(ship):
    timed = with_time(ship, "10 s")
    check = timed.check_limits("intermediate", speeds=np.arange(30, 108.01, 0.5) / RPM)
    (one,) = operating_instructions([check])
    assert one.action == "pass without stopping within 10 s"
    (found,) = section(timed)
    texts = [str(one) for one in found.blocks if isinstance(one, Paragraph)]
    assert any("in the 10 s that are asked for, the limit in passing is kept" in text for text in texts)
    assert any("Besides the times that limits ask for, 10 s" in text for text in texts)
    assert not any("No rule at hand" in text for text in texts)


def test_a_passing_time_that_is_none():
    with pytest.raises(tn.ModelError, match=r"passing_time"):
        tn.loads(
            tn.load("bulk_carrier")
            .to_yaml()
            .replace("tachometer_tolerance:", "passing_time: -3 s\n    tachometer_tolerance:")
        )


COUPLED = """
torsionnet: 1
name: set
elements:
  engine: {{type: inertia, node: a, inertia: 2}}
  rotor: {{type: inertia, node: b, inertia: 1}}
  rubber: {{{law}, nodes: [a, b]}}
speeds: {{of: a, range: 400..700 rpm, step: 5 rpm}}
load: {{absorbed_at: b, driven_by: {{a: 100 %}}, torque: 80 N*m, rated: 600 rpm, torque_exponent: 0}}
excitations: {{pulses: {{type: harmonic, node: b, orders: {{2: {{amplitude: 10}}}}}}}}
limits: {{rubber: {{rule: coupling, element: rubber, T_KW: 100 N*m, T_Kmax: 1500 N*m}}}}
"""
VISCOUS = "type: spring, stiffness: 10 kN*m/rad, damping: 2"
HYSTERETIC = "type: hysteretic_spring, stiffness: 10 kN*m/rad, loss_factor: 0.03"


class TestMaximumTorque:
    def test_mean_and_vibration_are_judged_along_the_passage(self):
        """The mean torque is 80 N m at all speeds; the rest is the half range of the same passage."""
        plant = tn.loads(COUPLED.format(law=VISCOUS))
        (barred,) = passed_ranges([plant.check_limits()])
        found = range_passages(plant, barred, [2.0])
        vibratory, total = ([one for one in found if one.verdict.criterion == name] for name in ("T_KW", "T_Kmax"))
        mean = 80
        for one, other in zip(total, vibratory, strict=True):
            assert one.largest == pytest.approx(mean + other.largest, rel=1e-6)
            assert (one.in_passing, one.allowed_there, one.cycles) == (1500.0, None, None)
            assert one.outcome == "kept"
        assert [row[0] for row in passage_table(found).rows] == ["rubber", "rubber T_Kmax"] * 2

    def test_hysteretic_couplings_keep_their_steady_value(self):
        plant = tn.loads(COUPLED.format(law=HYSTERETIC))
        check = plant.check_limits()
        (barred,) = passed_ranges([check])
        found = range_passages(plant, barred, [2.0])
        assert {one.verdict.criterion for one in found} == {"T_KW"}
        row = passage_table(found, barred=barred).rows[-1]
        assert row[:2] == ("rubber T_Kmax", "steady")
        assert row[5] == pytest.approx(check.of("rubber", "T_Kmax").worst_value, rel=1e-9)
