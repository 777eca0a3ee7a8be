"""Tracking of modes from a drivetrain to its variants in steps of parameter values, as short as needed."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.batch.batch_plan import batch_plan
from torsionnet.linear.batch.batched_modes import BatchedModes, batched_modes, single_modes
from torsionnet.linear.batch.mode_states import mode_states
from torsionnet.linear.batch.mode_steps import (
    MISSING_MODE,
    Columns,
    FollowedModes,
    assign_modes,
    successors,
    take_columns,
)

FIRST_STEP = 0.25
"""Share of the way to a variant that the first step takes, as shorter ones cost solutions and longer ones get
halved."""
SHORTEST_STEP = 2.0**-12
"""Shortest step as a share of the way to a variant, doubled whenever not even that tells modes apart, so that an
unclear way ends after a dozen."""


class ModeWalk:
    """Search for the modes of variants that continue those of a drivetrain, in steps along the way to each.

    Parameters
    ----------
    found : BatchedModes
    home : Followed
        m modes of the drivetrain itself (1, m).
    """

    def __init__(self, found: BatchedModes, home: FollowedModes) -> None:
        self._found, self._home = found, home
        self._plan = None if found.batch is None else batch_plan(found.drivetrain, found.values)

    def columns(self, places: NDArray[np.intp], arrived: FollowedModes) -> Columns:
        """Columns (n, m) of the variants' modes that continue those of the drivetrain.

        Parameters
        ----------
        places : (n,) index array
            The variants.
        arrived : Followed
            All their modes.
        """
        n, m = len(places), self._home.values.shape[1]
        known = FollowedModes(np.repeat(self._home.values, n, axis=0), np.repeat(self._home.states, n, axis=0))
        columns = np.full((n, m), MISSING_MODE)
        reached, step, shortest = np.zeros(n), np.full(n, FIRST_STEP), np.full(n, SHORTEST_STEP)
        walking = np.arange(n)
        while walking.size:
            goal = np.minimum(reached + step, 1.0)[walking]
            ahead = self._at(places[walking], goal, arrived.of(walking))
            there = ~np.isnan(ahead.values).all(axis=1)
            chosen, clear = successors(known.of(walking), ahead)
            forced = ~(clear & there) & (step[walking] <= shortest[walking])
            for number in np.flatnonzero(forced & there):
                chosen[number] = assign_modes(known.of(walking[[number]]), ahead.of(np.array([number])))[0]
            moved = (clear & there) | forced
            shortest[walking[forced]] *= 2.0
            step[walking] *= np.where(moved, 2.0, 0.5)
            reached[walking[moved]] = goal[moved]
            new = moved & there
            some = walking[new]
            columns[some] = chosen[new]
            known.values[some] = take_columns(ahead.values[new], chosen[new])
            known.states[some] = np.nan_to_num(take_columns(ahead.states[new], chosen[new][:, None, :]))
            walking = walking[reached[walking] < 1]
        return columns

    def _at(self, places: NDArray[np.intp], shares: FloatArray, arrived: FollowedModes) -> FollowedModes:
        """Eigenvalues (rad/s) and energy vectors of variants at ``shares`` (n,) of the ways to their parameter values.

        The share is 1 at the end.
        """
        ended = shares >= 1
        between = self._solved(places[~ended], shares[~ended])
        width = max(between.values.shape[1], arrived.values.shape[1])
        values = np.full((len(places), width), np.nan, dtype=complex)
        states = np.zeros((len(places), arrived.states.shape[1], width), dtype=complex)
        for part, mask in ((between, ~ended), (arrived.of(ended), ended)):
            values[mask, : part.values.shape[1]] = part.values
            states[mask, :, : part.values.shape[1]] = part.states
        return FollowedModes(values, states)

    def _solved(self, places: NDArray[np.intp], shares: FloatArray) -> FollowedModes:
        drivetrain = self._found.drivetrain
        ends = {name: column[places] for name, column in self._found.values.items()}
        values = _between(drivetrain.parameters, ends, shares)
        found = single_modes(drivetrain, values) if self._plan is None else batched_modes(self._plan.batch(values))
        return FollowedModes(found.eigenvalues, mode_states(found, np.arange(len(found))))


def _between(home: Mapping[str, float], ends: Mapping[str, FloatArray], shares: FloatArray) -> dict[str, FloatArray]:
    """Parameter values at ``shares`` of the ways, in equal factors where both ends have the same sign."""
    values = {}
    for name, end in ends.items():
        start = float(home[name])
        with np.errstate(all="ignore"):
            curved = start * (end / start) ** shares if start else end
        values[name] = np.where(start * end > 0, curved, start + shares * (end - start))
    return values
