"""The commands fit, identify-modes and sensitivity."""

import csv
import json
import re
import shutil

import numpy as np
import pytest
from support.command_line import run
from support.written_models import FIT_OF_TWO_DISCS, TWO_DISCS

import torsionnet as tn
from torsionnet.identification import load_fit


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    """The file of one test of the soft rig."""
    folder = tmp_path_factory.mktemp("record")
    (folder / "rig.yaml").write_text(TWO_DISCS)
    run("bench", folder / "rig.yaml", "-c", "soft", "-o", folder / "run_soft.npz")
    return folder / "run_soft.npz"


@pytest.fixture
def folder(record, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rig.yaml").write_text(TWO_DISCS)
    (tmp_path / "fit.yaml").write_text(FIT_OF_TWO_DISCS)
    shutil.copy(record, tmp_path)
    return tmp_path


def test_fit_finds_what_the_record_was_made_with(folder):
    result = run(
        "fit", "fit.yaml", "-o", "out.yaml", "--plot", "fit.png", "--csv", "fit.csv", "--write-model", "found.yaml"
    )
    assert "true" in result.stdout
    fit = load_fit("out.yaml")
    assert fit.values["k"] == pytest.approx(200, rel=1e-3)
    assert fit.values["shaft.damping"] == pytest.approx(1, rel=1e-2)
    assert tn.load("found.yaml").parameters["k"] == pytest.approx(fit.values["k"])
    assert (folder / "fit.png").stat().st_size > 20_000
    lines = [line for line in (folder / "fit.csv").read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    assert float(rows[0]["value"]) == fit.values["k"]


@pytest.mark.slow
def test_fit_in_json_with_profiles(folder):
    data = json.loads(run("fit", "fit.yaml", "--json", "--profile").stdout)
    first = data["parameters"][0]
    assert first["interval_95"] == pytest.approx(first["profile_95"], rel=1e-3)
    assert first["true"] == 200
    assert len(data["measurements"][0]["measured"][0]) == len(data["measurements"][0]["frequencies_Hz"])
    assert folder.exists()


def test_fit_to_a_response_from_a_file(folder):
    response = tn.load("rig.yaml").configured("soft").frequency_response("phi", "T", np.linspace(1, 25, 60))
    tn.io.write_frequency_response(response, folder / "frf.csv")
    text = FIT_OF_TWO_DISCS.replace("record: run_soft.npz", "response: frf.csv").replace(
        "input: T_set, model_input: T", "input: T"
    )
    (folder / "frf.yaml").write_text(text)
    data = json.loads(run("fit", "frf.yaml", "--json").stdout)
    assert [entry["value"] for entry in data["parameters"]] == pytest.approx([200, 1], rel=1e-6)


FAULTS = [
    ("model: rig.yaml", "model: rgi.yaml", "2:8", "rig.yaml.*missing-file"),
    ("start: 300 N*m/rad", "strat: 300 N*m/rad", "4:7", '"start".*unknown-entry'),
    ("bounds: [50, 2000]", "bounds: [50]", "4:35", "wrong-form"),
    ("bounds: [50, 2000]", "bounds: [500, 200]", "4:6", "unordered-rows"),
    ("run_soft.npz", "run_sotf.npz", "7:18", '"run_soft.npz".*missing-file'),
    ("output: phi", "output: psi", "7:18", "psi.*unknown-channel"),
    ("record: run_soft.npz, ", "", "7:3", "orders and stepped.*missing-entry"),
    (", output: phi", "", "7:3", "output: channel.*missing-entry"),
    ("configuration: soft", "configuration: sfot", "7:90", '"soft".*unknown-configuration'),
    ("band: [1 Hz, 25 Hz]", "band: [25 Hz, 1 Hz]", "7:102", "unordered-rows"),
    ("band: [1 Hz, 25 Hz]", "band: [1 s, 25 Hz]", "7:102", "1 s.*wrong-unit"),
    ("seconds: 2 s", "seconds: 2 Hz", "8:38", "2 Hz.*wrong-unit"),
    ("settings:", "setings:", "8:1", '"settings".*unknown-entry'),
    ("parameters:\n", "nothing:\n", "1:1", "parameters.*missing-entry"),
]


@pytest.mark.parametrize(("good", "bad", "place", "words"), FAULTS)
def test_faults_of_a_fit_file_are_located(folder, good, bad, place, words):
    (folder / "bad.yaml").write_text(FIT_OF_TWO_DISCS.replace(good, bad, 1))
    result = run("fit", "bad.yaml", "-o", "out.yaml", code=1)
    assert re.search(rf"^bad\.yaml:{place}: error: .*{words}\]$", result.stderr, re.MULTILINE)
    assert not (folder / "out.yaml").exists()


def test_fits_that_cannot_be_done(folder):
    (folder / "idle.yaml").write_text(FIT_OF_TWO_DISCS.replace("  shaft.damping: {start: 2 N*m*s/rad}", "  k_9: {}"))
    assert re.search('"k_9".*unknown-parameter', run("fit", "idle.yaml", code=2).stderr)
    assert "cannot be read" in run("fit", "none.yaml", code=2).stderr


@pytest.mark.slow
def test_modes_of_a_record_against_the_model(folder):
    arguments = (
        "identify-modes",
        "run_soft.npz",
        "--output",
        "phi",
        "--input",
        "T_set",
        "--band",
        1.2,
        25,
        "--seconds",
        10,
    )
    data = json.loads(run(*arguments, "--model", "rig.yaml", "-c", "soft", "--json", "--plot", "s.png").stdout)
    expected = tn.load("rig.yaml").configured("soft").modes()
    (pair,) = data["against_model"]
    assert abs(pair["frequency_error"]) < 0.01
    found = data["modes"][pair["identified"] - 1]["natural_frequency_Hz"]
    assert found == pytest.approx(expected.natural_frequencies[0], rel=0.01)
    assert (folder / "s.png").stat().st_size > 10_000
    assert "identified modes against the model" in run(*arguments, "--model", "rig.yaml", "-c", "soft").stdout


def test_half_power_of_a_record_warns_of_strong_damping(folder):
    run("bench", "rig.yaml", "--set", "k=40", "-o", "heavy.npz")
    result = run(
        "identify-modes", "heavy.npz", "--output", "phi", "--input", "T_set", "--method", "peaks", "--band", 0, 25
    )
    assert "too damped for half power" in result.stderr
    refused = run(
        "identify-modes",
        "heavy.npz",
        "--output",
        "phi",
        "--input",
        "T_set",
        "--method",
        "peaks",
        "--plot",
        "x.png",
        code=2,
    )
    assert "no stabilisation diagram" in refused.stderr
    assert folder.exists()


@pytest.mark.slow
def test_sensitivity_of_every_configuration(tmp_path):
    result = run(
        "sensitivity", "amt_rig", "-c", "II", "-c", "V", "--parameter", "c_O", "--parameter", "k_1", "--mode", 1
    )
    assert [line.split()[0] for line in result.stdout.splitlines() if line.startswith(("II ", "V "))] == [
        "II",
        "II",
        "V",
        "V",
    ]
    plot, table = tmp_path / "t.svg", tmp_path / "t.csv"
    data = json.loads(run("sensitivity", "dmf_rig", "--json", "--plot", plot, "--csv", table).stdout)[0]
    first = dict(zip(data["parameters"], data["modes"][0]["frequency_percent_per_percent"], strict=True))
    assert np.isclose(first["k_2"], 0.495, atol=0.01)
    assert sum(value for name, value in first.items() if name[0] == "k") == pytest.approx(0.5, abs=0.01)
    assert plot.exists()
    assert table.exists()
    assert 'did you mean "c_O"' in run("sensitivity", "amt_rig", "--parameter", "c_0", code=2).stderr


@pytest.mark.slow
def test_fit_against_the_set_point_and_without(folder):
    """The shaft's torque is measured with noise; ``reference`` and ``estimator`` act, or are refused."""
    text = FIT_OF_TWO_DISCS.replace("output: phi, input: T_set, model_input: T", "output: phi, input: M")
    for more, said in (
        ("", "of Hr with T_set as reference"),
        ("estimator: H1, ", "lines of H1)"),
        ("estimator: H2, ", "lines of H2)"),
    ):
        (folder / "m.yaml").write_text(text.replace("settings: {", f"settings: {{{more}"))
        data = json.loads(run("fit", "m.yaml", "--json").stdout)
        assert said in data["notes"][0]
        assert data["lack_of_fit"]["rejected"] is False
    for name, code, said in (("T_sett", 1, 'did you mean "T_set"?'), ("phi", 0, "of Hr with phi as reference")):
        (folder / "r.yaml").write_text(text.replace("output: phi, ", f"output: phi, reference: {name}, "))
        result = run("fit", "r.yaml", code=code)
        assert said in result.stdout + result.stderr
    (folder / "v.yaml").write_text(text.replace("settings: {", "settings: {estimator: Hv, "))
    assert "Hv is not" in run("fit", "v.yaml", code=2).stderr


@pytest.mark.slow
def test_fit_of_a_model_that_does_not_fit_says_so(folder):
    (folder / "wrong.yaml").write_text(TWO_DISCS.replace("inertia: 0.1", "inertia: 0.14"))
    (folder / "wrong_fit.yaml").write_text(FIT_OF_TWO_DISCS.replace("rig.yaml", "wrong.yaml"))
    result = run("fit", "wrong_fit.yaml", "--json", "--profile", "-o", "out.yaml")
    data = json.loads(result.stdout)
    assert data["lack_of_fit"]["rejected"]
    found = {one["unknown"]: one["values"] for one in data["lack_of_fit"]["explanations"]}
    assert found.keys() == {"gain", "rotor.inertia"}  # one mass: all other values follow a gain
    assert found["rotor.inertia"]["rotor.inertia"] == pytest.approx(0.1, rel=0.01)
    assert found["gain"]["k"] == pytest.approx(280, rel=0.01)
    assert data["parameters"][0]["interval_95"] == data["parameters"][0]["profile_95"] == [None, None]
    assert "warning: the model does not fit" in result.stderr
    assert re.search(
        r"rotor.inertia = 0.(1|099|100)\d* instead of 0.14( would explain it)?: k would be (199|200)", result.stderr
    )
    assert load_fit("out.yaml").standard_errors["k"] == np.inf


@pytest.mark.parametrize(("rate", "refused"), [(500, True), (4999, True), (5000, False)])
def test_a_preset_for_10_khz_refuses_slow_records(tmp_path, monkeypatch, rate, refused):
    """Every 50th sample of a record at 500 Hz is one at 10 Hz, of which an estimate to 4 Hz came without a word."""
    monkeypatch.chdir(tmp_path)
    t = np.arange(20 * rate) / rate
    rows = np.column_stack([t, np.sin(t * (1 + t)), np.cos(t * (1 + t))])
    np.savetxt("slow.csv", rows, delimiter=",", header="time [s],T [N*m],y [rad]", comments="", fmt="%.9g")
    for command in ("estimate", "identify-modes"):
        arguments = (command, "slow.csv", "--input", "T", "--output", "y", "--preset", "paper", "--seconds", 1)
        if refused:
            message = f"keeps every 50th sample; of {rate} Hz {rate / 50:g} are left"
            assert message in run(*arguments, code=2).stderr
        elif command == "estimate":
            run(*arguments)
    if rate == 500:
        assert run("spectrogram", "slow.csv", "--preset", "paper", "--plot", "x.png", code=2).stderr
        run("estimate", "slow.csv", "--input", "T", "--output", "y", "--preset", "paper", "--decimate", 2)
