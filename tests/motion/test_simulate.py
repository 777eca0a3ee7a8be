"""Motion over time against closed forms, scipy's lsim and the frequency response."""

import numpy as np
import pytest
import scipy

import torsionnet as tn
from torsionnet.linear.dynamic_stiffness import triangular

RATE = 2000.0


def free(*more):
    elements = [
        tn.Inertia("a", node="a", inertia=2),
        tn.Spring("k", nodes=("a", "b"), stiffness=100, damping=0.05),
        tn.Inertia("b", node="b", inertia=3),
        *more,
    ]
    return tn.Drivetrain("free", elements)


def oscillator(damping):
    elements = [
        tn.Inertia("a", node="a", inertia=1),
        tn.Spring("k", nodes=("a", "ground"), stiffness=25, damping=damping),
    ]
    return tn.Drivetrain("oscillator", elements)


def simulated(model, outputs, node, torque):
    record = model.simulate(outputs, {node: torque}, RATE)
    return [signal.values for signal in record.signals[1:]]


@pytest.mark.slow
def test_rigid_rotation_under_a_ramp_is_a_cubic():
    t = np.arange(40_001) / RATE
    a, b, speed = simulated(free(), ["a", "b", "velocity(b)"], "a", 5 * t)
    centre = (2 * a + 3 * b) / 5
    assert centre == pytest.approx(t**3 / 6, rel=1e-11, abs=1e-12)
    assert speed[-1] == pytest.approx(t[-1] ** 2 / 2, rel=1e-2)


@pytest.mark.parametrize("damping", [0.0, 1.0, 10.0, 10.0 + 1e-9, 26.0])
def test_step_of_an_oscillator_below_at_and_above_critical_damping(damping):
    t = np.arange(10_001) / RATE
    (found,) = simulated(oscillator(damping), ["a"], "a", np.full(len(t), 5.0))
    pole = np.sqrt(complex((damping / 2) ** 2 - 25))
    decay = np.exp(-damping / 2 * t)
    shape = np.cosh(pole * t) + damping / 2 * (np.sinh(pole * t) / pole if abs(pole) > 1e-6 else t)
    assert found == pytest.approx(0.2 * (1 - (decay * shape).real), abs=2e-9 if 10 < damping < 11 else 1e-12)


@pytest.mark.parametrize("name", ["dmf_rig", "amt_rig"])
def test_library_rigs_as_lsim(name):
    rig = tn.load(name)
    torque = np.random.default_rng(0).standard_normal(3000)
    names = ["theta_1", "T_T"]
    found = simulated(rig, names, "T_M", torque)
    S = rig.to_control()
    _, expected, _ = scipy.signal.lsim((S.A, S.B, S.C, S.D), torque, np.arange(3000) / RATE)
    for values, column in zip(found, expected.T, strict=True):
        assert values == pytest.approx(column, abs=1e-11 * np.abs(column).max())


def test_a_table_that_ends_below_half_the_sampling_rate_is_noted():
    def bush(*rows):
        spring = tn.TabulatedSpring("bush", nodes=("a", "ground"), table=[(f, 25, 0.5) for f in rows])
        rig = tn.Drivetrain("bush", [tn.Inertia("a", node="a", inertia=1), spring])
        return rig.simulate("a", {"a": np.ones(200)}, RATE).notes[1:]

    text = "bush: the rows of its table go from 1 to 20 Hz, and it is read from 0 Hz, where the first row is kept"
    assert bush(1, 20) == (f"{text}, and at up to 1000 Hz, where the last row is kept",)
    assert bush(0, 1000) == ()


def test_several_torques_add_up():
    rng = np.random.default_rng(1)
    one, other = rng.standard_normal((2, 500))
    model = free(tn.Damper("drag", nodes=("b", "ground"), damping=0.3))
    both = model.simulate(["a", "twist(k)"], {"a": one, "b": other}, RATE)
    parts = [simulated(model, ["a", "twist(k)"], node, torque) for node, torque in (("a", one), ("b", other))]
    assert both.names == ("torque on a", "torque on b", "a", "twist(k)")
    for values, *separate in zip([both["a"].values, both["twist(k)"].values], *parts, strict=True):
        assert values == pytest.approx(separate[0] + separate[1], abs=1e-15)


def test_steady_vibration_is_the_frequency_response():
    rig, f = tn.load("amt_rig").configured("III"), 4.0
    t = np.arange(20_000) / RATE
    (motion,) = simulated(rig, ["theta_1"], "T_M", np.sin(2 * np.pi * f * t))
    window = slice(-10_000, None)  # 20 whole periods
    measured = 2 * np.mean(motion[window] * np.exp(-2j * np.pi * f * t[window])) * 1j
    expected = rig.frequency_response("theta_1", "T_M", [f]).values[0, 0, 0]
    assert measured == pytest.approx(expected, rel=2e-5)  # straight lines between samples cost (pi f h)^2 / 3


def test_without_trusted_eigenvectors_the_triangular_form_gives_the_same(monkeypatch):
    torque = np.random.default_rng(2).standard_normal(400)
    model = free(tn.Spring("hold", nodes=("b", "ground"), stiffness=7, damping=0.1))
    expected = simulated(model, ["a", "b"], "a", torque)
    monkeypatch.setattr(triangular, "MOST_EIGENVECTOR_CONDITION", 0.0)
    assert simulated(model, ["a", "b"], "a", torque) == [pytest.approx(part, abs=1e-13) for part in expected]


@pytest.mark.parametrize(
    ("outputs", "inputs", "message"),
    [
        ("theta_1", {"T_X": [1.0]}, "unknown-channel"),
        ("theta_1", {"T_M": []}, "of one length"),
        ("theta_1", {"T_M": [1.0, np.nan]}, "finite numbers"),
        ("theta_1", {"T_M": [1.0], "primary": [1.0, 2.0]}, "of one length"),
        ("theta_1", {"T_T": [1.0]}, "driven by torques"),
        ("theta_9", {"T_M": [1.0]}, "did you mean"),
    ],
)
def test_questions_that_make_no_sense(outputs, inputs, message):
    with pytest.raises(tn.UsageError, match=message):
        tn.load("dmf_rig").simulate(outputs, inputs, RATE)


@pytest.mark.parametrize("between", ["held", "straight", "band_limited"])
@pytest.mark.filterwarnings("error")
def test_a_free_plant_with_a_law_over_frequency_is_refused_without_a_warning_of_numpy(between):
    plant = free(tn.HystereticSpring("rubber", nodes=("a", "b"), stiffness=20, loss_factor=0.1))
    torque = tn.signals.Signal("T", "torque", np.ones(50), between=between)
    with pytest.raises(tn.UsageError, match="unsupported-law"):
        plant.simulate(["a"], {"a": torque}, RATE)
