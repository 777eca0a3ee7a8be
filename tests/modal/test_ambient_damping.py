"""Natural frequency and damping from ambient records, with pyOMA_2 where it is installed, and the refusals without."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from support import campaigns

from torsionnet.base.errors import MissingExtraError, SolveError, UsageError
from torsionnet.modal import modes_from_ambient
from torsionnet.modal.operational.ambient_modes import _remark
from torsionnet.signals.recording import Recording, Signal

RATE = 100


def ambient(seed, *, sine=0.0, count=60_000):
    """Velocity of two modes, 8 Hz (2 %) and 20 Hz (1 %), under white noise by their exact discrete state equations."""
    from scipy.linalg import expm
    from scipy.signal import lfilter

    rng, total = np.random.default_rng(seed), np.zeros(count)
    for f, zeta, share in ((8, 0.02, 1.0), (20, 0.01, 0.5)):
        w = 2 * np.pi * f
        a = np.array([[0, 1], [-(w**2), -2 * zeta * w]])
        block = expm(np.block([[-a, np.diag([0.0, 1.0])], [np.zeros((2, 2)), a.T]]) / RATE)
        step = expm(a / RATE)
        spread = np.linalg.cholesky(block[2:, 2:].T @ block[:2, 2:])
        poles, shapes = np.linalg.eig(step)
        pushes = np.linalg.solve(shapes, spread @ rng.standard_normal((2, count)))
        states = [lfilter([1], [1, -pole], push.astype(complex)) for pole, push in zip(poles, pushes, strict=True)]
        total += share * np.real(shapes[1] @ np.array(states))
    values = total / total.std() + 0.1 * rng.standard_normal(count)
    values += sine * np.sin(2 * np.pi * 13 * np.arange(count) / RATE)
    return Recording((Signal("T", "torque", values),), RATE)


def test_modes_of_noise_and_an_order_among_them():
    pytest.importorskip("pyoma2")
    found = modes_from_ambient(ambient(0, sine=0.5), ["T"], up_to=30, orders=[1], speeds=(81, 82))
    assert found.natural_frequencies == pytest.approx([8, 13, 20], rel=0.005)
    assert found.damping_ratios[[0, 2]] == pytest.approx([0.02, 0.01], rel=0.3)
    assert np.all(np.abs(found.damping_ratios - [0.02, 0, 0.01]) < 2 * found.damping_half_widths)
    assert "at order 1" in found.mode_remarks[1]
    assert "as a sine" in found.mode_remarks[1]
    assert not found.mode_remarks[0]
    assert any(note.startswith("warning: some of these are orders") for note in map(str, found.notes))
    assert np.geterr()["divide"] == "warn"  # the package turns numpy's warnings off


def test_a_remark_says_by_itself_whether_a_pole_may_be_an_order():
    rows, step = ambient(0, sine=0.5)["T"].values[None, :6000], 1 / RATE
    near = [_remark(2j * np.pi * f, rows, step, (1,), (81, 82), 60) for f in (8, 13)]
    assert [may_be_order for _, may_be_order in near] == [False, True]
    assert _remark(2j * np.pi * 8, rows, step, (1,), None, 1.0) == ("only 8 cycles: record longer", False)


@pytest.mark.slow
def test_intervals_of_ambient_modes_hold_the_truth():
    pytest.importorskip("pyoma2")
    hits, seeds = np.zeros(4), campaigns.examples(12, 60)
    for seed in range(seeds):
        found = modes_from_ambient(ambient(seed), ["T"], up_to=30)
        near = [int(np.abs(found.natural_frequencies - f).argmin()) for f in (8, 20)]
        hits[:2] += np.abs(found.natural_frequencies[near] - [8, 20]) < found.frequency_half_widths[near]
        hits[2:] += np.abs(found.damping_ratios[near] - [0.02, 0.01]) < found.damping_half_widths[near]
    assert np.all(hits / seeds >= 0.85)


def test_missing_package_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyoma2", None)
    monkeypatch.setitem(sys.modules, "pyoma2.functions.ssi", None)
    with pytest.raises(MissingExtraError, match=r'pip install "torsionnet\[ambient\]"'):
        modes_from_ambient(ambient(0, count=5000), ["T"], up_to=30)


def test_wrong_input_is_named():
    record = ambient(0, count=5000)
    with pytest.raises(UsageError, match=r"(?s)50.*out-of-range"):
        modes_from_ambient(record, ["T"], up_to=60)
    with pytest.raises(UsageError, match="at least one channel"):
        modes_from_ambient(record, [], up_to=30)
    pytest.importorskip("pyoma2")
    with pytest.raises(SolveError, match=r"(?s)20.*30.*too-short"):
        modes_from_ambient(ambient(0, count=2000), ["T"], up_to=30)
