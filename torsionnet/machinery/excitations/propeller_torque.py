"""Excitation by the torque of a propeller at multiples of its blades."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.composite import Named, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value, is_quantity
from torsionnet.base.entries.spec import Count, EntryError, OneOf, Text, entry, name_fault
from torsionnet.base.errors import EntryPath, Fault, got, unfit_word
from torsionnet.machinery.excitations.harmonic_torque import TableByOrder
from torsionnet.machinery.excitations.order_excitation import (
    FloatArray,
    OrderExcitation,
    OrderTorques,
    Rating,
    register_excitation,
)
from torsionnet.model.element_base.element_entries import NodeName

ZERO_PITCH = "zero_pitch"
"""Name of a propeller's condition that only a controllable pitch makes possible."""


@dataclass(frozen=True, kw_only=True)
class BladeOrder(Declared):
    """Share of the mean torque and phase of one multiple of the blades."""

    kind: ClassVar[str] = "blade order"
    article: ClassVar[str] = "a blade order"
    form: ClassVar[str] = "{share: 6 %, phase: 30 deg}"

    share: float = entry(Value("amplitude over mean torque, as 6 %", "1", below=1))
    phase: float = entry(Value("the torque taken is share * Q * cos(order * phi + phase)", "angle", lower=None), 0)


BLADE_ORDER = Nested("share and phase", lambda: BladeOrder, "blade_order")
_BLADE_ORDERS = TableByOrder("multiple of the blades -> share of the mean torque and phase", BLADE_ORDER)


class ShareOfFullAhead(Value):
    """Entry of a torque over that of full ahead; a torque in N m is told what is wanted."""

    def coerce(self, raw: object) -> float:
        try:
            return super().coerce(raw)
        except EntryError:
            if is_quantity(raw, "torque"):
                raise EntryError(
                    f"a share of the mean torque at full ahead, as 11.2 %, is expected, {got(raw)}", kind="wrong-form"
                ) from None
            raise


@dataclass(frozen=True, kw_only=True)
class PropellerCondition(Declared):
    """Torque of a propeller in another condition than full ahead: at zero pitch, astern, in ice, out of the water."""

    kind: ClassVar[str] = "condition"
    article: ClassVar[str] = "a condition"
    form: ClassVar[str] = "{torque: 20 %, blade_orders: {1: {share: 10 %}}}"

    torque: float = entry(
        ShareOfFullAhead("its mean torque over that of full ahead at rated speed", "1", exclusive=True), 1
    )
    exponent: float | None = entry(
        Value("its mean torque follows speed/rated to this power; default: as full ahead", "1"), None
    )
    blade_orders: Mapping[float, BladeOrder] = entry(_BLADE_ORDERS)


@register_excitation
@dataclass(frozen=True, kw_only=True)
class PropellerTorque(OrderExcitation):
    """Torque of a propeller's blades beside the mean torque Q(n) = Q_rated (n/n_rated)^exponent.

    At blade order i of z blades it acts with -share_i Q(n) cos(i z phi + phase_i), phi the angle of the propeller. It
    is 0 where the first cylinder of the engine fires (``phase_zero: engine_tdc1``); phases that count from an upright
    blade (``blade``) need the angle by which a blade is past upright there.

    Examples
    --------
    >>> screw = PropellerTorque(node="prop", blades=4, torque="1280 kN*m", rated="105 rpm",
    ...     blade_orders={1: {"share": "6 %"}})
    >>> at_rated = screw.torques(np.array([105 * np.pi / 30]))
    >>> at_rated.orders.tolist(), at_rated.amplitudes.real.round(6).tolist()
    ([4.0], [[[-76800.0]]])
    """

    kind: ClassVar[str] = "propeller"

    node: str = entry(NodeName("the node of the propeller; orders count its revolutions", allow_ground=False))
    blades: int = entry(Count("number of blades", 2, 9))
    blade_orders: Mapping[float, BladeOrder] = entry(_BLADE_ORDERS)
    torque: float = entry(Value("mean torque at rated speed", "torque", exclusive=True))
    rated: float = entry(Value("rated speed of the propeller", "speed", exclusive=True))
    exponent: float = entry(Value("mean torque follows (speed/rated) to this power", "1"), 2)
    pitch: str = entry(OneOf("whether its pitch can be set", ("fixed", "controllable")), "fixed")
    conditions: Mapping[str, PropellerCondition] = entry(
        Named(
            "others than full ahead, such as zero_pitch, astern, iced",
            Nested("its torque and blade orders", lambda: PropellerCondition, "propeller_condition"),
            refused=name_fault,
        ),
        None,
    )
    condition: str = entry(Text("which of them it is in; default: full ahead", "the name of a condition"), "")
    phase_zero: str = entry(OneOf("where phases count from", ("engine_tdc1", "blade")), "engine_tdc1")
    blade_angle: float | None = entry(
        Value("by how much a blade is past upright where the first cylinder fires", "angle", None), None
    )

    def contradictions(self) -> list[Fault]:
        return [*self._wrong_orders(), *self._wrong_conditions(), *self._wrong_zero()]

    def _wrong_orders(self) -> Iterator[Fault]:
        tables: dict[EntryPath, Any] = {("blade_orders",): self.blade_orders}
        tables |= {("conditions", name, "blade_orders"): case.blade_orders for name, case in self.conditions.items()}
        for path, table in tables.items():
            for order in table:
                if order != round(order):
                    text = f"a blade order is a whole multiple of the blades: 1, 2, ...; got {order:g}"
                    yield Fault(text, path, kind="contradicting-values")
                    break

    def remarks(self, speeds: FloatArray | None) -> list[Fault]:
        del speeds
        return list(self._orders_of_the_shaft())

    def _orders_of_the_shaft(self) -> Iterator[Fault]:
        """Warnings of blade orders that were probably counted in revolutions of the shaft.

        4 and 8 of 4 blades, without 1.
        """
        tables: dict[EntryPath, Any] = {("blade_orders",): self.blade_orders}
        tables |= {("conditions", name, "blade_orders"): case.blade_orders for name, case in self.conditions.items()}
        for path, table in tables.items():
            # Blade order 1 is the largest in most wakes: a table of multiples of the blade number without it probably
            # counts revolutions of the shaft.
            if table and all(order % self.blades == 0 for order in table):
                first = min(table)
                text = f"blade order {first:g} of {self.blades} blades is {first * self.blades:g} times a revolution"
                meant = f"{first / self.blades:g}"
                text += f"; blade orders are multiples of the blades: did you mean {meant}?"
                yield Fault(text, path, "warning", meant=meant, kind="implausible-size")

    def _wrong_conditions(self) -> Iterator[Fault]:
        if self.pitch == "fixed" and ZERO_PITCH in self.conditions:
            text = "a propeller of fixed pitch has no zero pitch; write pitch: controllable"
            yield Fault(text, ("conditions", ZERO_PITCH), on_key=True, kind="needless-entry")
        if self.condition and self.condition not in self.conditions:
            known = ", ".join(self.conditions)
            rest = f"there are {known}" if known else "there are none"
            text = f'the propeller has no condition "{self.condition}"'
            yield unfit_word(text, self.condition, self.conditions, ("condition",), rest)

    def _wrong_zero(self) -> Iterator[Fault]:
        if self.phase_zero == "blade" and self.blade_angle is None:
            text = "phases from an upright blade need its angle where the first cylinder fires: blade_angle: 15 deg"
            yield Fault(text, ("phase_zero",), kind="missing-entry")
        if self.phase_zero != "blade" and self.blade_angle is not None:
            yield Fault(
                "phases count from engine_tdc1; a blade angle goes with phase_zero: blade",
                ("blade_angle",),
                kind="needless-entry",
            )

    @property
    def shaft(self) -> str:
        return str(self.node)

    @property
    def node_entries(self) -> tuple[tuple[EntryPath, str], ...]:
        return ((("node",), self.node),)

    @property
    def law(self) -> tuple[float, float]:
        """Mean torque of the propeller in N m at rated speed in the present condition, and its exponent over speed."""
        if not self.condition:
            return float(self.torque), float(self.exponent)
        present = self.conditions[self.condition]
        own = self.exponent if present.exponent is None else present.exponent
        return float(self.torque * present.torque), float(own)

    @property
    def rating(self) -> Rating:
        torque, exponent = self.law
        return Rating(-torque, ("torque",), self.rated, ("rated",), exponent=exponent)

    def torques(self, speeds: FloatArray) -> OrderTorques:
        table = (self.conditions[self.condition] if self.condition else self).blade_orders
        torque, exponent = self.law
        # Q(n) = Q_rated (n/n_rated)^exponent, of which each blade order is a share.
        mean = torque * (speeds / self.rated) ** exponent
        orders = self.blades * np.array([float(order) for order in table])
        shares = np.array([part.share * np.exp(1j * part.phase) for part in table.values()])
        # A blade past upright by beta where phi = 0: cos(i z (phi + beta) + phase).
        shares = shares * np.exp(1j * orders * (self.blade_angle or 0.0))
        # The torque of a propeller brakes its shaft, hence the sign.
        return OrderTorques(orders, self.nodes, -(mean[:, None] * shares)[:, :, None])
