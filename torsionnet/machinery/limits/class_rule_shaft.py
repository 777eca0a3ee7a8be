"""Base of the limits of shaft stress by rules of classification societies, which bar ranges of speed around peaks."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.limits.evidence import Evidence
from torsionnet.machinery.limits.limit import NOT_EXAMINED, PASSING_TIME, TOLERANCE, LimitLine
from torsionnet.machinery.limits.m68_stress import usual_range
from torsionnet.machinery.limits.shaft_limit import ShaftLimit
from torsionnet.machinery.limits.subject import LimitSubject
from torsionnet.machinery.orders.speed_refinement import vertex_speed
from torsionnet.machinery.verdicts.limit_check import FAIL, PASS, LimitVerdict
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan, joined_spans, range_end_remarks, spans_above


@dataclass(frozen=True, kw_only=True)
class ClassRuleShaft(ShaftLimit):
    """Base of limits of shaft stress over the speed ratio lambda = n/n_rated, with barred ranges below a ratio."""

    rated: float | None = entry(
        Value("rated speed of the reference shaft; default: that of speeds:", "speed", exclusive=True), None
    )
    tachometer_tolerance: float = entry(TOLERANCE, 0)
    passing_time: float | None = entry(PASSING_TIME, None)

    @property
    def no_barred_above(self) -> float:
        """Speed ratio above which no range may be barred in normal firing."""
        raise NotImplementedError

    @property
    def highest_ratio(self) -> float:
        """Speed ratio above which the rule says nothing."""
        raise NotImplementedError

    @property
    def tolerance(self) -> float:
        return float(self.tachometer_tolerance)

    @property
    def seconds_to_pass(self) -> float | None:
        return None if self.passing_time is None else float(self.passing_time)

    def rated_speed(self, subject: LimitSubject) -> float:
        """Rated speed of the reference shaft in rad/s, nan where neither limit nor model gives it."""
        return float(self.rated or subject.rated or math.nan)

    def no_rated_speed(self, subject: LimitSubject) -> Iterator[Fault]:
        """Fault that the rated speed is missing."""
        if self.rated is None and subject.rated is None:
            text = "lambda = n/n_rated needs the rated speed: speeds: {rated: 750 rpm}, or rated: of this limit"
            yield Fault(text, on_key=True, about="speeds")

    def may_bar_higher(self, subject: LimitSubject) -> bool:
        """Whether ranges above ``no_barred_above`` may be barred, as while a cylinder misfires."""
        return subject.misfiring

    def judged(self, line: LimitLine, name: str, evidence: Evidence) -> Iterator[LimitVerdict]:
        if not line.in_passing or np.isfinite(line.allowed).any():
            yield from super().judged(line, name, evidence)

    def continuous(self, line: LimitLine, name: str, evidence: Evidence) -> LimitVerdict:
        wanted = [
            self._barred(span, evidence, values)
            for values in line.each.T
            for span in spans_above(evidence.speeds, values, line.allowed)
        ]
        return self._in_operation(line, name, evidence, wanted)

    def _barred(self, above: SpeedSpan, evidence: Evidence, values: FloatArray) -> SpeedSpan:
        """Range of speeds in rad/s to be barred around the peak of the stress.

        Speeds above the stress permitted and the usual range around the peak, with the tachometer's tolerance.

        The rule of thumb must cover what exceeds it; beyond that it may stop where ranges must.
        """
        rated = self.rated_speed(evidence.subject)
        inside = np.array([above.holds(speed) for speed in evidence.speeds.tolist()])
        at = int(np.argmax(np.where(inside, values, -np.inf)))
        usual = usual_range(min(max(vertex_speed(evidence.speeds, values, at), above.low), above.high), rated)
        span = SpeedSpan(min(above.low, usual.low), max(above.high, usual.high)).widened(self.tolerance)
        limit = self.no_barred_above * rated
        if not self.may_bar_higher(evidence.subject) and above.high * (1 + self.tolerance) <= limit:
            return SpeedSpan(span.low, min(span.high, limit))
        return span

    def _in_operation(self, line: LimitLine, name: str, evidence: Evidence, wanted: list[SpeedSpan]) -> LimitVerdict:
        if not wanted:
            return self._verdict(line, name, evidence, PASS, (), ())
        rated = self.rated_speed(evidence.subject)
        top = min(self.highest_ratio * rated, evidence.examined.high)
        covered = SpeedSpan(evidence.examined.low, top)
        nothing = f"the rule says nothing above lambda = {self.highest_ratio:g}"
        above = nothing if top < evidence.examined.high else NOT_EXAMINED[1]
        barred = joined_spans([span.within(covered) for span in wanted])
        remarks = list(self.on_barred())
        remarks += [remark for span in barred for remark in range_end_remarks(span, covered, NOT_EXAMINED[0], above)]
        limit = self.no_barred_above * rated
        beyond = [span for span in barred if span.high > limit * (1 + 1e-12)]
        if beyond and not self.may_bar_higher(evidence.subject):
            where = f"above lambda = {self.no_barred_above:g}, where no range may be barred"
            remarks.insert(0, f"{line.criterion} is exceeded {where}: {beyond[0]}")
            below = tuple(span for span in barred if span not in beyond)
            return self._verdict(line, name, evidence, FAIL, below, tuple(remarks))
        return self.with_barred(line, name, evidence, barred, [rated, top], remarks)

    def with_barred(
        self,
        line: LimitLine,
        name: str,
        evidence: Evidence,
        barred: tuple[SpeedSpan, ...],
        kept: list[float],
        remarks: list[str],
    ) -> LimitVerdict:
        """Verdict on a stress that bars ranges of speed which may be barred; ``kept`` are speeds in rad/s to be run."""
        return self._restricted(line, name, evidence, barred, kept, tuple(remarks))

    def on_barred(self) -> Iterator[str]:
        """Remarks of the rule on shafts of plants with a barred range."""
        yield from ()
