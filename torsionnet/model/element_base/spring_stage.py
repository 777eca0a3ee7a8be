"""Stage of a spring with its entries, the points where it begins and ends, and the one in force at a mean torque.

Few springs have stages; the entry for all of them is in :mod:`torsionnet.model.element_base.spring_stages`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar

from torsionnet.base.entries.composite import given_entries, one_at_most
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import (
    SCALAR_SCHEMA,
    PhysicalQuantity,
    plain_scalar,
    read_scalar,
)
from torsionnet.base.entries.spec import EntryError, Json, Schema, Spec, entry
from torsionnet.base.errors import EntryPath, Fault, got
from torsionnet.base.expressions import Expression, Number, Rows
from torsionnet.base.units import DIMENSIONS
from torsionnet.model.element_base.element_entries import exact_or_value, shown
from torsionnet.model.element_base.laws import Values

ENDS = ("to", "to_torque", "to_twist")
"""Names of the entries by one of which a stage ends."""


class StageEnd(Spec[Number]):
    """Entry for the torque or angle at which a stage of a spring ends; the unit tells them apart."""

    def coerce(self, raw: object) -> Number:
        end = read_scalar(raw)
        if not isinstance(end, Number):
            text = f"a stage ends at a torque or an angle with its unit, as 120 N*m or 30 deg; give {end}"
            raise EntryError(
                f"{text} as to_torque or to_twist, which take expressions of parameters", kind="expression-not-allowed"
            )
        if end.unit_dimension not in (DIMENSIONS["torque"], DIMENSIONS["angle"]):
            raise EntryError(
                f"a stage ends at a torque or an angle with its unit, as 120 N*m or 30 deg; {got(raw)}",
                kind="missing-unit",
            )
        if end.unit_dimension == DIMENSIONS["torque"] and end.has_angle:
            raise EntryError(
                f"{end} is a stiffness; a stage ends at a torque or an angle, as 120 N*m or 30 deg", kind="wrong-unit"
            )
        if end.value <= 0:
            raise EntryError(f"a stage ends above 0, {got(raw)}", kind="out-of-range")
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
            raise EntryError(f"{reason}, {got(raw)}", kind="out-of-range")
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

    def quantities(self) -> Iterator[tuple[EntryPath, Spec[object], Expression, str]]:
        """Path, specification, expression and dimension name of everything that the stage gives."""
        for name, spec in self.specs():
            given = getattr(self, name)
            if isinstance(spec, PhysicalQuantity) and given is not None:
                yield (name,), spec, given, spec.dimension
            elif given is not None:
                assert self.end is not None
                yield (name,), spec, given, self.end[2]


@dataclass(frozen=True)
class StagePoint:
    """Twist in rad and torque in N m where a stage of a spring ends, in numbers of an algebra."""

    twist: Any
    torque: Any


@dataclass(frozen=True)
class StageSpan:
    """Stage of a spring, exact or in numbers of an algebra: stiffness in N m/rad, preload in N m, begin and end.

    It begins where the stage before it ends, below its preload.
    """

    stiffness: Any
    preload: Any
    begin: StagePoint
    end: StagePoint | None


def stage_spans(stages: Sequence[SpringStage], value: Values) -> list[StageSpan]:
    """Stages of a spring, each from where the one before it ends: exact, with expressions in the algebra of ``value``.

    >>> _, second = stage_spans((SpringStage(300, "0.5 rad"), SpringStage("2*k", preload=5)), Values({"k": 400}))
    >>> int(second.stiffness), float(second.begin.twist), float(second.begin.torque), second.end
    (800, 0.5, 150.0, None)
    """
    spans: list[StageSpan] = []
    begin = StagePoint(Fraction(0), Fraction(0))
    for stage in stages:
        stiffness = exact_or_value(stage.stiffness, value)
        preload = Fraction(0) if stage.preload is None else exact_or_value(stage.preload, value)
        # A preload is a step of the torque where its stage begins.
        end = None if stage.end is None else _end(begin, stiffness, begin.torque + preload, stage.end, value)
        spans.append(StageSpan(stiffness, preload, begin, end))
        begin = end or begin
    return spans


def _end(
    begin: StagePoint, stiffness: Any, torque: Any, given: tuple[str, Expression, str], value: Values
) -> StagePoint:
    """Point where a stage ends that begins at a twist with a torque, its preload included."""
    _, expression, dimension = given
    at = exact_or_value(expression, value)
    # T = T_0 + k (gamma - gamma_0), solved for gamma where the end is a torque.
    if dimension == "torque":
        return StagePoint(begin.twist + (at - torque) / stiffness, at)
    return StagePoint(at, torque + stiffness * (at - begin.twist))


def stage_faults(stages: Sequence[SpringStage], value: Values) -> list[Fault]:
    """Faults of stages that do not end beyond where they begin, with their path in the list.

    Stiffnesses and preloads of an impossible sign are left to the checks of single values.
    """
    for stage in stages:
        if not exact_or_value(stage.stiffness, value) > 0 or (
            stage.preload is not None and exact_or_value(stage.preload, value) < 0
        ):
            return []
    faults = []
    for place, (stage, span) in enumerate(zip(stages, stage_spans(stages, value), strict=True)):
        if stage.end is None or span.end is None:
            continue
        name, given, dimension = stage.end
        by_torque = dimension == "torque"
        # The step of a preload is behind it when a stage begins, so that its end lies beyond T_0 + preload.
        begun = span.begin.torque + span.preload if by_torque else span.begin.twist
        end = span.end.torque if by_torque else span.end.twist
        if not end > begun:
            unit = "N*m" if by_torque else "rad"
            what = "torques" if by_torque else "twists"
            at = shown(given if given.names else None, end)
            text = (
                f"the stages end at rising {what}; this one ends at {at} {unit}, begun at {shown(None, begun)} {unit}"
            )
            faults.append(Fault(text, (place, name), kind="unordered-rows"))
    return faults


def stage_torques(stages: Sequence[SpringStage], value: Values) -> list[Any]:
    """Torque in N m where each stage of a spring ends, None where a stage has no end.

    >>> stages = SpringStage(300, "0.5 rad"), SpringStage(1000, "250 N*m"), SpringStage(2000)
    >>> [end and float(end) for end in stage_torques(stages, Values({}))]
    [150.0, 250.0, None]
    """
    return [None if span.end is None else span.end.torque for span in stage_spans(stages, value)]


def stage_at(stages: Sequence[SpringStage], torque: Any, value: Values) -> SpringStage | None:
    """Stage of a spring in force at a mean torque in N m of either sign; None beyond the end of the last stage.

    >>> str(stage_at((SpringStage(300, "100 N*m"), SpringStage(1000)), -150, Values({})).stiffness)
    '1000'
    """
    size = -torque if torque < 0 else torque
    ends = zip(stages, stage_torques(stages, value), strict=True)
    return next((stage for stage, end in ends if end is None or not size > end), None)


def stage_range(stages: Sequence[SpringStage]) -> Rows:
    """Range of mean torques in N m that the stages of a spring cover, as two rows.

    Empty if the last stage has no end, or if it follows parameters.
    """
    if not stages or any(expression.names for stage in stages for _, _, expression, _ in stage.quantities()):
        return ()
    last = stage_torques(stages, Values({}))[-1]
    return () if last is None else ((Number(0),), (Number(last),))
