"""Chain drive, or a toothed belt, over two sprockets or more."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression, Number
from torsionnet.model.element_base.element import register
from torsionnet.model.element_base.laws import Values
from torsionnet.model.element_base.loop_drive import LoopDrive
from torsionnet.model.element_base.quantity_table import TableByNode


@register
@dataclass(frozen=True, eq=False, repr=False)
class ChainDrive(LoopDrive):
    """A chain, or a toothed belt, over two sprockets or more: ratios by counts of teeth, spans rigid or elastic.

    As for ``belt``, with radii r_i = z_i p / (2 pi) from the counts of teeth z_i and the pitch p; the ratios z_i / z_1
    are exact. The count is negative where the outside of the chain drives the sprocket. The polygon effect is left out.
    A chain has a tight span and one that sags: give the slack span its own, small stiffness.

    Examples
    --------
    >>> chain = ChainDrive("chain", sprockets={"crank": 21, "cam": 42})
    >>> chain.parts(Values({}))[0].row
    {'crank': 1, 'cam': Fraction(-2, 1)}
    """

    kind: ClassVar[str] = "chain_drive"
    wheels_field: ClassVar[str] = "sprockets"

    sprockets: tuple[tuple[str, Expression], ...] = entry(
        TableByNode(
            "teeth by node in the order of the run, negative where the outside of the chain drives",
            PhysicalQuantity("count of teeth", "1", "z", None, nonzero=True),
            "teeth by node, as {crank: 21, cam: 42}",
            names=("a", "b"),
        )
    )
    pitch: Expression | None = entry(
        PhysicalQuantity("pitch of the chain, for elastic spans", "length", "p", exclusive=True), None
    )

    def contradictions(self) -> list[Fault]:
        broken = [node for node, z in self.sprockets if isinstance(z, Number) and z.value != int(z.value)]
        faults = [Fault("a count of teeth is a whole number", ("sprockets", node)) for node in broken]
        if self.pitch is None and (self.stiffness or self.lengths):
            faults.append(
                Fault(
                    "the stiffness of spans in N/m needs the pitch of the chain; give pitch, as 9.525 mm", on_key=True
                )
            )
        return [*faults, *super().contradictions()]

    def radius_ratios(self, value: Values) -> dict[str, Any]:
        first = value(self.sprockets[0][1])
        return {node: value(z) / first for node, z in self.sprockets}

    def first_radius(self, value: Values) -> Any:
        return value(self.sprockets[0][1]) * value(self.pitch) / (2 * value.algebra.pi)
