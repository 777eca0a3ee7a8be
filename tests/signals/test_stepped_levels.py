"""Stepped sines at several amplitudes: stiffness and loss over amplitude against closed forms."""

import math

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.signals import Recording, Signal

RATE = 1000.0
LEVELS = (0.02, 0.05, 0.2)
SLIDER = [(412.462578, 0.205795), (264.223095, 0.282703), (208.589165, 0.113942)]
"""k' and eta_1 of a slider 300 N m/rad, 4 N m beside 200 N m/rad at the levels."""
RIG = """torsionnet: 1
elements:
  J: {type: inertia, node: a, inertia: 0.05}
  shaft: {type: spring, nodes: [a, ground], stages: [{stiffness: 460, to: 0.12 rad}, {stiffness: 1500}], damping: 0.5}
"""


def staircase(levels=LEVELS, frequency=4.0, cycles=12, mean=0.0):
    t = np.arange(0, cycles / frequency * len(levels), 1 / RATE)
    level = np.array(levels)[np.minimum((t * frequency // cycles).astype(int), len(levels) - 1)]
    return t, mean + level * np.sin(2 * np.pi * frequency * t)


def slider(twist, stiffness=300.0, most=4.0):
    """Torque of Coulomb's friction behind a spring along a twist, sample by sample."""
    torque, at = np.empty_like(twist), 0.0
    for place, step in enumerate(np.diff(twist, prepend=0.0)):
        at = min(most, max(-most, at + stiffness * step))
        torque[place] = at
    return torque


def record(torque, twist):
    return Recording((Signal("T", "torque", torque), Signal("gamma", "angle", twist)), RATE)


def test_a_slider_beside_a_spring_over_amplitude():
    """Four hundredths of a percent is what 250 samples of a cycle leave of the corners."""
    _, twist = staircase()
    found = record(slider(twist) + 200 * twist, twist).stepped_stiffness("T", "gamma")
    assert found.amplitudes == pytest.approx(LEVELS, rel=1e-6)
    assert found.frequencies == pytest.approx([4.0] * 3, rel=1e-6)
    assert found.stiffness.real == pytest.approx([real for real, _ in SLIDER], rel=2e-3)
    assert found.loss_factors == pytest.approx([eta for _, eta in SLIDER], rel=5e-3)


def test_noise_moves_it_as_little_as_noise_should():
    _, twist = staircase()
    rng = np.random.default_rng(60)
    torque = slider(twist) + 200 * twist + rng.normal(0, 0.1, len(twist))
    found = record(torque, twist + rng.normal(0, 5e-5, len(twist))).stepped_stiffness("T", "gamma")
    assert found.stiffness.real == pytest.approx([real for real, _ in SLIDER], rel=4e-3)
    assert found.amplitudes == pytest.approx(LEVELS, rel=2e-3)


def test_frequencies_may_step_too_and_means_are_read():
    pieces, start = [], 0
    for frequency, level in ((3.0, 0.03), (7.0, 0.03), (7.0, 0.1)):
        t = np.arange(0, 15 / frequency, 1 / RATE)
        pieces.append(0.3 + level * np.sin(2 * np.pi * frequency * t))
        start += len(t)
    twist = np.concatenate(pieces)
    found = record(460 * twist + 5, twist).stepped_stiffness("T", "gamma")
    assert found.frequencies == pytest.approx([3, 7, 7], rel=1e-4)
    assert found.mean_torques == pytest.approx([460 * 0.3 + 5] * 3, rel=1e-4)
    assert found.stiffness == pytest.approx([460] * 3, rel=1e-6)
    assert found.backbone(0.05) == pytest.approx([math.sqrt(460 / 0.05) / (2 * math.pi)] * 3, rel=1e-6)


def test_over_a_model_with_the_same_law():
    """Stages and a damper from the formula of the law, sampled: k' within .1 %."""
    t, twist = staircase((0.05, 0.2, 0.5))
    rate = np.gradient(twist, 1 / RATE)
    torque = 460 * twist + 1040 * np.sign(twist) * np.maximum(np.abs(twist) - 0.12, 0) + 0.5 * rate
    found = record(torque, twist).stepped_stiffness("T", "gamma")
    rig = tn.loads(RIG)
    np.testing.assert_allclose(found.stiffness, found.model_stiffness(rig, "shaft"), rtol=2e-3)
    assert found.model_stiffness(rig, "shaft").real[1] == pytest.approx(756.147259, rel=1e-5)
    rows = found.compared(rig, "shaft").rows
    assert [abs(row[5]) < 0.2 for row in rows] == [True] * 3
    assert len(t) == len(twist)


@pytest.mark.parametrize(
    ("signals", "kind"),
    [
        ({"T": "angle", "gamma": "angle"}, "unfit-channel"),
        ({"T": "torque", "gamma": "torque"}, "unfit-channel"),
    ],
)
def test_signals_that_are_no_torque_and_twist_are_refused(signals, kind):
    _, twist = staircase()
    given = Recording(tuple(Signal(name, quantity, twist) for name, quantity in signals.items()), RATE)
    with pytest.raises(tn.UsageError, match=kind):
        given.stepped_stiffness("T", "gamma")


def test_tops_that_friction_flattens_are_steps_all_the_same():
    """Noise places their tops anywhere, and a ripple beside them turns back; they rise through their middle in time."""
    t = np.arange(0, 12, 1 / RATE)
    phase = 2 * np.pi * 2.0 * t
    size = np.where(t < 6, 0.02, 0.2)
    shape = np.clip(1.1 * np.sin(phase), -1, 1) + np.where(t < 6, 0, 0.08) * np.sin(7 * phase)
    noise = np.random.default_rng(1).normal(0, 2e-5, len(t))
    found = record(460 * size * shape, size * shape + noise).stepped_stiffness("T", "gamma")
    assert found.frequencies == pytest.approx([2, 2], rel=1e-3)
    assert found.real == pytest.approx([460, 460], rel=1e-3)
    assert any("suppose a sine" in str(note) for note in found.notes)


def test_a_record_without_steps_and_an_unknown_element_are_refused():
    t = np.arange(0, 3, 1 / RATE)
    sweep = 0.1 * np.sin(2 * np.pi * (1 + 4 * t) * t)
    with pytest.raises(tn.UsageError, match="too-short"):
        record(460 * sweep, sweep).stepped_stiffness("T", "gamma")
    _, twist = staircase()
    with pytest.raises(tn.UsageError, match="unknown-element"):
        record(twist, twist).stepped_stiffness("T", "gamma").model_stiffness(tn.loads(RIG), "shift")
