"""How the rows of sensors move with parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsionnet.assembly.functionals import port_of
from torsionnet.assembly.rows import FloatArray
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import Element, Values
from torsionnet.solve.sensitivity.augmented import Augmented
from torsionnet.solve.sensitivity.dual import DUALS, gradient_of

POWERS = {"angle": 0, "velocity": 1, "acceleration": 2}


@dataclass(frozen=True, eq=False)
class ReadingDerivative:
    """Of y = s^power (m . theta) + sum_i f_i kappa_i (a_i . theta) + sum_j g_j lambda_j, what m, f and g change by.

    Arrays over nodes, laws and conditions, each with a last axis of parameters.
    """

    motion: FloatArray
    laws: FloatArray
    conditions: FloatArray

    @classmethod
    def nothing(cls, system: Augmented) -> ReadingDerivative:
        """Of a row that does not move."""
        (_, n_nodes, count), n_conditions = system.law_slopes.shape, len(system.condition_owners)
        return cls(np.zeros((n_nodes, count)), np.zeros(system.inertia.slopes.shape), np.zeros((n_conditions, count)))


def reading(
    sensor: Sensor, elements: Mapping[str, Element], system: Augmented, nodes: Sequence[str], values: Mapping[str, Any]
) -> ReadingDerivative:
    """Of a sensor that is known to be there."""
    new, count = ReadingDerivative.nothing(system), system.inertia.slopes.shape[1]
    if sensor.quantity == "twist":
        for node, coefficient in elements[sensor.of].twist(Values(values, DUALS)).items():
            new.motion[list(nodes).index(node)] = gradient_of(coefficient, count)
    elif sensor.quantity not in POWERS:  # a torque: everything of the element that acts on the node of the port
        element = elements[sensor.of]
        node, sign = port_of(element, sensor.at)
        for owners, rows, slopes in (
            (system.law_owners, system.law_slopes, new.laws),
            (system.condition_owners, system.condition_slopes, new.conditions),
        ):
            own = [index for index, owner in enumerate(owners) if owner == element.name]
            slopes[own] = sign * rows[own, list(nodes).index(node)]
    return new
