"""Checks of the records of a campaign: what is a remark, when a record is left out, when the command fails."""

import json
import re

import numpy as np
import pytest
from click.testing import CliRunner
from support.steady_campaign import CAMPAIGN, RATE, SPEED, STEADY_FAN, TURNS, torque, write_steady_record

import torsionnet as tn
from torsionnet.app.cli.app import app
from torsionnet.base.errors import ModelError
from torsionnet.io import read_recording, write_recording
from torsionnet.signals.recording import Recording, Signal

STILL = slice(4000, 4400)


@pytest.fixture
def folder(tmp_path):
    """Campaign whose second record is clipped, stands still for 0.2 s, and lacks 7 of its 7199 pulses."""
    (tmp_path / "fan.yaml").write_text(STEADY_FAN, encoding="utf-8")
    write_steady_record(tmp_path / "first.npz", 1, torque(SPEED))
    write_steady_record(tmp_path / "again.npz", 2, torque(SPEED))
    record = read_recording(tmp_path / "again.npz", pulse_readings={})
    values = np.clip(record["T"].values, -np.inf, 0.5 * record["T"].values.max())
    values[STILL] = values[STILL.start]
    wheel, mark = record.pulses
    wheel = type(wheel)("wheel", np.delete(wheel.times, [500, 1711, 2222, 3456, 4003, 5555, 6789]))
    changed = Recording((Signal("T", "torque", values),), sampling_rate=RATE, pulses=(wheel, mark))
    write_recording(changed, tmp_path / "again.npz")
    return tmp_path


def run(folder, checks=""):
    (folder / "test.yaml").write_text(CAMPAIGN + checks, encoding="utf-8")
    return tn.run_campaign(tn.load_campaign(folder / "test.yaml"))


def test_without_levels_faults_are_remarks_with_their_counts(folder):
    result = run(folder)
    values = read_recording(folder / "again.npz", pulse_readings={})["T"].values
    found = {one.check: one for one in result.findings}
    assert {one.record for one in result.findings} == {"again"}
    # Runs at the limit count from six samples on; noise breaks others into shorter ones.
    assert 0.02 < found["clipping"].share <= np.mean(values == values.max())
    assert found["drop_outs"].count == STILL.stop - STILL.start
    assert list(result.records) == ["first", "again"]
    assert not result.fails
    assert sum("again: T: drop-outs in 400 samples" in remark for remark in result.remarks) == 1


def test_a_record_is_left_out_from_its_level_on(folder):
    result = run(folder, "checks: {drop_outs: {leave_out: 1 %}}\n")
    assert list(result.records) == ["first"]
    assert not result.spreads
    assert list(run(folder, "checks: {drop_outs: {leave_out: 50 %}}\n").records) == ["first", "again"]


def test_pulses_are_counted_where_they_have_a_level(folder):
    result = run(folder, "checks: {pulses: {fail: 0.05 %}}\n")
    (found,) = (one for one in result.findings if one.check == "pulses")
    assert "wheel: 7 pulses missing or too many, 0.0973 %; this is beyond" in found.remark
    assert (found.channel, found.count) == ("wheel", 7)
    assert found.share == pytest.approx(7 / (60 * TURNS), rel=0.01)
    assert result.fails


def test_a_campaign_of_which_no_record_is_left_says_why(folder):
    text = CAMPAIGN.replace("  first: {file: first.npz, configuration: clean}\n", "")
    (folder / "test.yaml").write_text(f"{text}checks: {{drop_outs: {{leave_out: 1 %}}}}\n", encoding="utf-8")
    with pytest.raises(ModelError, match=r"checks: .*400.*missing-data"):
        tn.run_campaign(tn.load_campaign(folder / "test.yaml"))


def test_command_fails_beyond_a_level_and_shows_its_results(folder, monkeypatch):
    monkeypatch.chdir(folder)
    (folder / "test.yaml").write_text(f"{CAMPAIGN}checks: {{clipping: {{fail: 0.1 %}}}}\n", encoding="utf-8")
    found = CliRunner().invoke(app, ["campaign", "test.yaml", "--json"])
    assert found.exit_code == 1
    assert "error: again: T: clipping in" in found.stderr
    data = json.loads(found.stdout)
    assert [one["name"] for one in data["records"]] == ["first", "again"]
    assert {one["check"]: one["consequence"] for one in data["checks"]} == {"clipping": "fails", "drop_outs": ""}


def test_every_fault_of_the_checks_has_its_place(folder):
    with pytest.raises(ModelError) as caught:
        run(folder, "checks: {clipping: {}, drop_outs: {fail: -1 %}, pulse: {fail: 1 %}}\n")
    said = str(caught.value)
    assert re.search("test.yaml:12:10: error: .*missing-entry", said)
    assert "test.yaml:12:42: error:" in said
    assert re.search("test.yaml:12:49: error: .*unknown-entry", said)
