"""Modes from estimates that keep their record, against the eigenvalues of plants simulated exactly in state space."""

from dataclasses import replace

import numpy as np
import pytest
from support import campaigns
from support.modal_cases import pole

from torsionnet.modal import Settings, identify_modes
from torsionnet.modal.selection import merged
from torsionnet.signals import Welch, estimate
from torsionnet.signals.recording import Recording, Signal

RATE, FINE = 200.0, 10
TWO_INERTIAS = (np.diag([0.23, 0.13]), np.array([[4.3, -4], [-4, 8.2]]), np.array([[460, -460], [-460, 654.0]]))
"""Masses, dampers and springs of a plant with 3.408 Hz at 23.0 % and 12.84 Hz at 44.6 %."""


def chain(M, C, K):
    """State matrix of M q'' + C q' + K q = T at the first inertia, and what T does to the state."""
    n = len(M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    return A, np.concatenate([np.zeros(n), np.linalg.inv(M)[:, 0]])


def modal(*modes):
    """State matrix of modes (Hz, damping ratio) that a torque drives alike, read as the sum of all."""
    n, poles = len(modes), [pole(*mode) for mode in modes]
    K, C = np.diag([abs(value) ** 2 for value in poles]), np.diag([-2 * value.real for value in poles])
    return np.block([[np.zeros((n, n)), np.eye(n)], [-K, -C]]), np.concatenate([np.zeros(n), np.sqrt(np.diag(K))])


def simulated(plant, duration, *, noise=0.0, torque_noise=0.0, colour=0.0, excitation="sweep", seed=0, output="angle"):
    """Record of a plant at rest before, its torque held over a tenth of a sample: exact at every fine step."""
    from scipy import signal

    t, rng = np.arange(round(duration * RATE * FINE)) / (RATE * FINE), np.random.default_rng(seed)
    if excitation == "sweep":
        torque = 5 * signal.chirp(t, 0.3, duration, 30)
    else:
        low = signal.butter(10, 40, fs=RATE * FINE, output="sos")
        torque = signal.sosfilt(low, 20 * rng.standard_normal(len(t)))
    A, B = plant
    values, vectors = np.linalg.eig(A)
    n, parts = len(B) // 2, np.linalg.solve(vectors, B)
    shown = (vectors[n:] if output == "velocity" else vectors[:n]).sum(axis=0)
    motion = np.zeros(len(t), dtype=complex)
    for value, part, seen in zip(values, parts, shown, strict=True):
        step = np.exp(value / (RATE * FINE))
        motion += signal.lfilter([0, seen * part * (step - 1) / value], [1, -step], torque)
    angle = motion.real[::FINE]
    white = rng.standard_normal(len(angle) + 500)
    coloured = signal.lfilter([np.sqrt(1 - colour**2)], [1, -colour], white)[500:]
    read = torque[::FINE] + torque_noise * torque.std() * rng.standard_normal(len(angle))
    signals = (Signal("T", "torque", read), Signal("y", output, angle + noise * angle.std() * coloured))
    return Recording(signals, RATE)


def modes_of(record, seconds, band=(0.5, 20), estimator="H1", **more):
    return identify_modes(estimate(record, "y", "T", estimator, Welch(seconds=seconds)).between(*band), **more)


def assert_modes(found, A, sigmas=4.0):
    """Each pole of the plant in the band once, within its standard errors, and no other."""
    wanted = np.linalg.eigvals(A)
    wanted = sorted(wanted[wanted.imag > 0], key=abs)
    assert len(found) == len(wanted)
    frequencies, dampings = np.abs(wanted) / 2 / np.pi, [-value.real / abs(value) for value in wanted]
    assert np.all(np.abs(found.natural_frequencies - frequencies) < sigmas * found.frequency_errors)
    assert np.all(np.abs(found.damping_ratios - dampings) < sigmas * found.damping_errors)


class TestWindowsDoNotMatter:
    @pytest.mark.parametrize(("seconds", "duration"), [(2, 20), pytest.param(60, 120, marks=pytest.mark.slow)])
    def test_two_strongly_damped_modes(self, seconds, duration):
        plant = chain(*TWO_INERTIAS)
        found = modes_of(simulated(plant, duration, noise=1e-5), seconds)
        assert_modes(found, plant[0])
        assert found.frequency_errors[0] < 1e-4
        assert found.by_record

    def test_one_light_mode_in_short_windows(self):
        """Windows of 2 s of a peak 0.6 Hz wide give two modes at 2.7 %, if they are fitted as they are."""
        plant = modal((15.915, 0.02))
        found = modes_of(simulated(plant, 60, noise=1e-3, excitation="noise"), 2)
        assert_modes(found, plant[0])
        assert found.damping_errors[0] < 1e-4
        assert not any("half-power bandwidth" in note for note in found.notes)

    @pytest.mark.slow
    @pytest.mark.parametrize("excitation", ["sweep", pytest.param("noise", marks=pytest.mark.nightly)])
    def test_windows_shorter_than_the_modes_ring(self, excitation):
        """Five modes in twenty lines, which the estimate cannot tell apart; noise that falls with frequency."""
        plant = modal((1.6, 0.004), (3.2, 0.08), (4.3, 0.07), (5.8, 0.06), (12.8, 0.017))
        found = modes_of(simulated(plant, 120, noise=1e-4, colour=0.9, excitation=excitation), 1)
        assert_modes(found, plant[0])

    @pytest.mark.slow
    def test_speed_instead_of_angle_and_what_is_beyond_the_band(self):
        plant = modal((4, 0.05), (9, 0.01), (24, 0.03))
        found = modes_of(simulated(plant, 60, noise=1e-4, output="velocity"), 2)
        near, far = plant[0], np.abs(found.outside_poles) / 2 / np.pi
        assert_modes(found, near[np.ix_([0, 1, 3, 4], [0, 1, 3, 4])])
        assert far[np.argmin(np.abs(far - 24))] == pytest.approx(24, rel=0.02)
        s = 2j * np.pi * found.frequencies
        pairs = [(2 * np.pi * f, zeta) for f, zeta in ((4, 0.05), (9, 0.01), (24, 0.03))]
        held = np.exp(-s / (2 * RATE * FINE))  # the torque is held over a fine step
        exact = held * sum(s * w / (s**2 + 2 * zeta * w * s + w**2) for w, zeta in pairs)
        np.testing.assert_allclose(found.synthesised.values[:, 0, 0], exact, atol=3e-3 * np.abs(exact).max())

    def test_a_record_cut_out_of_a_motion_is_as_good(self):
        """Free decays at both ends are unknowns of the fit: a mode of 0.2 % rings all the time."""
        plant = modal((2.0, 0.002), (6.0, 0.1))
        whole = simulated(plant, 60, noise=1e-4, excitation="noise")
        cut = replace(whole, signals=tuple(replace(one, values=one.values[3000:9000]) for one in whole))
        assert_modes(modes_of(cut, 2), plant[0])

    def test_a_strongly_damped_mode_that_hides_behind_another(self):
        """Its share is 1 % and the noise as large: too little for the BIC, yet the damping of the other is 10 sigma off."""
        A, torque = modal((4, 0.2), (5.5, 0.45))
        record = simulated((A, torque * [1, 1, 1, 0.01]), 40, noise=0.01, excitation="noise")
        assert_modes(modes_of(record, 2), A)

    @pytest.mark.slow
    def test_standard_errors_are_those_of_many_records(self):
        plant = modal((3.4, 0.23), (12.8, 0.02))
        clean, rng = simulated(plant, 40), np.random.default_rng(1)
        size = 0.01 * clean["y"].values.std()
        scores = []
        for _ in range(campaigns.examples(6, 30)):
            noisy = clean["y"].values + size * rng.standard_normal(len(clean))
            found = modes_of(Recording((clean["T"], Signal("y", "angle", noisy)), RATE), 2)
            assert len(found) == 2
            scores += [*(found.natural_frequencies - [3.4, 12.8]) / found.frequency_errors]
            scores += [*(found.damping_ratios - [0.23, 0.02]) / found.damping_errors]
        assert np.sqrt(np.mean(np.square(scores))) == pytest.approx(1, abs=0.25)
        assert 0.9 <= np.mean(np.abs(scores) < 1.96) <= 0.99

    @pytest.mark.parametrize(
        ("excitation", "seed"),
        [("noise", 2), *(pytest.param("sweep", seed, marks=pytest.mark.slow) for seed in (1, 3))],
    )
    def test_noise_on_the_torque_is_large_at_a_narrow_peak(self, excitation, seed):
        """Taken as large as at the lines around, it gave errors three times too small and modes that are not there."""
        plant = modal((5, 0.005), (9, 0.4))
        record = simulated(plant, 60, torque_noise=0.01, excitation=excitation, seed=seed)
        assert_modes(modes_of(record, 5, estimator="H2"), plant[0])

    def test_a_steady_vibration_is_no_mode(self):
        """It came as a mode at 12.3 Hz with a damping ratio of 5e-9, give or take 4e-15."""
        plant = modal((4, 0.01), (14.6, 0.04))
        record = simulated(plant, 30, noise=1e-3, excitation="noise")
        tone = 2 * record["y"].values.std() * np.sin(2 * np.pi * 12.3 * np.arange(len(record)) / RATE)
        record = Recording((record["T"], replace(record["y"], values=record["y"].values + tone)), RATE)
        found = modes_of(record, 2)
        assert_modes(found, plant[0])
        assert [note for note in found.notes if "no mode: a vibration at 12.3 Hz that does not decay" in note]

    @pytest.mark.slow
    def test_poles_chosen_by_hand_stay_as_many(self):
        record = simulated(modal((4, 0.05), (9, 0.01)), 60, noise=1e-4)
        found = modes_of(record, 5, selection=[(4, 4.0)], settings=Settings("rational"))
        assert len(found) == 1
        assert found.by_record
        assert found.misfit.max() > 0.1


class TestWithoutTheRecord:
    def without(self, **changes):
        record = simulated(chain(*TWO_INERTIAS), 120, noise=1e-5)
        response = estimate(record, "y", "T", settings=Welch(seconds=2.0)).between(0.5, 20)
        estimation = replace(response.estimation, record=None, **changes)
        return identify_modes(replace(response, estimation=estimation))

    def test_errors_are_withheld_and_one_vibration_is_named(self):
        found = self.without()
        assert not found.by_record
        assert np.isnan([found.frequency_errors, found.damping_errors]).all()
        # A real pole may stand for what the windows add: where it lies is a matter of rounding.
        vibrations = found.natural_frequencies[np.array(found.kinds) == "oscillatory"]
        assert sum(abs(vibrations - 3.4) < 1) == 1
        assert any("its record is not at hand, and windows move poles" in note for note in found.notes)

    def test_poles_nearer_than_windows_tell_apart_are_one(self):
        """Windows of 2 s part peaks that lie several lines of 0.5 Hz apart; a real pole is no peak."""
        record = simulated(chain(*TWO_INERTIAS), 20)
        response = estimate(record, "y", "T", settings=Welch(seconds=2.0)).between(0.5, 20)
        poles = np.array([-6.2, -5 + 21j, -5.2 + 22j, -1 + 110j])
        np.testing.assert_allclose(merged(response, poles), [-6.2, -5.1 + 21.5j, -1 + 110j])

    def test_an_estimator_for_noise_on_the_input_has_no_errors(self):
        record = simulated(modal((4, 0.05)), 60, noise=1e-3)
        found = identify_modes(estimate(record, "y", "T", "Hv", Welch(seconds=5.0)).between(0.5, 20))
        assert np.isnan(found.frequency_errors).all()
        assert any("Hv supposes noise on the input" in note for note in found.notes)
