"""Natural frequency and damping from free decays, against decays in closed form and a nonlinear one by solve_ivp."""

from __future__ import annotations

import numpy as np
import pytest
from support import campaigns

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.modal import modes_from_decay
from torsionnet.modal.operational.decay_fit import pencil_poles
from torsionnet.modal.operational.decay_modes import logarithmic_decrement
from torsionnet.signals.recording import Recording, Signal

RATE = 1000
TIMES = np.arange(0, 6, 1 / RATE)


def decay(f, zeta, size, begin=1.0, phase=0.0):
    """A vibration that begins to decay at a time in s, constant before."""
    w, t = 2 * np.pi * f, np.clip(TIMES - begin, 0, None)
    return size * np.exp(-zeta * w * t) * np.cos(w * np.sqrt(1 - zeta**2) * t + phase)


def record(values, sigma=0.0, seed=0):
    noisy = values + np.random.default_rng(seed).normal(0, sigma, len(values)) if sigma else values
    return Recording((Signal("T", "torque", noisy),), RATE)


def test_release_of_a_preload():
    found = modes_from_decay(record(50 + decay(9, 0.02, 100)), "T")
    assert found.natural_frequencies == pytest.approx([9], rel=1e-5)
    assert found.damping_ratios == pytest.approx([0.02], rel=1e-4)
    assert 0.9 < found.evidence.times[0] < 1.2
    assert found.evidence.decrement.decrement == pytest.approx(2 * np.pi * 0.02 / np.sqrt(1 - 0.02**2), rel=1e-4)
    assert any("found to start at 1.0" in note for note in found.notes)


def test_two_modes_of_a_clutch_drop_in_noise():
    found = modes_from_decay(record(decay(9, 0.02, 100) + np.where(TIMES < 1, 0, decay(23, 0.015, 30, 1, 0.5)), 1), "T")
    assert found.natural_frequencies == pytest.approx([9, 23], rel=1e-3)
    assert found.damping_ratios == pytest.approx([0.02, 0.015], rel=0.03)
    assert np.all(found.damping_half_widths < 0.05 * found.damping_ratios)
    assert not any(note.startswith("warning") for note in map(str, found.notes))


def test_close_modes_are_told_apart():
    found = modes_from_decay(record(decay(9, 0.01, 100) + decay(9.6, 0.02, 60), 0.2), "T", start=1, mode_count=2)
    assert found.natural_frequencies == pytest.approx([9, 9.6], rel=1e-3)
    assert found.damping_ratios == pytest.approx([0.01, 0.02], rel=0.03)


def test_pencil_finds_the_poles_of_damped_exponentials():
    t = np.arange(300) * 0.01
    poles = np.array([-0.3 + 20j, -1 + 45j])
    signal = np.real(np.exp(poles[0] * t) + (0.2 - 0.4j) * np.exp(poles[1] * t))
    found = pencil_poles(signal, 0.01, 4)[-1]
    assert np.sort_complex(found[found.imag > 0]) == pytest.approx(np.sort_complex(poles), rel=1e-8)


def test_dry_friction_shows_as_damping_that_depends_on_amplitude():
    """Amplitudes fall by 4 F/k a cycle: ln of their ratio is larger at small ones."""
    from scipy.integrate import solve_ivp

    w, friction = 2 * np.pi * 9, 0.6

    def slope(_, x):
        return [x[1], -w * w * (x[0] + friction * np.tanh(x[1] / 10)) - 2 * 0.01 * w * x[1]]

    values = solve_ivp(slope, (0, 3), [100.0, 0.0], t_eval=TIMES[:2900], rtol=1e-6, max_step=2e-3).y[0]
    found = modes_from_decay(Recording((Signal("T", "torque", values),), RATE), "T", start=0)
    decrement = found.evidence.decrement
    assert decrement.depends_on_amplitude
    assert decrement.at_large == pytest.approx(2 * np.pi * 0.01 + 4 * friction / decrement.amplitudes[0], rel=0.35)
    assert decrement.at_small > 2 * decrement.at_large
    assert any("depends on amplitude" in note for note in found.notes)


def test_linear_decay_has_no_remark_on_amplitude():
    assert not any(
        modes_from_decay(record(decay(9, 0.02, 100), 1, seed), "T").evidence.decrement.depends_on_amplitude
        for seed in range(5)
    )


def test_interval_of_the_decrement_is_that_of_a_weighted_line():
    """N samples a cycle leave sigma sqrt(2/N) in each amplitude, and that over the amplitude in its logarithm."""
    noise, w, zeta = 1.0, 2 * np.pi * 10, 0.02
    pole = w * complex(-zeta, np.sqrt(1 - zeta**2))
    times = np.arange(2000) / RATE
    clean = 100 * np.exp(pole * times).real
    found = [
        logarithmic_decrement(times, clean + np.random.default_rng(seed).normal(0, noise, len(times)), pole, noise)
        for seed in range(40)
    ]
    true = 2 * np.pi * zeta / np.sqrt(1 - zeta**2)
    size = 100 * np.exp(-true * (np.arange(len(found[0].times)) + 0.5))
    columns = np.stack([size, size * np.arange(len(size))], axis=1)
    error = noise * np.sqrt(2 / 100) * np.sqrt(np.linalg.inv(columns.T @ columns)[1, 1])
    assert len(size) == 19
    assert np.sqrt(np.mean([one.half_width**2 for one in found])) == pytest.approx(1.96 * error, rel=0.08)
    assert np.std([one.decrement - true for one in found]) == pytest.approx(error, rel=0.25)


def test_wrong_input_is_named():
    values = record(decay(9, 0.02, 100))
    with pytest.raises(UsageError, match=r"(?s)5\.999.*out-of-range"):
        modes_from_decay(values, "T", start=9)
    with pytest.raises(SolveError, match=r"(?s)1\.8 .* 9 Hz.*too-short"):
        modes_from_decay(values, "T", start=1.0, stop=1.2)
    with pytest.raises(SolveError, match="no-resonance"):
        modes_from_decay(record(np.exp(-TIMES), 0.01), "T", start=0)


@pytest.mark.slow
def test_intervals_of_a_decay_hold_the_truth():
    clean, hits = decay(9, 0.02, 100) + np.where(TIMES < 1, 0, decay(23, 0.015, 30, 1, 0.5)), np.zeros((2, 2))
    seeds = campaigns.examples(60, 150)
    for seed in range(seeds):
        found = modes_from_decay(record(clean, 1, seed), "T", start=1.01, mode_count=2)
        hits[0] += np.abs(found.natural_frequencies - [9, 23]) < found.frequency_half_widths
        hits[1] += np.abs(found.damping_ratios - [0.02, 0.015]) < found.damping_half_widths
    assert np.all(hits / seeds >= 0.90)
    assert np.all(hits / seeds <= 0.995)
