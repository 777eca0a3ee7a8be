"""Laws over the rate under mean torques: all balances of friction, and machines with loads, which then stand still."""

from itertools import pairwise

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.errors import ModelError

STRIBECK = [["0 rad/s", "120 N*m"], ["50 rad/s", "110 N*m"], ["100 rad/s", "130 N*m"]]


def clutched(*faces):
    """Two rotors with friction between them."""
    rotors = [tn.Inertia("J1", node="a", inertia=0.5), tn.Inertia("J2", node="b", inertia=0.8)]
    return tn.Drivetrain("clutched", [*rotors, *faces])


def stribeck(name="rub", nodes=("a", "b")):
    return tn.Friction(name, nodes=nodes, torque_over_slip=STRIBECK)


def balances(plant, torque, **more):
    points = plant.operating_points(torque={"a": torque, "b": -torque}, **more)
    return [(round(one.states["rub"][0].rate, 9), one.is_stable) for one in points]


@pytest.mark.parametrize(
    ("torque", "expected"),
    [
        (90, [(0, True)]),
        (112, [(0, True), (40, False), (55, True)]),
        (-112, [(-55, True), (-40, False), (0, True)]),
        (120, [(0, True), (75, True)]),  # at the torque at which it breaks away it still sticks
        (121, [(77.5, True)]),
        (130, [(100, True)]),
    ],
)
def test_all_slips_of_friction_that_falls_and_rises(torque, expected):
    """By hand: 120 - 0.2 n up to 50 rad/s, 110 + 0.4 (n - 50) beyond; stable where it rises."""
    assert balances(clutched(stribeck()), torque) == expected


def test_friction_sticks_until_a_speed_says_that_it_slips():
    plant, torque = clutched(stribeck()), {"a": 112, "b": -112}
    stuck = plant.at(torque=torque)
    assert stuck.definition.tangents.state.states["rub"][0].rate == 0
    expected = "3 operating points are in balance, 2 of them stable; this is the one of them in which most friction"
    assert any(expected in note for note in stuck.modes().notes)
    slipping = plant.at(torque=torque, speed={"a": 155, "b": 100})
    assert any("rub slips at 55 rad/s, 112 N*m" in note for note in slipping.modes().notes)
    (pole,) = [one for one in slipping.modes().eigenvalues.tolist() if one]
    assert pole == pytest.approx(-0.4 * (1 / 0.5 + 1 / 0.8), rel=1e-9)


def test_speeds_that_are_not_in_balance_are_said():
    """Equal speeds are asked for under a torque that friction cannot hold, and a slip whose torque is another."""
    plant = clutched(stribeck())
    found = plant.at(torque={"a": 121, "b": -121}, speed={"a": 100, "b": 100})
    expected = "the speeds given are not in balance with the torques: rub slips at 77.5 rad/s"
    assert any(expected in note for note in found.modes().notes)
    with pytest.raises(ModelError, match=r"operating_point\.torque: .*110.*50.*unbalanced-torques"):
        plant.at(torque={"a": 90, "b": -90}, speed={"a": 150, "b": 100}).modes()


def test_two_frictions_side_by_side_share_the_torque_within_their_ranges():
    """120 and 20 N m hold 130 together, of which half each would be too much for the second; at 60 rad/s both slip.

    110 + 0.4 (n - 50) + 20 = 134 has the root 60 rad/s, 120 - 0.2 n + 20 = 134 the root 30.
    """
    plant = clutched(stribeck(), tn.Friction("ring", nodes=("a", "b"), torque=20))
    points = plant.operating_points(torque={"a": 130, "b": -130})
    assert [round(one.states["rub"][0].rate, 6) for one in points] == [0, 50]
    held = points[0].torques
    assert held["rub"][0] + held["ring"][0] == pytest.approx(130, rel=1e-9)
    assert held["ring"][0] <= 20 * (1 + 1e-9)
    assert balances(plant, 134) == [(0, True), (30, False), (60, True)]


def test_a_slip_beyond_the_table_is_no_balance_while_friction_holds():
    rows = [["0 rad/s", "120 N*m"], ["50 rad/s", "110 N*m"]]
    plant = clutched(tn.Friction("rub", nodes=("a", "b"), torque_over_slip=rows))
    ring = tn.Friction("ring", nodes=("a", "b"), torque=20)
    assert balances(plant, 100) == [(0, True)]
    both = clutched(tn.Friction("rub", nodes=("a", "b"), torque_over_slip=rows), ring)
    assert balances(both, 125) == [(0, True)]


def test_many_frictions_are_listed_up_to_a_limit():
    """Five in a row have 3^5 combinations: those that stick are left, and no plant hangs."""
    nodes = "abcdef"
    rotors = [tn.Inertia(f"J{node}", node=node, inertia=1) for node in nodes]
    faces = [stribeck(f"rub{first}", (first, second)) for first, second in pairwise(nodes)]
    points = tn.Drivetrain("row", [*rotors, *faces]).operating_points(torque={"a": 112, "f": -112})
    assert [one.sticking for one in points] == [5]


def kloss(speed):
    slip = 1 - speed / 150
    return 2 * 520 * slip * 0.18 / (slip**2 + 0.18**2)


MACHINES = {
    "induction": (
        tn.InductionMachine("drive", node="a", synchronous_speed=150, breakdown_torque=520, breakdown_slip=0.18),
        kloss,
    ),
    "own slip": (  # about which it is linear in results without an operating point
        tn.InductionMachine(
            "drive", node="a", synchronous_speed=150, breakdown_torque=520, breakdown_slip=0.18, slip=0.02
        ),
        kloss,
    ),
    "power": (tn.ConstantPowerLoad("drive", node="a", power="-20 kW"), lambda speed: 20e3 / speed),
    "torque": (None, lambda speed: 200 + 0 * speed),
}
"""Machines on node a, and their torques in N m over the speed of a in rad/s."""
LOADS = {
    "propeller": (
        tn.Propeller("load", node="c", inertia=0, exponent=2, torque=125, speed=50),
        lambda speed: 125 * (speed / 50) ** 2,
    ),
    "open water": (
        tn.Propeller(
            "load", node="c", inertia=0, torque=125, speed=50,
            torque_slope=-0.05, torque_coefficient=0.03, advance_ratio=0.6,
        ),
        lambda speed: 125 * ((1 + 1) * (speed / 50) ** 2 - 1 * speed / 50),
    ),
    "bearing": (tn.Damper("load", nodes=("c", "ground"), damping=3), lambda speed: 3 * speed),
    "rubbing": (tn.Friction("load", nodes=("c", "ground"), torque=60), lambda speed: 60 + 0 * speed),
}  # fmt: skip
"""Loads on node c, which turns half as fast as a, and their torques over the speed of c."""


@pytest.mark.parametrize("bearing", [0.0, 0.4])
@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("machine", MACHINES)
def test_every_load_counts_and_the_plant_stands_still_there(machine, load, bearing):
    """The sum of torques over the speed, written down anew, is zero; a motion that starts there stays."""
    if (machine, load, bearing) == ("torque", "rubbing", 0.0):
        pytest.skip("200 N m against 30 at any speed")
    drive, driving = MACHINES[machine]
    brake, braking = LOADS[load]
    rotors = [tn.Inertia("J1", node="a", inertia=0.9), tn.Inertia("J2", node="c", inertia=2.1)]
    line = [
        tn.Spring("shaft", nodes=("a", "b"), stiffness=6000, damping=1.1),
        tn.Gear("gear", nodes=("b", "c"), ratio=2),
    ]
    held = [tn.Damper("plain", nodes=("b", "ground"), damping=bearing)] if bearing else []
    torques = {"a": -20.0 if drive else 180.0}
    plant = tn.Drivetrain("pair", [*rotors, *line, brake, *held, *([drive] if drive else [])])
    if not any(one.has_motion_laws for one in plant.definition.switched_on):
        pytest.skip("a linear drivetrain has no law whose state is sought")

    def over(speed):
        return driving(speed) - 20 - braking(speed / 2) / 2 - bearing * speed

    fine = np.linspace(1.0, 3000.0, 60_001)
    left = over(fine)
    # Between two points of unlike signs the torque is as good as straight.
    crossings = [
        float(fine[at] - left[at] * (fine[at + 1] - fine[at]) / (left[at + 1] - left[at]))
        for at in np.flatnonzero((np.sign(left[:-1]) != np.sign(left[1:])) & (left[:-1] != 0))
    ]
    turning = [point for point in plant.operating_points(torque=torques) if point.speeds["a"] > 1]
    assert [point.speeds["a"] for point in turning] == pytest.approx(crossings, abs=0.02)
    for point in turning:
        speed = point.speeds["a"]
        assert over(speed) == pytest.approx(0, abs=1e-9 * max(driving(speed), 20.0))
        assert point.is_stable == (over(1.001 * speed) < over(0.999 * speed))
    (stable,) = [point for point in turning if point.is_stable]
    if len(turning) < len(plant.operating_points(torque=torques)):
        return  # friction that sticks is where it starts
    motion = plant.simulate("velocity(a)", {"a": np.full(400, torques["a"])}, 1000.0, initial_state="operating_point")
    np.testing.assert_allclose(motion["velocity(a)"].values, stable.speeds["a"], rtol=1e-9)


def test_bearings_on_both_sides_of_friction_that_slips():
    """By hand: 40 N m turn b against 2 N m s at 20 rad/s, and 150 - 40 turn a against 0.5 at 220."""
    ends = [tn.Damper(f"bearing_{node}", nodes=(node, "ground"), damping=c) for node, c in (("a", 0.5), ("b", 2.0))]
    plant = clutched(tn.Friction("rub", nodes=("a", "b"), torque=40), *ends)
    (point,) = plant.operating_points(torque={"a": 150})
    assert point.speeds == pytest.approx({"a": 220, "b": 20})
    motion = plant.simulate("velocity(b)", {"a": np.full(400, 150.0)}, 1000.0, initial_state="operating_point")
    np.testing.assert_allclose(motion["velocity(b)"].values, 20, rtol=1e-9)


@pytest.mark.parametrize("sense", [1, -1])
def test_a_clutch_breaks_away_above_the_torque_with_which_it_slips(sense):
    """100 - 0.4 n up to 50 rad/s, 80 + 0.4 (n - 50) beyond; it holds 130 N m."""
    rows = [["0 rad/s", "100 N*m"], ["50 rad/s", "80 N*m"], ["200 rad/s", "140 N*m"]]
    faces = {"nodes": ("a", "b"), "state": "slipping", "stick": "130 N*m"}
    by_torque = tn.Clutch("rub", torque=rows, **faces)
    coefficients = [[slip, float(torque.split()[0]) / 400] for slip, torque in rows]
    by_clamp = tn.Clutch("rub", friction=coefficients, clamp_torque="400 N*m", **faces)
    for clutch in (by_torque, by_clamp):
        plant = clutched(clutch)
        assert balances(plant, 90) == [(0, True), (25, False), (75, True)]
        assert balances(plant, 129 * sense) == sorted([(0, True), (172.5 * sense, True)])
        assert balances(plant, 131 * sense) == [(177.5 * sense, True)]
    ramp = np.linspace(0, 200, 401)  # breaks away at 130 N m, between the samples 260 and 261
    record = clutched(by_torque).simulate(["velocity(a)", "velocity(b)"], {"a": ramp, "b": -ramp}, 200.0)
    slip = record["velocity(a)"].values - record["velocity(b)"].values
    assert abs(slip[:261]).max() < 1e-9
    assert slip[265] > 0.5


@pytest.mark.parametrize("torque", [60, -60])
def test_the_static_points_of_a_magnetic_coupling(torque):
    """500 N m/rad up to 0.2 rad, then it falls to nothing at 0.6 rad: 60 N m at 0.12 rad, and at 0.36, which falls off."""
    rows = [["0 rad", "0 N*m"], ["0.2 rad", "100 N*m"], ["0.6 rad", "0 N*m"]]
    plant = clutched(tn.Spring("magnet", nodes=("a", "b"), torque_over_twist=rows, damping=0.5))
    points = plant.operating_points(torque={"a": torque, "b": -torque})
    sign = torque / 60
    assert [(round(one.states["magnet"][0].twist * sign, 12), one.is_stable) for one in points] == [
        (0.12, True),
        (0.36, False),
    ]
    (vibration,) = [
        one for one in plant.at(torque={"a": torque, "b": -torque}).modes().undamped_natural_frequencies if one > 1e-6
    ]
    assert vibration == pytest.approx(np.sqrt(500 * (1 / 0.5 + 1 / 0.8)) / (2 * np.pi), rel=1e-9)
    steady = {"a": np.full(300, float(torque)), "b": np.full(300, -float(torque))}
    motion = plant.simulate("twist(magnet)", steady, 1000.0, initial_state="operating_point")
    np.testing.assert_allclose(motion["twist(magnet)"].values * sign, 0.12, rtol=1e-9)
    with pytest.raises(ModelError, match=r"101 N\*m.*no-solution"):
        plant.at(torque={"a": 101, "b": -101}).modes()
