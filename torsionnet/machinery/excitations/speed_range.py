"""Entry ``speeds:`` for the shaft and the speeds at which running machinery is examined."""

from __future__ import annotations

import builtins
import math
import re
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import Listed, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Value
from torsionnet.base.entries.spec import EntryError, Json, OneOf, Schema, Spec, entry, not_none
from torsionnet.base.errors import Fault, got
from torsionnet.base.units import RPM
from torsionnet.model.element_base.element_entries import NodeName

SPEED = Value("a speed", "speed", exclusive=True, below=1e6)
RANGE_EXAMPLES = "300..788 rpm or [300 rpm, 788 rpm]"
"""Examples of a range of speeds, for messages."""
MOST_SPEEDS = 100_000
"""Largest number of speeds in a range, as more only come from a step in the wrong unit."""
FEWEST_SPEEDS = 100
"""Least number of steps of speed in a run-up before peaks between them are looked for."""
NONLINEAR = ("linear", "periodic")
"""Words for laws of motion in results over speed, linear about the operating point or in full, in periodic motion."""
_RANGE = re.compile(r"\s*([\d.eE+]+)\s*([A-Za-z/]*)\s*\.\.\s*([\d.eE+]+)\s*([A-Za-z/]*)\s*")


class SpeedBand(Spec[tuple[float, float]]):
    """Entry for a lower and an upper speed, stored in rad/s."""

    def coerce(self, raw: object) -> tuple[float, float]:
        low, high = (SPEED.coerce(edge) for edge in self._edges(raw))
        if low >= high:
            raise EntryError(
                f"a range goes from a lower to a higher speed, as in {RANGE_EXAMPLES}; {got(raw)}",
                kind="unordered-rows",
            )
        return low, high

    @staticmethod
    def _edges(raw: object) -> tuple[Any, Any]:
        if isinstance(raw, list | tuple) and len(raw) == 2:
            return raw[0], raw[1]
        match = _RANGE.fullmatch(raw) if isinstance(raw, str) else None
        if match is None:
            raise EntryError(f"expected a range such as {RANGE_EXAMPLES}, {got(raw)}", kind="wrong-form")
        if not match[2] and not match[4]:
            text = f"the range of speeds {match[1]}..{match[3]} has no unit"
            raise EntryError(
                f"{text}; write {match[1]}..{match[3]} rpm, or [{match[1]}, {match[3]}] in rad/s", kind="missing-unit"
            )
        return f"{match[1]} {match[2] or match[4]}", f"{match[3]} {match[4] or match[2]}"

    def plain(self, value: Any) -> Json:
        return list(value)

    def schema(self) -> Schema:
        pair: Schema = {"type": "array", "items": SCALAR_SCHEMA, "minItems": 2, "maxItems": 2}
        return {"description": f"{self.description}: {RANGE_EXAMPLES}", "anyOf": [{"type": "string"}, pair]}


@dataclass(frozen=True, kw_only=True)
class StartingRange(Declared):
    """Speeds that every start passes, with the load at which they are passed and the rate at which the speed rises.

    Examples
    --------
    >>> run_up = StartingRange(range="250..675 rpm", load="15 %", rate="20 rpm/s")
    >>> run_up.load, round(run_up.rate, 4), round(run_up.seconds, 2)
    (0.15, 2.0944, 21.25)
    """

    kind: ClassVar[str] = "run_up"
    article: ClassVar[str] = "a run-up"
    form: ClassVar[str] = "{range: 250..675 rpm, load: 15 %, rate: 20 rpm/s}"

    range: tuple[float, float] = entry(SpeedBand("from the speed at which it fires to those at which it runs"))
    load: float = entry(Value("share of rated indicated pressure and mean torque while it runs up", "1", below=1.5))
    rate: float | None = entry(
        Value("rise of the speed with time; default: judged as if each speed lasted", "acceleration", exclusive=True),
        None,
    )

    @property
    def seconds(self) -> float:
        """Time in s from the lowest to the highest speed; infinite without a rate."""
        low, high = self.range
        return (high - low) / self.rate if self.rate else math.inf

    def speeds(self, step: float | None) -> tuple[float, ...]:
        """Speeds of the run-up in rad/s, rising, at most a step in rad/s apart."""
        low, high = self.range
        count = min(max(FEWEST_SPEEDS, math.ceil((high - low) / step) if step else 0), MOST_SPEEDS)
        return tuple(low + (high - low) * number / count for number in builtins.range(count + 1))


@dataclass(frozen=True, kw_only=True)
class SpeedRange(Declared):
    """The speeds at which running machinery is examined.

    Examples
    --------
    >>> speeds = SpeedRange(of="fly", range="300..320 rpm", step="10 rpm")
    >>> [round(speed * 60 / 6.283185307179586, 6) for speed in speeds.values]
    [300.0, 310.0, 320.0]
    """

    kind: ClassVar[str] = "speeds"
    article: ClassVar[str] = "a range of speeds"
    form: ClassVar[str] = "{of: fly, range: 300..788 rpm, step: 2 rpm}"

    of: str = entry(NodeName("the node whose speed is meant", allow_ground=False))
    range: tuple[float, float] | None = entry(SpeedBand("lowest and highest speed"), None)
    step: float | None = entry(Value("from one speed to the next", "speed", exclusive=True), None)
    list: tuple[float, ...] = entry(Listed("the speeds one by one", SPEED, form="a list of speeds"), ())
    rated: float | None = entry(Value("speed to which rated torques belong", "speed", exclusive=True), None)
    run_up: StartingRange | None = entry(
        Nested("the speeds that every start passes, at which load and how fast", lambda: StartingRange, "run_up"), None
    )
    nonlinear: str | None = entry(
        OneOf(
            "whether laws of motion are linear about the operating point, or act in full in periodic motion", NONLINEAR
        ),
        None,
    )

    def contradictions(self) -> builtins.list[Fault]:
        if bool(self.list) == bool(self.range):
            text = "speeds are given by a range with its step, or one by one in a list"
            return [
                Fault(
                    f"{text}; here is {'both' if self.list else 'neither'}",
                    ("range",),
                    on_key=True,
                    kind="contradicting-entries",
                )
            ]
        if self.list and self.step:
            return [Fault("a list of speeds has no step", ("step",), on_key=True, kind="needless-entry")]
        if self.range and not self.step:
            return [Fault(f"a range of speeds needs its step: {self.form}", on_key=True, kind="missing-entry")]
        if self.range and (self.range[1] - self.range[0]) / not_none(self.step) > MOST_SPEEDS:
            return [
                Fault(f"the range has more than {MOST_SPEEDS} speeds; take a larger step", ("step",), kind="too-large")
            ]
        return self._unfit_run_up()

    def _unfit_run_up(self) -> builtins.list[Fault]:
        """Faults of a run-up that does not lead up to the speeds examined."""
        if self.run_up is None:
            return []
        (low, high), first = self.run_up.range, self.values[0]
        ends = (
            f"the run-up goes from {low * RPM:.6g} to {high * RPM:.6g} rpm, the speeds begin at {first * RPM:.6g} rpm"
        )
        if low >= first * (1 - 1e-9):
            return [Fault(f"{ends}: a run-up begins below them", ("run_up", "range"), kind="contradicting-values")]
        if high < first * (1 - 1e-9):
            return [
                Fault(
                    f"{ends}: what lies between is passed by every start, too",
                    ("run_up", "range"),
                    kind="contradicting-values",
                )
            ]
        return []

    @property
    def values(self) -> tuple[float, ...]:
        """Speeds of the range in rad/s, rising."""
        if self.list:
            return tuple(sorted(set(self.list)))
        (low, high), step = not_none(self.range), not_none(self.step)
        # Rounding of an end that is a whole number of steps away must not lose the last speed.
        count = int((high - low) / step * (1 + 1e-12) + 1e-9)
        speeds = [low + number * step for number in range(count + 1)]
        return (*speeds, high) if high - speeds[-1] > 1e-9 * high else tuple(speeds)
