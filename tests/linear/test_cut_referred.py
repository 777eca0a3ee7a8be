"""Rigs cut at a torque meter with values that are quoted at a shaft on the other side of the cut."""

import numpy as np
import pytest

import torsionnet as tn

F = np.geomspace(0.1, 30, 40)
QUOTED = {"referred_to": "m"}
SQUARE = 16  # of the ratio between motor and meter


def rig(*, quoted, shaft_alone=False):
    """Motor, gear 4:1, rigid meter, hub of 0.5 kg m^2, shaft of 1000 N m/rad and 0.6 N m s/rad, brake of 2 kg m^2, oil."""
    where, share = (QUOTED, 1 / SQUARE) if quoted else ({}, 1)
    shaft, part = (QUOTED, 1 / SQUARE) if quoted or shaft_alone else ({}, 1)
    elements = [
        tn.Inertia("motor", node="m", inertia=0.1),
        tn.Gear("gear", nodes=("m", "a"), ratio="tau"),
        tn.RigidCoupling("meter", nodes=("a", "c")),
        tn.Inertia("hub", node="c", inertia=0.5 * share, **where),
        tn.Spring("shaft", nodes=("c", "b"), stiffness=1000 * part, damping=0.6 * part, **shaft),
        tn.Damper("oil", nodes=("b", "ground"), damping=3 * share, **where),
        tn.Inertia("brake", node="b", inertia=2 * share, **where),
    ]
    sensors = {"T_T": {"torque": "meter"}, "phi": {"angle": "b"}, "phi_m": {"angle": "b", "referred_to": "m"}}
    return tn.Drivetrain("rig", elements, {"tau": 4}, {"T_M": {"torque": "m"}}, sensors)


@pytest.mark.parametrize("quoted", [False, True])
def test_poles_against_the_meter_are_those_of_the_side_beyond(quoted):
    """Hub and brake on their shaft, written down by hand."""
    M, K = np.diag([0.5, 2.0]), 1000 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    C = 0.6 / 1000 * K + np.diag([0.0, 3.0])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    expected = np.linalg.eigvals(A)
    found = rig(quoted=quoted).modes(measured_input="T_T").eigenvalues
    assert len(found) == 3  # one of the pair, and both real poles
    assert all(np.abs(expected - pole).min() < 1e-9 for pole in found)
    assert np.abs(found.imag).max() == pytest.approx(np.abs(expected.imag).max())


@pytest.mark.parametrize("output", ["phi", "phi_m"])
def test_formula_against_the_meter_is_the_response(output):
    """Also of an angle that is referred to the shaft before the cut."""
    plant = rig(quoted=True)
    formula = plant.symbolic().transfer_function(output, "T_T")
    expected = plant.frequency_response(output, "T_T", F).values[:, 0, 0]
    assert formula.evaluate(F).values[:, 0, 0] == pytest.approx(expected, rel=1e-9)


def test_derivative_to_the_ratio_before_the_cut_counts():
    """The stiffness at the shaft is k/tau^2 of the one quoted at the motor: central differences of the pole."""
    plant, step = rig(quoted=False, shaft_alone=True), 1e-4

    def poles(tau):
        found = plant.configured(tau=tau).modes(measured_input="T_T").eigenvalues
        return found[np.abs(found.imag) > 1]

    slopes = tn.sensitivity.mode_sensitivities(plant, ["tau"], measured_input="T_T")
    vibrates = np.abs(slopes.poles.imag) > 1
    assert slopes.poles[vibrates] == pytest.approx(poles(4))
    assert slopes.pole_slopes[vibrates].ravel() == pytest.approx(
        (poles(4 + step) - poles(4 - step)) / (2 * step), rel=1e-5
    )
