"""Entry for tables over mean indicated pressure, and interpolation between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from torsionnet.base.entries.composite import Composite
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import EntryError, Json, Schema, Spec, Stored_co
from torsionnet.base.errors import Fault, UsageError, got
from torsionnet.machinery.excitations.order_excitation import ComplexArray, FloatArray

MEAN_PRESSURE = Value("a mean indicated pressure", "pressure")
SMALLEST_MEAN_PRESSURE = 1e3
"""Smallest mean indicated pressure in Pa but zero, as a number in bar without its unit lies below."""
PRESSURE_RTOL = 1e-6
"""Relative distance beyond the ends of a pressure table that counts as rounding, as nothing is extrapolated."""


@dataclass(frozen=True, eq=False, repr=False)
class TableByPressure(Composite[Mapping[float, Stored_co]]):
    """Entry for values by mean indicated pressure, stored by rising pressure in Pa."""

    of: Spec[Stored_co]

    def read(self, raw: object) -> tuple[Mapping[float, Stored_co], list[Fault]]:
        if not isinstance(raw, Mapping) or not raw:
            return {}, [Fault(f"expected mean indicated pressures, {{27 bar: {self.of.example}}}, {got(raw)}")]
        table: dict[float, Any] = {}
        faults: list[Fault] = []
        for key, value in raw.items():
            try:
                pressure = mean_pressure(key)
            except EntryError as error:
                faults.append(replace(error.fault, path=(key,), on_key=True))
                continue
            if pressure in table:
                faults.append(Fault(f"{key} stands twice; keep one", (key,), on_key=True))
                continue
            table[pressure], found = self.of.read(value)
            faults += [fault.under(key) for fault in found]
        return dict(sorted(table.items())), faults

    def plain(self, value: Any) -> Json:
        return {f"{pressure!r} Pa": self.of.plain(one) for pressure, one in value.items()}

    def schema(self) -> Schema:
        return {
            "type": "object",
            "description": self.description,
            "additionalProperties": self.of.schema(),
            "minProperties": 1,
        }

    def definitions(self) -> Schema:
        return self.of.definitions()


def mean_pressure(raw: object) -> float:
    """Mean indicated pressure in Pa that an entry gives; EntryError if it is too small for an engine."""
    try:
        pressure = MEAN_PRESSURE.coerce(raw)
    except EntryError as error:
        raise EntryError(f"a mean indicated pressure has its unit, as 27 bar: {error}") from None
    if 0 < pressure < SMALLEST_MEAN_PRESSURE:
        shown = f"{pressure:g} Pa ({pressure / 1e5:.2g} bar)"
        raise EntryError(
            f"{shown} is too small for a mean indicated pressure; a bare number is Pa, write {pressure:g} bar"
        )
    return pressure


def interpolated(known: Sequence[float], values: ComplexArray, wanted: FloatArray) -> ComplexArray:
    """Rows of ``values`` at ``known`` pressures, interpolated at the ``wanted`` pressures, shape (n_wanted, n_orders).

    Raises
    ------
    UsageError
        A pressure outside of the table.
    """
    low, high = known[0], known[-1]
    outside = wanted[(wanted < low * (1 - PRESSURE_RTOL)) | (wanted > high * (1 + PRESSURE_RTOL))]
    if len(outside):
        text = f"a mean indicated pressure of {outside[0] / 1e5:.4g} bar is asked for"
        there = f"{low / 1e5:.4g} to {high / 1e5:.4g} bar" if len(known) > 1 else f"{low / 1e5:.4g} bar only"
        raise UsageError(f"{text}, gas is known for {there}; give what holds there, nothing is extrapolated")
    if len(known) == 1:
        return np.repeat(values, len(wanted), axis=0)
    places = np.clip(np.searchsorted(known, wanted), 1, len(known) - 1)
    pressures = np.asarray(known)
    share = np.clip((wanted - pressures[places - 1]) / (pressures[places] - pressures[places - 1]), 0, 1)[:, None]
    return np.asarray(values[places - 1] * (1 - share) + values[places] * share)
