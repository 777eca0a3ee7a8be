"""Poles against a measured input: the drivetrain cut there, or in general the rates that keep the reading at zero."""

import numpy as np
import pytest
from support.models import geared_line

import torsionnet as tn
from torsionnet.linear.dynamic_stiffness.transfer_request import resolve_request
from torsionnet.linear.modes.bordered_poles import measured_poles


def residue(model, output, measured, pole):
    """How large the transfer function gets next to a pole, against a place some way off."""
    near, off = pole * (1 + 1e-7), pole * (1 + 1e-3)
    values = [transfer(model, output, measured, s) for s in (near, off)]
    return abs(values[0] / values[1])


def transfer(model, output, measured, s):
    """The transfer function off the frequency axis, through the state space of all sensors."""
    space = model.to_control()
    names = list(model.sensors)
    values = np.asarray(space(s, squeeze=False))[:, 0, ...].ravel()
    return values[names.index(output)] / values[names.index(measured)]


def test_poles_are_those_of_the_transfer_function():
    rig = geared_line()
    modes = rig.modes(measured_input="T")
    assert modes.kinds == ("oscillatory", "real pole")
    for pole in modes.eigenvalues:
        assert residue(rig, "angle", "T", pole) == pytest.approx(1e4, rel=0.05)


def test_the_side_upstream_does_not_matter():
    heavy = geared_line(J_1=50).modes(measured_input="T").eigenvalues
    np.testing.assert_allclose(geared_line().modes(measured_input="T").eigenvalues, heavy, rtol=1e-13)


def test_downstream_of_the_cut_it_turns_round_with_the_excitation():
    """Driven from the gear, what is upstream of the meter is the gear side: only the motor and its node remain."""
    rig = geared_line()
    modes = rig.modes(measured_input="T", driven_by="g")
    assert modes.kinds == ("rigid body",)
    assert np.isnan(modes.shape_at("g")).all()


def test_the_general_way_agrees_with_the_cut():
    rig = geared_line()
    general, _ = measured_poles(rig, resolve_request(rig, "angle", "T", None))
    np.testing.assert_allclose(general.eigenvalues, rig.modes(measured_input="T").eigenvalues, rtol=1e-8)


def test_a_measured_angle_clamps_its_node():
    rig = geared_line()
    poles = rig.modes(measured_input="angle").eigenvalues
    clamped = (
        tn.Drivetrain("c", [*rig.elements.values(), tn.Lock("clamp", node="m")], rig.parameters).modes().eigenvalues
    )
    np.testing.assert_allclose(poles, clamped, rtol=1e-8)


def test_a_loop_past_the_meter_keeps_both_sides():
    rig = geared_line()
    bypass = [*rig.elements.values(), tn.Spring("past", nodes=("m", "g"), stiffness=250)]
    looped = tn.Drivetrain("loop", bypass, rig.parameters, rig.inputs, {**rig.sensors, "twist": {"twist": "soft"}})
    modes = looped.modes(measured_input="T")
    assert "does not cut the drivetrain in two" in modes.notes[0]
    for pole in modes.eigenvalues:
        assert residue(looped, "angle", "T", pole) == pytest.approx(1e4, rel=0.05)


def test_slow_poles_are_no_rigid_bodies():
    """A node held by 5 N m/rad and 100 N m s/rad relaxes at 0.05 rad/s, beside a mesh at 1e6 rad/s."""
    model = tn.Drivetrain(
        "p",
        [
            tn.Inertia("i", node="a", inertia=1),
            tn.Spring("s", nodes=("a", "b"), stiffness=1e5),
            tn.Inertia("j", node="b", inertia=0.1),
            tn.Spring("s2", nodes=("b", "c"), stiffness=5),
            tn.Damper("dc", nodes=("c", "ground"), damping=100),
            tn.Spring("mesh", nodes=("b", "d"), stiffness=1e9),
            tn.Inertia("pinion", node="d", inertia=1e-3),
        ],
        inputs={"T": {"torque": "a"}},
        sensors={"B": {"angle": "b"}},
    )
    modes = model.modes(measured_input="B")
    assert modes.kinds == ("real pole", "oscillatory")
    np.testing.assert_allclose(modes.eigenvalues, [-0.05, 1e6j], rtol=1e-6)


def test_a_measured_input_the_excitation_does_not_reach():
    rig = geared_line()
    behind = tn.Drivetrain(
        "x", [*rig.elements.values(), tn.Inertia("far", node="h", inertia=1)], rig.parameters, rig.inputs
    )
    with pytest.raises(tn.UsageError, match="does not reach"):
        behind.modes(measured_input="angle(h)")


def test_several_measured_inputs():
    rig = geared_line()
    poles = rig.modes(measured_input=["angle(m)", "angle(g)"], driven_by=["m", "g"])
    assert len(poles) == 0
    with pytest.raises(tn.UsageError, match=r"(?s)measured_input=.*wrong-count"):
        rig.modes(driven_by="m")


def test_a_spring_as_torque_meter_adds_its_own_pole():
    """theta_1/T_T of the DMF rig contains 1/(k_1 + c_1 s): a real pole at -k_1/c_1."""
    modes = tn.load("dmf_rig").modes(measured_input="T_T")
    assert modes.kinds == ("oscillatory", "real pole")
    assert modes.eigenvalues[1] == pytest.approx(-133000, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "words"), [("T_M", "no sensor"), ("torque(sof)", 'did you mean "soft"'), ("q", "no input")]
)
def test_wrong_measured_inputs(name, words):
    with pytest.raises(tn.UsageError, match=words):
        geared_line().modes(measured_input=name)


def test_torque_on_a_node_that_also_follows_an_imposed_angle():
    """Node c is the cage of a differential one side of which is held by an imposed angle: half of what drives it."""

    def rig(*, imposed):
        elements = [
            tn.Differential("D", cage="c", left="l", right="r"),
            tn.Inertia("J", node="l", inertia=2),
            tn.Spring("k", nodes=("l", "x"), stiffness=100),
            tn.Inertia("K", node="x", inertia=3),
            *([] if imposed else [tn.Lock("held", node="r")]),
        ]
        inputs = {"T": {"torque": "c"}} | ({"phi": {"angle": "r"}} if imposed else {})
        return tn.Drivetrain("axle", elements, inputs=inputs)

    found, expected = (rig(imposed=one).modes(measured_input="angle(x)", driven_by="T") for one in (True, False))
    assert found.eigenvalues == pytest.approx(expected.eigenvalues, rel=1e-12)
