"""Orders, limits, studies and pages of machinery whose laws of motion act in full, against the numbers of periodic motions."""

from __future__ import annotations

import json
from math import pi

import numpy as np
import pytest
from support.command_line import run
from support.periodic_rigs import car, free_clearance

import torsionnet as tn
from torsionnet.app.explore.over_speed import over_speed
from torsionnet.base.errors import UsageError
from torsionnet.motion.periodic.periodic_response import PeriodicOrders

RPM = pi / 30
GAS = {"type": "harmonic", "node": "engine", "orders": {
    2: {"amplitude": "300 N*m"}, 4: {"amplitude": "60 N*m", "phase": "-90 deg"}}}  # fmt: skip
MEAN = {"torque": {"engine": "60 N*m", "vehicle": "-60 N*m"}}


def _close(found: float, wanted: float, share: float = 1e-5) -> None:
    assert abs(found - wanted) <= share * abs(wanted), (found, wanted)


def rattling(**more: object) -> tn.Drivetrain:
    """Two free masses with a clearance under a mean torque of 25 N m and 40 N m of the first order."""
    given = {"operating_point": {"torque": {"a": "25 N*m", "b": "-25 N*m"}}} | more
    return tn.Drivetrain(
        "rattling",
        list(free_clearance().elements.values()),
        excitations={"shaker": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": "40 N*m"}}}},
        **given,
    )


def driven_car(speeds: list[str] | str, **more: object) -> tn.Drivetrain:
    """Car over a list of speeds, or over a range of them in steps of 50 rpm."""
    given = {"list": speeds} if isinstance(speeds, list) else {"range": speeds, "step": "50 rpm"}
    return car(
        excitations={"gas": GAS},
        operating_point=MEAN,
        speeds={"of": "engine", "nonlinear": "periodic", **given},
        **more,
    )


@pytest.fixture(scope="module")
def rattler() -> tn.Drivetrain:
    """Clearance at 40, 45 and 50 Hz, whose branches are followed once for all questions."""
    return rattling(speeds={"of": "a", "list": ["2400 rpm", "2700 rpm", "3000 rpm"], "nonlinear": "periodic"})


@pytest.fixture(scope="module")
def rattle(rattler) -> PeriodicOrders:
    return rattler.order_response("twist(gap)")


def test_half_ranges_are_those_of_the_motions_that_are_met(rattle):
    # at 40 and 45 Hz the single motion is unstable: what is met repeats after two periods
    wanted = ((0.02895156, -0.00153571), (0.02761135, 0.00605751), (0.02633979, 0.01267718))
    for number, (highest, lowest) in enumerate(wanted):
        _close(rattle.peak_to_peak[number, 0], highest - lowest)
        mean = rattle.taken[number][0].amplitudes[0, 0].real
        _close(rattle.bounds[0, number, 0] + mean, highest)
    assert not rattle.unmet.any()


def test_half_orders_stand_among_the_lines(rattle):
    orders = [line.order for line in rattle.lines]
    assert {0.5, 1.0, 1.5} <= set(orders)
    half = np.abs(rattle.of_order(0.5))
    assert half[0] > half[1] > 0
    assert half[2] == 0  # above the doubling at 48.3 Hz
    assert rattle.revolutions == 2
    # the sum of the orders kept is the motion but for what lies above them
    angle, wave = rattle.waveform()
    assert angle[-1] < 4 * pi
    _close(np.ptp(wave[0]) / 2, rattle.half_range[0, 0], 5e-3)


def test_orders_are_those_of_the_periodic_response(rattler, rattle):
    found = rattler.periodic_response("twist(gap)", speeds=rattle.speeds, speed_of="a", subharmonics=4)
    for number, at in enumerate(rattle.speeds):
        sizes = [found.peak_to_peak(one) for one in found.stable_at(at)]
        assert rattle.peak_to_peak[number, 0] == max(sizes)
    assert rattle.motions.table().rows == found.table().rows


@pytest.mark.slow
def test_branches_are_followed_once_for_all_outputs(monkeypatch):
    from torsionnet.motion.periodic import periodic_response

    followed, follow = [], periodic_response.all_branches
    monkeypatch.setattr(periodic_response, "all_branches", lambda *asked: followed.append(1) or follow(*asked))
    rig = rattling(speeds={"of": "a", "list": ["2950 rpm", "3000 rpm"], "nonlinear": "periodic"})
    twist, torque = rig.order_response("twist(gap)"), rig.order_response("torque(gap)", speeds=[3000 * RPM])
    assert len(followed) == 1
    # from nothing in the gap of 2 deg to 8000 N m/rad times what the twist is beyond
    _close(float(torque.peak_to_peak[0, 0]), 8000 * (0.02633979 - pi / 180))
    stronger = {"shaker": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": "41 N*m"}}}}
    other = tn.Drivetrain(
        "rattling", list(rig.elements.values()), excitations=stronger,
        operating_point={"torque": {"a": "25 N*m", "b": "-25 N*m"}}, speeds={"of": "a", "list": ["2950 rpm", "3000 rpm"]},
    )  # fmt: skip
    assert other.order_response("twist(gap)", nonlinear="periodic").half_range[1, 0] > twist.half_range[1, 0]
    assert len(followed) == 2


def test_mean_torques_are_those_of_the_load_at_each_speed():
    speeds = {"of": "a", "list": ["3000 rpm", "3300 rpm"], "rated": "3000 rpm"}
    load = {"absorbed_at": "b", "torque": "25 N*m", "torque_exponent": 2, "driven_by": {"a": 1}}
    loaded = rattling(operating_point=None, speeds=speeds, load=load)
    found = loaded.order_response("twist(gap)", nonlinear="periodic")
    _close(found.peak_to_peak[0, 0], 0.02633979 - 0.01267718)
    more = 25 * 1.1**2
    given = {"torque": {"a": f"{more} N*m", "b": f"{-more} N*m"}}
    alone = rattling(operating_point=given, speeds=speeds).order_response("twist(gap)", nonlinear="periodic")
    _close(found.peak_to_peak[1, 0], float(alone.peak_to_peak[1, 0]), 1e-7)
    assert abs(alone.peak_to_peak[0, 0] / found.peak_to_peak[0, 0] - 1) > 1e-2


def test_values_that_follow_the_speed_are_refused():
    speeds = {"of": "a", "list": ["3000 rpm"], "rated": "3000 rpm"}
    stiffness = {"by": "speed", "of": "a", "table": {"1000 rpm": 8000, "4000 rpm": 9000}}
    one, two, _, oil = free_clearance().elements.values()
    rig = tn.Drivetrain(
        "rattling", [one, two, tn.Clearance("gap", nodes=("a", "b"), gap="2 deg", stiffness="k"), oil],
        excitations={"shaker": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": "40 N*m"}}}},
        operating_point={"torque": {"a": "25 N*m", "b": "-25 N*m"}}, speeds=speeds, parameters={"k": stiffness},
    )  # fmt: skip
    with pytest.raises(UsageError, match=r"(?s)k: .*unsupported-law"):
        rig.order_response("twist(gap)", nonlinear="periodic")


def test_model_says_how_laws_act_and_an_argument_overrules_it(rattler, rattle):
    full, linear = rattle, rattler.order_response("twist(gap)", nonlinear="linear")
    assert isinstance(full, PeriodicOrders)
    _close(full.peak_to_peak[2, 0], 0.02633979 - 0.01267718)
    assert not isinstance(linear, PeriodicOrders)
    # in contact: 40/(.12 D) with the reduced inertia, k = 8000 and c = 3
    w, reduced = 3000 * RPM, 0.12 * 0.9 / 1.02
    wanted = 40 / 0.12 * reduced / abs(8000 - reduced * w**2 + 3j * w)
    _close(float(linear.half_range[2, 0]), wanted, 1e-9)
    assert any("linear" in note for note in linear.notes)
    assert rattler.configured().definition.to_data()["speeds"]["nonlinear"] == "periodic"


@pytest.mark.slow
def test_speeds_where_sweeps_jump_and_swings_peak_are_added_to_a_range():
    found = driven_car("1100..1200 rpm").order_response("twist(dmf)", refine=True)
    added = sorted(set(found.rpm) - {1100, 1150, 1200})
    for jump in (1102.2643, 1180.922):
        assert min(abs(at - jump) for at in added) < 0.01
    # The largest swing lies between the speeds given, just below the jump of a run-up.
    peak = int(found.peak_to_peak[:, 0].argmax())
    between = found.motions.motions_at(found.speeds[peak])
    assert 1150 < found.rpm[peak] < 1181
    _close(found.peak_to_peak[peak, 0], max(map(found.motions.peak_to_peak, between)), 1e-9)
    # the large motion lasts to its fold; beyond it the small one alone is left
    swings = dict(zip(np.round(found.rpm), found.peak_to_peak[:, 0], strict=True))
    _close(swings[1150], 0.25328758)
    _close(swings[1200], 0.12767932)
    assert swings[1181] > 0.95 * swings[1150]
    assert any(note.startswith("a run-up jumps at 1180.92") for note in found.notes)
    assert any(note.startswith("between the speeds given") for note in found.notes)


@pytest.mark.slow
def test_limits_judge_the_upper_branch_and_name_its_jumps():
    limits = {"dmf": {"rule": "curve", "output": "torque(dmf)", "value": "300 N*m", "source": "maker"}}
    rig = driven_car(["1000 rpm", "1150 rpm", "1300 rpm"], limits=limits)
    check = rig.check_limits()
    found = rig.periodic_response("torque(dmf)", speeds=check.speeds, speed_of="engine", subharmonics=4)
    upper = [max(map(found.peak_to_peak, found.stable_at(at))) / 2 for at in check.speeds]
    verdict = check.of("dmf")
    for ours, wanted in zip(verdict.values.tolist(), upper, strict=True):
        _close(ours, wanted, 1e-12)
    assert verdict.verdict != "pass"
    assert any("a run-down jumps at 1102.26" in note for note in check.notes)
    at_rest = rig.check_limits(nonlinear="linear")
    assert not any("jumps" in note for note in at_rest.notes)


def test_limit_that_only_an_unstable_motion_keeps_is_not_judged(monkeypatch):
    # at 40 Hz what is met repeats after two periods, which are not looked for here
    monkeypatch.setattr("torsionnet.motion.periodic.periodic_response.SUBHARMONICS", 1)
    limits = {"gap": {"rule": "curve", "output": "torque(gap)", "value": "1 kN*m", "source": "maker"}}
    speeds = {"of": "a", "list": ["2400 rpm", "3000 rpm"], "nonlinear": "periodic"}
    rig = rattling(speeds=speeds, limits=limits)
    check = rig.check_limits()
    assert check.of("gap").verdict == "not judged"
    assert "at some speeds no motion was found that is stable" in check.of("gap").remarks
    assert any(note.startswith("at 2400 rpm no motion found is stable") for note in check.notes)
    (axes,) = tn.plot.order_response(rig.order_response("twist(gap)")).axes
    (crosses,) = [line for line in axes.lines if line.get_label() == "of no stable motion"]
    assert crosses.get_xdata().round(6).tolist() == [2400]


@pytest.mark.slow
def test_study_says_where_no_motion_is_stable(monkeypatch):
    from torsionnet.study import define, run_study

    monkeypatch.setattr("torsionnet.motion.periodic.periodic_response.SUBHARMONICS", 1)
    limits = {"gap": {"rule": "curve", "output": "torque(gap)", "value": "1 kN*m", "source": "maker"}}
    rig = rattling(speeds={"of": "a", "list": ["2400 rpm"], "nonlinear": "periodic"}, limits=limits)
    asked = {"swing": {"type": "order_torque", "output": "twist(gap)"}, "used": {"type": "utilisation"}}
    found = run_study(define(rig, {"one.inertia": {"type": "list", "values": [0.12]}}, asked))
    assert "twist(gap): at some speeds no motion was found that is stable (1 variants)" in found.notes
    assert np.isnan(found.values("used")).all()


@pytest.mark.slow
def test_speed_at_which_an_allowed_value_over_speed_is_crossed():
    table = {"2930 rpm": 0.0076, "3300 rpm": 0.004}
    limits = {"gap": {"rule": "curve", "output": "twist(gap)", "over_speed": table, "source": "maker"}}
    speeds = {"of": "a", "range": "2930..3300 rpm", "step": "370 rpm", "nonlinear": "periodic"}
    rig = rattling(speeds=speeds, limits=limits)
    check = rig.check_limits()
    verdict = check.of("gap")
    above = verdict.values > verdict.allowed
    crossed = RPM * (2930 + 370 * (0.0076 - verdict.values[above][0]) / 0.0036)
    assert abs(check.speeds[above][0] / crossed - 1) < 1e-3
    assert abs(check.speeds[~above][-1] / crossed - 1) < 1e-3


def test_study_takes_the_motions_of_every_variant():
    from torsionnet.study import define, run_study

    speeds = {"of": "a", "list": ["3000 rpm"], "nonlinear": "periodic"}
    rig = rattling(speeds=speeds)
    asked = {"swing": {"type": "order_torque", "output": "twist(gap)"}}
    varied = {"one.inertia": {"type": "list", "values": [0.12, 0.13]}}
    found = run_study(define(rig, varied, asked)).values("swing")
    _close(float(found[0]), (0.02633979 - 0.01267718) / 2)
    assert abs(found[1] / found[0] - 1) > 1e-3


def test_page_over_speed_draws_what_is_met_and_says_so(rattler):
    shown = over_speed(rattler, "twist(gap)")
    _close(2 * shown["half_range"][1], 0.02761135 - 0.00605751)
    assert any("the largest motion of each output that is stable" in note for note in shown["notes"])


@pytest.mark.parametrize(
    ("change", "asked", "kind"),
    [
        ({}, {"nonlinear": "cubic"}, "unknown-word"),
        ({}, {"speeds": [1.0], "speed_of": "q"}, "unknown-node"),
        ({"linear": True}, {"nonlinear": "periodic"}, "no-effect"),
    ],
)
def test_what_cannot_be_answered_is_refused(change, asked, kind):
    rig = rattling(speeds={"of": "a", "list": ["3000 rpm"]})
    if change:
        rig = tn.Drivetrain(
            "linear",
            [*list(rig.elements.values())[:2], tn.Spring("gap", nodes=("a", "b"), stiffness=8000)],
            excitations={"shaker": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": "40 N*m"}}}},
            speeds={"of": "a", "list": ["3000 rpm"]},
        )
    with pytest.raises(UsageError, match=kind):
        rig.order_response("twist(gap)", **asked)


MODEL = """torsionnet: 1
name: rattling
elements:
  one: {type: inertia, node: a, inertia: 0.12}
  two: {type: inertia, node: b, inertia: 0.9}
  gap: {type: clearance, nodes: [a, b], gap: 2 deg, stiffness: 8000}
  oil: {type: damper, nodes: [a, b], damping: 3}
operating_point: {torque: {a: 25, b: -25}}
sensors: {swing: {twist: gap}}
speeds: {of: a, list: [3000 rpm]}
excitations: {shaker: {type: harmonic, node: a, orders: {1: {amplitude: 40}}}}
limits: {gap: {rule: curve, output: twist(gap), value: 0.01, source: maker}}
"""


def test_commands_take_the_word(tmp_path):
    path = tmp_path / "gap.yaml"
    path.write_text(MODEL)
    said = run("orders", str(path), "--output", "twist(gap)", "--nonlinear", "periodic", "--json").stdout
    (record,) = json.loads(said)
    _close(2 * record["outputs"][0]["half_range"][0], 0.02633979 - 0.01267718)
    shown = run("limits", str(path), "--nonlinear", "periodic").stdout
    assert "laws of motion in full" in shown


def test_report_draws_branches_in_german_words(tmp_path):
    path = tmp_path / "gap.yaml"
    path.write_text(MODEL.replace("3000 rpm]}", "2400 rpm, 3000 rpm], nonlinear: periodic}"))
    run("report", str(path), "--section", "periodic_motions", "--language", "de", "-o", str(tmp_path / "gap.md"))
    text = (tmp_path / "gap.md").read_text()
    assert "Periodische Bewegungen" in text
    assert "Periode verdoppelt sich" in text
    assert "2899" in text.replace(",", "")  # 48.316462 Hz
