"""Power that vibration dissipates: coupling heat by hand, every kind of element against its own law."""

import math
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from support.forced_plants import plant, reference

import torsionnet as tn
from torsionnet.machinery.mean.power_flow import _largest_over_angle

PSI, STIFFNESS, TORQUE, HZ = 1.13, 100e3, 5e3, 25.0


def shaken(elements, orders, nodes=("a",), **more):
    """Elements excited by harmonic torques at 600 r/min, 10 Hz, unless the speed is given."""
    return tn.Drivetrain(
        "shaken",
        elements,
        speeds={"of": "a", "list": more.pop("speeds", ["600 rpm"])},
        excitations={f"on_{node}": {"type": "harmonic", "node": node, "orders": orders} for node in nodes},
    )


def test_coupling_heat_is_that_of_the_whole_torque():
    """At 25 Hz, 5 kN m whole torque: 3421 W; 3531 W would be the elastic part, 3475 W a stiffness that is |k*|."""
    rubber = tn.HystereticSpring("rubber", nodes=("a", "ground"), stiffness=STIFFNESS, loss_factor={"psi": PSI})
    rig = shaken([tn.Inertia("J", node="a", inertia=1), rubber], {1: {"amplitude": 1}}, speeds=[f"{HZ * 60} rpm"])
    unit = abs(rig.order_response("torque(rubber)").values[0, 0, 0])
    power = rig.dissipated_power("rubber").of("rubber")[0] * (TORQUE / unit) ** 2
    assert power == pytest.approx(3421, abs=0.5)
    eta, w = PSI / (2 * math.pi), 2 * math.pi * HZ
    assert power == pytest.approx(w * eta * TORQUE**2 / (2 * STIFFNESS * (1 + eta**2)), rel=1e-12)
    assert power * (1 + eta**2) == pytest.approx(3531, abs=0.5)
    assert power * math.sqrt(1 + eta**2) == pytest.approx(3475, abs=0.5)


def test_orders_of_one_frequency_are_added_before_they_are_squared():
    elements = [
        tn.Inertia("J1", node="a", inertia=2),
        tn.Spring("k", nodes=("a", "b"), stiffness=1e4, damping=5),
        tn.Inertia("J2", node="b", inertia=1),
    ]
    orders = {1: {"amplitude": 10}, 2: {"amplitude": 4, "phase": "40 deg"}}
    both = shaken(elements, orders, nodes=("a", "b"))
    twist = both.order_response("twist(k)")
    expected = 0.0
    for order in (1, 2):
        gamma = abs(sum(twist.of_order(order, excitation=f"on_{node}")[0] for node in "ab"))
        expected += 5 * (order * 2 * math.pi * 10) ** 2 * gamma**2 / 2
    assert both.dissipated_power("k").of("k")[0] == pytest.approx(expected, rel=1e-12)


def test_what_dampers_take_is_what_excitation_gives():
    """Energy: the power of all torques on their nodes goes into the elements, whatever their kind."""
    elements = [
        tn.Inertia("J1", node="a", inertia=2),
        tn.Shaft("shaft", nodes=("a", "b"), outer_diameter=0.05, length=1, segments=3, damping=20),
        tn.ViscousDamper("damper", node="b", ring_inertia=0.5, damping=30, hub_inertia=0.1),
        tn.Gear("gear", nodes=("b", "c"), ratio=-2, stiffness=5e4, damping=10),
        tn.Spring("coupling", nodes=("c", "d"), stiffness=2e4, damping=8),
        tn.Inertia("J2", node="d", inertia=3),
        tn.Damper("water", nodes=("d", "ground"), damping=4),
    ]
    rig = shaken(elements, {1: {"amplitude": 10}, 2: {"amplitude": 4}}, speeds=["600 rpm", "1800 rpm"])
    taken = rig.dissipated_power(["shaft", "damper", "gear", "coupling", "water"])
    assert (taken.values > 0).all()
    velocity = rig.order_response("velocity(a)").values[:, :, 0]
    given = (np.array([10, 4]) * velocity.real).sum(axis=1) / 2
    assert taken.values.sum(axis=1) == pytest.approx(given, rel=1e-9)


def test_the_trucks_damper_against_its_film():
    data = reference("forced_inline_six")
    run = plant(data).configured("normal")
    film = next(spring for spring in data["model"]["springs"] if spring.get("damping") and not spring["stiffness"])
    twist = run.order_response(f"twist({film['name']})")
    rate = 2 * math.pi * twist.frequencies * np.abs(twist.values[:, :, 0])
    assert run.dissipated_power(film["name"]).of(film["name"]) == pytest.approx(
        film["damping"] * (rate**2).sum(axis=1) / 2, rel=1e-12
    )


def test_tables_say_which_torque_is_meant_and_names_are_checked():
    rig = shaken([tn.Inertia("J", node="a", inertia=1), tn.Damper("c", nodes=("a", "ground"), damping=2)],
                 {1: {"amplitude": 1}})  # fmt: skip
    found = rig.dissipated_power("c")
    table = found.table()
    assert any("whole torque" in note for note in table.notes)
    # c times half the square of the rate, which is 1/|j J omega + c|.
    for speed, (rpm, power) in zip(found.speeds, table.rows, strict=True):
        assert rpm == pytest.approx(speed * 30 / np.pi)
        assert power == pytest.approx(2 / 2 / (speed**2 + 4), rel=1e-9)
    with pytest.raises(tn.UsageError, match="unknown-element"):
        rig.dissipated_power("d")
    with pytest.raises(tn.UsageError, match="no power of"):
        found.of("J")


def test_waves_of_two_engines_without_a_common_cycle_reach_their_crests_together():
    waves = [SimpleNamespace(relative=Fraction(1, 10**9 + number), fixed=False) for number in (7, 9)]
    assert _largest_over_angle(np.array([[3 + 4j, -2]]), waves) == pytest.approx([7])
