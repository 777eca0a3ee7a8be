"""The command track: from a record of pulses and torque to complex orders in a file, a table, JSON and pictures."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from torsionnet.app.cli.app import app
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.base.notes import Note, warning
from torsionnet.io import read_tracked_orders, write_recording, write_tracked_orders
from torsionnet.io.tracked_order_tables import is_tracked_table
from torsionnet.signals.orders.tracked_orders import TrackedOrders, TrackingKernel, order_slices, stress_orders
from torsionnet.signals.orders.tracking_entries import BANDWIDTH, ORDERS
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.rotation.pulse_channel import PulseChannel


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    """Run-up from 600 to 1200 r/min in 6 s: 60-2 teeth, tooth 0 at -35 degrees, cam, torque of orders 1.5 and 3."""
    rate, first, slope = 2000.0, 20 * np.pi, 20 * np.pi / 6
    time = np.arange(12_000) / rate
    phi = first * time + slope * time**2 / 2
    torque = 500 + 100 * np.cos(3 * phi + 0.7) + 30 * np.cos(1.5 * phi - 0.2)

    def at(angles):
        return (-first + np.sqrt(first**2 + 2 * slope * angles)) / slope

    turns = int(phi[-1] / (2 * np.pi)) - 1
    teeth = np.arange(60 * turns)
    fly = at(2 * np.pi * (teeth[teeth % 60 < 58] / 60 + 1) - np.radians(35))
    cam = at(4 * np.pi * np.arange(1, turns // 2) - np.radians(150))
    gen = at(2 * np.pi * np.arange(60 * turns) / 60)
    pulses = (PulseChannel("fly", fly), PulseChannel("gen", gen), PulseChannel("cam", cam))
    whole = Recording(
        (Signal("T", "torque", torque), Signal("n", "velocity", first + slope * time)), rate, pulses=pulses
    )
    path = tmp_path_factory.mktemp("track") / "up.npz"
    write_recording(whole, path)
    return path


def run(*words, code=0):
    result = CliRunner().invoke(app, ["track", *map(str, words)])
    assert result.exit_code == code, result.output
    return result


def test_orders_with_phase_from_top_dead_centre(record, tmp_path):
    file = tmp_path / "up.csv"
    shown = run(record, "--reference-shaft", "fly=60-2", "--tdc", "35deg", "--cam", "cam", "--channel", "T", "--orders",
                "0.5:3:0.5", "-o", file, "--plot", tmp_path / "up.png", "--csv", tmp_path / "table.csv")  # fmt: skip
    assert "top dead centre of cylinder 1" in shown.output
    (found,) = read_tracked_orders(file)
    assert found.along(3) == pytest.approx(np.full(len(found.times), 100 * np.exp(0.7j)), abs=0.05)
    assert found.along(1.5) == pytest.approx(np.full(len(found.times), 30 * np.exp(-0.2j)), abs=0.05)
    assert np.abs(found.along(2)).max() < 0.05
    assert found.half_range == pytest.approx(found.half_range[0], rel=1e-3)
    assert (tmp_path / "up.png").stat().st_size > 10_000


def test_wheels_of_a_file(record, tmp_path):
    """The file says the same as the options: channel, gap and gearing."""
    file = tmp_path / "wheels.yaml"
    file.write_text("fly: {teeth: 60, missing_teeth: 2}\ngen: {teeth: 60}\n")
    words = (record, "--reference-shaft", "fly", "--tdc", "35deg", "--cam", "cam", "--orders", "1.5,3", "--json")
    found = json.loads(run(*words, "--wheels", file).stdout)
    assert [one["channel"] for one in found] == ["T", "n", "fly", "gen"]
    torque = np.array(found[0]["real"]) + 1j * np.array(found[0]["imag"])
    assert torque[0] == pytest.approx(np.full(torque.shape[1], 30 * np.exp(-0.2j)), abs=0.05)
    assert torque[1] == pytest.approx(np.full(torque.shape[1], 100 * np.exp(0.7j)), abs=0.05)
    one = json.loads(run(*words, "--wheels", file, "--pulses", "fly").stdout)
    assert [each["channel"] for each in one] == ["T", "n", "fly"]
    refused = run(*words, "--wheels", file, "--ratio", "gen=2", "--pulses", "gen=60", code=2)
    assert "leave gen=60, --ratio out" in refused.output


@pytest.mark.filterwarnings("ignore::torsionnet.TorsionnetWarning")
def test_crossing_orders_of_a_second_shaft_are_kept_apart(tmp_path):
    """Order 2 of a shaft from 8 to 14 Hz crosses order 1.5 of one at 14.5 Hz, 21.75 Hz, at 10.9 Hz; both hold their amplitude."""
    time = np.arange(3000) / 500
    first, second = 2 * np.pi * (8 * time + time**2 / 2), 2 * np.pi * 14.5 * time
    torque = 100 * np.cos(2 * first + 0.3) + 60 * np.cos(1.5 * second + 0.9)
    speeds = {"n": 2 * np.pi * (8 + time), "m": np.full(3000, 2 * np.pi * 14.5)}
    signals = (Signal("T", "torque", torque), *(Signal(name, "velocity", values) for name, values in speeds.items()))
    write_recording(Recording(signals, 500.0), tmp_path / "two.npz")
    words = (
        tmp_path / "two.npz",
        "--reference-shaft",
        "n",
        "--channel",
        "T",
        "--orders",
        "2",
        "--method",
        "vold-kalman",
    )
    result = run(*words, "--further-shaft", "m", "--further-orders", "1.5", "--json")
    found = {tuple(one["orders"]): np.hypot(one["real"], one["imag"])[0] for one in json.loads(result.stdout)}
    assert {*found} == {(2.0,), (1.5,)}
    assert found[2.0,] == pytest.approx(np.full_like(found[2.0,], 100), rel=1e-3)
    assert found[1.5,] == pytest.approx(np.full_like(found[1.5,], 60), rel=1e-3)


def test_signals_of_teeth(tmp_path):
    """A sampled tooth signal that reads 0 to 5 V, and a cam of its own level: orders and phases as from pulses."""
    time = np.arange(60_000) / 10e3
    phi = 60 * time + 1.5 * time**2
    teeth = 2.5 + 2.5 * np.sin(60 * phi)  # rises through 2.5 V where phi is a multiple of 6 degrees
    tdc = np.where((phi + 1e-9) % (2 * np.pi) < 0.3, 12.0, 0.0)
    cam = np.where((phi + np.pi / 2) % (4 * np.pi) < 0.3, 24.0, 8.0)
    torque = 100 * np.cos(3 * phi + 0.7) + 30 * np.cos(1.5 * phi - 0.2)
    file = tmp_path / "raw.csv"
    rows = np.column_stack([time, teeth, tdc, cam, torque])
    heading = "time [s],fly [V],tdc [V],cam [V],T [N*m]"
    np.savetxt(file, rows, delimiter=",", header=heading, comments="", fmt="%.6f")
    words = (
        file,
        "--reference-shaft",
        "fly=60",
        "--phase",
        "tdc",
        "--cam",
        "cam",
        "--channel",
        "T",
        "--orders",
        "1.5,3",
    )
    found = json.loads(run(*words, "--level", "fly=2.5", "--level", "cam=16", "--json").stdout)[0]
    values = np.array(found["real"]) + 1j * np.array(found["imag"])
    assert np.abs(values[1]) == pytest.approx(np.full(values.shape[1], 100), rel=2e-3)
    assert np.angle(values[1]) == pytest.approx(np.full(values.shape[1], 0.7), abs=0.02)
    assert np.angle(values[0]) == pytest.approx(np.full(values.shape[1], -0.2), abs=0.02)
    assert re.search("flt.*unknown-name", " ".join(run(*words, "--level", "flt=2.5", code=2).output.split()))


def test_vold_kalman_slices_and_waterfall(record, tmp_path):
    words = (record, "--reference-shaft", "n", "--channel", "T", "--orders", "1.5,3", "--method", "vold-kalman")
    found = json.loads(run(*words, "--bandwidth", "3Hz", "--speed-step", "50rpm", "--json").stdout)[0]
    assert np.hypot(found["real"][1], found["imag"][1])[1:-1] == pytest.approx(100, rel=2e-3)
    assert found["reference"] == ""
    run(*words, "--bandwidth", "5%", "--plot", tmp_path / "fall.png", "--picture", "waterfall")


def test_twist_torque_and_stress(record):
    words = ("--reference-shaft", "fly=60-2", "--pulses", "gen=60", "--orders", "1,3", "--twist", "fly-gen")
    found = json.loads(
        run(
            record, *words, "--channel", "fly", "--stiffness", "2 MN*m/rad", "--diameter", "fly-gen=200mm", "--json"
        ).stdout
    )
    assert [one["channel"] for one in found] == ["fly", "torque(fly-gen)", "stress(torque(fly-gen))"]
    assert [one["unit"] for one in found] == ["rad", "N*m", "Pa"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--reference-shaft", "fly=60-2", "--tdc", "35deg", "--orders", "0"), "positive numbers"),
        (("--reference-shaft", "n", "--tdc", "35deg", "--orders", "1"), "n .*ambiguous-tooth"),
        (("--reference-shaft", "fly=60-2", "--orders", "1", "--bandwidth", "1Hz"), "belong to --method vold-kalman"),
        (("--reference-shaft", "fly=60-2", "--orders", "1:2"), "first:last:step"),
        (("--reference-shaft", "fly=60-2", "--orders", "1", "--twist", "fly-gen"), "--twist fly-gen.*missing-entry"),
        (
            ("--reference-shaft", "fly=60-2", "--orders", "1", "--pattern", "gen=x.yaml"),
            "--pattern gen=x.yaml.*unknown-name",
        ),
        (("--reference-shaft", "fly=60-2", "--orders", "40"), "order 40.* 20.*beyond-sampling"),
        (("--reference-shaft", "fly=x", "--orders", "1"), r"CHANNEL\[=TEETH\]"),
        (("--reference-shaft", "T", "--orders", "1"), "T .*unfit-channel"),
        (("--reference-shaft", "fly=60-2", "--orders", "1", "--speed-step", "20Nm"), "20Nm"),
    ],
)
def test_wrong_words_are_named(record, words, message):
    result = CliRunner().invoke(app, ["track", str(record), *words])
    assert result.exit_code in (1, 2), result.output
    assert re.search(message, " ".join(result.output.split()))


def tracked(**more):
    values = np.array([[1 + 2j, 3], [4, 5j]])
    given = {"half_range": np.array([3.0, 6.0]), "reference": "tooth 0", "undecided": (0.5,), "notes": ("a", "b, c")}
    return TrackedOrders(
        "T 1", "torque", np.array([0.5, 3.0]), np.array([0.0, 1.0]), np.array([10.0, 20.0]), values,
        np.array([[0.1, np.nan], [0.2, 0.3]]), **given | more,
    )  # fmt: skip


def test_a_file_keeps_everything(tmp_path):
    file = tmp_path / "o.csv"
    notes = ("a", warning("b, c"), Note("1 pulse missing", channel="T 1"))
    one = tracked(title="run", notes=notes, tracking=TrackingKernel(share=0.1, poles=3))
    write_tracked_orders([one, replace(tracked(half_range=None), name="U")], file)
    assert is_tracked_table(file)
    again, _ = read_tracked_orders(file)
    for name in ("orders", "times", "speeds", "values", "half_widths", "half_range"):
        np.testing.assert_allclose(getattr(again, name), getattr(one, name), err_msg=name)
    assert (again.name, again.unit, again.reference, again.undecided) == ("T 1", "N*m", "tooth 0", (0.5,))
    assert (again.title, again.notes, again.tracking) == ("run", notes, one.tracking)


def test_names_that_look_like_words_of_notes_are_kept(tmp_path):
    file = tmp_path / "o.csv"
    one = tracked(
        notes=(Note("1 pulse missing", channel="warning"), warning("shaft: x (mode 3"), "warning: rig (left)")
    )
    named = replace(one, name="T"), replace(one, name="T: shaft", notes=(Note("late", "warning", "fly"), "x"))
    write_tracked_orders(named, file)
    assert [again.notes for again in read_tracked_orders(file)] == [again.notes for again in named]
    file.write_text(file.read_text().replace('# notes: {"T"', '# notes: {"T'))
    with pytest.raises(UsageError, match="the line notes of"):
        read_tracked_orders(file)


@pytest.mark.parametrize(("note", "tracking"), [
    ("Vold-Kalman filter of 3 poles, bandwidth 4 Hz between", TrackingKernel(4.0, poles=3)),
    ("Vold-Kalman filter of 2 poles, bandwidth 5 % of the order's frequency", TrackingKernel(share=0.05)),
    ("synchronous average over blocks of 8 cycles of 2 turns, intervals", TrackingKernel(revolutions=16.0, taper=2.0)),
    ("recorded", TrackingKernel()),
])  # fmt: skip
def test_older_files_tell_in_notes_how_orders_were_tracked(note, tracking, tmp_path):
    write_tracked_orders([tracked(notes=(note,))], tmp_path / "o.csv")
    assert "# tracking" not in (tmp_path / "o.csv").read_text()
    assert read_tracked_orders(tmp_path / "o.csv")[0].tracking == tracking


def test_faults_of_a_file_have_their_place(tmp_path):
    file = tmp_path / "o.csv"
    write_tracked_orders([tracked()], file)
    lines = file.read_text().splitlines()
    lines[-1] = lines[-1].replace("5.0", "five").replace("0.3", "")
    lines[-2] = lines[-2].replace("3.0", "", 1)
    file.write_text("\n".join(lines))
    with pytest.raises(ModelError) as caught:
        read_tracked_orders(file)
    text = str(caught.value)
    assert '"five" is no number' in text
    assert f"o.csv:{len(lines)}:" in text
    file.write_text("time [s],speed [rpm],order\n0,1,2\n")
    with pytest.raises(ModelError, match=r":1:1: .*missing-column"):
        read_tracked_orders(file)
    heading = "time [s],speed [rpm],order,T real [kgm],T imag [N*m]"
    for body, place in {
        f"{heading}\n0,1,2,3,4\n": r":1:28: .*unknown-unit",
        f"{heading.replace('kgm', 'N*m').replace('imag', 'img')}\n0,1,2,3,4\n": r":1:28: .*missing-column",
        f"{heading.replace('kgm', 'N*m')}\n0,nan,2,3,4\n": r":2:3: .*not-a-number",
        f"{heading.replace('kgm', 'N*m')}\n0,1,2,3,4\n0,1,2,3,4\n": r":3:1: .*repeated-name",
        f"{heading.replace('kgm', 'N*m')}\n0,1,2,3,4\n0,1,3,3,4\n1,1,2,3,4\n": r":4:1: .*wrong-count",
    }.items():
        file.write_text(body)
        with pytest.raises(ModelError, match=place):
            read_tracked_orders(file)
    file.write_text("a,b\n1,2\n")
    with pytest.raises(UsageError, match="wrong-file"):
        read_tracked_orders(file)
    with pytest.raises(UsageError, match="repeated-name"):
        write_tracked_orders([tracked(), tracked()], file)
    with pytest.raises(UsageError, match="write them apart"):
        write_tracked_orders([tracked(), replace(tracked(reference=""), name="U")], file)


def test_units_of_a_file_are_read(tmp_path):
    file = tmp_path / "o.csv"
    file.write_text("time [s],speed [rpm],order,T real [kNm],T imag [kNm]\n0,60,3,1,2\n")
    (one,) = read_tracked_orders(file)
    assert one.along(3) == pytest.approx([1000 + 2000j])
    assert one.speeds == pytest.approx([2 * np.pi])
    assert np.isnan(one.half_widths).all()
    assert one.half_range is None


def test_slices_and_stress():
    sliced = order_slices(tracked(), 100.0)
    assert sliced.along(3) == pytest.approx([2 + 2.5j])
    assert sliced.half_range == pytest.approx([6.0])
    stress = stress_orders(tracked(), 0.2)
    assert stress.along(3) == pytest.approx(tracked().along(3) * 16 / (np.pi * 0.2**3))
    with pytest.raises(UsageError, match="out-of-range"):
        stress_orders(tracked(), 0.0)


def test_entries():
    assert ORDERS.coerce("0.5:2:0.5, 6") == (0.5, 1.0, 1.5, 2.0, 6.0)
    assert (BANDWIDTH.coerce("2%").share, BANDWIDTH.coerce("0.5 Hz").bandwidth) == (0.02, 0.5)


def test_a_misspelt_reference_names_the_likely_wheel(record, tmp_path):
    wheels = tmp_path / "wheels.yaml"
    wheels.write_text("fly: {teeth: 60, missing_teeth: 2}\ngen: {teeth: 60}\n")
    result = CliRunner().invoke(
        app, ["track", str(record), "--wheels", str(wheels), "--reference-shaft", "flyy", "--orders", "3"]
    )
    assert result.exit_code == 2
    assert 'named flyy; did you mean "fly"?; wheels: fly, gen; channels: T, n' in " ".join(result.output.split())


def test_a_part_of_the_record_counts(record, tmp_path):
    """Speeds between 2 and 4 s of a run-up of 100 r/min a second from 600, for wheels, signals and the reference."""
    for reference in ("fly=60-2", "n"):
        file = tmp_path / f"{reference[:1]}.csv"
        run(
            record,
            "--reference-shaft",
            reference,
            "--channel",
            "T",
            "--orders",
            "3",
            "-o",
            file,
            "--start",
            2,
            "--stop",
            4,
        )
        (found,) = read_tracked_orders(file)
        assert found.times.min() >= 2
        assert found.times.max() <= 4
        assert np.abs(found.along(3)) == pytest.approx(100, rel=5e-3)
