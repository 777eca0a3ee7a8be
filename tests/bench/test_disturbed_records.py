"""Spikes, frozen stretches and clipped sines in records: found where they were put, and nowhere else."""

import time
from dataclasses import replace

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.bench.plan import Acquisition, Encoder, Plan, Transducer
from torsionnet.signals import BurstRandom, LinearChirp, Recording, Signal, check_recording
from torsionnet.signals.excitation import LogarithmicSweep, Multisine, SteppedSine
from torsionnet.signals.recording_checks import repeated_blocks
from torsionnet.signals.uncertainty import step_of
from torsionnet.signals.value_faults import frozen_stretches, spikes

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
        for begin in (3, 19_797, *range(2000, 18_000, 1777)):
            values = torque()
            values[begin : begin + 200] = values[begin]
            assert frozen_stretches(values, RATE) == [(begin, begin + 199)]
        (text,) = messages(values)
        assert text.startswith("stands still where it moves before and after: from 17.993 to 18.192 s; samples may")
        assert text.endswith("have been lost: cut it out, or record again")

    @pytest.mark.parametrize("rate", [100.0, 200.0, 2000.0])
    def test_of_0_15_s_at_any_rate(self, rate):
        count = int(0.15 * rate)
        values = np.random.default_rng(1).normal(size=2000)
        values[700 : 700 + count] = values[700]
        assert frozen_stretches(values, rate) == [(700, 699 + count)]

    def test_one_soon_after_the_other(self):
        values = torque()
        values[3000:3150], values[3155:3305] = values[3000], values[3155]
        assert frozen_stretches(values, RATE) == [(3000, 3149), (3155, 3304)]

    def test_beside_two_that_are_shorter_but_not_beside_three(self):
        """Fourteen samples are a tenth of 140: a signal that stands still so often is slow."""
        values = torque()
        values[2960:3100] = values[2960]
        for begin, found in ((2944, [(2960, 3099)]), (2928, [(2960, 3099)]), (2912, [])):
            values[begin : begin + 14] = values[begin]
            assert frozen_stretches(values, RATE) == found

    @pytest.mark.parametrize("lines", [500, 5000])
    def test_of_a_fast_encoder(self, lines):
        values = angle(lines)
        values[8000:8200] = values[8000]
        (found,) = frozen_stretches(values, RATE, 2 * np.pi / lines)
        assert abs(found[0] - 8000) < 5
        assert found[1] == 8199
        assert any("stands still" in text for text in messages(values, "angle"))

    def test_of_a_smooth_signal_by_its_jump(self):
        values = 20 * np.sin(2 * np.pi * 3 * TIME)
        values[5000:5200] = values[5000]
        assert frozen_stretches(values, RATE) == [(5000, 5199)]

    @pytest.mark.parametrize(
        "values",
        [
            np.concatenate([np.zeros(5000), torque()[5000:15_000], np.full(5000, 3.3)]),
            np.interp(TIME, [0, 2, 5, 8, 12, 14, 20], [0, 0, 10, 10, 40, 40, 0]),
            np.where(np.abs(TIME - 10) < 2, 0.0, torque()),
            np.repeat([1.0, 5.0, 2.0, 5.0], 5000),
            np.where((TIME % 5 > 2) & (TIME % 5 < 2.2) & (TIME < 10), 3.3, torque()),
            angle(20),
            np.round(np.sin(2 * np.pi * 0.2 * TIME) * 40),
            np.round(0.45 * np.sin(2 * np.pi * 5 * TIME) + 0.3),
        ],
    )
    def test_not_what_rests_or_is_slow(self, values):
        assert frozen_stretches(values, RATE, 1.0 if np.all(values == np.rint(values)) else 0.0) == []


def quantised(values, step=0.05):
    return step * np.round(values / step)


MOVING = {
    "torque": torque(),
    "12 bits": quantised(torque()),
    "speed": 100 + 0.5 * np.random.default_rng(4).normal(size=len(TIME)),
    "swinging encoder": quantised(0.3 * torque(0.02), 2 * np.pi / 5000),
    "without noise": 20 * np.sin(2 * np.pi * (1 + TIME) * TIME),
}
SLOW = np.round(40 * np.sin(2 * np.pi * (0.2 + 0.01 * TIME) * TIME))
PERIOD = np.random.default_rng(5).normal(size=5000)


class TestRepeatedBlocks:
    @pytest.mark.parametrize("name", MOVING)
    @pytest.mark.parametrize(
        ("source", "first", "count"), [(5000, 5200, 200), (2000, 14_000, 150), (18_000, 18_500, 500)]
    )
    def test_are_found_where_they_are(self, name, source, first, count):
        values = MOVING[name].copy()
        assert repeated_blocks(values, RATE, step_of(values)) == []
        values[first : first + count] = values[source : source + count]
        (found,) = repeated_blocks(values, RATE, step_of(values))
        # Beside the copy a coarse signal may go on alike for some samples.
        assert found.first - found.source == first - source
        assert first - 5 <= found.first <= first
        assert first + count <= found.first + found.count <= first + count + 5

    def test_are_told_with_both_times(self):
        values = torque()
        values[14_000:14_200] = values[2000:2200]
        (text,) = messages(values)
        assert text == (
            "repeats itself exactly: from 14 to 14.199 s as from 2 to 2.199 s; "
            "a buffer was recorded twice: cut it out, or record again"
        )

    def test_several(self):
        values = torque()
        for first in (3000, 9000, 12_000):
            values[first : first + 200] = values[first - 200 : first]
        assert [block.first for block in repeated_blocks(values, RATE)] == [3000, 9000, 12_000]

    def test_shorter_ones_are_no_buffers(self):
        values = torque()
        values[14_000:14_140] = values[2000:2140]
        assert repeated_blocks(values, RATE) == []

    @pytest.mark.parametrize(
        "values",
        [
            np.sin(2 * np.pi * (np.arange(20_000) % 100) / 100),
            quantised(20 * np.sin(2 * np.pi * 5 * TIME)),
            quantised(20 * np.sin(2 * np.pi * 4.7 * TIME) + 0.01 * np.random.default_rng(6).normal(size=len(TIME))),
            np.tile(PERIOD, 4),
            np.concatenate([np.zeros(3000), PERIOD, PERIOD, np.zeros(7000)]),
            np.concatenate([np.zeros(5000), torque()[5000:15_000], np.zeros(5000)]),
            np.full(20_000, 7.0),
            SLOW,
            np.repeat(np.random.default_rng(7).integers(0, 2, 2000), 10),
            np.floor(np.arange(20_000) / 37.3) % 1000,
            np.round(0.4 * np.random.default_rng(8).normal(size=20_000)),
            np.where(np.sin(2 * np.pi * 3.3 * TIME) > 0, 5.0, -5.0),
        ],
    )
    def test_not_what_is_periodic_or_rests_or_is_coarse(self, values):
        values = np.asarray(values, dtype=float)
        assert repeated_blocks(values, RATE, step_of(values)) == []

    def test_a_step_of_a_computed_sine_held_for_two_periods(self):
        """It goes on smoothly: the same sine once more, and no buffer."""
        period = np.sin(2 * np.pi * np.arange(500) / 500)
        chirp = 2 * np.sin(2 * np.pi * (3 + 0.2 * TIME[:8000]) * TIME[:8000])
        values = np.concatenate([chirp, period, period, chirp])
        assert repeated_blocks(values, RATE) == []

    def test_soon_done(self):
        values = np.random.default_rng(9).normal(size=1_000_000)
        values[600_000:600_400] = values[200_000:200_400]
        begin = time.process_time()
        (found,) = repeated_blocks(values, RATE)
        assert found.source == 200_000
        assert time.process_time() - begin < 0.5  # 0.05 s and what else the machine does


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
@pytest.mark.parametrize("bench", ["dmf_bench", pytest.param("amt_bench", marks=pytest.mark.nightly)])
def test_nothing_is_found_in_the_library_s_benches(bench):
    given = tn.load_bench(bench)
    for lines in (60, 1024):
        channels = {**given.plan.channels, "theta_1": Encoder(lines=lines)}
        assert check_recording(replace(given, plan=replace(given.plan, channels=channels)).run()) == ()
