"""A drivetrain reduced to arrays: kinematic rows over the kept coordinates, and what acts on each row.

With the rows B (n_laws x n_q) the equations of motion are

    M = B^T diag(J) B,   C = B^T diag(c) B,   K = B^T diag(k) B,
    D(s) = M s^2 + C s + K + sum_d kappa_d(omega) b_d b_d^T

Solvers that care about accuracy use the rows; the assembled matrices are for those that do not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
ComplexArray: TypeAlias = NDArray[np.complex128]

DynamicStiffness: TypeAlias = Callable[[FloatArray], ComplexArray]
"""kappa(omega): complex stiffness in N m/rad at omega in rad/s; shape in = shape out."""


@dataclass(frozen=True)
class RowSystem:
    """Rows and coefficients of every law of a drivetrain, in the kept coordinates q.

    Attributes
    ----------
    rows : (n_laws, n_q) array
        gamma = rows @ q, the scalar motion on which each law acts, in rad.
    inertia, damping, stiffness : (n_laws,) arrays
        J in kg m^2, c in N m s/rad, k in N m/rad of each law; all >= 0.
    dynamic : tuple of (law index, kappa)
        Laws that also have a frequency-dependent complex stiffness kappa(omega), omega >= 0.
    plans : dict
        What solvers have worked out from the rows alone; systems with the same rows share it.
    """

    rows: FloatArray
    inertia: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    dynamic: tuple[tuple[int, DynamicStiffness], ...] = ()
    plans: dict[Any, Any] = field(default_factory=dict, compare=False, repr=False)

    @cached_property
    def sparse_rows(self) -> list[dict[int, float]]:
        """Every row as a map from coordinate to coefficient."""
        return sparse(self.rows)

    def __post_init__(self) -> None:
        for array in (self.rows, self.inertia, self.damping, self.stiffness):
            array.setflags(write=False)

    @property
    def n_coordinates(self) -> int:
        return int(self.rows.shape[1])

    def _gram(self, coefficients: FloatArray) -> FloatArray:
        used = np.flatnonzero(coefficients)
        rows = self.rows[used]
        return np.asarray(rows.T @ (coefficients[used, None] * rows), dtype=float)

    @cached_property
    def M(self) -> FloatArray:
        """Inertia matrix (n_q, n_q), kg m^2."""
        return self._gram(self.inertia)

    @cached_property
    def C(self) -> FloatArray:
        """Viscous damping matrix (n_q, n_q), N m s/rad."""
        return self._gram(self.damping)

    @cached_property
    def K(self) -> FloatArray:
        """Stiffness matrix (n_q, n_q), N m/rad, without frequency-dependent parts."""
        return self._gram(self.stiffness)

    def kappa(self, omega: float) -> ComplexArray:
        """Frequency-dependent complex stiffness of each law at one omega in rad/s, shape (n_laws,)."""
        values = np.zeros(len(self.stiffness), dtype=complex)
        for index, law in self.dynamic:
            values[index] += law(np.array([omega]))[0]
        return values


def sparse(rows: FloatArray) -> list[dict[int, float]]:
    """Rows as maps from coordinate to coefficient."""
    found: list[dict[int, float]] = [{} for _ in rows]
    for i, j in zip(*(part.tolist() for part in np.nonzero(rows)), strict=True):
        found[i][j] = float(rows[i, j])
    return found
