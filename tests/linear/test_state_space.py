"""State space for python-control."""

import numpy as np
import pytest
from support.models import geared_line

import torsionnet as tn

F = np.array([0.2, 3.0, 17.0])


def agrees(model):
    space = model.to_control()
    H = model.frequency_response(list(model.sensors), list(model.inputs), F)
    response = np.moveaxis(space(2j * np.pi * F, squeeze=False), 2, 0)
    np.testing.assert_allclose(response, H.values, rtol=1e-9, atol=1e-12 * np.abs(H.values).max())
    return space


@pytest.mark.parametrize("name", ["dmf_rig", "amt_rig"])
def test_rigs(name):
    space = agrees(tn.load(name))
    assert space.input_labels == ["T_M"]
    assert space.output_labels == ["theta_1", "T_T"]


@pytest.mark.parametrize(("output", "input", "driven_by"), [("phi_1", "T_P", None), ("T_int", "T_thrust", "T_1")])
def test_far_below_the_peak(output, input, driven_by):
    """Three decades above the fastest mode, 1e-30 of the peak, as elimination along the graph has it."""
    ship = tn.load("two_stroke_ship")
    f = np.geomspace(1, 1e5, 16)
    H = ship.frequency_response(output, input, f, driven_by=driven_by)
    response = ship.to_control(output, input, driven_by=driven_by)(2j * np.pi * f)
    np.testing.assert_allclose(response, H.values[:, 0, 0], rtol=1e-9)


def test_massless_nodes_static_and_damped():
    parts = [
        tn.Inertia("j", node="a", inertia=2),
        tn.Spring("k1", nodes=("a", "b"), stiffness=300),
        tn.Spring("k2", nodes=("b", "c"), stiffness=500),
        tn.Damper("c", nodes=("c", "d"), damping=20),
        tn.Spring("k3", nodes=("d", "ground"), stiffness=400),
    ]
    sensors = {"s": {"torque": "k2"}, "v": {"velocity": "a"}, "acc": {"acceleration": "a"}, "b": {"angle": "b"}}
    model = tn.Drivetrain("maxwell", parts, inputs={"T": {"torque": "a"}, "T_b": {"torque": "b"}}, sensors=sensors)
    space = agrees(model)
    assert space.nstates == 3  # angle and speed of a, one state of the damper between massless nodes


def test_free_drivetrain_keeps_its_rigid_body():
    assert np.sort(np.abs(agrees(geared_line().switched(off=["brake", "stiff"])).poles()))[0] < 1e-6


def test_what_has_no_state_space_says_so():
    rig = geared_line()
    rate = tn.Drivetrain(
        "x",
        [
            tn.Inertia("j", node="a", inertia=1),
            tn.Spring("k", nodes=("a", "b"), stiffness=5),
            tn.Damper("c", nodes=("a", "ground"), damping=1),
        ],
        inputs={"T": {"torque": "b"}},
        sensors={"v": {"velocity": "b"}},
    )
    with pytest.raises(tn.UsageError, match="unsupported-law"):
        rate.to_control()
    hysteretic = [*rig.elements.values(), tn.HystereticSpring("rubber", nodes=("m", "g"), stiffness=9, loss_factor=0.1)]
    with pytest.raises(tn.UsageError, match="rubber"):
        tn.Drivetrain("h", hysteretic, rig.parameters, rig.inputs, rig.sensors).to_control()
    with pytest.raises(tn.UsageError, match="at least one input"):
        tn.Drivetrain("n", rig.elements.values(), rig.parameters).to_control()


def test_frequency_response_data():
    H = geared_line().frequency_response(["angle", "T"], "T_M", F)
    data = H.to_control()
    np.testing.assert_array_equal(np.moveaxis(data(1j * data.omega), 2, 0), H.values)
    assert data.output_labels == ["angle", "T"]


def test_a_dot_in_the_name_of_a_model():
    parts = [tn.Inertia("j", node="a", inertia=2), tn.Spring("k", nodes=("a", "ground"), stiffness=300)]
    model = tn.Drivetrain("2.0 l diesel", parts, inputs={"T": {"torque": "a"}}, sensors={"phi": {"angle": "a"}})
    assert agrees(model).name == "2_0 l diesel"


def test_states_are_named_after_what_they_are():
    """Two inertias; a massless node between damper and spring is a state, one between springs is none."""
    elements = [
        tn.Inertia("Ja", node="a", inertia=1),
        tn.Spring("k1", nodes=("a", "b"), stiffness=10),
        tn.Damper("c", nodes=("b", "ground"), damping=2),
        tn.Spring("k2", nodes=("a", "d"), stiffness=10),
        tn.Spring("k3", nodes=("d", "ground"), stiffness=10),
    ]
    rig = tn.Drivetrain("rig", elements, inputs={"T": {"torque": "a"}}, sensors={"b": {"angle": "b"}})
    space = rig.to_control()
    assert space.state_labels == ["velocity(a)", "angle(a)", "angle(b)"]
    np.testing.assert_allclose(space.A[2], [0, 5, -5])
