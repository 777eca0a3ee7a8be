"""Kinematic rows of a drivetrain over the kept coordinates, with the coefficients of the law on each row.

With the rows B (n_laws x n_q) the equations of motion are

    M = B^T diag(J) B,   C = B^T diag(c) B,   K = B^T diag(k) B,
    D(s) = M s^2 + C s + K + sum_d kappa_d(omega) b_d b_d^T

Solvers that care about accuracy use the rows; the assembled matrices are for those that do not.

Here as well: transfer functions of actions (controllers, fluid couplings), whose torques follow a motion, in exact
numbers.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import exact
from torsionnet.base.registers import Memo
from torsionnet.model.kinematics import Kinematics, exact_row

if TYPE_CHECKING:
    from torsionnet.model.element_base.dynamic_stiffness import DynamicStiffness

Polynomial: TypeAlias = tuple[Fraction, ...]
"""Coefficients of a polynomial in s in ascending powers, the last of them not zero; an empty tuple for zero."""


@dataclass(frozen=True)
class ActionLaw:
    """Law of an action, whose torque N(s)/D(s) e^(-s delay) gamma_sensed in N m drives one row by another's motion.

    Attributes
    ----------
    owner : str
        Its element.
    nodes : mapping
        The row it drives, over nodes.
    row, sensed : mapping
        The row it drives and the one it follows, over coordinates and imposed angles.
    numerator, denominator : tuple of Fraction
        N(s) in N m/rad and D(s), ascending, without a common factor s; the last coefficient of D is 1.
    delay : Fraction
        s.
    """

    owner: str
    nodes: Mapping[str, Fraction]
    row: Mapping[str, Fraction]
    sensed: Mapping[str, Fraction]
    numerator: Polynomial
    denominator: Polynomial
    delay: Fraction

    @property
    def acts_at_rest(self) -> bool:
        """Whether a constant angle of the sensed row makes a torque."""
        return self.numerator[0] != 0 or self.denominator[0] == 0

    @property
    def rows(self) -> tuple[str, Mapping[str, Fraction], Mapping[str, Fraction], Mapping[str, Fraction]]:
        """Element of the action, and its rows over nodes: all it touches, the driven and the sensed ones."""
        return self.owner, self.nodes, self.row, self.sensed

    @cached_property
    def _floats(self) -> tuple[list[float], list[float], float]:
        numbers = ([float(value) for value in part] for part in (self.numerator, self.denominator))
        return (*numbers, float(self.delay))  # type: ignore[return-value]

    def kappa(self, s: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Transfer function torque / sensed angle in N m/rad at the Laplace variable s in rad/s, shape of s."""
        numerator, denominator, delay = self._floats
        with np.errstate(all="ignore"):
            value = polynomial(numerator, s) / polynomial(denominator, s)
            return np.asarray(value * np.exp(-delay * s) if delay else value, dtype=np.complex128)


def refuse_actions(actions: Sequence[ActionLaw], what: str) -> None:
    """Raise an error if a drivetrain has actions (controllers, fluid couplings), which a calculation does not cover.

    Raises
    ------
    UsageError
        There is one.
    """
    if actions:
        names = ", ".join(dict.fromkeys(action.owner for action in actions))
        raise UsageError(
            f"{what} not worked out where a torque follows another motion; switch off {names}", kind="unsupported-law"
        )


def polynomial(coefficients: Sequence[Any], s: Any) -> Any:
    """Value at s of a polynomial with the given coefficients in ascending powers, by Horner's rule."""
    value = 0 * s
    for coefficient in reversed(coefficients):
        value = value * s + coefficient
    return value


def action_laws(kinematics: Kinematics) -> tuple[ActionLaw, ...]:
    """Laws of all actions of a drivetrain whose gain and sensed motion are not zero, in the order of the elements."""
    laws = []
    for owner, action in kinematics.actions:
        sensed = exact_row(kinematics.reduction.reduced(action.sensed))
        numerator, denominator = lowest_terms(action.numerator, action.denominator)
        if numerator and sensed:
            nodes = exact_row(action.row)
            row, delay = exact_row(kinematics.reduction.reduced(action.row)), exact(action.delay)
            laws.append(ActionLaw(owner, nodes, row, sensed, numerator, denominator, delay))
    return tuple(laws)


def lowest_terms(numerator: Sequence[Any], denominator: Sequence[Any]) -> tuple[Polynomial, Polynomial]:
    """Exact coefficients of numerator and denominator without a common factor s, the denominator with leading 1.

    A common factor s is an integral of a rate, which is the angle: no state of its own.

    >>> lowest_terms((0, 2, 4, 0), (0, 2))
    ((Fraction(1, 1), Fraction(2, 1)), (Fraction(1, 1),))
    """
    above, below = ([exact(value) for value in part] for part in (numerator, denominator))
    for part in (above, below):
        while part and part[-1] == 0:
            part.pop()
    while above and below and above[0] == 0 and below[0] == 0:
        del above[0], below[0]
    lead = below[-1] if below else Fraction(1)
    return tuple(value / lead for value in above), tuple(value / lead for value in below)


def divide_polynomials(numerator: Polynomial, denominator: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Quotient and remainder of a polynomial divided by one with leading coefficient 1, as exact coefficients.

    >>> divide_polynomials((Fraction(1), Fraction(0), Fraction(2)), (Fraction(3), Fraction(1)))
    ((Fraction(-6, 1), Fraction(2, 1)), (Fraction(19, 1),))
    """
    rest, degree = list(numerator), len(denominator) - 1
    quotient = [Fraction(0)] * max(len(rest) - degree, 0)
    for power in reversed(range(len(quotient))):
        factor = quotient[power] = rest[power + degree]
        for place, value in enumerate(denominator):
            rest[power + place] -= factor * value
    return tuple(quotient), tuple(rest[:degree])


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
        rows: list[dict[int, float]] = [{} for _ in dense]
        for i, j in zip(*(part.tolist() for part in np.nonzero(dense)), strict=True):
            rows[i][j] = float(dense[i, j])
        return cls(tuple(rows), int(dense.shape[1]))

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
        J in kg m^2, c in N m s/rad, k in N m/rad of each law. Damping below zero feeds a vibration; a
        stiffness with losses, or over frequency, stands in ``dynamic`` and is 0 here.
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
        # A law at a shaft behind a gear has the entry 1/tau in its row b over the coordinate before it; b b^T has
        # 1/tau^2, the reflected J/tau^2, c/tau^2 and k/tau^2.
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
