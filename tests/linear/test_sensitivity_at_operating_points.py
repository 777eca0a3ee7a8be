"""Derivatives about operating points: torques, stiffnesses and ratios move the states of smooth laws of motion."""

from math import pi, sqrt

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.linear.sensitivity import mode_sensitivities
from torsionnet.linear.sensitivity.parametric import parametric_response

FREQUENCIES = [3.0, 5.0, 9.0]


def slopes_of(make, start):
    """Derivatives of ``make(*values)`` to every value by differences of fourth order, one row each."""
    found = []
    for place, value in enumerate(start):
        h = 1e-3 * value
        one, two, three, four = (
            make(*[*start[:place], value + share * h, *start[place + 1 :]]) for share in (1, -1, 2, -2)
        )
        found.append((8 * (one - two) - (three - four)) / (12 * h))
    return np.array(found)


def duffing(torque=60.0, k=450.0, cubic=3000.0, inertia=0.5):
    """One rotor on a spring k phi + k3 phi^3 under a mean torque."""
    elements = [
        tn.Inertia("rotor", node="a", inertia="J"),
        tn.Spring("disc", nodes=("a", "ground"), stiffness="k", cubic="k3"),
    ]
    parameters = {"T": torque, "k": k, "k3": cubic, "J": inertia}
    return tn.Drivetrain("duffing", elements, parameters=parameters, operating_point={"torque": {"a": "T"}})


def test_frequency_of_a_cubic_spring_moves_with_the_torque():
    """By hand: k_t = k + 3 k3 g^2, T = k g + k3 g^3, so dk_t/dT = 6 k3 g/k_t, dk_t/dk = 1 - 6 k3 g^2/k_t, ..."""
    found = mode_sensitivities(duffing(), ["T", "k", "k3", "J"])
    k, k3, J = 450.0, 3000.0, 0.5
    g = float(np.roots([k3, 0, k, -60.0])[-1].real)
    kt = k + 3 * k3 * g**2
    rates = np.array([6 * k3 * g / kt, 1 - 6 * k3 * g**2 / kt, 3 * g**2 - 6 * k3 * g**4 / kt])
    by_hand = [*rates / (4 * pi * sqrt(kt * J)), -sqrt(kt / J) / (4 * pi * J)]
    np.testing.assert_allclose(found.frequency_slopes[0], by_hand, rtol=1e-8)
    assert any("operating point under a 60 N*m" in note for note in found.notes)
    assert any("operating point under a 60 N*m" in note for note in found.table().notes)
    assert any("operating point under a 60 N*m" in note for note in found.remarks)


def test_pole_of_a_motor_moves_with_torque_and_slip():
    """Kloss: with s = s_k (x - sqrt(x^2 - 1)), x = T_k/T, the pole of the rotor is -2 T_k s_k (s_k^2 - s^2)/..."""

    def motor(breakdown, slip, torque):
        machine = tn.InductionMachine(
            "motor", node="a", synchronous_speed=100, breakdown_torque="Tk", breakdown_slip="sk", inertia=0.4
        )
        parameters = {"Tk": breakdown, "sk": slip, "T": torque}
        return tn.Drivetrain("m", [machine], parameters=parameters, operating_point={"torque": {"a": "-T"}})

    def pole(breakdown, slip, torque):
        x = breakdown / torque
        s = slip * (x - sqrt(x**2 - 1))
        return np.array([-2 * breakdown * slip * (slip**2 - s**2) / (100 * (s**2 + slip**2) ** 2) / 0.4])

    start = [400.0, 0.1, 240.0]
    found = mode_sensitivities(motor(*start), ["Tk", "sk", "T"])
    np.testing.assert_allclose(found.poles, pole(*start), rtol=1e-12)
    np.testing.assert_allclose(found.pole_slopes[0], slopes_of(pole, start)[:, 0], rtol=1e-7)


def test_no_derivative_at_the_breakdown_torque():
    machine = tn.InductionMachine(
        "motor", node="a", synchronous_speed=100, breakdown_torque=400, breakdown_slip=0.1, inertia=0.4
    )
    drive = tn.Drivetrain("m", [machine], parameters={"T": 400}, operating_point={"torque": {"a": "-T"}})
    with pytest.raises(UsageError, match="unsupported-law"):
        mode_sensitivities(drive, ["T"])


def geared(torque, ratio, k, cubic, shaft):
    """A cubic spring quoted at the fast shaft, in a loop with a linear spring, behind a gear, on a free drivetrain."""
    elements = [
        tn.Inertia("J1", node="a", inertia=0.5),
        tn.Spring("disc", nodes=("a", "b"), stiffness="k", cubic="k3", referred_to="w", damping=0.3),
        tn.Spring("beside", nodes=("a", "b"), stiffness="ks"),
        tn.Inertia("J2", node="b", inertia=1),
        tn.Gear("gear", nodes=("b", "w"), ratio="i"),
        tn.Spring("shaft", nodes=("w", "v"), stages=[{"stiffness": 800, "to": "0.2 rad"}, {"stiffness": 1500}]),
        tn.Inertia("J3", node="v", inertia=9),
    ]
    parameters = {"T": torque, "i": ratio, "k": k, "k3": cubic, "ks": shaft}
    point = {"torque": {"a": "T", "v": "-i*T"}}
    return tn.Drivetrain("geared", elements, parameters=parameters, operating_point=point)


@pytest.mark.slow
def test_responses_and_derivatives_have_the_operating_point_of_their_values():
    """At values beside those of the drivetrain too: a fit moves torques, ratios and stiffnesses."""

    def response(*values):
        return geared(*values).frequency_response("torque(disc)", "a", FREQUENCIES).values[:, 0, 0]

    start, names = [60.0, 2.0, 150.0, 900.0, 400.0], ["T", "i", "k", "k3", "ks"]
    asked = parametric_response(geared(*start), "torque(disc)", "a", FREQUENCIES, names)
    for values in (start, [140.0, 1.5, 120.0, 2000.0, 500.0]):
        found = asked.evaluation(values)
        np.testing.assert_allclose(found.values[:, 0, 0], response(*values), rtol=1e-10)
        np.testing.assert_allclose(found.jacobian[:, 0, 0].T, slopes_of(response, values), rtol=1e-6, atol=1e-9)


def test_a_fit_moves_the_stage_with_the_torque():
    """Values on another stage, which a preload lets stand still: the constraint comes and goes with the torque."""

    def plant(torque):
        stages = [{"stiffness": 450, "to": "0.1 rad"}, {"stiffness": 1800, "preload": "20 N*m"}]
        elements = [
            tn.Inertia("rotor", node="a", inertia=0.5),
            tn.Spring("disc", nodes=("a", "b"), stages=stages, damping=0.3),
            tn.Inertia("mass", node="b", inertia=0.5),
            tn.Spring("foot", nodes=("b", "ground"), stiffness=700, damping=1),
        ]
        return tn.Drivetrain("p", elements, parameters={"T": torque}, operating_point={"torque": {"a": "T"}})

    asked = parametric_response(plant(20.0), "b", "a", FREQUENCIES, ["T"])
    for torque in (20.0, 55.0, 90.0):
        own = plant(torque).frequency_response("b", "a", FREQUENCIES).values
        np.testing.assert_allclose(asked.evaluation([torque]).values, own, rtol=1e-10)
        assert not asked.evaluation([torque]).jacobian.any()
