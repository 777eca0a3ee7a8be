"""Channels of several sampling rates in one file: named, one rate chosen, others brought to it when asked."""

import re

import numpy as np
import pytest
from click.testing import CliRunner

from torsionnet.app.cli.app import app
from torsionnet.base.errors import ModelError
from torsionnet.signals import PulseReading, iter_blocks, read_recording
from torsionnet.signals.resampling import interpolated_at, spline_error

SLOW, FAST = 100.0, 1000.0


def swing(times):
    """Three tones and a mean, all below 0.8 times half the slow rate."""
    return 5.0 + np.sin(2 * np.pi * 3 * times) + 0.5 * np.cos(2 * np.pi * 17 * times) + 0.1 * np.sin(200 * times)


@pytest.fixture
def file(tmp_path):
    """Torque at 1 kHz, the same torque at 100 Hz and 0.5037 s later, and counts of a wheel."""
    nptdms = pytest.importorskip("nptdms")
    path = tmp_path / "run.tdms"
    quick, slow = np.arange(8000) / FAST, 0.5037 + np.arange(700) / SLOW
    with nptdms.TdmsWriter(str(path)) as writer:
        writer.write_segment(
            [
                nptdms.ChannelObject("fast", "M", swing(quick), {"wf_increment": 1 / FAST, "unit_string": "N*m"}),
                nptdms.ChannelObject(
                    "slow",
                    "M",
                    swing(slow),
                    {"wf_increment": 1 / SLOW, "wf_start_offset": 0.5037, "unit_string": "N*m"},
                ),
                nptdms.ChannelObject("wheel", "n1", np.arange(900, dtype=np.uint32) * 100),
            ]
        )
    return path


NAMES = ["fast/M", "slow/M"]
READING = {"wheel/n1": PulseReading(tick="1 us")}


def test_the_rates_are_named(file):
    with pytest.raises(ModelError, match=r"(?s)100.*0\.5037.*unlike-results"):
        read_recording(file, names=NAMES)
    with pytest.raises(ModelError, match=r"(?s)300.*unlike-results"):
        read_recording(file, names=NAMES, sampling_rate=300)


def test_one_rate_is_read_and_the_others_are_left_out_with_a_note(file):
    found = read_recording(file, pulse_readings=READING, sampling_rate=100)
    assert (found.names, found.sampling_rate, found.start, len(found)) == (("slow/M",), 100.0, 0.5037, 700)
    assert "left out, as sampled at other rates than 100 Hz: fast/M (1000 Hz from 0 s)" in " ".join(found.notes)
    assert len(found.pulses_of("wheel/n1")) == 900


def test_a_channel_named_is_never_left_out(file):
    with pytest.raises(ModelError, match=r"(?s)1000.*100.*unlike-results"):
        read_recording(file, names=NAMES, sampling_rate=100)


@pytest.mark.parametrize(("rate", "start"), [(FAST, 0.504), (SLOW, 0.5037)])
def test_resampled_when_asked(file, rate, start):
    """Both channels recorded the same torque: closed form within 0.1 % of its amplitude, to either rate."""
    found = read_recording(file, names=NAMES, sampling_rate=rate, resample=True)
    assert found.start == pytest.approx(start)
    inner = slice(int(rate / 2), -int(rate / 2))
    for name in NAMES:
        assert np.abs(found[name].values - swing(found.time))[inner].max() < 1e-3
    assert sum("band-limited: holds up to 40 Hz" in " ".join(signal.notes) for signal in found) == 1
    assert found.names == ("fast/M", "slow/M")
    assert any(note.startswith("1 channel of another rate or start interpolated at") for note in found.notes)
    cut = [note for note in found.notes if note.startswith("cut to where all channels were recorded")]
    assert len(cut) == (rate == FAST)


def test_names_of_one_rate(file):
    assert read_recording(file, names=["slow/M"]).sampling_rate == SLOW
    assert len(list(iter_blocks(file, 1.0, names=["slow/M"]))) == 7


def test_what_the_lower_rate_cannot_hold_is_not_folded():
    """170 Hz sampled at 1 kHz would appear at 30 Hz of 100 Hz."""
    times = np.arange(5000) / FAST
    new = 1.0 + np.arange(300) / SLOW
    assert np.abs(interpolated_at(np.sin(2 * np.pi * 170 * times), FAST, 0.0, new, SLOW)).max() < 2e-4


def test_channels_of_one_rate_that_begin_at_different_times(tmp_path):
    """A start 0.1 ms late is 5.4 degrees of order 6 at 1500 rpm, which is 150 Hz."""
    nptdms = pytest.importorskip("nptdms")
    path, late = tmp_path / "run.tdms", 1e-4
    times = np.arange(4000) / FAST
    with nptdms.TdmsWriter(str(path)) as writer:
        writer.write_segment(
            [
                nptdms.ChannelObject(
                    "g",
                    name,
                    np.cos(2 * np.pi * 150 * (times + start)),
                    {"wf_increment": 1e-3, "wf_start_offset": start, "unit_string": "N*m"},
                )
                for name, start in (("a", 0.0), ("b", late))
            ]
        )

    def phase(record, name):
        middle = slice(500, 3500)
        turning = np.exp(-2j * np.pi * 150 * record.time[middle])
        return np.degrees(np.angle(np.mean(turning * record[name].values[middle])))

    with pytest.raises(ModelError, match=r"(?s)1000.*1000.*unlike-results"):
        read_recording(path)
    found = read_recording(path, resample=True)
    assert phase(found, "b") - phase(found, "a") == pytest.approx(0.0, abs=0.01)


def test_values_that_are_not_finite_are_not_interpolated(tmp_path):
    nptdms = pytest.importorskip("nptdms")
    path = tmp_path / "run.tdms"
    with nptdms.TdmsWriter(str(path)) as writer:
        writer.write_segment(
            [
                nptdms.ChannelObject("g", "a", np.ones(100), {"wf_increment": 0.01, "unit_string": "N*m"}),
                nptdms.ChannelObject("g", "b", np.full(10, np.nan), {"wf_increment": 0.1, "unit_string": "N*m"}),
            ]
        )
    with pytest.raises(ModelError, match=r"channels\.b: .*10.*not-finite"):
        read_recording(path, sampling_rate=100, resample=True)


@pytest.mark.parametrize(("share", "jittered"), [(0.05, 1.5), (0.1, 1.5), (0.3, 1.2)])
def test_the_error_of_splines_is_that_of_a_known_tone(share, jittered):
    """Against the tone itself between the samples, even ones and such with a jitter of 10 %."""
    from scipy.interpolate import CubicSpline

    random = np.random.default_rng(1)
    times, between = np.arange(1000.0), random.uniform(50, 950, 50_000)

    def tone(time):
        return np.sin(2 * np.pi * share * time + 0.3)

    said = spline_error(tone(times))
    for stamps, most in ((times, 1.02), (times + random.uniform(-0.1, 0.1, 1000), jittered)):
        missed = CubicSpline(stamps, tone(stamps))(between) - tone(between)
        assert 0.98 < np.sqrt(2 * np.mean(missed**2)) / said < most


def test_on_the_command_line_the_error_is_printed(file):
    arguments = ["estimate", str(file), "--input", "fast/M", "--output", "slow/M", "--sampling-rate", "1000"]
    shown = CliRunner().invoke(app, arguments)
    assert (shown.exit_code, shown.stdout) == (1, "")
    assert re.search(r"slow/M .*0\.5037 s\) .*--resample", shown.stderr)
    assert "--resample" in CliRunner().invoke(app, arguments[:-2]).stderr
    shown = CliRunner().invoke(app, [*arguments[:-2], "--resample"])
    assert shown.exit_code == 0
    assert (
        "note: slow/M: interpolated from 100 to 1000 Hz, band-limited: holds up to 40 Hz with an error" in shown.stderr
    )
