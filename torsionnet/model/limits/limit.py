"""What every limit has: a rule, what it is about, and verdicts on a condition of the drivetrain."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar, TypeVar

import numpy as np

from torsionnet.core.entries.declared import Declared
from torsionnet.core.errors import Fault, Path
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import Element
from torsionnet.model.limits.evidence import Evidence
from torsionnet.model.limits.subject import LimitSubject
from torsionnet.response.frequency_response import FloatArray
from torsionnet.response.limit_check import BARRED, FAIL, OPEN, PASS, LimitVerdict, RuleText
from torsionnet.response.speed_spans import SpeedSpan, spans_above

_RULES: dict[str, type[Limit]] = {}
L = TypeVar("L", bound="type[Limit]")
COARSE = 0.1
"""A peak whose neighbours are lower by more than this share of it may be higher between the speeds."""


def register_rule(cls: L) -> L:
    """Make a rule known by its ``kind``."""
    _RULES[cls.kind] = cls
    return cls


def limit_rules() -> Mapping[str, type[Limit]]:
    """The rules by the word in ``rule:``."""
    return _RULES


@dataclass(frozen=True, kw_only=True)
class Limit(Declared):
    """Base of the limits; a class of its own for each ``rule:``, registered by :func:`register_rule`."""

    article: ClassVar[str] = "a limit"

    @property
    def of(self) -> str:
        """What it is about: an element, a node or an output."""
        raise NotImplementedError

    @property
    def named(self) -> tuple[tuple[Path, str, str], ...]:
        """Where it names something of the model: path, "element" or "node", name."""
        raise NotImplementedError

    def fitted(self, elements: Mapping[str, Element]) -> Limit:
        """The limit with what the catalogue of its element says of it."""
        del elements
        return self

    def unfit(self, subject: LimitSubject) -> Iterator[Fault]:
        """What does not fit a drivetrain that has everything it names."""
        del subject
        yield from ()

    def seen(self, subject: LimitSubject) -> list[Sensor]:
        """What it wants to know the orders of."""
        raise NotImplementedError

    def averaged(self, subject: LimitSubject) -> list[Sensor]:
        """What it wants to know the mean value of."""
        del subject
        return []

    def powered(self) -> list[str]:
        """Elements of which it wants to know the dissipated power."""
        return []

    def text(self, evidence: Evidence) -> RuleText:
        """Source, formula with its numbers, and what is not covered."""
        raise NotImplementedError

    def judged(self, name: str, evidence: Evidence) -> Iterator[LimitVerdict]:
        """Verdicts on a condition in which all it names is switched on."""
        raise NotImplementedError

    def verdicts(self, name: str, evidence: Evidence) -> list[LimitVerdict]:
        """Verdicts on a condition."""
        off = self.switched_off(evidence.subject)
        if off:
            return [self.open(name, evidence, "all", f"{off} is switched off in this condition")]
        return list(self.judged(name, evidence))

    def switched_off(self, subject: LimitSubject) -> str:
        """What it names that is not there in this condition; empty where all is."""
        there = {"element": subject.active, "node": subject.active_nodes}
        return next((what for _, kind, what in self.named if what not in there[kind]), "")

    def open(self, name: str, evidence: Evidence, criterion: str, why: str) -> LimitVerdict:
        """The verdict where data are missing."""
        empty = np.empty(0)
        return LimitVerdict(
            limit=name, of=self.of, criterion=criterion, quantity="", unit="", values=empty, allowed=empty,
            verdict=OPEN, text=self.text(evidence), remarks=(why,),
        )  # fmt: skip

    def peak(self, line: LimitLine, name: str, evidence: Evidence) -> LimitVerdict:
        """A criterion that no speed may exceed, not even while it is passed."""
        above = spans_above(evidence.speeds, line.values, line.allowed)
        over = tuple(f"exceeded from {span}" for span in above)
        return self._verdict(line, name, evidence, FAIL if above else PASS, (), over)

    def continuous(self, line: LimitLine, name: str, evidence: Evidence) -> LimitVerdict:
        """A criterion for continuous operation: where it is exceeded, speeds are to be barred, if any are left.

        In normal firing neither the rated nor the highest speed can be barred.
        """
        above = spans_above(evidence.speeds, line.values, line.allowed)
        kept = {evidence.subject.rated, float(evidence.speeds[-1])} - {None}
        lost = [span for span in above if any(span.holds(speed) for speed in kept if speed is not None)]
        if lost and not evidence.subject.misfiring:
            return self._verdict(line, name, evidence, FAIL, (), (f"exceeded from {lost[0]}: no range to be barred",))
        if len(above) == 1 and above[0] == SpeedSpan(float(evidence.speeds[0]), float(evidence.speeds[-1])):
            return self._verdict(line, name, evidence, FAIL, (), ("exceeded at all speeds",))
        return self._verdict(line, name, evidence, BARRED if above else PASS, above, ())

    def _verdict(
        self,
        line: LimitLine,
        name: str,
        evidence: Evidence,
        verdict: str,
        barred: tuple[SpeedSpan, ...],
        remarks: tuple[str, ...],
    ) -> LimitVerdict:
        case = _worst_case(evidence, line, self.seen(evidence.subject)[0])
        return LimitVerdict(
            limit=name, of=self.of, criterion=line.criterion, quantity=line.quantity, unit=line.unit,
            values=line.values, allowed=line.allowed, verdict=verdict, text=self.text(evidence), barred=barred,
            remarks=(*remarks, *line.remarks, *case, *_coarse(evidence, line.values)), orders=line.orders,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class LimitLine:
    """A value over speed and what is allowed there."""

    criterion: str
    quantity: str
    unit: str
    values: FloatArray
    allowed: FloatArray
    remarks: tuple[str, ...] = ()
    orders: FloatArray | None = None


def _worst_case(evidence: Evidence, line: LimitLine, sensor: Sensor) -> tuple[str, ...]:
    """A remark on the case, as the cylinder that misfires, which is worst at the worst speed."""
    with np.errstate(divide="ignore", invalid="ignore"):
        at = int(np.argmax(np.nan_to_num(line.values / line.allowed, nan=-1.0)))
    case = evidence.worst_case(sensor, at)
    return (f"worst at {evidence.run.rpm[at]:g} rpm: {case}",) if case else ()


def _coarse(evidence: Evidence, values: FloatArray) -> tuple[str, ...]:
    """A remark where the highest peak is so sharp that it may be higher between two speeds."""
    at = int(np.argmax(values))
    if at in (0, len(values) - 1):
        return ()
    beside = (values[at - 1] + values[at + 1]) / 2
    if beside >= (1 - COARSE) * values[at]:
        return ()
    return (f"the peak at {evidence.run.rpm[at]:g} rpm is sharp; a smaller step of speeds may find it higher",)
