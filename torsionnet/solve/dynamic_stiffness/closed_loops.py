"""Responses with controllers and fluid couplings at work, calculated from responses without their torques.

An action drives a row by T = kappa(s) y, y the motion it senses. With the responses of the laws alone to excitations u
and to unit torques of the actions, y = Y_u u + Y_T T and z = Z_u u + Z_T T, so

    T = (I - kappa Y_T)^-1 kappa Y_u u

Elimination along the graph stays symmetric; what the loop subtracts is watched for the digits it costs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.assembly.rows import ComplexArray
from torsionnet.core.errors import SolveError
from torsionnet.solve.dynamic_stiffness.lost_digits import LARGE_SHARE
from torsionnet.solve.dynamic_stiffness.reading_problem import ReadingProblem


class ClosedLoops(NamedTuple):
    """Readings (n_read, n_exc, n_points) with controllers at work, torques of these in N m, and uncertain points.

    Readings are per unit excitation; the torques are (n_act, n_exc, n_points); ``uncertain`` (n_points,) marks points
    that lost digits.
    """

    values: ComplexArray
    torques: ComplexArray
    uncertain: NDArray[np.bool_]


def close_loops(
    reading_problem: ReadingProblem, kappa: LawStiffness, values: ComplexArray, uncertain: NDArray[np.bool_]
) -> ClosedLoops:
    """Readings per unit excitation with controllers at work, from ``values`` calculated without their torques.

    These ``values`` are responses to the excitations, then to a unit torque of each action.
    """
    n_exc, n_act = reading_problem.n_excitations, len(reading_problem.sensed)
    if not n_act:
        return ClosedLoops(values, np.zeros((0, n_exc, kappa.n_points), dtype=complex), uncertain)
    if len(kappa.actions) != n_act:
        raise SolveError("this calculation does not include the torques of controllers; switch them off")
    gains = np.array([values_.ravel() for values_ in kappa.actions])
    sensed = gains[:, None, :] * values[list(reading_problem.sensed)]
    by_torque, by_excitation = np.moveaxis(sensed[:, n_exc:], 2, 0), np.moveaxis(sensed[:, :n_exc], 2, 0)
    with np.errstate(all="ignore"):
        loop = np.eye(n_act) - by_torque
        torques, lost = _solved(loop, by_excitation)
        lost |= (LARGE_SHARE * np.abs(loop) < np.abs(by_torque)).any(axis=(1, 2))
        torques = np.moveaxis(torques, 0, 2)
        alone, added = values[:, :n_exc], values[:, n_exc:]
        total = alone + np.einsum("rap,aep->rep", added, torques)
        size = np.abs(alone) + np.einsum("rap,aep->rep", np.abs(added), np.abs(torques))
        lost |= (LARGE_SHARE * np.abs(total) < size).any(axis=(0, 1))
    finite = np.isfinite(total).all(axis=(0, 1)) & np.isfinite(torques).all(axis=(0, 1))
    return ClosedLoops(total, torques, uncertain | lost | ~finite)


def _solved(loop: ComplexArray, right: ComplexArray) -> tuple[ComplexArray, NDArray[np.bool_]]:
    """Torques of the actions (n_points, n_act, n_exc) in N m, and mask (n_points,) where the loops nearly cancel."""
    if loop.shape[1] == 1:
        return np.asarray(right / loop), np.zeros(len(loop), dtype=bool)
    finite = np.isfinite(loop).all(axis=(1, 2)) & np.isfinite(right).all(axis=(1, 2))
    found: ComplexArray = np.full(right.shape, np.nan + 0j)
    lost: NDArray[np.bool_] = np.asarray(~finite)
    for point in np.flatnonzero(finite):
        rows = np.abs(loop[point]).max(axis=1, keepdims=True)
        scaled = loop[point] / np.where(rows > 0, rows, 1.0)
        if np.linalg.cond(scaled) > LARGE_SHARE:
            lost[point] = True
        try:
            found[point] = np.linalg.solve(loop[point], right[point])
        except np.linalg.LinAlgError:
            lost[point] = True
    return found, lost
