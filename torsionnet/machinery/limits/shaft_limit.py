"""Base of limits of shaft stress, and what classification societies say on torsional vibration, with its sources."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import EntryError, OneOf, Text, entry, not_none
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.limits.evidence import Evidence, LimitSubject, torques_of
from torsionnet.machinery.limits.limit import LimitLine, line_without_data, register_rule
from torsionnet.machinery.limits.speed_band import InSpeedBand
from torsionnet.machinery.orders.order_amplitudes import OrderAmplitudes
from torsionnet.machinery.verdicts.limit_verdict import RuleText
from torsionnet.model.channels import Sensor
from torsionnet.model.element_base.element_entries import ElementName
from torsionnet.model.elements import Element, Values

# Rows of what classification societies say on torsional vibration of shafts, each with its source.


@dataclass(frozen=True)
class GeneratingSetNumbers:
    """Vibratory shear stresses in Pa that a society permits the shafts of a generating set driven by a piston engine.

    Attributes
    ----------
    lowest, highest : float
        Speed ratios between which the set runs continuously.
    continuous, passing : mapping
        Stress in Pa from ``lowest`` to ``highest``, and while lower speeds are passed, by kind of shaft.
    tensile_strength, yield_strength : float
        Pa; of the steel that the stresses are for.
    caps : mapping
        Largest tensile strength in Pa that counts, by kind of steel.
    source : str
    """

    lowest: float
    highest: float
    continuous: Mapping[str, float]
    passing: Mapping[str, float]
    tensile_strength: float
    yield_strength: float
    caps: Mapping[str, float]
    source: str


@dataclass(frozen=True)
class Society:
    """Row of a classification society: names, symbols, words of its form, and the numbers that its text gives.

    Attributes
    ----------
    name : str
    edition : str
        Text that was read, with its edition.
    words : mapping
        What the society calls things, by the words and symbols that limits and reports use of themselves.
    marking : str
        How ranges are marked, and how they are passed.
    asked_for : tuple of (str, str, str)
        Paragraph, what it asks of the calculation, and the section of a report that has it.
    highest_critical_ratio : float, optional
        Speed ratio up to which critical speeds are to be given.
    shafts : str
        Source of the stresses of propulsion shafts; empty where its text was not at hand.
    sets : GeneratingSetNumbers, optional
    remark : str
        What of the society's rules is left out or stands in for its text.
    """

    name: str
    edition: str
    words: Mapping[str, str] = field(default_factory=dict)
    marking: str = ""
    asked_for: tuple[tuple[str, str, str], ...] = ()
    highest_critical_ratio: float | None = None
    shafts: str = ""
    sets: GeneratingSetNumbers | None = None
    remark: str = ""

    def in_words(self, text: str) -> str:
        """Text with the society's words and symbols in place of those that limits and reports use of themselves.

        >>> SOCIETIES["lr"].in_words("barred ranges above tau_C up to lambda = 0.8")
        'restricted speed ranges above tau_c up to r = 0.8'
        """
        if not self.words:
            return text
        said = {
            word.replace("_", mark): other.replace("_", mark) for mark in "_ " for word, other in self.words.items()
        }
        # A name from the model that holds one of the words is longer, and stays.
        known = "|".join(sorted(map(re.escape, said), key=len, reverse=True))
        return re.sub(rf"(?<![\w-])({known})(?=s?(?![\w-]))", lambda match: said[match[1]], text)


SOURCE = (
    "IACS UR M68, torsional vibration stresses and C_K as in KR Rules Part 5 Chapter 4 (2025), 202 and 206, "
    "which carry them"
)
"""Text with the source of IACS M68 as reports print it."""
KR_CHAPTER = "KR Rules for the Classification of Steel Ships, Part 5 Chapter 4 (2025)"
"""Chapter of the Korean Register's rules on torsional vibration, with its edition."""
LR_CHAPTER = (
    "LR Rules for the Classification of Naval Ships (January 2023), Vol 2 Pt 5 Ch 1, 1.1 to 3.1 and Table 1.3.1 in "
    "part; restricted speed range as in Ch 2, 3.3"
)
"""Chapter of the rules of Lloyd's Register that was at hand in part, with its edition."""

SOCIETIES: dict[str, Society] = {
    "m68": Society(
        name="IACS UR M68",
        edition="as carried by KR Part 5 Chapter 4 (2025); of M68 itself the scope",
        shafts=SOURCE,
    ),
    "kr": Society(
        name="Korean Register (KR)",
        edition=KR_CHAPTER,
        words={"tau_C": "tau_1", "tau_T": "tau_2", "C_K": "C_k", "C_D": "C_d", "sigma_B": "T_s"},
        marking="red zones on the engine tachometers; passed as rapidly as possible (206.1)",
        asked_for=(
            (
                "102.1(1)",
                "natural frequencies and modes with one and two nodes, more if need be",
                "natural_frequencies",
            ),
            ("102.1(2)", "stresses at critical speeds up to 120 % of the maximum continuous speed", "resonances"),
            ("102.1(3)", "vibratory torques of shafts, gears and flexible couplings", "forced_response"),
            ("102.1(4)", "stresses of propulsion shafts with any one cylinder misfiring", "components"),
            ("103.2", "measurements that confirm the calculation", "measurement_plan"),
            ("206.1", "barred speed ranges", "conclusion"),
        ),
        highest_critical_ratio=1.2,
        shafts=f"{KR_CHAPTER}, 202 and 206; C_k by Table 5.4.1",
        sets=GeneratingSetNumbers(
            lowest=0.9,
            highest=1.1,
            continuous={"generator": 31e6, "crankshaft_in_line": 21e6, "crankshaft_other": 16e6},
            passing={"generator": 118e6, "crankshaft_in_line": 90e6, "crankshaft_other": 90e6},
            tensile_strength=440e6,
            yield_strength=225e6,
            caps={"carbon": 590e6, "carbon_manganese": 590e6, "alloy": 835e6},
            source=f"{KR_CHAPTER}, 203 and 206, f_m by 201.4",
        ),
        remark="crankshafts of main engines (201) and the avoidance of major criticals (204) are not judged; C_K = "
        "1.45/scf of slots is that of M68, KR wants it agreed; ranges by measurement (206.3) are left to the test",
    ),
    "lr": Society(
        name="Lloyd's Register (LR)",
        edition=LR_CHAPTER,
        words={
            "barred speed range": "restricted speed range",
            "barred range": "restricted speed range",
            "tau_C": "tau_c",
            "tau_T": "tau_t",
            "C_K": "C_k",
            "C_D": "C_d",
            "sigma_B": "sigma_u",
            "lambda =": "r =",
            "lambda above": "r above",
            "lambda^2": "r^2",
        },
        asked_for=(
            ("2.1.1", "vibratory torques and stresses of the whole system", "forced_response"),
            ("2.1.2", "division of power over the speed range; several engines and their phases", "conditions"),
            ("2.1.4", "operating conditions of longer duration: idling, combinator", "conditions"),
            ("2.1.5", "makers' data of dampers and couplings with their vibratory loads and heat", "installation"),
            ("2.1.6", "dimensions of generator and motor shafts, inertia of rotors by the maker", "mass_elastic"),
            ("2.1.7", "monitoring of vibration, where it is required", "measurement_plan"),
        ),
        remark="words, symbols, C_D and the first C_K are those of LR; its formulas of the stresses permitted and its "
        "values for generating sets were not at hand, and limits are judged by the rule that each names",
    ),
}
"""Rows of the classification societies whose text on torsional vibration was at hand, by their short name."""


def in_all_words(word: str) -> frozenset[str]:
    """Words and symbols of all societies for a word or symbol that limits use of themselves, with this one.

    >>> sorted(in_all_words("tau_C"))
    ['tau_1', 'tau_C', 'tau_c']
    """
    return frozenset({word, *(society.in_words(word) for society in SOCIETIES.values())})


NOT_AT_HAND = {
    "lr": "of LR's rules words and symbols were at hand, but not the formulas of its limits (Pt 5 Ch 8 2.5)",
    "dnv": "the text of DNV's rules (DNV-RU-SHIP Pt.4 Ch.2, DNV-CG-0038) on torsional vibration was not at hand",
    "abs": "the text of ABS's rules (4-3-2/7) on torsional vibration was not at hand",
}
"""Reasons that the numbers of a society are missing here, by its short name."""
SHAFT_SOCIETIES = tuple(name for name, row in SOCIETIES.items() if row.shafts)
"""Short names of the societies by which stresses of propulsion shafts are judged."""
SET_SOCIETIES = tuple(name for name, row in SOCIETIES.items() if row.sets)
"""Short names of the societies by which stresses of generating sets are judged."""


class SocietyName(OneOf):
    """Entry of the society whose numbers are meant; says of others why they have none here."""

    def coerce(self, raw: object) -> str:
        if raw in NOT_AT_HAND and raw not in self.options:
            instead = "give the values that its letter of approval states as rule: curve"
            raise EntryError(
                f"{NOT_AT_HAND[str(raw)]}; judge by {' or '.join(self.options)}, or {instead}", kind="unknown-word"
            )
        return super().coerce(raw)


# Base of limits of shaft stress in a section of the shaft itself or of the limit's entries.

VIBRATORY_STRESSES = in_all_words("tau_C") | {"tau_W"}
"""Criteria of limits of shafts that judge the half range of the shear stress alone in continuous operation."""


@dataclass(frozen=True)
class RoundSection:
    """Round section by its outer and inner diameter in m.

    Examples
    --------
    >>> round(RoundSection(0.345).modulus * 1e6)
    8063
    """

    outer: float
    inner: float = 0.0

    @property
    def modulus(self) -> float:
        """Polar section modulus of the section in m^3."""
        return math.pi * (self.outer**4 - self.inner**4) / (16 * self.outer)


@dataclass(frozen=True, kw_only=True)
class ShaftLimit(InSpeedBand):
    """Base of the limits of nominal shear stress."""

    element: str = entry(ElementName("the shaft, or a spring that stands for one"))
    diameter: float | None = entry(
        Value("outer diameter where the stress is judged; default: that of the shaft", "length", exclusive=True), None
    )
    bore: float | None = entry(Value("inner diameter there; default: that of the shaft", "length"), None)

    @property
    def of(self) -> str:
        return str(self.element)

    @property
    def named(self) -> tuple[tuple[EntryPath, str, str], ...]:
        return ((("element",), "element", self.element),)

    def contradictions(self) -> list[Fault]:
        if self.diameter is not None and self.bore is not None and self.bore >= self.diameter:
            return [Fault("the bore must be smaller than the diameter", ("bore",), kind="contradicting-values")]
        return []

    def unfit(self, subject: LimitSubject) -> Iterator[Fault]:
        yield from super().unfit(subject)
        element, name = subject.elements[self.element], ModelName(self.element)
        if element.diameters is None and self.diameter is None:
            said = "{}, a {}, has no diameter, and so no stress; give the limit one, diameter: 300 mm, or make the "
            yield Fault(phrase(f"{said}element a shaft", name, element.kind), ("element",), kind="not-applicable")
        elif len(element.ports) != 2:
            yield Fault(
                phrase("{}, a {}, is no shaft between two nodes", name, element.kind),
                ("element",),
                kind="not-applicable",
            )
        else:
            section = self.section(subject)
            if section.inner >= section.outer:
                key = "diameter" if self.diameter is not None else "bore"
                said = "the bore of {}, {:g} mm, is no smaller than its diameter, {:g} mm"
                yield Fault(
                    phrase(said, name, 1000 * section.inner, 1000 * section.outer), (key,), kind="contradicting-values"
                )

    def order_sensors(self, subject: LimitSubject) -> list[Sensor]:
        return torques_of(subject.elements[self.element])

    def mean_sensors(self, subject: LimitSubject) -> list[Sensor]:
        del subject
        return [Sensor("torque", self.element)]

    def vibratory_sensors(self, criterion: str, subject: LimitSubject) -> tuple[list[Sensor], float] | None:
        if criterion not in VIBRATORY_STRESSES:
            return None
        return self.order_sensors(subject), 1 / self.section(subject).modulus

    def passing_sensors(self, criterion: str, subject: LimitSubject) -> tuple[list[Sensor], float] | None:
        del criterion  # each is of a stress with vibration in it
        return self.order_sensors(subject), 1 / self.section(subject).modulus

    def section(self, subject: LimitSubject) -> RoundSection:
        """Round section of the shaft in which the limit judges the stress."""
        own = _own(subject.elements[self.element], Values(subject.values))
        outer = self.diameter if self.diameter is not None else own.outer if own else math.nan
        inner = self.bore if self.bore is not None else own.inner if own else 0.0
        return RoundSection(float(outer), float(inner))

    def stress(self, evidence: Evidence) -> tuple[FloatArray, OrderAmplitudes]:
        """Half range (n_speeds,) and amplitudes by order of the nominal shear stress in Pa."""
        torques, modulus = torques_of(evidence.subject.active[self.element]), self.section(evidence.subject).modulus
        return evidence.size(torques) / modulus, evidence.orders(torques).times(1 / modulus)

    def stress_by_case(self, evidence: Evidence) -> FloatArray | None:
        """Half range in Pa of the nominal shear stress in each case of excitation, shape (n_speeds, n_cases).

        None where there are no cases.
        """
        torque = evidence.size_by_case(torques_of(evidence.subject.active[self.element]))
        return None if torque is None else torque / self.section(evidence.subject).modulus

    def mean_stress_of(self, evidence: Evidence) -> FloatArray | None:
        """Magnitude of the mean shear stress in Pa, shape (n_speeds,), None where it is not known."""
        mean = evidence.mean(Sensor("torque", self.element))
        return None if mean is None else abs(mean) / self.section(evidence.subject).modulus


def _own(element: Element, value: Values) -> RoundSection | None:
    if element.diameters is None:
        return None
    return RoundSection(*(float(value(diameter)) for diameter in element.diameters))


# Fatigue limits of shafts in torsion, with strengths that the user gives.


@register_rule
@dataclass(frozen=True, kw_only=True)
class FatigueLimit(ShaftLimit):
    """Stress amplitude of a shaft against a fatigue strength in shear, with mean stress by Goodman or Haigh.

    With K the fatigue stress concentration, tau_a the nominal half range and tau_m the nominal mean stress,
    K tau_a <= tau_W (1 - tau_m/tau_B)/S by Goodman, K tau_a <= (tau_W - M tau_m)/S by Haigh with the sensitivity M to
    mean stress. tau_W is the fully reversed strength at the knee of the S-N line, times (N_knee/N)^(1/slope) for fewer
    cycles N. Against yield, tau_m + tau_a <= tau_F/S_F.

    Examples
    --------
    >>> limit = FatigueLimit(element="shaft", fatigue_strength="150 MPa", mean_stress="none", cycles=2e5, slope=5)
    >>> round(limit.strength / 1e6, 2)
    237.73
    """

    kind: ClassVar[str] = "fatigue"

    fatigue_strength: float = entry(
        Value("fully reversed strength in shear tau_W at the knee of the S-N line", "pressure", exclusive=True)
    )
    stress_concentration: float = entry(Value("fatigue stress concentration K in torsion", "1", lower=1), 1)
    mean_stress: str = entry(OneOf("how mean stress counts", ("goodman", "haigh", "none")), "goodman")
    ultimate_strength: float | None = entry(
        Value("strength in shear tau_B, for goodman", "pressure", exclusive=True), None
    )
    mean_sensitivity: float | None = entry(Value("M, for haigh", "1", below=1), None)
    cycles: float | None = entry(Value("cycles N to be borne; default: unlimited", "1", lower=1000), None)
    knee: float = entry(Value("cycles N_knee at the knee of the S-N line", "1", lower=1000), 2_000_000)
    slope: float | None = entry(Value("of the S-N line: tau ~ N^(-1/slope) up to the knee", "1", lower=1), None)
    safety: float = entry(Value("S wanted against fatigue", "1", lower=1), 1)
    yield_strength: float | None = entry(Value("yield strength in shear tau_F", "pressure", exclusive=True), None)
    yield_safety: float = entry(Value("S_F wanted against yield", "1", lower=1), 1)
    source: str = entry(Text("where the strengths come from"), "strengths given by the user")

    def contradictions(self) -> list[Fault]:
        faults = super().contradictions()
        if self.mean_stress == "goodman" and self.ultimate_strength is None:
            text = "goodman needs ultimate_strength, in shear; or take mean_stress: haigh or none"
            faults.append(Fault(text, on_key=True, kind="missing-entry"))
        if self.mean_stress == "haigh" and self.mean_sensitivity is None:
            faults.append(Fault("haigh needs mean_sensitivity, as 0.2", on_key=True, kind="missing-entry"))
        if self.cycles is not None and self.slope is None:
            faults.append(
                Fault(
                    "a number of cycles needs the slope of the S-N line, as slope: 5", ("cycles",), kind="missing-entry"
                )
            )
        return faults

    @property
    def strength(self) -> float:
        """Fatigue strength tau_W in Pa of the shaft for the number of cycles wanted."""
        if self.cycles is None or self.cycles >= self.knee:
            return float(self.fatigue_strength)
        # S-N line N tau^slope = const up to the knee: tau = tau_W (N_knee/N)^(1/slope).
        return float(self.fatigue_strength * (self.knee / self.cycles) ** (1 / not_none(self.slope)))

    def rule_text(self, evidence: Evidence) -> RuleText:
        del evidence
        terms = {
            "goodman": f"tau_W (1 - tau_m/tau_B)/S, tau_B = {(self.ultimate_strength or math.nan) / 1e6:g} N/mm^2",
            "haigh": f"(tau_W - M tau_m)/S, M = {self.mean_sensitivity}",
            "none": "tau_W/S, mean stress left out",
        }
        numbers = (
            f"K = {self.stress_concentration:g}, tau_W = {self.strength / 1e6:.5g} N/mm^2, S = {self.safety:g}, "
            f"{'unlimited' if self.cycles is None else f'{self.cycles:g}'} cycles"
        )
        formula = f"K tau_a <= {terms[self.mean_stress]}; {numbers}"
        if self.yield_strength is not None:
            formula += f"; tau_m + tau_a <= tau_F/S_F, tau_F = {self.yield_strength / 1e6:g} N/mm^2"
        missing = (
            "bending and axial stress, size, surface and corrosion unless in the strengths, damage of load spectra"
        )
        return RuleText(self.source, formula, missing)

    def lines(self, evidence: Evidence) -> Iterator[LimitLine]:
        amplitude, orders = self.stress(evidence)
        mean = self.mean_stress_in(evidence)
        if mean is None:
            yield line_without_data("tau_W", f"the mean stress is not known: {evidence.why_no_mean}")
            return
        # What mean stress takes of the strength: tau_W tau_m/tau_B (Goodman) or M tau_m (Haigh).
        lost = {
            "goodman": lambda: self.strength * mean / self.ultimate_strength,
            "haigh": lambda: self.mean_sensitivity * mean,
            "none": lambda: 0.0 * mean,
        }
        strength = np.maximum(self.strength - lost[self.mean_stress](), 0)
        # K tau_a S <= strength, as a nominal half range; a mean stress beyond tau_B leaves nothing.
        allowed = strength / (self.safety * self.stress_concentration)
        quantity = "nominal shear stress, half range"
        yield LimitLine("tau_W", quantity, "Pa", amplitude, allowed, (), orders)
        if self.yield_strength is not None:
            limit = np.full(len(mean), self.yield_strength / self.yield_safety)
            total = "nominal shear stress, mean and half range"
            yield LimitLine("tau_F", total, "Pa", mean + amplitude, limit, in_passing=True)

    def remarks(self, line: LimitLine, evidence: Evidence) -> tuple[str, ...]:
        said = super().remarks(line, evidence)
        if line.criterion != "tau_W":
            return said
        return (*said, f"safety against fatigue {self.safety * float(np.nanmin(line.allowed / line.values)):.3g}")

    def mean_stress_in(self, evidence: Evidence) -> Any:
        """Mean shear stress of the shaft in Pa, shape (n_speeds,).

        Zero where it is left out, None where it is needed and not known.
        """
        mean = self.mean_stress_of(evidence)
        if mean is None and self.mean_stress == "none" and self.yield_strength is None:
            return np.zeros(len(evidence.speeds))
        return mean
