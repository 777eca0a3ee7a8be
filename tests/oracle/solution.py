"""Motions and torques of a model under unit excitations, from one equation per node and per rigid condition.

The unknowns are the angles of all nodes and the multipliers lambda of the rigid conditions A theta = x:

    D(s) theta + A^T lambda = f,    A theta = x

Conditions that follow from others are left out, decided on exact fractions. A torque that takes a multiplier which those
others could share is indeterminate.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import networkx as nx
from flint import acb, arb

from oracle.description import GROUND, Model, Reading
from oracle.elimination import Entries, Order, make_order, solve
from oracle.exact import Row, Span, ball, imaginary, null_space, precision, rank
from oracle.physics import Condition, Law, conditions_of, laws_of, twist_row

GENERIC_S = ("0.7234198", "1.3987123")
RATES = {"angle": 0, "velocity": 1, "acceleration": 2}
PREFIX = "lambda of "
BITS = 512


class Mechanics:
    """Laws and rigid conditions of a model, and what follows from their exact rows."""

    def __init__(self, model: Model) -> None:
        self.model, self.nodes = model, model.nodes
        self.laws: list[Law] = [law for part in model.parts for law in laws_of(part)]
        self.conditions: list[Condition] = [c for part in model.parts for c in conditions_of(part)]
        self.conditions += [Condition(name, {node: 1}, f"imposed {name}") for name, node in model.imposed.items()]
        span = Span()
        self.kept = [c for c in self.conditions if span.add(without_ground(c.row), c.label)]
        self.shared = {label for relation in span.relations for label in relation}
        self.parts = {part.name: part for part in model.parts}

    @cached_property
    def motion(self) -> dict[str, dict[str, acb]]:
        """Every node as a combination of the free ones."""
        return null_space([without_ground(c.row) for c in self.conditions], self.nodes)

    @cached_property
    def freedom(self) -> int:
        return len(self.nodes) - len(self.kept)

    @cached_property
    def eliminated(self) -> set[str]:
        """Nodes whose motion is given by others."""
        return {node for node, motion in self.motion.items() if motion != {node: 1}}

    @cached_property
    def in_loops(self) -> set[str]:
        """Parts that close a loop which does not run through ground."""
        graph = nx.Graph()
        for part in self.model.parts:
            graph.add_edges_from((part.name, (node,)) for node in part.ports.values() if node != GROUND)
        blocks = (block for block in nx.biconnected_components(graph) if len(block) > 2)
        return {name for block in blocks for name in block if isinstance(name, str)}

    def reduced(self, row: Row) -> dict[str, acb]:
        """A row in the free nodes."""
        result: dict[str, acb] = {}
        for node, factor in without_ground(row).items():
            for free, value in self.motion[node].items():
                result[free] = result.get(free, 0) + factor * value
        return {node: value for node, value in result.items() if value}

    def rank_of(self, laws: str) -> int:
        """Of the rows on which some of J, c, k act."""
        return rank([self.reduced(law.row) for law in self.laws if law.acts(laws)])

    @property
    def is_frequency_dependent(self) -> bool:
        return any(law.depends_on_frequency for law in self.laws)

    @cached_property
    def names(self) -> list[str]:
        return [*self.nodes, *(PREFIX + c.label for c in self.kept)]

    def entries(self, s: acb, omega: arb | None = None) -> Entries:
        """The matrix [D A^T; A 0]."""
        table: dict[tuple[str, str], acb] = {}
        for law in self.laws:
            if not law.acts("Jck"):
                continue
            kappa, row = law.kappa(s, omega), without_ground(law.row)
            for a, x in row.items():
                for b, y in row.items():
                    term = kappa * ball(x * y)
                    table[a, b] = table[a, b] + term if (a, b) in table else term
        for condition in self.kept:
            for node, x in without_ground(condition.row).items():
                table[PREFIX + condition.label, node] = table[node, PREFIX + condition.label] = acb(ball(x))
        return table

    @cached_property
    def order(self) -> Order:
        with precision(BITS):
            s = acb(arb(GENERIC_S[0]), arb(GENERIC_S[1]))
            return make_order(self.entries(s), self.names)

    def is_determinate(self, reading: Reading) -> bool:
        """Whether equilibrium alone gives the reading."""
        if reading.quantity != "torque":
            return True
        node = self.parts[reading.of].ports[reading.port]
        return not any(c.label in self.shared and node in c.row for c in conditions_of(self.parts[reading.of]))

    # --- readings ---------------------------------------------------------------------------------------------------

    def functional(self, reading: Reading, s: acb, omega: arb | None = None) -> dict[str, acb]:
        """The reading as a combination of the unknowns."""
        if reading.quantity in RATES:
            return {reading.of: s ** RATES[reading.quantity]} if reading.of != GROUND else {}
        part = self.parts[reading.of]
        if reading.quantity == "twist":
            return {node: acb(ball(x)) for node, x in without_ground(twist_row(part)).items()}
        node = part.ports[reading.port]
        sign = 1 if reading.port == next(iter(part.ports)) else -1
        result: dict[str, acb] = {}
        for law in self.laws:
            if law.owner == part.name and node in law.row:
                torque = law.kappa(s, omega) * ball(sign * law.row[node])
                for other, x in without_ground(law.row).items():
                    result[other] = result.get(other, 0) + torque * ball(x)
        kept = {c.label for c in self.kept}
        for condition in conditions_of(part):
            if node in condition.row and condition.label in kept:
                result[PREFIX + condition.label] = acb(ball(sign * condition.row[node]))
        return result

    def load(self, excitation: tuple[str, str]) -> dict[str, acb]:
        """Right-hand side of a unit torque on a node, or of a unit imposed angle."""
        quantity, node = excitation
        if quantity == "torque":
            return {node: acb(1)}
        name = next(name for name, at in self.model.imposed.items() if at == node)
        return {PREFIX + f"imposed {name}": acb(1)}

    def at(self, s: acb, excitations: Sequence[tuple[str, str]], readings: Sequence[Reading]) -> list[list[acb]]:
        """Readings (rows) under unit excitations (columns) at s, at the current precision."""
        motions = solve(self.entries(s), self.order, [self.load(excitation) for excitation in excitations])
        rows = [self.functional(reading, s) for reading in readings]
        return [[_total(row, motion) for motion in motions] for row in rows]

    def sizes(self, s: acb, excitations: Sequence[tuple[str, str]], readings: Sequence[Reading]) -> list[list[acb]]:
        """The same with every angle and every multiplier as large as the largest, and no sign."""
        motions = solve(self.entries(s), self.order, [self.load(excitation) for excitation in excitations])
        rows = [self.functional(reading, s) for reading in readings]
        return [[_bound(row, motion) for motion in motions] for row in rows]


def _bound(row: Mapping[str, acb], motion: Mapping[str, acb]) -> acb:
    total = acb(0)
    for kind in (False, True):
        factors = [abs(factor) for name, factor in row.items() if name.startswith(PREFIX) == kind]
        largest = max((abs(v).mid() for name, v in motion.items() if name.startswith(PREFIX) == kind), default=arb(0))
        total += sum(factors, arb(0)) * (largest + 1 if kind else largest)
    return total


def without_ground(row: Mapping[str, object]) -> dict:
    return {node: value for node, value in row.items() if node != GROUND}


def _total(row: Mapping[str, acb], motion: Mapping[str, acb]) -> acb:
    return sum((factor * motion[name] for name, factor in row.items()), acb(0))


def s_of(frequency: float) -> acb:
    """J omega of a frequency in Hz that is exactly this double."""
    return imaginary(2 * arb.pi() * ball(frequency))
