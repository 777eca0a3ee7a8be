"""Writing of drivetrains as TORS files of openTorsion."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from datetime import UTC, datetime
from itertools import count
from typing import Any, TypeAlias, TypeVar

from torsionnet.base.atomic import write_text
from torsionnet.base.errors import UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.export_losses import export_losses
from torsionnet.io.tors_elements import Disk, GearElement, TorsElement
from torsionnet.io.tors_file import TorsComponent, TorsFile
from torsionnet.io.tors_graph import Edge, Graph, tors_graph

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
                f"{names} lead on together from node {node}; openTorsion lets one shaft go on from a place"
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
