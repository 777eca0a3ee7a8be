"""Entries for springs in stages, and the stage in force at a mean torque."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar

from torsionnet.core.entries.composite import Composite, Listed, Nested
from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.scalars import SCALAR_SCHEMA, Value, plain_scalar, read_value
from torsionnet.core.entries.spec import EntryError, Json, Plural, Schema, Spec, entry
from torsionnet.core.errors import Fault
from torsionnet.core.expressions import Number
from torsionnet.core.piecewise_linear import Rows
from torsionnet.core.units import DIMENSIONS, exact


class StageEnd(Spec[Number]):
    """Entry for the torque or angle at which a stage of a spring ends; the unit tells them apart."""

    def coerce(self, raw: object) -> Number:
        end = read_value(raw)
        if not isinstance(end, Number) or end.unit_dimension not in (DIMENSIONS["torque"], DIMENSIONS["angle"]):
            raise EntryError(f"a stage ends at a torque or an angle with its unit, as 120 N*m or 30 deg; got {raw!r}")
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


@dataclass(frozen=True)
class SpringStage(Declared):
    """Stage of a spring: its stiffness, up to a torque or an angle from the unloaded position.

    ``preload`` is the torque under which its springs are installed: where the stage begins, the twist stands still
    until the torque exceeds that of the stage before by the preload.
    """

    kind: ClassVar[str] = "stage"
    article: ClassVar[str] = "a stage"
    form: ClassVar[str] = "{stiffness: 12 N*m/deg, to: 180 N*m}"

    stiffness: float = entry(Value("stiffness of the stage", "stiffness", exclusive=True))
    to: Number | None = entry(StageEnd("torque or angle where the stage ends; none: the last stage"), None)
    preload: float | None = entry(Value("torque under which the springs of the stage are installed", "torque"), None)


class SpringStages(Composite[tuple[SpringStage, ...]], Plural[tuple[SpringStage, ...]]):
    """Entry for the stages of a spring from zero torque on.

    ``[{stiffness: 6 N*m/deg, to: 120 N*m}, {stiffness: 14 N*m/deg}]``.
    """

    is_read_off: ClassVar[bool] = True

    @property
    def absent(self) -> tuple[SpringStage, ...]:
        return ()

    @property
    def _listed(self) -> Listed[SpringStage]:
        return Listed(
            self.description,
            Nested("a stage", lambda: SpringStage, "spring_stage"),
            form="stages as [{stiffness: 6 N*m/deg, to: 120 N*m}, {stiffness: 14 N*m/deg}]",
        )

    def read(self, raw: object) -> tuple[tuple[SpringStage, ...], list[Fault]]:
        stages, faults = self._listed.read(raw)
        if faults or not stages:
            return (), faults or [Fault("expected at least one stage")]
        for place, stage in enumerate(stages[:-1]):
            if stage.to is None:
                return (), [
                    Fault(
                        "every stage but the last needs its end; give it as to: with a torque or an angle",
                        (place,),
                        on_key=True,
                    )
                ]
        begun = 0.0
        for place, (stage, end) in enumerate(zip(stages, stage_torques(stages), strict=True)):
            begun += stage.preload or 0.0
            if end is not None and end <= begun:
                text = f"the stages end at rising torques; this one ends at {end:g} N*m, begun at {begun:g} N*m"
                faults.append(Fault(text, (place, "to")))
            begun = begun if end is None else end
        return stages if not faults else (), faults

    def plain(self, value: Any) -> Json:
        return self._listed.plain(value)

    def schema(self) -> Schema:
        return self._listed.schema()

    def definitions(self) -> Schema:
        return self._listed.definitions()

    @property
    def accepted(self) -> str:
        return self._listed.accepted


@dataclass(frozen=True)
class StagePoint:
    """Twist in rad and torque in N m where a stage of a spring ends, exact."""

    twist: Fraction
    torque: Fraction


def stage_ends(stages: Sequence[SpringStage]) -> list[StagePoint | None]:
    """Point where each stage of a spring ends, None where a stage has no end.

    >>> [end and float(end.twist) for end in stage_ends((SpringStage(300, "0.5 rad"), SpringStage(1000)))]
    [0.5, None]
    """
    found: list[StagePoint | None] = []
    torque = twist = Fraction(0)
    for stage in stages:
        if stage.to is None:
            found.append(None)
            continue
        end, stiffness = exact(stage.to.value), exact(stage.stiffness)
        torque += exact(stage.preload or 0)
        if stage.to.unit_dimension == DIMENSIONS["torque"]:
            torque, twist = end, twist + (end - torque) / stiffness
        else:
            torque, twist = torque + stiffness * (end - twist), end
        found.append(StagePoint(twist, torque))
    return found


def stage_torques(stages: Sequence[SpringStage]) -> list[float | None]:
    """Torque in N m where each stage of a spring ends, None where a stage has no end.

    >>> stage_torques((SpringStage(300, "0.5 rad"), SpringStage(1000, "250 N*m"), SpringStage(2000)))
    [150.0, 250.0, None]
    """
    return [None if end is None else float(end.torque) for end in stage_ends(stages)]


def stage_at(stages: tuple[SpringStage, ...], torque: Any) -> SpringStage | None:
    """Stage of a spring in force at a mean torque in N m of either sign; None beyond the end of the last stage.

    >>> stage_at((SpringStage(300, "100 N*m"), SpringStage(1000)), -150).stiffness
    1000.0
    """
    ends, size = stage_torques(stages), -torque if torque < 0 else torque
    return next((stage for stage, end in zip(stages, ends, strict=True) if end is None or not size > end), None)


def stage_range(stages: tuple[SpringStage, ...]) -> Rows:
    """Range of mean torques in N m that the stages of a spring cover, as two rows.

    Empty if the last stage has no end.
    """
    last = stage_torques(stages)[-1] if stages else None
    return () if last is None else ((Number(0),), (Number(last),))
