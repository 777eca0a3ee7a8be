"""Torque of arc springs over time, which remembers where the twist turned back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from torsionnet.model.arc_spring.linear_law import arc_values
from torsionnet.model.arc_spring.loop_at_torque import loop_at_torque
from torsionnet.model.arc_spring.segment_chain import segments_needed
from torsionnet.model.arc_spring.slow_loop import ArcSprings
from torsionnet.model.element_base.element import OtherLaws
from torsionnet.model.element_base.laws import Law, MotionLaw, MotionState, Part, TorqueCurve, Values, WholePart
from torsionnet.model.motion_laws.piece_curve import friction_curve

FEWEST_SEGMENTS, MOST_SEGMENTS = 10, 80
"""Fewest and most segments of the chain that moves over time."""
STEP = 1e-6
"""Share of a twist over which the slope of the first loading is taken."""


@dataclass(frozen=True)
class ArcCurve(TorqueCurve):
    """Torque of arc springs that are loaded from nothing; over time a chain of ``segments`` stands in its place.

    >>> curve = ArcCurve(ArcSprings(700.0, 2.6, 0.12, 0.9, 0.11, 314.159265), 20)
    >>> round(curve.torque(0.34906585, 0), 3)
    352.279
    """

    over = "twist"

    springs: ArcSprings
    segments: int

    def torque(self, twist: Any, rate: Any, *sensed: Any) -> Any:
        del rate, sensed
        return self.springs.first_torque(float(twist))

    def energy(self, twist: Any) -> Any:
        """Energy in J that the curve knows of, none: what a chain has stored follows from its places."""
        return 0.0 * twist

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        step = STEP * max(abs(state.twist), STEP)
        rise = self.torque(state.twist + step, 0) - self.torque(state.twist - step, 0)
        return rise / (2 * step), 0

    def corners(self) -> tuple[Any, ...]:
        return (0,)

    def scaled(self, ratio: Any) -> ArcCurve:
        r, own = abs(float(ratio)), self.springs
        # r T(r gamma): k grows with r^2 and C/psi with r, mu psi stays.
        return replace(self, springs=replace(own, stiffness=own.stiffness * r**2, spring_mass=own.spring_mass * r))


@dataclass(frozen=True)
class LawsOverTime(OtherLaws):
    """Laws of an element with arc springs in motion over time: their chain, basic friction, and what is linear."""

    def parts(self, value: Values) -> tuple[Part, ...]:
        return self.element.parts(value)

    def whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        law, *others = self.element.parts(value)
        if not isinstance(law, Law):
            raise TypeError("springs on an arc come first")
        *springs, swing, torque = (float(value(entry)) for entry in arc_values(self.element))
        row, laws = law.row, list[WholePart]([MotionLaw(law.row, arc_curve(ArcSprings(*springs), swing, torque))])
        friction = value(self.element.friction) if hasattr(self.element, "friction") else 0
        if friction:
            laws.append(MotionLaw(row, friction_curve(friction, friction)))
        if law.damping:
            laws.append(Law(row, damping=law.damping))
        return (*laws, *others)

    def tangent_parts(self, value: Values, states: Sequence[MotionState] = ()) -> tuple[Part, ...]:
        del states
        return self.element.parts(value)


def arc_curve(springs: ArcSprings, swing: float, torque: float) -> ArcCurve:
    """Curve with as many segments as give the loss of a swing in rad about a mean torque in N m to 1 %.

    >>> arc_curve(ArcSprings(700.0, 2.6, 0.12, 0.9, 0.11, 314.159265), 0.034906585, 276.2278).segments
    19
    """
    depth = loop_at_torque(springs, swing, torque).depth
    needed = segments_needed(depth) if depth > 0 else MOST_SEGMENTS
    return ArcCurve(springs, min(MOST_SEGMENTS, max(FEWEST_SEGMENTS, needed)))
