"""A coupling of which only measurements are known."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.core.entries.spec import entry
from torsionnet.model.elements.element import Element, register
from torsionnet.model.elements.laws import Law, Part, Values, difference
from torsionnet.model.elements.nodes import NodePair
from torsionnet.model.elements.springs import PAIR
from torsionnet.model.elements.stiffness_rows import TableEntry


@register
@dataclass(frozen=True, eq=False, repr=False)
class TabulatedSpring(Element):
    """A coupling known by its measured dynamic stiffness k(f) + j omega c(f), interpolated linearly between the rows.

    Examples
    --------
    >>> bush = TabulatedSpring("bush", nodes=("a", "b"), table=[[1, 400, 2], ["20 Hz", "0.5 kN*m/rad", 1.2]])
    >>> bush.table.stiffness
    (400.0, 500.0)
    """

    kind: ClassVar[str] = "tabulated_spring"
    glyph: ClassVar[str] = "spring"

    nodes: Any = entry(NodePair(PAIR))
    table: Any = entry(TableEntry("rows [frequency in Hz, stiffness in N*m/rad, damping in N*m*s/rad]"))

    def parts(self, value: Values) -> tuple[Part, ...]:
        del value
        return (Law(difference(*self.nodes), table=self.table),)
