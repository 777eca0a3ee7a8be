"""Friction that may stick and slip under one mean torque: all balances, their stability, and the one taken."""

from itertools import pairwise

import pytest

import torsionnet as tn
from torsionnet.core.errors import ModelError

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
    with pytest.raises(ModelError, match=r"rub 110 N\*m against its slip of 50 rad/s\) leave -20 N\*m over"):
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
