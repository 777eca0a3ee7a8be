"""Units in which the numbers of a study are shown, those written in the study, else those written in the model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.expressions import Number
from torsionnet.base.units import CELSIUS, UnitError, parse_unit
from torsionnet.study.answers.answer import AskedStudy, measure_of, units_of
from torsionnet.study.quantities.quantity import ValueInUnit
from torsionnet.study.space.variations.variation import Variation


@dataclass(frozen=True)
class ShownUnits:
    """Units in which parameters and quantities of a study are shown, by their names; others follow the conventions.

    Attributes
    ----------
    written : mapping
        Name -> unit, ``"kN*m/rad"``.
    si : mapping
        Name -> unit in SI, for results that do not say it themselves.
    conventions : Conventions
        Of quantities, as the unit of angles.

    Examples
    --------
    >>> units = ShownUnits({"k_1": "kN*m/rad"}, conventions=Conventions(angle="deg"))
    >>> units.unit("k_1", "N*m/rad"), units.scale("k_1", "N*m/rad")
    ('kN*m/rad', 0.001)
    >>> units.unit("theta", "rad/(N*m)"), round(units.scale("theta", "rad/(N*m)"), 3)
    ('deg/(N*m)', 57.296)
    """

    written: Mapping[str, str] = field(default_factory=dict)
    si: Mapping[str, str] = field(default_factory=dict)
    conventions: Conventions = SI

    def unit(self, name: str, si: str | None = None) -> str:
        """Unit in which a parameter or quantity with the SI unit ``si`` is shown."""
        si = self.si.get(name, "") if si is None else si
        return self.written.get(name) or (self.conventions.unit(si) if si and _factor(si) else si)

    def scale(self, name: str, si: str | None = None) -> float:
        """Factor by which a parameter or quantity in SI is multiplied to be shown in its unit."""
        si = self.si.get(name, "") if si is None else si
        shown = self.unit(name, si)
        factors = [_factor(unit) if unit else 1.0 for unit in (si, shown)]
        return factors[0] / factors[1] if factors[0] and factors[1] else 1.0


IN_SI = ShownUnits()
"""Shown units of results that print every number in SI."""


def _factor(unit: str) -> float | None:
    """Factor from a unit to SI, None if the unit has no factor, such as dB."""
    try:
        return float(parse_unit(unit).factor)
    except UnitError:
        return None


def shown_units(study: AskedStudy, conventions: Conventions | None = None) -> ShownUnits:
    """Shown units of the varied parameters and quantities, by the values in the study, else by those in the model.

    Parameters
    ----------
    study : Study
    conventions : Conventions, optional
        Of quantities to which the study gives no limit with a unit; by default angles are in degrees where limits of
        other quantities have them so.

    Examples
    --------
    >>> import torsionnet as tn
    >>> shown_units(tn.load_study("amt_tolerances")).written["theta_5"]
    'deg/(N*m)'
    """
    written: dict[str, str] = {}
    si = units_of(study) | {name: measure_of(study, name).unit for name in study.quantities}
    for name, variation in study.space.entries.vary.items():
        own = set(_units(variation))
        unit = own.pop() if len(own) == 1 else _unit(study.model.parameter_definitions[name].value)
        if unit and _is_of(unit, si[name]):
            written[name] = unit
    for name, limit in study.limits.items():
        units = [side.unit for side in (limit.below, limit.above) if isinstance(side, ValueInUnit) and side.unit]
        if units and _is_of(units[0], si[name]):
            written[name] = units[0]
    limited = " ".join(written.get(name, "") for name in study.limits)
    usual = Conventions(angle="deg") if "deg" in limited and "rad" not in limited else SI
    return ShownUnits(written, si, conventions or usual)


def _units(variation: Variation) -> Iterator[str]:
    """Yield the units written behind the values of a variation, except percent."""
    for key, _ in variation.specs():
        value = getattr(variation, key)
        for written in value if isinstance(value, tuple) else (value,):
            if (unit := _unit(written)) and unit != "%":
                yield unit


def _unit(value: object) -> str:
    """Unit written behind a value, empty if there is none, or if its zero is not that of SI (degC)."""
    unit = value.unit_written if isinstance(value, Number) else ""
    return "" if unit == CELSIUS else unit


def _is_of(unit: str, si: str) -> bool:
    """Whether a unit has the dimension of the SI unit ``si``, or of rad where ``si`` is empty."""
    try:
        return parse_unit(unit).dimension == parse_unit(si or "rad").dimension
    except UnitError:
        return False
