"""The command damping: run-up, decay, tracked orders, a model beside them, and refusals."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from support.known_damping import F0, ZETA, swept

import torsionnet as tn
from torsionnet.app.cli import main
from torsionnet.io import write_recording
from torsionnet.io.tracked_order_tables import write_tracked_orders
from torsionnet.modal.operational.run_up_fit import sweep_of, swept_response
from torsionnet.signals.orders.tracked_orders import TrackedOrders
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.rotation.pulse_channel import PulseChannel


@pytest.fixture
def run_up(tmp_path):
    path = tmp_path / "runup.npz"
    write_recording(swept(10), path)
    return str(path)


def test_run_up(run_up, tmp_path, capsys):
    figure, table = tmp_path / "a.png", tmp_path / "a.csv"
    words = ["damping", run_up, "--kind", "run-up", "--channel", "T", "--orders", "1", "--speed-channel", "n"]
    assert main([*words, "--json", "--plot", str(figure), "--csv", str(table)]) == 0
    (mode,) = json.loads(capsys.readouterr().out)["modes"]
    assert mode["natural_frequency_Hz"] == pytest.approx(F0, rel=1e-3)
    assert mode["damping_ratio"] == pytest.approx(ZETA, rel=0.03)
    assert figure.stat().st_size > 10_000
    assert "natural frequency [Hz]" in table.read_text()


def test_run_up_by_the_pulses_of_a_wheel_with_a_gap(tmp_path, capsys):
    record = swept(10)
    speed, time = record["n"].values, record.time
    turned = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 / record.sampling_rate)])
    teeth = np.arange(int(turned[-1] / (2 * np.pi) * 60))
    teeth = teeth[teeth % 60 < 58]
    fine = np.linspace(0, time[-1], 400_000)
    passed = np.interp(2 * np.pi * teeth / 60, np.interp(fine, time, turned), fine)
    path = tmp_path / "pulses.npz"
    write_recording(replace(record, signals=(record["T"],), pulses=(PulseChannel("fly", passed),)), path)
    words = ["damping", str(path), "--kind", "run-up", "--channel", "T", "--orders", "1"]
    assert main([*words, "--angle-channel", "fly", "--pulses", "fly=60-2", "--json"]) == 0
    (mode,) = json.loads(capsys.readouterr().out)["modes"]
    assert mode["natural_frequency_Hz"] == pytest.approx(F0, rel=1e-3)
    assert mode["damping_ratio"] == pytest.approx(ZETA, rel=0.03)
    assert main([*words, "--angle-channel", "n", "--pulses", "fly=60-2"]) == 2
    assert "names this wheel" in capsys.readouterr().err


def test_decay_beside_a_model(tmp_path, capsys):
    rig = tn.load("amt_rig").configured("V")
    pole = rig.modes().eigenvalues
    pole = next(one for one in pole if one.imag > 0)
    t = np.arange(0, 3, 0.002)
    write_recording(
        Recording((Signal("T", "torque", np.real(np.exp(pole * t))),), 500), str(tmp_path / "decay.npz")
    )  # fmt: skip
    words = [
        "damping",
        str(tmp_path / "decay.npz"),
        "--kind",
        "decay",
        "--channel",
        "T",
        "--start",
        "0",
        "--mode-count",
        "1",
    ]
    assert main([*words, "--stop", "0.9", "--model", "amt_rig", "-c", "V", "--json"]) == 0
    (pair,) = json.loads(capsys.readouterr().out)["against_model"]
    assert pair["frequency_error"] == pytest.approx(0, abs=1e-3)


def test_tracked_orders(tmp_path, capsys):
    f = np.arange(8, 36, 0.1)
    times = np.arange(len(f)) / 20
    sweep = sweep_of(times, 2 * np.pi * np.cumsum(f) / 20, 1.0)
    fine = np.linspace(0, times[-1], 8000)
    speed = np.interp(fine, times, 2 * np.pi * f)
    sweep = sweep_of(fine, np.cumsum(speed) * fine[1], 1.0)
    pole = 2 * np.pi * F0 * complex(-ZETA, np.sqrt(1 - ZETA**2))
    values = np.interp(times, fine, swept_response(pole, sweep))
    path = tmp_path / "orders.csv"
    widths = np.full((1, len(f)), 0.01)
    orders = TrackedOrders(
        "T", "torque", np.array([1.0]), times, 2 * np.pi * f, values[None], widths, reference="a pulse"
    )
    write_tracked_orders([orders], path)
    assert main(["damping", str(path), "--kind", "run-up", "--channel", "T", "--orders", "1", "--json"]) == 0
    captured = capsys.readouterr()
    (mode,) = json.loads(captured.out)["modes"]
    assert mode["natural_frequency_Hz"] == pytest.approx(F0, rel=1e-3)
    assert mode["damping_ratio"] == pytest.approx(ZETA, rel=0.03)
    assert "smears is not known" in captured.err
    assert main(["damping", str(path), "--kind", "run-up", "--channel", "U", "--orders", "1"]) == 2
    assert '"U"; ' in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("--kind run-up --channel T --speed-channel n", "give --orders, vibrations per revolution"),
        ("--kind run-up --channel T --orders 1", "give --speed-channel or --angle-channel"),
        (
            "--kind run-up --channel T --orders 1 --speed-channel T",
            "T is torque.* \\[unfit-channel",
        ),
        (
            "--kind decay --channel T --channel n --orders 1 --band 1 2",
            "--orders is for --kind run-up or ambient; --band",
        ),
        ("--kind run-up --channel T --orders 1 --speed-channel n --revolutions 0", r"--revolutions.*out-of-range"),
        ("--kind ambient --channel T", "give the highest frequency of interest, --up-to, in Hz"),
    ],
)
def test_what_is_missing_is_named(run_up, words, said, capsys):
    assert main(["damping", run_up, *words.split()]) == 2
    assert re.search(said, " ".join(capsys.readouterr().err.split()))
