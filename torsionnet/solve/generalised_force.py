"""How much of an order a mode takes up: the torques of all cylinders summed on its shape, with their phases."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from torsionnet.model.excitations import OrderExcitation
from torsionnet.response.star_diagram import StarDiagram

NOT_EXCITED = 0.01
"""Generalised force, over that of a single cylinder at the largest amplitude of its shaft, that counts as none."""
CANCELLED = 1e-6
"""Sum of unit vectors on a node that is zero but for rounding."""


@dataclass(frozen=True)
class GeneralisedForce:
    """``sum_n phi_n T_n`` in N m, for a shape whose largest angle is 1.

    ``relative`` is its magnitude over the torque of one cylinder at the largest amplitude of the shape, all angles
    referred to the shaft of the excitation.
    """

    value: complex
    relative: float

    @property
    def acts(self) -> bool:
        return self.relative >= NOT_EXCITED


def star_diagram(
    excitation: OrderExcitation, name: str, order: float, shape: Mapping[str, complex], title: str = ""
) -> StarDiagram:
    """The phase vectors of one order on a shape given by node."""
    found = excitation.phase_vectors(order)
    amplitudes = np.array([shape[node] for node, _ in found.values()])
    largest = np.abs(amplitudes).max(initial=0) or 1.0
    vectors = np.array([vector for _, vector in found.values()]) * amplitudes / largest
    return StarDiagram(name, order, tuple(found), tuple(node for node, _ in found.values()), vectors, title)


def generalised_force(
    excitation: OrderExcitation,
    order: float,
    torques: Mapping[str, complex],
    shape: Mapping[str, complex],
    largest: float,
    strongest: float,
) -> GeneralisedForce:
    """Of complex torques by node in the sense of their nodes, N m.

    ``largest`` is the largest angle of the shape, referred to the shaft of the excitation; ``strongest`` the largest
    torque of any order at this speed, of which what cancels leaves rounding.
    """
    value = sum((torque * shape[node] for node, torque in torques.items()), 0j)
    single = max(_single(excitation, order, torques), CANCELLED * strongest) * largest
    return GeneralisedForce(complex(value), abs(value) / single if single > 0 else 0.0)


def _single(excitation: OrderExcitation, order: float, torques: Mapping[str, complex]) -> float:
    """Torque of one cylinder, from nodes on which the unit vectors of the cylinders do not cancel."""
    units = dict.fromkeys(torques, 0j)
    for node, vector in excitation.phase_vectors(order).values():
        units[node] = units.get(node, 0j) + vector
    each = [abs(torque) / abs(units[node]) for node, torque in torques.items() if abs(units[node]) > CANCELLED]
    return max(each or map(abs, torques.values()), default=0.0)
