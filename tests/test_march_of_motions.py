"""March of motions in contact states: samples seldom and often, compiled loops, steps of stiff and of massless parts."""

import sys

import numpy as np
import pytest

from tests.random_motion_plants import moving_plant
from torsionnet.response import MotionStart
from torsionnet.solve.motion import piece_system


def simulated(seed=3, rate=1000.0, seconds=0.2, most=3):
    plant = moving_plant(seed, most)
    nodes = [node for node in plant.drivetrain.nodes if node.startswith("n")]
    times = np.arange(round(seconds * rate) + 1) / rate
    outputs = [f"{what}({node})" for what in ("angle", "velocity", "acceleration") for node in nodes]
    start = MotionStart(speeds=plant.speeds)
    record = plant.drivetrain.simulate(outputs, plant.samples(times), rate, start=start)
    return np.array([record[name].values for name in outputs]), record


@pytest.mark.parametrize("seed", [3, 6])
def test_samples_seldom_and_often_read_one_motion(seed):
    """20 Hz take more steps to a sample than a block has, 125 Hz some, 4 kHz one."""
    often, record = simulated(seed, 4000.0)
    assert len(record.events) > 5
    for rate, each in ((20.0, 200), (125.0, 32)):
        seldom, _ = simulated(seed, rate)
        size = np.abs(often).max(axis=1, keepdims=True)
        assert (np.abs(seldom - often[:, ::each]) < 1e-10 * size).all()


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 3])
def test_compiled_loops_march_as_numpy_does(monkeypatch, seed):
    pytest.importorskip("numba")
    plain, record = simulated(seed, seconds=0.5, most=20)
    compiled = piece_system._compiled_march()
    assert compiled is not piece_system.marching.march
    marched = []
    monkeypatch.setattr(piece_system, "STEPS_WORTH_COMPILING", 0)
    monkeypatch.setattr(
        piece_system, "_compiled_march", lambda: lambda *given: (marched.append(1), compiled(*given))[1]
    )
    fast, same = simulated(seed, seconds=0.5, most=20)
    assert marched
    assert [event.what for event in same.events] == [event.what for event in record.events]
    assert np.abs(fast - plain).max() < 1e-9 * np.abs(plain).max()


@pytest.mark.parametrize("broken", [None, "another module"])
def test_motions_need_no_numba(monkeypatch, broken):
    plain, _ = simulated()
    monkeypatch.setattr(piece_system, "STEPS_WORTH_COMPILING", 0)
    monkeypatch.setitem(sys.modules, "numba", broken)
    monkeypatch.delitem(sys.modules, "torsionnet.solve.motion.compiled_march", raising=False)
    assert piece_system._compiled_march() is piece_system.marching.march
    assert np.array_equal(simulated()[0], plain)
