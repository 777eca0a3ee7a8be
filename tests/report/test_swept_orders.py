"""Orders along the speed of a run-up beside measured ones: a plant integrated over time in the test."""

import json
from pathlib import Path

import numpy as np
import pytest
import scipy
from support.command_line import run
from support.report_blocks import blocks, of, rows

import torsionnet as tn
from torsionnet.io.tracked_order_tables import read_tracked_orders, write_tracked_orders
from torsionnet.machinery.orders.calculated_order import swept_comparison, swept_orders
from torsionnet.report import make_report
from torsionnet.report.document_tree import TableBlock
from torsionnet.report.writers.markdown import MarkdownWriter
from torsionnet.signals.orders.tracked_orders import TrackedOrders

RPM = np.pi / 30
PLANT = """torsionnet: 1
name: pump on a motor
elements:
  motor: {type: inertia, node: m, inertia: 0.5 kg*m^2}
  shaft: {type: spring, nodes: [m, f], stiffness: 40 kN*m/rad, damping: 5 N*m*s/rad}
  pump: {type: inertia, node: f, inertia: 2 kg*m^2}
sensors: {T: {torque: shaft}}
speeds: {of: m, range: 250..960 rpm, step: 5 rpm}
excitations: {motor: {type: harmonic, node: m, orders: {6: {amplitude: 20 N*m, phase: 30 deg}}}}
report: {measure: [T]}
"""
FIRST, RATE, LONG = 300 * RPM, 100 * RPM, 6.0  # 10 Hz/s of order 6, through 50.3 Hz with a damping ratio of 0.02


def run_up(step=1e-4):
    """Torque of the shaft over time by lsim, and the angle; the twist follows one equation of second order."""
    time = np.arange(0, LONG + step / 2, step)
    angle = FIRST * time + RATE * time**2 / 2
    whole = 1 / 0.5 + 1 / 2
    torque = 20 * np.cos(6 * angle + np.radians(30))
    system = ([5.0 / 0.5, 4e4 / 0.5], [1.0, 5 * whole, 4e4 * whole])
    return time, angle, scipy.signal.lsim(system, torque, time)[1]


def averaged(time, angle, signal, at, cycles):
    """Order 6 by quadrature over the angle under a window of Hann's edges, flat between: cycles of two turns."""
    found = []
    for moment in at:
        middle = np.interp(moment, time, angle)
        half = cycles * 2 * np.pi
        x = np.linspace(-half, half, 4001)[:-1] + middle
        y = np.interp(x, angle, signal)
        edge = np.clip((half - np.abs(x - middle)) / (4 * np.pi), 0, 1)
        weight = 0.5 - 0.5 * np.cos(np.pi * edge)
        found.append(2 * (weight * y * np.exp(-6j * x)).sum() / weight.sum())
    return np.array(found)


@pytest.fixture(scope="module")
def run_up_of_plant():
    time, angle, signal = run_up()
    at = np.arange(1.0, 5.2, 0.1)
    values = averaged(time, angle, signal, at, 2)
    return TrackedOrders(
        "T", "torque", np.array([6.0]), at, FIRST + RATE * at, values[None], np.full((1, len(at)), 1.0), None, "a pulse"
    )


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plant.yaml").write_text(PLANT)


def test_orders_of_a_run_up_at_ten_hertz_a_second(run_up_of_plant):
    (found,) = swept_orders(tn.load("plant.yaml"), ["T"], run_up_of_plant)
    peak = np.abs(run_up_of_plant.values).max()
    assert np.abs(found.values - run_up_of_plant.values).max() < 0.005 * peak
    steady = 20 / 0.5 * 4e4 / (2 * 0.02 * 4e4 * 2.5)
    assert peak < 0.8 * steady  # the run-up does not reach the steady peak


def test_the_command_compares_with_the_swept_response(run_up_of_plant):
    write_tracked_orders([run_up_of_plant], "tracked.csv")
    options = ["orders", "plant.yaml", "--output", "T", "--measured", "tracked.csv"]
    (found,) = json.loads(run(*options, "--json").stdout)
    (row,) = found["outputs"][0]["measured"]
    assert (row["is_swept"], row["verdict"]) == (True, "agrees")
    text = " ".join(run(*options).stdout.split())
    assert "order 6 compared with the response along the measured speed over time" in text
    assert "the model's steady peak loses" in text


def report_on(tests, language="en"):
    """Sections on the measurement as plain text, and the rows of the table of peaks."""
    report = make_report(
        tn.load("plant.yaml"), sections=["measurement_plan"], measured=tests, date=None, language=language
    )
    found = [one for one in of(TableBlock, blocks(report, "measurement_plan")) if "speed" not in str(one.caption)]
    return MarkdownWriter(report, ".").page(), rows(found[-1])


def test_a_report_compares_with_the_swept_response(run_up_of_plant):
    write_tracked_orders([run_up_of_plant], "tracked.csv")
    text, (peak,) = report_on(["T=tracked.csv"])
    assert peak[-1] == "agrees"
    assert float(peak[1]) == pytest.approx(np.abs(run_up_of_plant.values).max(), rel=2e-3)
    for words in (
        "order 6 compared with the response along the measured speed over time",
        "at 10 Hz/s: the model’s steady peak loses",
        "A fast run-up does not reach the peaks of steady speed.",
    ):
        assert words in text.replace("'", "’")
    german, _ = report_on(["T=tracked.csv"], "de")
    for words in (
        "Ordnung 6 verglichen mit der Antwort",
        "die stationäre Spitze des Modells",
        "Ein schneller Hochlauf",
    ):
        assert words in german


def test_a_report_tells_fast_and_slow_tests_of_one_place_apart(run_up_of_plant):
    """Of two files of one order each is compared with its own response: the slow one, of the steady peak, agrees."""
    rpm = np.arange(300.0, 900.0, 7.0)
    s = 6j * rpm * RPM
    kappa = 4e4 + 5 * s
    steady = kappa * 20 * np.exp(1j * np.radians(30)) / 0.5 / (s**2 + kappa * 2.5)
    slow = TrackedOrders(
        "T", "torque", np.array([6.0]), np.arange(len(rpm)) * 60.0, rpm * RPM, steady[None],
        np.full((1, len(rpm)), 1.0), None, "a pulse",
    )  # fmt: skip
    write_tracked_orders([run_up_of_plant], "fast.csv")
    write_tracked_orders([slow], "slow.csv")
    _, peaks = report_on(["T=fast.csv", "T=slow.csv"])
    assert [row[-1] for row in peaks] == ["agrees", "agrees"]


def test_a_slow_run_is_compared_with_the_steady_response(run_up_of_plant):
    slow = TrackedOrders(
        "T", "torque", run_up_of_plant.orders, run_up_of_plant.times * 1000, run_up_of_plant.speeds, run_up_of_plant.values,
        run_up_of_plant.half_widths, None, "a pulse",
    )  # fmt: skip
    write_tracked_orders([slow], "tracked.csv")
    (found,) = json.loads(run("orders", "plant.yaml", "--output", "T", "--measured", "tracked.csv", "--json").stdout)
    (row,) = found["outputs"][0]["measured"]
    assert (row["is_swept"], row["verdict"] == "agrees") == (False, False)


def test_orders_of_engines_at_unknown_angles_are_compared_with_the_steady_bound(run_up_of_plant):
    """They have no single phase to follow over time; what the run-up loses is said all the same."""
    engine = (
        "{type: reciprocating_engine, cycle: 4, firing_order: [1], bore: 80 mm, stroke: 90 mm, rod_length: 150 mm, "
        "reciprocating_mass: 1 kg, "
    )
    engines = [f"{node}: {engine}speed_of: {node}, cylinders: {{1: {node}}}}}" for node in "mf"]
    plant = tn.loads(PLANT.partition("excitations")[0] + "excitations: {" + ", ".join(engines) + "}")
    run = plant.order_response("T", speeds=[50.0, 55.0])
    found = swept_comparison(plant, run, ["T"], run_up_of_plant)
    assert not found.orders
    assert found.remarks


def test_an_order_of_undecided_sign_is_compared_by_amplitude():
    """Half orders whose turn of the cycle is not known have no phase: none is said to have the wrong sign."""
    Path("half.yaml").write_text(PLANT.replace("{6:", "{4.5:"), encoding="utf-8")
    rpm = np.arange(300.0, 900.0, 7.0)
    s = 4.5j * rpm * RPM
    kappa = 4e4 + 5 * s
    truth = kappa * 20 * np.exp(1j * np.radians(30)) / 0.5 / (s**2 + kappa * 2.5)
    widths = np.full((1, len(rpm)), 0.5)
    options = ["orders", "half.yaml", "--output", "T", "--measured", "tracked.csv", "--json"]
    for undecided, verdict in (((4.5,), "agrees"), ((), "wrong sign")):
        one = TrackedOrders(
            "T", "torque", np.array([4.5]), np.arange(len(rpm)) * 60.0, rpm * RPM, -truth[None], widths, None,
            "a pulse", undecided=undecided,
        )  # fmt: skip
        write_tracked_orders([one], "tracked.csv")
        assert read_tracked_orders("tracked.csv")[0].undecided == undecided
        (found,) = json.loads(run(*options).stdout)
        (row,) = found["outputs"][0]["measured"]
        assert row["verdict"] == verdict


def test_the_lead_of_a_run_up_goes_on_along_its_slope():
    """A speed of 50 + 2 t rad/s from 1 to 11 s lies on the same line before and behind; a steep one stops at half."""
    from types import SimpleNamespace

    from torsionnet.machinery.orders.calculated_order import _profile

    times = np.arange(1.0, 11.5, 0.5)
    found, speeds = _profile(SimpleNamespace(times=times, speeds=50 + 2 * times), np.array([0.75, 11.25]), 2)
    assert found[0] < 0.75
    assert found[-1] > 11.25
    np.testing.assert_allclose(speeds, 50 + 2 * found, rtol=1e-12)
    _, steep = _profile(SimpleNamespace(times=times, speeds=1 + 40 * (times - 1)), np.array([0.75, 11.25]), 2)
    assert steep[0] == 0.5
