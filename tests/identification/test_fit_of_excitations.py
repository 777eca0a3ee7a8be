"""Fits of propellers, mistuned dampers and engines to measured orders, against equations of motion written here.

Models that a fit writes are read again by the command line.
"""

import json

import numpy as np
import pytest
from support.command_line import run
from support.order_fits import HARMONICS, K_COUPLING, dense_orders, engine_model, tracked

import torsionnet as tn
from torsionnet.identification import Measurement, identify, rank_causes
from torsionnet.io.tracked_order_tables import write_tracked_orders
from torsionnet.signals.orders.tracked_orders import TrackedOrders

RPM = np.pi / 30
SHIP = """torsionnet: 1
name: motor, shaft and propeller
elements:
  motor: {type: inertia, node: m, inertia: 0.5 kg*m^2}
  shaft: {type: spring, nodes: [m, p], stiffness: 40 kN*m/rad, damping: 20 N*m*s/rad}
  screw: {type: inertia, node: p, inertia: 2 kg*m^2}
sensors: {T: {torque: shaft}}
speeds: {of: p, list: [700 rpm]}
excitations:
  propeller: {type: propeller, node: p, blades: 4, torque: 500 N*m, rated: 900 rpm, blade_orders: {1: {share: 6 %}}}
"""
SHARE, PHASE = 0.09, 0.7
NAMES = ("propeller.blade_orders.1.share", "propeller.blade_orders.1.phase")
RUN = np.linspace(400, 1000, 15) * RPM


def shaft_torque(speeds, share=SHARE, phase=PHASE):
    """Complex order 4 of the torque of the shaft in N m: two masses on a spring, the load on the second."""
    s = 4j * speeds
    kappa = 4e4 + 20 * s
    load = -share * 500 * (speeds / (900 * RPM)) ** 2 * np.exp(1j * phase)
    return -kappa * load / 2 / (s**2 + kappa * (1 / 0.5 + 1 / 2))


def measured(values, sigma, order, speeds=RUN):
    rng = np.random.default_rng(0)
    noisy = values + sigma * (rng.normal(size=len(values)) + 1j * rng.normal(size=len(values)))
    return TrackedOrders(
        "T", "torque", np.array([order]), np.arange(float(len(speeds))), speeds, noisy[None],
        np.full((1, len(speeds)), 1.959964 * sigma), reference="top dead centre of cylinder 1",
    )  # fmt: skip


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def complex_orders(file, output):
    """Complex amplitudes of a model file over speed in rpm, by order, as the command calculates them."""
    (found,) = json.loads(run("orders", file, "--output", output, "--json").stdout)
    rows = found["outputs"][0]["orders"]
    return np.array(found["speeds_rpm"]), {
        row["of_reference"]: np.array(row["real"]) + 1j * np.array(row["imag"]) for row in rows
    }


def test_amplitude_and_phase_of_a_propeller_order():
    fit = identify(tn.loads(SHIP), Measurement(measured(shaft_torque(RUN), 0.5, 4.0)), list(NAMES))
    for name, true in zip(NAMES, (SHARE, PHASE), strict=True):
        low, high = fit.intervals()[name]
        assert low < true < high
        assert high - low < 0.03 * true
    assert fit.units[NAMES[1]] == "rad"
    assert not fit.lack_of_fit.rejected


@pytest.mark.slow
def test_phase_of_a_propeller_order_is_blamed():
    """With the share right and the phase of the model 0, only the phase explains the test."""
    rig = tn.loads(SHIP.replace("6 %", "9 %"))
    ranking = rank_causes(rig, Measurement(measured(shaft_torque(RUN), 0.5, 4.0)))
    good = {one.unknown: one.value for one in ranking.causes if one.explains}
    assert NAMES[1] in good
    assert good[NAMES[1]] == pytest.approx(PHASE, abs=0.02)
    assert NAMES[0] not in good


def test_fitted_propeller_is_written_and_read_by_the_command_line(folder):
    (folder / "ship.yaml").write_text(SHIP)
    write_tracked_orders([measured(shaft_torque(RUN), 0.5, 4.0)], "run.csv")
    (folder / "fit.yaml").write_text(
        f"{{torsionnet: 1, model: ship.yaml, parameters: [{', '.join(NAMES)}], "
        "measurements: {run: {orders: run.csv, output: T}}}"
    )
    found = json.loads(run("fit", "fit.yaml", "--write-model", "fitted.yaml", "--json").stdout)
    share, phase = (next(one["value"] for one in found["parameters"] if one["name"] == name) for name in NAMES)
    rpm, orders = complex_orders("fitted.yaml", "T")
    assert orders[4.0] == pytest.approx(shaft_torque(rpm * RPM, share, phase), rel=1e-6)


@pytest.mark.slow
def test_fitted_engine_is_written_and_read_by_the_command_line(folder):
    names = ["engine.misfire_share.4", "engine.gas.correction.3.real", "engine.gas.correction.3.imag", "k_cpl"]
    engine_model().to_yaml(folder / "engine.yaml")
    test = dense_orders(misfire={4: 0.3}, corrections={3.0: 1.1 - 0.15j}, k_cpl=5.6e3)
    write_tracked_orders([tracked(test, 2.0, 0)], "run.csv")
    (folder / "fit.yaml").write_text(
        f"{{torsionnet: 1, model: engine.yaml, parameters: [{', '.join(names)}], "
        "measurements: {run: {orders: run.csv, output: T_cpl}}}"
    )
    found = json.loads(run("fit", "fit.yaml", "--write-model", "fitted.yaml", "--json").stdout)
    values = {one["name"]: one["value"] for one in found["parameters"]}
    misfire, real, imag, stiffness = (values[name] for name in names)
    assert misfire == pytest.approx(0.3, abs=0.03)
    rpm, orders = complex_orders("fitted.yaml", "T_cpl")
    exact = dense_orders(misfire={4: misfire}, corrections={3.0: real + 1j * imag}, k_cpl=stiffness, speeds=rpm * RPM)
    assert np.abs(exact - dense_orders(speeds=rpm * RPM, k_cpl=K_COUPLING)).max() > 10
    for order, true in zip(HARMONICS, exact, strict=True):
        assert orders[order] == pytest.approx(true, rel=1e-6)


DAMPED = """torsionnet: 1
name: motor with a tuned damper
elements:
  motor: {type: inertia, node: m, inertia: 0.5 kg*m^2}
  shaft: {type: spring, nodes: [m, p], stiffness: 40 kN*m/rad, damping: 20 N*m*s/rad}
  fan: {type: inertia, node: p, inertia: 2 kg*m^2}
  damper: {type: tuned_damper, node: m, ring_inertia: 0.08 kg*m^2, TUNING, damping: 3 N*m*s/rad}
sensors: {T: {torque: shaft}}
speeds: {of: m, list: [700 rpm]}
excitations: {motor: {type: harmonic, node: m, orders: {6: {amplitude: 20 N*m, phase: 30 deg}}}}
"""


def torque_with_damper(speeds, hertz):
    """Complex order 6 of the torque of the shaft in N m, of three masses as matrices: ring, motor, fan."""
    k = 0.08 * (2 * np.pi * hertz) ** 2
    M = np.diag([0.08, 0.5, 2.0])
    K = np.array([[k, -k, 0.0], [-k, k + 4e4, -4e4], [0.0, -4e4, 4e4]])
    C = np.array([[3.0, -3.0, 0.0], [-3.0, 23.0, -20.0], [0.0, -20.0, 20.0]])
    load = np.array([0.0, 20 * np.exp(1j * np.pi / 6), 0.0])
    found = []
    for s in 6j * speeds:
        motion = np.linalg.solve(K + s * C + s**2 * M, load)
        found.append((4e4 + 20 * s) * (motion[1] - motion[2]))
    return np.array(found)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("tuning", "unknown", "true"),
    [
        ("natural_frequency: 45 Hz", "damper.natural_frequency", 52.0),
        (f"stiffness: {0.08 * (2 * np.pi * 45) ** 2:.6f} N*m/rad", "damper.stiffness", 0.08 * (2 * np.pi * 52) ** 2),
    ],
)
def test_a_mistuned_damper_is_ranked_first(tuning, unknown, true):
    test = measured(torque_with_damper(RUN, 52.0), 0.5, 6.0)
    ranking = rank_causes(tn.loads(DAMPED.replace("TUNING", tuning)), Measurement(test))
    assert [one.unknown for one in ranking.causes if one.explains] == [unknown]
    assert ranking.causes[0].value == pytest.approx(true, rel=0.01)
    assert unknown in ranking.verdict
