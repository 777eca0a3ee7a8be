"""Motions of random plants with two and three rigid frictions, against exponentials and enumerated states."""

import numpy as np
import pytest
from support import campaigns
from support.friction_plants import RubbingPlant, rubbing_motion, rubbing_plant

import torsionnet as tn
from torsionnet.motion.contact_states import MotionStart
from torsionnet.motion.marching import DEGREE, first_root

SECONDS = 0.2


def simulated(plant, rate, seconds, beside=()):
    """Angles (n_t, n) in rad of a plant sampled at a rate in Hz."""
    nodes = [f"n{i}" for i in range(len(plant.inertias))]
    torques = {}
    for i, mean, rise, amplitude, omega, phase in plant.loads:
        wave = {"mean": mean, "amplitude": amplitude, "frequency": omega / (2 * np.pi), "phase": f"{phase!r} rad"}
        torques[f"n{i}"] = wave if amplitude else {"0 s": mean, "100 s": mean + 100 * rise}
    record = plant.drivetrain(beside).simulate(
        nodes,
        scenario={"type": "torques", "duration": seconds, "torque": torques},
        initial_state=MotionStart(speeds=dict(zip(nodes, plant.speeds, strict=True))),
        sampling_rate=rate,
    )
    return np.array([record[node].values for node in nodes]).T


def compared(plant, rates, seconds=SECONDS, beside=()):
    """Check samples at all rates against the reference, and return its events."""
    common = np.arange(round(100 * seconds) + 1) / 100
    wanted, events = rubbing_motion(plant, common)
    for rate in rates:
        apart = np.abs(simulated(plant, rate, seconds, beside)[:: round(rate / 100)] - wanted).max()
        assert apart < 1e-10 * np.abs(wanted).max()
    return events


@pytest.mark.parametrize(("frictions", "seed"), [(2, 19), (2, 29), (3, 12), (3, 14)])
def test_few_seeds(frictions, seed):
    assert len(compared(rubbing_plant(seed, frictions), (300.0, 1000.0, 7000.0))) > 3


@pytest.mark.slow
@pytest.mark.parametrize("frictions", [2, 3])
def test_many_seeds(frictions):
    events = [compared(rubbing_plant(seed, frictions), (500.0, 20e3)) for seed in range(campaigns.examples(12, 250))]
    assert sum(map(len, events)) > 5 * len(events)


def test_slip_that_begins_without_acceleration():
    """A light disc lets go of a heavy one: both turn at 5 rad/s, and their slip begins with an acceleration of zero."""
    plant = RubbingPlant(
        [0.81, 0.88, 1.7, 2.0, 0.046, 0.41],
        [(1, 2, 2.3e4, 0.0), (2, 3, 5.6e4, 14.0), (4, 5, 2.6e3, 0.77)],
        [(0, 1, 310.0, 310.0), (3, 4, 12.0, 12.0)],
        [(0, -41.0, 0.0, 270.0, 8 * np.pi, 0.0), (3, 0.0, -290.0, 0.0, 1.0, 0.0)],
        [-2.3, 4.5, 3.1, 0.0, 0.0, 1.7],
    )
    assert len(compared(plant, (200.0, 1000.0, 9000.0), 0.3)) > 5


@pytest.mark.parametrize(
    ("start", "rise", "expected"),
    [(-5.42e-18, 1.4e-3, -1.0), (-5.42e-18, -1.4e-3, 0.0), (-1e-9, 1e-3, 0.0), (-5.42e-18, 1e-16, 0.0)],
)
def test_guard_that_begins_below_zero_by_rounding(start, rise, expected):
    """One that rises above zero at once has not fallen; one that falls, or was far below, or stays, has."""
    course = [start, rise, *[0.0] * (DEGREE - 1)]
    assert first_root(course, 0.25, 5.4e-18) == expected


def test_guard_that_rises_from_below_and_falls_again():
    """0.1 s - s^2 from -5e-18 on falls below zero at 0.1, not where it begins."""
    assert first_root([-5e-18, 0.1, -1.0, *[0.0] * (DEGREE - 2)], 0.25, 4e-18) == pytest.approx(0.1, rel=1e-12)


@pytest.mark.parametrize(("frictions", "beside"), [(2, (1.4,)), (3, (2.0, 1.2))])
def test_weakest_of_frictions_in_series_slips(frictions, beside):
    """Nodes between them have neither inertia nor a speed at the start that belongs to the motion."""
    for seed in range(campaigns.examples(3, 60)):
        compared(rubbing_plant(seed, frictions), (1000.0,), 0.1, beside)


def in_series(*more):
    discs = [tn.Inertia("A", node="a", inertia=1), tn.Inertia("B", node="b", inertia=2)]
    rubs = [tn.Friction("f10", nodes=("a", "m"), torque=10), tn.Friction("f7", nodes=("m", "b"), torque=7)]
    return tn.Drivetrain("series", [*discs, *rubs, *more])


@pytest.mark.parametrize("more", [(), (tn.Spring("soft", nodes=("b", "ground"), stiffness=0, cubic="1e-9 N*m/rad^3"),)])
@pytest.mark.parametrize("speeds", [{}, {"a": 3.0}, {"a": 3.0, "m": -50.0}, {"a": 3.0, "m": 90.0}])
def test_two_frictions_in_series_carry_the_smaller_torque(speeds, more):
    """30 N m turn 1 kg m^2 against 7 N m, which turn 2 kg m^2, whatever the speed of what has no inertia."""
    outputs = ["a", "b", "velocity(m)", "torque(f10)", "torque(f7)"]
    record = in_series(*more).simulate(
        outputs, {"a": np.full(51, 30.0)}, 100.0, initial_state=MotionStart(speeds=speeds)
    )
    first, time = speeds.get("a", 0.0), 0.5
    expected = [first * time + 23 * time**2 / 2, 3.5 * time**2 / 2, first + 23 * time, 7.0, 7.0]
    assert [record[one].values[-1] for one in outputs] == pytest.approx(expected, rel=1e-9)


def test_load_on_a_node_between_frictions():
    """16 N m turn it over 10 N m of the housing, and 6 N m turn the disc with it; more than 17 N m turn it alone."""
    rubs = [tn.Friction("f10", nodes=("m", "ground"), torque=10), tn.Friction("f7", nodes=("m", "b"), torque=7)]
    plant = tn.Drivetrain("loaded", [tn.Inertia("B", node="b", inertia=2), *rubs])
    record = plant.simulate(["m", "b"], {"m": np.full(51, 16.0)}, 100.0)
    assert [record[one].values[-1] for one in "mb"] == pytest.approx([3 / 8, 3 / 8], rel=1e-12)
    with pytest.raises(tn.UsageError, match="indeterminate-motion"):
        plant.simulate(["m", "b"], {"m": np.full(51, 18.0)}, 100.0)
