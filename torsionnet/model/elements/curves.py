"""Curves of makers' sheets: a value over a torque, a temperature or a frequency, by straight lines between the rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from torsionnet.core.entries.scalars import PhysicalQuantity, check_unit, plain_scalar, read_scalar, read_value
from torsionnet.core.entries.spec import EntryError, Schema, Spec
from torsionnet.core.errors import Fault
from torsionnet.core.expressions import Expression, Number
from torsionnet.core.units import DIMENSIONS, expected_unit
from torsionnet.model.elements.laws import Values

Rows = tuple[tuple[Number, Number], ...]


@dataclass(frozen=True, eq=False, repr=False)
class Temperature(PhysicalQuantity):
    """A temperature, in degC or K: a number alone would leave open which."""

    def coerce(self, raw: Any) -> Expression:
        value = read_scalar(raw, self.dimension)
        if isinstance(value, Number) and value.unit_dimension is None:
            raise EntryError(f"a temperature has its unit: write {raw} degC, or {raw} K")
        return value


@dataclass(frozen=True, eq=False, repr=False)
class LookupCurve(Spec):
    """``{20 degC: 1, 60 degC: 0.8}``, stored as pairs by rising first value.

    ``over`` and ``dimension`` are those of the two columns. Over a torque, rows without a unit, or in %, are shares of
    the nominal torque T_KN.
    """

    over: str
    dimension: str = "1"
    exclusive: bool = False
    """Whether 0 is no value; a curve over frequency begins above 0, too."""
    shown: str = "{20 degC: 1, 60 degC: 0.8}"

    @property
    def absent(self) -> Rows:
        return ()

    @property
    def example(self) -> str:
        return self.shown

    def read(self, raw: Any) -> tuple[Rows, list[Fault]]:
        if isinstance(raw, tuple) and all(isinstance(row, tuple) and isinstance(row[0], Number) for row in raw):
            return raw, []
        if not isinstance(raw, Mapping) or len(raw) < 2:
            return (), [Fault(f"expected two rows or more, as in {self.shown}; got {raw!r}")]
        found: list[tuple[Number, Number]] = []
        faults: list[Fault] = []
        for key, value in raw.items():
            try:
                found.append((self._key(key), self._value(value)))
            except EntryError as error:
                faults.append(Fault(error.fault.message, (key,)))
        if faults:
            return (), faults
        found.sort(key=lambda row: row[0].value)
        twice = [second for first, second in pairwise(found) if first[0].value == second[0].value]
        faults += [Fault(f"{key} stands twice in the curve") for key, _ in twice]
        if len({is_share(key) for key, _ in found}) > 1:
            faults.append(Fault("rows are torques, as 5 kN*m, or shares of T_KN, as 0.5; here are both"))
        return ((), faults) if faults else (tuple(found), [])

    def _key(self, raw: Any) -> Number:
        key = self._number(read_value(raw), raw)
        if self.over == "temperature" and key.unit_dimension is None:
            raise EntryError(f"a temperature has its unit: write {raw} degC, or {raw} K")
        if not (self.over == "torque" and is_share(key)):
            check_unit(key, self.over)
        if key.value < 0 or (key.value == 0 and self.over == "frequency"):
            raise EntryError(f"the rows of this curve begin above 0, got {raw}")
        return key

    def _value(self, raw: Any) -> Number:
        value = self._number(read_scalar(raw, self.dimension), raw)
        if value.value < 0 or (self.exclusive and value.value == 0):
            raise EntryError(f"must {'be greater than' if self.exclusive else 'not be less than'} 0, got {raw}")
        return value

    @staticmethod
    def _number(value: Expression, raw: Any) -> Number:
        if not isinstance(value, Number):
            raise EntryError(f'a curve holds numbers; "{raw}" is an expression of parameters')
        return value

    def plain(self, value: Any) -> Any:
        return {str(key): plain_scalar(one) for key, one in value}

    def schema(self) -> Schema:
        unit = f" [{expected_unit(self.dimension)} over {expected_unit(self.over)}]"
        return {
            "type": "object",
            "description": self.description + unit,
            "minProperties": 2,
            "additionalProperties": {"type": ["number", "string"]},
        }


def is_share(key: Number) -> bool:
    """Whether a row begins with a number or a percentage."""
    return key.unit_dimension in (None, DIMENSIONS["1"])


@dataclass(frozen=True, eq=False, repr=False)
class OnCurve(PhysicalQuantity):
    """A value at which a curve is read off: within its rows, beyond which nothing is known."""

    rows: Rows = ()
    share_of: Fraction | float = 1

    def curve_fault(self, value: float) -> str | None:
        """Why nothing can be read off at a value in SI, or None."""
        first, last = (float(self.rows[place][0].value) * float(self.share_of) for place in (0, -1))
        slack = 1e-9 * last
        if first - slack <= value <= last + slack:
            return None
        return f"lies beyond its curve, which goes from {self.rows[0][0]} to {self.rows[-1][0]}"


def read_off(rows: Rows, at: Any, value: Values) -> Any:
    """The value at ``at`` in the algebra of ``value``, by straight lines; beyond the ends that of the nearest row.

    A sum of ramps, (x - x_i + |x - x_i|)/2 times the change of slope at each row, needs no comparison and so works for
    symbols and for numbers with derivatives; at a row the derivative is the mean of both sides.

    Examples
    --------
    >>> rows = ((Number(1), Number(10)), (Number(3), Number(30)), (Number(4), Number(0)))
    >>> [int(read_off(rows, Fraction(x), Values({}))) for x in (0, 2, 3, 5)]
    [10, 20, 30, 0]
    """
    algebra, total, slope = value.algebra, value(rows[0][1]), Fraction(0)
    for place, (key, level) in enumerate(rows):
        following = rows[place + 1] if place + 1 < len(rows) else None
        ahead = (following[1].value - level.value) / (following[0].value - key.value) if following else Fraction(0)
        if ahead != slope:
            beyond = at - algebra.number(key.value)
            total = total + algebra.number((ahead - slope) / 2) * (beyond + algebra.sqrt(beyond**2))
        slope = ahead
    return total
