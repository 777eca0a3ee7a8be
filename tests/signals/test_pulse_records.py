"""Channels of pulses in files, counts of a clock that wrap, and what cannot be read of them."""

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from support.foreign_files import EXTRAS

from torsionnet.base.errors import ModelError, UsageError
from torsionnet.signals import Recording, Signal, iter_blocks, read_recording, write_recording
from torsionnet.signals.rotation.counter import PulseReading, lowest_speed, pulse_channel
from torsionnet.signals.rotation.pulse_channel import PulseChannel

RPM = np.pi / 30
TORQUE = {"T": "torque"}


def recording():
    """Two signals of 1 s, a wheel of 333 pulses, one without pulses and one with a single pulse."""
    chance = np.random.default_rng(1)
    times = np.sort(chance.uniform(0.4, 1.6, 333))
    trains = (
        PulseChannel("n 1", times, 1e-6, ("ticks",)),
        PulseChannel("none", np.empty(0)),
        PulseChannel("once", np.array([1.0])),
    )
    signals = (Signal("T", "torque", chance.normal(size=1000)), Signal("phi", "angle", 0.1 * np.arange(1000)))
    return Recording(signals, 1000.0, 0.5, title="run-up", notes=("cold",), pulses=trains)


def assert_same_pulses(found, expected):
    assert [channel.name for channel in found] == [channel.name for channel in expected]
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_array_equal(one.times, other.times)
        assert (one.tick, one.notes) == (other.tick, other.notes)


@pytest.mark.parametrize("ending", [".npz", ".mat", ".h5", ".tdms", ".mf4"])
class TestFiles:
    @pytest.fixture
    def file(self, tmp_path, ending):
        pytest.importorskip({**EXTRAS, ".mf4": "asammdf"}[ending])
        path = tmp_path / f"run{ending}"
        write_recording(recording(), path)
        return path

    def test_keep_pulses_of_any_length(self, file):
        found = read_recording(file)
        assert (found.names, found.notes, found.start) == (("T", "phi"), ("cold",), 0.5)
        assert_same_pulses(found.pulses, recording().pulses)

    def test_names_choose_pulses_as_they_choose_signals(self, file):
        assert [one.name for one in read_recording(file, names=["T", "once"]).pulses] == ["once"]
        renamed = read_recording(file, names={"n 1": "wheel", "T": "M"})
        assert (renamed.names, renamed.pulses[0].name) == (("M",), "wheel")
        assert read_recording(file, names=["phi"]).pulses == ()
        alone = read_recording(file, names=["n 1"])
        assert (len(alone), len(alone.pulses_of("n 1")), alone.sampling_rate) == (0, 333, 1000.0)

    def test_blocks_have_the_pulses_of_their_time(self, file):
        blocks = list(iter_blocks(file, 0.3))
        assert [len(block) for block in blocks] == [300, 300, 300, 100]
        for before, block in pairwise(blocks):
            assert before.pulses_of("n 1").times[-1] < block.start <= block.pulses_of("n 1").times[0]
        every = np.concatenate([block.pulses_of("n 1").times for block in blocks])
        np.testing.assert_array_equal(every, recording().pulses_of("n 1").times)

    def test_pulses_without_signals(self, tmp_path, ending):
        pytest.importorskip({**EXTRAS, ".mf4": "asammdf"}[ending])
        path = tmp_path / f"wheels{ending}"
        write_recording(replace(recording(), signals=()), path)
        assert_same_pulses(read_recording(path).pulses, recording().pulses)
        assert len(list(iter_blocks(path, 0.3))) == 1


@pytest.mark.parametrize("ending", [".csv", ".uff", ".parquet"])
def test_files_of_columns_of_one_length_refuse_pulses(tmp_path, ending):
    with pytest.raises(UsageError, match="no-counterpart"):
        write_recording(recording(), tmp_path / f"run{ending}")
    assert not list(tmp_path.iterdir())


def test_a_record_without_pulses_has_the_bytes_of_before(tmp_path):
    path = tmp_path / "run.npz"
    write_recording(replace(recording(), pulses=()), path)
    assert b'"pulses"' not in path.read_bytes()


def test_damaged_pulses_are_named(tmp_path):
    path = tmp_path / "run.npz"
    write_recording(recording(), path)
    content = dict(np.load(path))
    content["n 1"][7] = content["n 1"][3]
    np.savez(path, **content)
    with pytest.raises(ModelError, match=r"channels\.n 1: .*unordered-rows"):
        read_recording(path)


def test_one_name_twice_is_refused(tmp_path):
    twice = replace(recording(), pulses=(PulseChannel("T", np.array([1.0])),))
    with pytest.raises(UsageError, match="repeated-name"):
        write_recording(twice, tmp_path / "run.npz")


def test_selection_and_words():
    record = recording()
    assert record.select(["once", "T"]).pulses[0].name == "once"
    assert record.select(["T"]).pulses == ()
    assert "n 1 of 333 pulses" in repr(record)
    assert any(note.startswith("n 1: 333 pulses from 0.4") for note in map(str, record.table().notes))
    longer = record.with_pulses(PulseChannel("once", np.array([1.0, 2.0])), PulseChannel("new", np.array([0.0])))
    assert [len(one) for one in longer.pulses] == [333, 0, 2, 1]


def wrapped(times, clock, bits):
    """Counts that a free-running counter shows at these times, by whole-number arithmetic."""
    return [int(time * clock) % 2**bits for time in times]


class TestCounts:
    @pytest.mark.parametrize(("clock", "bits"), [(1e6, 16), (80e6, 24), (80e6, 32), (20e6, None)])
    def test_wraps_are_unwrapped_and_counted(self, clock, bits):
        """60 teeth at 1500 rpm over 60 s: 90 001 pulses, of which a 16-bit counter at 1 MHz sees 916 wraps."""
        times = 0.01 + np.arange(90_001) / 1500
        found = pulse_channel("n1", wrapped(times, clock, bits or 62), PulseReading(clock=f"{clock!r} Hz", bits=bits))
        assert found.tick == pytest.approx(1 / clock)
        whole = int(0.01 * clock) // 2 ** (bits or 62) * 2 ** (bits or 62) / clock
        assert np.abs(found.times + whole - times).max() <= 1.001 / clock
        if bits:
            wraps = int(times[-1] * clock) // 2**bits - int(times[0] * clock) // 2**bits
            assert f"unwrapped: {wraps} wrap{'s' * (wraps != 1)} of {bits} bits" in found.notes

    def test_tick_and_clock_are_the_same(self):
        assert PulseReading(tick="12.5 ns").seconds == PulseReading(clock="80 MHz").seconds == 12.5e-9

    def test_counts_with_a_sign(self):
        counts = np.array(wrapped(np.arange(500) / 1500, 1e6, 16)).astype(np.uint16).view(np.int16)
        found = pulse_channel("n1", counts, PulseReading(tick="1 us", bits=16))
        assert np.abs(np.diff(found.times) - 1 / 1500).max() < 1.1e-6
        assert found.notes[1].startswith("counts from -")

    def test_the_speed_below_which_wraps_are_lost_is_said(self):
        """A 16-bit counter at 80 MHz is full after 0.8192 ms, in which 60 teeth turn at 1220.7 rpm."""
        reading = PulseReading(clock="80 MHz", bits=16)
        assert lowest_speed(reading, 60) / RPM == pytest.approx(1220.703125)
        found = pulse_channel("n1", wrapped(np.arange(600) / 1500, 80e6, 16), reading)
        assert str(found.notes[-1]).startswith("warning: pulses more than 0.0008192 s apart")
        assert "below 1221 pulses a second" in found.notes[-1]
        assert lowest_speed(PulseReading(clock="80 MHz"), 60) == 0

    def test_a_shaft_that_falls_below_it_is_refused(self):
        """From 1500 to 900 rpm: the interval passes the time of a wrap near pulse 2000."""
        speed = np.linspace(1500, 900, 4000)
        times = np.cumsum(1 / speed)
        with pytest.raises(UsageError, match="wrapped-count"):
            pulse_channel("n1", wrapped(times, 80e6, 16), PulseReading(clock="80 MHz", bits=16))
        with pytest.raises(UsageError, match=r"has wrapped more often"):
            pulse_channel("n1", wrapped(times[-1] - times[::-1], 80e6, 16), PulseReading(clock="80 MHz", bits=16))

    def test_a_double_pulse_near_a_wrap_is_no_lost_wrap(self):
        times = np.sort(np.append(np.arange(600) / 1400, 100 / 1400 + 2e-6))
        found = pulse_channel("n1", wrapped(times, 80e6, 16), PulseReading(clock="80 MHz", bits=16))
        assert np.abs(np.diff(found.times) - np.diff(times)).max() < 3e-8

    def test_equal_counts_are_left_out_and_counted(self):
        found = pulse_channel("n1", [1, 5, 5, 9], PulseReading(tick="1 ms"))
        assert found.times.round(9).tolist() == [0.001, 0.005, 0.009]
        assert str(found.notes[-1]) == "warning: 1 pulse at the count of the one before left out: pulse 2"
        full = pulse_channel("n1", [65534, 65534, 0, 0, 2], PulseReading(tick="1 ms", bits=16))
        assert np.diff(full.times).round(9).tolist() == [0.002, 0.002]
        assert full.notes[1] == "unwrapped: 1 wrap of 16 bits"

    @pytest.mark.parametrize(
        ("values", "reading", "message"),
        [
            ([1, 2.5], {"tick": 1e-6}, r"(?s)2\.5.*wrong-form"),
            ([65000, 200], {"tick": 1e-6}, r"(?s)65000.*200.*wrapped-count"),
            ([1, 70000], {"tick": 1e-6, "bits": 16}, r"(?s)65535.*70000.*contradicting-values"),
            ([1, 2**60], {"tick": 1e-6}, r"counts above 2\^53"),
            ([1, 3, 2], {}, "unordered-rows"),
            ([1, np.nan, 2], {}, "not-a-number"),
            ([np.nan], {}, "lost-pulses"),
        ],
    )
    def test_refused_with_what_would_help(self, values, reading, message):
        with pytest.raises(UsageError, match=message):
            pulse_channel("n1", values, PulseReading(**reading))

    def test_contradictions(self):
        with pytest.raises(ModelError, match=r"clock: .*contradicting-entries"):
            PulseReading(tick="1 us", clock="1 MHz")
        with pytest.raises(ModelError, match=r"bits: .*missing-entry"):
            PulseReading(bits=16)


class TestReadingFiles:
    @pytest.fixture
    def ticks(self, tmp_path):
        """Torque at 1 kHz beside the counts of two wheels, which have other lengths."""
        path = tmp_path / "run.npz"
        first, second = np.arange(3000) / 1500, 0.1 + np.arange(170) / 100
        counts = {"n1": wrapped(first, 80e6, 32), "n2": 1e6 * second}
        np.savez(path, T=np.sin(np.arange(2000)), fs=1000.0, **counts)
        return path

    def test_counts_and_times_beside_a_signal(self, ticks):
        readings = {"n1": PulseReading(clock="80 MHz", bits=32), "n2": PulseReading()}
        record = read_recording(ticks, pulse_readings=readings, units={"n2": "us"})
        assert (record.names, len(record), record.sampling_rate) == (("T",), 2000, 1000.0)
        np.testing.assert_allclose(record.pulses_of("n1").times, np.arange(3000) / 1500, atol=1.3e-8)
        np.testing.assert_allclose(record.pulses_of("n2").times, 0.1 + np.arange(170) / 100, rtol=1e-12)
        assert record.pulses_of("n2").notes[-1] == "converted from us"

    def test_angle_of_counts(self, ticks):
        readings = {"n1": PulseReading(clock="80 MHz", bits=32)}
        record = read_recording(ticks, names=["T", "n1"], pulse_readings=readings, pulses={"n1": 60}, quantities=TORQUE)
        assert record.names == ("T", "n1")
        slope = np.polyfit(record.time, record["n1"].values, 1)[0]
        assert slope == pytest.approx(1500 * RPM, rel=1e-9)

    def test_a_column_with_a_unit_of_time_is_not_the_clock(self, tmp_path):
        path = tmp_path / "run.csv"
        rows = "".join(f"{100 * n + 7},{n / 10},{n}\n" for n in range(20))
        path.write_text(f"n1 [us],time [s],T [N*m]\n{rows}")
        record = read_recording(path, pulse_readings={"n1": PulseReading()})
        assert (record.names, record.sampling_rate) == (("T",), 10.0)
        np.testing.assert_allclose(record.pulses_of("n1").times, (100 * np.arange(20) + 7) * 1e-6)
        assert not any("n1" in note for note in record.notes)

    def test_blocks(self, ticks):
        readings = {"n1": PulseReading(clock="80 MHz", bits=32)}
        blocks = list(iter_blocks(ticks, 0.5, names=["T", "n1"], pulse_readings=readings, quantities=TORQUE))
        assert [len(block.pulses_of("n1")) for block in blocks] == [750, 750, 750, 750]

    def test_all_faults_at_once(self, ticks):
        readings = {"n3": PulseReading(), "n2": PulseReading(), "n1": PulseReading()}
        with pytest.raises(ModelError) as caught:
            read_recording(ticks, pulse_readings=readings, units={"n2": "rpm", "n1": "kg"})
        text = str(caught.value)
        assert '"n3"' in text
        assert re.search(r'"rpm" .*\[wrong-unit\]', text)
        assert re.search(r'"kg" .*\[wrong-unit\]', text)
