"""What every variation has: it is written relative to a model, and bound to the values of one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, TypeVar

from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.scalars import SCALAR_SCHEMA, plain_number, read_value
from torsionnet.core.entries.spec import EntryError, Schema, Spec
from torsionnet.core.expressions import Number
from torsionnet.core.number_range import is_beyond_range
from torsionnet.core.type_register import TypeRegister
from torsionnet.study.space.variations.grid_axis import GridAxis
from torsionnet.study.space.variations.marginal import Marginal
from torsionnet.study.space.variations.nominal import NominalReader

MIDDLE, SPREAD, LOWEST_VALUE, HIGHEST_VALUE = "mean", "standard deviation", "lowest", "highest"
MOST_FREQUENT = "most frequent"
"""Numbers of variations."""

V = TypeVar("V", bound="type[Variation]")


class ParameterValue(Spec):
    """A value of a parameter: with unit, in SI, or in percent of the value in the model."""

    def coerce(self, raw: Any) -> Number:
        value = raw if isinstance(raw, Number) else read_value(raw)
        if not isinstance(value, Number):
            raise EntryError(f'expected a number with unit or in percent; "{value}" is an expression of parameters')
        if is_beyond_range(float(value.value)):
            raise EntryError(f"{float(value.value):g} is no size that anything in a drivetrain has")
        return value

    def plain(self, value: Any) -> Any:
        return plain_number(value.value) if value.text is None else value.text

    def schema(self) -> Schema:
        return {**SCALAR_SCHEMA, "description": f"{self.description} [unit of the parameter, or %]"}


@dataclass(frozen=True, kw_only=True)
class Variation(Declared):
    """Base of the variations; a class of its own for each ``type:``, registered by :func:`register_variation`."""

    article: ClassVar[str] = "a variation"
    is_random: ClassVar[bool] = True
    """Whether it is a distribution that values are drawn from."""

    @property
    def words(self) -> str:
        """What it is, as a reader of a report is told."""
        return self.kind

    def sizes(self, reader: NominalReader) -> dict[str, float]:
        """The numbers that it is made of, in SI, by what they are: :data:`MIDDLE`, ...; of faultless entries."""
        raise NotImplementedError

    def bound(self, reader: NominalReader) -> Marginal | GridAxis | None:
        """The distribution or the values in SI; None where the reader found faults."""
        raise NotImplementedError


VARIATIONS: TypeRegister[type[Variation]] = TypeRegister("torsionnet.study.space.variations")
"""By the word in ``type:``."""


def register_variation(cls: V) -> V:
    """Make a variation known by its ``kind``."""
    VARIATIONS[cls.kind] = cls
    return cls
