"""Readings as functionals of node angles and the torques of rigid conditions, with their derivatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import Element, Values
from torsionnet.model.readings import Reading, reading
from torsionnet.solve.sensitivity.augmented import Augmented
from torsionnet.solve.sensitivity.dual import DUALS, gradient_of


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


def reading_on_duals(
    sensor: Sensor, elements: Mapping[str, Element], system: Augmented, values: Mapping[str, Any]
) -> Reading:
    """What a sensor reads that is known to be there; its numbers carry their derivatives."""
    laws = zip(system.law_owners, system.law_rows, strict=True)
    conditions = zip(system.condition_owners, system.condition_rows, strict=True)
    return reading(sensor, elements, Values(values, DUALS), laws, conditions)


def derivative_of(read: Reading, system: Augmented, nodes: Sequence[str]) -> ReadingDerivative:
    """A reading in arrays."""
    count, row = system.inertia.slopes.shape[1], read.row or {}
    motion = {place: row[node] for place, node in enumerate(nodes) if node in row}
    n_laws, n_conditions = len(system.law_owners), len(system.condition_owners)
    parts = ((motion, len(nodes)), (read.laws, n_laws), (read.constraints, n_conditions))
    return ReadingDerivative(read.power, *(array for part, size in parts for array in _arrays(part, size, count)))


def _arrays(numbers: Mapping[int, Any], size: int, count: int) -> tuple[FloatArray, FloatArray]:
    """Numbers by place as values (size,) and derivatives (size, count)."""
    values, slopes = np.zeros(size), np.zeros((size, count))
    for place, number in numbers.items():
        values[place], slopes[place] = float(number), gradient_of(number, count)
    return values, slopes


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
