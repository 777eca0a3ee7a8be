"""What sensors read, as linear functionals of motion and applied torque.

Every reading is a sum of terms coefficient(s) * gamma, gamma = a^T theta, plus a direct share of applied torques. The
torque through a rigid connection is its multiplier: with a virtual motion z that violates that constraint alone by one,
lambda = z^T (B u - D(s) theta), so that it reads like any other sensor.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np

from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.assembly.system import Assembly
from torsionnet.channels import SENSOR_QUANTITIES, UNITS, Sensor, port_fault
from torsionnet.definition import all_nodes
from torsionnet.drivetrain import Drivetrain
from torsionnet.elements import GROUND, Element, Values
from torsionnet.elimination import exact
from torsionnet.errors import UsageError, did_you_mean
from torsionnet.kinematics import exact_row, virtual_motion


@dataclass(frozen=True)
class Term:
    """factor * s^power * (row theta), or with ``law`` factor * kappa_law(s) * (row theta).

    ``row`` and ``imposed`` are the floats of ``exact``, the row over coordinates and imposed angles.
    """

    row: FloatArray
    imposed: FloatArray
    exact: Mapping[str, Fraction]
    factor: Fraction
    power: int = 0
    law: int | None = None


@dataclass(frozen=True)
class Functional:
    """A reading: terms of motion, and ``direct``: node -> share of a torque applied there."""

    name: str
    unit: str
    terms: tuple[Term, ...]
    direct: Mapping[str, float] = field(default_factory=dict)

    def coefficients(self, kappa: LawStiffness) -> ComplexArray:
        """Coefficient of every term, shape (n_lanes, n_terms)."""
        columns = [
            float(term.factor) * (kappa.s**term.power if term.law is None else kappa.of(term.law))
            for term in self.terms
        ]
        return np.stack(columns, axis=1) if columns else np.zeros((kappa.n_lanes, 0), dtype=complex)


def functional(drivetrain: Drivetrain, sensor: Sensor, name: str = "") -> Functional:
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
        msg = f'"{sensor.quantity}" is no quantity of a sensor; choose {", ".join(SENSOR_QUANTITIES)}'
        raise UsageError(msg)
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
        msg = f'{what} "{name}" is switched off in this configuration; nothing can be measured there'
        raise UsageError(msg)
    msg = f'no {what} is named "{name}"{did_you_mean(name, known)}'
    raise UsageError(msg)


def _motion(assembly: Assembly, row: Mapping[str, Any], power: int) -> Term:
    exact = exact_row(assembly.kinematics.reduced(row))
    return Term(*assembly.rows_of(row), exact=exact, factor=Fraction(1), power=power)


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
    if element.glyph in ("spring", "damper", "coupling") and len(element.ports) == 2:  # noqa: PLR2004
        return 1 - index
    msg = f"attach {element.name} to a node with a lock instead of ground to read the torque it hands over there"
    raise UsageError(msg)


def _torque(assembly: Assembly, element: Element, at: str | None, label: str) -> Functional:
    node, sign = port_of(element, at)
    terms: list[Term] = []
    direct: dict[str, float] = {}
    for index, (owner, law) in enumerate(zip(assembly.owners, assembly.laws, strict=True)):
        if owner == element.name and node in law.row:
            terms.append(_law_term(assembly, index, sign * exact(law.row[node])))
    for index, (owner, row) in enumerate(assembly.kinematics.constraints):
        if owner == element.name and node in row:
            more, shares = _multiplier(assembly, index, sign * exact(row[node]))
            terms += more
            direct = {name: direct.get(name, 0.0) + shares.get(name, 0.0) for name in {*direct, *shares}}
    return Functional(label, UNITS["torque"], tuple(terms), direct)


def _law_term(assembly: Assembly, index: int, factor: Fraction) -> Term:
    rows = (assembly.system.rows[index], assembly.imposed_rows[index], assembly.exact_rows[index])
    return Term(*rows, factor=factor, law=index)


def _multiplier(assembly: Assembly, index: int, factor: Fraction) -> tuple[list[Term], dict[str, float]]:
    """Lambda = z^T (B u - D theta) times ``factor``."""
    motion = virtual_motion(assembly.kinematics, index)
    terms = []
    for number, law in enumerate(assembly.laws):
        shares = (exact(coefficient) * motion[node] for node, coefficient in law.row.items() if node in motion)
        work = sum(shares, start=Fraction(0))
        if work:
            terms.append(_law_term(assembly, number, -factor * work))
    return terms, {node: float(factor * value) for node, value in motion.items()}
