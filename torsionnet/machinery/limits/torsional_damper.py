"""Limits of torsional vibration dampers, viscous or with springs, on heat and twist."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import one_at_most
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import entry, not_none
from torsionnet.base.errors import Fault
from torsionnet.machinery.limits.element_limit import ElementLimit, constant_over_speed
from torsionnet.machinery.limits.evidence import Evidence
from torsionnet.machinery.limits.limit import LimitLine, register_rule
from torsionnet.machinery.limits.subject import LimitSubject
from torsionnet.machinery.verdicts.limit_check import RuleText
from torsionnet.model.channels import Sensor


@register_rule
@dataclass(frozen=True, kw_only=True)
class DamperLimit(ElementLimit):
    """A damper at the free end of a crankshaft: power it may turn into heat, also per area, and twist.

    Examples
    --------
    >>> DamperLimit(element="damper", power_per_area="5 kW/m^2", area="1.4 m^2").allowed_power
    7000.0
    """

    kind: ClassVar[str] = "damper"
    criteria: ClassVar[tuple[str, ...]] = ("power", "power_per_area", "vibratory_twist")
    alternatives: ClassVar[tuple[tuple[str, ...], ...]] = (("power",), ("power_per_area", "area"))

    power: float | None = entry(Value("power it may turn into heat", "power", exclusive=True), None)
    power_per_area: float | None = entry(Value("instead: per cooling area", "heat flux", exclusive=True), None)
    area: float | None = entry(Value("cooling area", "area", exclusive=True), None)
    vibratory_twist: float | None = entry(Value("twist of ring against hub, peak value", "angle", exclusive=True), None)

    def contradictions(self) -> list[Fault]:
        faults = super().contradictions() + one_at_most(self, "power", "power_per_area")
        if (self.power_per_area is None) != (self.area is None):
            faults.append(Fault("power_per_area and area go together", on_key=True))
        return faults

    @property
    def allowed_power(self) -> float | None:
        """Power in W that the damper may turn into heat, None where it is not limited."""
        per_area = None if self.power_per_area is None else float(self.power_per_area * not_none(self.area))
        return float(self.power) if self.power is not None else per_area

    def order_sensors(self, subject: LimitSubject) -> list[Sensor]:
        del subject
        return [self.twisting]

    def power_elements(self) -> list[str]:
        return [self.element] if self.allowed_power is not None else []

    def text(self, evidence: Evidence) -> RuleText:
        del evidence
        parts = ["P = sum over frequencies of Re(T conj(dgamma/dt))/2 with T the whole torque, elastic and damping"]
        if self.power_per_area is not None:
            parts.append(f"P <= {self.power_per_area / 1000:g} kW/m^2 x {self.area:g} m^2")
        elif self.power is not None:
            parts.append(f"P <= {self.power / 1000:g} kW")
        if self.vibratory_twist is not None:
            parts.append("half range of twist <= vibratory_twist")
        return RuleText(self.source, "; ".join(parts), "ageing of the fluid, temperature of the film, wear of springs")

    def lines(self, evidence: Evidence) -> Iterator[LimitLine]:
        if self.allowed_power is not None:
            allowed = constant_over_speed(self.allowed_power, evidence)
            yield LimitLine("P", "dissipated power", "W", evidence.power(self.element), allowed)
        if self.vibratory_twist is not None:
            allowed, twist = constant_over_speed(self.vibratory_twist, evidence), [self.twisting]
            orders = evidence.orders(twist)
            yield LimitLine("vibratory twist", "twist, half range", "rad", evidence.size(twist), allowed, (), orders)
