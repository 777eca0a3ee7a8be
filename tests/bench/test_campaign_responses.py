"""Campaigns of a rig that is shaken: responses of several records beside the model, repeatability, fit, report."""

import csv
import json

import numpy as np
import pytest
from click.testing import CliRunner

import torsionnet as tn
from torsionnet.app.cli.app import app
from torsionnet.base.errors import ModelError
from torsionnet.bench.campaign import running_campaign
from torsionnet.io import write_recording
from torsionnet.report.report import campaign_report, writer_for
from torsionnet.signals.recording import Recording, Signal

MODEL = """
torsionnet: 1
name: rig
elements:
  rotor: {type: inertia, node: motor, inertia: 2 kg*m^2}
  shaft: {type: spring, nodes: [motor, fan], stiffness: 20 kN*m/rad, damping: 40 N*m*s/rad}
  fan: {type: inertia, node: fan, inertia: 3 kg*m^2}
inputs: {T_in: {torque: motor}}
sensors: {T: {torque: shaft}, omega: {velocity: fan}}
"""
CAMPAIGN = """
torsionnet: 1
name: shaken rig
model: rig.yaml
channels: {M: {sensor: T, gain: 2}}
records: {first: first.npz, again: again.npz}
responses:
  input: F
  outputs: [M, omega]
  model_input: T_in
  band: 4..60 Hz
  settings: {window: hann, seconds: 2 s, overlap: 50 %}
"""
RATE, SECONDS = 500.0, 40.0


def responses(frequencies, stiffness=20e3):
    """Torque in the shaft, and speed of the fan, over the torque on the motor, from two inertias written out."""
    s = 2j * np.pi * np.asarray(frequencies, dtype=float)
    spring = stiffness + 40 * s
    determinant = (spring + 2 * s**2) * (spring + 3 * s**2) - spring**2
    motor, fan = (spring + 3 * s**2) / determinant, spring / determinant
    return spring * (motor - fan), s * fan


def write(path, seed, stiffness=20e3):
    """Record of noise on the motor and what it causes, the torque at half its size, with noise."""
    chance, count = np.random.default_rng(seed), int(RATE * SECONDS)
    drive = chance.normal(scale=10, size=count)
    lines, frequencies = np.fft.rfft(drive), np.fft.rfftfreq(count, 1 / RATE)
    frequencies[0] = np.inf
    with np.errstate(invalid="ignore"):
        caused = [np.fft.irfft(np.nan_to_num(h) * lines, count) for h in responses(frequencies, stiffness)]
    noisy = [one + chance.normal(scale=0.02 * one.std(), size=count) for one in caused]
    signals = (
        Signal("F", "torque", drive),
        Signal("M", "torque", noisy[0] / 2),
        Signal("omega", "velocity", noisy[1]),
    )
    write_recording(Recording(signals, sampling_rate=RATE), path)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "rig.yaml").write_text(MODEL, encoding="utf-8")
    (tmp_path / "test.yaml").write_text(CAMPAIGN, encoding="utf-8")
    write(tmp_path / "first.npz", 1)
    write(tmp_path / "again.npz", 2)
    return tmp_path


def run(folder, *changes):
    text = CAMPAIGN
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    (folder / "test.yaml").write_text(text, encoding="utf-8")
    return tn.run_campaign(tn.load_campaign(folder / "test.yaml"))


def test_responses_are_those_of_the_inertias_written_out(folder):
    for one in run(folder).responses.values():
        f = one.measured.frequencies
        assert 4 <= f[0] < f[-1] <= 60
        for place, exact in enumerate(responses(f)):
            np.testing.assert_allclose(one.measured.values[:, place, 0], exact, atol=0.05 * abs(exact).max())
            np.testing.assert_allclose(one.calculated.values[:, place, 0], exact, rtol=1e-9)
        # Noise of 2 % of the torque hardly lowers its coherence within the band.
        assert one.measured.coherence[:, 0].min() > 0.9


def test_rows_say_how_far_test_and_model_are_apart(folder):
    write(folder / "again.npz", 2, stiffness=30e3)
    rows = {(one.record, one.output): one for one in run(folder).response_rows}
    good, bad = rows["first", "M"], rows["again", "M"]
    assert good.decibels < 0.3 < 2 < bad.decibels
    assert good.frac > 0.998 > bad.frac
    # 30 instead of 20 kN m/rad raise the peak by the root of 1.5, within the lines of 0.5 Hz.
    assert bad.peak == pytest.approx(good.calculated_peak * np.sqrt(1.5), abs=1.0)


def test_repeats_spread_as_their_coherence_says(folder):
    (torque, speed) = run(folder).response_spreads
    assert (torque.response, torque.records) == ("M/F", 2)
    for one in (torque, speed):
        assert 0.7 < one.ratio < 1.4


def test_only_the_record_that_changed_is_estimated_again(folder, monkeypatch):
    read, names = running_campaign.campaign_response, []
    from torsionnet.bench.campaign import estimating_responses

    original = estimating_responses.estimated_response
    monkeypatch.setattr(
        estimating_responses, "estimated_response", lambda c, name: names.append(name) or original(c, name)
    )
    run(folder)
    run(folder)
    assert names == ["first", "again"]
    write(folder / "again.npz", 7)
    run(folder)
    assert names == ["first", "again", "again"]
    run(folder, ("seconds: 2 s", "seconds: 4 s"))
    assert names == ["first", "again", "again", "first", "again"]
    assert len(list((folder / "test.orders").glob("*~responses-*"))) == 2
    assert read is running_campaign.campaign_response


@pytest.mark.slow
def test_fit_takes_the_records_of_the_responses(folder):
    fit = run(folder, ("responses:", "fit: {parameters: {shaft.stiffness: 18 kN*m/rad}}\nresponses:")).fit
    assert fit.values["shaft.stiffness"] == pytest.approx(20e3, rel=0.005)
    assert [one.name for one in fit.comparisons] == ["first: M", "first: omega", "again: M", "again: omega"]


def test_command_prints_json_and_writes_every_line_as_csv(folder, monkeypatch):
    monkeypatch.chdir(folder)
    found = CliRunner().invoke(app, ["campaign", "test.yaml", "--json", "--csv", "lines.csv"])
    assert found.exit_code == 0, found.output
    data = json.loads(found.stdout)
    named = [(one["record"], one["output"]) for one in data["responses"]]
    assert named == [("first", "M"), ("first", "omega"), ("again", "M"), ("again", "omega")]
    assert data["orders"] == []
    assert data["records"][0]["from_rpm"] is None
    assert len(data["response_repeatability"]) == 2
    with (folder / "lines.csv").open(encoding="utf-8") as stream:
        lines = list(csv.DictReader(line for line in stream if not line.startswith("#")))
    first = next(line for line in lines if line["frequency [Hz]"] == "20.0")
    assert float(first["|test|"]) == pytest.approx(abs(responses([20.0])[0][0]), rel=0.05)


@pytest.mark.slow
def test_command_writes_pictures_and_a_report_of_every_response(folder, monkeypatch):
    monkeypatch.chdir(folder)
    (folder / "test.yaml").write_text(f"{CAMPAIGN}report: {{sections: [test]}}\n", encoding="utf-8")
    found = CliRunner().invoke(app, ["campaign", "test.yaml", "--plot", "test.png", "-o", "test.html"])
    assert found.exit_code == 0, found.output
    assert len(list(folder.glob("test_*.png"))) == 4
    assert (folder / "test.html").read_text(encoding="utf-8").count("test minus model") == 4


def test_screen_shows_responses_without_a_table_of_orders(folder, monkeypatch):
    monkeypatch.chdir(folder)
    found = CliRunner().invoke(app, ["campaign", "test.yaml"])
    assert found.exit_code == 0, found.output
    assert "frequency responses of test and model" in found.stdout
    assert "orders compared" not in found.stdout


@pytest.mark.slow
def test_report_is_as_the_campaign_plans_it(folder):
    plan = (
        "report: {kind: approval, title: Prüfstandslauf, language: de, sections: [test],\n"
        "  title_block: {document_number: TV-17, revisions: [{revision: B, date: 2026-11-20}]}}\n"
    )
    result = run(folder, ("responses:", f"{plan}responses:"))
    report = campaign_report(result)
    assert report.title == "Prüfstandslauf"
    assert [section.name for section in report.sections] == ["test"]
    write = writer_for("report.html")
    write(report, folder / "report.html")
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "<html lang=de>" in page
    assert "TV-17" in page
    assert "2026-11-20" in page


def test_faults_of_the_report_have_their_places(folder):
    plan = "report: {language: fr, sections: [tests]}\nresponses:"
    with pytest.raises(ModelError) as caught:
        run(folder, ("responses:", plan))
    assert [(fault.position.line, fault.position.column, fault.kind) for fault in caught.value.faults] == [
        (7, 20, "unknown-word"),
        (7, 35, "unknown-word"),
    ]
    with pytest.raises(ModelError, match=r":7:31: .*unknown-channel"):
        run(folder, ("responses:", "report: {transfer_functions: [omgea/T_in]}\nresponses:"))


def test_every_fault_of_the_responses_has_its_place(folder):
    with pytest.raises(ModelError) as caught:
        run(
            folder,
            ("outputs: [M, omega]", "outputs: [M, omgea]"),
            ("model_input: T_in", "model_input: T_im"),
            ("overlap: 50 %", "overlap: 150 %"),
            ("again: again.npz", "again: {file: again.npz, shows: orders}"),
        )
    assert [(fault.position.line, fault.position.column, fault.kind) for fault in caught.value.faults] == [
        (6, 61, "missing-entry"),
        (9, 16, "unknown-channel"),
        (10, 16, "unknown-channel"),
        (12, 13, "out-of-range"),
    ]


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("responses:", "answers:", r":2:1: .*missing-entry"),
        ("responses:", "orders: 1:4:1\nresponses:", "missing-entry"),
        ("outputs: [M, omega]", "outputs: []", r":9:12: .*missing-entry"),
        ("outputs: [M, omega]", "outputs: [M, F]", r":9:16: .*needless-entry"),
        ("band:", "bant:", "unknown-entry"),
    ],
)
def test_what_contradicts_itself_is_refused(folder, before, after, words):
    with pytest.raises(ModelError, match=words):
        run(folder, (before, after))


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("input: F", "input: Q", "record first: .*Q"),
        ("seconds: 2 s", "seconds: 200 s", "record first: .*too short"),
        ("{sensor: T, gain: 2}", "{sensor: omega}", r"records\.first: .*wrong-unit"),
    ],
)
def test_what_a_record_lacks_is_said_with_its_name(folder, before, after, words):
    with pytest.raises(ModelError, match=words):
        run(folder, (before, after))
