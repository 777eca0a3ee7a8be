"""Measures of damping, converted through the loss factor eta.

For a spring of stiffness k with hysteresis, eta is the energy lost per cycle over 2*pi times the largest elastic
energy. A viscous damper c has the loss factor c*omega/k, so a measure fixes c only at one stated frequency:

    eta = 2*zeta = 1/Q = psi/(2*pi) = c*omega/k,     omega = 2*pi*f
    zeta = delta/sqrt(4*pi^2 + delta^2)

``eta = 2*zeta`` and ``eta = 1/Q`` take k as the stiffness of the oscillator at its own resonance.

>>> convert_damping(0.01, "zeta", "Q")
50.0

Here as well: entries for damping as a viscous coefficient, a loss factor, or another measure of damping.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.scalars import SCALAR_SCHEMA, QuantityKind, plain_scalar, read_scalar
from torsionnet.base.entries.spec import EntryError, Json, Schema, full_name
from torsionnet.base.errors import INSERT, EntryPath, Fault, Remedy, TorsionnetError, did_you_mean, unfit_word
from torsionnet.base.expressions import FLOAT, Algebra, Expression, Number
from torsionnet.base.units import DIMENSIONS


class DampingError(TorsionnetError, ValueError):
    """Error that a damping measure does not exist, or cannot be converted with the values given."""


@dataclass(frozen=True)
class Measure:
    """Damping measure, with the functions that convert its value to the loss factor and back."""

    symbol: str
    name: str
    to_loss_factor: Callable[[Any, Algebra, Any], Any]
    from_loss_factor: Callable[[Any, Algebra, Any], Any]
    dimension: str = "1"
    meaning: str = ""

    @property
    def description(self) -> str:
        """Name of a damping measure, with what it means where the name does not say so."""
        return f"{self.name}: {self.meaning}" if self.meaning else self.name


def _from_decrement(delta: Any, algebra: Algebra, _: Any) -> Any:
    return 2 * delta / algebra.sqrt(4 * algebra.pi**2 + delta**2)


def _to_decrement(eta: Any, algebra: Algebra, _: Any) -> Any:
    return 2 * algebra.pi * eta / algebra.sqrt(4 - eta**2)


MEASURES: dict[str, Measure] = {
    "zeta": Measure("zeta", "damping ratio", lambda x, *_: 2 * x, lambda eta, *_: eta / 2),
    "Q": Measure("Q", "quality factor", lambda x, *_: 1 / x, lambda eta, *_: 1 / eta),
    "magnifier": Measure("M", "dynamic magnifier", lambda x, *_: 1 / x, lambda eta, *_: 1 / eta),
    "eta": Measure("eta", "loss factor", lambda x, *_: x, lambda eta, *_: eta),
    "psi": Measure(
        "psi",
        "relative damping",
        lambda x, algebra, _: x / (2 * algebra.pi),
        lambda eta, algebra, _: 2 * algebra.pi * eta,
        meaning="energy lost per cycle over k*phi^2/2",
    ),
    "log_decrement": Measure(
        "delta",
        "logarithmic decrement of free decay",
        _from_decrement,
        _to_decrement,
    ),
    "c": Measure(
        "c",
        "viscous damping in N*m*s/rad",
        lambda x, _, ratio: x * ratio,
        lambda eta, _, ratio: eta / ratio,
        "damping",
    ),
}
"""Measures of damping such as ``zeta`` and ``Q``, by the name they have in model files."""


def _measure(name: str) -> Measure:
    if name not in MEASURES:
        known = ", ".join(MEASURES)
        raise DampingError(
            f'no measure of damping is named "{name}"{did_you_mean(name, MEASURES)} (known: {known})',
            kind="unknown-word",
        )
    return MEASURES[name]


def convert_damping(
    value: float, measure: str, to: str, *, stiffness: float | None = None, frequency: float | None = None
) -> float:
    """Value of a damping measure converted to another measure, such as ``zeta`` to ``Q``.

    ``c`` needs the stiffness in N*m/rad and the frequency in Hz.

    >>> round(convert_damping(0.05, "eta", "c", stiffness=1000.0, frequency=10.0), 6)
    0.795775
    >>> convert_damping(0.02, "zta", "eta")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    torsionnet.model.damping.DampingError: no measure of damping is named "zta"; did you mean "zeta"? (known: ...
    """
    source, target = _measure(measure), _measure(to)
    if not math.isfinite(value):
        raise DampingError(f"expected a finite number for {measure}, got {value}", kind="not-a-number")
    if source == target:
        return float(value)
    ratio = _omega_over_stiffness(stiffness, frequency) if "c" in (measure, to) else None
    try:
        eta = source.to_loss_factor(float(value), FLOAT, ratio)
        if to == "log_decrement" and abs(eta) >= 2:
            raise DampingError(
                f"{measure} = {value:g} is zeta = {eta / 2:g}; a decrement needs zeta below 1", kind="out-of-range"
            )
        return float(target.from_loss_factor(eta, FLOAT, ratio))
    except ZeroDivisionError:
        raise DampingError(f"{measure} = {value:g} has no finite {to}", kind="not-finite") from None


def _omega_over_stiffness(stiffness: float | None, frequency: float | None) -> float:
    for name, given in (("stiffness in N*m/rad", stiffness), ("frequency in Hz", frequency)):
        if given is None or not (math.isfinite(given) and given > 0):
            got = "" if given is None else f", got {given}"
            raise DampingError(
                f"c and a measure without dimension are related by a positive {name}{got}", kind="out-of-range"
            )
    return 2 * math.pi * (frequency or 0.0) / (stiffness or 1.0)


def _is_zero(value: Any) -> bool:
    # sympy and numpy divide by zero without an exception; an array is left to its owner.
    zero = value == 0
    return getattr(zero, "ndim", 0) == 0 and bool(zero)


@dataclass(frozen=True)
class DampingMeasure:
    """Damping of a spring by a measure, as zeta = 0.02 at 12 Hz, instead of c.

    The measure, its value, and the frequency in Hz where it holds.

    >>> quality = DampingMeasure("Q", Number(20), Number(50))
    >>> round(quality.viscous(1000.0, {}, FLOAT), 6)
    0.159155
    """

    measure: str
    value: Expression
    at: Expression | None = None

    def __post_init__(self) -> None:
        _measure(self.measure)
        given = self.at.unit_dimension if isinstance(self.at, Number) else None
        if given not in (None, DIMENSIONS["frequency"]):
            raise DampingError(f"the frequency where {self.measure} holds is in Hz, not in {given}", kind="wrong-unit")

    @property
    def names(self) -> frozenset[str]:
        """Names of the parameters in the expressions of the measure's value and frequency."""
        return self.value.names | (self.at.names if self.at else frozenset())

    def loss_factor(self, values: Mapping[str, Any], algebra: Algebra) -> Any:
        """Dimensionless loss factor eta equal to the measure, as a number of the given algebra.

        ``c`` has none without a stiffness and a frequency.
        """
        if self.measure == "c":
            raise DampingError(
                "c has a loss factor only at a stiffness and a frequency; use convert_damping", kind="missing-entry"
            )
        value = self.value.evaluate(values, algebra)
        if self.measure in ("Q", "magnifier") and _is_zero(value):
            raise DampingError(
                f'{self.measure} = "{self.value}" is 0, the damping would be infinite', kind="out-of-range"
            )
        return MEASURES[self.measure].to_loss_factor(value, algebra, None)

    def viscous(self, stiffness: Any, values: Mapping[str, Any], algebra: Algebra) -> Any:
        """Viscous damping c = eta*k/(2*pi*f) in N m s/rad, as a number of the given algebra.

        The value itself for the measure ``c``.
        """
        if self.measure == "c":
            return self.value.evaluate(values, algebra)
        if self.at is None:
            raise DampingError(
                f"{self.measure} is a viscous damping only at a frequency; add for example at: 50 Hz",
                kind="missing-entry",
            )
        frequency = self.at.evaluate(values, algebra)
        if _is_zero(frequency):
            raise DampingError(f'the frequency "{self.at}" where {self.measure} holds is 0', kind="out-of-range")
        return self.loss_factor(values, algebra) * stiffness / (2 * algebra.pi * frequency)


class DampingQuantity(QuantityKind[Expression | DampingMeasure]):
    """Entry for a viscous coefficient, or for a damping measure at a stated frequency: ``{zeta: 0.02, at: 12 Hz}``."""

    keys_within: ClassVar[tuple[str, ...]] = tuple(name for name in MEASURES if name != "c")

    def coerce(self, raw: object) -> Expression | DampingMeasure:
        if isinstance(raw, DampingMeasure):
            return raw
        if isinstance(raw, Mapping):
            return self._measure(raw)
        try:
            return read_scalar(raw, self.dimension)
        except EntryError as error:
            if not str(raw).rstrip().endswith("%"):
                raise
            hint = f"a share is a damping ratio at a frequency: write {{zeta: {raw}, at: ... Hz}}"
            raise EntryError(f"{error.fault.message}; {hint}", kind="unknown-unit") from None

    def _measure(self, raw: Mapping[str, Any]) -> DampingMeasure:
        given = [key for key in raw if key != "at"]
        for key in given:
            if key not in MEASURES:
                text, known = f'"{key}" is not a measure of damping', f"known: {', '.join(MEASURES)}"
                raise EntryError(unfit_word(text, str(key), MEASURES, (key,), known, on_key=True))
        if len(given) != 1:
            raise EntryError(
                f"give one measure of damping ({', '.join(MEASURES)}) and at: the frequency where it holds",
                kind="missing-entry",
            )
        measure = given[0]
        if "at" not in raw and measure != "c":
            text = f"{measure} gives a viscous coefficient only at a stated frequency; add at: 12 Hz"
            raise EntryError(Fault(text, remedy=Remedy(INSERT, "12 Hz", keys=("at",)), kind="missing-entry"))
        value = _within(raw[measure], "damping" if measure == "c" else "1", measure)
        at = _within(raw["at"], "frequency", "at") if "at" in raw else None
        return DampingMeasure(measure, value, at)

    def plain(self, value: Any) -> Json:
        if not isinstance(value, DampingMeasure):
            return plain_scalar(value)
        at = {} if value.at is None else {"at": plain_scalar(value.at)}
        return {value.measure: plain_scalar(value.value), **at}

    def schema(self) -> Schema:
        keys = {**dict.fromkeys(MEASURES, SCALAR_SCHEMA), "at": SCALAR_SCHEMA}
        measure: Schema = {"type": "object", "properties": keys, "additionalProperties": False, "minProperties": 1}
        return {"anyOf": [SCALAR_SCHEMA, measure], "description": f"{self.description} [N*m*s/rad]"}

    def expressions(self, value: Any) -> tuple[tuple[EntryPath, Expression, str], ...]:
        if not isinstance(value, DampingMeasure):
            return (((), value, self.dimension),)
        entries: list[tuple[EntryPath, Expression, str]] = [
            ((value.measure,), value.value, "damping" if value.measure == "c" else "1")
        ]
        if value.at is not None:
            entries.append((("at",), value.at, "frequency"))
        return tuple(entries)

    @property
    def accepted(self) -> str:
        return f"Scalar | {full_name(DampingMeasure)} | collections.abc.Mapping[str, Scalar]"


def _within(raw: object, dimension: str, key: str) -> Expression:
    try:
        return read_scalar(raw, dimension)
    except EntryError as error:
        raise EntryError(error.fault.under(key)) from None


class LossFactor(QuantityKind[Expression | DampingMeasure]):
    """Entry for a loss factor eta, or for a damping measure without frequency: ``{zeta: 0.05}``, ``{psi: 0.6}``."""

    keys_within: ClassVar[tuple[str, ...]] = tuple(name for name in MEASURES if name != "c")

    def coerce(self, raw: object) -> Expression | DampingMeasure:
        if isinstance(raw, DampingMeasure):
            return raw
        if not isinstance(raw, Mapping):
            return read_scalar(raw, self.dimension)
        known = [name for name in MEASURES if name != "c"]
        if len(raw) != 1 or next(iter(raw)) not in known:
            raise EntryError(
                f"give a loss factor, or one measure of damping out of {', '.join(known)}", kind="missing-entry"
            )
        measure = next(iter(raw))
        return DampingMeasure(measure, _within(raw[measure], "1", measure), None)

    plain = DampingQuantity.plain

    @property
    def accepted(self) -> str:
        return f"Scalar | {full_name(DampingMeasure)} | collections.abc.Mapping[str, Scalar]"

    def schema(self) -> Schema:
        keys = {name: SCALAR_SCHEMA for name in MEASURES if name != "c"}
        measure: Schema = {"type": "object", "properties": keys, "additionalProperties": False, "minProperties": 1}
        return {"anyOf": [SCALAR_SCHEMA, measure], "description": self.description}

    def expressions(self, value: Any) -> tuple[tuple[EntryPath, Expression, str], ...]:
        if isinstance(value, DampingMeasure):
            return (((value.measure,), value.value, "1"),)
        return (((), value, "1"),)


def loss_factor(entry: Expression | DampingMeasure | None, parameters: Mapping[str, Any], algebra: Algebra) -> Any:
    """Dimensionless loss factor eta of an entry that gives it directly or by a measure of damping.

    0 without an entry.
    """
    if isinstance(entry, DampingMeasure):
        return entry.loss_factor(parameters, algebra)
    return 0 if entry is None else entry.evaluate(parameters, algebra)
