"""Mass-elastic table from the laws of a drivetrain: inertias of nodes, connections between them, damping."""

from __future__ import annotations

import math
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.machinery.holzer.holzer_balance import (
    Coefficients,
    HolzerBalance,
    HolzerLine,
    Neighbours,
    NodeLoad,
    balance_of,
    holzer_lines,
)
from torsionnet.machinery.holzer.mass_elastic_table import (
    MassElasticLine,
    MassElasticRow,
    MassElasticShaft,
    MassElasticTable,
    StationSection,
)
from torsionnet.model.element_base.round_section import section_modulus
from torsionnet.model.elements import Values
from torsionnet.model.speeds import speeds_by_reference

# Shafts that a model divides into segments, put together again for tables of masses and shafts.


@dataclass(frozen=True)
class HiddenNodes:
    """Nodes inside of divided shafts, and the inertia in kg m^2 that each end of the shafts takes over from them.

    Attributes
    ----------
    names : frozenset of str
    shares : mapping
        Node -> inertia.
    """

    names: frozenset[str] = frozenset()
    shares: Mapping[str, float] = field(default_factory=dict)


def hidden_nodes(drivetrain: AssembledModel, tree: Neighbours, inertias: Mapping[str, float]) -> HiddenNodes:
    """Inner nodes of the divided shafts of a drivetrain, each split on the two ends of its shaft by its place.

    A node at the share x of the shaft's flexibility gives 1 - x of its inertia to the first end and x to the other, as
    if the shaft twisted evenly; the sum stays. A shaft that closes a loop stays divided.
    """
    names: set[str] = set()
    shares: dict[str, float] = {}
    for element in drivetrain.elements.values():
        inner = element.internal_nodes if hasattr(element, "segments") else ()
        chain = _chain(tree, inner) if inner and set(inner) <= tree.keys() else []
        if not chain:
            continue
        # Flexibility 1/k of each part of the shaft, parallel elements of a part added as stiffnesses.
        steps = [1 / sum(load.stiffness_at(near) for load in tree[near][other]) for near, other in pairwise(chain)]
        names |= set(inner)
        for place, node in enumerate(chain[1:-1], 1):
            share = sum(steps[:place]) / sum(steps)
            for end, part in ((chain[0], 1 - share), (chain[-1], share)):
                shares[end] = shares.get(end, 0.0) + part * inertias[node]
    return HiddenNodes(frozenset(names), shares)


def _chain(tree: Neighbours, inner: Sequence[str]) -> list[str]:
    """Nodes of a shaft from end to end through its inner nodes; empty where these do not stand in one elastic line."""
    first = next((node for node in inner if len(set(tree[node]) - set(inner)) >= 1), None)
    if first is None:
        return []
    chain = [next(node for node in tree[first] if node not in inner), first]
    while chain[-1] in inner:
        onward = [node for node in tree[chain[-1]] if node != chain[-2]]
        if len(onward) != 1 or any(load.rigid for load in tree[chain[-1]][onward[0]]):
            return []
        chain += onward
    return chain if set(inner) <= set(chain) else []


def whole_shaft(parts: Sequence[MassElasticShaft]) -> MassElasticShaft:
    """Connection equivalent to several in series, of stiffness 1/sum(1/k) in N m/rad and with the sum of their losses.

    Damping is the one with the same loss at an even twist, k^2 sum(c_i/k_i^2), the loss factor k sum(eta_i/k_i).

    Examples
    --------
    >>> half = MassElasticShaft(("line",), "b", 8e6, damping=40.0)
    >>> both = whole_shaft([half, half])
    >>> both.stiffness, both.damping, both.segments
    (4000000.0, 20.0, 2)
    """
    if len(parts) == 1:
        return parts[0]
    # Springs in series: one torque, twists add, 1/k = sum 1/k_i.
    stiffness = 1 / sum(1 / part.stiffness for part in parts)
    return replace(
        parts[0],
        to=parts[-1].to,
        stiffness=stiffness,
        # gamma_i = (k/k_i) gamma: the loss sum c_i gamma_i'^2 is that of c = k^2 sum c_i/k_i^2.
        damping=stiffness**2 * sum(part.damping / part.stiffness**2 for part in parts),
        loss_factor=stiffness * sum(part.loss_factor / part.stiffness for part in parts),
        segments=len(parts),
    )


def shown_steps(
    steps: Sequence[tuple[str, str]], hidden: Container[str]
) -> Iterator[tuple[str, list[tuple[str, str]]]]:
    """Yield every shown node of a line with the steps (node, next node) to the next shown one; none after the last.

    Examples
    --------
    >>> list(shown_steps([("a", "s.1"), ("s.1", "b"), ("b", "")], {"s.1"}))
    [('a', [('a', 's.1'), ('s.1', 'b')]), ('b', [])]
    """
    rows: list[tuple[str, list[tuple[str, str]]]] = []
    for node, after in steps:
        if node not in hidden:
            rows.append((node, []))
        if after:
            rows[-1][1].append((node, after))
    yield from rows


@dataclass(frozen=True)
class _DampingLaw:
    """Viscous damping in N m s/rad and hysteretic stiffness k eta in N m/rad of one law on the nodes of its row."""

    element: str
    row: Coefficients
    damping: float
    lossy: float


def mass_elastic_table(drivetrain: AssembledModel, referred_to: str | None = None) -> MassElasticTable:
    """Mass-elastic table of the drivetrain, inertias, shafts and damping, as they are and referred to one shaft.

    Parameters
    ----------
    referred_to : str, optional
        Node of the reference shaft; default: that of the model's ``speeds:``, else the first station.

    Raises
    ------
    UsageError
        No such node, or a controller acts on the drivetrain.

    Examples
    --------
    >>> import torsionnet as tn
    >>> sheet = tn.load("reciprocating_compressor_train").mass_elastic_table()  # flywheel: 140.45 / 2.96^2
    >>> round(sheet.rows[3].referred_inertia, 3), round(sheet.total_inertia, 2)
    (16.03, 43.1)
    """
    definition, nodes = drivetrain.definition, drivetrain.assembly.nodes
    if referred_to is not None and referred_to not in drivetrain.nodes:
        raise UsageError(
            f'no node is named "{referred_to}"{did_you_mean(referred_to, drivetrain.nodes)}', kind="unknown-node"
        )
    # At 0 Hz and without motion: rows, stiffnesses and inertias as the Holzer table takes them.
    balance = balance_of(drivetrain, 0.0, np.zeros(len(nodes)))
    order, tree = holzer_lines(nodes, balance.loads, None)
    reference = referred_to or (str(definition.speeds.of) if definition.speeds else order[0].nodes[0])
    ratios = speeds_by_reference(definition, drivetrain.exact_values, reference)
    own = ratios.get(reference) or 1.0
    walk = _Walk(
        drivetrain,
        balance,
        tree,
        tuple(_damping_laws(drivetrain)),
        {node: speed / own for node, speed in ratios.items() if speed},
        hidden_nodes(drivetrain, tree, balance.inertias),
    )
    lines = tuple(walk.lines(order))
    return MassElasticTable(reference, lines, drivetrain.title, tuple(walk.left_over(lines)))


def _damping_laws(drivetrain: AssembledModel) -> Iterator[_DampingLaw]:
    assembly = drivetrain.assembly
    known = set(assembly.nodes)
    for owner, law in zip(assembly.owners, assembly.laws, strict=True):
        lossy = float(law.stiffness * law.loss_factor)
        if law.damping or lossy:
            row = {node: float(value) for node, value in law.row.items() if node in known}
            yield _DampingLaw(owner, row, float(law.damping), lossy)


@dataclass(frozen=True, eq=False)
class _Walk:
    """Masses and connections of a drivetrain, from which the rows of its mass-elastic table are made."""

    drivetrain: AssembledModel
    balance: HolzerBalance
    tree: Neighbours
    damping: tuple[_DampingLaw, ...]
    ratios: Mapping[str, float]
    hidden: HiddenNodes

    def lines(self, order: Sequence[HolzerLine]) -> Iterator[MassElasticLine]:
        """Lines of the table, with their masses counted from 1 through all of them."""
        number = 0
        main = set(order[0].nodes) if order else set()
        for line in order:
            rows = []
            joins = line.joins or None
            for node, steps in shown_steps(tuple(line.steps()), self.hidden.names):
                number += 1
                shaft = whole_shaft([self._shaft(*step) for step in steps]) if steps else None
                if shaft is None and node not in main:  # a ring that a film alone drags along
                    shaft = self._film(node)
                    joins = shaft.to if shaft else joins
                ratio = self.ratios.get(node, math.nan)
                # Inner nodes of a divided shaft give their inertia to its ends, so that the sum stays.
                inertia = self.balance.inertias[node] + self.hidden.shares.get(node, 0.0)
                of_shafts = inertia - self.balance.masses[node]
                rows.append(MassElasticRow(number, node, inertia, self._absolute(node), ratio, shaft, of_shafts))
            yield MassElasticLine(joins, tuple(rows))

    def _absolute(self, node: str) -> float:
        """Damping in N m s/rad of a node against the ground."""
        return sum(law.damping * law.row[node] ** 2 for law in self.damping if tuple(law.row) == (node,))

    def _film(self, node: str) -> MassElasticShaft | None:
        """Connection of a node with another one by damping alone, or None."""
        film = next(
            (law for law in self.damping if node in law.row and len(law.row) == 2 and not self._is_followed(law)), None
        )
        if film is None:
            return None
        other = next(end for end in film.row if end != node)
        return MassElasticShaft((film.element,), other, 0.0, film.damping * film.row[node] ** 2)

    def _is_followed(self, law: _DampingLaw) -> bool:
        """Whether a law of damping lies between two neighbours that a spring or a rigid connection joins."""
        near, other = law.row
        return other in self.tree[near]

    def _shaft(self, node: str, after: str) -> MassElasticShaft:
        loads = self.tree[node][after]
        stiffness = sum(load.stiffness_at(node) for load in loads)
        elements = {load.element for load in loads}
        laws = [
            law
            for law in self.damping
            if set(law.row) == {node, after} or (law.element in elements and {node, after} <= set(law.row))
        ]
        names = tuple(dict.fromkeys([*(load.element for load in loads), *(law.element for law in laws)]))
        shaft = MassElasticShaft(names, after, stiffness, sum(law.damping * law.row[node] ** 2 for law in laws))
        # k eta of parallel laws adds; eta of the connection is their sum over the sum of k.
        lossy = sum(law.lossy * law.row[node] ** 2 for law in laws)
        shaft = replace(shaft, loss_factor=lossy / stiffness) if lossy else shaft
        return replace(shaft, section=self._section(loads), length=self._length(loads), material=self._material(loads))

    def _section(self, loads: Sequence[NodeLoad]) -> StationSection | None:
        """Outer and inner diameter in m and section modulus in m^3 of a connection that is one shaft, else None."""
        element = self.drivetrain.elements[loads[0].element]
        if len(loads) > 1 or element.diameters is None:
            return None
        value = Values(self.drivetrain.exact_values)
        outer, inner = (float(value(size)) for size in element.diameters)
        return StationSection(outer, inner, float(section_modulus(element, value)))

    def _length(self, loads: Sequence[NodeLoad]) -> float | None:
        """Length in m of a connection that is one shaft of given dimensions, else None."""
        element = self.drivetrain.elements[loads[0].element]
        length = getattr(element, "length", None)
        if len(loads) > 1 or element.diameters is None or length is None:
            return None
        return float(Values(self.drivetrain.exact_values)(length))

    def _material(self, loads: Sequence[NodeLoad]) -> str:
        """Kind of steel and tensile strength that a limit on one of the elements gives, else an empty text."""
        names = {load.element for load in loads}
        for limit in self.drivetrain.definition.limits.values():
            strength = getattr(limit, "tensile_strength", None) or getattr(limit, "ultimate_strength", None)
            if getattr(limit, "element", None) in names and strength:
                kind = getattr(limit, "material", "").replace("_", "-")
                size = f"{strength / 1e6:g} N/mm²"
                return phrase("{steel} {strength}", steel=phrase(f"{kind} steel"), strength=size) if kind else size
        return ""

    def left_over(self, lines: Sequence[MassElasticLine]) -> Iterator[str]:
        """Sentences on connections that no row of the mass-elastic table has."""
        followed = {id(load) for ends in self.tree.values() for loads in ends.values() for load in loads}
        for load in self.balance.loads:
            if id(load) in followed:
                continue
            ends = " and ".join([", ".join(load.row)] if len(load.row) > 1 else [*load.row, "ground"])
            size = "rigid" if load.rigid else f"{load.stiffness:.5g} N*m/rad"
            yield f"{load.element} ties {ends} ({size})"
        shown = {name for line in lines for row in line.rows if row.shaft for name in row.shaft.elements}
        for law in self.damping:
            if len(law.row) > 1 and law.element not in shown and law.damping:
                yield f"{law.element} damps {', '.join(law.row)} ({law.damping:.5g} N*m*s/rad)"
