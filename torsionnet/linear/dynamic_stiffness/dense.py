"""Responses by the assembled dynamic stiffness matrix, solved by LAPACK, as reference for the other solvers.

A block of frequencies is solved at a time.
"""

from __future__ import annotations

import numpy as np

from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.assembly.rows import ComplexArray
from torsionnet.linear.dynamic_stiffness.response_problem import ResponseProblem

BLOCK_BYTES = 32 * 2**20
"""Memory in bytes of the dynamic stiffness matrices solved at once, since larger blocks leave the processor's cache."""


def respond(problem: ResponseProblem, laws: LawStiffness) -> ComplexArray:
    """Motions (rad) and reactions (N m) per unit excitation, (n_read, n_exc, n_points), by dense matrices."""
    by_law, n_points = laws.by_law, laws.n_points
    values = np.zeros((problem.n_read, len(problem.excitations), n_points), dtype=complex)
    block = max(1, BLOCK_BYTES // (16 * max(1, _columns(problem)) ** 2))
    with np.errstate(all="ignore"):
        for start in range(0, n_points, block):
            part = slice(start, min(start + block, n_points))
            values[:, :, part] = np.moveaxis(_respond(problem, by_law[:, part].T), 0, 2)
    return values


def _columns(problem: ResponseProblem) -> int:
    given = [j for row in problem.laws for j in row]
    given += [j for loading in problem.excitations for j in (*loading.load, *loading.motion)]
    return max([problem.n_free, *(j + 1 for j in given), *(j + 1 for j in problem.reactions)])


def _respond(problem: ResponseProblem, kappa: ComplexArray) -> ComplexArray:
    """Outputs (rad) and reactions (N m) per unit excitation at a block of frequencies, (n_f, n_read, n_exc)."""
    n, free = _columns(problem), slice(0, problem.n_free)
    given, n_exc = slice(problem.n_free, n), len(problem.excitations)
    D = _assembled(problem, kappa, n)
    load, motion = np.zeros((n, n_exc)), np.zeros((len(kappa), n, n_exc), dtype=complex)
    for number, excitation in enumerate(problem.excitations):
        load[list(excitation.load), number] = list(excitation.load.values())
        motion[:, list(excitation.motion), number] = list(excitation.motion.values())
    # D_ff q_f = f_f - D_fg q_g, with the given angles q_g
    motion[:, free] = _solve(D[:, free, free], load[free] - D[:, free, given] @ motion[:, given])
    rows = np.zeros((len(problem.outputs), n))
    for number, row in enumerate(problem.outputs):
        rows[number, list(row)] = list(row.values())
    # The torque f_g - D_g q on given columns is their reaction.
    reacted = list(problem.reactions)
    return np.concatenate([rows @ motion, load[reacted] - D[:, reacted] @ motion], axis=1)


def _assembled(problem: ResponseProblem, kappa: ComplexArray, n: int) -> ComplexArray:
    """Dynamic stiffness matrices in N m/rad, shape (n_f, n, n), summed law by law from nonzero entries of rows."""
    stiffness = np.zeros((len(kappa), n, n), dtype=complex)
    for law, row in enumerate(problem.laws):
        for i, a in row.items():
            for j, b in row.items():
                stiffness[:, i, j] += kappa[:, law] * (a * b)
    return stiffness


def _solve(stiffness: ComplexArray, loads: ComplexArray) -> ComplexArray:
    """Solutions x of D x = load at each frequency in rad, shape (n_f, n, n_exc), with D scaled by its own diagonal."""
    scale = np.sqrt(np.abs(np.einsum("fii->fi", stiffness)))
    scale[scale == 0] = 1.0
    scaled = stiffness / (scale[:, :, None] * scale[:, None, :])
    right = np.broadcast_to(loads, (len(stiffness), *loads.shape[-2:])) / scale[:, :, None]
    try:
        return np.asarray(np.linalg.solve(scaled, right) / scale[:, :, None])
    except np.linalg.LinAlgError:
        solved = np.stack(
            [_solution_at_one_frequency(matrix, load) for matrix, load in zip(scaled, right, strict=True)]
        )
        return np.asarray(solved / scale[:, :, None])


def _solution_at_one_frequency(matrix: ComplexArray, load: ComplexArray) -> ComplexArray:
    """Solution x (n, n_exc) of D x = load at one frequency, with rounding-sized damping where D is exactly singular.

    This is at an exact undamped resonance.
    """
    try:
        return np.asarray(np.linalg.solve(matrix, load))
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.solve(matrix + 1j * np.finfo(float).eps * np.eye(len(matrix)), load))
