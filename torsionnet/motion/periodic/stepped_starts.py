"""Starts of branches from motions simulated over time: the last period of a simulation, then harmonic balance."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.motion.contact_states import MotionStart
from torsionnet.motion.periodic.harmonic_balance import harmonics_of, over_time
from torsionnet.motion.periodic.periodic_problem import PeriodicMotion, PeriodicProblem
from torsionnet.motion.simulation import simulate_torques

PERIODS = 50
"""Periods of the torques that are simulated."""
SAMPLES = 64
"""Samples in a period."""
REPEATS = 0.05
"""Share of a swing by which a motion may change within a period that counts as its own."""
TAKEN = 16
"""Harmonics of a period of the torques that are taken from a simulation."""


def from_simulation(
    problem: PeriodicProblem, parameter: float, state: str | MotionStart, most: int
) -> Iterator[PeriodicMotion]:
    """Yield the motion to which a simulation from a state comes at a parameter, of up to ``most`` periods of torques.

    None where it does not repeat after all periods.
    """
    angles = _simulated(problem, parameter, state)
    assembly = problem.plant.assembly
    q = np.linalg.lstsq(assembly.T, angles, rcond=None)[0]
    twists = problem.plant.rows @ q
    count = problem.subharmonics
    while count <= most:
        last, before = twists[:, -count * SAMPLES :], twists[:, -2 * count * SAMPLES : -count * SAMPLES]
        swing = np.ptp(last, axis=1)
        if (np.abs(last - before).max(axis=1) <= REPEATS * np.maximum(swing, REPEATS * swing.max())).all():
            own = problem.with_subharmonics(count)
            motion = own.solve(parameter, _motions(own, parameter, last))
            if motion is not None:
                yield motion
            return
        count *= 2


def _simulated(problem: PeriodicProblem, parameter: float, state: str | MotionStart) -> FloatArray:
    """Angles (n_nodes, n) in rad over the time simulated."""
    plant = problem.plant
    omega, loads = problem.drive.omega(parameter), problem.drive.loads(parameter)
    period = max(SAMPLES, 2 ** math.ceil(math.log2(8 * len(loads))))
    n = SAMPLES * (period // SAMPLES)
    torques = {
        channel.of if channel.against is None else f"{channel.of}-{channel.against}": np.append(
            np.tile(over_time(loads[:, place], n), PERIODS), over_time(loads[:, place], n)[:1]
        )
        for place, channel in enumerate(plant.inputs)
    }
    nodes = list(plant.assembly.nodes)
    rate = n * omega / (2 * math.pi)
    record = simulate_torques(plant.drivetrain, nodes, torques, rate, state)
    return np.array([record[node].values[: -1 : n // SAMPLES] for node in nodes])


def _motions(problem: PeriodicProblem, parameter: float, twists: FloatArray) -> ComplexArray:
    """Harmonics (n, n_laws) of x = g + T/r of twists (n_laws, n) over one period of the motion."""
    harmonics = TAKEN * problem.subharmonics
    g = np.stack([harmonics_of(samples_of, harmonics) for samples_of in twists], axis=1)
    balance = problem.balance(parameter, harmonics)
    s = 1j * balance.omega * np.arange(harmonics + 1)[:, None]
    g = g * s ** np.array([force.power for force in problem.forces])
    yielding = np.array([force.yielding for force in problem.forces])
    if not yielding.any():
        return np.asarray(g)
    # G tau = driven - g and tau = T (1 + k_0/r) - k_0 x = T - k_0 g
    tau = np.stack(
        [np.linalg.lstsq(G, left, rcond=1e-9)[0] for G, left in zip(balance.G, balance.driven - g, strict=True)]
    )
    return np.asarray(g + (tau + problem.plant.references * g) * yielding)
