"""State of a motion at its start from given angles and speeds of nodes."""

from __future__ import annotations

import numpy as np

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.motion.motion_plant import MotionPlant
from torsionnet.motion.motion_start import MotionStart
from torsionnet.motion.state_layout import Layout


def start_state(plant: MotionPlant, at: Layout, start: MotionStart) -> FloatArray:
    """State z (N,) in SI units of given angles and speeds of nodes.

    Raises
    ------
    UsageError
        Unknown nodes, numbers that are not finite, or nodes that rigid connections tie to others with another motion.
    """
    assembly = plant.assembly
    for name in (*start.angles, *start.speeds):
        if name not in assembly.node_index:
            raise UsageError(f'no node is named "{name}"{did_you_mean(name, assembly.nodes)}')
    z = np.zeros(at.size)
    z[at.one] = 1.0
    for place, given in ((at.q, start.angles), (at.v, start.speeds)):
        if not given:
            continue
        # nodes not named follow those tied to them; free ones stand
        named = [assembly.node_index[name] for name in given]
        wanted = np.array([_number(name, value) for name, value in given.items()])
        rows = assembly.T[named]
        found = np.linalg.lstsq(rows, wanted, rcond=None)[0]
        if np.abs(rows @ found - wanted).max() > 1e-9 * np.abs(wanted).max(initial=1e-300):
            names = ", ".join(given)
            raise UsageError(f"{names} cannot start with these angles or speeds: rigid connections tie them")
        z[place] = found
    return z


def _number(name: str, value: float) -> float:
    if not (isinstance(value, int | float | np.number) and np.isfinite(value)):
        raise UsageError(f"a motion starts with finite angles in rad and speeds in rad/s; that of {name} is {value}")
    return float(value)


def relative_state(plant: MotionPlant, at: Layout, z: FloatArray) -> FloatArray:
    """State z with coordinates counted from those that turn with the whole, from one with all angles."""
    found = z.copy()
    for pivot, column in plant.turning:
        for place in (at.q, at.v):
            others = np.where(np.arange(at.n_q) == pivot, 0.0, column)
            found[place] -= others * z[place][pivot]
    return found


def absolute_rates(plant: MotionPlant, rates: FloatArray) -> FloatArray:
    """Rates (n_q,) of coordinates from those counted from what turns with the whole."""
    found = rates.copy()
    for pivot, column in plant.turning:
        found += np.where(np.arange(len(rates)) == pivot, 0.0, column) * rates[pivot]
    return found
