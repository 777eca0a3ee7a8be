"""Gas torque of a cylinder by order, from pressure traces or tangential harmonics."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, TypeAlias

import numpy as np

from torsionnet.base.entries.composite import Composite, Nested, one_at_most, one_exactly
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import EntryError, Json, OneOf, Schema, Spec, entry, not_none
from torsionnet.base.errors import EntryPath, Fault, got
from torsionnet.machinery.excitations.harmonic_torque import TableByOrder
from torsionnet.machinery.excitations.order_excitation import ComplexArray, FloatArray
from torsionnet.machinery.excitations.pressure_trace import PressureTrace, TraceEntry
from torsionnet.machinery.excitations.table_by_pressure import TableByPressure, interpolated

# Entries for tangential pressures by order, as engine makers list them.

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
        given = [pair for pair in (polar, parts) if any(part is not None for part in pair)]
        if len(given) != 1 or None in given[0]:
            return [
                Fault(
                    f"an order has amplitude and phase, or cosine and sine: {self.form}",
                    on_key=True,
                    kind="missing-entry",
                )
            ]
        return []

    def complex_amplitude(self, phase_of: str) -> complex:
        """Complex amplitude T in Pa of Re T exp(j h phi), with phi = 0 at firing top dead centre."""
        if self.amplitude is None:
            # a cos(h phi) + b sin(h phi) = Re (a - j b) exp(j h phi).
            return complex(not_none(self.cosine), -not_none(self.sine))
        # sin x = cos(x - pi/2): a phase of the sine lies 90 degrees behind, a factor -j.
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
    pressures = np.zeros(len(orders), dtype=complex)
    known = np.array(list(table), dtype=float)
    same, row = np.nonzero(np.abs(orders[:, None] - known) <= ORDER_ROUNDING * known)
    pressures[same] = np.array([harmonic.complex_amplitude(phase_of) for harmonic in table.values()])[row]
    return pressures


# Complex factors on the gas torque by order, with which measured orders correct a trace or a table.


@dataclass(frozen=True, kw_only=True)
class OrderCorrection(Declared):
    """Complex factor on the gas torque of one order: real part, and imaginary part, which leads by 90 degrees."""

    kind: ClassVar[str] = "order correction"
    article: ClassVar[str] = "a correction of an order"
    form: ClassVar[str] = "{real: 1.05, imag: -0.02}"

    real: float = entry(Value("real part of the factor; 1 leaves the order as it is", "1", lower=None), 1)
    imag: float = entry(Value("imaginary part of the factor", "1", lower=None), 0)


def corrections(table: Mapping[float, OrderCorrection], orders: FloatArray) -> ComplexArray:
    """Complex factors without unit on the gas torque at orders, shape (n_orders,); 1 at orders not in the table.

    Examples
    --------
    >>> corrections({3.0: OrderCorrection(real=1.1, imag=0.2)}, np.array([1.5, 3.0])).tolist()
    [(1+0j), (1.1+0.2j)]
    """
    factors = np.ones(len(orders), dtype=complex)
    for order, correction in table.items():
        factors[np.isclose(orders, order)] = complex(correction.real, correction.imag)
    return factors


FIRING_TDC = "firing_tdc"


class ZeroEntry(Spec[float]):
    """Entry for the angle of a trace at firing top dead centre, stored in rad."""

    def coerce(self, raw: object) -> float:
        if raw == FIRING_TDC:
            return 0.0
        try:
            return _ANGLE.coerce(raw)
        except EntryError:
            text = f"expected {FIRING_TDC}, or the crank angle of the traces at firing top dead centre (360 deg)"
            raise EntryError(f"{text}, {got(raw)}", kind="wrong-form") from None

    def plain(self, value: Any) -> Json:
        return _ANGLE.plain(value)

    def schema(self) -> Schema:
        return {"type": ["number", "string"], "description": self.description}


_ANGLE = Value("crank angle", "angle", lower=None)
_TRACE = "pressure over the cycle: p100.csv, or a list at even steps from firing top dead centre on"
"""Description of the entries of an engine for pressure traces."""


@dataclass(frozen=True, kw_only=True)
class GasPressure(Declared):
    """Pressure over one cycle, with injection and without."""

    kind: ClassVar[str] = "gas"
    article: ClassVar[str] = "the gas of an engine"
    form: ClassVar[str] = "{fired: p100.csv, motored: compression.csv, crankcase: 1 bar}"

    fired: PressureTrace | None = entry(TraceEntry(_TRACE), None)
    traces: Mapping[float, PressureTrace] | None = entry(
        TableByPressure(
            "instead: several by mean indicated pressure, {27 bar: p100.csv, 14 bar: p50.csv}", TraceEntry("")
        ),
        None,
    )
    harmonics: Tables | None = entry(
        HarmonicTables("instead: tangential pressure by order, one table or several by mean indicated pressure"), None
    )
    phase_of: str = entry(OneOf("what phases of harmonics are those of", PHASES), "cosine")
    motored: PressureTrace | None = entry(TraceEntry("the pressure without injection, but with compression"), None)
    motored_harmonics: Tables | None = entry(
        HarmonicTables("instead: tangential pressure by order without injection"), None
    )
    correction: Mapping[float, OrderCorrection] = entry(
        TableByOrder(
            "order -> complex factor on the gas torque with injection, as a test of orders finds it",
            Nested("real and imaginary part", lambda: OrderCorrection, "order_correction", shown=OrderCorrection.form),
            fewest=0,
        ),
        None,
    )
    crank_end: PressureTrace | None = entry(
        TraceEntry("pressure below the piston of a double-acting cylinder, over the same angles as above it"), None
    )
    reference: str = entry(OneOf("what the pressures are over", ("absolute", "gauge")), "absolute")
    zero: float = entry(ZeroEntry(f"{FIRING_TDC}, or the angle of the traces at firing top dead centre"), 0.0)
    crankcase: float = entry(Value("absolute pressure below the pistons", "pressure"), "1 bar")
    rated: float | None = entry(
        Value("speed to which a single trace belongs, of exponent", "speed", exclusive=True), None
    )
    exponent: float = entry(Value("gas torque follows speed/rated to this power", "1", lower=None), 0)

    def contradictions(self) -> list[Fault]:
        return [*self._wrong_sources(), *self._wrong_scaling()]

    def _wrong_sources(self) -> Iterator[Fault]:
        yield from one_exactly(self, "fired", "traces", "harmonics", of="gas")
        yield from one_at_most(self, "motored", "motored_harmonics", of="compression without injection")
        if self.motored_harmonics and None not in self.motored_harmonics:
            text = "there is one table without injection, by order: a misfiring cylinder has no indicated pressure"
            yield Fault(text, ("motored_harmonics",), on_key=True, kind="contradicting-entries")

    def _wrong_scaling(self) -> Iterator[Fault]:
        if self.exponent and self.rated is None:
            yield Fault(
                "an exponent needs the speed to which the pressures belong: rated: 105 rpm",
                ("exponent",),
                kind="missing-entry",
            )
        if self.exponent and self.is_by_pressure:
            text = "what is given by mean indicated pressure follows the load of the engine, and no exponent"
            yield Fault(text, ("exponent",), on_key=True, kind="needless-entry")

    @property
    def is_by_pressure(self) -> bool:
        """Whether the engine gives traces or harmonics by mean indicated pressure."""
        return bool(self.traces) or bool(self.harmonics and None not in self.harmonics)

    @property
    def has_motored(self) -> bool:
        return bool(self.motored or self.motored_harmonics)

    @property
    def all_traces(self) -> Iterator[tuple[EntryPath, PressureTrace]]:
        """Path and trace of every pressure trace that the engine gives."""
        for key in ("fired", "motored", "crank_end"):
            if getattr(self, key):
                yield (key,), getattr(self, key)
        for pressure, trace in (self.traces or {}).items():
            yield ("traces", f"{pressure:g}"), trace

    @property
    def own_orders(self) -> tuple[tuple[str, float], ...]:
        """Name of the entry and order of every tangential harmonic that the engine gives."""
        keys = ("harmonics", "motored_harmonics")
        tables = [(key, table) for key in keys for table in (getattr(self, key) or {}).values()]
        return tuple((key, float(order)) for key, table in tables for order in table)

    def fired_harmonics(
        self, crank: Crank, orders: FloatArray, pressures: FloatArray | None, speeds: FloatArray | None = None
    ) -> ComplexArray:
        """Torque by order of a firing cylinder in N m, shape (n_pressures or 1, n_orders), at pressures in Pa.

        ``speeds`` in rad/s, to which the pressures belong, are named where one is not known.
        """
        tables: dict[float | None, ComplexArray] = {}
        if self.harmonics:
            for pressure, table in self.harmonics.items():
                tables[pressure] = crank.factor * amplitudes(table, orders, self.phase_of)
        elif self.traces:
            tables |= {mean: self._of_trace(trace, crank, orders) for mean, trace in self.traces.items()}
        else:
            tables[None] = self._of_trace(not_none(self.fired), crank, orders)
        # The lower side of a double-acting piston adds to all traces alike, before a test corrects their sum.
        values = np.array(list(tables.values())) + self._below_piston(crank, orders)
        values = values * corrections(self.correction, orders)
        known = [pressure for pressure in tables if pressure is not None]
        # A single trace or table holds at all pressures; several are read at the load of the engine.
        return values if not known or pressures is None else interpolated(known, values, pressures, speeds)

    def motored_harmonics_at(self, crank: Crank, orders: FloatArray) -> ComplexArray:
        """Torque of a cylinder without injection in N m by order, shape (n_orders,)."""
        if self.motored:
            return self._of_trace(self.motored, crank, orders) + self._below_piston(crank, orders)
        if self.motored_harmonics:
            return np.asarray(crank.factor * amplitudes(self.motored_harmonics[None], orders, self.phase_of))
        return np.zeros(len(orders), dtype=complex)

    def _of_trace(self, trace: PressureTrace, crank: Crank, orders: FloatArray) -> ComplexArray:
        return np.asarray(crank.factor * trace.harmonics(crank.ratio, crank.revolutions, orders, self.zero, self.below))

    def _below_piston(self, crank: Crank, orders: FloatArray) -> ComplexArray:
        """Torque by order in N m of the pressure below a double-acting piston, shape (n_orders,)."""
        if not self.crank_end:
            return np.zeros(len(orders), dtype=complex)
        # It pushes upwards, against x', on the area that the piston rod leaves.
        return -self._of_trace(self.crank_end, crank, orders) * crank.lower_share

    @property
    def below(self) -> float:
        """Pressure below the pistons in Pa, absolute or over the ambient pressure as the traces are."""
        return float(self.crankcase) if self.reference == "absolute" else 0.0

    def factor(self, speeds: FloatArray) -> FloatArray:
        """Dimensionless factor on the gas torque of the traces at speeds in rad/s, shape (n_speeds,)."""
        return np.asarray((speeds / not_none(self.rated)) ** self.exponent if self.exponent else np.ones(len(speeds)))


GAS = Nested("pressure in the cylinders", lambda: GasPressure, "gas")


@dataclass(frozen=True)
class Crank:
    """Bore, stroke, rod length (m) and cycle of a cylinder's crank mechanism.

    ``rod_diameter`` is that of a piston rod on the lower side.
    """

    bore: float
    stroke: float
    rod_length: float
    revolutions: int
    rod_diameter: float = 0.0

    @property
    def ratio(self) -> float:
        """Crank radius over rod length of the mechanism, dimensionless."""
        return self.stroke / 2 / self.rod_length

    @property
    def radius(self) -> float:
        return self.stroke / 2

    @property
    def factor(self) -> float:
        """Piston area times crank radius in m^3, the gas torque over tangential pressure."""
        return math.pi * self.bore**2 / 4 * self.radius

    @property
    def swept_volume(self) -> float:
        """Swept volume of one cylinder in m^3."""
        return 2 * self.factor

    @property
    def lower_share(self) -> float:
        """Area of the piston's lower side over that of its upper side."""
        return 1 - (self.rod_diameter / self.bore) ** 2
