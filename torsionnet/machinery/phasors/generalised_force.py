"""Generalised force of an order on a mode, torques of all cylinders summed on its shape with their phases."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.machinery.excitations import OrderExcitation, OrderTorques
from torsionnet.machinery.excitations.order_excitation import TorqueShares
from torsionnet.machinery.orders.worst_case import contributions
from torsionnet.machinery.orders.worst_combination import Contributions, largest_amplitudes
from torsionnet.machinery.phasors.star_diagram import StarDiagram

NOT_EXCITED = 0.01
"""Generalised force, over that of one cylinder at the largest angle of the shape, below which a mode hardly responds
and is not excited.

A larger value hides weak crossings, a smaller one lists more that hardly respond.
"""
CANCELLED = 1e-6
"""Size of a sum of unit phase vectors below which these count as cancelling, far above what rounding leaves."""


@dataclass(frozen=True)
class GeneralisedForce:
    """Generalised force ``|sum_n phi_n T_n|`` in N m on a mode shape scaled to a largest angle of 1, worst case.

    ``relative`` is this force over the torque of one cylinder at the largest amplitude of the shape, all angles
    referred to the shaft of the excitation. ``case`` names the worst case and ``part`` the part out of action in it,
    where there are several cases.
    """

    value: float
    relative: float
    case: str = ""
    part: str = ""

    @property
    def acts(self) -> bool:
        """Whether the generalised force is large enough, over that of one cylinder, to excite the mode."""
        return self.relative >= NOT_EXCITED


def star_diagram(
    excitation: OrderExcitation, name: str, order: float, shape: Mapping[str, complex], title: str = "", out: str = ""
) -> StarDiagram:
    """Star diagram of one order, with phase vectors of the cylinders weighted by a mode shape.

    The part ``out`` is out of action.
    """
    found = {part: (node, 0j if part == out else v) for part, (node, v) in excitation.phase_vectors(order).items()}
    amplitudes = np.array([shape[node] for node, _ in found.values()])
    largest = np.abs(amplitudes).max(initial=0) or 1.0
    vectors = np.array([vector for _, vector in found.values()]) * amplitudes / largest
    return StarDiagram(name, order, tuple(found), tuple(node for node, _ in found.values()), vectors, title)


def generalised_force(
    excitation: OrderExcitation,
    found: OrderTorques,
    at: tuple[int, int],
    shape: Mapping[str, complex],
    largest: float,
) -> GeneralisedForce:
    """Generalised force in N m of an order's torques on a mode shape, in the worst case of misfire and spread.

    Each torque is positive in the sense of its node.

    ``at`` are the indices of speed and line; ``largest`` is the largest angle of the shape, referred to the shaft of
    the excitation.
    """
    speed, line = at
    torques = dict(zip(found.nodes, found.amplitudes[speed, line].tolist(), strict=True))
    # What cancels leaves rounding of the largest torque of any order at this speed.
    strongest = float(np.abs(found.amplitudes[speed]).max())
    single = max(_single(excitation, float(found.orders[line]), torques), CANCELLED * strongest) * largest
    cases = _cases(found, at, shape)
    value = max(one[0] for one in cases)
    worst = [one for one in cases if one[0] >= (1 - CANCELLED) * value]
    _, case, part = worst[0]  # equal cases are named together; where all are equal none is named
    case = "" if 1 < len(worst) == len(cases) else " or ".join(label for _, label, _ in worst)
    return GeneralisedForce(value, value / single if single > 0 else 0.0, case, part)


def _cases(found: OrderTorques, at: tuple[int, int], shape: Mapping[str, complex]) -> list[tuple[float, str, str]]:
    """Generalised force in N m, label and part out of action of every case, each at the worst cylinder spread."""
    speed, line = at
    gains = np.array([shape[node] for node in found.nodes])[None, None, None, :]
    columns = {node: (place, 1.0) for place, node in enumerate(found.nodes)}

    def on_top(shares: TorqueShares) -> Contributions:
        here = replace(shares, amplitudes=shares.amplitudes[:, speed : speed + 1, line : line + 1])
        return contributions("", here, gains, slice(0, 1), columns)

    nominal = np.array(gains[..., 0, :] @ found.amplitudes[speed, line]).reshape(1, 1, 1)
    scatter = [] if found.scatter is None else [on_top(found.scatter)]
    if found.alternatives is None:
        return [(float(largest_amplitudes(nominal, scatter).item()), "", "")]
    changes = on_top(found.alternatives)
    cases = []
    for change, label, part in zip(changes.values, changes.labels, changes.parts, strict=True):
        free = [one.without({("", part)}) for one in scatter]
        cases.append((float(largest_amplitudes(nominal + change, free).item()), label, part))
    return cases


def _single(excitation: OrderExcitation, order: float, torques: Mapping[str, complex]) -> float:
    """Torque amplitude in N m of one cylinder, which is that of a node over the sum of its cylinders' phase vectors."""
    units = dict.fromkeys(torques, 0j)
    for node, vector in excitation.phase_vectors(order).values():
        units[node] = units.get(node, 0j) + vector
    each = [abs(torque) / abs(units[node]) for node, torque in torques.items() if abs(units[node]) > CANCELLED]
    return max(each or map(abs, torques.values()), default=0.0)
