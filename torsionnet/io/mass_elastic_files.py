"""Mass-elastic sheets of makers (CSV), read as drivetrains and written from them."""

from __future__ import annotations

import csv
import io
import os
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from torsionnet.base.atomic import write_text
from torsionnet.base.errors import UsageError, did_you_mean, readable_text, warn_user
from torsionnet.base.units import numeral_of
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.export_losses import describe_element_part, export_losses, refuse_laws_of_motion
from torsionnet.model.elements import GROUND, Constraint, Element, Law, Row, Shaft, Values
from torsionnet.model.elements.mass_elastic import sheet_elements
from torsionnet.model.sheets.factor_readings import READINGS
from torsionnet.model.sheets.mass_elastic_sheet import SIDES, MassElasticSheet, SheetReading, read_sheet

# Reading of makers' mass-elastic sheets as drivetrains.


def read_mass_elastic(path: str | os.PathLike[str], *, values: str = "", factors: str = "") -> Drivetrain:
    """Read a maker's mass-elastic sheet (CSV, or what a spreadsheet program saves as text) as a drivetrain.

    Masses become inertias on nodes of their names, shafts springs, changes of speed gears. What was taken as what is in
    :func:`mass_elastic_report`.

    Parameters
    ----------
    path : str or PathLike
        The file.
    values : str
        ``real`` or ``referred`` (to the speed of ratio 1), where the sheet leaves it open or is wrong.
    factors : str
        What factors in headings multiply, as ``K x 10^-6 (lb-in/rad)``: ``values`` (cells are K times 1e-6) or ``unit``
        (cells are in 1e-6 lb-in/rad). Without it the lowest vibration decides where only one reading is possible.

    Raises
    ------
    ModelError
        With the row and column of every fault.
    UsageError
        There is no such file, or no such value of an argument.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "engine.csv")
    >>> _ = path.write_text("mass;J [kg m²];k [MNm/rad]\\ncyl 1;0,45;2,1\\nflywheel;14;", encoding="utf-8")
    >>> engine = read_mass_elastic(path)
    >>> engine.nodes, list(engine.elements)
    (('cyl_1', 'flywheel'), ['cyl_1', 'flywheel', 'cyl_1_to_flywheel'])
    """
    return sheet_drivetrain(mass_elastic_report(path, values=values, factors=factors))


def mass_elastic_report(path: str | os.PathLike[str], *, values: str = "", factors: str = "") -> MassElasticSheet:
    """Content of a mass-elastic sheet, whose ``report()`` is the table of what was taken as what, in which unit.

    Arguments are those of :func:`read_mass_elastic`.
    """
    source = Path(path)
    for name, value, allowed in (("values", values, SIDES), ("factors", factors, READINGS)):
        if value and value not in allowed:
            raise UsageError(
                f'{name} is {" or ".join(allowed)}, not "{value}"{did_you_mean(value, allowed)}', kind="unknown-word"
            )
    if not source.is_file():
        raise UsageError(f'there is no file "{source}"', kind="missing-file")
    return read_sheet(source, reading=SheetReading(values, factors))


def sheet_drivetrain(sheet: MassElasticSheet) -> Drivetrain:
    """Drivetrain of a mass-elastic sheet that was read, its nodes named after the masses."""
    nodes = {mass.name: mass.name for mass in sheet.masses}
    title = readable_text(Path(sheet.file).stem.replace("_", " "))
    return Drivetrain(
        title, list(sheet_elements(sheet, nodes)), source=f"mass-elastic sheet {readable_text(sheet.file)}"
    )


# Writing of drivetrains as mass-elastic sheets (CSV), with a mass and the shaft after it in each row.

# Graph of a drivetrain for a mass-elastic sheet, with inertias of nodes, connections between two, speed ratios.

NODES_PER_CONNECTION = 2
"""Most nodes that a row of a mass-elastic sheet connects, the two ends of a shaft."""
MOST_LISTED_PARTS = 4
"""Parts without a column in a sheet that an error message lists, beyond which it gives their number."""


@dataclass(frozen=True)
class Connection:
    """Spring (N m/rad), damper (N m s/rad) or rigid connection (stiffness None) on theta_first - tau theta_second."""

    name: str
    first: str
    second: str
    tau: Any = 1
    stiffness: float | None = None
    damping: float = 0.0
    loss_factor: float = 0.0
    diameters: tuple[float, float] | None = None

    def from_node(self, node: str) -> Connection:
        """Connection with ``node`` as its first end, and stiffness and damping in SI referred to that node."""
        if node == self.first:
            return self
        factor = float(self.tau) ** 2
        stiffness = None if self.stiffness is None else self.stiffness * factor
        return replace(self, first=self.second, second=self.first, tau=1 / self.tau, stiffness=stiffness,
                       damping=self.damping * factor)  # fmt: skip


@dataclass
class MassElasticGraph:
    """Inertia (kg m^2) and damping to ground (N m s/rad) by node, connections, and speed ratios to one node."""

    inertias: dict[str, float]
    dampings: dict[str, float]
    connections: list[Connection] = field(default_factory=list)
    ratios: dict[str, Any] = field(default_factory=dict)

    @property
    def connections_at(self) -> dict[str, list[Connection]]:
        """Connections between two nodes by node, each listed at both of its ends; those to ground are left out."""
        by_node: dict[str, list[Connection]] = {node: [] for node in self.inertias}
        for connection in self.connections:
            if GROUND not in (connection.first, connection.second):
                by_node[connection.first].append(connection)
                by_node[connection.second].append(connection)
        return by_node


def mass_elastic_graph(drivetrain: Drivetrain, reference: str) -> MassElasticGraph:
    """Graph of a drivetrain as a mass-elastic sheet shows it, with speed ratios relative to the node ``reference``.

    Raises
    ------
    UsageError
        Naming parts that a sheet has no column for.

    Warns
    -----
    TorsionnetWarning
        A shaft is lumped whose inertia is consistent with its twist.
    """
    refuse_laws_of_motion(drivetrain, "a mass-elastic sheet")
    nodes = list(drivetrain.nodes)
    graph = MassElasticGraph(dict.fromkeys(nodes, 0.0), dict.fromkeys(nodes, 0.0))
    value, refused = Values(drivetrain.exact_values), []
    for given in drivetrain.elements.values():
        element = _lumped(given)
        for part in element.parts(value):
            rigid = isinstance(part, Constraint)
            written = (
                _law(graph, element, part, value)
                if isinstance(part, Law)
                else rigid and len(part.row) <= NODES_PER_CONNECTION
            )
            if written and part.row and rigid:
                graph.connections.append(_connected(element.name, part.row))
            refused += [] if written else [describe_element_part(element, part)]
    if refused:
        rest = f" and {len(refused) - MOST_LISTED_PARTS} more" if len(refused) > MOST_LISTED_PARTS else ""
        raise UsageError(
            f"a mass-elastic sheet has no column for {'; '.join(refused[:MOST_LISTED_PARTS])}{rest}",
            kind="no-counterpart",
        )
    graph.connections = list(_named(graph.connections))
    graph.ratios = _ratios(graph, reference)
    return graph


def _lumped(element: Element) -> Element:
    """Shaft with its inertia lumped on the ends of its segments, as a sheet has only masses and springs."""
    if not isinstance(element, Shaft) or element.inertia != "consistent":
        return element
    text = f"the inertia of {element.name} is lumped at the ends of its segments, which moves natural frequencies"
    warn_user(f"{text}; inertia: lumped in the model does the same")
    return replace(element, inertia="lumped")


def _law(graph: MassElasticGraph, element: Element, law: Law, value: Values) -> bool:
    """Add a law of an element to the graph and return whether a mass-elastic sheet can hold the law."""
    if (
        law.table is not None
        or len(law.row) > NODES_PER_CONNECTION
        or (len(law.row) == NODES_PER_CONNECTION and law.inertia != 0)
    ):
        return False
    if not law.row:
        return True
    node, share = next(iter(law.row.items()))
    # A law on the row a (theta_1 - tau theta_2) counts a^2 times over the angle of its first node.
    factor = float(share) ** 2
    inertia, damping, stiffness = (float(size) * factor for size in (law.inertia, law.damping, law.stiffness))
    section = element.diameters
    diameters = None if section is None else (float(value(section[0])), float(value(section[1])))
    # On one node an inertia is a mass and a damping one to ground; a spring to ground has a row of its own.
    if len(law.row) == 1:
        graph.inertias[node] += inertia
        if not stiffness:
            graph.dampings[node] += damping
            return True
    elif not stiffness and not damping:
        return True
    connection = _connected(element.name, law.row)
    lossy = float(law.loss_factor)
    graph.connections.append(
        replace(connection, stiffness=stiffness, damping=damping, loss_factor=lossy, diameters=diameters)
    )
    return True


def _connected(name: str, row: Row) -> Connection:
    (first, share), *rest = row.items()
    if not rest:
        return Connection(name, first, GROUND)
    # a theta_1 + b theta_2 = a (theta_1 - tau theta_2), tau = -b/a.
    second, other = rest[0]
    return Connection(name, first, second, -other / (Fraction(share) if isinstance(share, int) else share))


def _named(connections: list[Connection]) -> Iterator[Connection]:
    """Yield the connections with unique names, numbered where one element has several."""
    names = [connection.name for connection in connections]
    for index, link in enumerate(connections):
        several = names.count(link.name) > 1
        yield replace(link, name=f"{link.name}_{names[:index].count(link.name) + 1}") if several else link


def _ratios(graph: MassElasticGraph, reference: str) -> dict[str, Any]:
    """Speed of every node over that of the reference, by node, or UsageError where nothing or two things tell it."""
    ratios: dict[str, Any] = {reference: Fraction(1)}
    at, waiting = graph.connections_at, deque([reference])
    while waiting:
        node = waiting.popleft()
        for connection in at[node]:
            there = connection.from_node(node)
            # A rigid connection has theta_1 = tau theta_2, and on average so has a spring.
            speed = ratios[node] / there.tau
            if there.second not in ratios:
                ratios[there.second] = speed
                waiting.append(there.second)
            elif abs(float(ratios[there.second] / speed) - 1) > 1e-9:
                raise UsageError(
                    f"the ratio of {connection.name} is not that of the speeds of its nodes by another way through the "
                    "plant; a sheet has one speed for each mass, so switch one of the ways off",
                    kind="no-counterpart",
                )
    unconnected = [node for node in graph.inertias if node not in ratios]
    if unconnected:
        raise UsageError(
            f"nothing connects {unconnected[0]} with {reference} in this configuration; a sheet holds one plant",
            kind="unconnected-nodes",
        )
    return ratios


LARGEST_RATIO_TERM = 10**6
"""Whole numbers below which a speed ratio of a sheet is written as a fraction (``29/14``), otherwise in decimals."""
_COLUMNS = (
    "mass", "{J} [kg*m^2]", "absolute damping{by} [N*m*s/rad]", "speed ratio", "from", "to", "{k} [N*m/rad]",
    "relative damping{by} [N*m*s/rad]", "loss factor", "outer diameter [m]", "inner diameter [m]",
)  # fmt: skip


def to_mass_elastic(drivetrain: Drivetrain, *, referred_to: str | None = None) -> str:
    """Text of a mass-elastic sheet (CSV) that :func:`read_mass_elastic` reads back to equal modes.

    A row is a mass, at a node, and the shaft ``to`` another one; what is left over (parallel springs, loops, springs to
    ground) has rows with ``from`` and ``to`` and no inertia. The speed ratio is the speed of the node over that of the
    first one, or of ``referred_to``; then all values are referred to it: J n^2, k n^2, c n^2. Otherwise they are real;
    the stiffness of a shaft that ends in a gear is that at its own speed.

    Raises
    ------
    UsageError
        What a sheet has no column for: tables over frequency, consistent inertia of shafts, sets of three moving
        members, parts that nothing connects.

    Examples
    --------
    >>> import torsionnet as tn
    >>> print(to_mass_elastic(tn.load("oil_engine")).splitlines()[1])
    # all values are real, in SI units; speed ratio: speed of the mass over that of engine
    """
    if referred_to is not None and referred_to not in drivetrain.nodes:
        hint = did_you_mean(referred_to, drivetrain.nodes) or f"; there are {', '.join(drivetrain.nodes)}"
        raise UsageError(f'no node is named "{referred_to}"{hint}', kind="unknown-node")
    graph = mass_elastic_graph(drivetrain, referred_to or drivetrain.nodes[0])
    referred = referred_to is not None
    said = f"values are referred to {referred_to}" if referred else "all values are real"
    text = io.StringIO()
    # How values are to be taken stands before any free text, which may hold such words too.
    text.write(f"# mass-elastic sheet\n# {said}, in SI units; speed ratio: speed of the mass over that of ")
    text.write(f"{referred_to or drivetrain.nodes[0]}\n")
    writer = csv.writer(text, lineterminator="\n")
    words = {"J": "J referred", "k": "k referred", "by": " referred"} if referred else {"J": "J", "k": "k", "by": ""}
    writer.writerow([heading.format(**words) for heading in _COLUMNS])
    order, held, others = _in_sheet_order(graph)
    for node in order:
        writer.writerow(_mass_row(graph, node, held.get(node), referred))
    for link in others:
        writer.writerow([link.name, "", "", "", link.first, link.second, *_shaft_cells(graph, link, referred)])
    text.writelines(f"# {' '.join(note.split())}\n" for note in export_losses(drivetrain, "sheet").sentences())
    return text.getvalue()


def write_mass_elastic(drivetrain: Drivetrain, path: str | os.PathLike[str], *, referred_to: str | None = None) -> None:
    """Write the mass-elastic sheet of :func:`to_mass_elastic` as a file, whole or not at all."""
    write_text(path, to_mass_elastic(drivetrain, referred_to=referred_to))


def _in_sheet_order(graph: MassElasticGraph) -> tuple[list[str], dict[str, Connection], list[Connection]]:
    """Nodes in the order of a sheet's rows, the connection written in each row, and connections left over.

    Along the main line a row has the shaft to the next one; in a branch, the one back to where it comes from.
    """
    at = graph.connections_at
    ends = [node for node, there in at.items() if len(there) <= 1]
    order: list[str] = []
    held: dict[str, Connection] = {}
    used: set[str] = set()
    # Depth first from a free end: the first way onward is the main line, others are branches.
    stack: list[tuple[str, bool, Connection | None]] = [((ends or list(at))[0], True, None)]
    while stack:
        node, is_main, by = stack.pop()
        if node in order:
            continue
        order.append(node)
        if by is not None:
            used.add(by.name)
            before = by.second if by.first == node else by.first
            holder = before if is_main else node
            held[holder] = by.from_node(holder)
        onward = [connection for connection in at[node] if connection.name not in used]
        stack += [(connection.from_node(node).second, is_main and place == 0, connection)
                  for place, connection in reversed(list(enumerate(onward)))]  # fmt: skip
    return order, held, [connection for connection in graph.connections if connection.name not in used]


def _mass_row(graph: MassElasticGraph, node: str, held: Connection | None, referred: bool) -> Sequence[Any]:
    factor = float(graph.ratios[node]) ** 2 if referred else 1.0
    inertia, damping = graph.inertias[node] * factor, graph.dampings[node] * factor
    row = [node, repr(inertia), repr(damping) if damping else "", _ratio(graph.ratios[node])]
    if held is None:
        return [*row, *[""] * (len(_COLUMNS) - len(row))]
    return [*row, "", held.second, *_shaft_cells(graph, held, referred)]


def _shaft_cells(graph: MassElasticGraph, link: Connection, referred: bool) -> Sequence[str]:
    factor = float(graph.ratios[link.first]) ** 2 if referred else 1.0
    section = ["", ""] if link.diameters is None else [repr(size) if size else "" for size in link.diameters]
    if link.stiffness is None:
        return ["rigid", "", "", *section]
    numbers = [link.damping * factor, link.loss_factor]
    return [repr(link.stiffness * factor), *(repr(number) if number else "" for number in numbers), *section]


def _ratio(ratio: Any) -> str:
    """Speed ratio as text, a fraction of whole numbers where they are small, else the decimals of the nearest float."""
    if isinstance(ratio, Fraction) and max(abs(ratio.numerator), ratio.denominator) < LARGEST_RATIO_TERM:
        return numeral_of(ratio)
    return repr(float(ratio))
