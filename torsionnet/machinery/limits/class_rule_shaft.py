"""Base of the limits of shaft stress by rules of classification societies, which bar ranges of speed around peaks."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import OneOf, entry, not_none
from torsionnet.base.errors import Fault
from torsionnet.base.phrases import phrase
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.limits.evidence import Evidence, LimitSubject
from torsionnet.machinery.limits.limit import NOT_EXAMINED, PASSING_TIME, TOLERANCE, LimitLine, register_rule
from torsionnet.machinery.limits.m68_factors import CAPS, usual_range
from torsionnet.machinery.limits.shaft_limit import (
    SET_SOCIETIES,
    SOCIETIES,
    GeneratingSetNumbers,
    ShaftLimit,
    SocietyName,
)
from torsionnet.machinery.orders.speed_refinement import vertex_speed
from torsionnet.machinery.verdicts.limit_verdict import FAIL, PASS, LimitVerdict, RuleText
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
            yield Fault(text, on_key=True, about="speeds", kind="missing-entry")

    def may_bar_higher(self, subject: LimitSubject) -> bool:
        """Whether ranges above ``no_barred_above`` may be barred, as while a cylinder misfires."""
        return subject.misfiring

    def judged(self, line: LimitLine, name: str, evidence: Evidence) -> Iterator[LimitVerdict]:
        if not line.in_passing or np.isfinite(line.allowed).any():
            yield from super().judged(line, name, evidence)

    def continuous(self, line: LimitLine, name: str, evidence: Evidence) -> LimitVerdict:
        if self.speed_band:
            return super().continuous(line, name, evidence)
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
        # The rule of thumb is around the critical speed: here the top of the stress where it exceeds the limit.
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
        # A range ends where the rule or the examined speeds do: nothing is known of stresses beyond.
        covered = SpeedSpan(evidence.examined.low, top)
        nothing = f"the rule says nothing above lambda = {self.highest_ratio:g}"
        above = nothing if top < evidence.examined.high else NOT_EXAMINED[1]
        barred = joined_spans([span.within(covered) for span in wanted])
        remarks = list(self.on_barred())
        remarks += [remark for span in barred for remark in range_end_remarks(span, covered, NOT_EXAMINED[0], above)]
        limit = self.no_barred_above * rated
        # A range that begins below the ratio and reaches above it cannot be barred either.
        beyond = [span for span in barred if span.high > limit * (1 + 1e-12)]
        if beyond and not self.may_bar_higher(evidence.subject):
            where = f"above lambda = {self.no_barred_above:g}, where no range may be barred"
            remarks.insert(0, f"{line.criterion} is exceeded {where}: {beyond[0]}")
            below = tuple(span for span in barred if span not in beyond)
            return self._verdict(line, name, evidence, FAIL, below, tuple(remarks))
        verdict = self.with_barred(line, name, evidence, barred, [rated, top], remarks)
        return verdict if self.may_bar_higher(evidence.subject) else replace(verdict, free_above=limit)

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


# Limits of the vibratory stress of shafts of generating sets that piston engines drive.

SHAFTS = ("generator", "crankshaft_in_line", "crankshaft_other")
"""Kinds of shafts of a generating set for which societies permit different stresses."""
FORMULA = (
    "{shaft}: {continuous} = {steady:g} f_m N/mm^2 up to {ratio} = {highest:g}, exceeded below {lowest:g} alone and in "
    "passing; {passing} = {quick:g} f_m N/mm^2 up to {ratio} = {lowest:g}; f_m = 1 + 2/3 (T_s/{strength:g} - 1), at "
    "least 1: {by_strength:.4g}; in passing Y/{limit:g}, at least 1: {by_yield:.4g}"
)
"""Formula of the limits of generating sets as reports print it."""
NOT_COVERED = (
    "speeds above the highest ratio; short circuit and faulty synchronisation; bending; crankshafts whose strength was "
    "calculated throw by throw; the avoidance of major criticals near rated speed"
)
"""Text with what the limits of generating sets do not cover, as reports print it."""


@register_rule
@dataclass(frozen=True, kw_only=True)
class GeneratingSetShaft(ClassRuleShaft):
    """Generator shaft, or crankshaft of the engine, of a generating set: tau_C around rated speed, tau_T below.

    By KR Rules Part 5 Chapter 4 (2025), 203: a generator shaft bears 31 N/mm^2 from lambda = 0.9 to 1.1, 118 N/mm^2
    while lower speeds are passed; a crankshaft 21 N/mm^2 (four-stroke engines in line, or V engines that fire every 45
    or 60 degrees) or 16 N/mm^2 (all others), 90 N/mm^2 in passing. A steel above 440 N/mm^2 raises the former by f_m =
    1 + 2/3 (T_s/440 - 1), a yield strength Y above 225 N/mm^2 the latter by Y/225.

    Examples
    --------
    >>> shaft = GeneratingSetShaft(element="rotor_shaft", shaft="generator", material="alloy",
    ...     tensile_strength="660 MPa", yield_strength="450 MPa")
    >>> [round(factor, 4) for factor in shaft.material_factors]
    [1.3333, 2.0]
    """

    kind: ClassVar[str] = "generating_set_shaft"

    shaft: str = entry(
        OneOf("crankshaft_in_line: of a four-stroke engine in line or V that fires every 45 or 60 degrees", SHAFTS)
    )
    material: str = entry(OneOf("kind of steel", tuple(CAPS)))
    tensile_strength: float = entry(Value("specified minimum tensile strength", "pressure", exclusive=True))
    yield_strength: float | None = entry(
        Value("specified minimum yield strength; default: none above that of the rule", "pressure", exclusive=True),
        None,
    )
    rules: str = entry(SocietyName("society whose text counts", SET_SOCIETIES), "kr")

    @property
    def numbers(self) -> GeneratingSetNumbers:
        """Stresses that the society permits in Pa, with the speed ratios they are for."""
        return not_none(SOCIETIES[self.rules].sets)

    @property
    def no_barred_above(self) -> float:
        return self.numbers.lowest

    @property
    def highest_ratio(self) -> float:
        return self.numbers.highest

    @property
    def material_factors(self) -> tuple[float, float]:
        """Dimensionless factors of the material on the stress in continuous operation and in passing, 1 or more."""
        numbers = self.numbers
        # f_m = 1 + 2/3 (T_s/T_0 - 1) up to the strength that counts, and Y/Y_0 in passing; no less than 1.
        strength = min(self.tensile_strength, numbers.caps[self.material])
        passing = (self.yield_strength or 0.0) / numbers.yield_strength
        return max(1.0, 1 + 2 / 3 * (strength / numbers.tensile_strength - 1)), max(1.0, passing)

    @property
    def permitted(self) -> tuple[float, float]:
        """Stresses in Pa that the shaft bears in continuous operation and in passing."""
        factors = self.material_factors
        return self.numbers.continuous[self.shaft] * factors[0], self.numbers.passing[self.shaft] * factors[1]

    def contradictions(self) -> list[Fault]:
        faults = super().contradictions()
        if self.tensile_strength < 100e6:
            got = f"{self.tensile_strength / 1e6:g} N/mm^2"
            faults.append(
                Fault(
                    f"steel has a tensile strength of 100 N/mm^2 or more; got {got}",
                    ("tensile_strength",),
                    kind="out-of-range",
                )
            )
        if self.yield_strength is not None and self.yield_strength > self.tensile_strength:
            faults.append(
                Fault(
                    "the yield strength is not above the tensile strength",
                    ("yield_strength",),
                    kind="contradicting-values",
                )
            )
        return faults

    def unfit(self, subject: LimitSubject) -> Iterator[Fault]:
        yield from super().unfit(subject)
        yield from self.no_rated_speed(subject)

    def may_bar_higher(self, subject: LimitSubject) -> bool:
        # A set runs at rated speed or not at all, also with a cylinder out.
        del subject
        return False

    def breaks(self, subject: LimitSubject) -> list[float]:
        rated = self.rated_speed(subject)
        return [*super().breaks(subject), self.no_barred_above * rated, self.highest_ratio * rated]

    def rule_text(self, evidence: Evidence) -> RuleText:
        del evidence
        numbers, society = self.numbers, SOCIETIES[self.rules]
        own = numbers.continuous[self.shaft] / 1e6, numbers.passing[self.shaft] / 1e6
        factors = self.material_factors
        # Names of stresses and of the speed ratio are the society's.
        continuous, passing, ratio = map(society.in_words, ("tau_C", "tau_T", "lambda"))
        formula = phrase(
            FORMULA, shaft=phrase(self.shaft.replace("_", " ")), continuous=continuous, passing=passing, ratio=ratio,
            steady=own[0], quick=own[1], highest=numbers.highest, lowest=numbers.lowest,
            strength=numbers.tensile_strength / 1e6, by_strength=factors[0],
            limit=numbers.yield_strength / 1e6, by_yield=factors[1],
        )  # fmt: skip
        return RuleText(numbers.source, formula, NOT_COVERED)

    def lines(self, evidence: Evidence) -> Iterator[LimitLine]:
        society, numbers = SOCIETIES[self.rules], self.numbers
        ratio = evidence.speeds / self.rated_speed(evidence.subject)
        values, orders = self.stress(evidence)
        continuous, passing = self.permitted
        quantity = "nominal shear stress, half range"
        allowed = np.where(ratio <= numbers.highest * (1 + 1e-12), continuous, np.nan)
        cases = self.stress_by_case(evidence)
        yield LimitLine(society.in_words("tau_C"), quantity, "Pa", values, allowed, (), orders, cases=cases)
        below = np.where(ratio <= numbers.lowest * (1 + 1e-12), passing, np.nan)
        yield LimitLine(society.in_words("tau_T"), quantity, "Pa", values, below, (), orders, in_passing=True)

    def remarks(self, line: LimitLine, evidence: Evidence) -> tuple[str, ...]:
        said = super().remarks(line, evidence)
        return said if line.in_passing else (*said, *self._remarks(evidence))

    def _remarks(self, evidence: Evidence) -> Iterator[str]:
        numbers = self.numbers
        ratio = evidence.speeds / self.rated_speed(evidence.subject)
        low, high = float(ratio[0]), float(ratio[-1])
        wanted = f"the set runs from {numbers.lowest:g} to {numbers.highest:g}"
        if low > numbers.lowest * (1 + 1e-9):
            yield f"speeds examined begin at lambda = {low:.3g}; {wanted}, and lower speeds are passed"
        if high < numbers.highest * (1 - 1e-9):
            yield f"speeds examined end at lambda = {high:.3g}; {wanted}"
        if high > numbers.highest * (1 + 1e-9):
            yield f"lambda above {numbers.highest:g} is not covered"
        if self.tensile_strength > numbers.caps[self.material]:
            counted = f"{numbers.caps[self.material] / 1e6:g} N/mm^2"
            yield f"a tensile strength above {counted} counts as the society decides; here {counted}"
