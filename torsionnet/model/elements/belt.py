"""Belt drive over two pulleys or more."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.expressions import Expression
from torsionnet.model.element_base.element import register
from torsionnet.model.element_base.laws import Values
from torsionnet.model.element_base.loop_drive import LoopDrive
from torsionnet.model.element_base.quantity_table import TableByNode


@register
@dataclass(frozen=True, eq=False, repr=False)
class Belt(LoopDrive):
    """A belt over two pulleys or more, rigid or with elastic spans, and with a tensioner arm if wanted.

    The belt runs over the pulleys in the order given and back to the first. A span from pulley i to j of stiffness
    k = E A / L, in N/m, gets shorter by r_i theta_i - r_j theta_j: row (r_i theta_i - r_j theta_j) / r_1 with the
    stiffness k r_1^2, so that its torque is that on the first pulley. Two pulleys have two spans in parallel, as a gear
    of ratio r_2 / r_1 whose teeth have (k_1 + k_2) r_1^2. A rigid belt is a rigid gear. A radius is negative where the
    back of the belt runs over the pulley, which then turns in the other sense. An arm that turns by phi makes the spans
    before and after its pulley longer by a phi, each with its own lever a = l cos(beta): l is the length of the arm,
    beta the angle between span and way of the pulley's centre. Inertia and spring of the arm are elements of their own
    on its node. Slip and creep are left out (R. S. Beikmann, N. C. Perkins, A. G. Ulsoy, Free vibration of serpentine
    belt drive systems, J. Vib. Acoust. 118, 1996, with the rotations of the pulleys alone).

    Examples
    --------
    >>> belt = Belt("belt", pulleys={"crank": "70 mm", "pump": "35 mm"}, stiffness=["300 kN/m", "200 kN/m"])
    >>> [float(law.stiffness) for law in belt.parts(Values({}))]
    [1470.0, 980.0]
    """

    kind: ClassVar[str] = "belt"
    wheels_field: ClassVar[str] = "pulleys"

    pulleys: tuple[tuple[str, Expression], ...] = entry(
        TableByNode(
            "radius by node in the order of the run, negative where the back of the belt drives",
            PhysicalQuantity("radius to the middle of the belt", "length", "r", None, nonzero=True, usual=(1e-4, 5)),
            "radii by node, as {crank: 80 mm, pump: 60 mm}",
            names=("a", "b"),
        )
    )

    def radius_ratios(self, value: Values) -> dict[str, Any]:
        first = self.first_radius(value)
        return {node: value(radius) / first for node, radius in self.pulleys}

    def first_radius(self, value: Values) -> Any:
        return value(self.pulleys[0][1])
