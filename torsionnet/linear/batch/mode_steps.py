"""Matching of the modes of a variant to those of a neighbouring one, by eigenvalue and common energy.

Modes are followed along their eigenvalues: neighbours whose states have most of their energy in common are the same
mode. Where two modes have changed places in between and could have met, a shorter step says whether they did.

Modes written as vectors of energy over the laws, and the energy that two modes have in common. The state of a mode has
for every law the velocity times the root of its inertia and the twist times the root of its stiffness: the square of
its length is the energy of the vibration. States of different modes of an undamped drivetrain are orthogonal, whatever
inertias and stiffnesses are, which angles at nodes are not; and two real poles that share a shape differ in velocity
over twist.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import Assembly, ComplexArray, FloatArray, RowSystem
from torsionnet.linear.batch.batch_plan import batch_plan
from torsionnet.linear.batch.batched_modes import BatchedModes, batched_modes, single_modes, stacked_coefficients
from torsionnet.linear.modes.mode_shapes import EQUAL_EIGENVALUES
from torsionnet.model.element_base.dynamic_stiffness import ComplexStiffness

# Modes written as vectors of energy over the laws, and the energy that two modes have in common.


def mode_states(batched: BatchedModes, places: NDArray[np.intp]) -> ComplexArray:
    """Modes as vectors of energy over the laws, of length 1, shape (n, n_states, n_modes).

    They are 0 for rigid bodies and missing modes.

    Variants whose laws are not those of the drivetrain itself, one to one, have states of zeros.
    """
    assembly = batched.drivetrain.assembly
    n_laws, n_modes = len(assembly.kinematics.laws), batched.eigenvalues.shape[1]
    states = np.zeros((len(places), 2 * n_laws, n_modes), dtype=complex)
    # Variants that were solved singly have laws of their own and are filled in one by one.
    counts = np.where(np.isin(places, list(batched.singles)), 0, _counts(batched, places))
    for number in np.flatnonzero(counts == 0):
        place = int(places[number])
        own = batched.singles.get(place)
        if own is not None and len(own.kinematics.laws) == n_laws:
            count, coefficients = int(_counts(batched, places[[number]])[0]), (own.system.inertia, _springs(own.system))
            states[number, :, :count] = _states(own, *coefficients, batched, places[[number]], count)[0]
    given = None if batched.batch is None else stacked_coefficients(batched.batch)
    if given is None:
        return states
    for count in sorted(set(counts[counts > 0].tolist())):
        some = np.flatnonzero(counts == count)  # a product's bits may depend on the number of its columns
        coefficients = given.inertia[places[some]], given.stiffness[places[some]]
        states[some, :, :count] = _states(assembly, *coefficients, batched, places[some], count)
    return states


def _springs(system: RowSystem) -> FloatArray:
    """Stiffness (n_laws,) of all laws in N m/rad, with that of hysteretic springs."""
    stiffness = system.stiffness.copy()
    for law, table in system.dynamic:
        if isinstance(table, ComplexStiffness):
            stiffness[law] += table.kappa(np.zeros(1))[0].real
    return stiffness


def _counts(batched: BatchedModes, places: NDArray[np.intp]) -> NDArray[np.intp]:
    """Number of modes of each variant at these places, shape (n,)."""
    return np.asarray(np.sum(~np.isnan(batched.eigenvalues[places]), axis=1))


def _states(
    assembly: Assembly,
    inertia: FloatArray,
    stiffness: FloatArray,
    batched: BatchedModes,
    places: NDArray[np.intp],
    count: int,
) -> ComplexArray:
    """Modes as unit vectors of energy (n, 2 n_laws, count) of the variants that have ``count`` modes."""
    values = batched.eigenvalues[places, :count]
    nodes = [assembly.node_index[name] for name in assembly.kinematics.coordinates]
    # gamma = B q of every law, with q the angles of the nodes that are coordinates.
    motion = assembly.system.rows @ batched.shapes[places, :, :count][:, nodes]
    acting = np.flatnonzero([law.acts for _, law in assembly.kinematics.laws])
    states = np.zeros((len(places), 2, len(assembly.kinematics.laws), count), dtype=complex)
    # State (sqrt(J) lambda gamma, sqrt(k) gamma) of every law; rigid bodies have none.
    states[:, 0, acting] = np.sqrt(np.maximum(inertia, 0))[..., None] * motion * values[:, None, :]
    states[:, 1, acting] = np.sqrt(np.maximum(stiffness, 0))[..., None] * motion
    return _unit(states.reshape(len(places), -1, count) * (values != 0)[:, None, :])


def common_energy(first: ComplexArray, second: ComplexArray) -> FloatArray:
    """Energy in common (n, n_first, n_second) of modes given as energy vectors, 1 for equal and 0 for orthogonal ones.

    It is the modal assurance criterion of these vectors.
    """
    return np.asarray(np.abs(np.conj(np.swapaxes(first, -1, -2)) @ second) ** 2)


def inertia_mac(first: ComplexArray, second: ComplexArray) -> FloatArray:
    """Modal assurance criterion (n, n_first, n_second) of modes, weighted with inertias, 0 where nothing moves."""
    half = first.shape[1] // 2
    return common_energy(_unit(first[:, :half]), _unit(second[:, :half]))


def _unit(states: ComplexArray) -> ComplexArray:
    size = np.linalg.norm(states, axis=1, keepdims=True)
    return np.asarray(np.divide(states, size, out=np.zeros_like(states), where=size > 0))


SAME_MODE_ENERGY = 0.8
"""Energy in common, from 0 to 1, from which modes of neighbouring variants are the same mode, well above half."""
SUCCESSOR_ENERGY = 0.5
"""Energy in common, from 0 to 1, below which a mode has no successor, as less than half of it is the same motion."""
MISSING_MODE = -1
"""Column number that stands for a mode which a variant does not have."""

Columns = NDArray[np.intp]


class FollowedModes(NamedTuple):
    """Eigenvalues (n, m) in rad/s and energy vectors of modes, each in the column of the mode it continues."""

    values: ComplexArray
    states: ComplexArray

    def of(self, some: NDArray[np.generic]) -> FollowedModes:
        return FollowedModes(self.values[some], self.states[some])


def take_columns(array: NDArray[Any], columns: Columns) -> NDArray[Any]:
    """Values of an array at these columns of its last axis, NaN for columns marked as missing."""
    if not array.shape[-1]:
        return np.full((*array.shape[:-1], columns.shape[-1]), np.nan, dtype=array.dtype)
    taken = np.take_along_axis(array, np.maximum(columns, 0), axis=-1)
    return np.asarray(np.where(columns == MISSING_MODE, np.nan, taken))


class Successors(NamedTuple):
    """Columns (n, m) of the modes that continue each mode, and mask (n,) of unambiguous variants.

    Missing modes are marked.
    """

    columns: Columns
    clear: NDArray[np.bool_]


def successors(known: FollowedModes, further: FollowedModes) -> Successors:
    """Columns (n, m) of the modes that continue those of a neighbouring variant, where that is unambiguous.

    Parameters
    ----------
    known : FollowedModes
        m modes that are followed.
    further : FollowedModes
        All modes there are; NaN after the last one of a variant.
    """
    alike = common_energy(known.states, further.states)
    columns = _slower(known, further, alike)
    followed = ~np.isnan(known.values)
    best = np.take_along_axis(alike, columns[:, :, None], axis=2)[:, :, 0]
    # Every followed mode meets itself here; more matches are modes that claim the same successor.
    twice = (columns[:, :, None] == columns[:, None, :]) & followed[:, :, None] & followed[:, None, :]
    values = np.take_along_axis(further.values, columns, axis=1)
    clear = ((best >= SAME_MODE_ENERGY) | ~followed).all(axis=1) & (twice.sum(axis=(1, 2)) == followed.sum(axis=1))
    # Modes that changed their order may have crossed or veered, which a shorter step tells.
    clear &= ~_may_have_met(known.values, values).any(axis=(1, 2))
    return Successors(np.where(followed, columns, MISSING_MODE), clear)


def _slower(known: FollowedModes, further: FollowedModes, alike: FloatArray) -> Columns:
    """Column (n, m) of the mode whose energy is most like that of each known mode, per variant.

    Of two real poles into which an overdamped vibration falls it is the slower.
    """
    best = alike.max(axis=2, keepdims=True)
    real = _is_real(further.values)[:, None, :]
    chosen = np.argmax(alike, axis=2)
    # A vibration of which the nearest mode is a real pole has become overdamped.
    falls = (known.values.imag > 0) & (np.take_along_axis(further.values, chosen, axis=1).imag == 0)
    # Modes rise in |lambda|: the first real pole that is nearly as alike is the slower one.
    slowest = np.argmax(real & (alike >= SAME_MODE_ENERGY * best), axis=2)
    return np.asarray(np.where(falls, slowest, chosen))


def _may_have_met(before: ComplexArray, after: ComplexArray) -> NDArray[np.bool_]:
    """Mask (n, m, m) of pairs of modes that have changed order and moved far enough to have met."""
    order = [_order(np.abs(values)) for values in (before, after)]
    kinds = [(values.imag > 0)[:, :, None] == (values.imag > 0)[:, None, :] for values in (before, after)]
    moved = np.abs(after - before)
    # Only if both together moved by the larger of their gaps can they have met on the way.
    gap = np.maximum(np.abs(_differences(before)), np.abs(_differences(after)))
    met = moved[:, :, None] + moved[:, None, :] >= gap  # False for NaN
    return np.asarray((order[0] * order[1] < 0) & kinds[0] & kinds[1] & met)


def _order(sizes: FloatArray) -> FloatArray:
    """Sign (n, m, m) of the size difference of all pairs of modes, 1 or -1, and 0 for equal sizes."""
    apart = _differences(sizes)
    return np.where(np.abs(apart) > EQUAL_EIGENVALUES * sizes[:, :, None], np.sign(apart), 0.0)


def _differences(values: NDArray[Any]) -> NDArray[Any]:
    return np.asarray(values[:, :, None] - values[:, None, :])


def assign_modes(known: FollowedModes, further: FollowedModes) -> Columns:
    """Columns (1, m) that continue each mode of one ambiguous variant, with the most energy in common overall.

    Of two real poles that have become one vibration the slower one goes on.
    """
    from scipy.optimize import linear_sum_assignment

    # The assignment of modes with the largest sum of common energy.
    alike = common_energy(known.states, further.states[:, :, ~np.isnan(further.values[0])])[0]
    alike[(alike < SUCCESSOR_ENERGY) | np.isnan(known.values[0])[:, None]] = 0.0
    columns = np.full(known.values.shape[1], MISSING_MODE)
    for mode, column in zip(*linear_sum_assignment(-alike), strict=True):
        if alike[mode, column] > 0:
            columns[mode] = column
    # Two real poles that meet become one vibration, which continues only one of them.
    real = np.flatnonzero(_is_real(known.values[0]))
    for slower in real[columns[real] == MISSING_MODE]:
        for faster in real[columns[real] != MISSING_MODE]:
            column = columns[faster]
            sizes = np.abs(known.values[0, [slower, faster]])
            if further.values[0, column].imag > 0 and alike[slower, column] > 0 and sizes[0] < sizes[1]:
                columns[slower], columns[faster] = column, MISSING_MODE
                break
    return columns[None]


def _is_real(values: ComplexArray) -> NDArray[np.bool_]:
    return np.asarray((values.imag == 0) & (np.abs(values) > 0))


# Tracking of modes from a drivetrain to its variants in steps of parameter values, as short as needed.

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
    batched : BatchedModes
    home : FollowedModes
        m modes of the drivetrain itself (1, m).
    """

    def __init__(self, batched: BatchedModes, home: FollowedModes) -> None:
        self._batched, self._home = batched, home
        self._plan = None if batched.batch is None else batch_plan(batched.drivetrain, batched.values)

    def columns(self, places: NDArray[np.intp], arrived: FollowedModes) -> Columns:
        """Columns (n, m) of the variants' modes that continue those of the drivetrain.

        Parameters
        ----------
        places : (n,) index array
            The variants.
        arrived : FollowedModes
            All their modes.
        """
        n, m = len(places), self._home.values.shape[1]
        known = FollowedModes(np.repeat(self._home.values, n, axis=0), np.repeat(self._home.states, n, axis=0))
        columns = np.full((n, m), MISSING_MODE)
        reached, step, shortest = np.zeros(n), np.full(n, FIRST_STEP), np.full(n, SHORTEST_STEP)
        walking = np.arange(n)
        while walking.size:
            goal = np.minimum(reached + step, 1.0)[walking]
            ahead = self._modes_on_the_way(places[walking], goal, arrived.of(walking))
            there = ~np.isnan(ahead.values).all(axis=1)
            chosen, clear = successors(known.of(walking), ahead)
            # At the shortest step modes count as crossing: the largest common energy decides.
            forced = ~(clear & there) & (step[walking] <= shortest[walking])
            for number in np.flatnonzero(forced & there):
                chosen[number] = assign_modes(known.of(walking[[number]]), ahead.of(np.array([number])))[0]
            moved = (clear & there) | forced
            shortest[walking[forced]] *= 2.0
            step[walking] *= np.where(moved, 2.0, 0.5)
            reached[walking[moved]] = goal[moved]
            # Over a variant that cannot be on the way the modes of the last one before it are kept.
            new = moved & there
            some = walking[new]
            columns[some] = chosen[new]
            known.values[some] = take_columns(ahead.values[new], chosen[new])
            known.states[some] = np.nan_to_num(take_columns(ahead.states[new], chosen[new][:, None, :]))
            walking = walking[reached[walking] < 1]
        return columns

    def _modes_on_the_way(self, places: NDArray[np.intp], shares: FloatArray, arrived: FollowedModes) -> FollowedModes:
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
        drivetrain = self._batched.drivetrain
        ends = {name: column[places] for name, column in self._batched.values.items()}
        values = _between(drivetrain.parameters, ends, shares)
        solved = single_modes(drivetrain, values) if self._plan is None else batched_modes(self._plan.batch(values))
        return FollowedModes(solved.eigenvalues, mode_states(solved, np.arange(len(solved))))


def _between(home: Mapping[str, float], ends: Mapping[str, FloatArray], shares: FloatArray) -> dict[str, FloatArray]:
    """Parameter values at ``shares`` of the ways, in equal factors where both ends have the same sign."""
    values = {}
    for name, end in ends.items():
        start = float(home[name])
        # A stiffness that moves over decades does so by equal factors, p = p_0 (p_1 / p_0)^share.
        with np.errstate(all="ignore"):
            curved = start * (end / start) ** shares if start else end
        values[name] = np.where(start * end > 0, curved, start + shares * (end - start))
    return values
