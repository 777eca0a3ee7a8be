"""Mass-elastic table from the laws of a drivetrain: inertias of nodes, connections between them, damping."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.machinery.holzer.holzer_balance import Coefficients, HolzerBalance, NodeLoad, balance_of
from torsionnet.machinery.holzer.holzer_lines import HolzerLine, Neighbours, holzer_lines
from torsionnet.machinery.holzer.mass_elastic_table import (
    MassElasticLine,
    MassElasticRow,
    MassElasticShaft,
    MassElasticTable,
    StationSection,
)
from torsionnet.machinery.holzer.whole_shafts import HiddenNodes, hidden_nodes, shown_steps, whole_shaft
from torsionnet.model.element_base.round_section import section_modulus
from torsionnet.model.elements import Values
from torsionnet.model.speeds import speeds_by_reference


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
    >>> found = tn.load("reciprocating_compressor_train").mass_elastic_table()  # flywheel: 140.45 / 2.96^2
    >>> round(found.rows[3].referred_inertia, 3), round(found.total_inertia, 2)
    (16.03, 43.1)
    """
    definition, nodes = drivetrain.definition, drivetrain.assembly.nodes
    if referred_to is not None and referred_to not in drivetrain.nodes:
        raise UsageError(f'no node is named "{referred_to}"{did_you_mean(referred_to, drivetrain.nodes)}')
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
                inertia = self.balance.inertias[node] + self.hidden.shares.get(node, 0.0)
                rows.append(MassElasticRow(number, node, inertia, self._absolute(node), ratio, shaft))
            yield MassElasticLine(joins, tuple(rows))

    def _absolute(self, node: str) -> float:
        """Damping in N m s/rad of a node against the ground."""
        return sum(one.damping * one.row[node] ** 2 for one in self.damping if tuple(one.row) == (node,))

    def _film(self, node: str) -> MassElasticShaft | None:
        """Connection of a node with another one by damping alone, or None."""
        found = next(
            (one for one in self.damping if node in one.row and len(one.row) == 2 and not self._is_followed(one)), None
        )
        if found is None:
            return None
        other = next(one for one in found.row if one != node)
        return MassElasticShaft((found.element,), other, 0.0, found.damping * found.row[node] ** 2)

    def _is_followed(self, law: _DampingLaw) -> bool:
        """Whether a law of damping lies between two neighbours that a spring or a rigid connection joins."""
        one, other = law.row
        return other in self.tree[one]

    def _shaft(self, node: str, after: str) -> MassElasticShaft:
        loads = self.tree[node][after]
        stiffness = sum(load.stiffness_at(node) for load in loads)
        elements = {load.element for load in loads}
        laws = [
            one
            for one in self.damping
            if set(one.row) == {node, after} or (one.element in elements and {node, after} <= set(one.row))
        ]
        names = tuple(dict.fromkeys([*(load.element for load in loads), *(one.element for one in laws)]))
        found = MassElasticShaft(names, after, stiffness, sum(one.damping * one.row[node] ** 2 for one in laws))
        lossy = sum(one.lossy * one.row[node] ** 2 for one in laws)
        found = replace(found, loss_factor=lossy / stiffness) if lossy else found
        return replace(found, section=self._section(loads), length=self._length(loads), material=self._material(loads))

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
                return f"{kind} steel {strength / 1e6:g} N/mm²".strip() if kind else f"{strength / 1e6:g} N/mm²"
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
        for one in self.damping:
            if len(one.row) > 1 and one.element not in shown and one.damping:
                yield f"{one.element} damps {', '.join(one.row)} ({one.damping:.5g} N*m*s/rad)"
