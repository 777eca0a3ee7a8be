"""Spread of the orders of records that repeat one condition, beside the intervals that each of them states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from torsionnet.base.result_rows import Out
from torsionnet.signals.orders.tracked_orders import TrackedOrders

FEWEST_COMMON = 2
"""Fewest speeds that two records must share to be compared."""


@dataclass(frozen=True, eq=False)
class ConditionSpread:
    """Repeatability of one order of a channel over the records of one condition, in SI units of the channel."""

    channel: Annotated[str, Out("channel")]
    condition: Annotated[str, Out("condition")]
    records: Annotated[int, Out("records")]
    order: Annotated[float, Out("order")]
    amplitude: Annotated[float, Out("RMS amplitude", digits=4)]
    spread: Annotated[float, Out("standard deviation between records", digits=4)]
    stated: Annotated[float, Out("standard deviation stated", digits=4)]
    unit: Annotated[str, Out("unit")]

    @property
    def ratio(self) -> Annotated[float, Out("ratio", digits=3)]:
        """Standard deviation between records over that which the intervals state; about 1 where these tell all."""
        return self.spread / self.stated if self.stated else float("nan")


def condition_spread(condition: str, records: Sequence[TrackedOrders]) -> tuple[ConditionSpread, ...]:
    """Repeatability of each order of one channel over two records or more of a condition.

    The records are compared at the speeds of the first, between those of the others linearly, where all of them have
    been; complex values where all phases have a reference, else amplitudes.
    """
    first, tests = records[0], [one.measured() for one in records]
    found = []
    for place, order in enumerate(first.orders.tolist()):
        alike = [test[place] for test in tests]
        low = max(float(one.speeds[0]) for one in alike)
        high = min(float(one.speeds[-1]) for one in alike)
        speeds = alike[0].speeds[(alike[0].speeds >= low) & (alike[0].speeds <= high)]
        if len(speeds) < FEWEST_COMMON:
            continue
        phased = all(one.values is not None for one in alike)
        curves = np.array(
            [np.interp(speeds, one.speeds, one.values if phased and one.values is not None else one.amplitude)
             for one in alike]
        )  # fmt: skip
        unknown = np.full(len(speeds), np.nan)
        widths = np.array(
            [unknown if one.half_widths is None else np.interp(speeds, one.speeds, one.half_widths) for one in alike]
        )
        apart = np.abs(curves - curves.mean(axis=0)) ** 2
        parts = 2 if phased else 1
        spread = float(np.sqrt(apart.sum(axis=0).mean() / (len(alike) - 1) / parts))
        stated = float(np.sqrt(np.mean((widths / 1.96) ** 2)))
        size = float(np.sqrt(np.mean(np.abs(curves) ** 2)))
        found.append(ConditionSpread(first.name, condition, len(alike), order, size, spread, stated, first.unit))
    return tuple(found)
