"""Speed over time of a drivetrain that coasts down, braked by the load of its model."""

from __future__ import annotations

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.bench.plan.bench_motions import COAST_DOWN_POINTS
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.load.external_torques import reference_node
from torsionnet.signals.recording import FloatArray

LEAST_DRAG = 1e-9
"""Least torque that brakes, over the largest along the speed: below it the speed would never fall."""


def coast_down(
    drivetrain: Drivetrain, reference: str, start: float, stop: float
) -> tuple[FloatArray, FloatArray, tuple[str, ...]]:
    """Times (n,) in s and speeds (n,) in rad/s of the reference shaft while the load brakes it, and notes.

    All inertias that turn with the reference store their energy, sum over nodes of J r^2 w^2/2 with the ratio r, and
    what the load absorbs at each speed takes it: dw/dt = -P(w)/(J w).

    Raises
    ------
    UsageError
        The load absorbs nothing at some speed on the way.
    """
    inertia = turning_inertia(drivetrain, reference)
    speeds = np.linspace(start, stop, COAST_DOWN_POINTS + 1)
    drag = np.array([absorbed_torque(drivetrain, reference, speed) for speed in speeds.tolist()])
    if (drag <= LEAST_DRAG * drag.max(initial=0.0)).any():
        raise UsageError("the load of the model absorbs nothing at some of these speeds; give a time_constant")
    per_speed = inertia / drag
    steps = -np.diff(speeds) * (per_speed[1:] + per_speed[:-1]) / 2
    times = np.concatenate([[0.0], np.cumsum(steps)])
    note = f"braked by the load, {drag[0]:.4g} N*m at first, with {inertia:.4g} kg*m^2, both at {reference}"
    return times, speeds, (note,)


def turning_inertia(drivetrain: Drivetrain, reference: str) -> float:
    """Inertia in kg m^2 of all that turns with a node, as it is felt there."""
    laws = drivetrain.assembly.laws
    ratios: dict[str, float] = {}
    total = 0.0
    for law in laws:
        if not law.inertia:
            continue
        turning = 0.0
        for node, weight in law.row.items():
            if node not in ratios:
                ratios[node] = _ratio(drivetrain, node, reference)
            turning += float(weight) * ratios[node]
        total += float(law.inertia) * turning**2
    return total


def _ratio(drivetrain: Drivetrain, node: str, reference: str) -> float:
    try:
        return drivetrain.ratio_between(node, reference)
    except UsageError:
        return 0.0  # what turns by itself does not slow down with the shaft


def absorbed_torque(drivetrain: Drivetrain, reference: str, speed: float) -> float:
    """Torque in N m at a node, turning at a speed in rad/s, of what the load of the model absorbs there."""
    definition = drivetrain.definition
    own = reference_node(definition)
    scale = 1.0 if own == reference else abs(drivetrain.ratio_between(own, reference))
    torques = drivetrain.external_torques.at(speed * scale)
    ratios = {node: drivetrain.ratio_between(node, reference) for node in torques if node in drivetrain.nodes}
    return -sum(min(torques[node] * ratio, 0.0) for node, ratio in ratios.items())
