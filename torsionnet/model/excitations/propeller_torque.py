"""The torque of a propeller at multiples of its blades."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from torsionnet.core.entries.composite import Nested
from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.scalars import Value
from torsionnet.core.entries.spec import entry
from torsionnet.core.entries.words import Count
from torsionnet.core.errors import Fault, Path
from torsionnet.model.elements.nodes import NodeName
from torsionnet.model.excitations.harmonic_torque import ByOrder
from torsionnet.model.excitations.order_excitation import FloatArray, OrderExcitation, OrderTorques, register_excitation


@dataclass(frozen=True, kw_only=True)
class BladeOrder(Declared):
    """Share of the mean torque and phase of one multiple of the blades."""

    kind: ClassVar[str] = "blade order"
    article: ClassVar[str] = "a blade order"
    form: ClassVar[str] = "{share: 6 %, phase: 30 deg}"

    share: Any = entry(Value("amplitude over mean torque, as 6 %", "1", below=1))
    phase: Any = entry(Value("the torque taken is share * Q * cos(order * phi + phase)", "angle", lower=None), 0)


BLADE_ORDER = Nested("share and phase", lambda: BladeOrder, "blade_order")


@register_excitation
@dataclass(frozen=True, kw_only=True)
class PropellerTorque(OrderExcitation):
    """What a propeller's blades take from the shaft beside the mean torque Q(n) = Q_rated (n/n_rated)^exponent.

    At blade order i of z blades it acts with -share_i Q(n) cos(i z phi + phase_i), phi the angle of the propeller.

    Examples
    --------
    >>> screw = PropellerTorque(node="prop", blades=4, torque="1280 kN*m", rated="105 rpm",
    ...     blade_orders={1: {"share": "6 %"}})
    >>> at_rated = screw.torques(np.array([105 * np.pi / 30]))
    >>> at_rated.orders.tolist(), at_rated.amplitudes.real.round(6).tolist()
    ([4.0], [[[-76800.0]]])
    """

    kind: ClassVar[str] = "propeller"

    node: Any = entry(NodeName("the node of the propeller; orders count its revolutions", allow_ground=False))
    blades: Any = entry(Count("number of blades", 2, 9))
    blade_orders: Any = entry(ByOrder("multiple of the blades -> share of the mean torque and phase", BLADE_ORDER))
    torque: Any = entry(Value("mean torque at rated speed", "torque", exclusive=True))
    rated: Any = entry(Value("rated speed of the propeller", "speed", exclusive=True))
    exponent: Any = entry(Value("mean torque follows (speed/rated) to this power", "1"), 2)

    def contradictions(self) -> list[Fault]:
        odd = [order for order in self.blade_orders if order != round(order)]
        return (
            [Fault(f"a blade order is a whole multiple of the blades: 1, 2, ...; got {odd[0]:g}", ("blade_orders",))]
            if odd
            else []
        )

    @property
    def shaft(self) -> str:
        return str(self.node)

    @property
    def node_entries(self) -> tuple[tuple[Path, str], ...]:
        return ((("node",), self.node),)

    def torques(self, speeds: FloatArray) -> OrderTorques:
        mean = self.torque * (speeds / self.rated) ** self.exponent
        shares = np.array([part.share * np.exp(1j * part.phase) for part in self.blade_orders.values()])
        orders = self.blades * np.array([float(order) for order in self.blade_orders])
        return OrderTorques(orders, self.nodes, -(mean[:, None] * shares)[:, :, None])
