"""Readings of sensors as linear expressions of the motion and of applied torques.

Every reading is a sum of terms coefficient(s) * gamma, gamma = a^T theta, and a direct share of applied torques, which
only the torque through a rigid connection has. Solvers that care about accuracy keep the gap of such a connection as a
column of its own, because these terms may cancel.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

import numpy as np

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.assembly.system import Assembly
from torsionnet.core.errors import UsageError, did_you_mean
from torsionnet.model.channels import UNITS, Sensor
from torsionnet.model.definition import all_nodes
from torsionnet.model.elements import Values
from torsionnet.model.elimination import exact
from torsionnet.model.kinematics import exact_row
from torsionnet.model.readings import balance, reading
from torsionnet.response import Channel


@dataclass(frozen=True)
class Term:
    """Term of a sensor's reading, factor * s^power * (row theta), or with ``law`` factor * kappa_law(s) * (row theta).

    ``columns`` is the row over the ``n_coordinates`` coordinates and, after them, imposed angles: the floats of
    ``exact``.
    """

    columns: Mapping[int, float]
    n_coordinates: int
    exact: Mapping[str, Fraction]
    factor: Fraction
    power: int = 0
    law: int | None = None

    @property
    def row(self) -> FloatArray:
        """Coefficients (n_q,) of the coordinates in the angle of the term, a dense array: not for large systems."""
        row = np.zeros(self.n_coordinates)
        for column, coefficient in self.columns.items():
            if column < self.n_coordinates:
                row[column] = coefficient
        return row


@dataclass(frozen=True)
class Functional:
    """Reading of a sensor as a linear expression of the motion and of the torques applied to nodes.

    ``sensor`` is None for an excitation in the place of a measured input; ``applied`` is empty unless the torque of a
    rigid connection is read. ``actions`` are the factors of the torques of actions that belong to the element read;
    what actions apply to nodes counts with ``applied``.
    """

    name: str
    unit: str
    terms: tuple[Term, ...]
    applied: Mapping[str, Fraction] = field(default_factory=dict)
    actions: Mapping[int, Fraction] = field(default_factory=dict)
    sensor: Sensor | None = None

    @property
    def channel(self) -> Channel:
        """Channel of the reading, with its name and unit."""
        return Channel(self.name, self.unit)

    def direct(self, row: Mapping[str, int]) -> Fraction:
        """Factor from torques on the nodes of a row to the reading without any motion (direct feedthrough)."""
        return sum((share * self.applied.get(node, Fraction(0)) for node, share in row.items()), start=Fraction(0))


def coefficient(term: Term, kappa: LawStiffness) -> ComplexArray:
    """Factor on the angle of a term at all points, s^power or the dynamic stiffness of its law, shape (n_points,)."""
    return np.asarray(float(term.factor) * (kappa.s**term.power if term.law is None else kappa.of(term.law)))


def powers_of_s(assembly: Assembly, term: Term) -> tuple[Fraction, Fraction, Fraction]:
    """Coefficients of 1, s and s^2 (SI) in the law of a term; of a term without law, 1 at its power of s and 0 else."""
    if term.law is None:
        return Fraction(term.power == 0), Fraction(term.power == 1), Fraction(term.power == 2)
    law = assembly.laws[term.law]
    return exact(law.stiffness), exact(law.damping), exact(law.inertia)


def functional(drivetrain: AssembledModel, sensor: Sensor, name: str = "") -> Functional:
    """Reading of a sensor of a drivetrain as a linear expression of the motion and of applied torques.

    Raises
    ------
    UsageError
        The node, element or port does not exist or is switched off, or the torque is statically indeterminate.
    """
    assembly, definition = drivetrain.assembly, drivetrain.definition
    if sensor.is_on_element:
        _require(sensor.of, drivetrain.elements, "element", definition.elements)
    else:
        for node in sensor.nodes:
            _require(node, drivetrain.nodes, "node", all_nodes(definition.elements.values()))
    laws = ((owner, law.row) for owner, law in zip(assembly.owners, assembly.laws, strict=True))
    values = Values(drivetrain.exact_values)
    actions = ((one.owner, one.nodes) for one in assembly.system.actions)
    read = reading(sensor, drivetrain.elements, values, laws, assembly.kinematics.constraints, actions)
    found = Functional(name or str(sensor), UNITS[sensor.quantity], (), sensor=sensor)
    if read.row is not None:
        return replace(found, terms=(_motion(assembly, read.row, read.power),))
    balanced = balance(read, assembly.kinematics, [law.row for law in assembly.laws])
    terms = tuple(_law_term(assembly, law, factor) for law, factor in balanced.laws if factor)
    own = {number: exact(factor) for number, factor in read.actions.items()}
    return replace(found, terms=terms, applied=balanced.applied, actions=own)


def _require(name: str, known: Any, what: str, switched_off: Any = ()) -> None:
    if name in known:
        return
    if name in switched_off:
        raise UsageError(f'{what} "{name}" is switched off in this configuration; nothing can be measured there')
    raise UsageError(f'no {what} is named "{name}"{did_you_mean(name, known)}')


def _motion(assembly: Assembly, row: Mapping[str, Any], power: int) -> Term:
    exact = exact_row(assembly.kinematics.reduced(row))
    return Term(assembly.columns_of(exact), assembly.system.n_coordinates, exact, factor=Fraction(1), power=power)


def _law_term(assembly: Assembly, index: int, factor: Fraction) -> Term:
    columns, n_coordinates = assembly.law_columns[index], assembly.system.n_coordinates
    return Term(columns, n_coordinates, assembly.exact_rows[index], factor=factor, law=index)
