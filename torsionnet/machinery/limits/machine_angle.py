"""Limits of generators on the swing of the rotor in electrical degrees, at which lamps begin to flicker."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, Text, entry
from torsionnet.base.errors import EntryPath
from torsionnet.base.phrases import phrase
from torsionnet.machinery.limits.element_limit import constant_over_speed
from torsionnet.machinery.limits.evidence import Evidence, LimitSubject
from torsionnet.machinery.limits.limit import LimitLine, register_rule
from torsionnet.machinery.limits.speed_band import InSpeedBand
from torsionnet.machinery.verdicts.limit_verdict import RuleText
from torsionnet.model.channels import Sensor
from torsionnet.model.element_base.element_entries import NodeName


@register_rule
@dataclass(frozen=True, kw_only=True)
class MachineAngleLimit(InSpeedBand):
    """Vibratory angle of the rotor of an electric machine in electrical degrees: pole pairs times the mechanical angle.

    Examples
    --------
    >>> round(MachineAngleLimit(node="rotor", pole_pairs=4, angle="3.5 deg").angle, 6)
    0.061087
    """

    kind: ClassVar[str] = "machine_angle"
    holds_in_band_alone: ClassVar[bool] = True

    node: str = entry(NodeName("the node of its rotor", allow_ground=False))
    pole_pairs: int = entry(Count("pairs of poles", 1, 200))
    angle: float = entry(Value("angle allowed, peak value, electrical", "angle", exclusive=True))
    source: str = entry(Text("who states the value, and where"), "value given by the user")

    @property
    def of(self) -> str:
        return str(self.node)

    @property
    def named(self) -> tuple[tuple[EntryPath, str, str], ...]:
        return ((("node",), "node", self.node),)

    def order_sensors(self, subject: LimitSubject) -> list[Sensor]:
        del subject
        return [Sensor("angle", self.node)]

    def rule_text(self, evidence: Evidence) -> RuleText:
        del evidence
        formula = phrase(
            "{count} pole pairs x half range of the angle <= angle allowed, electrical", count=self.pole_pairs
        )
        return RuleText(self.source, formula, "swinging of machines that run in parallel against each other")

    def lines(self, evidence: Evidence) -> Iterator[LimitLine]:
        angle = self.order_sensors(evidence.subject)
        # Electrical angle = pole pairs times mechanical angle.
        values, orders = self.pole_pairs * evidence.size(angle), evidence.orders(angle).times(self.pole_pairs)
        allowed = constant_over_speed(self.angle, evidence)
        yield LimitLine("electrical angle", "electrical angle, half range", "rad", values, allowed, (), orders)
