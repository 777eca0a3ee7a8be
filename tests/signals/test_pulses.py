"""Pulses of encoders: the angle between them, and what is wrong with them."""

import json

import numpy as np
import pytest
from support.command_line import run
from support.written_models import TWO_DISCS

from torsionnet.base.errors import ModelError, SolveError, TorsionnetWarning, UsageError
from torsionnet.identification.fit_file import load_fit_plan
from torsionnet.signals import (
    Recording,
    Signal,
    angle_from_pulses,
    check_recording,
    read_recording,
    repaired_pulses,
    write_recording,
)
from torsionnet.signals.bandlimited import Rotation
from torsionnet.signals.encoder import pulse_times
from torsionnet.signals.pulses import missing_pulses

LINES, SPEED, RATE = 60, 50 * np.pi, 20_000.0  # 25 turns a second
SMALL = np.radians(0.1)
STEP = 2 * np.pi / LINES
MARGIN = 20 / (LINES * SPEED / (2 * np.pi))  # s; twenty pulses


def motion(order=6, size=SMALL, slope=0.0, slow=0.0):
    """Rotation with one order, a rising speed and a swing of order 2; as a function of time."""

    def angle(t):
        mean = SPEED * t + slope * t**2 / 2
        return mean + size * np.sin(order * mean) + slow * np.sin(2 * mean)

    return angle


def pulses_of(angle, seconds=2.0):
    """Times at which the angle is a whole number of steps, by Newton."""
    steps = np.arange(int(angle(seconds) / STEP)) * STEP
    times = steps / SPEED
    for _ in range(80):
        times = times - (angle(times) - steps) / ((angle(times + 1e-7) - angle(times - 1e-7)) / 2e-7)
    assert np.abs(angle(times) - steps).max() < 1e-9
    return times


def time_of(found, start):
    return start + np.arange(len(found)) / RATE


def amplitude(values, time, order):
    """Of the order, over the mean rotation, by least squares."""
    mean = SPEED * time
    columns = np.column_stack([np.sin(order * mean), np.cos(order * mean), np.ones_like(time)])
    return np.hypot(*np.linalg.lstsq(columns, values - mean)[0][:2])


class TestBetweenPulses:
    @pytest.mark.parametrize(("order", "straight", "limit"), [(6, 0.033, 1e-6), (15, 0.19, 1e-6), (25, 0.46, 5e-5)])
    def test_orders_come_out_as_large_as_they_are(self, order, straight, limit):
        angle = motion(order)
        times = pulses_of(angle)
        found, start = angle_from_pulses(times, LINES, RATE)
        time = time_of(found, start)
        inner = (time > 0.1) & (time < 1.9)
        size = amplitude(found[inner], time[inner], order) / SMALL
        assert abs(size - 1) < limit
        lines = np.interp(time, times, np.arange(len(times)) * STEP)
        assert amplitude(lines[inner], time[inner], order) / SMALL == pytest.approx(1 - straight, abs=0.01)

    @pytest.mark.parametrize(("order", "margin", "end"), [(6, 2e-5, 0.02), (15, 2e-4, 0.15)])
    def test_error_at_the_ends(self, order, margin, end):
        angle = motion(order)
        found, start = angle_from_pulses(pulses_of(angle), LINES, RATE)
        time = time_of(found, start)
        error = np.abs(found - angle(time)) / SMALL
        assert error[(time > MARGIN) & (time < time[-1] - MARGIN)].max() < margin
        assert error.max() < end

    @pytest.mark.parametrize("order", [6, 15])
    def test_a_run_up_with_a_swing(self, order):
        angle = motion(order, slope=20 * np.pi, slow=np.radians(2))
        found, start = angle_from_pulses(pulses_of(angle), LINES, RATE)
        time = time_of(found, start)
        inner = (time > 0.05) & (time < 1.95)
        np.testing.assert_allclose(found[inner], angle(time[inner]), atol=2e-3 * SMALL)

    def test_pulses_are_met_exactly(self):
        times = np.cumsum(np.random.default_rng(1).uniform(0.9, 1.1, 500))
        np.testing.assert_allclose(Rotation(times, np.arange(500), 8).at(times), np.arange(500), atol=1e-9)

    def test_few_pulses_and_few_a_turn(self):
        for count in (2, 3, 5, 9, 30):
            found, _ = angle_from_pulses(np.arange(count) / 8, 1, sampling_rate=16.0)
            np.testing.assert_allclose(found, 2 * np.pi * np.arange(2 * count - 1) / 2, atol=1e-9)

    def test_a_speed_that_jumps_is_refused(self):
        times = np.cumsum(np.where(np.arange(2000) % 2 == 0, 1.0, 3.0))
        with pytest.raises(SolveError, match="lost-pulses"):
            angle_from_pulses(times, LINES, 1.0, fill=False)


class TestRepairs:
    """A double pulse gave 3.57 turns of drift, without a word."""

    angle = staticmethod(motion(6))

    def found(self, times, message):
        with pytest.warns(TorsionnetWarning, match=message):
            found, start = angle_from_pulses(times, LINES, RATE)
        time = time_of(found, start)
        inner = (time > 0.05) & (time < 1.9)
        return np.abs(found[inner] - self.angle(time[inner])).max() / SMALL

    @pytest.mark.parametrize("after", [1e-6, 2e-4, 4e-4])  # of the 6.7e-4 s from pulse to pulse
    def test_double_pulses_are_left_out(self, after):
        times = pulses_of(self.angle)
        double = np.sort(np.concatenate([times, times[[500, 1700]] + after]))
        message = rf"2 pulses too many left out: pulse 50[01] at {times[500]:.3f}\d* s, pulse 170[12] at "
        assert self.found(double, message) < 1e-3 if after > 1e-5 else 0.02

    def test_a_burst(self):
        times = pulses_of(self.angle)
        bounces = np.sort(np.concatenate([times, times[800] + np.array([1e-5, 2e-5, 4e-5])]))
        assert self.found(bounces, "3 pulses too many left out: pulse 801 at 0.5333") < 1e-3

    def test_a_burst_in_a_record_of_few_pulses(self):
        """The usual interval is the median of all five that there are around it, not of three, two of them short."""
        assert repaired_pulses([0.0, 1.0, 2.0, 2.01, 2.02, 3.0, 4.0]).spurious.tolist() == [3, 4]

    def test_missing_pulses_are_counted(self):
        times = np.delete(pulses_of(self.angle), [100, 700, 701])
        message = r"3 pulses missing and counted: 1 after pulse 99 at 0.066\d* s, 2 after pulse 698 at 0.466"
        assert self.found(times, message) < 1e-3

    def test_both(self):
        times = pulses_of(self.angle)
        mixed = np.sort(np.append(np.delete(times, 100), times[300] + 1e-4))
        found = repaired_pulses(mixed)
        assert found.numbers[-1] == len(times) - 1
        assert len(found.remarks) == 2
        assert found.spurious.tolist() == [300]

    def test_nothing_is_said_of_good_pulses(self):
        for slope, slow in ((0, 0), (20 * np.pi, 0.05), (-5 * np.pi, 0.1)):
            found = repaired_pulses(pulses_of(motion(6, slope=slope, slow=slow)), LINES)
            assert found.remarks == ()
            assert found.period == 0

    def test_a_wheel_with_a_gap(self):
        every = pulses_of(self.angle)
        wheel = every[np.arange(len(every)) % 60 < 58]
        found = repaired_pulses(wheel, 60)
        assert (found.period, found.remarks, found.numbers[-1]) == (60, (), 2997)
        angle, start = angle_from_pulses(wheel, 60, RATE)
        time = time_of(angle, start)
        inner = (time > 0.05) & (time < 1.9)
        assert np.abs(angle - self.angle(time))[inner].max() < 2e-4 * SMALL
        lost = np.delete(wheel, 1000)
        assert repaired_pulses(lost, 60).remarks == (
            f"1 pulse missing and counted: 1 after pulse 999 at {lost[999]:.6g} s",
        )

    @pytest.mark.parametrize("after", [2e-4, 2.6e-4])  # of the 6.7e-4 s from pulse to pulse
    def test_both_flanks_of_each_tooth_are_no_double_pulses(self, after):
        times = pulses_of(self.angle)
        with pytest.raises(UsageError, match="lost-pulses"):
            repaired_pulses(np.sort(np.concatenate([times, times + after])), 120)

    def test_a_seventh_of_the_pulses_too_many_is_the_wheel(self):
        """Six teeth, and one between two of them, as a camshaft has it; 60 pulses were left out."""
        turns = np.add.outer(360 * np.arange(60), [0, 15, 60, 120, 180, 240, 300]).ravel() / 7200
        with pytest.raises(UsageError, match=r"(?s)60.*420.*unfit-wheel"):
            repaired_pulses(turns)

    def test_a_wheel_with_another_number_of_teeth(self):
        every = pulses_of(self.angle)
        with pytest.raises(
            UsageError,
            match=r"(?s)36.*36.*unfit-wheel",
        ):
            angle_from_pulses(every[np.arange(len(every)) % 36 < 35], 60, RATE)

    @pytest.mark.parametrize(
        ("times", "message"),
        [
            (lambda t: np.delete(t, slice(301, None, 2)), r"(?s)300.*0\.2.*lost-pulses"),
            (lambda t: np.concatenate([t[:500], t[500:] + 5e-4]), r"(?s)499.*lost-pulses"),
            (lambda t: np.concatenate([t[:500], 1.2 * (t[560:] - t[560]) + t[560]]), "lost-pulses"),
        ],
    )  # fmt: skip
    def test_what_cannot_be_repaired_is_refused_with_its_place(self, times, message):
        with pytest.raises(UsageError, match=message):
            angle_from_pulses(times(pulses_of(self.angle)), LINES, RATE)

    def test_left_as_they_are_if_wanted(self):
        even = np.arange(100) / 100
        found, _ = angle_from_pulses(even, 100, 100.0, fill=False)
        assert found[-1] == pytest.approx(99 * 2 * np.pi / 100)
        slower, _ = angle_from_pulses(np.delete(even, 50), 100, 100.0, fill=False)
        assert slower[51] == pytest.approx(50 * 2 * np.pi / 100)
        with pytest.raises(SolveError, match=r"(?s)2\.5.*lost-pulses"):
            angle_from_pulses(np.delete(np.arange(400) / 100, slice(240, 270)), 100, 100.0, fill=False)

    @pytest.mark.slow
    def test_no_good_record_is_touched_at_random(self):
        """Pitch errors of 3 %, swings and run-ups: the repair finds back what was done to them, and nothing else."""
        rng = np.random.default_rng(4)
        for _ in range(60):
            angle = motion(
                int(rng.integers(1, 12)), np.radians(0.3) * rng.random(), 40 * np.pi * rng.random(), 0.06 * rng.random()
            )
            times = pulses_of(angle, 1.0)
            times = times + 0.03 * 6.7e-4 * rng.uniform(-0.5, 0.5, len(times))
            assert repaired_pulses(times).remarks == ()
            far = np.sort(rng.choice(np.arange(20, len(times) - 20, 25), 8, replace=False))
            lost, doubled = far[::2], far[1::2]
            share = rng.uniform(0.01, 0.9, len(doubled))
            extra = times[doubled] + share * (times[doubled + 1] - times[doubled])
            found = repaired_pulses(np.sort(np.concatenate([np.delete(times, lost), extra])))
            assert found.numbers[-1] == len(times) - 1
            assert found.missing.total == 4
            apart = np.abs(found.left_out - extra) / 6.7e-4
            assert apart.max() < 0.2

    def test_check_tells_of_double_pulses(self):
        times = np.sort(np.append(np.arange(1000) / 100, 5.001))
        record = Recording((Signal("phi", "angle", np.arange(1001) * 0.01),), 100.0, times=times)
        (fault,) = (fault for fault in check_recording(record) if fault.kind == "lost-pulses")
        assert fault.path == ("time",)
        assert "5.001 s" in fault.message

    def test_missing_pulses_alone(self):
        assert missing_pulses(np.delete(np.arange(20.0), [7, 8])).counts.tolist() == [2]
        with pytest.raises(UsageError, match="unordered-rows"):
            missing_pulses(np.insert(np.arange(20.0), 7, 7.0))  # one pulse that stands twice


class TestTrain:
    def train(self, shape, rate=50_000.0):
        time = np.arange(int(2 * rate)) / rate
        return time, shape((motion(6)(time) / STEP) % 1)

    def test_edges_of_a_voltage(self):
        time, volts = self.train(lambda phase: 2.5 - 2 * np.cos(2 * np.pi * phase))
        noisy = volts + 0.05 * np.random.default_rng(2).normal(size=len(volts))
        exact = pulses_of(lambda t: motion(6)(t) + STEP * 3 / 4)  # a quarter of a step after the whole one
        found = pulse_times(volts, time)
        np.testing.assert_allclose(found[:1000], exact[1:1001], atol=2e-8)
        assert len(pulse_times(noisy, time)) == len(found)

    @pytest.mark.parametrize(
        ("values", "message"),
        [
            (np.ones(1000), "there are no pulses"),
            (np.arange(1000.0) % 2, "beyond-sampling"),
        ],
    )
    def test_refused(self, values, message):
        with pytest.raises(UsageError, match=message):
            pulse_times(values, np.arange(1000) / 1000)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Records of a torque of order 6 with the angle as pulses: sampled, as times, and in a text file."""
    monkeypatch.chdir(tmp_path)
    rate, angle = 20_000.0, motion(6)
    time = np.arange(int(6 * rate)) / rate
    torque = Signal("T", "torque", 100 * np.sin(6 * SPEED * time))
    volts = Signal("n1", "", 2.5 - 2.5 * np.cos(2 * np.pi * angle(time) / STEP))
    write_recording(Recording((torque, volts), rate), "train.npz")
    np.savez("stamps.npz", fs=rate, T=torque.values, n1=pulses_of(angle, 6))
    np.savez("double.npz", fs=rate, T=torque.values, n1=np.sort(np.append(pulses_of(angle, 6), 3.00012)))
    return tmp_path


class TestFiles:
    @pytest.mark.slow
    @pytest.mark.parametrize("file", ["train.npz", "stamps.npz"])
    def test_a_channel_of_pulses_is_read_as_an_angle(self, folder, file):
        record = read_recording(folder / file, pulses={"n1": 60}, quantities={"T": "torque"})
        assert record.names == ("T", "n1")
        assert record["n1"].quantity == "angle"
        inner = (record.time > 0.2) & (record.time < 5.8)
        swing = record["n1"].values - SPEED * record.time
        columns = np.column_stack(
            [np.sin(6 * SPEED * record.time), np.cos(6 * SPEED * record.time), np.ones(len(record))]
        )
        parts = np.linalg.lstsq(columns[inner], swing[inner])[0]
        assert np.hypot(*parts[:2]) / SMALL == pytest.approx(1, abs=1e-3 if file == "train.npz" else 1e-5)
        assert parts[0] / SMALL == pytest.approx(1, abs=1e-3)  # in phase with the torque: times are those of the file
        assert any(note.startswith("cut to where there are pulses: from ") for note in map(str, record.notes))

    @pytest.mark.slow
    def test_stamps_alone(self, folder):
        angle = motion(6)
        np.savez("alone.npz", n1=pulses_of(angle))
        record = read_recording("alone.npz", pulses={"n1": 60}, units={"n1": "s"})
        assert folder.exists()
        assert record.sampling_rate > 1500
        inner = slice(100, -100)
        np.testing.assert_allclose(record["n1"].values[inner], angle(record.time)[inner], atol=1e-3 * SMALL)

    def test_text_and_a_unit_of_time(self, folder):
        lines = "\n".join(f"{1e3 * time:.9f}" for time in pulses_of(motion(6), 1.0))
        (folder / "stamps.csv").write_text(f"pulses [ms]\n{lines}\n")
        record = read_recording("stamps.csv", pulses={"pulses": 60})
        assert record["pulses"].values[-1] == pytest.approx(SPEED, rel=2e-3)

    @pytest.mark.slow
    def test_a_double_pulse_is_told(self, folder):
        record = read_recording(folder / "double.npz", pulses={"n1": 60}, quantities={"T": "torque"})
        assert any(
            n.startswith("warning: n1: 1 pulse too many left out: pulse 4501 at 3.0") for n in map(str, record.notes)
        )

    @pytest.mark.parametrize(
        ("pulses", "message"),
        [
            ({"n2": 60}, r"channels: .*unknown-channel"),
            ({"n1": 0}, r"channels\.n1: .*out-of-range"),
            ({"T": 60, "n1": 60}, "T: "),
        ],
    )
    def test_faults(self, folder, pulses, message):
        if "T" in pulses:
            np.savez("train.npz", fs=1e4, T=np.zeros(1000), n1=np.arange(1000) / 1e4)
        with pytest.raises(ModelError, match=message):
            read_recording(folder / "train.npz", pulses=pulses, quantities={"T": "torque"})

    @pytest.mark.slow
    def test_the_commands_take_them(self, folder):
        arguments = ("--input", "T", "--output", "n1", "--detrend", "linear", "--seconds", "1", "--json")
        given = ("estimate", "stamps.npz", "--pulses", "n1=60", "--quantity", "T=torque", *arguments)
        data = json.loads(run(*given).stdout)
        at = data["frequencies_Hz"].index(150.0)
        first = data["responses"][0]
        assert np.hypot(first["real"][at], first["imag"][at]) * 100 / SMALL == pytest.approx(1, abs=1e-3)
        told = run("estimate", "double.npz", *given[2:]).stderr
        assert "warning: n1: 1 pulse too many left out: pulse 4501 at 3.0" in told
        assert "n1: " in run("estimate", "train.npz", "--pulses", "n1=x", *arguments, code=2).stderr
        assert folder.exists()

    @pytest.mark.slow
    def test_fit_files_take_them(self, folder):
        (folder / "rig.yaml").write_text(TWO_DISCS)
        fit = """\
torsionnet: 1
model: rig.yaml
parameters: {k: 300}
measurements:
  soft: {record: train.npz, output: n1, input: T, pulses: {n1: 60}, band: [1 Hz, 25 Hz]}
"""
        (folder / "fit.yaml").write_text(fit)
        (one,) = load_fit_plan("fit.yaml", lambda path: path).measurements
        assert one.data["n1"].unit == "rad"
        (folder / "fit.yaml").write_text(fit.replace("{n1: 60}", "60"))
        with pytest.raises(ModelError, match=r":5:59: .*wrong-form"):
            load_fit_plan("fit.yaml", lambda path: path)
