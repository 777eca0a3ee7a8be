"""Rigid connections: rigid coupling (also a torque meter) and clamp to ground."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.core.entries.spec import entry
from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.laws import Constraint, Part, Row, Values, difference, make_row
from torsionnet.model.element_base.nodes import NodeName, NodePair


@register
@dataclass(frozen=True, eq=False, repr=False)
class RigidCoupling(Element):
    """Two nodes that turn as one; the torque it carries is what a stiff torque meter reads.

    Examples
    --------
    >>> RigidCoupling("torque_meter", nodes=("motor", "primary")).nodes
    ('motor', 'primary')
    """

    kind: ClassVar[str] = "rigid_coupling"
    glyph: ClassVar[str] = "coupling"

    nodes: tuple[str, str] = entry(NodePair("the two nodes it joins; torque is positive from the first to the second"))

    def parts(self, value: Values) -> tuple[Part, ...]:
        del value
        return (Constraint(difference(*self.nodes)),)


@register
@dataclass(frozen=True, eq=False, repr=False)
class Lock(Element):
    """A node clamped to ground; its torque is the reaction the ground has to take.

    Examples
    --------
    >>> Lock("brake", node="hub").ports
    {'node': 'hub'}
    """

    kind: ClassVar[str] = "lock"
    glyph: ClassVar[str] = "clamp"
    sign: ClassVar[str] = "positive when the drivetrain turns the clamp in the positive sense"

    node: str = entry(NodeName("the clamped node", allow_ground=False))

    def parts(self, value: Values) -> tuple[Part, ...]:
        del value
        return (Constraint(make_row([(self.node, 1)])),)

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """No rows of mean speeds, because a clamp transmits no rotation; a rig locked for a test keeps its ratios."""
        del value
        return ()
