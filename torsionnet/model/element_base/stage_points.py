"""Points where the stages of a spring begin and end, and the stage in force at a mean torque."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from torsionnet.core.errors import Fault
from torsionnet.core.expressions import Expression, Number
from torsionnet.core.piecewise_linear import Rows
from torsionnet.model.element_base.laws import Values
from torsionnet.model.element_base.quantity_group import exact_or_value, shown
from torsionnet.model.element_base.spring_stage import SpringStage


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
    found: list[StageSpan] = []
    begin = StagePoint(Fraction(0), Fraction(0))
    for stage in stages:
        stiffness = exact_or_value(stage.stiffness, value)
        preload = Fraction(0) if stage.preload is None else exact_or_value(stage.preload, value)
        end = None if stage.end is None else _end(begin, stiffness, begin.torque + preload, stage.end, value)
        found.append(StageSpan(stiffness, preload, begin, end))
        begin = end or begin
    return found


def _end(
    begin: StagePoint, stiffness: Any, torque: Any, given: tuple[str, Expression, str], value: Values
) -> StagePoint:
    """Point where a stage ends that begins at a twist with a torque, its preload included."""
    _, expression, dimension = given
    at = exact_or_value(expression, value)
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
    found = []
    for place, (stage, span) in enumerate(zip(stages, stage_spans(stages, value), strict=True)):
        if stage.end is None or span.end is None:
            continue
        name, given, dimension = stage.end
        by_torque = dimension == "torque"
        begun = span.begin.torque + span.preload if by_torque else span.begin.twist
        end = span.end.torque if by_torque else span.end.twist
        if not end > begun:
            unit = "N*m" if by_torque else "rad"
            what = "torques" if by_torque else "twists"
            at = shown(given if given.names else None, end)
            text = (
                f"the stages end at rising {what}; this one ends at {at} {unit}, begun at {shown(None, begun)} {unit}"
            )
            found.append(Fault(text, (place, name)))
    return found


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
    if not stages or any(one.names for stage in stages for _, _, one, _ in stage.quantities()):
        return ()
    last = stage_torques(stages, Values({}))[-1]
    return () if last is None else ((Number(0),), (Number(last),))
