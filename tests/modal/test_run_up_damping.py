"""Natural frequency and damping from run-ups: the swept fit against solve_ivp and the closed form of a linear sweep."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support import campaigns
from support.known_damping import F0, ZETA, closed_form, half_power, swept, with_noise

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.modal import match, modes_from_run_up
from torsionnet.modal.operational.run_up_fit import sweep_of, swept_response
from torsionnet.modal.operational.run_up_modes import modes_from_tracked_orders
from torsionnet.signals.orders.tracked_orders import UNKNOWN_TRACKING, TrackedOrders, TrackingKernel
from torsionnet.signals.recording import Recording, Signal

POLE = 2 * np.pi * F0 * complex(-ZETA, np.sqrt(1 - ZETA**2))
NIGHT = pytest.mark.nightly
STEADY_PEAK = 1 / (2 * ZETA * np.sqrt(1 - ZETA**2))


@pytest.mark.parametrize(("rate", "peak", "late", "wide"), [(10, -0.44, 0.11, 3.6), (1, -0.10, 0.025, 1.43)])
def test_steady_reading_of_a_run_up_is_low_late_and_wide(rate, peak, late, wide):
    f = np.linspace(10, 35, 50001)
    found = half_power(f, np.abs(closed_form(rate, f)))
    assert found[0] / STEADY_PEAK - 1 == pytest.approx(peak, abs=0.005)
    assert found[1] / F0 - 1 == pytest.approx(late, abs=0.002)
    assert found[2] / ZETA == pytest.approx(wide, abs=0.03)


@pytest.mark.parametrize("rate", [10, 1, -10])
def test_swept_response_is_the_closed_form(rate):
    first, last = (4, 40) if rate > 0 else (40, 4)
    times = np.arange(0, (last - first) / rate, 1 / 800)
    sweep = sweep_of(times, 2 * np.pi * (first * times + rate * times**2 / 2), 1.0)
    found = np.abs(swept_response(POLE, sweep))
    f = sweep.speed / (2 * np.pi)
    kept = slice(len(f) // 3, None)  # what the sweep has forgotten of its start
    if rate > 0:
        assert found[kept] == pytest.approx(np.abs(closed_form(rate, f[kept])), rel=2e-3)
    else:  # down in time: the highest point is early now, and as much lower
        assert found.max() / STEADY_PEAK - 1 == pytest.approx(-0.44, abs=0.03)
        assert f[found.argmax()] < F0


@pytest.mark.parametrize("rate", [10, pytest.param(1, marks=pytest.mark.slow), -10])
def test_swept_fit_without_noise(rate):
    first, last = (8, 36) if rate > 0 else (36, 8)
    found = modes_from_run_up(swept(rate, first, last), "T", 1, "n")
    assert found.natural_frequencies == pytest.approx([F0], rel=1e-3)
    assert found.damping_ratios == pytest.approx([ZETA], rel=0.03)


def test_swept_fit_without_noise_is_far_better_than_asked():
    found = modes_from_run_up(swept(10), "T", 1, "n")
    assert found.natural_frequencies == pytest.approx([F0], rel=2e-5)
    assert found.damping_ratios == pytest.approx([ZETA], rel=2e-3)
    assert "a peak 44 % too low" in " ".join(found.notes)


def test_inertia_torque_grows_with_the_square_of_the_speed():
    record = swept(8, 8, 40, power=2)
    found = modes_from_run_up(record, "T", 1, "n", excitation_law="inertia")
    assert found.natural_frequencies == pytest.approx([F0], rel=1e-4)
    assert found.damping_ratios == pytest.approx([ZETA], rel=5e-3)
    assert any("square of the speed" in note for note in found.notes)


@pytest.mark.slow
def test_an_order_of_an_engine_is_read_beside_others():
    """Order 6 of a shaft, with orders 5.5 and 6.5 beside it that excite the same mode, and a mean torque."""
    rate = 0.4  # revolutions per s, per s
    orders = ((6, 1.0), (5.5, 0.6), (6.5, 0.5))
    parts = [
        swept(rate * o, 2 * o, 5.2 * o, order=o, sampling=500, phase=o).signals[0].values * size for o, size in orders
    ]
    count = min(map(len, parts))
    torque = 40 + sum(part[:count] for part in parts)
    speed = 2 * np.pi * (2 + rate * np.arange(count) / 500)
    record = Recording((Signal("T", "torque", torque), Signal("n", "velocity", speed)), 500)
    together = modes_from_run_up(record, "T", [6, 5.5, 6.5], "n", band=(14, 29))
    assert together.natural_frequencies == pytest.approx([F0], rel=1e-3)
    assert together.damping_ratios == pytest.approx([ZETA], rel=0.03)


@pytest.mark.slow
def test_two_modes_that_overlap():
    one, other = swept(2, 8, 40), swept(2, 8, 40, f0=22.5, zeta=0.03)
    torque = one["T"].values - 0.8 * other["T"].values
    found = modes_from_run_up(one.with_signals(Signal("T", "torque", torque)), "T", 1, "n", mode_count=2)
    assert found.natural_frequencies == pytest.approx([F0, 22.5], rel=1e-3)
    assert found.damping_ratios == pytest.approx([ZETA, 0.03], rel=0.03)


@pytest.mark.parametrize(("quantity", "times"), [("velocity", 1), ("acceleration", 2)])
def test_derivatives_of_the_angle(quantity, times):
    record = swept(8, 8, 40, sampling=2000)
    values = record["T"].values
    for _ in range(times):
        values = np.gradient(values, 1 / record.sampling_rate, edge_order=2)
    found = modes_from_run_up(record.with_signals(Signal("T", quantity, values)), "T", 1, "n")
    assert found.natural_frequencies == pytest.approx([F0], rel=1e-3)
    assert found.damping_ratios == pytest.approx([ZETA], rel=0.03)


def tracked(rate, *, bandwidth=0.0, phases=True, tracking=UNKNOWN_TRACKING):
    """The order as it follows from the closed solution, smeared by an order-tracking filter of two poles by its FFT."""
    f = np.arange(8, 36, rate / 100)
    times = np.arange(len(f)) / 100
    sweep = sweep_of(times, 2 * np.pi * np.cumsum(f) / 100, 1.0)
    values = swept_response(POLE, sweep)
    if bandwidth:
        lines = np.fft.fftfreq(2 * len(values), 1 / 100)
        mirrored = np.concatenate([values, values[::-1]])
        gain = 1 / (1 + (np.sqrt(2) - 1) * (2 * lines / bandwidth) ** 4)
        values = np.fft.ifft(np.fft.fft(mirrored) * gain)[: len(values)]
    if not phases:
        values = np.abs(values).astype(complex)
    widths = np.full((1, len(f)), np.nan)
    return TrackedOrders("T", "torque", np.array([1.0]), times, 2 * np.pi * f, values[None], widths, tracking=tracking)


@pytest.mark.slow
def test_tracked_order_with_and_without_phases():
    for phases in (True, False):
        found = modes_from_tracked_orders(tracked(1, phases=phases), 1)
        assert found.natural_frequencies == pytest.approx([F0], rel=1e-3)
        assert found.damping_ratios == pytest.approx([ZETA], rel=0.03)
        assert any("amplitudes alone" in note for note in found.notes) != phases
        assert any("smears is not known" in note for note in found.notes)


@pytest.mark.slow
def test_smear_of_a_tracking_filter_is_fitted_with_it():
    order = tracked(2, bandwidth=2.0, tracking=TrackingKernel(bandwidth=2.0))
    found = modes_from_tracked_orders(order, 1)
    assert found.natural_frequencies == pytest.approx([F0], rel=1e-3)
    assert found.damping_ratios == pytest.approx([ZETA], rel=0.03)
    ignorant = modes_from_tracked_orders(tracked(2, bandwidth=2.0), 1)
    assert ignorant.damping_ratios[0] > 1.1 * ZETA


@pytest.mark.parametrize("derivative", [1, 2])
def test_velocity_and_acceleration_at_the_start_are_those_of_the_steady_response(derivative):
    times = np.arange(0, 10, 1 / 1000)
    sweep = sweep_of(times, 2 * np.pi * (12 * times + times**2 / 1000), 1.0)
    steady = abs(POLE) ** 2 / ((1j * sweep.speed - POLE) * (1j * sweep.speed - POLE.conjugate()))
    found = swept_response(POLE, sweep, derivative)
    assert found == pytest.approx(steady * (1j * sweep.speed) ** derivative, rel=1e-4)


@pytest.mark.parametrize(("rate", "first"), [(2, 16), (5, 14)])
def test_a_sweep_begins_without_ringing(rate, first):
    """From the first sample on it is one that began in the far past; the steady response is 1.8 % off there."""
    times = np.arange(0, 12 / rate, 1 / 800)
    found = swept_response(POLE, sweep_of(times, 2 * np.pi * (first * times + rate * times**2 / 2), 1.0))
    exact = closed_form(rate, first + rate * times)
    steady = 1 / (1 - (first / F0) ** 2 + 2j * ZETA * first / F0)
    assert abs(steady / exact[0] - 1) > 0.017
    assert abs(found[0] / exact[0] - 1) < 0.0013
    assert np.abs(found - exact).max() < 1.5e-4 * np.abs(exact).max()


def test_weights_of_a_tracking_filter_and_of_blocks():
    """Two poles between -3 dB points of b: exp(-a|t|)(cos a|t| + sin a|t|), a = pi b/(sqrt(2) (sqrt(2) - 1)^(1/4))."""
    times = np.linspace(-1, 1, 41)
    a = np.pi * 2.0 / (np.sqrt(2) * (np.sqrt(2) - 1) ** 0.25)
    exact = np.exp(-a * np.abs(times)) * (np.cos(a * times) + np.sin(a * np.abs(times)))
    found = TrackingKernel(bandwidth=2.0).weights(times, 60.0, 1.0)
    assert found / found.max() == pytest.approx(exact, abs=2e-3)
    blocks = TrackingKernel(revolutions=16.0, taper=2.0)
    assert blocks.reach(2 * np.pi * 10, 1.0) == pytest.approx(0.8)  # half of 16 revolutions at 10 per second
    assert blocks.weights(np.array([0, 0.6, 0.7, 0.8]), 2 * np.pi * 10, 1.0) == pytest.approx([1, 1, 0.5, 0])


def test_modes_are_laid_beside_those_of_a_model():
    found = modes_from_run_up(swept(10), "T", 1, "n")
    compared = match(found, [POLE * 1.01, 3 * POLE])
    assert compared.model.tolist() == [0]
    assert compared.frequency_errors == pytest.approx([1 / 1.01 - 1], abs=1e-4)


def test_resonance_that_is_not_passed():
    with pytest.raises(SolveError, match="no-resonance"):
        modes_from_run_up(swept(2, 8, 18), "T", 1, "n")


def test_wrong_input_is_named():
    record = swept(10)
    with pytest.raises(UsageError, match="out-of-range"):
        modes_from_run_up(record, "T", -1, "n", mode_count=0)
    with pytest.raises(UsageError, match="unfit-channel"):
        modes_from_run_up(record, "T", 1, "T")
    with pytest.raises(SolveError, match=r"(?s)50.*60.*no-resonance"):
        modes_from_run_up(record, "T", 1, "n", band=(50, 60))
    with pytest.raises(UsageError, match='"constant" or "inertia"'):
        modes_from_run_up(record, "T", 1, "n", excitation_law="square")
    backwards = replace(tracked(1), times=tracked(1).times[::-1])
    with pytest.raises(UsageError, match="unordered-rows"):
        modes_from_tracked_orders(backwards, 1)


def coverage(rate, sigma, seeds, **more):
    hits = np.zeros(2)
    record = swept(rate)
    for seed in range(seeds):
        found = modes_from_run_up(with_noise(record, sigma, seed), "T", 1, "n", **more)
        hits += [
            abs(found.natural_frequencies[0] - F0) < found.frequency_half_widths[0],
            abs(found.damping_ratios[0] - ZETA) < found.damping_half_widths[0],
        ]
    return hits / seeds


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rate", "sigma"), [pytest.param(10, 0.5, marks=NIGHT), (10, 3.0), pytest.param(3, 2.0, marks=NIGHT)]
)
def test_intervals_of_the_swept_fit_hold_the_truth(rate, sigma):
    frequency, damping = coverage(rate, sigma, campaigns.examples(60, 150))
    assert 0.90 <= frequency <= 0.99
    assert 0.90 <= damping <= 0.99
