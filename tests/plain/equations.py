"""All node angles and all torques of rigid conditions as unknowns, solved in balls of several hundred bits."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

from flint import acb, acb_mat, arb

from plain.component import Row, Value, twist
from plain.trains import Plant

DEGREE = {"angle": 0, "velocity": 1, "acceleration": 2}


class Dense:
    """A plant with values of its parameters."""

    def __init__(self, plant: Plant, changed: Mapping[str, float | arb] | None = None) -> None:
        values = {**plant.parameters, **(changed or {})}
        self.plant = plant
        self.value: Value = lambda one: acb(values[one] if isinstance(one, str) else one)
        self.equations = {name: one.equations(self.value) for name, one in plant.components.items()}

    @cached_property
    def nodes(self) -> dict[str, int]:
        rows = [
            row
            for one in self.equations.values()
            for row in (*one.held, *(r for law in one.laws for r in (law.driven, law.sensed or {})))
        ]
        found = dict.fromkeys(node for row in rows for node in row if node != "ground")
        return {node: place for place, node in enumerate(found)}

    @cached_property
    def held(self) -> list[tuple[str, Row]]:
        own = [(name, row) for name, one in self.equations.items() for row in one.held]
        return own + [(name, _row(of)) for name, (quantity, of) in self.plant.inputs.items() if quantity == "angle"]

    def matrix(self, s: acb) -> acb_mat:
        n = len(self.nodes)
        found = acb_mat(n + len(self.held), n + len(self.held))
        for one in self.equations.values():
            for law in one.laws:
                kappa = law.kappa(s)
                for i, x in law.driven.items():
                    for j, y in (law.sensed or law.driven).items():
                        if "ground" not in (i, j):
                            found[self.nodes[i], self.nodes[j]] += kappa * x * y
        for place, (_, row) in enumerate(self.held, n):
            for node, x in row.items():
                if node != "ground":
                    found[place, self.nodes[node]] = found[self.nodes[node], place] = acb(x)
        return found

    def readings(self, s: acb) -> list[dict[int, acb]]:
        return [self._reading(quantity, of, s) for quantity, of in self.plant.outputs.values()]

    def _reading(self, quantity: str, of: tuple[str, ...], s: acb) -> dict[int, acb]:
        if quantity != "torque":
            return {self.nodes[node]: acb(x) * s ** DEGREE[quantity] for node, x in _row(of).items()}
        component, found = self.plant.components[of[0]], {}
        port, sign, n = component.port, component.sign, len(self.nodes)
        for law in self.equations[of[0]].laws:
            if port in law.driven:
                for node, y in (law.sensed or law.driven).items():
                    if node != "ground":
                        at = self.nodes[node]
                        found[at] = found.get(at, 0) + sign * law.driven[port] * law.kappa(s) * y
        for place, (name, row) in enumerate(self.held, n):
            if name == of[0] and port in row:
                found[place] = acb(sign * row[port])
        return found

    def response(self, s: acb) -> list[list[acb]]:
        """Outputs (rows) by inputs (columns)."""
        n, inputs = len(self.nodes), self.plant.inputs
        right = acb_mat(n + len(self.held), len(inputs))
        for column, (name, (quantity, of)) in enumerate(inputs.items()):
            if quantity == "angle":
                right[n + [name for name, _ in self.held].index(name), column] = 1
            else:
                for node, x in _row(of).items():
                    right[self.nodes[node], column] = x
        found = self.matrix(s).solve(right)
        return [
            [sum((x * found[place, column] for place, x in row.items()), acb(0)) for column in range(len(inputs))]
            for row in self.readings(s)
        ]

    def determinant(self, s: acb) -> acb:
        return self.matrix(s).det()


def _row(of: tuple[str, ...]) -> Row:
    return {of[0]: 1} if len(of) == 1 else twist(*of)
