"""Entry for tables over mean indicated pressure, and interpolation between them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.composite import Composite, Nested, one_exactly
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value, is_quantity
from torsionnet.base.entries.spec import EntryError, Json, Schema, Spec, Stored_co, entry, not_none
from torsionnet.base.errors import LEAVE_OUT, Fault, Remedy, UsageError, got
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.order_excitation import ComplexArray, FloatArray
from torsionnet.model.load.load_section import TableOverSpeed, value_over_speed

MEAN_PRESSURE = Value("a mean indicated pressure", "pressure")
SMALLEST_MEAN_PRESSURE = 1e3
"""Smallest mean indicated pressure in Pa but zero, as a number in bar without its unit lies below."""
PRESSURE_RTOL, HELD_RTOL = 1e-6, 0.005
"""Relative distances beyond the ends of a pressure table that count as rounding, and up to which the row at the end
holds with a note: pressures from powers and efficiencies are stated to three digits, and nothing is extrapolated."""


@dataclass(frozen=True, eq=False, repr=False)
class TableByPressure(Composite[Mapping[float, Stored_co]]):
    """Entry for values by mean indicated pressure, stored by rising pressure in Pa."""

    of: Spec[Stored_co]

    def read(self, raw: object) -> tuple[Mapping[float, Stored_co], list[Fault]]:
        if not isinstance(raw, Mapping) or not raw:
            return {}, [
                Fault(
                    f"expected mean indicated pressures, {{27 bar: {self.of.example}}}, {got(raw)}", kind="wrong-form"
                )
            ]
        table: dict[float, Any] = {}
        faults: list[Fault] = []
        for key, value in raw.items():
            try:
                pressure = mean_pressure(key)
            except EntryError as error:
                faults.append(replace(error.fault, path=(key,), on_key=True))
                continue
            if pressure in table:
                faults.append(Fault(f"{key} stands twice; keep one", (key,), on_key=True, kind="repeated-name"))
                continue
            table[pressure], wrong = self.of.read(value)
            faults += [fault.under(key) for fault in wrong]
        return dict(sorted(table.items())), faults

    def plain(self, value: Any) -> Json:
        return {f"{pressure!r} Pa": self.of.plain(stored) for pressure, stored in value.items()}

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
        if is_quantity(raw, MEAN_PRESSURE.dimension):
            raise EntryError(
                f"a mean indicated pressure is not below 0, {got(raw)}; a trace whose losses leave less stands at "
                "0 bar",
                kind="out-of-range",
            ) from None
        raise EntryError(f"a mean indicated pressure has its unit, as 27 bar: {error}", kind="missing-unit") from None
    if 0 < pressure < SMALLEST_MEAN_PRESSURE:
        shown = f"{pressure:g} Pa ({pressure / 1e5:.2g} bar)"
        raise EntryError(
            f"{shown} is too small for a mean indicated pressure; a bare number is Pa, write {pressure:g} bar",
            kind="missing-unit",
        )
    return pressure


def interpolated(
    known: Sequence[float], values: ComplexArray, wanted: FloatArray, speeds: FloatArray | None = None
) -> ComplexArray:
    """Rows of ``values`` at ``known`` pressures, interpolated at the ``wanted`` pressures, shape (n_wanted, n_orders).

    ``speeds`` in rad/s at which these are wanted are named where one is outside.

    Raises
    ------
    UsageError
        A pressure outside of the table.
    """
    low, high = known[0], known[-1]
    outside = far_beyond(known, wanted, HELD_RTOL)
    if outside.any():
        at = int(np.argmax(np.where(outside, np.maximum(low - wanted, wanted - high), -np.inf)))
        text = f"a mean indicated pressure of {wanted[at] / 1e5:.4g} bar is asked for"
        there = f"{low / 1e5:.4g} to {high / 1e5:.4g} bar" if len(known) > 1 else f"{low / 1e5:.4g} bar only"
        where = f"at {speeds[at] * RPM:.6g} rpm" if speeds is not None and np.ptp(wanted) > 0 else "there"
        raise UsageError(
            f"{text}, gas is known for {there}; give what holds {where}, nothing is extrapolated", kind="beyond-table"
        )
    if len(known) == 1:
        return np.repeat(values, len(wanted), axis=0)
    places = np.clip(np.searchsorted(known, wanted), 1, len(known) - 1)
    pressures = np.asarray(known)
    # Complex values run straight between neighbouring pressures, order by order.
    share = np.clip((wanted - pressures[places - 1]) / (pressures[places] - pressures[places - 1]), 0, 1)[:, None]
    return np.asarray(values[places - 1] * (1 - share) + values[places] * share)


def far_beyond(known: Sequence[float], wanted: FloatArray, share: float = PRESSURE_RTOL) -> NDArray[np.bool_]:
    """Flags (n_wanted,) of the pressures in Pa that lie further beyond the ends of a table than a share of the end.

    Examples
    --------
    >>> [far_beyond([2e5, 27e5], np.array([27e5, 27.03e5]), share).tolist() for share in (0.005, 0.001)]
    [[False, False], [False, True]]
    """
    return np.asarray((wanted < known[0] * (1 - share)) | (wanted > known[-1] * (1 + share)))


# Load of an engine, its mean indicated pressure over speed.

_THERE = Value("its mean indicated pressure", "pressure")
_PRESSURES = "{300 rpm: 5 bar, 750 rpm: 27 bar}"


@dataclass(frozen=True, kw_only=True)
class EngineLoad(Declared):
    """Mean indicated pressure of an engine at rated speed, or the power it makes, and how it follows the speed.

    On a curve of its own, as of a controllable pitch or a run-up, the pressures stand in a table over speed.

    Examples
    --------
    >>> load = EngineLoad(mean_indicated_pressure="20 bar", rated="750 rpm", exponent=2)
    >>> (load.at(np.array([375.0, 750.0]) * np.pi / 30, swept_volume=0.2, revolutions=2) / 1e5).round(6).tolist()
    [5.0, 20.0]
    """

    kind: ClassVar[str] = "engine load"
    article: ClassVar[str] = "the load of an engine"
    form: ClassVar[str] = "{mean_indicated_pressure: 27 bar, rated: 750 rpm, exponent: 2}"

    mean_indicated_pressure: float | None = entry(MEAN_PRESSURE, None)
    power: float | None = entry(Value("instead: power at the coupling at rated speed", "power", exclusive=True), None)
    mechanical_efficiency: float | None = entry(
        Value("power at the coupling over indicated power", "1", exclusive=True, below=1.0001), None
    )
    rated: float | None = entry(Value("speed to which these belong", "speed", exclusive=True), None)
    exponent: float = entry(
        Value("mean indicated pressure follows (speed/rated) to this power: 2 on a propeller curve", "1", lower=None), 0
    )
    over_speed: tuple[tuple[float, float], ...] = entry(
        TableOverSpeed("instead of all others: mean indicated pressure over the speed", _THERE, _PRESSURES), ()
    )

    def contradictions(self) -> list[Fault]:
        if self.over_speed:
            return self._wrong_table()
        wrong = one_exactly(self, "mean_indicated_pressure", "power", of="a load", form=self.form)
        if wrong:
            return wrong
        if self.power is not None and self.mechanical_efficiency is None:
            text = "the indicated power follows from that at the coupling with mechanical_efficiency: 0.92"
            return [Fault(text, ("power",), on_key=True, kind="missing-entry")]
        if self.power is None and self.mechanical_efficiency is not None:
            text = "a mean indicated pressure needs no mechanical_efficiency; that belongs to a power"
            return [Fault(text, ("mechanical_efficiency",), on_key=True, kind="needless-entry")]
        if self.rated is None and (self.power is not None or self.exponent):
            return [Fault("give the speed at which this is reached: rated: 750 rpm", on_key=True, kind="missing-entry")]
        if self.power is None:
            try:
                mean_pressure(self.mean_indicated_pressure)
            except EntryError as error:
                return [error.fault.under("mean_indicated_pressure")]
        return []

    def _wrong_table(self) -> list[Fault]:
        """Faults of a table over speed with other entries beside it, or with pressures too small for an engine."""
        beside = [name for name in ("mean_indicated_pressure", "power", "rated") if getattr(self, name) is not None]
        if beside:
            text = f"a table over speed says it all; leave out {' and '.join(beside)}"
            return [Fault(text, (beside[0],), on_key=True, remedy=Remedy(LEAVE_OUT), kind="needless-entry")]
        try:
            for _, pressure in self.over_speed:
                mean_pressure(pressure)
        except EntryError as error:
            return [replace(error.fault, path=("over_speed",))]
        return []

    def at(self, speeds: FloatArray, swept_volume: float, revolutions: int) -> FloatArray:
        """Mean indicated pressure in Pa at speeds in rad/s, shape (n_speeds,), of cycles of so many revolutions.

        ``swept_volume`` is that of all cylinders in m^3.

        Raises
        ------
        UsageError
            A speed is outside the table over speed.
        """
        if self.over_speed:
            return np.array([value_over_speed(self.over_speed, float(speed)) for speed in speeds])
        pressure = self.rated_pressure(swept_volume, revolutions)
        follows = (speeds / not_none(self.rated)) ** self.exponent if self.exponent else np.ones(len(speeds))
        return np.asarray(pressure * follows)

    def rated_pressure(self, swept_volume: float, revolutions: int) -> float:
        """Mean indicated pressure in Pa at the rated speed; the largest one of a table over speed."""
        if self.over_speed:
            return max(pressure for _, pressure in self.over_speed)
        if self.mean_indicated_pressure is not None:
            return self.mean_indicated_pressure
        # Indicated power P_e/eta_m, its work per cycle P 2 pi revolutions/Omega, over the swept volume.
        power = not_none(self.power) / not_none(self.mechanical_efficiency)
        return power * 2 * math.pi * revolutions / not_none(self.rated) / swept_volume


LOAD = Nested("mean indicated pressure over speed", lambda: EngineLoad, "engine_load")
