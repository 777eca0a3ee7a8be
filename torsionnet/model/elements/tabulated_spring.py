"""Coupling by its measured dynamic stiffness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.spec import entry
from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.element_entries import NodePair
from torsionnet.model.element_base.laws import Law, Part, Values, difference
from torsionnet.model.element_base.stiffness_rows import TableEntry
from torsionnet.model.element_base.stiffness_table import StiffnessTable
from torsionnet.model.elements.springs import NODE_PAIR_DESCRIPTION


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

    nodes: tuple[str, str] = entry(NodePair(NODE_PAIR_DESCRIPTION))
    table: StiffnessTable = entry(TableEntry("rows [frequency in Hz, stiffness in N*m/rad, damping in N*m*s/rad]"))

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        del value
        return (Law(difference(*self.nodes), table=self.table),)
