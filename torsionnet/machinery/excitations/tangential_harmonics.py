"""Entries for tangential pressures by order, as engine makers list them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, TypeAlias

import numpy as np

from torsionnet.base.entries.composite import Composite, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Json, Schema, entry, not_none
from torsionnet.base.errors import Fault
from torsionnet.machinery.excitations.harmonic_torque import TableByOrder
from torsionnet.machinery.excitations.order_excitation import ComplexArray, FloatArray
from torsionnet.machinery.excitations.table_by_pressure import TableByPressure

Tables: TypeAlias = "Mapping[float | None, Mapping[float, TangentialHarmonic]]"
PHASES = ("cosine", "sine")
ORDER_ROUNDING = 1e-5
"""Relative difference of two orders up to which they are the same, as tables give orders with a few digits."""
_SIGNED = Value("tangential pressure", "pressure", lower=None)


@dataclass(frozen=True, kw_only=True)
class TangentialHarmonic(Declared):
    """Order of the tangential pressure: amplitude and phase, or cosine and sine."""

    kind: ClassVar[str] = "tangential harmonic"
    article: ClassVar[str] = "an order"
    form: ClassVar[str] = "{amplitude: 2.1 bar, phase: 30 deg}, or {cosine: 1.8 bar, sine: -1.1 bar}"

    amplitude: float | None = entry(Value("peak value over piston area and crank radius", "pressure"), None)
    phase: float | None = entry(
        Value("of the cosine, or of the sine where phase_of says so", "angle", lower=None), None
    )
    cosine: float | None = entry(_SIGNED, None)
    sine: float | None = entry(_SIGNED, None)

    def contradictions(self) -> list[Fault]:
        polar, parts = (self.amplitude, self.phase), (self.cosine, self.sine)
        given = [pair for pair in (polar, parts) if any(one is not None for one in pair)]
        if len(given) != 1 or None in given[0]:
            return [Fault(f"an order has amplitude and phase, or cosine and sine: {self.form}", on_key=True)]
        return []

    def complex_amplitude(self, phase_of: str) -> complex:
        """Complex amplitude T in Pa of Re T exp(j h phi), with phi = 0 at firing top dead centre."""
        if self.amplitude is None:
            return complex(not_none(self.cosine), -not_none(self.sine))
        return complex(self.amplitude * np.exp(1j * not_none(self.phase)) * (-1j if phase_of == "sine" else 1))


BY_ORDER = TableByOrder("order -> tangential pressure", Nested("", lambda: TangentialHarmonic, "tangential_harmonic"))
_BY_PRESSURE = TableByPressure("mean indicated pressure -> orders", BY_ORDER)


class HarmonicTables(Composite[Tables]):
    """Entry for tangential pressures in a table by order, or in several by mean indicated pressure in Pa.

    A single table has the key None.
    """

    def read(self, raw: object) -> tuple[Any, list[Fault]]:
        if isinstance(raw, Mapping) and (None in raw or any(_names_pressure(key) for key in raw)):
            if None in raw:
                return dict(raw), []
            return _BY_PRESSURE.read(raw)
        table, faults = BY_ORDER.read(raw)
        return {None: table}, faults

    def plain(self, value: Any) -> Json:
        return BY_ORDER.plain(value[None]) if None in value else _BY_PRESSURE.plain(value)

    def schema(self) -> Schema:
        return {**_BY_PRESSURE.schema(), "description": self.description, "additionalProperties": True}

    def definitions(self) -> Schema:
        return _BY_PRESSURE.definitions()


def _names_pressure(key: Any) -> bool:
    """Whether the key of a table is a pressure, as ``27 bar``, and not an order."""
    return (isinstance(key, str) and any(sign.isalpha() for sign in key)) or (isinstance(key, float) and key >= 1e4)


def amplitudes(table: Mapping[float, TangentialHarmonic], orders: FloatArray, phase_of: str) -> ComplexArray:
    """Complex tangential pressure in Pa at orders, shape (n_orders,), from a table by order.

    0 at orders that the table lacks.
    """
    found = np.zeros(len(orders), dtype=complex)
    known = np.array(list(table), dtype=float)
    same, row = np.nonzero(np.abs(orders[:, None] - known) <= ORDER_ROUNDING * known)
    found[same] = np.array([one.complex_amplitude(phase_of) for one in table.values()])[row]
    return found
