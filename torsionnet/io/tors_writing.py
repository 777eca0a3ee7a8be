"""Writing of drivetrains as TORS files of openTorsion."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import cached_property
from itertools import count, zip_longest
from typing import Any, TypeAlias, TypeGuard, TypeVar

from torsionnet.base.atomic import write_text
from torsionnet.base.errors import UsageError
from torsionnet.base.registers import Groups
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.export_losses import describe_element_part, export_losses, refuse_laws_of_motion
from torsionnet.io.tors_file import (
    SHEAR_MODULUS,
    Disk,
    GearElement,
    ShaftContinuous,
    ShaftDiscrete,
    TorsComponent,
    TorsElement,
    TorsFile,
)
from torsionnet.model.elements import GROUND, Action, Constraint, Element, Gear, Law, Part, Row, Shaft, Values

# Graph of a drivetrain for a TORS file, with disks on nodes, shafts and gears between them.

Disks: TypeAlias = dict[str, list[Disk]]


@dataclass
class Edge:
    """Connection of two nodes in a TORS file, the items of a shaft from first to second, or a gear."""

    first: str
    second: str
    names: list[str]
    items: list[TorsElement] = field(default_factory=list)
    ratio: float = 1.0
    teeth: tuple[int, int] | None = None

    @property
    def is_gear(self) -> bool:
        return not self.items

    def other(self, node: str) -> str:
        return self.second if node == self.first else self.first


@dataclass
class Graph:
    """Disks of a TORS file by node, and the shafts and gears between the nodes."""

    disks: Disks
    edges: list[Edge]

    @cached_property
    def at(self) -> dict[str, list[Edge]]:
        """Shafts and gears at every node, by node, in the order of the elements."""
        by_node: dict[str, list[Edge]] = {node: [] for node in self.disks}
        for edge in self.edges:
            for node in (edge.first, edge.second):
                by_node[node].append(edge)
        return by_node


def tors_graph(drivetrain: Drivetrain) -> Graph:
    """Graph of a drivetrain for a TORS file, refused with the names of all parts that TORS has no counterpart of."""
    refuse_laws_of_motion(drivetrain, "TORS")
    writer = _GraphWriter(drivetrain)
    for element in drivetrain.elements.values():
        writer.write(element)
    if writer.refused:
        raise UsageError(
            f"TORS has no counterpart of {'; '.join(writer.refused)}; it knows disks, shafts and rigid gears in a tree",
            kind="no-counterpart",
        )
    _refuse_all_but_a_tree(writer.disks, writer.edges)
    return Graph(writer.disks, writer.edges)


class _GraphWriter:
    """Writer of the disks and edges of a TORS file, a shaft as such, any other element by its laws and constraints."""

    def __init__(self, drivetrain: Drivetrain) -> None:
        self.value = Values(drivetrain.exact_values)
        elements = drivetrain.elements.values()
        inside = {node for element in elements if _is_chain(element) for node in element.internal_nodes}
        self.home = _merged(elements, self.value, [node for node in drivetrain.nodes if node not in inside])
        self.disks: Disks = {node: [] for node in dict.fromkeys(self.home.values())}
        self.edges: list[Edge] = []
        self.refused: list[str] = []

    def write(self, element: Element) -> None:
        if _is_chain(element):
            first, second = (self.home[node] for node in element.nodes)
            items = _segments(element, self.value, self.disks, [first, second])
            self.edges.append(Edge(first, second, [element.name], items))
            return
        for part in element.parts(self.value):
            is_written = self._part(element, part)
            if not is_written:
                self.refused.append(describe_element_part(element, part))

    def _part(self, element: Element, part: Part) -> bool:
        """Write a law or constraint of an element and return whether TORS has a counterpart."""
        if isinstance(part, Action):
            return False
        return self._law(element, part) if isinstance(part, Law) else self._constraint(element, part.row)

    def _law(self, element: Element, law: Law) -> bool:
        """Write an inertia, damping, spring or damper into the graph and return whether the law is one of these."""
        factor = next(iter(law.row.values()), 0) ** 2
        inertia, damping, stiffness = (float(size * factor) for size in (law.inertia, law.damping, law.stiffness))
        nodes = [self.home.get(node, node) for node in law.row]
        if law.loss_factor != 0 or law.table is not None:
            return False
        if len(nodes) == 1 and not stiffness:
            self.disks[nodes[0]].append(Disk(name=element.name, inertia=inertia, damping=damping))
            return True
        if not _is_difference(law.row) or inertia:
            return False
        self._spring(ShaftDiscrete(name=element.name, stiffness=stiffness, damping=damping), *nodes)
        return True

    def _spring(self, new: ShaftDiscrete, first: str, second: str) -> None:
        """Write a spring or damper, added to another one that is on the same nodes."""
        for edge in self.edges:
            match edge.items:
                case [ShaftDiscrete() as old] if {edge.first, edge.second} == {first, second}:
                    stiffness, damping = old.stiffness + new.stiffness, old.damping + new.damping
                    edge.items[0] = replace(old, stiffness=stiffness, damping=damping)
                    edge.names.append(new.name)
                    return
        self.edges.append(Edge(first, second, [new.name], [new]))

    def _constraint(self, element: Element, row: Row) -> bool:
        """Write a rigid connection or a gear into the graph and return whether the constraint is one of these."""
        if _is_joint(element, row):
            return True
        if len(row) != 2:
            return False
        (first, share), (second, other) = row.items()
        teeth = element.teeth if isinstance(element, Gear) and set(row) == set(element.nodes) else None
        ends = self.home[first], self.home[second]
        self.edges.append(Edge(*ends, [element.name], ratio=float(-other / share), teeth=teeth))
        return True


def _is_chain(element: Element) -> TypeGuard[Shaft]:
    """Whether an element is a shaft that is written to TORS with all that is between its two ends."""
    return isinstance(element, Shaft) and GROUND not in element.nodes


def _is_difference(row: Row) -> bool:
    return len(row) == 2 and sum(row.values()) == 0


def _is_joint(element: Element, row: Row) -> bool:
    """Whether a constraint makes two nodes one, which a gear of ratio 1 does not."""
    return _is_difference(row) and not isinstance(element, Gear)


def _refuse_all_but_a_tree(disks: Disks, edges: list[Edge]) -> None:
    joined = Groups(disks)
    for edge in edges:
        if not joined.join(edge.first, edge.second):
            raise UsageError(
                f"{', '.join(edge.names)} closes a loop; TORS holds trees only: switch it off, or take another format",
                kind="no-counterpart",
            )
    parts = [part[0] for part in joined.groups()]
    if len(parts) > 1:
        raise UsageError(
            f"nothing connects {' and '.join(parts)} in this configuration; "
            "TORS holds one tree: leave one of the two parts out",
            kind="no-counterpart",
        )


def _merged(elements: Iterable[Element], value: Values, nodes: Sequence[str]) -> dict[str, str]:
    """Node that stands for each node, by name, as rigid connections make one of two."""
    joined = Groups(nodes)
    for element in elements:
        for part in element.parts(value):
            if isinstance(part, Constraint) and _is_joint(element, part.row):
                joined.join(*part.row)
    return {node: joined.of(node)[0] for node in nodes}


def _segments(shaft: Shaft, value: Values, disks: Disks, ends: list[str]) -> list[TorsElement]:
    """Items of a shaft in a TORS file, its segments, and the disks between them where the inertia is lumped."""
    n, laws = int(shaft.segments), [part for part in shaft.parts(value) if isinstance(part, Law)]
    names = [shaft.name if n == 1 else f"{shaft.name} {index}" for index in range(1, n + 1)]
    elastic = next(law for law in laws if law.is_elastic)
    damping = float(elastic.damping)
    if shaft.inertia == "consistent":
        segment = _continuous(shaft, value, n)
        return [replace(segment, name=name, damping=damping or None) for name in names]
    shafts = [ShaftDiscrete(name=name, stiffness=float(elastic.stiffness), damping=damping) for name in names]
    lump = max(float(law.inertia) for law in laws)
    if not lump:
        return [*shafts]
    for end in ends:
        disks[end].append(Disk(name=f"{shaft.name} at {end}", inertia=lump))
    between = [Disk(name=f"{shaft.name} lump {index}", inertia=2 * lump) for index in range(1, n)]
    return [item for pair in zip_longest(shafts, between) for item in pair if item]


def _continuous(shaft: Shaft, value: Values, n: int) -> ShaftContinuous:
    """Segment of a shaft in a TORS file, of equal stiffness and inertia with openTorsion's shear modulus."""
    outer, inner, length = (
        1e3 * float(value(size)) for size in (shaft.outer_diameter, shaft.inner_diameter, shaft.length)
    )
    stretch = SHEAR_MODULUS / float(value(shaft.shear_modulus))
    return ShaftContinuous(
        name=shaft.name,
        length=length / n * stretch,
        outerDiameter=outer,
        innerDiameter=inner,
        density=float(value(shaft.density)) / stretch,
    )


WHEEL = 100.0
"""Diameter in mm of the first wheel of a gear known by its ratio alone, as TORS wants diameters or teeth."""

MOST_STARTS = 50
"""Ends of the drivetrain from which a layout is tried, as more would take longer where none is possible."""

E = TypeVar("E", bound=TorsElement)
Chain: TypeAlias = dict[str, TorsElement]
"""Elements of a component of a TORS file in their order, by name."""


def to_tors(drivetrain: Drivetrain) -> dict[str, Any]:
    """JSON data of a TORS file of the drivetrain, with the values of its parameters and its configuration.

    The format knows disks, shafts and gears in a tree. Nodes joined by a rigid coupling become one; springs and dampers
    between the same nodes one shaft; a gear of positive ratio a train with an idler; a shaft of another modulus than
    80 GPa one of equal stiffness and inertia with another length and density. Other element types are written by their
    laws and constraints, as far as these are disks, shafts and gears. Every element carries its ``node``, so that
    :func:`read_tors` finds it again; openTorsion passes over that. ``notes`` lists what is left out, as inputs and
    sensors.

    Raises
    ------
    UsageError
        What the format, or openTorsion 0.3.2 in reading it, cannot express: a clamp or a spring to ground, a compliant
        mesh, planetary sets, open differentials, frequency-dependent springs, loops, parts that nothing connects, two
        shafts leaving one node.

    Examples
    --------
    >>> import torsionnet as tn
    >>> [element["name"] for element in to_tors(tn.load("oil_engine"))["components"][0]["elements"]]
    ['engine_inertia', 'engine_shaft', 'wheel', 'pump_shaft', 'pump_inertia']
    """
    layout = _laid_out(tors_graph(drivetrain))
    components = tuple(
        TorsComponent(name=name, elements=tuple(chain.values())) for name, chain in layout.chains.items()
    )
    today = datetime.now(tz=UTC).date().isoformat()
    structure = tuple(layout.structure)
    notes = list(export_losses(drivetrain, "tors").sentences()) or None
    return TorsFile(
        name=drivetrain.title, date=today, notes=notes, components=components, structure=structure
    ).written_entries()


def write_tors(drivetrain: Drivetrain, path: str | os.PathLike[str]) -> None:
    """Write the data of :func:`to_tors` as a JSON file, whole or not at all."""
    text = json.dumps(to_tors(drivetrain), indent=1, ensure_ascii=False)
    write_text(path, f"{text}\n")


def _laid_out(graph: Graph) -> _Layout:
    """Layout of the graph as chains of elements, begun at the first end of the drivetrain where that is possible."""
    nodes = list(graph.disks)
    ends = [node for node in nodes if len(graph.at[node]) <= 1] or nodes[:1]
    refusals: list[UsageError] = []
    for start in ends[:MOST_STARTS]:
        try:
            layout = _Layout(graph)
            layout.run(start)
        except UsageError as refusal:
            refusals.append(refusal)
        else:
            return layout
    raise refusals[0]


def _add(chain: Chain, item: E, node: str | None = None) -> E:
    """Element as it is put at the end of a chain, with a name that no other one in it has, and the node at its end."""
    names = (f"{item.name} {number}" if number > 1 else item.name for number in count(1))
    added = replace(item, name=next(name for name in names if name not in chain), node=node)
    chain[added.name] = added
    return added


class _Layout:
    """Layout of a graph as chains of elements with branches, beginning at one end."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.chains: dict[str, Chain] = {}
        self.structure: list[tuple[str, str]] = []
        self.used: set[int] = set()

    def run(self, start: str) -> None:
        name, chain = self._new_chain()
        if not self.graph.disks[start]:
            _add(chain, Disk(name=start, inertia=0.0), start)
        self._walk(name, start)

    def _new_chain(self) -> tuple[str, Chain]:
        name = f"part {len(self.chains) + 1}"
        self.chains[name] = {}
        return name, self.chains[name]

    def _walk(self, component: str, node: str) -> None:
        """Add a node and all that follows to the chain, or to another one where gears follow, too."""
        chain = self.chains[component]
        while True:
            for disk in self.graph.disks[node]:
                _add(chain, disk, node)
            shafts, gears = self._onward(node)
            wheels = [_add(chain, _wheel(edge, node), node) for edge in gears]
            if gears:
                break
            if not shafts:
                return
            node = self._shaft(chain, shafts[0], node)
        if shafts:
            self._branch(f"{component}.{wheels[-1].name}", shafts[0], node)
        for edge, wheel in zip(gears, wheels, strict=True):
            self._mesh(chain, edge, wheel, node)
            self._walk(component, edge.other(node))

    def _onward(self, node: str) -> tuple[list[Edge], list[Edge]]:
        """Shafts and gears that lead on from a node, marked as used."""
        onward = [edge for edge in self.graph.at[node] if id(edge) not in self.used]
        self.used |= {id(edge) for edge in onward}
        shafts = [edge for edge in onward if not edge.is_gear]
        if len(shafts) > 1:
            names = ", ".join(name for edge in shafts for name in edge.names)
            raise UsageError(
                f"{names} lead on together from node {node}; openTorsion lets one shaft go on from a place",
                kind="no-counterpart",
            )
        return shafts, [edge for edge in onward if edge.is_gear]

    def _shaft(self, chain: Chain, edge: Edge, node: str) -> str:
        for item in edge.items[:-1]:  # equal segments: the same from either side
            _add(chain, item)
        _add(chain, edge.items[-1], edge.other(node))
        return edge.other(node)

    def _branch(self, origin: str, edge: Edge, node: str) -> None:
        name, chain = self._new_chain()
        end = self._shaft(chain, edge, node)
        self.structure.append((origin, f"{name}.{next(iter(chain))}"))
        self._walk(name, end)

    def _mesh(self, chain: Chain, edge: Edge, wheel: GearElement, node: str) -> None:
        """Add the second wheel of a gear, for a positive ratio after an idler that turns the sense round."""
        parent = wheel.name
        if edge.ratio > 0:
            parent = _add(chain, replace(wheel, name=f"{edge.names[0]} idler", parent=parent)).name
        end = edge.other(node)
        _add(chain, replace(_wheel(edge, end), parent=parent), end)


def _wheel(edge: Edge, node: str) -> GearElement:
    side = 0 if node == edge.first else 1
    teeth = abs(int(edge.teeth[side])) if edge.teeth else None
    size = float(teeth or WHEEL * (abs(edge.ratio) if side else 1.0))
    return GearElement(name=f"{edge.names[0]} {node}", inertia=0.0, diameter=size, teeth=teeth)
