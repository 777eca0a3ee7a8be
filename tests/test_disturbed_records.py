"""Spikes, frozen stretches and clipped sines in records: found where they were put, and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.model.bench import Acquisition, Encoder, Plan, Transducer
from torsionnet.signals import (
    BurstRandom,
    LinearChirp,
    LogarithmicSweep,
    Multisine,
    Recording,
    Signal,
    SteppedSine,
    check_recording,
)
from torsionnet.signals.spikes import spikes
from torsionnet.signals.standstill import frozen

RATE = 1000.0
TIME = np.arange(20_000) / RATE


def torque(noise=0.2, seed=1):
    """A sweep of +-20 N m with noise."""
    chirp = 20 * np.sin(2 * np.pi * (1 + TIME) * TIME)
    return chirp + noise * np.random.default_rng(seed).normal(size=len(TIME))


def angle(lines, seed=2):
    """An encoder on a shaft that turns and swings."""
    turned = 2 * np.pi * 3 * TIME + 0.3 * np.sin(2 * np.pi * 4 * TIME)
    step = 2 * np.pi / lines
    return step * np.floor(turned / step + np.random.default_rng(seed).random())


def messages(values, quantity="torque"):
    return [fault.message for fault in check_recording(Recording((Signal("x", quantity, values),), RATE))]


class TestSpikes:
    PLACES = np.array([1234, 5678, 5690, 12_345, 19_000])

    def test_five_of_200_in_20(self):
        values = torque()
        values[self.PLACES] += np.array([200, -200, 200, 200, -200])
        assert spikes(values).tolist() == self.PLACES.tolist()
        (text,) = messages(values)
        assert text.startswith(f"5 single samples far from those around: {values[1234]:.6g} N*m at 1.234 s, ")
        assert text.endswith(" and 2 more; a disturbance, to be mended or cut out")

    @pytest.mark.parametrize(("size", "noise"), [(5, 0.2), (1.5, 0.02), (50, 2)])
    def test_small_ones_over_the_noise(self, size, noise):
        slow = 20 * np.sin(2 * np.pi * 2 * TIME) + noise * np.random.default_rng(1).normal(size=len(TIME))
        slow[self.PLACES] += size
        assert spikes(slow).tolist() == self.PLACES.tolist()

    @pytest.mark.parametrize("lines", [100, 5000])
    def test_in_an_encoder(self, lines):
        values = angle(lines)
        values[self.PLACES] += 2 * np.pi
        assert spikes(values, 2 * np.pi / lines).tolist() == self.PLACES.tolist()

    @pytest.mark.parametrize("name", ["normal", "laplace", "uniform"])
    def test_none_in_noise(self, name):
        rng = np.random.default_rng(3)
        for _ in range(10):
            assert not len(spikes(getattr(rng, name)(size=100_000)))


class TestFrozen:
    def test_a_fifth_of_a_second(self):
        for begin in range(2000, 18_000, 1777):
            values = torque()
            values[begin : begin + 200] = values[begin]
            assert frozen(values, RATE) == [(begin, begin + 199)]
        (text,) = messages(values)
        assert (
            text == "stands still where it moves before and after: from 17.993 to 18.192 s; samples may have been lost"
        )

    @pytest.mark.parametrize("lines", [500, 5000])
    def test_of_a_fast_encoder(self, lines):
        values = angle(lines)
        values[8000:8200] = values[8000]
        (found,) = frozen(values, RATE, 2 * np.pi / lines)
        assert abs(found[0] - 8000) < 5
        assert found[1] == 8199
        assert any("stands still" in text for text in messages(values, "angle"))

    def test_of_a_smooth_signal_by_its_jump(self):
        values = 20 * np.sin(2 * np.pi * 3 * TIME)
        values[5000:5200] = values[5000]
        assert frozen(values, RATE) == [(5000, 5199)]

    @pytest.mark.parametrize(
        "values",
        [
            np.concatenate([np.zeros(5000), torque()[5000:15_000], np.full(5000, 3.3)]),
            np.interp(TIME, [0, 2, 5, 8, 12, 14, 20], [0, 0, 10, 10, 40, 40, 0]),
            np.where(np.abs(TIME - 10) < 2, 0.0, torque()),
            np.repeat([1.0, 5.0, 2.0, 5.0], 5000),
            angle(20),
            np.round(np.sin(2 * np.pi * 0.2 * TIME) * 40),
            np.round(0.45 * np.sin(2 * np.pi * 5 * TIME) + 0.3),
        ],
    )
    def test_not_what_rests_or_is_slow(self, values):
        assert frozen(values, RATE, 1.0 if np.all(values == np.rint(values)) else 0.0) == []


@pytest.mark.parametrize("share", [0.2, 0.5, 0.7, 0.9])
def test_a_clipped_sine(share):
    values = np.clip(20 * np.sin(2 * np.pi * 3 * TIME), -20 * share, 20 * share)
    assert any(text.startswith("clipped: ") for text in messages(values))


EXCITATIONS = [
    LinearChirp(start=0.2, stop=60, duration=20, amplitude=15),
    LogarithmicSweep(start=0.5, stop=60, duration=20, amplitude=15),
    Multisine(start=0.5, stop=60, period=5, periods=4, amplitude=15),
    BurstRandom(start=0.5, stop=60, period=5, periods=4, amplitude=15),
    SteppedSine(frequencies=(1.0, 3.0, 8.0, 20.0), hold=5, amplitude=15),
]


@pytest.mark.parametrize("excitation", EXCITATIONS, ids=lambda one: one.kind)
@pytest.mark.parametrize("lines", [60, 1024, 18_000])
def test_nothing_is_found_in_sound_tests(excitation, lines):
    plan = Plan(
        excitation=excitation,
        channels={"T_T": Transducer(noise="0.23 N*m"), "theta_1": Encoder(lines=lines, quadrature=True)},
        acquisition=Acquisition(rate="2 kHz"),
    )
    record = tn.Bench(tn.load("dmf_rig"), plan).run()
    assert check_recording(record) == ()


@pytest.mark.slow
@pytest.mark.parametrize("bench", ["dmf_bench", "amt_bench"])
def test_nothing_is_found_in_the_library_s_benches(bench):
    given = tn.load_bench(bench)
    for lines in (60, 1024):
        channels = {**given.plan.channels, "theta_1": Encoder(lines=lines)}
        assert check_recording(replace(given, plan=replace(given.plan, channels=channels)).run()) == ()
