"""Assembly of a drivetrain in numbers, theta = T q + S x and the rows of the laws with their coefficients."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from torsionnet.base.packages import gc_paused
from torsionnet.linear.assembly.rows import FloatArray, Rows, RowSystem, action_laws
from torsionnet.model.definition import Definition
from torsionnet.model.elements import Law, Values
from torsionnet.model.kinematics import Kinematics, exact_row, pseudo_node, solve_kinematics

if TYPE_CHECKING:
    from torsionnet.model.element_base.dynamic_stiffness import DynamicStiffness


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
    actions = action_laws(kinematics) if kinematics.actions else ()
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
