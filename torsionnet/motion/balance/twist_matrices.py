"""Matrices over coordinates, dense for few of these and sparse for many, and solutions of their equations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

SMALL_RESIDUAL = 1e-10
"""Size of a residual over that of the right side below which a solution counts as one."""
DENSE_COORDINATES = 400
"""Number of coordinates from which sparse matrices are quicker."""


def row_matrix(rows: Sequence[Mapping[str, float]], place: Mapping[str, int]) -> Any:
    """Rows over the coordinates, dense for few of these."""
    entries = [
        (number, place[name], share) for number, row in enumerate(rows) for name, share in row.items() if name in place
    ]
    shape = (len(rows), len(place))
    if len(place) <= DENSE_COORDINATES:
        dense = np.zeros(shape)
        for number, column, share in entries:
            dense[number, column] = share
        return dense
    from scipy import sparse

    triples: Any = zip(*entries, strict=True) if entries else ((), (), ())
    numbers, columns, shares = triples
    placed: Any = (shares, (numbers, columns))
    return sparse.csr_array(placed, shape=shape, dtype=float)


def gram(rows: Any, sizes: FloatArray) -> Any:
    """Matrix sum_l size_l b_l b_l^T over the coordinates."""
    if isinstance(rows, np.ndarray):
        return rows.T @ (sizes[:, None] * rows)
    from scipy import sparse

    return sparse.csc_array(rows.T @ (sparse.diags_array(sizes) @ rows))


def bordered(stiffness: Any, rows: Any) -> Any:
    """Matrix [[K, B^T], [B, 0]] of coordinates under constraints on the rows B."""
    if isinstance(stiffness, np.ndarray):
        m = len(rows)
        return np.block([[stiffness, rows.T], [rows, np.zeros((m, m))]]) if m else stiffness
    from scipy import sparse

    return sparse.block_array([[stiffness, rows.T], [rows, None]]).tocsc() if rows.shape[0] else stiffness


def solution(matrix: Any, right: FloatArray) -> FloatArray:
    """Solution of a system of equations, not a number where a sparse one is singular."""
    if isinstance(matrix, np.ndarray):
        try:
            return np.asarray(np.linalg.solve(matrix, right))
        except np.linalg.LinAlgError:
            return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0])
    from scipy.sparse.linalg import splu

    try:
        return np.asarray(splu(matrix.tocsc()).solve(right))
    except RuntimeError:
        return np.full(len(right), np.nan)
