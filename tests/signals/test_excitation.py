"""Excitation signals against what defines them."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.signals.excitation import BurstRandom, LinearChirp, LoadCycles, LogarithmicSweep, Multisine, SteppedSine

RATE = 2000.0


def measured_frequency(x, rate):
    """Instantaneous frequency between upward zero crossings, (time, Hz)."""
    up = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))
    crossing = (up - x[up] / (x[up + 1] - x[up])) / rate
    return (crossing[1:] + crossing[:-1]) / 2, 1 / np.diff(crossing)


@pytest.mark.parametrize(
    "sweep",
    [
        LinearChirp(start=0.5, stop=80, duration=60),
        LinearChirp(start=80, stop=5, duration=60),
        LogarithmicSweep(start=0.5, stop=80, duration=60),
        LogarithmicSweep(start=40, stop=2, duration=60),
    ],
)
def test_sweeps_have_the_frequency_they_say(sweep):
    time, f = measured_frequency(sweep.samples(RATE), RATE)
    assert f == pytest.approx(sweep.frequency(time), rel=0.03)
    ends = sweep.frequency(np.array([0.0, 60.0]))
    assert ends == pytest.approx([sweep.start, sweep.stop])


def test_linear_chirp_counts_its_cycles():
    """The mean frequency times the duration: twice as many would be the printed equation (1) of the source paper."""
    x = LinearChirp(start=0.1, stop=80, duration=100).samples(10e3)
    assert len(measured_frequency(x, 10e3)[1]) == pytest.approx(40.05 * 100, abs=2)


def test_amplitude_and_mean():
    x = LinearChirp(start=1, stop=20, duration=20, amplitude=15, mean=-4).samples(RATE)
    assert (x.max(), x.min()) == pytest.approx((11, -19), rel=1e-3)


def test_steps_hold_whole_periods_without_jumps():
    steps = SteppedSine(frequencies=(3.0, 7.0, 11.0), hold=0.9)
    x = steps.samples(RATE)
    assert steps.length == pytest.approx(3 / 3 + 7 / 7 + 10 / 11)
    assert np.abs(np.diff(x)).max() <= 2 * np.pi * 11 / RATE * 1.001
    for start, f in zip(steps.starts, steps.frequencies, strict=True):
        t = start + np.arange(20) / RATE
        part = x[round(start * RATE) : round(start * RATE) + 20]
        assert part == pytest.approx(np.sin(2 * np.pi * f * (np.round(t * RATE) / RATE - start)), abs=1e-9)


def test_multisine_is_flat_and_has_a_low_peak():
    signal = Multisine(start=0.5, stop=40, period=8, periods=3, amplitude=10)
    x = signal.samples(RATE)
    spectrum = np.abs(np.fft.rfft(x[: len(x) // 3])) / (len(x) // 6)
    excited = np.round(signal.lines * 8).astype(int)
    assert np.ptp(spectrum[excited]) <= 1e-9
    assert np.delete(spectrum, excited).max() <= 1e-9
    assert np.abs(x).max() == pytest.approx(10, rel=0.01)
    assert np.abs(x).max() / x.std() < 1.55
    assert x[: len(x) // 3] == pytest.approx(x[-(len(x) // 3) :])


def test_burst_is_in_its_band_silent_and_repeatable():
    signal = BurstRandom(start=5, stop=40, period=4, periods=5, share=0.75, amplitude=3, seed=1)
    x = signal.samples(RATE).reshape(5, -1)
    assert np.all(x[:, 6000:] == 0)
    assert np.all(np.abs(x[:, :6000]).max(axis=1) > 1)
    assert np.abs(x).max() == pytest.approx(3)
    assert not np.allclose(x[0], x[1])
    power = (np.abs(np.fft.rfft(x, axis=1)) ** 2).mean(axis=0)
    f = np.fft.rfftfreq(x.shape[1], 1 / RATE)
    assert power[(f < 4) | (f > 41)].sum() < 0.05 * power.sum()
    assert np.array_equal(signal.samples(RATE), signal.samples(RATE))


def test_burst_of_the_whole_period_is_never_silent():
    x = BurstRandom(start=5, stop=40, period=4, periods=2, share=1).samples(RATE).reshape(2, -1)
    assert np.all(np.abs(x[:, -200:]).max(axis=1) > 0.1)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: LinearChirp(start=1, stop=1, duration=5), "same frequency"),
        (lambda: LinearChirp(start=-1, stop=5, duration=5), "out-of-range"),
        (lambda: LogarithmicSweep(start=0, stop=5, duration=5), "out-of-range"),
        (lambda: LogarithmicSweep(start=1, stop=5, duration=np.nan, amplitude=-2), "amplitude.*; duration"),
        (lambda: LinearChirp(start=1, stop=5, duration=5, mean=np.nan), "out-of-range"),
        (lambda: SteppedSine(frequencies=(), hold=1), "at least one"),
        (lambda: Multisine(start=5, stop=2, period=4), "out-of-range"),
        (lambda: LoadCycles(frequencies=1.0), "frequencies must be several numbers"),
        (lambda: LoadCycles(frequencies=(1,), levels=0.5), "levels must be several numbers"),
        (lambda: LoadCycles(frequencies=("1 Hz",)), "frequencies must be several numbers"),
        (lambda: LoadCycles(frequencies=(1,), amplitude="3 N*m"), "amplitude must be a number"),
        (lambda: LoadCycles(frequencies=(1,), shape="square"), "out-of-range"),
        (lambda: LoadCycles(frequencies=(1,), cycles=2.5), "out-of-range"),
        (lambda: LoadCycles(frequencies=(1,), means=(np.inf,)), "out-of-range"),
        (lambda: Multisine(start=1.01, stop=1.02, period=4), "no line between"),
        (lambda: Multisine(start=1, stop=20, period=1.23456789).samples(1000), "contradicting-values"),
        (lambda: BurstRandom(start=1, stop=20, period=4, share=1.5), "out-of-range"),
        (lambda: LinearChirp(start=1, stop=600, duration=5).samples(1000), "beyond-sampling"),
    ],
)
def test_signals_that_make_no_sense(make, message):
    with pytest.raises(tn.UsageError, match=message):
        make()


def test_lines_that_rounding_puts_beside_an_end_are_among_them():
    """0.1 * 3 * 10 is above 3 and 0.29 * 100 is below 29, each by rounding alone."""
    assert 0.1 * 3 * 10 > 3
    assert 0.29 * 100 < 29
    assert Multisine(start=0.1 * 3, stop=1, period=10, periods=1).lines[0] == pytest.approx(0.3)
    assert Multisine(start=0.1, stop=0.29, period=100, periods=1).lines[-1] == pytest.approx(0.29)
    assert Multisine(start=0.1, stop=1, period=4).lines.tolist() == [0.25, 0.5, 0.75, 1.0]
