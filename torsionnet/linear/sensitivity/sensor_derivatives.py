"""Derivatives of the coefficients of sensor readings with respect to parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.sensitivity.augmented import Augmented
from torsionnet.linear.sensitivity.dual import DUALS, gradient_of
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import Element, Values
from torsionnet.model.readings import Reading, reading


@dataclass(frozen=True, eq=False)
class ReadingDerivative:
    """Derivatives of the coefficients of a reading by node, law and condition, with respect to parameters.

    They are those of m, f and g in y = s^power (m . theta) + sum_i f_i kappa_i (a_i . theta) + sum_j g_j lambda_j.

    Arrays over nodes, laws and conditions, each with a last axis of parameters.
    """

    motion: FloatArray
    laws: FloatArray
    conditions: FloatArray

    @classmethod
    def nothing(cls, system: Augmented) -> ReadingDerivative:
        """Derivatives of a reading that does not depend on parameters, which are all zero."""
        (_, n_nodes, count), n_conditions = system.law_slopes.shape, len(system.condition_owners)
        return cls(np.zeros((n_nodes, count)), np.zeros(system.inertia.slopes.shape), np.zeros((n_conditions, count)))


def reading_on_duals(
    sensor: Sensor, elements: Mapping[str, Element], system: Augmented, values: Mapping[str, Any]
) -> Reading:
    """Reading of a sensor, known to be present, with coefficients that carry their derivatives."""
    laws = zip(system.law_owners, system.law_rows, strict=True)
    conditions = zip(system.condition_owners, system.condition_rows, strict=True)
    return reading(sensor, elements, Values(values, DUALS), laws, conditions)


def derivative_of(read: Reading, system: Augmented, nodes: Sequence[str]) -> ReadingDerivative:
    """Derivatives of a reading's coefficients by node, law and condition to parameters, from dual numbers."""
    new, count = ReadingDerivative.nothing(system), system.inertia.slopes.shape[1]
    places = {node: place for place, node in enumerate(nodes)}
    motion = {places[node]: number for node, number in (read.row or {}).items() if node in places}
    for numbers, slopes in ((motion, new.motion), (read.laws, new.laws), (read.constraints, new.conditions)):
        for place, number in numbers.items():
            slopes[place] = gradient_of(number, count)
    return new
