"""Modelica components of any element, made from its laws and constraints."""

from __future__ import annotations

from functools import reduce
from typing import TypeAlias

from torsionnet.io.expression_numbers import ExpressionNumber, expression_number
from torsionnet.io.modelica_net import Net
from torsionnet.io.modelica_syntax import ROTATIONAL, ModelicaExpressions, quoted
from torsionnet.model.elements import GROUND, Action, Constraint, Element, Law, Part, Row

COMPONENTS = f"{ROTATIONAL}.Components"
FIXED = f"node:{GROUND}"

Lever: TypeAlias = tuple[str, ExpressionNumber]
"""Connection point of a Modelica model, and the factor from its angle to the weighted sum of angles of a row."""


def port(element: Element, name: str) -> str:
    """Name of the connection point at a port of an element, joined to its node or to a torque sensor between them."""
    return f"port:{element.name}.{name}"


def declared(element: Element, net: Net, kind: str, values: str = "", suffix: str = "") -> str:
    """Declare a component of an element and return its name, with the element's description if it has no suffix."""
    comment = quoted(element.description) if element.description and not suffix else ""
    return net.declare(f"{COMPONENTS}.{kind}", element.name + suffix, values, comment)


def write_parts(element: Element, net: Net, words: ModelicaExpressions) -> None:
    """Declare springs, dampers and inertias on the row of each law, and ideal gears or connections for constraints.

    A row of one node, or the difference of two, is acted on as it is. Any other row becomes the angle of a flange: an
    ideal planetary set has the weighted mean of two angles on its carrier.
    """
    writer = _PartWriter(element, net, words)
    for part in element.parts(words.symbolic):
        writer.write(part)


def has_counterpart(part: Part) -> bool:
    """Whether Modelica components can do what a law, constraint or action does: nothing that depends on frequency."""
    if isinstance(part, Action):
        return False
    return isinstance(part, Constraint) or (part.loss_factor == 0 and part.table is None)


class _PartWriter:
    def __init__(self, element: Element, net: Net, words: ModelicaExpressions) -> None:
        self.element, self.net, self.words = element, net, words
        self.points = {node: f"node:{node}" for node in element.internal_nodes}
        for name, node in reversed(element.ports.items()):
            self.points[node] = port(element, name)
        self.is_first = True

    def write(self, part: Part) -> None:
        if isinstance(part, Constraint):
            self._constraint(part.row)
        elif isinstance(part, Law) and part.acts:
            if part.is_elastic or part.damping != 0:
                self._spring(part)
            if part.inertia != 0:
                point, factor = self._mean(part.row)
                name = self._declared("Inertia", f"J={self._text(part.inertia * factor**2)}", "_inertia")
                self.net.points.join(point, f"{name}.flange_a")

    def _declared(self, kind: str, values: str, suffix: str) -> str:
        name = declared(self.element, self.net, kind, values, "" if self.is_first else suffix)
        self.is_first = False
        return name

    def _text(self, number: ExpressionNumber) -> str:
        return self.words.expression(expression_number(number).expression)

    def _spring(self, law: Law) -> None:
        first, second, factor = self._ends(law.row)
        laws = {"c": law.stiffness * factor**2, "d": law.damping * factor**2}
        values = ", ".join(f"{letter}={self._text(number)}" for letter, number in laws.items() if number != 0)
        kind = "Damper" if law.stiffness == 0 else "Spring" if law.damping == 0 else "SpringDamper"
        name = self._declared(kind, values, f"_{kind.lower()}")
        self.net.points.join(first, f"{name}.flange_a")
        self.net.points.join(second, f"{name}.flange_b")

    def _ends(self, row: Row) -> tuple[str, str, ExpressionNumber]:
        """Two connection points and a factor, so that their difference of angles times it is the row's sum."""
        nodes = list(row)
        if len(nodes) == 2 and row[nodes[0]] + row[nodes[1]] == 0:
            return self.points[nodes[0]], self.points[nodes[1]], expression_number(row[nodes[0]])
        point, factor = self._mean(row)
        return point, self.points.get(GROUND, FIXED), factor

    def _mean(self, row: Row) -> Lever:
        """Connection point and a factor, such that its angle times it is the weighted sum of a row."""
        levers = [(self.points[node], expression_number(share)) for node, share in row.items()]
        return reduce(self._mean_of_two, levers)

    def _mean_of_two(self, one: Lever, other: Lever) -> Lever:
        (point, factor), (end, share) = one, other
        if factor + share == 0:  # there is no mean of weights that cancel: the other angle turned round
            reverse = self._declared("IdealGear", "ratio=-1", "_reverse")
            self.net.points.join(end, f"{reverse}.flange_a")
            end, share = f"{reverse}.flange_b", -share
        mean = self._declared("IdealPlanetary", f"ratio={self._text(share / factor)}", "_mean")
        self.net.points.join(point, f"{mean}.sun")
        self.net.points.join(end, f"{mean}.ring")
        return f"{mean}.carrier", factor + share

    def _constraint(self, row: Row) -> None:
        *some, last = row
        if not some:
            self._hold(self.points[last])
            return
        point, factor = self._mean({node: row[node] for node in some})
        share = expression_number(row[last])
        if factor + share == 0:
            self.net.points.join(point, self.points[last])
            return
        gear = self._declared("IdealGear", f"ratio={self._text(-share / factor)}", "_gear")
        self.net.points.join(point, f"{gear}.flange_a")
        self.net.points.join(self.points[last], f"{gear}.flange_b")

    def _hold(self, point: str) -> None:
        if GROUND in self.points:
            self.net.points.join(point, self.points[GROUND])
        else:
            self.net.points.join(point, f"{self._declared('Fixed', '', '_fixed')}.flange")
