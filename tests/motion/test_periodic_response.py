"""Periodic responses as users ask for them: branches, jumps, doubled motions, starts of simulations, bad questions."""

from __future__ import annotations

import json
from functools import partial
from math import pi

import numpy as np
import pytest
from support.command_line import run
from support.periodic_rigs import car, duffing, free_clearance, gear_pair, order_2, rubbing_mass, two_stage_rig

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.motion import MotionStart
from torsionnet.motion.periodic.periodic_result import FoundMotion, PeriodicResponse

RPM = pi / 30


def _close(found: float, wanted: float, share: float = 1e-5) -> None:
    assert abs(found - wanted) <= share * abs(wanted), (found, wanted)


@pytest.fixture(scope="module")
def driven_car() -> PeriodicResponse:
    gas = {"type": "harmonic", "node": "engine", "orders": {
        2: {"amplitude": "300 N*m"}, 4: {"amplitude": "60 N*m", "phase": "-90 deg"}}}  # fmt: skip
    rig = car(excitations={"gas": gas}, operating_point={"torque": {"engine": "60 N*m", "vehicle": "-60 N*m"}})
    speeds = [rpm * RPM for rpm in (1050, 1150, 1300, 1700, 2000)]
    return rig.periodic_response("twist(dmf)", speeds=speeds, speed_of="engine", subharmonics=2)


def test_car_booms_only_on_the_way_down(driven_car):
    (down, caught), (up, left) = sorted(driven_car.jumps)
    assert (down, up) == ("run-down", "run-up")
    _close(caught / RPM, 1102.2643)
    _close(left / RPM, 1180.922)
    swings = [driven_car.peak_to_peak(one) for one in driven_car.motions_at(1150 * RPM)]
    for found, wanted in zip(sorted(swings), (0.15954798, 0.22471678, 0.25328757), strict=True):
        _close(found, wanted)
    assert len(driven_car.stable_at(1150 * RPM)) == 2


@pytest.mark.slow
def test_both_jumps_are_told_from_motions_close_beside_a_fold():
    gas = {"type": "harmonic", "node": "engine", "orders": {
        2: {"amplitude": "300 N*m"}, 4: {"amplitude": "60 N*m", "phase": "-90 deg"}}}  # fmt: skip
    rig = car(excitations={"gas": gas}, operating_point={"torque": {"engine": "60 N*m", "vehicle": "-60 N*m"}})
    speeds = np.array([1000, 1000 + 27 * 2000 / 299, 1300]) * RPM
    found = rig.periodic_response("twist(dmf)", speeds=speeds, speed_of="engine")
    assert sorted(way for way, _ in found.jumps) == ["run-down", "run-up"]
    turns = [one.turn or one.stability for one in found.motions if 1170 < one.at / RPM < 1185]
    assert turns[:3] == ["stable", "fold", "unstable: leaves"]


def test_car_at_1700_rpm_is_met_with_order_1(driven_car):
    (met,) = driven_car.stable_at(1700 * RPM)
    assert met.periods == 2
    _close(driven_car.peak_to_peak(met), 0.09489966)
    _close(driven_car.amplitude_of_order(met, 1), 0.03709959)
    _close(driven_car.amplitude_of_order(met, 2), 0.01857517)
    doubles = sorted(one.at / RPM for one in driven_car.turns("doubling"))
    _close(doubles[0], 1529.144)
    _close(doubles[-1], 1875.612)
    shown = driven_car.table().to_text()
    assert "unstable: doubles" in shown
    assert "repeats after 2 periods" in shown


def test_result_is_read_back_with_all_its_numbers(driven_car, tmp_path):
    driven_car.to_json(tmp_path / "car.json")
    again = PeriodicResponse.from_json(tmp_path / "car.json")
    assert again.table().to_text() == driven_car.table().to_text()
    assert again.motions[0].multipliers.dtype == complex


def test_unstable_parts_are_dashed(driven_car):
    (axes,) = tn.plot.periodic_response(driven_car).axes
    styles = {line.get_linestyle() for line in axes.lines}
    assert {"-", "--"} <= styles
    assert ":" not in styles


Swept = dict[str, tuple[float, float, int, float]]
"""Torques by input: mean and amplitude in N m, harmonic, and phase in degrees."""
CAR: Swept = {"T_2": (60, 300, 1, 0), "T_4": (0, 60, 2, -90), "T_V": (-60, 0, 1, 0)}


def _car() -> tn.Drivetrain:
    return car(
        inputs={name: {"torque": node} for name, node in (("T_2", "engine"), ("T_4", "engine"), ("T_V", "vehicle"))}
    )


@pytest.mark.parametrize(
    ("rig", "output", "torques", "at", "periods"),
    [
        (two_stage_rig, "twist(dmf)", {"motor": (40, 60, 1, 0)}, 11, 1),
        *(
            pytest.param(*case, marks=pytest.mark.nightly)
            for case in (
                (duffing, "a", {"a": (0, 0.18, 1, 0)}, 1.2 / (2 * pi), 1),
                (two_stage_rig, "twist(dmf)", {"motor": (40, 60, 1, 0)}, 15, 2),
                (gear_pair, "x", {"x": (0.1, 0.032, 1, 0)}, 0.7 / (2 * pi), 1),
                (rubbing_mass, "x", {"x": (0, 3, 1, 0)}, 13.15039, 1),
                (free_clearance, "twist(gap)", {"a": (25, 40, 1, 0), "b": (-25, 0, 1, 0)}, 30, 1),
                (free_clearance, "twist(gap)", {"a": (25, 40, 1, 0), "b": (-25, 0, 1, 0)}, 45, 2),
                (_car, "twist(dmf)", CAR, order_2(1150), 1),
                (_car, "twist(dmf)", CAR, order_2(1700), 2),
                (partial(gear_pair, 0.06), "x", {"x": (0.12, 0.6, 1, 0)}, 1.9 / (2 * pi), 2),
            )
        ),
    ],
)
def test_simulation_stays_on_a_stable_motion_and_leaves_an_unstable_one_at_its_multiplier(
    rig, output, torques: Swept, at, periods
):
    plant = rig()
    loads = {
        name: {h: a for h, a in ((0, mean), (harmonic, amplitude * np.exp(1j * np.radians(phase)))) if a}
        for name, (mean, amplitude, harmonic, phase) in torques.items()
    }
    found = plant.periodic_response(output, frequencies=[at], excitation=loads, subharmonics=periods)
    courses = {
        name: {"mean": mean, "amplitude": amplitude, "frequency": harmonic * at, "phase": np.radians(phase)}
        if amplitude
        else mean
        for name, (mean, amplitude, harmonic, phase) in torques.items()
    }

    def swept(motion: FoundMotion, count: int, samples: int, nudge: float = 0.0) -> np.ndarray:
        """Output over so many periods from a motion, at ``samples`` points of a period of the torques."""
        scenario = {"type": "torques", "duration": count / at, "rate": samples * at, "torque": courses}
        angles = {node: angle * (1 + nudge) + nudge / 100 for node, angle in motion.angles.items()}
        start = MotionStart(angles=angles, speeds=motion.speeds)
        return plant.simulate([output], scenario=scenario, initial_state=start)[output].values

    assert any(motion.periods == periods for motion in found.stable_at(at))
    for motion in found.motions_at(at):
        if motion.is_stable:
            values = swept(motion, 50 * motion.periods, 16)
            assert np.abs(values[-1] - values[0]) < 1e-7 * np.ptp(values)
            continue
        # until it has left by a factor of 1000 it leaves along the vector of its multiplier
        multiplier = motion.multipliers[0].real
        count = int(np.log(1e3) / np.log(abs(multiplier)))
        off = swept(motion, count, 1, 1e-7) - swept(motion, count, 1)
        assert abs(off[-1] / off[-2] - multiplier) < 2e-3 * abs(multiplier)


@pytest.mark.slow
def test_one_harmonic_says_how_far_it_is_off():
    found = two_stage_rig().periodic_response(
        "twist(dmf)", frequencies=[10.0, 10.1], excitation={"T_M": {0: 40, 1: 60}}, harmonics=1
    )
    (motion,) = found.motions_at(10.0)
    _close(2 * abs(motion.amplitudes[1, 0]), 0.72260077, 1e-6)
    assert any("with 1 harmonic, further ones would move" in note for note in found.notes)


def test_means_of_the_operating_point_act_where_none_is_given():
    rig = free_clearance()
    loaded = tn.Drivetrain(
        "loaded", list(rig.elements.values()), operating_point={"torque": {"a": "25 N*m", "b": "-25 N*m"}}
    )
    found = loaded.periodic_response("twist(gap)", frequencies=[50.0, 55.0], excitation={"a": {1: 40}})
    (motion,) = found.motions_at(50.0)
    _close(float(motion.highest[0]), 0.02633979)
    _close(float(motion.lowest[0]), 0.01267718)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"excitation": {"a": 1}}, "wrong-form"),
        ({"frequencies": [1.0]}, "excitation= gives torques"),
        ({"frequencies": [0.0], "excitation": {"a": 1}}, "out-of-range"),
        ({"frequencies": [1.0], "excitation": {"a": {0: 1}}}, "no torque vibrates"),
        ({"frequencies": [1.0], "excitation": {"a": {0: 1j, 1: 1}}}, "wrong-form"),
        ({"frequencies": [1.0], "excitation": {"b": 1}}, 'no node is named "b"|named "b"'),
        ({"frequencies": [1.0], "excitation": {"a": 1}, "harmonics": 0}, "out-of-range"),
        ({"frequencies": [1.0], "excitation": {"a": 1}, "speed_of": "a"}, "contradicting-entries"),
        ({"frequencies": [1.0], "excitation": {"a": 1}, "output": []}, "missing-entry"),
        ({"frequencies": [1.0], "excitation": {"a": 1}, "subharmonics": 3}, "another power of 2"),
        ({"frequencies": [1.0], "speeds": [1.0]}, "not both"),
    ],
)
def test_questions_that_make_no_sense(asked, message):
    with pytest.raises(UsageError, match=message):
        duffing().periodic_response(**{"output": "a", **asked})


def test_linear_drivetrains_and_loose_loads_are_refused():
    linear = tn.Drivetrain(
        "linear", [tn.Inertia("mass", node="a", inertia=1), tn.Spring("shaft", nodes=("a", "ground"), stiffness=4)]
    )
    with pytest.raises(UsageError, match="no laws of motion"):
        linear.periodic_response("a", frequencies=[1.0], excitation={"a": 1})
    with pytest.raises(UsageError, match="do not balance"):
        free_clearance().periodic_response("twist(gap)", frequencies=[50.0], excitation={"a": {0: 25, 1: 40}})


def test_command_prints_every_motion(tmp_path):
    model = tmp_path / "cubic.yaml"
    model.write_text(duffing().to_yaml(), encoding="utf-8")
    frequency = 1.2 / (2 * pi)
    options = ["--output", "a", "--frequencies", f"{frequency!r},0.2", "--torque", "a=0,0.18"]
    (record,) = json.loads(run("periodic", str(model), *options, "--json").stdout)
    here = [one for one in record["motions"] if abs(one["at"] - frequency) < 1e-9]
    assert [one["stability"] for one in here] == ["stable", "unstable: leaves", "stable"]
    _close(max(one["highest"] for one in here), 2.54557670, 1e-6)
    assert "goes with --frequencies" in run("periodic", str(model), *options[:2], *options[4:], code=2).stderr
    assert 'got "0,much" [wrong-form]' in run("periodic", model, *options[:4], "--torque", "a=0,much", code=2).stderr
