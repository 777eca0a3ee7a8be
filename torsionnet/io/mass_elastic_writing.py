"""Writing of drivetrains as mass-elastic sheets (CSV), with a mass and the shaft after it in each row."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from torsionnet.base.atomic import write_text
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.units import numeral_of
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.export_losses import export_losses
from torsionnet.io.mass_elastic_graph import Connection, MassElasticGraph, mass_elastic_graph

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
        raise UsageError(f'no node is named "{referred_to}"{hint}')
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
    order, held, others = _laid_out(graph)
    for node in order:
        writer.writerow(_mass_row(graph, node, held.get(node), referred))
    for one in others:
        writer.writerow([one.name, "", "", "", one.first, one.second, *_shaft_cells(graph, one, referred)])
    text.writelines(f"# {' '.join(note.split())}\n" for note in export_losses(drivetrain, "sheet").sentences())
    return text.getvalue()


def write_mass_elastic(drivetrain: Drivetrain, path: str | os.PathLike[str], *, referred_to: str | None = None) -> None:
    """Write the mass-elastic sheet of :func:`to_mass_elastic` as a file, whole or not at all."""
    write_text(path, to_mass_elastic(drivetrain, referred_to=referred_to))


def _laid_out(graph: MassElasticGraph) -> tuple[list[str], dict[str, Connection], list[Connection]]:
    """Nodes in the order of a sheet's rows, the connection written in each row, and connections left over.

    Along the main line a row has the shaft to the next one; in a branch, the one back to where it comes from.
    """
    at = graph.connections_at
    ends = [node for node, there in at.items() if len(there) <= 1]
    order: list[str] = []
    held: dict[str, Connection] = {}
    used: set[str] = set()
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
        onward = [one for one in at[node] if one.name not in used]
        stack += [(one.from_node(node).second, is_main and place == 0, one)
                  for place, one in reversed(list(enumerate(onward)))]  # fmt: skip
    return order, held, [one for one in graph.connections if one.name not in used]


def _mass_row(graph: MassElasticGraph, node: str, held: Connection | None, referred: bool) -> Sequence[Any]:
    factor = float(graph.ratios[node]) ** 2 if referred else 1.0
    inertia, damping = graph.inertias[node] * factor, graph.dampings[node] * factor
    row = [node, repr(inertia), repr(damping) if damping else "", _ratio(graph.ratios[node])]
    if held is None:
        return [*row, *[""] * (len(_COLUMNS) - len(row))]
    return [*row, "", held.second, *_shaft_cells(graph, held, referred)]


def _shaft_cells(graph: MassElasticGraph, one: Connection, referred: bool) -> Sequence[str]:
    factor = float(graph.ratios[one.first]) ** 2 if referred else 1.0
    section = ["", ""] if one.diameters is None else [repr(size) if size else "" for size in one.diameters]
    if one.stiffness is None:
        return ["rigid", "", "", *section]
    numbers = [one.damping * factor, one.loss_factor]
    return [repr(one.stiffness * factor), *(repr(number) if number else "" for number in numbers), *section]


def _ratio(ratio: Any) -> str:
    """Speed ratio as text, a fraction of whole numbers where they are small, else the decimals of the nearest float."""
    if isinstance(ratio, Fraction) and max(abs(ratio.numerator), ratio.denominator) < LARGEST_RATIO_TERM:
        return numeral_of(ratio)
    return repr(float(ratio))
