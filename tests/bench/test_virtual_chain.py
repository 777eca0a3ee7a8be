"""From torque to estimated frequency response through simulated motion, an encoder's steps and a noisy torque meter."""

from dataclasses import replace

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.signals import PAPER, LinearChirp, Recording, difference, estimate, resolution_limit

RATE = 10e3
STEP = 2 * np.pi / 4096  # 1024 lines in quadrature
NOISE = 0.23  # N m, 0.1 % of 230


def bench(rig):
    """Torque with second and third harmonics on the motor; angle in encoder steps, torque with noise."""
    chirp = LinearChirp(start=0.1, stop=80, duration=100, amplitude=15)
    phase = 2 * np.pi * np.cumsum(chirp.frequency(chirp.time(RATE))) / RATE
    torque = chirp.samples(RATE) + 0.3 * np.sin(2 * phase) + 0.2 * np.sin(3 * phase)
    record = rig.simulate(["theta_1", "T_T"], {"T_M": torque}, RATE)
    angle, measured = record["theta_1"], record["T_T"]
    rng = np.random.default_rng(0)
    return record.with_signals(
        replace(angle, values=STEP * np.round(angle.values / STEP)),
        replace(measured, values=measured.values + NOISE * rng.standard_normal(len(record))),
    )


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("name", "configuration", "peak"),
    [
        ("dmf_rig", "", 8.1),
        ("amt_rig", "II", 3.7),
        ("amt_rig", "III", 5.0),
        ("amt_rig", "IV", 6.0),
        ("amt_rig", "V", 6.7),
    ],
)
def test_estimate_and_model_agree(name, configuration, peak):
    rig = tn.load(name).configured(configuration)
    record: Recording = bench(rig)
    H = estimate(record, "theta_1", "T_T", settings=PAPER)
    model = rig.frequency_response("theta_1", "T_T", H.frequencies)
    torque = 15 * np.abs(rig.frequency_response("T_T", "T_M", H.frequencies).values[:, 0, 0])
    limit = resolution_limit(H.frequencies, torque * model.magnitude[:, 0, 0], STEP, 4)
    assert 12 < limit < 30
    band = (H.frequencies >= 0.5) & (H.frequencies <= limit)
    apart = difference(H, model)
    assert np.abs(apart.decibels[band]).max() < 0.6
    assert np.abs(apart.degrees[band]).max() < 6
    assert H.frequencies[band][H.magnitude[band, 0, 0].argmax()] == pytest.approx(peak, abs=0.5)
    assert H.coherence[band].min() > 0.9
