"""Tracked orders against rota-order, a tracker written independently; skipped where it is not installed."""

from __future__ import annotations

import numpy as np
import pytest
from support.collecting import OnDemand

from torsionnet.signals import CycleAverage, PhaseReference, VoldKalman, mean_rotation, track_orders
from torsionnet.signals.recording import Recording, Signal

rota = OnDemand("rota")
RATE = 1000.0


@pytest.fixture(scope="module")
def run_up():
    time = np.arange(12_000) / RATE
    speed = 60 + 3 * time
    phi = 60 * time + 1.5 * time**2
    hertz = 3 * speed / (2 * np.pi)
    resonant = 1 / (1 - (hertz / 38) ** 2 + 0.1j * hertz / 38)
    values = (resonant * np.exp(3j * phi)).real + 0.5 * np.cos(4.5 * phi + 1)
    values += 0.05 * np.random.default_rng(1).standard_normal(len(time))
    record = Recording(
        (Signal("n", "velocity", speed), Signal("a", "angle", phi), Signal("T", "torque", values)), sampling_rate=RATE
    )
    return record, time, speed * 30 / np.pi, values


def compared(record, time, method, theirs, skip=1.0):
    (found,) = track_orders(
        record,
        mean_rotation(record, "a"),
        ["T"],
        orders=[3, 4.5],
        method=method,
        phase_reference=PhaseReference(0.0, "x"),
    )
    inside = (found.times > skip) & (found.times < time[-1] - skip)
    for place, envelope in enumerate(theirs.envelopes.T):
        same = np.interp(found.times, time, envelope.real) + 1j * np.interp(found.times, time, envelope.imag)
        yield np.abs(found.values[place] - same)[inside].max()


def test_vold_kalman_gives_the_same_envelopes(run_up):
    """Their bandwidth is to one side of the order, ours from side to side."""
    record, time, rpm, values = run_up
    theirs = rota.extract.order_waveform(values, RATE, rpm, [3, 4.5], bandwidth=1.0)
    assert max(compared(record, time, VoldKalman(2.0), theirs)) < 0.01


def test_averages_over_cycles_agree_with_phase_locked_averages(run_up):
    record, time, rpm, values = run_up
    theirs = rota.extract.tracked_harmonics(values, RATE, rpm, [3, 4.5], window_revs=8.0)
    assert max(compared(record, time, CycleAverage(cycles=4), theirs)) < 0.25
