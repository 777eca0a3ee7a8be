"""Sensors as functionals of node angles and the torques of rigid conditions, with their derivatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsionnet.assembly.functionals import port_of
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import Element, Values
from torsionnet.solve.sensitivity.augmented import Augmented
from torsionnet.solve.sensitivity.dual import DUALS, gradient_of

POWERS = {"angle": 0, "velocity": 1, "acceleration": 2}


@dataclass(frozen=True, eq=False)
class ReadingDerivative:
    """y = s^power (m . theta) + sum_i f_i kappa_i (a_i . theta) + sum_j g_j lambda_j.

    Values and derivatives (with a last axis of parameters) of m over nodes, f over laws, g over conditions.
    """

    power: int
    motion: FloatArray
    motion_slopes: FloatArray
    laws: FloatArray
    law_slopes: FloatArray
    conditions: FloatArray
    condition_slopes: FloatArray


def reading(
    sensor: Sensor, elements: Mapping[str, Element], system: Augmented, nodes: Sequence[str], values: Mapping[str, Any]
) -> ReadingDerivative:
    """The functional of a sensor that is known to be there."""
    count = system.inertia.slopes.shape[1]
    new = _Parts(len(nodes), len(system.law_owners), len(system.condition_owners), count)
    if sensor.quantity in POWERS:
        new.motion[list(nodes).index(sensor.of)] = 1.0
    elif sensor.quantity == "twist":
        for node, coefficient in elements[sensor.of].twist(Values(values, DUALS)).items():
            new.motion[list(nodes).index(node)] = float(coefficient)
            new.motion_slopes[list(nodes).index(node)] = gradient_of(coefficient, count)
    else:
        _torque(new, sensor, elements[sensor.of], system, nodes)
    return ReadingDerivative(
        POWERS.get(sensor.quantity, 0),
        new.motion,
        new.motion_slopes,
        new.laws,
        new.law_slopes,
        new.conditions,
        new.condition_slopes,
    )


class _Parts:
    def __init__(self, n_nodes: int, n_laws: int, n_conditions: int, count: int) -> None:
        self.motion, self.motion_slopes = np.zeros(n_nodes), np.zeros((n_nodes, count))
        self.laws, self.law_slopes = np.zeros(n_laws), np.zeros((n_laws, count))
        self.conditions, self.condition_slopes = np.zeros(n_conditions), np.zeros((n_conditions, count))


def _torque(new: _Parts, sensor: Sensor, element: Element, system: Augmented, nodes: Sequence[str]) -> None:
    """Everything of the element that acts on the node of the port."""
    node, sign = port_of(element, sensor.at)
    column = list(nodes).index(node)
    for owners, rows, factors, slopes in (
        (system.law_owners, system.laws, new.laws, new.law_slopes),
        (system.condition_owners, system.conditions, new.conditions, new.condition_slopes),
    ):
        own = [index for index, owner in enumerate(owners) if owner == element.name]
        factors[own] = sign * rows.values[own, column]
        slopes[own] = sign * rows.slopes[own, column]


def rows_of(
    readings: Sequence[ReadingDerivative], system: Augmented, kappa: ComplexArray, omega: FloatArray
) -> ComplexArray:
    """Rows (n_f, n_readings, n_nodes + n_conditions) with y = row . [theta, lambda]."""
    n_nodes = system.laws.values.shape[1]
    rows = np.zeros((len(omega), len(readings), n_nodes + len(system.condition_owners)), dtype=complex)
    for number, one in enumerate(readings):
        rows[:, number, :n_nodes] = (1j * omega[:, None]) ** one.power * one.motion
        for law in np.flatnonzero(one.laws):
            for column in np.flatnonzero(system.laws.values[law]):
                rows[:, number, column] += kappa[:, law] * (one.laws[law] * system.laws.values[law, column])
        rows[:, number, n_nodes:] = one.conditions
    return rows
