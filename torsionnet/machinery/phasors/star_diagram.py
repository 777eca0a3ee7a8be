"""Phase-vector (star) diagrams, which show how the torques of cylinders add up on a mode shape."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.table import Column, Table
from torsionnet.linear.frequency_response import ComplexArray


@dataclass(frozen=True, eq=False)
class StarDiagram:
    """Star diagram of one order h, complex vectors ``a_i exp(-j h alpha_i)`` of relative amplitude and firing angle.

    Attributes
    ----------
    excitation : str
    order : float
    labels, nodes : tuple of str
        Numbers of the cylinders (or names of other torques) and their nodes.
    vectors : (n,) complex array
        Vectors, where the largest amplitude of the mode at these nodes is 1; 0 for cylinders that do not act.
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
        """Complex vector sum of a star diagram, as a number of cylinders that act together at the largest amplitude."""
        return complex(self.vectors.sum())

    def table(self) -> Table:
        """Table of a star diagram with a row per cylinder, length and phase in deg of its vector, and the sum."""
        columns = (Column("cylinder"), Column("node"), Column("length", "1"), Column("phase", "deg"))
        rows = [
            (label, node, float(abs(vector)), float(np.degrees(np.angle(vector))) if vector else None)
            for label, node, vector in zip(self.labels, self.nodes, self.vectors, strict=True)
        ]
        total = self.sum
        rows.append(("sum", "", abs(total), float(np.degrees(np.angle(total))) if total else None))
        title = f"{self.title}: {self.excitation} order {self.order:g}"
        return Table(title, columns, tuple(rows), ("the largest amplitude at these nodes is 1",))
