"""Working points given by parameters: each value gives the element that has the number in their place."""

import numpy as np
import pytest
from support.study_blocks import together

import torsionnet as tn
from torsionnet.base.errors import ModelError
from torsionnet.io.fmu.traced_numbers import trace_motion
from torsionnet.linear.sensitivity import mode_sensitivities
from torsionnet.study.quantities.quantity import QUANTITIES

SLIP = [["0 rad/s", "200 N*m"], ["10 rad/s", "190 N*m"], ["30 rad/s", "185 N*m"]]
STAGES = [
    {"stiffness": 300, "to": "150 N*m"},
    {"stiffness": 1000, "to": "250 N*m"},
    {"stiffness": 2000, "to": "400 N*m"},
]
CAPACITY = {"pump_torque": [[0, 180], [0.5, 170], [1, 100]], "test_speed": 200}
ELEMENTS = {
    "clutch": lambda at: tn.Clutch("e", nodes=("a", "b"), state="slipping", slip_speed=at, torque=SLIP),
    "flywheel": lambda at: tn.DualMassFlywheel(
        "e", nodes=("a", "b"), primary_inertia=0.1, secondary_inertia=0.1, stages=STAGES, torque=at
    ),
    "converter": lambda at: tn.TorqueConverter(
        "e", pump="a", turbine="b", speed=150, speed_ratio=at, torque_ratio=[[0, 2.2], [1, 1]], **CAPACITY
    ),
    "coupling": lambda at: tn.FluidCoupling("e", pump="a", turbine="b", speed=150, speed_ratio=at, **CAPACITY),
}  # fmt: skip
POINTS = {
    "clutch": (-25.0, -4.0, 4.0, 10.0, 25.0),
    "flywheel": (-300.0, 20.0, 150.0, 200.0, 399.0),
    "converter": (0.0, 0.25, 0.5, 0.75, 1.0),
    "coupling": (0.1, 0.5, 0.9),
}
BEYOND = {"clutch": 31, "flywheel": -401, "converter": 1.1, "coupling": 1.2}
F = [1.0, 7.0, 30.0]


def rig(kind, at, value=None):
    elements = [
        tn.Inertia("J_a", node="a", inertia=2),
        tn.Spring("S_a", nodes=("a", "ground"), stiffness=4000, damping=9),
        ELEMENTS[kind](at),
        tn.Inertia("J_b", node="b", inertia=3),
        tn.Spring("S_b", nodes=("b", "ground"), stiffness=900, damping=7),
    ]
    return tn.Drivetrain(
        "rig", elements, parameters={} if value is None else {"p": value}, inputs={"T": {"torque": "a"}}
    )


@pytest.mark.parametrize(("kind", "value"), [(kind, one) for kind, points in POINTS.items() for one in points])
def test_a_parameter_is_as_its_number(kind, value):
    given, plain = rig(kind, "p", value), rig(kind, value)
    found, expected = (one.frequency_response(["a", "b"], "T", F).values for one in (given, plain))
    np.testing.assert_array_equal(found, expected)
    symbols = given.symbolic()
    for name in ("M", "C", "K"):
        expected = getattr(plain.symbolic(), name)
        difference = (getattr(symbols, name) - expected).subs({"p": value, **symbols.values})
        assert max(map(abs, difference), default=0) < 1e-9


@pytest.mark.parametrize("kind", ["flywheel", "clutch"])
def test_variants_on_different_pieces(kind):
    """A study in arrays gives what single models give, whatever piece of the table each variant is on."""
    quantity = QUANTITIES["response"](output="a", input="T", at="7 Hz")
    values = np.array(POINTS[kind])
    found = quantity.evaluate(together(rig(kind, "p", POINTS[kind][0]), {"p": values}))[:, 0]
    expected = [abs(rig(kind, value).frequency_response("a", "T", [7.0]).values[0, 0, 0]) for value in values]
    np.testing.assert_allclose(found, expected, rtol=1e-11)


@pytest.mark.parametrize("kind", ["flywheel", "clutch"])
def test_derivatives_are_those_of_the_piece(kind):
    """Between two rows neither stages nor slopes move, as differences of models say."""
    at, step = POINTS[kind][1], 1e-5
    found = mode_sensitivities(rig(kind, "p", at), ["p"]).frequency_slopes[:, 0]
    below, above = (rig(kind, at + one).modes().natural_frequencies for one in (-step, step))
    np.testing.assert_allclose(found, (above - below) / (2 * step), atol=1e-6)


@pytest.mark.parametrize("kind", ELEMENTS)
def test_beyond_the_table(kind):
    for model in (
        lambda: rig(kind, "p", BEYOND[kind]),
        lambda: rig(kind, "p", POINTS[kind][1]).configured(p=BEYOND[kind]),
    ):
        ends = r"elements\.e\.torque: .*400.*contradicting-values" if kind == "flywheel" else "out-of-range"
        with pytest.raises(ModelError, match=ends):
            model()


def test_an_fmu_keeps_what_decided_the_stage():
    """Other values would be another stage, which the equations inside do not have."""
    motion = trace_motion(rig("flywheel", "p", 200.0))
    assert motion.parameters
    assert all(motion.tape.constant(number) is not None for number in motion.parameters.values())
