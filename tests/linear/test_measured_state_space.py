"""State space of transfer functions against measured inputs."""

import numpy as np
import pytest
from support.models import geared_line

import torsionnet as tn
from torsionnet.linear.dynamic_stiffness.measured_state_space import _until_driven

F = np.array([0.2, 3.0, 17.0, 60.0])


def agrees(model, output, input, **asked):
    """The state space has the response that elimination along the graph gives at each frequency.

    States lose digits where a response is small beside its value at high frequency, as an acceleration near rest.
    """
    space = model.to_control(output, input, **asked)
    H = model.frequency_response(output, input, F, **asked)
    response = np.moveaxis(space(2j * np.pi * F, squeeze=False), 2, 0)
    np.testing.assert_allclose(response, H.values, rtol=1e-8, atol=1e-9 * np.abs(H.values).max())
    return space


def poles_of(space):
    """One pole of each conjugate pair, sorted."""
    poles = space.poles()
    return np.sort_complex(poles[poles.imag >= 0])


def test_the_paper_s_transfer_function():
    """theta_1/T_T of Galvagno et al. (2015), equation (13): the secondary on its spring alone, 8.755 Hz and 25.7 %."""
    space = agrees(tn.load("dmf_rig"), "theta_1", "T_T")
    assert (space.input_labels, space.output_labels) == (["T_T"], ["theta_1"])
    slow = poles_of(space)[-1]
    np.testing.assert_allclose([abs(slow) / (2 * np.pi), -slow.real / abs(slow)], [8.755, 0.257], rtol=1e-3)


@pytest.mark.parametrize("gear", ["II", "V"])
def test_poles_are_those_of_the_drivetrain_cut_at_the_meter(gear):
    rig = tn.load("amt_rig").configured(gear)
    found = poles_of(agrees(rig, "theta_1", "T_T"))
    np.testing.assert_allclose(found, np.sort_complex(rig.modes(measured_input="T_T").eigenvalues), rtol=1e-9)


def branched(seed):
    """A line of five inertias with a branch, springs and dampers by chance, driven at its first node."""
    draw = np.random.default_rng(seed)
    nodes = ["a", "b", "c", "d", "e"]
    pairs = [("a", "b"), ("b", "c"), ("c", "d"), ("b", "e"), ("d", "ground")]
    elements = [tn.Inertia(f"J_{node}", node=node, inertia=float(draw.uniform(0.02, 2))) for node in nodes]
    for number, pair in enumerate(pairs):
        k, c = float(10 ** draw.uniform(2, 5)), float(draw.uniform(0.01, 3))
        elements.append(tn.Spring(f"k_{number}", nodes=pair, stiffness=k, damping=c))
    sensors = {"T": {"torque": "k_1"}, "phi": {"angle": "d"}, "speed": {"velocity": "b"}, "acc": {"acceleration": "c"}}
    inputs = {"T_a": {"torque": "a"}, "T_d": {"torque": "d"}}
    return tn.Drivetrain("line", elements, inputs=inputs, sensors=sensors)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.filterwarnings("ignore:the state space")
def test_every_kind_of_measured_input(seed):
    model = branched(seed)
    for output in ("T", "phi", "speed", "acc", "angle(e)"):
        for measured in ("T", "phi", "speed", "acc"):
            # An improper response grows without bound, by its frequency or quicker.
            H = model.frequency_response(output, measured, [1e7, 1e8], driven_by="T_a").values[:, 0, 0]
            if abs(H[1] / H[0]) < 5:
                agrees(model, output, measured, driven_by="T_a")
                continue
            with pytest.raises(tn.UsageError, match="unsupported-law"):
                model.to_control(output, measured, driven_by="T_a")


def test_an_excitation_that_shows_in_both_at_once():
    """Against the acceleration of the driven mass that acceleration is 1, at every frequency."""
    model = branched(4)
    space = agrees(model, ["acceleration(a)", "T", "acceleration(b)"], "acceleration(a)", driven_by="T_a")
    np.testing.assert_allclose(space.D[0, 0], 1, rtol=1e-12)


def test_two_measured_inputs():
    model = branched(3)
    space = agrees(model, ["speed", "angle(e)"], ["T", "phi"], driven_by=["T_a", "T_d"])
    assert (space.ninputs, space.noutputs) == (2, 2)


def test_poles_that_no_output_shows_are_named():
    """With the angle of b known, so are those beyond; the branch swings on b: sqrt(k/J)."""
    elements = [tn.Inertia(f"J_{node}", node=node, inertia=J) for node, J in zip("abce", (1, 2, 3, 0.5), strict=True)]
    pairs = {"k_ab": ("a", "b"), "k_bc": ("b", "c"), "k_be": ("b", "e"), "k_c": ("c", "ground")}
    elements += [tn.Spring(name, nodes=nodes, stiffness=800, damping=2) for name, nodes in pairs.items()]
    sensors = {"at_b": {"angle": "b"}, "phi": {"angle": "c"}}
    model = tn.Drivetrain("line", elements, inputs={"T_a": {"torque": "a"}}, sensors=sensors)
    hidden = f"{np.sqrt(800 / 0.5) / (2 * np.pi):.4g} Hz with a damping ratio of 5 %"
    with pytest.warns(tn.TorsionnetWarning, match=f"phi against at_b .* no output shows: {hidden}"):
        space = agrees(model, "phi", "at_b")
    assert space.nstates == 5  # the branch, c on two springs, and k_ab, which relaxes at k/c = 400 1/s


def test_lost_digits_are_told():
    """A damper of 1 N m s/rad on 1e-9 kg m^2 has a pole at -1e9 1/s beside one of 1 rad/s."""
    elements = [
        tn.Inertia("J_a", node="a", inertia=1),
        tn.Inertia("J_b", node="b", inertia=1e-9),
        tn.Inertia("J_c", node="c", inertia=1),
        tn.Spring("k_ab", nodes=("a", "b"), stiffness=1e6, damping=1),
        tn.Spring("k_bc", nodes=("b", "c"), stiffness=1, damping=1),
        tn.Spring("k_c", nodes=("c", "ground"), stiffness=1, damping=1e-4),
    ]
    sensors = {"acc": {"acceleration": "b"}, "phi": {"angle": "c"}}
    model = tn.Drivetrain("line", elements, inputs={"T_a": {"torque": "a"}}, sensors=sensors)
    with pytest.warns(tn.TorsionnetWarning, match="phi/acc has lost digits from .* Hz, at worst"):
        model.to_control("phi", "acc")


def test_free_motion_behind_the_meter_has_lost_no_digits():
    """Its double pole at 0 is one of 1e-7 rad/s by rounding."""
    elements = [tn.Inertia(f"J_{node}", node=node, inertia=J) for node, J in zip("abcd", (1, 2, 1, 1), strict=True)]
    elements += [tn.Spring(f"k_{a}{b}", nodes=(a, b), stiffness=100, damping=0.1) for a, b in ("ab", "bc", "cd")]
    sensors = {"T": {"torque": "k_bc"}, "phi": {"angle": "c"}}
    agrees(tn.Drivetrain("line", elements, inputs={"T_a": {"torque": "a"}}, sensors=sensors), "phi", "T")
    # Beside a spring that passes the meter by, two of three poles are such a pair.
    elements = [tn.Inertia(f"J_{node}", node=node, inertia=J) for node, J in zip("ab", (16.6, 0.24), strict=True)]
    elements.append(tn.Spring("k_ab", nodes=("a", "b"), stiffness=11.8, damping=46))
    elements.append(tn.Spring("beside", nodes=("a", "b"), stiffness=559))
    sensors = {"T": {"torque": "k_ab"}, "phi": {"angle": "a"}}
    agrees(tn.Drivetrain("pair", elements, inputs={"T_b": {"torque": "b"}}, sensors=sensors), "phi", "T")


def test_an_acceleration_that_shows_the_torque_alone_has_no_state_space():
    """Of a free mass alpha = T/J, and against its angle s^2: no state carries that."""
    sensors = {"phi": {"angle": "a"}, "alpha": {"acceleration": "a"}}
    model = tn.Drivetrain(
        "mass", [tn.Inertia("J", node="a", inertia=2)], inputs={"T": {"torque": "a"}}, sensors=sensors
    )
    with pytest.raises(tn.UsageError, match="unsupported-law"):
        model.to_control("alpha", "phi")


def test_inputs_by_name():
    """Excitations and outputs may be named, as in a frequency response."""
    space = agrees(geared_line(), "angle(g)", "T_M")
    assert (space.input_labels, space.output_labels) == (["T_M"], ["angle(g)"])


def test_requests_that_have_no_state_space():
    model = branched(2)
    with pytest.raises(tn.UsageError, match="name output and input"):
        model.to_control("phi")
    with pytest.raises(tn.UsageError, match="unsupported-law"):
        model.to_control("acc", "phi", driven_by="T_a")


def test_a_reading_that_no_excitation_moves_is_no_input():
    with pytest.raises(tn.UsageError, match="zero-reading"):
        _until_driven(np.array([[0.0, 1.0], [-4.0, 0.0]]), np.zeros((2, 1)), np.array([1.0, 0.0]), np.zeros(1), "T")
