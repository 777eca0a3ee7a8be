"""Limits of IACS unified requirement M68 on torsional vibration stresses of propulsion shafts."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, OneOf, entry
from torsionnet.base.errors import Fault
from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.limits.class_rule_shaft import ClassRuleShaft
from torsionnet.machinery.limits.evidence import Evidence, LimitSubject
from torsionnet.machinery.limits.limit import LimitLine, line_without_data, register_rule
from torsionnet.machinery.limits.m68_factors import (
    CAPS,
    CONSTANT_ABOVE,
    FEATURES,
    GEARING,
    HIGHEST_RATIO,
    HOLE,
    NO_BARRED_ABOVE,
    NOT_COVERED,
    NOT_FOR_CRANKSHAFTS,
    NOT_FOR_GEARS,
    NOT_FOR_SETS,
    OF_PITCH,
    PASSING_FACTOR,
    PROPELLER_CAP,
    SCF_OF_UNIT,
    SLOT_BORE,
    SLOT_LENGTH,
    SLOT_WIDTH,
    STRENGTH_FOR_PASSING,
    STRENGTHS,
    m68_factors,
    permissible,
    size_factor,
)
from torsionnet.machinery.limits.shaft_limit import SHAFT_SOCIETIES, SOCIETIES, RoundSection, Society, SocietyName
from torsionnet.machinery.verdicts.limit_verdict import FAIL, LimitVerdict, RuleText
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan, restriction_words


@register_rule
@dataclass(frozen=True, kw_only=True)
class IacsM68(ClassRuleShaft):
    """Intermediate, thrust and propeller shafts of ships: tau_C in continuous operation, tau_T in passing.

    With the speed ratio lambda = n/n_rated, tau_C = (sigma_B + 160)/18 C_K C_D (3 - 2 lambda^2) below 0.9 and
    (sigma_B + 160)/18 C_K C_D 1.38 up to 1.05, N/mm^2; tau_T = 1.7 tau_C/sqrt(C_K) up to 0.8;
    C_D = 0.35 + 0.93 d^-0.2 with d in mm. The stress is the half range of the sum of all orders on the plain section.

    Examples
    --------
    >>> shaft = IacsM68(element="tail", shaft="propeller", feature="keyless", material="alloy",
    ...     tensile_strength="700 MPa")
    >>> shaft.strength / 1e6, shaft.feature_factor
    (600.0, 0.55)
    """

    kind: ClassVar[str] = "iacs_m68"

    shaft: str = entry(OneOf("which shaft it is", tuple(FEATURES)))
    feature: str = entry(
        OneOf("design feature where the stress is judged", tuple(name for table in FEATURES.values() for name in table))
    )
    material: str = entry(OneOf("kind of steel", tuple(STRENGTHS)))
    tensile_strength: float = entry(Value("specified minimum tensile strength sigma_B", "pressure", exclusive=True))
    hole_diameter: float | None = entry(Value("diameter of a radial hole", "length", exclusive=True), None)
    slot_length: float | None = entry(Value("length of a longitudinal slot", "length", exclusive=True), None)
    slot_width: float | None = entry(Value("its width", "length", exclusive=True), None)
    slots: int = entry(Count("slots, evenly around the shaft", 1, 12), 1)
    stress_concentration: float | None = entry(
        Value("of a slot, largest principal stress over sqrt(3) tau_nominal: C_K = 1.45/scf", "1", exclusive=True), None
    )
    rules: str = entry(SocietyName("society whose text counts, with its symbols", SHAFT_SOCIETIES), "m68")
    safe_speed: float | None = entry(
        Value("speed of the reference shaft that must stay free with a cylinder misfiring", "speed", exclusive=True),
        None,
    )

    def contradictions(self) -> list[Fault]:
        faults = super().contradictions()
        known = FEATURES[self.shaft]
        if self.feature not in known:
            owner = next(shaft for shaft, table in FEATURES.items() if self.feature in table)
            text = f'"{self.feature}" belongs to a shaft: {owner}; {self.shaft} has {", ".join(known)}'
            faults.append(Fault(text, ("feature",), kind="unfit-rule"))
        low, high = STRENGTHS[self.material]
        if not low <= self.tensile_strength <= high:
            text = f"sigma_B of {self.material.replace('_', '-')} steel is {low / 1e6:g} to {high / 1e6:g} N/mm^2 here"
            got = f"{self.tensile_strength / 1e6:g} N/mm^2"
            faults.append(Fault(f"{text}; got {got}", ("tensile_strength",), kind="unfit-rule"))
        return [*faults, *self._wrong_details()]

    def _wrong_details(self) -> Iterator[Fault]:
        for key, feature in (
            ("hole_diameter", "radial_hole"),
            ("slot_length", "longitudinal_slot"),
            ("slot_width", "longitudinal_slot"),
            ("stress_concentration", "longitudinal_slot"),
        ):
            if getattr(self, key) is not None and self.feature != feature:
                yield Fault(f"{key} goes with feature: {feature}", (key,), on_key=True, kind="needless-entry")
        if self.slots > 3 and self.stress_concentration is None:
            text = "C_K = 0.30 is for 1, 2 or 3 slots; give the stress_concentration of others"
            yield Fault(text, ("slots",), kind="unfit-rule")

    def unfit(self, subject: LimitSubject) -> Iterator[Fault]:
        wrong = list(super().unfit(subject))
        yield from wrong
        reason = "" if wrong else self._inapplicable(self.section(subject))
        if reason:
            yield Fault(reason, ("feature",), kind="unfit-rule")
        yield from self.no_rated_speed(subject)
        yield from self._unexamined(subject)
        foreign = self._foreign(subject)
        if foreign:
            yield Fault(foreign, ("rule",), "warning", on_key=True, kind="unfit-rule")

    def _foreign(self, subject: LimitSubject) -> str:
        """Message why the shaft is none of those that the rule is for; empty where it may be."""
        if subject.is_generating_set:
            return NOT_FOR_SETS
        # A part between two throws, as others may lie between a cylinder and the flywheel.
        nodes = set(subject.elements[self.element].ports.values())
        if len(nodes) > 1 and nodes <= subject.cranks:
            return phrase(NOT_FOR_CRANKSHAFTS, name=self.element)
        meshing = {
            node for element in subject.elements.values() if element.kind in GEARING for node in element.ports.values()
        }
        return phrase(NOT_FOR_GEARS, name=self.element) if len(nodes) > 1 and nodes <= meshing else ""

    def _unexamined(self, subject: LimitSubject) -> Iterator[Fault]:
        """Fault that the speed for safe navigation is not among the speeds examined."""
        if self.safe_speed is None or not subject.speeds:
            return
        low, high = subject.speeds[0], subject.speeds[-1]
        if not low * (1 - 1e-9) <= self.safe_speed <= high * (1 + 1e-9):
            examined = phrase("{low:.6g} to {high:.6g} rpm", low=low * RPM, high=high * RPM)
            text = f"safe_speed of {self.safe_speed * RPM:.6g} rpm is not among the speeds examined, {examined}"
            yield Fault(text, ("safe_speed",), kind="out-of-range")

    def _inapplicable(self, section: RoundSection) -> str:
        """Message why the factor C_K does not hold for the hole or slot given; empty where it does."""
        outer = section.outer
        if self.hole_diameter is not None and self.hole_diameter > HOLE * outer:
            return f"C_K = 0.50 is for radial holes up to {HOLE:g} d; this one has {self.hole_diameter / outer:.3g} d"
        if self.feature != "longitudinal_slot" or self.stress_concentration is not None:
            return ""
        fits = {f"bore/d < {SLOT_BORE}": section.inner < SLOT_BORE * outer}
        if self.slot_length is not None:
            fits[f"length/d < {SLOT_LENGTH}"] = self.slot_length < SLOT_LENGTH * outer
        if self.slot_width is not None:
            fits[f"width/d > {SLOT_WIDTH}"] = self.slot_width > SLOT_WIDTH * outer
        missed = [text for text, fit in fits.items() if not fit]
        return f"C_K = 0.30 is for slots with {', '.join(missed)}; give the stress_concentration" if missed else ""

    def _assumed(self) -> Iterator[str]:
        """Remarks on dimensions that footnotes of the rule ask for and the limit does not give."""
        if self.feature == "radial_hole" and self.hole_diameter is None:
            yield f"hole_diameter not given: taken to be at most {HOLE:g} d"
        if self.feature == "longitudinal_slot" and self.stress_concentration is None:
            missing = [key for key in ("slot_length", "slot_width") if getattr(self, key) is None]
            if missing:
                sizes = f"length/d < {SLOT_LENGTH}, width/d > {SLOT_WIDTH}"
                yield f"{' and '.join(missing)} not given: taken to be {sizes}, ends rounded with half the width"

    @property
    def strength(self) -> float:
        """Tensile strength sigma_B of the shaft in Pa, capped as the rule says."""
        # Strengths count up to a cap: that of the steel, and that of propeller shafts if it is lower.
        cap = min(CAPS[self.material], PROPELLER_CAP if self.shaft == "propeller" else math.inf)
        return float(min(self.tensile_strength, cap))

    @property
    def feature_factor(self) -> float:
        """Dimensionless factor C_K of the shaft's design feature."""
        if self.stress_concentration is not None:
            # C_K = 1.45/scf of a slot, and no more than that of a plain shaft.
            return float(min(1.0, SCF_OF_UNIT / self.stress_concentration))
        return FEATURES[self.shaft][self.feature]

    def rule_text(self, evidence: Evidence) -> RuleText:
        size = size_factor(self.section(evidence.subject).outer)
        formula = (
            "tau_C = (sigma_B + 160)/18 C_K C_D (3 - 2 lambda^2), from lambda = 0.9 to 1.05 (sigma_B + 160)/18 C_K C_D "
            f"1.38; tau_T = 1.7 tau_C/sqrt(C_K) up to lambda = 0.8; C_K = {self.feature_factor:g} ({self.feature}), "
            f"C_D = {size:.5f}, sigma_B = {self.strength / 1e6:g} N/mm^2 (given {self.tensile_strength / 1e6:g})"
        )
        missing = NOT_COVERED if evidence.subject.fixed_pitch else f"{NOT_COVERED}{OF_PITCH}"
        missing += f"; {self.society.remark}" if self.society.remark else ""
        factors = m68_factors(self, self.section(evidence.subject))
        return RuleText(self.society.shafts, self.society.in_words(formula), missing, factors)

    @property
    def society(self) -> Society:
        """Row of the society whose text counts."""
        return SOCIETIES[self.rules]

    @property
    def no_barred_above(self) -> float:
        return NO_BARRED_ABOVE

    @property
    def highest_ratio(self) -> float:
        return HIGHEST_RATIO

    def kept_free(self, subject: LimitSubject) -> float | None:
        return self.safe_speed if subject.misfiring else None

    def breaks(self, subject: LimitSubject) -> list[float]:
        rated = self.rated_speed(subject)
        return [*super().breaks(subject), NO_BARRED_ABOVE * rated, CONSTANT_ABOVE * rated, HIGHEST_RATIO * rated]

    def lines(self, evidence: Evidence) -> Iterator[LimitLine]:
        continuous, in_passing = (self.society.in_words(symbol) for symbol in ("tau_C", "tau_T"))
        why = self._foreign(evidence.subject) or self._inapplicable(self.section(evidence.subject))
        if why:
            yield line_without_data(continuous, why)
            return
        ratio = evidence.speeds / self.rated_speed(evidence.subject)
        values, orders = self.stress(evidence)
        factors = self.feature_factor * size_factor(self.section(evidence.subject).outer)
        allowed = permissible(self.strength, factors, ratio)
        quantity = "nominal shear stress, half range"
        cases = self.stress_by_case(evidence)
        yield LimitLine(continuous, quantity, "Pa", values, allowed, (), orders, cases=cases)
        below = ratio <= NO_BARRED_ABOVE * (1 + 1e-12)
        # tau_T = 1.7 tau_C/sqrt(C_K), said for lambda up to 0.8 only.
        passing = np.where(below, PASSING_FACTOR * allowed / math.sqrt(self.feature_factor), np.nan)
        yield LimitLine(in_passing, quantity, "Pa", values, passing, (), orders, in_passing=True)

    def remarks(self, line: LimitLine, evidence: Evidence) -> tuple[str, ...]:
        ratio = evidence.speeds / self.rated_speed(evidence.subject)
        said = super().remarks(line, evidence)
        return said if line.in_passing else (*said, *self._assumed(), *_beyond(evidence, ratio))

    def with_barred(
        self,
        line: LimitLine,
        name: str,
        evidence: Evidence,
        barred: tuple[SpeedSpan, ...],
        kept: list[float],
        remarks: list[str],
    ) -> LimitVerdict:
        if evidence.subject.misfiring and self.safe_speed is None:
            remarks.append("a cylinder misfires: ranges must leave safe navigation possible; give safe_speed")
        lost = [span for span in barred if self.safe_speed is not None and span.holds(self.safe_speed)]
        verdict = super().with_barred(line, name, evidence, barred, kept, remarks)
        above = self.safe_speed is not None and verdict.highest is not None and self.safe_speed > verdict.highest
        if above:
            said = f"safe_speed is above the highest speed permitted: {restriction_words((), verdict.highest)}"
        elif evidence.subject.misfiring and lost:
            said = f"safe_speed lies in a range to be barred: {lost[0]}"
        else:
            return verdict
        # The ranges may be passed all the same: what decides is the speed that does not stay free.
        return replace(verdict, verdict=FAIL, remarks=(said, *verdict.remarks), not_free=self.safe_speed)

    def on_barred(self) -> Iterator[str]:
        if self.feature.endswith("keyway"):
            yield "keyways are in general not for plants with a barred speed range"
        if self.tensile_strength < STRENGTH_FOR_PASSING:
            passing = self.society.in_words("tau_T")
            yield f"shafts stressed nearly up to {passing} want a tensile strength of 500 N/mm^2 or more"


def _beyond(evidence: Evidence, ratio: FloatArray) -> tuple[str, ...]:
    """Remark on speeds that the rule does not cover."""
    rpm = evidence.run.rpm[ratio > HIGHEST_RATIO * (1 + 1e-12)]
    if ratio[-1] < 1 - 1e-9:
        return (f"speeds examined end at lambda = {ratio[-1]:.3g}: nothing is said of those from there to rated speed",)
    return (f"speeds from {rpm[0]:g} to {rpm[-1]:g} rpm: lambda above 1.05 is not covered",) if len(rpm) else ()
