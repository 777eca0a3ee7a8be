"""Responses of like signals, such as torque over torque: read in every spelling, fitted, and ranked without unknowns."""

import json
import re

import numpy as np
import pytest
from support.command_line import run

import torsionnet as tn
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.io import read_frequency_response

FIT = """\
torsionnet: 1
model: amt_rig
measurements:
  II: {response: tt.csv, output: T_T, input: T_M, configuration: II}
"""
F = np.linspace(1, 20, 25)


def table(path, unit, output="T_T"):
    values = tn.load("amt_rig").configured("II").frequency_response(output, "T_M", F).values[:, 0, 0]
    rows = [f"{f:.17g},{abs(g):.17g},{np.degrees(np.angle(g)):.17g}" for f, g in zip(F, values, strict=True)]
    heading = f"frequency [Hz],|{output}/T_M|{unit},phase {output}/T_M [deg]"
    path.write_text("\n".join([heading, *rows, ""]))
    return read_frequency_response(path)


@pytest.mark.parametrize("unit", ["1", "-", "N*m/(N*m)", "Nm/Nm", "N.m/N.m", "(N*m)/(N*m)", "N-m/N-m"])
def test_torque_over_torque_is_read_and_fitted(tmp_path, unit):
    response = table(tmp_path / "r.csv", f" [{unit}]")
    assert {channel.unit for channel in (*response.outputs, *response.inputs)} <= {"1", "N*m"}
    rig = tn.load("amt_rig").configured(c_O=100)
    fit = tn.identify(rig, tn.Measurement(response, "T_T", "T_M", configuration="II"), ["c_O"])
    assert fit.values["c_O"] == pytest.approx(170, rel=1e-6)


@pytest.mark.parametrize("unit", ["", " []", " [kN*m/(N*m)]", " [%]"])
def test_other_units_are_refused(tmp_path, unit):
    """Without a unit the ratio was taken for that of an angle to a velocity."""
    with pytest.raises(ModelError, match=r".*N\*m/\(N\*m\), 1"):
        table(tmp_path / "r.csv", unit)


def test_a_ratio_of_unlike_signals_in_the_model_is_refused(tmp_path):
    response = table(tmp_path / "r.csv", " [1]", "theta_1")
    with pytest.raises(UsageError, match="wrong-unit"):
        tn.identify(tn.load("amt_rig"), tn.Measurement(response, "theta_1", "T_M", configuration="II"), ["c_O"])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "f.yaml").write_text(FIT)
    return tmp_path


def test_what_frf_writes_is_read_back_and_fitted(folder):
    run(
        "frf",
        "amt_rig",
        "-c",
        "II",
        "--output",
        "T_T",
        "--input",
        "T_M",
        "--band",
        "1",
        "20",
        "--csv",
        "tt.csv",
    )
    response = read_frequency_response("tt.csv")
    exact = tn.load("amt_rig").configured("II").frequency_response("T_T", "T_M", response.frequencies)
    np.testing.assert_allclose(response.values, exact.values, rtol=1e-12)
    (folder / "f.yaml").write_text(FIT + "parameters: {c_O: {start: 100}}\n")
    found = json.loads(run("fit", "f.yaml", "--json").stdout)["parameters"]
    assert found[0]["value"] == pytest.approx(170, rel=1e-9)


def test_a_table_of_several_configurations_names_them(folder):
    span = ("--band", "1", "20", "--csv", "both.csv")
    run("frf", "amt_rig", "-c", "II", "-c", "III", "--output", "T_T", "--input", "T_M", *span)
    with pytest.raises(ModelError, match=r":3:1: .*unlike-results"):
        read_frequency_response(folder / "both.csv")


@pytest.mark.slow
def test_a_ranking_needs_no_unknown_parameters(folder):
    response = table(folder / "tt.csv", " [1]")
    data = json.loads(run("fit", "f.yaml", "--rank", "--json").stdout)
    assert {"c_O", "k_1", "gain"} <= {one["unknown"] for one in data["ranking"]}
    assert re.search("--rank .*missing-entry", run("fit", "f.yaml", code=1).stderr)
    refused = run("fit", "f.yaml", "--rank", "--profile", "-o", "x.yaml", code=2).stderr
    assert re.search("--profile and -o: .*needless-entry", refused)
    assert response.has_phase
