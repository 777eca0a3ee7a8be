"""Matrices M, C and K of a drivetrain in numbers, with the map from its coordinates to all nodes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.scalars import read_scalar
from torsionnet.base.entries.spec import EntryError
from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import Number
from torsionnet.base.result_rows import NUMBER_ROWS, Out
from torsionnet.linear.assembly.action_laws import ActionLaw
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray, RowSystem

HIGHEST_POWER = 2
"""Highest power of s in an action that has a place in K, C and M."""


@dataclass(frozen=True)
class SystemMatrices:
    """Matrices of M q'' + C q' + K q = T^T (torques on nodes), with node angles theta = T q.

    Attributes
    ----------
    coordinates : tuple of str
        Nodes whose angles are the coordinates q, in the order of rows and columns.
    nodes : tuple of str
        All nodes, in the order of the rows of ``T``.
    M : (n_q, n_q) array
        Inertia in kg m^2.
    C : (n_q, n_q) array
        Damping in N m s/rad.
    K : (n_q, n_q) array
        Stiffness in N m/rad; complex where it belongs to a frequency.
    T : (n_nodes, n_q) array
        Angles of all nodes per coordinate, without unit.
    frequency : float, optional
        Hz, at which hysteretic and tabulated elements were taken.
    """

    SHOWN: ClassVar = ("coordinates", "M", "C", "K")

    coordinates: tuple[str, ...]
    nodes: tuple[str, ...]
    M: Annotated[FloatArray, Out(schema=NUMBER_ROWS)]
    C: Annotated[FloatArray, Out(schema=NUMBER_ROWS)]
    K: Annotated[NDArray[np.float64] | NDArray[np.complex128], Out(schema=NUMBER_ROWS)]
    T: FloatArray
    frequency: float | None = None

    def _repr_html_(self) -> str:
        from torsionnet.base.table import Column, Table

        columns = tuple(map(Column, ("", *self.coordinates)))
        at = "" if self.frequency is None else f" at {self.frequency:g} Hz"
        matrices = {"M [kg*m^2]": self.M, "C [N*m*s/rad]": self.C, f"K [N*m/rad]{at}": self.K}
        return "\n".join(
            Table(title, columns, tuple(zip(self.coordinates, *matrix.T.tolist(), strict=True))).to_html()
            for title, matrix in matrices.items()
        )


def matrices(drivetrain: AssembledModel, *, at: float | str | None = None) -> SystemMatrices:
    """Matrices M, C and K of the drivetrain in SI units, reflected through its gears to the coordinates kept.

    Parameters
    ----------
    at : float or str, optional
        Frequency in Hz, or with its unit, at which elements that depend on frequency are taken: hysteretic and
        tabulated ones, rubber, continuous shafts. K is complex then.

    Raises
    ------
    UsageError
        Elements that depend on frequency and no frequency; a controller with a delay or states of its own; an
        imposed angle.

    Notes
    -----
    Sums of large and small stiffnesses in one entry have lost digits that the drivetrain itself keeps; responses and
    modes are calculated without these matrices. Controllers without states add to them and make them unsymmetric.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("amt_rig").configured("II")
    >>> system = rig.matrices()
    >>> system.coordinates, system.M.shape, system.T.shape
    (('motor', 'input_shaft'), (2, 2), (5, 2))
    """
    assembly = drivetrain.assembly
    rows = assembly.system
    if assembly.kinematics.imposed:
        names = ", ".join(assembly.kinematics.imposed)
        raise UsageError(
            f"the angle imposed by {names} is no coordinate; matrices hold free coordinates alone",
            kind="unsupported-law",
        )
    frequency = None if at is None else _hertz(at)
    if rows.dynamic and frequency is None:
        names = ", ".join(sorted({assembly.owners[index] for index, _ in rows.dynamic}))
        raise UsageError(
            f'the stiffness of {names} depends on frequency; say at which one, as matrices(at="12 Hz")',
            kind="missing-entry",
        )
    M, C = rows.M.copy(), rows.C.copy()
    K = rows.K.copy() if frequency is None else _at_frequency(rows, 2 * math.pi * frequency)
    for action in rows.actions:
        # The torque of an action drives, where those of laws resist: hence the sign.
        sensed, driven = (assembly.over_coordinates(part) for part in (action.sensed, action.row))
        k, c, J = _direct_terms(action)
        motion = np.outer(driven, sensed)
        K, C, M = K - k * motion, C - c * motion, M - J * motion
    return SystemMatrices(assembly.kinematics.coordinates, assembly.nodes, M, C, K, assembly.T.copy(), frequency)


def _at_frequency(rows: RowSystem, omega: float) -> NDArray[np.complex128]:
    """K with the complex stiffness that laws over frequency have at omega in rad/s, sum of kappa a a^T."""
    K = rows.K.astype(np.complex128)
    kappa = rows.kappa(omega)
    for index, _ in rows.dynamic:
        row = rows.rows[index]
        K += kappa[index] * np.outer(row, row)
    return K


def _direct_terms(action: ActionLaw) -> tuple[float, float, float]:
    """Coefficients of 1, s and s^2 in the law of an action without states of its own."""
    if action.delay:
        raise UsageError(
            f"{action.owner} acts with a delay, which no matrices M, C and K have; use frequency_response",
            kind="unsupported-law",
        )
    if len(action.denominator) > 1 or len(action.numerator) > HIGHEST_POWER + 1:
        raise UsageError(
            f"{action.owner} has states of its own, which M, C and K do not have; use to_control()",
            kind="unsupported-law",
        )
    k, c, J = (*map(float, action.numerator), 0.0, 0.0)[: HIGHEST_POWER + 1]
    return k, c, J


def _hertz(at: float | str) -> float:
    try:
        value = read_scalar(at, "frequency")
    except EntryError as error:
        raise UsageError(f"at: {error}", kind=error.fault.kind) from None
    if not isinstance(value, Number) or value.value < 0:
        raise UsageError(f'at: expected a frequency of at least 0 Hz, got "{at}"', kind="out-of-range")
    return float(value.value)
