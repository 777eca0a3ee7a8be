"""Kinematic rows of a drivetrain over the kept coordinates, with the coefficients of the law on each row.

With the rows B (n_laws x n_q) the equations of motion are

    M = B^T diag(J) B,   C = B^T diag(c) B,   K = B^T diag(k) B,
    D(s) = M s^2 + C s + K + sum_d kappa_d(omega) b_d b_d^T

Solvers that care about accuracy use the rows; the assembled matrices are for those that do not.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.action_law import ActionLaw
from torsionnet.core.memo import Memo

if TYPE_CHECKING:
    from torsionnet.model.element_base.dynamic_stiffness import DynamicStiffness

FloatArray: TypeAlias = NDArray[np.float64]
ComplexArray: TypeAlias = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Rows:
    """Sparse matrix of rows over columns, stored by the few entries that are not zero.

    A drivetrain of n nodes has rows with one to three entries, so that n x n arrays cost the square of what there is to
    say: ``dense`` is for small systems and for methods that need such an array anyway.

    Attributes
    ----------
    maps : tuple of dict
        Column -> coefficient of every row.
    n_columns : int

    Examples
    --------
    >>> rows = Rows.of(np.array([[1.0, 0.0], [1.0, -1.0]]))
    >>> rows.maps
    ({0: 1.0}, {0: 1.0, 1: -1.0})
    >>> rows.dense.shape
    (2, 2)
    """

    maps: tuple[dict[int, float], ...]
    n_columns: int

    @classmethod
    def of(cls, dense: FloatArray) -> Rows:
        """Sparse rows with the entries of a dense array (n_rows, n_columns) that are not zero."""
        found: list[dict[int, float]] = [{} for _ in dense]
        for i, j in zip(*(part.tolist() for part in np.nonzero(dense)), strict=True):
            found[i][j] = float(dense[i, j])
        return cls(tuple(found), int(dense.shape[1]))

    @classmethod
    def named(cls, rows: Iterable[Mapping[str, Any]], columns: Mapping[str, int]) -> Rows:
        """Sparse rows from rows over names, restricted to the names that have a column."""
        maps = [{columns[name]: float(value) for name, value in row.items() if name in columns} for row in rows]
        return cls(tuple(maps), len(columns))

    def __len__(self) -> int:
        return len(self.maps)

    @cached_property
    def dense(self) -> FloatArray:
        """Sparse rows written out as an array (n_rows, n_columns), read-only."""
        array = np.zeros((len(self.maps), self.n_columns))
        for index, row in enumerate(self.maps):
            for column, value in row.items():
                array[index, column] = value
        array.setflags(write=False)
        return array

    @cached_property
    def csr(self) -> Any:
        """Sparse rows as a scipy.sparse.csr_array (n_rows, n_columns)."""
        from scipy import sparse

        indices = [column for row in self.maps for column in row]
        values = [value for row in self.maps for value in row.values()]
        starts = np.cumsum([0, *map(len, self.maps)])
        return sparse.csr_array((values, indices, starts), shape=(len(self.maps), self.n_columns), dtype=float)


@dataclass(frozen=True)
class RowSystem:
    """Rows of all laws of a drivetrain over the kept coordinates q, with inertia, damping and stiffness of each in SI.

    Attributes
    ----------
    law_rows : Rows
        gamma = row @ q, the scalar motion on which each law acts, in rad.
    inertia, damping, stiffness : (n_laws,) arrays
        J in kg m^2, c in N m s/rad, k in N m/rad of each law; all >= 0.
    dynamic : tuple of (law index, DynamicStiffness)
        Laws that also have a frequency-dependent complex stiffness kappa(omega), omega >= 0.
    actions : tuple of ActionLaw
        Torques that follow the motion of another row; no part of ``M``, ``C`` and ``K``.
    memo : Memo
        What solvers have worked out from the rows alone; systems with the same rows share it.
    """

    law_rows: Rows
    inertia: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    dynamic: tuple[tuple[int, DynamicStiffness], ...] = ()
    actions: tuple[ActionLaw, ...] = ()
    memo: Memo = field(default_factory=Memo, compare=False, repr=False)

    def __post_init__(self) -> None:
        for array in (self.inertia, self.damping, self.stiffness):
            array.setflags(write=False)

    @property
    def rows(self) -> FloatArray:
        """Rows of all laws over the coordinates as a dense array (n_laws, n_q): not for large systems."""
        return self.law_rows.dense

    @property
    def sparse_rows(self) -> tuple[dict[int, float], ...]:
        """Row of each law as a map from the number of a coordinate to its coefficient."""
        return self.law_rows.maps

    @property
    def n_coordinates(self) -> int:
        return self.law_rows.n_columns

    @property
    def is_active(self) -> bool:
        """Whether controllers or negative damping may feed energy into the drivetrain, so that it may be unstable."""
        return bool(self.actions) or bool((self.damping < 0).any())

    @property
    def is_continuous(self) -> bool:
        """Whether the system has infinitely many modes, because a shaft in it is continuous."""
        return any(table.is_continuous for _, table in self.dynamic)

    def _gram(self, coefficients: FloatArray) -> FloatArray:
        used = np.flatnonzero(coefficients)
        rows = self.rows[used]
        return np.asarray(rows.T @ (coefficients[used, None] * rows), dtype=float)

    @cached_property
    def M(self) -> FloatArray:
        """Inertia matrix of the drivetrain over the kept coordinates, (n_q, n_q), kg m^2."""
        return self._gram(self.inertia)

    @cached_property
    def C(self) -> FloatArray:
        """Viscous damping matrix of the drivetrain over the kept coordinates, (n_q, n_q), N m s/rad."""
        return self._gram(self.damping)

    @cached_property
    def K(self) -> FloatArray:
        """Stiffness matrix of the drivetrain, (n_q, n_q), N m/rad, without frequency-dependent parts."""
        return self._gram(self.stiffness)

    def frozen(self, omega: float | FloatArray) -> tuple[FloatArray | ComplexArray, FloatArray]:
        """Stiffness in N m/rad and damping in N m s/rad, (n_laws, ...), that poles with ``|Im s|`` = omega meet.

        The stiffness is real where nothing is hysteretic, and at rest; omega, in rad/s, is a number or an array.
        """
        at = np.atleast_1d(omega)
        stiffness, damping = (np.repeat(part[:, None], len(at), axis=1) for part in (self.stiffness, self.damping))
        loss = np.zeros((0, len(at)))
        for index, law in self.dynamic:
            k, c = law.frozen(at)
            stiffness[index] += k.real
            damping[index] += c
            if k.imag.any() and at.any():
                loss = loss if len(loss) else np.zeros_like(stiffness)
                loss[index] += np.where(at > 0, k.imag, 0.0)
        every = stiffness + 1j * loss if len(loss) else stiffness
        return (every, damping) if np.ndim(omega) else (every[:, 0], damping[:, 0])

    def at_frequency(self, omega: float) -> RowSystem:
        """Copy of the system with the real part of its stiffness and its damping frozen at omega in rad/s."""
        stiffness, damping = self.frozen(omega)
        return replace(self, stiffness=stiffness.real, damping=damping, dynamic=())

    def kappa(self, omega: float) -> ComplexArray:
        """Frequency-dependent complex stiffness of each law in N m/rad at one omega in rad/s, shape (n_laws,)."""
        values = np.zeros(len(self.stiffness), dtype=complex)
        for index, law in self.dynamic:
            values[index] += law.kappa(np.array([omega]))[0]
        return values
