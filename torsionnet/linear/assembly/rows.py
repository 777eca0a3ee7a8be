"""Assembly of a drivetrain in numbers: rows of the laws over the kept coordinates, with the coefficients on each row.

Angles of the nodes are theta = T q + S x, with imposed angles x. With the rows B (n_laws x n_q) the equations of motion
are

    M = B^T diag(J) B,   C = B^T diag(c) B,   K = B^T diag(k) B,
    D(s) = M s^2 + C s + K + sum_d kappa_d(omega) b_d b_d^T

Solvers that care about accuracy use the rows; the assembled matrices are for those that do not.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.packages import gc_paused
from torsionnet.base.registers import Memo
from torsionnet.model.definition import Definition
from torsionnet.model.elements import Law, Values
from torsionnet.model.kinematics import Kinematics, exact_row, pseudo_node, solve_kinematics

if TYPE_CHECKING:
    from torsionnet.linear.assembly.action_laws import ActionLaw
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


@dataclass(frozen=True)
class Assembly:
    """Assembled drivetrain in numbers, with kinematics, rows and coefficients of all laws, and angles of all nodes.

    Attributes
    ----------
    kinematics : Kinematics
    system : RowSystem
        The laws over the coordinates q.
    node_rows : Rows
        Angles of all nodes from the coordinates.
    imposed_node_rows : Rows
        Angles of all nodes from the imposed angles.
    imposed_law_rows : Rows
        The part of gamma of every law that follows imposed angles.
    owners : tuple of str
        Element of each law.
    """

    kinematics: Kinematics
    system: RowSystem
    node_rows: Rows
    imposed_node_rows: Rows
    imposed_law_rows: Rows
    owners: tuple[str, ...]

    @property
    def nodes(self) -> tuple[str, ...]:
        return self.kinematics.nodes

    def over_coordinates(self, row: Mapping[str, Any]) -> FloatArray:
        """Coefficients (n_q,) by coordinate of a row that is given by names, where imposed angles are left out."""
        coefficients = np.zeros(self.system.n_coordinates)
        for column, value in self.columns_of(row).items():
            if column < len(coefficients):  # imposed angles stand still
                coefficients[column] = value
        return coefficients

    @property
    def T(self) -> FloatArray:
        """Matrix T (n_nodes, n_q) of the node angles theta = T q, a dense array: not for large systems."""
        return self.node_rows.dense

    @property
    def S(self) -> FloatArray:
        """Matrix S (n_nodes, n_x) of the node angles theta = S x that follow the imposed angles x."""
        return self.imposed_node_rows.dense

    @property
    def imposed_rows(self) -> FloatArray:
        """Matrix (n_laws, n_x) of the part of each law's angle gamma that follows the imposed angles."""
        return self.imposed_law_rows.dense

    @cached_property
    def node_index(self) -> dict[str, int]:
        return {node: index for index, node in enumerate(self.nodes)}

    def rows_of(self, row: dict[str, Any]) -> tuple[FloatArray, FloatArray]:
        """Coefficients over the coordinates (n_q,), and over the imposed angles (n_x,), of a row given over nodes."""
        coefficients = np.zeros(len(self._column))
        for column, value in self.columns_of(self.kinematics.reduction.in_floats(exact_row(row))).items():
            coefficients[column] = value
        n = self.system.n_coordinates
        return coefficients[:n], coefficients[n:]

    def columns_of(self, row: Mapping[str, Any], number: Callable[[Any], Any] = float) -> dict[int, Any]:
        """Coefficients of a row by column number (coordinates, then imposed angles) from those by name."""
        return {self._column[name]: number(coefficient) for name, coefficient in row.items()}

    @cached_property
    def _column(self) -> dict[str, int]:
        names = (*self.kinematics.coordinates, *map(pseudo_node, self.kinematics.imposed))
        return {name: column for column, name in enumerate(names)}

    @cached_property
    def law_columns(self) -> tuple[dict[int, float], ...]:
        """Coefficients of every law's angle gamma by column number, of coordinates and then imposed angles."""
        n = self.system.n_coordinates
        pairs = zip(self.system.law_rows.maps, self.imposed_law_rows.maps, strict=True)
        return tuple({**free, **{n + j: a for j, a in imposed.items()}} for free, imposed in pairs)

    @cached_property
    def laws(self) -> tuple[Law, ...]:
        """Laws (inertia, damping, stiffness) of the rows of ``system``, in their order, with exact coefficients."""
        return tuple(law for _, law in self.kinematics.laws if law.acts)

    @cached_property
    def exact_rows(self) -> tuple[dict[str, Fraction], ...]:
        """Row of each law of ``system`` over coordinates and imposed angles, as exact rationals by name."""
        return tuple(exact_row(self.kinematics.reduction.reduced(law.row)) for law in self.laws)


@gc_paused()
def assemble(
    definition: Definition,
    values: Mapping[str, Any],
    referred_to: tuple[str, ...] = (),
    like: Assembly | None = None,
) -> Assembly:
    """Assembly of a drivetrain in one configuration, in numbers, from its exact parameter values.

    Where ``like``, of another configuration, has the same rows, they and all that was worked out from them are shared.
    """
    kinematics = solve_kinematics(definition, Values(values), referred_to, like.kinematics if like else None)
    laws = [(owner, law) for owner, law in kinematics.laws if law.acts]
    # J (kg m^2), c (N m s/rad) and k (N m/rad) of every law, each (n_laws,), and the stiffnesses over frequency.
    coefficients = (
        np.array([float(law.inertia) for _, law in laws]),
        np.array([float(law.damping) for _, law in laws]),
        np.array([0.0 if law.loss_factor else float(law.stiffness) for _, law in laws]),
        tuple(_dynamic(index, law) for index, (_, law) in enumerate(laws) if law.table or law.loss_factor),
    )
    actions: tuple[ActionLaw, ...] = ()
    if kinematics.actions:
        from torsionnet.linear.assembly.action_laws import action_laws

        actions = action_laws(kinematics)
    same_actions = like is not None and [law.rows for law in actions] == [law.rows for law in like.system.actions]
    if like is not None and same_actions and _same_rows(kinematics, like.kinematics):
        shared = like.system
        system = RowSystem(shared.law_rows, *coefficients, actions=actions, memo=shared.memo)
        return replace(like, kinematics=kinematics, system=system)
    # theta = T q + S x of the nodes, gamma = a^T theta of the laws: rows over coordinates q and imposed angles x.
    coordinates = {name: column for column, name in enumerate(kinematics.coordinates)}
    imposed = {pseudo_node(name): column for column, name in enumerate(kinematics.imposed)}
    in_floats = kinematics.reduction.in_floats
    nodes = [in_floats({node: 1}) for node in kinematics.nodes]
    rows = [in_floats(exact_row(law.row)) for _, law in laws]
    return Assembly(
        kinematics,
        RowSystem(Rows.named(rows, coordinates), *coefficients, actions=actions),
        node_rows=Rows.named(nodes, coordinates),
        imposed_node_rows=Rows.named(nodes, imposed),
        imposed_law_rows=Rows.named(rows, imposed),
        owners=tuple(owner for owner, _ in laws),
    )


def _same_rows(kinematics: Kinematics, like: Kinematics) -> bool:
    """Whether two kinematics share the solution of their constraints, and have laws on equal rows in equal order."""
    if kinematics.reduction is not like.reduction:
        return False
    ours, theirs = ([(owner, law.row, law.acts) for owner, law in side.laws] for side in (kinematics, like))
    return ours == theirs


def _dynamic(index: int, law: Law) -> tuple[int, DynamicStiffness]:
    if law.table is not None:
        return index, law.table
    from torsionnet.model.element_base.dynamic_stiffness import ComplexStiffness

    return index, ComplexStiffness(complex(float(law.stiffness), float(law.stiffness * law.loss_factor)))


def smallest_rate(system: RowSystem) -> float:
    """Circular frequency in rad/s safely below the slowest motion of the system, for limits at zero frequency."""
    stiff = [*system.stiffness[system.stiffness > 0], *(abs(law.kappa(np.zeros(1))[0]) for _, law in system.dynamic)]
    inertia = float(system.inertia.sum()) + sum(law.inertia_at_rest for _, law in system.dynamic) or 1.0
    drags = np.abs(system.damping)
    damping = float(drags.sum())
    softest = min((float(value) for value in stiff if value > 0), default=1.0)
    drag = min((float(value) for value in drags if value > 0), default=inertia) / inertia
    return min(math.sqrt(softest / inertia), drag, softest / damping if damping else math.inf)
