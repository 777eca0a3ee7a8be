"""Fluid couplings and torque converters against differences of their own steady torques, and dense matrices."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.model.elements import Law, Values

W, J_P, J_T, J_H, K_H = 180.0, 0.3, 0.2, 4.0, 900.0
TABLES = {
    "pump_torque": ({"test_speed": "2000 rpm"}, [[0, 260], [0.5, 240], [0.8, 200], [1, 40]]),
    "performance": ({"diameter": 0.26, "density": 850}, [[0, 0.004], [0.5, 0.0037], [0.8, 0.003], [1, 0.0006]]),
    "k_factor": ({}, [[0, 120], [0.5, 125], [0.8, 150], [1, 400]]),
}
GAIN = [[0, 2.3], [0.5, 1.55], [0.85, 1.0], [1, 1.0]]


def steady(form, pump, turbine, gain):
    """Torques of pump and turbine, by the definitions of the three characteristics."""
    rows = TABLES[form][1]
    nu = turbine / pump
    level = np.interp(nu, *np.array(rows).T)
    torque = {
        "pump_torque": lambda: level * (pump / (2000 * np.pi / 30)) ** 2,
        "performance": lambda: level * 850 * 0.26**5 * pump**2,
        "k_factor": lambda: (pump * 30 / np.pi / level) ** 2,
    }[form]()
    return torque, torque * np.interp(nu, *np.array(gain).T)


def damping_by_differences(form, nu, gain, step=1e-4):
    """C of pump and turbine in [[dT_p/dw_p, dT_p/dw_t], [-dT_t/dw_p, -dT_t/dw_t]]."""
    columns = []
    for change in ((step, 0), (0, step)):
        above, below = (np.array(steady(form, W + s * change[0], nu * W + s * change[1], gain)) for s in (1, -1))
        columns.append((above - below) / (2 * step))
    return np.array([[1], [-1]]) * np.array(columns).T


def element(form, nu, gain=None, **more):
    entries = {form: TABLES[form][1], **TABLES[form][0], "speed": W, "speed_ratio": nu, **more}
    if gain is None:
        return tn.FluidCoupling("oil", pump="p", turbine="t", **entries)
    return tn.TorqueConverter("oil", pump="p", turbine="t", torque_ratio=gain, **entries)


def rig(oil):
    housing = "housing" in oil.ports and oil.housing != "ground"
    parts = [tn.Inertia("pump", node="p", inertia=J_P), tn.Inertia("turbine", node="t", inertia=J_T)]
    parts += [tn.Spring("shaft", nodes=("t", "ground"), stiffness=700)]
    if housing:
        parts += [tn.Inertia("case", node="h", inertia=J_H), tn.Spring("mount", nodes=("h", "ground"), stiffness=K_H)]
    sensors = {"w_p": {"velocity": "p"}, "w_t": {"velocity": "t"}}
    return tn.Drivetrain("rig", [*parts, oil], inputs={"T": {"torque": "p"}}, sensors=sensors)


def dense(form, nu, gain, housing):
    """M, C and K; a housing takes what is left of the torques."""
    c = damping_by_differences(form, nu, gain or [[0, 1], [1, 1]])
    if not housing:
        return np.diag([J_P, J_T]), c, np.diag([0, 700.0])
    turning = np.array([[1, 0, -1], [0, 1, -1]])
    return np.diag([J_P, J_T, J_H]), turning.T @ c @ turning, np.diag([0, 700.0, K_H])


@pytest.mark.parametrize("form", TABLES)
@pytest.mark.parametrize("nu", [0.3, 0.7, 0.95])
@pytest.mark.parametrize("gain", [None, GAIN], ids=["coupling", "converter"])
@pytest.mark.parametrize("housing", [False, True])
class TestMatrix:
    def test_responses(self, form, nu, gain, housing):
        mass, c, stiffness = dense(form, nu, gain, housing)
        plant = rig(element(form, nu, gain, **({"housing": "h"} if housing else {})))
        frequencies = np.array([0.3, 4.0, 11.0, 60.0])
        found = plant.frequency_response(["w_p", "w_t"], "T", frequencies).values.reshape(len(frequencies), -1)
        for row, frequency in zip(found, frequencies, strict=True):
            s = 2j * np.pi * frequency
            expected = s * np.linalg.solve(mass * s**2 + c * s + stiffness, np.eye(len(mass))[:, 0])[:2]
            np.testing.assert_allclose(row, expected, rtol=1e-6)

    def test_modes(self, form, nu, gain, housing):
        mass, c, stiffness = dense(form, nu, gain, housing)
        plant = rig(element(form, nu, gain, **({"housing": "h"} if housing else {})))
        lower = [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, c)]
        poles = np.linalg.eigvals(np.block([[np.zeros_like(mass), np.eye(len(mass))], lower]))
        found = plant.modes().eigenvalues
        for pole in poles[(poles.imag >= 0) & (abs(poles) > 1e-3)]:
            assert min(abs(found - pole)) < 1e-6 * abs(pole)


def test_slip_passes_a_mean_speed_on_at_the_speed_ratio():
    assert rig(element("k_factor", 0.7)).ratio_between("t", "p") == pytest.approx(0.7, rel=1e-14)


def test_a_coupling_passes_one_torque_on():
    """At a common rotation of both nothing but the speed of the pump counts: 2 C omega_p + (1 - nu) C' omega_p."""
    damper, follows = element("pump_torque", 0.9).parts(Values({}))
    assert isinstance(damper, Law)
    assert damper.row == {"p": 1, "t": -1}
    assert follows.row == {"t": 1, "p": -1}
    reference = (2000 * np.pi / 30) ** 2
    assert float(damper.damping) == pytest.approx(W * 160 / 0.2 / reference)
    assert float(follows.numerator[1]) == pytest.approx(W * (2 * 120 - 0.1 * 800) / reference)


def test_a_configuration_has_another_speed_ratio():
    text = """torsionnet: 1
elements:
  engine: {type: inertia, node: p, inertia: 0.3}
  oil: {type: torque_converter, pump: p, turbine: t, speed: 180 rad/s, speed_ratio: 0.3, k_factor: [[0, 120], [1, 400]],
        torque_ratio: [[0, 2.3], [1, 1]]}
  car: {type: inertia, node: t, inertia: 20}
configurations: {launch: {stall: {oil.speed_ratio: 0}, higher: {oil.speed_ratio: %s}}}
"""
    plant = tn.loads(text % 0.6)
    assert plant.configured("higher").ratio_between("t", "p") == pytest.approx(0.6)
    with pytest.raises(tn.ModelError, match=r"<text>:7:82: error: .*k_factor.*out-of-range"):
        tn.loads(text % 1.3)


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        ({}, "contradicting-entries"),
        ({"k_factor": [[0, 1], [1, 2]], "performance": [[0, 1], [1, 2]]}, "contradicting-entries"),
        ({"performance": [[0, 1], [1, 2]]}, r"elements\.oil\.performance: .*missing-entry"),
        ({"pump_torque": [[0, 1], [1, 2]]}, r"elements\.oil\.pump_torque: .*missing-entry"),
        ({"k_factor": [[0, 0], [1, 2]]}, r"elements\.oil\.k_factor: .*out-of-range"),
        ({"k_factor": [[0, 1], [0.4, 2]]}, r"elements\.oil\.speed_ratio: .*out-of-range"),
        ({"k_factor": [[0, 1], [0.4, "2 kg"]]}, r"elements\.oil\.k_factor\.1\.1: .*wrong-unit"),
        ({"k_factor": [[0, 1], [1, 2]], "housing": "p"}, r"elements\.oil\.turbine: .*same-node"),
    ],
)
def test_what_is_wrong_is_said(entries, words):
    with pytest.raises(tn.ModelError, match=words):
        tn.FluidCoupling("oil", pump="p", turbine="t", speed=W, speed_ratio=0.5, **entries)
