"""Reference solver: the assembled dynamic stiffness, solved by LAPACK for a block of frequencies at a time."""

from __future__ import annotations

import numpy as np

from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.assembly.rows import ComplexArray, FloatArray, RowSystem

BLOCK_BYTES = 32 * 2**20


def respond(system: RowSystem, kappa: LawStiffness, loads: ComplexArray, rows: FloatArray) -> ComplexArray:
    """Motion of ``rows`` under ``loads``: rows @ D(s)^-1 @ loads; as :func:`torsionnet.solve.starmesh.respond`."""
    return solve(system, kappa.by_law, loads, rows)


def solve(system: RowSystem, by_law: ComplexArray, loads: ComplexArray, rows: FloatArray) -> ComplexArray:
    """The same for dynamic stiffnesses (n_laws, n_lanes) in N m/rad."""
    n_lanes, n_q = by_law.shape[1], system.n_coordinates
    motion = np.empty((n_lanes, len(rows), loads.shape[2]), dtype=complex)
    block = max(1, BLOCK_BYTES // (16 * max(1, n_q) ** 2))
    for start in range(0, n_lanes, block):
        part = slice(start, min(start + block, n_lanes))
        motion[part] = rows @ _solve(_assembled(system, by_law[:, part].T), loads if len(loads) == 1 else loads[part])
    return motion


def _assembled(system: RowSystem, kappa: ComplexArray) -> ComplexArray:
    """D (n_f, n_q, n_q): each law adds kappa a a^T, which touches the few entries where its row is not zero."""
    stiffness = np.zeros((len(kappa), system.n_coordinates, system.n_coordinates), dtype=complex)
    for law, row in enumerate(system.rows):
        used = np.flatnonzero(row)
        for i in used:
            for j in used:
                stiffness[:, i, j] += kappa[:, law] * (row[i] * row[j])
    return stiffness


def _solve(stiffness: ComplexArray, loads: ComplexArray) -> ComplexArray:
    """Scaled by its own diagonal, which makes rows of very different stiffness comparable."""
    scale = np.sqrt(np.abs(np.einsum("fii->fi", stiffness)))
    scale[scale == 0] = 1.0
    scaled = stiffness / (scale[:, :, None] * scale[:, None, :])
    right = np.broadcast_to(loads, (len(stiffness), *loads.shape[1:])) / scale[:, :, None]
    try:
        return np.asarray(np.linalg.solve(scaled, right) / scale[:, :, None])
    except np.linalg.LinAlgError:
        solved = np.stack([_one(matrix, load) for matrix, load in zip(scaled, right, strict=True)])
        return np.asarray(solved / scale[:, :, None])


def _one(matrix: ComplexArray, load: ComplexArray) -> ComplexArray:
    """At an undamped resonance met exactly, a rounding error of damping stands in for the missing pivot."""
    try:
        return np.asarray(np.linalg.solve(matrix, load))
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.solve(matrix + 1j * np.finfo(float).eps * np.eye(len(matrix)), load))
