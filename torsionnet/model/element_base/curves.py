"""Curves from makers' sheets, of a value over torque, temperature or frequency, interpolated linearly."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields
from fractions import Fraction
from typing import Any, ClassVar

from torsionnet.base.entries.scalars import NumberTable, PhysicalQuantity, QuantityKind, check_unit, read_scalar
from torsionnet.base.entries.spec import EntryError, Schema, Spec
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.expressions import Expression, Number, Rows
from torsionnet.base.units import DIMENSIONS, expected_unit
from torsionnet.model.parameters import LookupTable


class Temperature(PhysicalQuantity):
    """Entry for a temperature, which needs a unit: a plain number could be degC or K."""

    def coerce(self, raw: object) -> Expression:
        value = read_scalar(raw, self.dimension)
        if isinstance(value, Number) and value.unit_dimension is None:
            raise EntryError(f"a temperature has its unit: write {raw} degC, or {raw} K", kind="missing-unit")
        return value


@dataclass(frozen=True, eq=False, repr=False)
class LookupCurve(LookupTable):
    """Entry for a curve, as ``{20 degC: 1, 60 degC: 0.8}``, stored as pairs by rising first value.

    ``over`` and ``dimension`` are those of the two columns. Over a torque, rows without a unit, or in %, are shares of
    the nominal torque T_KN.
    """

    over: str
    dimension: str = "1"
    exclusive: bool = False
    """Whether the curve refuses 0 as a value; a curve over frequency begins above 0, too."""
    shown: str = "{20 degC: 1, 60 degC: 0.8}"

    @property
    def example(self) -> str:
        return self.shown

    def key(self, raw: object) -> Number:
        key = self._number(read_scalar(raw), raw)
        if self.over == "temperature" and key.unit_dimension is None:
            raise EntryError(f"a temperature has its unit: write {raw} degC, or {raw} K", kind="missing-unit")
        if not (self.over == "torque" and is_share(key)):
            check_unit(key, self.over)
        if key.value < 0 or (key.value == 0 and self.over == "frequency"):
            raise EntryError(f"the rows of this curve begin above 0, got {raw}", kind="unfit-curve")
        return key

    def value(self, raw: object) -> Number:
        value = self._number(read_scalar(raw, self.dimension), raw)
        if value.value < 0 or (self.exclusive and value.value == 0):
            raise EntryError(
                f"must {'be greater than' if self.exclusive else 'not be less than'} 0, got {raw}", kind="out-of-range"
            )
        return value

    def unit_faults(self, rows: list[tuple[Number, Number]]) -> list[Fault]:
        if len({is_share(key) for key, _ in rows}) > 1:
            return [Fault("rows are torques, as 5 kN*m, or shares of T_KN, as 0.5; here are both", kind="wrong-unit")]
        return []

    @staticmethod
    def _number(value: Expression, raw: object) -> Number:
        if not isinstance(value, Number):
            raise EntryError(
                f'a curve holds numbers, not expressions of parameters; got "{raw}"', kind="expression-not-allowed"
            )
        return value

    def schema(self) -> Schema:
        unit = f" [{expected_unit(self.dimension)} over {expected_unit(self.over)}]"
        return {
            "type": "object",
            "description": self.description + unit,
            "minProperties": 2,
            "additionalProperties": {"type": ["number", "string"]},
        }


def is_share(key: Number) -> bool:
    """Whether the first value of a curve's row is a share: a number without unit, or a percentage."""
    return key.unit_dimension in (None, DIMENSIONS["1"])


def with_curve_ranges(
    quantities: Iterable[tuple[EntryPath, Spec[object], Expression, str]],
    curves: Mapping[str, tuple[Rows, Fraction | float]],
) -> Iterator[tuple[EntryPath, Spec[object], Expression, str]]:
    """Expressions of an element, each with its path, specification and dimension, operating values with their range.

    Operating values of a curve get a specification with the range of that curve.

    ``curves`` are the rows by the name of the entry, and the value that rows given as shares are shares of, else 1.
    """
    for path, spec, expression, dimension in quantities:
        rows, share_of = curves.get(str(path[0]), ((), 1))
        if rows and isinstance(spec, QuantityKind):
            given = {field.name: getattr(spec, field.name) for field in fields(QuantityKind)}
            yield path, OnCurve(**given, rows=rows, share_of=share_of), expression, dimension
        else:
            yield path, spec, expression, dimension


@dataclass(frozen=True, eq=False, repr=False)
class OnCurve(PhysicalQuantity):
    """Specification of an entry with an operating value that has to lie within the rows of a curve."""

    rows: Rows = ()
    share_of: Fraction | float = 1

    def curve_fault(self, value: Any) -> str | None:
        """Message if an operating value in SI units lies outside of the curve, else None.

        A curve from 0 on holds for both signs.
        """
        first, last = (float(self.rows[place][0].value) * float(self.share_of) for place in (0, -1))
        slack = 1e-9 * abs(last)
        if first - slack <= (abs(value) if first >= 0 else value) <= last + slack:
            return None
        return f"lies beyond its curve, which goes from {self.rows[0][0]} to {self.rows[-1][0]}; extend it"


# Entry for a characteristic, rows of plain numbers interpolated linearly over the first column.


@dataclass(frozen=True, eq=False, repr=False)
class Characteristic(NumberTable[Rows]):
    """Entry for a function of an operating value, given by rows of plain numbers.

    There are two rows or more, interpolated linearly.
    """

    is_read_off: ClassVar[bool] = True

    fewest: int = 2

    def coerce(self, raw: object) -> Rows:
        return self.rows(raw)
