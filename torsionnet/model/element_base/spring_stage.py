"""Entries of one stage of a spring."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.core.entries.alternatives import given_entries, one_at_most
from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.scalars import SCALAR_SCHEMA, PhysicalQuantity, plain_scalar, read_value
from torsionnet.core.entries.spec import EntryError, Json, Schema, Spec, entry
from torsionnet.core.errors import Fault, Path
from torsionnet.core.expressions import Expression, Number
from torsionnet.core.units import DIMENSIONS

ENDS = ("to", "to_torque", "to_twist")
"""Names of the entries by one of which a stage ends."""


class StageEnd(Spec[Number]):
    """Entry for the torque or angle at which a stage of a spring ends; the unit tells them apart."""

    def coerce(self, raw: object) -> Number:
        end = read_value(raw)
        if not isinstance(end, Number):
            text = f"a stage ends at a torque or an angle with its unit, as 120 N*m or 30 deg; give {end}"
            raise EntryError(f"{text} as to_torque or to_twist, which take expressions of parameters")
        if end.unit_dimension not in (DIMENSIONS["torque"], DIMENSIONS["angle"]):
            raise EntryError(f"a stage ends at a torque or an angle with its unit, as 120 N*m or 30 deg; got {raw!r}")
        if end.unit_dimension == DIMENSIONS["torque"] and re.search("rad|deg", end.unit_written):
            raise EntryError(f"{end} is a stiffness; a stage ends at a torque or an angle, as 120 N*m or 30 deg")
        if end.value <= 0:
            raise EntryError(f"a stage ends above 0, got {raw!r}")
        return end

    def plain(self, value: Any) -> Json:
        return plain_scalar(value)

    def schema(self) -> Schema:
        return {**SCALAR_SCHEMA, "description": f"{self.description} [N*m or rad]"}

    @property
    def accepted(self) -> str:
        return "Scalar"


class StageQuantity(PhysicalQuantity):
    """Entry of a quantity of a stage, which refuses a number out of bounds with the other faults of its list."""

    def coerce(self, raw: object) -> Expression:
        value = super().coerce(raw)
        reason = self.bound_fault(float(value.value)) if isinstance(value, Number) else None
        if reason:
            raise EntryError(f"{reason}, got {raw!r}")
        return value


@dataclass(frozen=True)
class SpringStage(Declared):
    """Stage of a spring: its stiffness, up to a torque or an angle from the unloaded position.

    ``preload`` is the torque under which its springs are installed: where the stage begins, the twist stands still
    until the torque exceeds that of the stage before by the preload.
    """

    kind: ClassVar[str] = "stage"
    article: ClassVar[str] = "a stage"
    form: ClassVar[str] = "{stiffness: 12 N*m/deg, to: 180 N*m}"

    stiffness: Expression = entry(StageQuantity("stiffness of the stage", "stiffness", "k_i", exclusive=True))
    to: Number | None = entry(StageEnd("torque or angle with unit where the stage ends; none: the last stage"), None)
    preload: Expression | None = entry(
        StageQuantity("torque under which the springs of the stage are installed", "torque", "P_i"), None
    )
    to_torque: Expression | None = entry(
        StageQuantity("instead of to: torque there, also an expression", "torque", "T_i", exclusive=True), None
    )
    to_twist: Expression | None = entry(
        StageQuantity("instead of to: twist there, also an expression", "angle", "gamma_i", exclusive=True), None
    )

    def contradictions(self) -> list[Fault]:
        return one_at_most(self, *ENDS)

    @property
    def end(self) -> tuple[str, Expression, str] | None:
        """Entry by which the stage ends, what it gives and its dimension; None without an end."""
        for name in given_entries(self, *ENDS):
            given = getattr(self, name)
            by_torque = name == "to_torque" or (name == "to" and given.unit_dimension == DIMENSIONS["torque"])
            return name, given, "torque" if by_torque else "angle"
        return None

    def quantities(self) -> Iterator[tuple[Path, Spec[object], Expression, str]]:
        """Path, specification, expression and dimension name of everything that the stage gives."""
        for name, spec in self.specs():
            given = getattr(self, name)
            if isinstance(spec, PhysicalQuantity) and given is not None:
                yield (name,), spec, given, spec.dimension
            elif given is not None:
                assert self.end is not None
                yield (name,), spec, given, self.end[2]
