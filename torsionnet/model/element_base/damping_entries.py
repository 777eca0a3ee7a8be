"""Entries for damping as a viscous coefficient, a loss factor, or another measure of damping."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from torsionnet.core.damping import MEASURES, DampingMeasure
from torsionnet.core.entries.scalars import SCALAR_SCHEMA, QuantityKind, plain_scalar, read_scalar
from torsionnet.core.entries.spec import EntryError, Json, Schema, full_name
from torsionnet.core.errors import Fault, Path, did_you_mean
from torsionnet.core.expressions import Algebra, Expression


class DampingQuantity(QuantityKind[Expression | DampingMeasure]):
    """Entry for a viscous coefficient, or for a damping measure at a stated frequency: ``{zeta: 0.02, at: 12 Hz}``."""

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
            raise EntryError(f"{error.fault.message}; {hint}") from None

    def _measure(self, raw: Mapping[str, Any]) -> DampingMeasure:
        given = [key for key in raw if key != "at"]
        for key in given:
            if key not in MEASURES:
                hint = did_you_mean(str(key), MEASURES)
                known = f"known: {', '.join(MEASURES)}"
                raise EntryError(
                    Fault(
                        f'"{key}" is not a measure of damping{hint}; {known}',
                        (key,),
                        on_key=True,
                    )
                )
        if len(given) != 1:
            raise EntryError(
                f"give one measure of damping ({', '.join(MEASURES)}) and at: the frequency where it holds"
            )
        measure = given[0]
        if "at" not in raw and measure != "c":
            raise EntryError(f"{measure} gives a viscous coefficient only at a stated frequency; add at: 12 Hz")
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

    def expressions(self, value: Any) -> tuple[tuple[Path, Expression, str], ...]:
        if not isinstance(value, DampingMeasure):
            return (((), value, self.dimension),)
        entries: list[tuple[Path, Expression, str]] = [
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

    def coerce(self, raw: object) -> Expression | DampingMeasure:
        if isinstance(raw, DampingMeasure):
            return raw
        if not isinstance(raw, Mapping):
            return read_scalar(raw, self.dimension)
        known = [name for name in MEASURES if name != "c"]
        if len(raw) != 1 or next(iter(raw)) not in known:
            raise EntryError(f"give a loss factor, or one measure of damping out of {', '.join(known)}")
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

    def expressions(self, value: Any) -> tuple[tuple[Path, Expression, str], ...]:
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
