"""Phase-vector (star) diagrams: how the torques of cylinders add up on the shape of a mode."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.response.frequency_response import ComplexArray
from torsionnet.response.table import Column, Table


@dataclass(frozen=True, eq=False)
class StarDiagram:
    """Vectors ``a_i exp(-j h alpha_i)`` of one order: relative amplitude ``a_i`` of the mode, firing angle ``alpha_i``.

    Attributes
    ----------
    excitation : str
    order : float
    labels, nodes : tuple of str
        What acts (the numbers of cylinders) and where.
    vectors : (n,) complex array
        The largest amplitude of the mode at these nodes is 1; what is out of action has 0.
    title : str
    """

    excitation: str
    order: float
    labels: tuple[str, ...]
    nodes: tuple[str, ...]
    vectors: ComplexArray
    title: str = ""

    @property
    def sum(self) -> complex:
        """The vector sum: as many cylinders as act together at the largest amplitude."""
        return complex(self.vectors.sum())

    def table(self) -> Table:
        """One row per cylinder, and the sum."""
        columns = (Column("cylinder"), Column("node"), Column("length", "1"), Column("phase", "deg"))
        rows = [
            (label, node, float(abs(vector)), float(np.degrees(np.angle(vector))) if vector else None)
            for label, node, vector in zip(self.labels, self.nodes, self.vectors, strict=True)
        ]
        total = self.sum
        rows.append(("sum", "", abs(total), float(np.degrees(np.angle(total))) if total else None))
        title = f"{self.title}: {self.excitation} order {self.order:g}"
        return Table(title, columns, tuple(rows), ("the largest amplitude at these nodes is 1",))
