"""Base of limits of shaft stress in a section of the shaft itself or of the limit's entries."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import EntryPath, Fault, ModelName, Worded
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.limits.evidence import Evidence, torques_of
from torsionnet.machinery.limits.limit import Limit
from torsionnet.machinery.limits.subject import LimitSubject
from torsionnet.model.channels import Sensor
from torsionnet.model.element_base.element_entries import ElementName
from torsionnet.model.elements import Element, Values

VIBRATORY_STRESSES = ("tau_C", "tau_W")
"""Criteria of limits of shafts that judge the half range of the shear stress alone."""


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
class ShaftLimit(Limit):
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
            return [Fault("the bore must be smaller than the diameter", ("bore",))]
        return []

    def unfit(self, subject: LimitSubject) -> Iterator[Fault]:
        element, name = subject.elements[self.element], ModelName(self.element)
        if element.diameters is None and self.diameter is None:
            said = "{}, a {}, has no diameter, and so no stress; give the limit one, diameter: 300 mm, or make the "
            yield Fault(Worded(f"{said}element a shaft", name, element.kind), ("element",))
        elif len(element.ports) != 2:
            yield Fault(Worded("{}, a {}, is no shaft between two nodes", name, element.kind), ("element",))
        else:
            section = self.section(subject)
            if section.inner >= section.outer:
                key = "diameter" if self.diameter is not None else "bore"
                said = "the bore of {}, {:g} mm, is no smaller than its diameter, {:g} mm"
                yield Fault(Worded(said, name, 1000 * section.inner, 1000 * section.outer), (key,))

    def order_sensors(self, subject: LimitSubject) -> list[Sensor]:
        return torques_of(subject.elements[self.element])

    def mean_sensors(self, subject: LimitSubject) -> list[Sensor]:
        del subject
        return [Sensor("torque", self.element)]

    def vibratory_sensors(self, criterion: str, subject: LimitSubject) -> tuple[list[Sensor], float] | None:
        if criterion not in VIBRATORY_STRESSES:
            return None
        return self.order_sensors(subject), 1 / self.section(subject).modulus

    def section(self, subject: LimitSubject) -> RoundSection:
        """Round section of the shaft in which the limit judges the stress."""
        own = _own(subject.elements[self.element], Values(subject.values))
        outer = self.diameter if self.diameter is not None else own.outer if own else math.nan
        inner = self.bore if self.bore is not None else own.inner if own else 0.0
        return RoundSection(float(outer), float(inner))

    def stress(self, evidence: Evidence) -> tuple[FloatArray, FloatArray]:
        """Half range (n_speeds,) and amplitudes by order (n_speeds, n_lines) of the nominal shear stress in Pa."""
        torques, modulus = torques_of(evidence.subject.active[self.element]), self.section(evidence.subject).modulus
        return evidence.size(torques) / modulus, evidence.orders(torques) / modulus

    def stress_by_case(self, evidence: Evidence) -> FloatArray | None:
        """Half range in Pa of the nominal shear stress in each case of excitation, shape (n_speeds, n_cases).

        None where there are no cases.
        """
        found = evidence.size_by_case(torques_of(evidence.subject.active[self.element]))
        return None if found is None else found / self.section(evidence.subject).modulus

    def mean_stress_of(self, evidence: Evidence) -> FloatArray | None:
        """Magnitude of the mean shear stress in Pa, shape (n_speeds,), None where it is not known."""
        mean = evidence.mean(Sensor("torque", self.element))
        return None if mean is None else abs(mean) / self.section(evidence.subject).modulus


def _own(element: Element, value: Values) -> RoundSection | None:
    if element.diameters is None:
        return None
    return RoundSection(*(float(value(diameter)) for diameter in element.diameters))
