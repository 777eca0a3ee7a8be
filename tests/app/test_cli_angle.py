"""Command angle: from counts, times and tooth signals to a record of angle, speed and uncertainty."""

import json
import re

import numpy as np
import pytest
from support.command_line import run
from support.known_rotation import pulse_times, shaft

from torsionnet.base.errors import ModelError
from torsionnet.io.wheel_files import read_wheels
from torsionnet.signals import read_recording, write_recording
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel import WheelPattern

PITCH = 2 * np.pi / 60
_, ANGLE = shaft(60.0, {6: np.radians(0.1)}, acceleration=6.0)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("angle")
    numbers = np.arange(60, 2400)
    times = pulse_times(ANGLE, numbers * PITCH, 5.0)
    gap = pulse_times(ANGLE, numbers[numbers % 48 < 46] * 2 * np.pi / 48, 6.0)
    channels = (PulseChannel("n1", np.floor(times / 1e-7) * 1e-7, 1e-7), PulseChannel("n2", np.delete(gap, 200)))
    write_recording(Recording((), 1000.0, pulses=channels), folder / "run.npz")
    counts = np.floor(times * 80e6) % 2**24
    (folder / "ticks.csv").write_text("n1\n" + "\n".join(f"{count:.0f}" for count in counts))
    time = np.arange(40_000) / 20e3
    rows = [f"{t:.6f};{v:.5f}" for t, v in zip(time, np.sin(60 * ANGLE(time)), strict=True)]
    (folder / "raw.csv").write_text("time [s];teeth [V]\n" + "\n".join(rows))
    return folder


def wheels_of(folder, *arguments):
    return {
        one["name"]: one
        for one in json.loads(run("angle", str(folder / arguments[0]), *arguments[1:], "--json").stdout)["wheels"]
    }


@pytest.mark.parametrize(
    ("unit", "per_second", "shown"), [("ms", 1e3, "0.6 rpm, in ms 600"), ("us", 1e6, "0.0006 rpm, in us 600")]
)
def test_times_without_a_unit_that_make_an_impossible_speed_are_asked_for_it(tmp_path, unit, per_second, shown):
    times = np.arange(600) / 600
    (tmp_path / "bare.csv").write_text("p\n" + "\n".join(f"{per_second * time:.3f}" for time in times))
    given = ("angle", str(tmp_path / "bare.csv"), "--pulses", "p=60")
    assert f"turns at {shown} rpm" in run(*given, code=1).stderr
    found = json.loads(run(*given, "--unit", f"p={unit}", "--json").stdout)["wheels"][0]
    assert found["highest_speed_rad_s"] == pytest.approx(20 * np.pi, rel=1e-3)
    assert found["settled_s"] == pytest.approx([times[20], times[-21]], rel=1e-4)
    with pytest.raises(ModelError, match=f"p: the times of the pulses have no unit: .* in {unit} 600 rpm"):
        read_recording(tmp_path / "bare.csv", pulses={"p": 60})


def test_a_wheel_with_three_gaps_by_its_pattern(tmp_path):
    there = np.flatnonzero(~np.isin(np.arange(36 * 30) % 36, [16, 17, 28, 29, 34, 35]))
    (tmp_path / "gaps.csv").write_text("p [s]\n" + "\n".join(f"{place / 36 / 20:.9f}" for place in there))
    given = (str(tmp_path / "gaps.csv"), "--pulses", "p=36", "--pattern")
    found = wheels_of(tmp_path, *given, "16 teeth, 2 missing, 10 teeth, 2 missing, 4 teeth, 2 missing")["p"]
    assert found["highest_speed_rad_s"] == pytest.approx(40 * np.pi, rel=1e-6)
    assert "[wrong-count]" in run("angle", *given, "32 teeth, 2 missing", code=1).stderr


def test_a_record_with_angle_speed_and_uncertainty(folder):
    done = run(
        "angle", str(folder / "run.npz"), "--pulses", "n1=60", "--pulses", "n2=48-2", "-o", str(folder / "angle.npz"),
        "--orders", "6", "--plot", str(folder / "angle.png"),
    )  # fmt: skip
    assert re.search(r"n2: gap of 2 teeth found in \d+ turns, first after pulse 33 of the record", done.stdout)
    assert "n2: 1 pulse missing and counted: 1 after pulse 199" in done.stdout
    found = read_recording(folder / "angle.npz")
    assert found.names == tuple(f"{n} {what}" for n in ("n1", "n2") for what in ("angle", "speed", "angle deviation"))
    inner = (found.time > 0.2) & (found.time < found.time[-1] - 0.2)
    for name in ("n1 angle", "n2 angle"):
        away = (found[name].values - ANGLE(found.time))[inner]
        assert np.ptp(away) < 3e-5
    assert np.degrees(found["n1 angle deviation"].values).max() < 0.001
    assert {channel.name for channel in found.pulses} == {"n1", "n2"}


def test_counts_of_a_clock_that_wraps(folder):
    one = wheels_of(folder, "ticks.csv", "--pulses", "n1", "--teeth", "60", "--clock", "80MHz", "--bits", "24")["n1"]
    assert one["tick_s"] == pytest.approx(12.5e-9)
    assert one["revolutions"] == pytest.approx(2339 / 60)
    assert (one["highest_order"], one["alias_order"]) == (25, 30)


def test_the_signal_of_the_teeth(folder):
    one = wheels_of(folder, "raw.csv", "--pulses", "teeth=60")["teeth"]
    assert one["revolutions"] == pytest.approx(ANGLE(2.0) / (2 * np.pi), abs=0.04)


def test_an_order_that_the_teeth_do_not_tell(folder):
    done = run("angle", str(folder / "run.npz"), "--pulses", "n1=60", "--orders", "54", code=2)
    assert re.search("order 54 .*beyond-sampling", done.stderr)


def test_all_that_is_wrong_with_wheels_is_said_at_once(folder):
    done = run("angle", str(folder / "run.npz"), "--pulses", "n1=60-3", "--pulses", "n2=50", code=1)
    assert re.search("n1: .* 3 .*unfit-wheel", done.stderr)
    assert re.search("n2: .* 48 .*unfit-wheel", done.stderr)


@pytest.mark.parametrize(
    ("arguments", "message", "code"),
    [
        ([], "--pulses n1=60.*missing-entry", 2),
        (["--pulses", "n1"], "n1: .*missing-entry", 1),
        (["--pulses", "n3=60"], '"n3".*unknown-channel', 1),
        (["--pulses", "n1=60", "--ratio", "fast"], "n1: --ratio", 1),
        (
            ["--pulses", "n1=60", "--wheels", "w.yaml"],
            "n1=60.*contradicting-entries",
            2,
        ),
    ],
)
def test_bad_options(folder, arguments, message, code):
    done = run("angle", str(folder / "run.npz"), *arguments, code=code)
    assert re.search(f"(?s){message}", done.stderr)


class TestWheelFiles:
    def test_wheels_with_a_pattern(self, folder):
        from torsionnet.io.wheel_files import write_wheel_pattern

        places = np.radians(0.1) * np.cos(PITCH * np.arange(60))
        write_wheel_pattern(WheelPattern(places, np.full(60, 1e-6)), folder / "fly.yaml")
        file = folder / "wheels.yaml"
        file.write_text("n1: {teeth: 60, pattern: fly.yaml, ratio: 1.5}\nn2: {teeth: 48, missing_teeth: 2}\n")
        found = read_wheels(file)
        assert np.allclose(found["n1"].pattern.positions, places)
        assert (found["n1"].channel.ratio, found["n2"].channel.missing_teeth) == (1.5, 2)

    def test_every_fault_has_its_place(self, folder):
        file = folder / "bad.yaml"
        file.write_text(
            "n1: {teeth: 60, tooth: 3}\nn2:\n  teeth: 48\n  tick: 3 kg\nn3: {teeth: 36, pattern: none.yaml}\n"
        )
        with pytest.raises(ModelError) as error:
            read_wheels(file)
        places = {(fault.position.line, fault.position.column) for fault in error.value.faults}
        assert places == {(1, 17), (4, 9), (5, 26)}


def test_a_part_of_the_record_counts(folder, tmp_path):
    """The second half lacks half of its pulses, and is cut away; the first is read as if nothing stood behind it."""
    times = pulse_times(ANGLE, np.arange(60, 2400) * PITCH, 5.0)
    half = times[1200]
    broken = PulseChannel("n1", np.concatenate([times[times <= half], times[times > half][::7]]))
    write_recording(Recording((), 1000.0, pulses=(broken,)), tmp_path / "broken.npz")
    options = ("--pulses", "n1=60", "--orders", "6")
    assert "cut the record" in run("angle", str(tmp_path / "broken.npz"), *options, code=1).stderr
    (one,) = wheels_of(tmp_path, "broken.npz", *options, "--stop", f"{half:.9f}").values()
    assert one["pulses"] == 1201
    (early,) = wheels_of(tmp_path, "broken.npz", *options, "--start", "1.5", "--stop", f"{half:.9f}").values()
    assert early["pulses"] == np.count_nonzero((times >= 1.5) & (times <= half))
    assert early["lowest_speed_rad_s"] > one["lowest_speed_rad_s"]
    assert "[out-of-range]" in run("angle", str(folder / "run.npz"), *options, "--start", "99", code=2).stderr


@pytest.mark.parametrize("by", ["signal", "wheel"])
def test_the_record_of_a_second_system_comes_to_the_clock_of_the_first(tmp_path, by):
    """Its clock gains 80 ppm and was started 0.5 s later; the delay of a channel is taken out like that of a clock."""
    time = np.arange(40_000) / 2e3

    def torque(of):
        return np.random.default_rng(3).normal(size=60) @ np.sin(np.outer(np.arange(3, 63), of) * 1.7)

    drift, offset = 80e-6, 0.5
    numbers = np.arange(60, 15_000)
    pulses = pulse_times(ANGLE, numbers * PITCH, 20.0)
    for name, moved in (("first", lambda t: t), ("second", lambda t: offset + (1 + drift) * t)):
        own = moved(pulses)
        there = (time - moved(0.0)) / (moved(1.0) - moved(0.0))  # time of the first system at the samples of this one
        signals = (Signal("T", "torque", torque(there)),)
        write_recording(Recording(signals, 2e3, pulses=(PulseChannel("n1", own),)), tmp_path / f"{name}.npz")
    what = ("--channel", "T") if by == "signal" else ("--pulses", "n1=60")
    files = [str(tmp_path / f"{name}.npz") for name in ("first", "second")]
    found = json.loads(run("clocks", *files, *what, "--json", "-o", str(tmp_path / "moved.npz")).stdout)
    assert found["drift"] == pytest.approx(drift, abs=2e-6)
    assert found["offset_s"] == pytest.approx(offset, abs=2e-4)
    moved = read_recording(tmp_path / "moved.npz")
    assert moved.pulses_of("n1").times == pytest.approx(pulses, abs=5e-4)
    assert moved.sampling_rate == pytest.approx(2e3 * (1 + drift), rel=1e-5)
    assert "name what both recorded" in run("clocks", *files, code=2).stderr


def test_a_channel_that_comes_late(folder):
    """Pulses 10 ms late: the angles are those of 10 ms before."""
    early = wheels_of(folder, "run.npz", "--pulses", "n1=60", "--delay", "n1=10ms", "--stop", "2")["n1"]
    there = wheels_of(folder, "run.npz", "--pulses", "n1=60", "--stop", "2.01")["n1"]
    assert early["pulses"] == there["pulses"]
    assert early["highest_speed_rad_s"] == pytest.approx(there["highest_speed_rad_s"], rel=1e-9)
    refused = run("angle", str(folder / "run.npz"), "--pulses", "n1=60", "--delay", "n7=10ms", code=2).stderr
    assert "no such channel" in refused
