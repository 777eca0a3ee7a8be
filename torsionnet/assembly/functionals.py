"""What sensors read, as linear functionals of motion and applied torque.

Every reading is a sum of terms coefficient(s) * gamma, gamma = a^T theta, plus reactions. The torque through a rigid
connection is its multiplier, the reaction on its gap: with a virtual motion z that violates that constraint alone by
one, lambda = z^T (B u - D(s) theta). Written out it is a sum of terms and a direct share of applied torques; solvers
that care about accuracy keep the gap as a column of its own, because these terms may cancel.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.assembly.system import Assembly
from torsionnet.core.errors import UsageError, did_you_mean
from torsionnet.model.channels import SENSOR_QUANTITIES, UNITS, Sensor, port_fault
from torsionnet.model.definition import all_nodes
from torsionnet.model.elements import GROUND, Element, Values
from torsionnet.model.elimination import exact
from torsionnet.model.kinematics import exact_row, virtual_motion


@dataclass(frozen=True)
class Term:
    """factor * s^power * (row theta), or with ``law`` factor * kappa_law(s) * (row theta).

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
        """The row over the coordinates as an array (n_q,): not for large systems."""
        row = np.zeros(self.n_coordinates)
        for column, coefficient in self.columns.items():
            if column < self.n_coordinates:
                row[column] = coefficient
        return row


@dataclass(frozen=True)
class Reaction:
    """Torque of a rigid connection, ``factor`` times the multiplier of constraint number ``constraint``.

    Attributes
    ----------
    constraint : int
    factor : Fraction
    motion : mapping
        Node -> angle in the virtual motion z that opens the gap of this constraint by one.
    work : mapping
        Law -> a^T z, how far z moves its row.
    terms : tuple of Term
        The same torque as a sum over these laws.
    """

    constraint: int
    factor: Fraction
    motion: Mapping[str, Fraction]
    work: Mapping[int, Fraction]
    terms: tuple[Term, ...]


@dataclass(frozen=True)
class Functional:
    """A reading: ``own`` terms of motion, and reactions of rigid connections."""

    name: str
    unit: str
    own: tuple[Term, ...]
    reactions: tuple[Reaction, ...] = ()

    @cached_property
    def terms(self) -> tuple[Term, ...]:
        """Everything as terms of motion, but for what ``applied`` says."""
        return (*self.own, *(term for reaction in self.reactions for term in reaction.terms))

    def applied(self, node: str) -> Fraction:
        """Share of a torque applied at a node that is read without any motion, besides ``terms``."""
        shares = (reaction.factor * reaction.motion.get(node, 0) for reaction in self.reactions)
        return sum(shares, start=Fraction(0))

    @cached_property
    def direct(self) -> dict[str, float]:
        """These shares by node."""
        nodes = {node for reaction in self.reactions for node in reaction.motion}
        return {node: float(self.applied(node)) for node in sorted(nodes)}


def coefficient(term: Term, kappa: LawStiffness) -> ComplexArray:
    """What the motion of a term is multiplied with, shape (n_points,)."""
    return np.asarray(float(term.factor) * (kappa.s**term.power if term.law is None else kappa.of(term.law)))


def functional(drivetrain: AssembledModel, sensor: Sensor, name: str = "") -> Functional:
    """The functional of a sensor.

    Raises
    ------
    UsageError
        The node, element or port does not exist or is switched off, or the torque is statically indeterminate.
    """
    assembly = drivetrain.assembly
    label, unit = name or str(sensor), UNITS.get(sensor.quantity, "")
    if sensor.quantity in ("angle", "velocity", "acceleration"):
        _require(sensor.of, drivetrain.nodes, "node", all_nodes(drivetrain.definition.elements.values()))
        power = ("angle", "velocity", "acceleration").index(sensor.quantity)
        return Functional(label, unit, (_motion(assembly, {sensor.of: 1}, power),))
    if sensor.quantity not in SENSOR_QUANTITIES:
        raise UsageError(f'"{sensor.quantity}" is no quantity of a sensor; choose {", ".join(SENSOR_QUANTITIES)}')
    _require(sensor.of, drivetrain.elements, "element", drivetrain.definition.elements)
    element = drivetrain.elements[sensor.of]
    if sensor.quantity == "twist":
        row = element.twist(Values(drivetrain.exact_values))
        return Functional(label, unit, (_motion(assembly, row, 0),))
    return _torque(assembly, element, sensor.at, label)


def _require(name: str, known: Any, what: str, switched_off: Any = ()) -> None:
    if name in known:
        return
    if name in switched_off:
        raise UsageError(f'{what} "{name}" is switched off in this configuration; nothing can be measured there')
    raise UsageError(f'no {what} is named "{name}"{did_you_mean(name, known)}')


def _motion(assembly: Assembly, row: Mapping[str, Any], power: int) -> Term:
    exact = exact_row(assembly.kinematics.reduced(row))
    return Term(assembly.columns_of(exact), assembly.system.n_coordinates, exact, factor=Fraction(1), power=power)


def port_of(element: Element, at: str | None) -> tuple[str, int]:
    """(node, sign) of a port given by its own name or its node: +1 into the element at the first port, else -1.

    A connection without inertia hands on to ground what it takes at its other end, so that end is returned instead.
    """
    ports = list(element.ports.items())
    index = 0 if at is None else _port_index(element, at)
    if ports[index][1] == GROUND:
        index = _other_end(element, index)
    return ports[index][1], 1 if index == 0 else -1


def _port_index(element: Element, at: str) -> int:
    fault = port_fault(element, at)
    if fault:
        raise UsageError(fault)
    return next(index for index, names in enumerate(element.ports.items()) if at in names)


def _other_end(element: Element, index: int) -> int:
    if element.glyph in ("spring", "damper", "coupling") and len(element.ports) == 2:
        return 1 - index
    raise UsageError(
        f"attach {element.name} to a node with a lock instead of ground to read the torque it hands over there"
    )


def _torque(assembly: Assembly, element: Element, at: str | None, label: str) -> Functional:
    node, sign = port_of(element, at)
    own = tuple(
        _law_term(assembly, index, sign * exact(assembly.laws[index].row[node]))
        for index in assembly.laws_at.get(node, ())
        if assembly.owners[index] == element.name
    )
    reactions = tuple(
        _reaction(assembly, index, sign * exact(row[node]))
        for index, (owner, row) in enumerate(assembly.kinematics.constraints)
        if owner == element.name and node in row
    )
    return Functional(label, UNITS["torque"], own, reactions)


def _law_term(assembly: Assembly, index: int, factor: Fraction) -> Term:
    columns, n_coordinates = assembly.law_columns[index], assembly.system.n_coordinates
    return Term(columns, n_coordinates, assembly.exact_rows[index], factor=factor, law=index)


def _reaction(assembly: Assembly, index: int, factor: Fraction) -> Reaction:
    motion = virtual_motion(assembly.kinematics, index)
    work: dict[int, Fraction] = {}
    for number in sorted({law for node in motion for law in assembly.laws_at.get(node, ())}):
        row = assembly.laws[number].row
        done = sum((exact(a) * motion[node] for node, a in row.items() if node in motion), start=Fraction(0))
        if done:
            work[number] = done
    terms = tuple(_law_term(assembly, number, -factor * done) for number, done in work.items())
    return Reaction(index, factor, motion, work, terms)
