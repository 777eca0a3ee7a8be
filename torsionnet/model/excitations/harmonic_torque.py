"""A torque given by its orders."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from torsionnet.core.entries.composite import Nested
from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.scalars import Value
from torsionnet.core.entries.spec import EntryError, Schema, Spec, entry
from torsionnet.core.errors import Fault, Path
from torsionnet.model.elements.nodes import NodeName
from torsionnet.model.excitations.order_excitation import (
    ORDER,
    FloatArray,
    OrderExcitation,
    OrderTorques,
    register_excitation,
)

_ANGLE = Value("phase: the torque is amplitude * cos(order * phi + phase)", "angle", lower=None)


@dataclass(frozen=True, kw_only=True)
class TorqueAmplitude(Declared):
    """Peak value and phase of one order."""

    kind: ClassVar[str] = "amplitude"
    article: ClassVar[str] = "an order"
    form: ClassVar[str] = "{amplitude: 12 N*m, phase: 30 deg}"

    amplitude: Any = entry(Value("peak value", "torque"))
    phase: Any = entry(_ANGLE, 0)

    @property
    def complex_amplitude(self) -> complex:
        return complex(self.amplitude * np.exp(1j * self.phase))


@dataclass(frozen=True, eq=False, repr=False)
class ByOrder(Spec):
    """A table by order, a number above 0."""

    of: Nested

    @property
    def absent(self) -> dict[float, Any]:
        return {}

    def read(self, raw: Any) -> tuple[dict[float, Any], list[Fault]]:
        if not isinstance(raw, Mapping) or not raw:
            return {}, [Fault(f"expected orders with what belongs to each, {{2: {self.of.example}}}, got {raw!r}")]
        table: dict[float, Any] = {}
        faults: list[Fault] = []
        for key, value in raw.items():
            try:
                order = ORDER.coerce(key)
            except EntryError as error:
                faults.append(Fault(f"an order is a number: {error}", (key,), on_key=True))
                continue
            if order in table:
                faults.append(Fault(f"order {order:g} stands twice", (key,), on_key=True))
                continue
            table[order], found = self.of.read(value)
            faults += [fault.under(key) for fault in found]
        return table, faults

    def plain(self, value: Any) -> Any:
        return {int(order) if order == int(order) else order: self.of.plain(part) for order, part in value.items()}

    def schema(self) -> Schema:
        return {
            "type": "object",
            "description": self.description,
            "additionalProperties": self.of.schema(),
            "minProperties": 1,
        }

    def definitions(self) -> Schema:
        return self.of.definitions()


AMPLITUDE = Nested("peak value and phase", lambda: TorqueAmplitude, "torque_amplitude")


@register_excitation
@dataclass(frozen=True, kw_only=True)
class HarmonicTorque(OrderExcitation):
    """A torque on a node by orders of a shaft, the same at all speeds.

    Examples
    --------
    >>> fan = HarmonicTorque(node="fan", speed_of="motor", orders={2: {"amplitude": "10 N*m", "phase": "90 deg"}})
    >>> fan.torques(np.array([100.0])).amplitudes.round(9).tolist()
    [[[10j]]]
    """

    kind: ClassVar[str] = "harmonic"

    node: Any = entry(NodeName("the node it acts on", allow_ground=False))
    speed_of: Any = entry(NodeName("the shaft whose orders are given; default: node", allow_ground=False), None)
    orders: Any = entry(ByOrder("order -> peak value and phase", AMPLITUDE))

    @property
    def shaft(self) -> str:
        return str(self.speed_of or self.node)

    @property
    def node_entries(self) -> tuple[tuple[Path, str], ...]:
        return ((("node",), self.node),)

    def torques(self, speeds: FloatArray) -> OrderTorques:
        amplitudes = np.array([part.complex_amplitude for part in self.orders.values()])
        shape = (len(speeds), len(amplitudes), 1)
        return OrderTorques(
            np.array(list(self.orders)), self.nodes, np.broadcast_to(amplitudes[None, :, None], shape).copy()
        )
