"""Drop-outs of telemetry: cycles with held values or zeros are left out of orders, and counted."""

from itertools import pairwise

import numpy as np
import pytest

from torsionnet.signals import CycleAverage, VoldKalman, mean_rotation, track_orders
from torsionnet.signals.orders.cycle_average import averaged_blocks
from torsionnet.signals.orders.tracked_signals import drop_outs
from torsionnet.signals.recording import Recording, Signal

RATE, SPEED, MEAN, PEAK = 2000.0, 60.0, -400.0, 50.0


def record(spans=(), noise=0.0, begin=0.0, reads="held", bits=0.0):
    """Torque of order 1.5 of 50 N m about -400 N m at 60 rad/s for 20 s, with times in s in which it is lost."""
    time = begin + np.arange(40_000) / RATE
    values = MEAN + PEAK * np.cos(1.5 * SPEED * time + 0.4) + noise * np.random.default_rng(1).standard_normal(40_000)
    values = bits * np.rint(values / bits) if bits else values
    for first, last in spans:
        lost = (time >= first) & (time < last)
        values[lost] = values[np.argmax(lost) - 1] if reads == "held" else 0.0
    angle = Signal("a", "angle", SPEED * time)
    return Recording((angle, Signal("T", "torque", values), Signal("T2", "torque", values.copy())), RATE, start=begin)


def tracked(recording, method=None, channels=("T",)):
    mean = mean_rotation(recording, "a")
    phase = np.exp(-1.5j * mean.angles[0])
    return [(one, one.along(1.5) * phase) for one in track_orders(recording, mean, channels, orders=[1, 1.5, 2],
                                                                 method=method)]  # fmt: skip


TRUE = PEAK * np.exp(0.4j)
SPANS = ((4.003, 4.043), (11.51, 11.55))


@pytest.mark.parametrize("reads", ["held", "zero"])
@pytest.mark.parametrize("noise", [0.0, 2.0])
@pytest.mark.parametrize("method", [CycleAverage(), VoldKalman(bandwidth=0.5)], ids=["average", "filter"])
def test_orders_do_not_see_drop_outs(reads, noise, method):
    ((found, values),) = tracked(record(SPANS, noise, reads=reads), method)
    assert np.abs(values - TRUE).max() < (1e-3 if not noise else 1.5)
    length = "0.081" if reads == "held" else "0.08"  # the sample that is held looks alike
    assert any(note.startswith(f"2 drop-outs of {length} s in all, the first at 4.00") for note in found.notes)
    ((clean, same),) = tracked(record((), noise), method)
    assert not any("drop-out" in note for note in clean.notes)
    assert np.abs(same - TRUE).max() < (1e-3 if not noise else 1.5)


def test_drop_outs_would_spoil_a_block_if_they_were_kept(monkeypatch):
    monkeypatch.setattr("torsionnet.signals.orders.tracked_signals.drop_outs", lambda _: [])
    ((_, values),) = tracked(record(SPANS, reads="zero"))
    assert np.abs(values - TRUE).max() > 1.0


def test_only_the_channel_that_drops_out_loses_cycles():
    whole, lost = record((), 2.0), record(SPANS, 2.0, reads="zero")
    both = Recording((whole["a"], lost["T"], whole["T2"]), RATE)
    (_, first), (second, values) = tracked(both, channels=("T", "T2"))
    ((_, alone),) = tracked(whole, channels=("T2",))
    np.testing.assert_allclose(values, alone, rtol=1e-9)
    assert not any("drop-out" in note for note in second.notes)
    assert np.abs(first - alone).max() > 0


@pytest.mark.parametrize("method", [CycleAverage(cycles=4), VoldKalman(bandwidth=0.5)], ids=["average", "filter"])
def test_values_for_as_long_as_a_drop_out_are_left_out(method):
    both = record([(5.0, 8.0)], 1.0)
    (_, whole), _ = tracked(record((), 1.0), method, ("T", "T2"))
    (found, values), (beside, _) = tracked(Recording((both["a"], both["T"], record()["T2"]), RATE), method, ("T", "T2"))
    gap = np.diff(found.times).max()
    assert 3.0 < gap < 5.1  # a block of four cycles lacks too much if one of them is lost
    assert len(values) == len(whole) - round(gap / np.diff(found.times).min()) + 1
    assert np.isfinite(found.half_widths).all()
    assert np.abs(values - TRUE).max() < 1.0
    np.testing.assert_array_equal(beside.times, found.times)
    for one in (found, beside):
        assert sum("values of each order left out" in note and "T dropped out" in note for note in one.notes) == 1


def test_samples_lost_by_another_channel_are_said_where_both_are_filtered():
    one = record(SPANS)
    (_, _), (beside, _) = tracked(Recording((one["a"], one["T"], record()["T2"]), RATE), VoldKalman(), ("T", "T2"))
    assert any(note.startswith("samples left out with those that T lost") for note in beside.notes)


def test_blocks_find_the_same_drop_outs_as_the_whole_record():
    one = record([(4.095, 4.135), SPANS[1]], 1.0)
    cut = [0, 8192 + 20, 23_000, 31_000, 40_000]  # the first seam lies in a drop-out
    blocks = [
        Recording(tuple(Signal(s.name, s.quantity, s.values[a:b]) for s in one), RATE, start=a / RATE)
        for a, b in pairwise(cut)
    ]
    mean = mean_rotation(one, "a")
    for method in (CycleAverage(), VoldKalman(bandwidth=0.5)):
        (whole,) = track_orders(one, mean, ["T"], orders=[1.5], method=method)
        (parts,) = track_orders(iter(blocks), mean, ["T"], orders=[1.5], method=method)
        np.testing.assert_allclose(parts.values, whole.values, atol=1e-6)
        assert whole.notes == parts.notes


@pytest.mark.parametrize("lost", [(), (0, 1, 2), (3,), (6, 7, 8)])
def test_a_block_without_some_cycles_is_a_line_through_the_others_at_its_middle(lost):
    """Value and scatter against least squares over pairs of cycles, each read as a block of its own."""
    size = np.random.default_rng(2).normal(PEAK, 3, 9) + 4 * np.arange(9)
    record = Recording((Signal("a", "angle", SPEED * np.arange(4000) / RATE),), RATE)
    mean = mean_rotation(record, "a")

    def read(times):
        angle = SPEED * times - mean.angles[0]
        cycle = np.clip((angle / (4 * np.pi) + 1e-9).astype(int), 0, 8)
        return (size[cycle] * np.cos(1.5 * angle))[None]

    def blocks(begins, lost):
        given = (read, mean, np.array([1.5]), np.array(begins), lambda _: 64, lambda _: np.ones(1), mean.angles[0])
        return [*averaged_blocks(*given, lambda ends: np.isin(mean.ends.searchsorted(ends[:-1]), lost)[None])]

    (block,) = blocks([0, 9], lost)
    pairs = np.array([blocks([first, first + 2], ())[0].values[0, 0] for first in range(8)])
    kept = np.array([first for first in range(8) if first not in lost and first + 1 not in lost])
    columns = np.stack([np.ones(len(kept)), kept - 3.5], axis=1)
    (middle, _), (square,) = np.linalg.lstsq(columns + 0j, pairs[kept])[:2]
    assert block.count == len(kept)
    assert block.values[0, 0] == pytest.approx(middle, rel=1e-9)
    # Of the middle, which the mean of the others only is where none is missing on one side.
    variance = len(kept) * np.linalg.inv(columns.T @ columns)[0, 0]
    assert block.scatter[0, 0] == pytest.approx(square * variance, rel=1e-9)


TIME = np.arange(40_000) / RATE
WAVE = 10 * np.cos(2 * np.pi * 6 * TIME + 0.3)


def test_what_moves_is_no_drop_out():
    wave = np.sin(2 * np.pi * 3 * TIME)
    noisy = np.random.default_rng(2).normal(size=len(TIME))
    for signal in (wave, np.clip(wave, -0.9, 0.9), np.maximum(wave, 0), np.clip(WAVE + 0.1 * noisy, -9.8, 99) + 9.8,
                   np.sign(wave), 0 * wave, 0 * wave + 3, np.where(TIME > 3, 1.0, 0.0) * TIME, noisy.round()):  # fmt: skip
        assert drop_outs(signal) == []


def stops_and_starts():
    return WAVE * np.where(TIME < 8, np.exp(-np.maximum(TIME - 5, 0) / 0.3), np.minimum(np.exp((TIME - 13) / 0.3), 1))


def between_resonances():
    speed = 1 + TIME
    swept = np.cos(2 * np.pi * np.cumsum(speed) / RATE)
    return 0.02 * swept * sum(1 / np.hypot(1 - (speed / at) ** 2, 0.02 * speed / at) for at in (6.0, 16.0))


def clutch_opens():
    return np.interp(TIME, [0, 8, 8.2, 10, 10.2, 20], [1, 1, 0, 0, 1, 1]) * (WAVE - 400)


@pytest.mark.parametrize("signal", [stops_and_starts, between_resonances, clutch_opens,
                                    lambda: 0.15 * WAVE, lambda: 3.1 * np.cos(0.7 * TIME)])  # fmt: skip
@pytest.mark.parametrize("step", [0.05, 0.5, 2.0])
@pytest.mark.parametrize("noise", [0.0, 0.02, 0.3])
def test_a_coarse_converter_holds_nothing(signal, step, noise):
    steps = signal() / step + noise * np.random.default_rng(3).normal(size=len(TIME))
    for mean in (0.0, -80.2):
        assert drop_outs(step * np.rint(steps + mean)) == []


@pytest.mark.parametrize("step", [0.0, 0.02, 0.2])
@pytest.mark.parametrize("reads", ["held", "zero"])
@pytest.mark.parametrize("noise", [0.0, 0.4])
def test_drop_outs_of_a_converter_with_steps_are_found(step, reads, noise):
    missed = 0
    for at in range(8000, 10_000, 100):
        values = WAVE - 400 + 3 * np.cos(2 * np.pi * 13.7 * TIME)
        values += noise * np.random.default_rng(at).normal(size=len(TIME))
        values = step * np.rint(values / step) if step else values
        values[at : at + 80] = values[at - 1] if reads == "held" else 0.0
        missed += len(drop_outs(values)) != 1
    # Without noise a value is missed that goes on where it was held.
    assert missed <= (4 if reads == "held" and not noise else 0)


def test_a_shift_in_time_by_a_spline_does_not_hide_a_drop_out():
    from scipy.interpolate import CubicSpline

    one = record(SPANS, 2.0)
    early = CubicSpline(one.time, one["T"].values)(np.minimum(one.time + 0.00837, one.time[-1]))
    found = drop_outs(early)
    assert len(found) == 2
    assert found[0][0] / RATE == pytest.approx(4.003 - 0.00837, abs=0.008)
