"""Entries of the tracking of orders, with their units: bandwidths, angles, steps of speed, stiffness, diameter."""

from __future__ import annotations

import re
from dataclasses import dataclass

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import EntryError, Schema, Spec
from torsionnet.base.errors import got
from torsionnet.signals.orders.vold_kalman import VoldKalman

TICK = Value("the time of one count", "time", exclusive=True)
TOP_DEAD_CENTRE = Value("an angle of the reference shaft", "angle", lower=None)
STEP = Value("a step of speed", "speed", exclusive=True)
STIFFNESS = Value("a torsional stiffness", "stiffness", exclusive=True)
DIAMETER = Value("a diameter", "length", exclusive=True)
MOST_ORDERS = 2000
"""Most orders of a list, as more only come from a step that is too fine."""


@dataclass(frozen=True)
class Bandwidth(Spec[VoldKalman]):
    """Entry for the bandwidth of Vold-Kalman filters, a frequency, or a share of the frequency of each order."""

    def coerce(self, raw: object) -> VoldKalman:
        if isinstance(raw, VoldKalman):
            return raw
        text = str(raw).strip()
        if text.endswith("%"):
            share = Value(self.description, "1", exclusive=True, below=1.0).coerce(text)
            return VoldKalman(share=share)
        return VoldKalman(bandwidth=Value(self.description, "frequency", exclusive=True).coerce(text))

    def plain(self, value: VoldKalman) -> str:
        return f"{100 * value.share!r}%" if value.share else f"{value.bandwidth!r} Hz"

    def schema(self) -> Schema:
        return {"type": "string", "description": self.description}

    @property
    def accepted(self) -> str:
        return "str"


@dataclass(frozen=True)
class OrderList(Spec[tuple[float, ...]]):
    """Entry for orders, one by one as ``0.5, 1, 3``, or from the first to the last with a step as ``0.5:12:0.5``."""

    rising: bool = True

    def coerce(self, raw: object) -> tuple[float, ...]:
        orders: list[float] = []
        if isinstance(raw, list | tuple):
            raw = ",".join(map(str, raw))
        for part in re.split(r"[,;\s]+", str(raw).strip()):
            ends = [self._number(text, part) for text in part.split(":")]
            if len(ends) == 1:
                orders += ends
            elif len(ends) == 3 and ends[2] > 0 and ends[1] >= ends[0]:
                count = int((ends[1] - ends[0]) / ends[2] * (1 + 1e-9)) + 1
                if count > MOST_ORDERS:
                    raise EntryError(f'"{part}" means {count} orders; take a larger step', kind="too-large")
                orders += [ends[0] + ends[2] * place for place in range(count)]
            else:
                raise EntryError(f'"{part}": orders are numbers, or first:last:step as 0.5:12:0.5', kind="wrong-form")
        if not orders or min(orders) <= 0:
            raise EntryError(
                f"orders are positive numbers of vibrations per revolution, {got(raw)}", kind="out-of-range"
            )
        return tuple(sorted(set(orders)) if self.rising else dict.fromkeys(orders))

    @staticmethod
    def _number(text: str, part: str) -> float:
        try:
            value = float(text)
        except ValueError:
            raise EntryError(
                f'"{part}": orders are numbers, or first:last:step as 0.5:12:0.5', kind="wrong-form"
            ) from None
        if not abs(value) < float("inf"):
            raise EntryError(f'"{part}": orders are finite numbers', kind="not-finite")
        return value

    def plain(self, value: tuple[float, ...]) -> str:
        return ", ".join(map(repr, value))

    def schema(self) -> Schema:
        single: Schema = {"type": ["number", "string"]}
        return {"anyOf": [single, {"type": "array", "items": single, "minItems": 1}], "description": self.description}

    @property
    def accepted(self) -> str:
        return "float | str | Sequence[float]"


BANDWIDTH = Bandwidth("a bandwidth of Vold-Kalman filters")
ORDERS = OrderList("orders")
ORDERS_AS_GIVEN = OrderList("orders", rising=False)
