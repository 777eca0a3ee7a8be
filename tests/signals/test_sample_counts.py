"""Nothing is made of a number in the data before it is checked: neither samples, nor windows, nor filters."""

import tracemalloc

import numpy as np
import pytest
from click.testing import CliRunner

from torsionnet.app.cli.app import app
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.signals.encoder import angle_from_pulses
from torsionnet.signals.estimators import estimate
from torsionnet.signals.pulses import repaired_pulses
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.records.recording_files import read_recording
from torsionnet.signals.resampling import (
    ALWAYS_ALLOWED_COUNT,
    MOST_MULTIPLE,
    check_count,
    decimate,
    even_times,
    resampled,
)
from torsionnet.signals.spectra import spectrogram
from torsionnet.signals.uncertainty import resolution
from torsionnet.signals.welch import Welch

CLOCK = 80e6
TICKS = np.round(np.arange(6001) * CLOCK / 1500)
"""Of a counter, at 1500 pulses a second."""
GAP = np.concatenate([np.arange(20.0), 1e12 + np.arange(20.0)])
BLOCKS = np.concatenate([1e10 * block + np.arange(20.0) for block in range(6)])
SLOW = Recording((Signal("phi", "angle", np.arange(4.0)),), 1e-13, times=np.array([0, 1e13, 2e13, 3.1e13]))
NOISE = np.random.default_rng(1).normal(size=(2, 20_000))


def fast(rate):
    return Recording((Signal("T", "torque", NOISE[0]), Signal("phi", "angle", NOISE[1])), rate)


CASES = {
    "ticks as s": (lambda: angle_from_pulses(TICKS, 60, 10e3), r"(?s)6001.*too-large"),
    "a gap of ages": (
        lambda: angle_from_pulses(GAP, 60, 1e-9),
        "too-large",
    ),
    "gaps of ages": (lambda: repaired_pulses(BLOCKS, 60), r"(?s)10000000000.*unfit-wheel"),
    "slow stamps": (lambda: resampled(SLOW, 1000.0), r"(?s)13.*too-large"),
    "overlap": (lambda: spectrogram(fast(1e3), "T", Welch(seconds=10.0, overlap=0.99999)), "take less overlap"),
    "a filter": (lambda: decimate(fast(1e3), 10**10), r"(?s)20000.*too-short"),
    "windows": (lambda: estimate(fast(1e12), "phi", "T"), "too-short"),
    "windows without end": (lambda: estimate(fast(1e15), "phi", "T", Welch(seconds=1e6)), "too-short"),
}


@pytest.mark.parametrize("case", CASES)
def test_refused_before_memory_is_taken(case):
    call, message = CASES[case]
    tracemalloc.start()
    try:
        with pytest.raises(UsageError, match=message):
            call()
        assert tracemalloc.get_traced_memory()[1] < 50e6
    finally:
        tracemalloc.stop()


def test_what_is_legitimate_is_made():
    """A run-up from 60 to 6000 rpm, whose first interval is 100 times its last, and a spline between few samples."""
    times = np.cumsum(np.geomspace(1.0, 0.01, 3000))
    angle, start = angle_from_pulses(times, 60, 100.0)
    assert (len(angle), start) == (int((times[-1] - 1) * 100) + 1, 1.0)
    check_count(ALWAYS_ALLOWED_COUNT, 4, "anything", "")
    check_count(MOST_MULTIPLE * ALWAYS_ALLOWED_COUNT, ALWAYS_ALLOWED_COUNT, "anything", "")
    assert len(resampled(Recording(SLOW.signals, 1.0, times=SLOW.times / 1e13), 1000.0)) == 3101


def test_times_end_where_a_rounding_error_would_lose_the_last():
    assert even_times(0.0, 0.3, 10.0, 4, "samples").tolist() == pytest.approx([0.0, 0.1, 0.2, 0.3])


@pytest.mark.parametrize("rate", [1e300, np.inf, np.nan, -5.0])
def test_a_rate_that_nothing_has_is_a_fault_of_the_file(tmp_path, rate):
    np.savez(tmp_path / "r.npz", fs=rate, T=NOISE[0])
    with pytest.raises(ModelError, match="implausible-size"):
        read_recording(tmp_path / "r.npz", {"T": "torque"})
    assert read_recording(tmp_path / "r.npz", {"T": "torque"}, sampling_rate=10.0).sampling_rate == 10.0


def test_a_window_longer_than_any_record_is_none():
    assert resolution(fast(1e15), "phi", "T", 1e6) is None


class TestFiles:
    def test_ticks(self, tmp_path):
        np.savez(tmp_path / "ticks.npz", n1=TICKS)
        with pytest.raises(ModelError, match=r"channels\.n1: .*6001.*too-large"):
            read_recording(tmp_path / "ticks.npz", pulses={"n1": 60}, units={"n1": "s"})

    def test_few_ticks_are_doubted(self, tmp_path):
        """Which fit into memory: an eighth of a turn in five days."""
        np.savez(tmp_path / "ticks.npz", n1=TICKS[:9])
        with pytest.raises(ModelError, match=r"channels\.n1: .*missing-unit"):
            read_recording(tmp_path / "ticks.npz", pulses={"n1": 60})
        in_us = tmp_path / "us.npz"
        np.savez(in_us, n1=TICKS[:9] / 80)
        assert read_recording(in_us, pulses={"n1": 60}, units={"n1": "us"}).notes == ()

    @pytest.mark.parametrize("command", [("estimate", "--output", "w", "--input", "T"), ("spectrogram",)])
    def test_ticks_for_seconds_leave_no_segment(self, tmp_path, command):
        """Of an 80 MHz clock, at 1 kHz: as seconds they are samples a day apart, which ended in a division by zero."""
        path = tmp_path / "ticks.csv"
        rows = [f"{80_000 * place},{np.sin(place / 9):.5f},{np.cos(place / 9):.5f}" for place in range(500)]
        path.write_text("\n".join(["t [s],T [N*m],w [rad/s]", *rows, ""]), encoding="utf-8")
        found = CliRunner().invoke(app, [command[0], str(path), *command[1:]])
        assert found.exit_code == 2
        assert "a segment of 2 s has less than two samples at 1.25e-05 Hz; take longer ones, or say" in found.output

    def test_pulses_of_two_shafts_at_other_times(self, tmp_path):
        np.savez(tmp_path / "two.npz", n1=np.arange(100) / 1500, n2=9 + np.arange(90) / 1500)
        with pytest.raises(ModelError, match=r"channels\.n1: .*0\.066.*unlike-results"):
            read_recording(tmp_path / "two.npz", pulses={"n1": 60, "n2": 60})
