"""Groups of a schematic in SVG, one for each part of a drivetrain, with ids and titles for screen readers."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from torsionnet.model.elements import GROUND, Element
from torsionnet.plot.drawing.labels import value_lines
from torsionnet.plot.drawing.pieces import Label, Owner, Piece, Stroke
from torsionnet.plot.drawing.symbol_runs import symbol_runs
from torsionnet.plot.schematics.epicyclic import epicyclic_sets

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


@dataclass
class SvgGroup:
    """Group of a schematic in SVG with what it draws and the groups of parts that its symbol hides.

    Its kind is ``element``, ``node``, ``input`` or ``sensor``.
    """

    kind: str
    name: str
    id: str
    words: str
    """Classes of the group: its kind, and the type of an element."""
    title: str
    strokes: list[Stroke] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)
    hides: list[Owner] = field(default_factory=list)
    """Owners whose symbol this one is too, as the planets in the box of a planetary set."""
    within: Owner | None = None
    """Owner in whose symbol this one is hidden."""


def drawn_groups(model: Drivetrain, whole: Piece) -> dict[Owner, SvgGroup]:
    """Groups of a drawing by kind and name, nodes first so that symbols of elements lie over shafts."""
    ids: set[str] = set()
    found = {
        Owner(kind, name): SvgGroup(kind, name, _id(kind, name, ids), words, title)
        for kind, name, words, title in _parts(model)
    }
    _hide(model, found)
    for stroke in whole.strokes:
        if stroke.owner in found:
            found[stroke.owner].strokes.append(stroke)
    for label in whole.labels:
        if label.owner in found:
            found[label.owner].labels.append(label)
    return found


def _parts(model: Drivetrain) -> list[tuple[str, str, str, str]]:
    """Rows (kind, name, classes, title) of all parts of a drivetrain."""
    values = model.exact_values
    return [
        *(("node", name, "node", f"node {name}") for name in model.nodes),
        *(
            ("element", name, f"element {one.kind}", _element_title(one, values))
            for name, one in model.elements.items()
        ),
        *(("input", name, "input", f"input {name}: {one.quantity} on {one.of}") for name, one in model.inputs.items()),
        *(
            ("sensor", name, "sensor", f"sensor {name}: {one.quantity} of {one.of}")
            for name, one in model.sensors.items()
        ),
    ]


def _element_title(element: Element, values: Any) -> str:
    """Title of an element, as "shaft_1, spring, gearbox to car: k_1 = 460 N·m/rad"."""
    ends = [node for node in dict.fromkeys(element.ports.values()) if node != GROUND]
    joined = " to ".join(ends) + (" to ground" if GROUND in element.ports.values() and ends else "")
    lines = ", ".join(_plain(line) for line in value_lines(element, values))
    return f"{element.name}, {element.kind.replace('_', ' ')}, {joined}{': ' if lines else ''}{lines}"


def _plain(text: str) -> str:
    r"""Text of a label without its markup for symbols.

    >>> _plain("$k_{\\mathrm{1}}$ = 460 N·m/rad")
    'k_1 = 460 N·m/rad'
    """
    return "".join(f"_{run.text}" if run.style == "index" else run.text for run in symbol_runs(text))


def _id(kind: str, name: str, taken: set[str]) -> str:
    """Id of a group, in which other characters than letters, digits, dots and lines stand as their codes."""
    plain = re.sub(r"[^A-Za-z0-9_.-]", lambda match: f"_{ord(match[0]):x}_", name)
    found, number = f"{kind}-{plain}", 1
    while found in taken:
        number += 1
        found = f"{kind}-{plain}-{number}"
    taken.add(found)
    return found


def _hide(model: Drivetrain, found: dict[Owner, SvgGroup]) -> None:
    """Note which elements and nodes have no symbol of their own: those in a planetary set, nodes within an element."""
    hidden: list[tuple[Owner, Owner]] = []
    for drawn in epicyclic_sets(model):
        box = Owner("element", drawn.name)
        hidden += [(Owner("element", one.name), box) for one in drawn.elements if one.name != drawn.name]
        hidden += [(Owner("node", node), box) for node in drawn.planets]
    for name, element in model.elements.items():
        hidden += [(Owner("node", node), Owner("element", name)) for node in element.internal_nodes]
    for inner, outer in hidden:
        if inner in found and found[inner].within is None:
            drawn_in = outer
            while (further := found[drawn_in].within) is not None:
                drawn_in = further
            found[inner].within = drawn_in
            found[drawn_in].hides.append(inner)
