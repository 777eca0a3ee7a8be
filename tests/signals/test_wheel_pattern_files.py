"""Files of pitch patterns, and the command that writes them."""

import json
import pathlib
import re

import numpy as np
import pytest
import scipy
from support.command_line import run
from support.faults import placed_faults
from support.wheel_tests import DEGREE, RPM, VALUES, Z, record, teeth

from torsionnet.io import read_wheel_pattern, write_recording, write_wheel_pattern
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel import WheelPattern


def test_what_is_written_is_read_again(tmp_path):
    pattern = WheelPattern(
        teeth(), np.full(Z, 1e-5), missing=1, name="flywheel: engine 2", first="the first tooth after the gap",
        unresolved=(3, 6), notes=('two pickups, 114 "degrees"', "# no comment"), reversed=True,
    )  # fmt: skip
    write_wheel_pattern(pattern, tmp_path / "wheel.yaml")
    found = read_wheel_pattern(tmp_path / "wheel.yaml")
    assert found.positions == pytest.approx(pattern.positions, rel=1e-9, abs=1e-15)
    assert found.half_widths == pytest.approx(pattern.half_widths, rel=1e-9)
    for name in ("missing", "name", "first", "unresolved", "notes", "reversed"):
        assert getattr(found, name) == getattr(pattern, name)
    assert "# tooth 0" in (tmp_path / "wheel.yaml").read_text()


def test_a_person_may_write_one_in_rad(tmp_path):
    text = "torsionnet: 1\nteeth: 2\nunit: rad\npositions: [[0.001, 0], [-0.001, 0]]\n"
    (tmp_path / "w.yaml").write_text(text)
    assert read_wheel_pattern(tmp_path / "w.yaml").positions.tolist() == [0.001, -0.001]


def test_every_fault_of_a_file_is_told_with_its_place(tmp_path):
    (tmp_path / "w.yaml").write_text(
        "torsionnet: 1\nnme: x\nteeth: 3\nunit: grad\npositions:\n  - [0.1, x]\n  - [0.1]\n"
    )
    file = tmp_path / "w.yaml"
    assert [one.removeprefix(str(file)) for one in placed_faults(lambda: read_wheel_pattern(file))] == [
        ":2:1 unknown-entry",
        ":4:7 unknown-word",
        ":6:11 not-a-number",
        ":7:5 wrong-form",
    ]
    (tmp_path / "w.yaml").write_text("torsionnet: 1\nteeth: 3\nunit: deg\npositions: [[0.1, -1], [80, 0]]\n")
    assert [one.removeprefix(str(file)) for one in placed_faults(lambda: read_wheel_pattern(file))] == [
        ":4:12 wrong-count",
        ":4:19 out-of-range",
        ":4:24 wrong-unit",
    ]


@pytest.fixture
def records(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    positions = teeth()
    for rpm in (600, 900, 1300, 1800):
        test = record(positions, rpm * RPM, angle=100 * DEGREE, values=VALUES)
        write_recording(Recording((), 1e4, pulses=(test.first, test.second, test.index)), f"{rpm}.npz")
    return positions


CALL = ("--pulses", "A", "--teeth", Z, "--index", "index")


@pytest.mark.parametrize("angle", ["360 deg", "0 deg"])
def test_an_angle_of_a_whole_turn_or_of_nothing_is_refused(angle):
    said = run("calibrate-wheel", "600.npz", *CALL, "--pickup-angle", angle, code=2).stderr
    assert "--pickup-angle" in said
    assert "must be" in said


def test_vibration_repeats_after_one_turn_or_more():
    assert "x>=1" in run("calibrate-wheel", "600.npz", *CALL, "--cycle", "0", code=2).stderr


def test_the_command_writes_a_pattern_by_two_pickups(records):
    done = run(
        "calibrate-wheel", "600.npz", "900.npz", *CALL, "--second-pickup", "B", "--pickup-angle", "99deg", "--name", "flywheel",
        "-o", "wheel.yaml", "--plot", "wheel.png", "--csv", "wheel.csv",
    )  # fmt: skip
    assert "two pickups" in done.stdout
    assert "100.0000 +-" in done.stdout
    found = read_wheel_pattern("wheel.yaml")
    assert found.positions == pytest.approx(records, abs=1e-4 * DEGREE)
    assert (found.name, found.unresolved) == ("flywheel", ())
    assert any("two pickups" in note for note in found.notes)


@pytest.mark.usefixtures("records")
def test_a_part_of_the_records_is_enough():
    words = ("calibrate-wheel", "600.npz", *CALL, "--second-pickup", "B", "--pickup-angle", "99deg", "--json")
    whole, part = (json.loads(run(*words, *more).stdout) for more in ((), ("--start", "0.1", "--stop", "1.9")))
    assert part["positions_rad"] == pytest.approx(whole["positions_rad"], abs=1e-4 * DEGREE)
    assert part != whole


def test_signals_of_teeth_and_a_file_of_wheels(records):
    """Two pickups, sampled, read at one level: the pattern is that of their pulses; the file says what the options say."""
    test = record(records, 900 * RPM, angle=100 * DEGREE, values=VALUES)
    time = np.arange(test.second.times[2], test.first.times[-2], 1 / 40e3)
    signals = tuple(
        Signal(
            one.name,
            "",
            np.sin(2 * np.pi * scipy.interpolate.PchipInterpolator(one.times, np.arange(float(len(one))))(time)),
        )
        for one in (test.first, test.second)
    )
    times = np.array([one for one in test.index.times if time[0] < one < time[-1]])
    whole = Recording(signals, 40e3, float(time[0]), pulses=(PulseChannel("index", times),))
    write_recording(whole, "raw.npz")
    words = ("calibrate-wheel", "raw.npz", "--second-pickup", "B", "--pickup-angle", "99deg")
    run(*words, *CALL, "--level", "A=0", "-o", "one.yaml")
    found = read_wheel_pattern("one.yaml").positions
    assert found == pytest.approx(records, abs=5e-3 * DEGREE)
    pathlib.Path("wheels.yaml").write_text(
        f"A: {{teeth: {Z}, level: 0, index: index}}\nC: {{teeth: 60}}\n", encoding="utf-8"
    )
    run(*words, "--wheels", "wheels.yaml", "--pulses", "A", "-o", "two.yaml")
    assert read_wheel_pattern("two.yaml").positions == pytest.approx(found, abs=1e-9)
    assert "[missing-entry]" in run(*words, "--wheels", "wheels.yaml", code=2).stderr


@pytest.mark.usefixtures("records")
def test_json_holds_what_is_unresolved_and_why():
    data = json.loads(run("calibrate-wheel", "600.npz", "900.npz", "1300.npz", *CALL, "--json").stdout)
    assert not data["orders"][2]["resolved"]
    assert "rigid response to inertia torques" in data["orders"][2]["why_not_resolved"]
    assert data["lowest_speed_rpm"] == pytest.approx(600, rel=1e-6)


@pytest.mark.usefixtures("records")
@pytest.mark.parametrize(
    ("more", "code", "text"),
    [
        (("--second-pickup", "B"), 2, "--second-pickup and --pickup-angle go together"),
        (("--second-pickup", "B", "--pickup-angle", "180"), 2, "must be less than 6.28319"),
        (("--model", "engine_generator_set"), 2, "--model needs --node"),
        (("--node", "fly"), 2, "belong to a --model"),
        (("--constant-orders", "3;6"), 2, "3;6.*wrong-form"),
        ((), 2, "900 rpm.*unfit-order"),
    ],
)
def test_what_does_not_go_together_is_refused(more, code, text):
    done = run("calibrate-wheel", "900.npz", *CALL, *more, code=code)
    assert re.search(text, " ".join(done.stderr.split()))


@pytest.mark.usefixtures("records")
def test_a_channel_that_is_not_there():
    assert 'did you mean "A"' in run("calibrate-wheel", "900.npz", "--pulses", "a", "--teeth", Z, code=1).stderr


def test_times_of_pulses_in_a_text_file(records):
    times = PulseChannel("A", record(records, 100.0).first.times).times
    rows = [f"{time!r}" for time in (times - times[0] + 1e-3).tolist()]
    with pathlib.Path("a.csv").open("w", encoding="utf-8") as file:
        file.write("A [s]\n" + "\n".join(rows) + "\n")
    assert "too small" in run("calibrate-wheel", "a.csv", "--pulses", "A", "--teeth", Z, code=2).stderr
