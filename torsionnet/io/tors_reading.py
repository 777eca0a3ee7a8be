"""Reading of TORS files of openTorsion as drivetrains."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from torsionnet.core.errors import Fault, ModelError, Position, TorsionnetWarning, UsageError
from torsionnet.core.plain_names import Names
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.tors_elements import DENSITY, SHEAR_MODULUS, Entry, TorsDocument, read_document
from torsionnet.model.elements import GROUND, Damper, Element, Gear, Inertia, Shaft, Spring
from torsionnet.model.files.located_yaml import compose

VERSION = "openTorsion 0.3.2"
"""Version of openTorsion whose reading of TORS files is taken as the rule."""


def read_tors(path: str | os.PathLike[str]) -> Drivetrain:
    """Read a model of openTorsion or its editor from a TORS file as a drivetrain.

    Disks become inertias, with a damper or spring to ground where they have one; discrete shafts springs;
    continuous shafts ``Shaft`` elements of one segment with consistent inertia, G = 80 GPa and, where the file says
    nothing, 8000 kg/m^3 as in openTorsion; pairs of gears a ``Gear`` of negative ratio -z_child/z_parent, for
    opposite senses. Nodes are named after the first disk or gear on them. An excitation becomes an input of that
    place; its values are left out.

    Parameters
    ----------
    path : str or path
        A JSON file in the TORS format.

    Returns
    -------
    Drivetrain

    Raises
    ------
    ModelError
        The file is no TORS file, or faulty; everything found is listed.
    UsageError
        There is no such file.

    Warns
    -----
    TorsionnetWarning
        openTorsion 0.3.2 itself would read the file in another way.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "line.tors")
    >>> elements = [{"name": "rotor", "type": "Disk", "inertia": 2, "damping": 0},
    ...     {"name": "shaft", "type": "ShaftDiscrete", "stiffness": 1000, "damping": 1},
    ...     {"name": "load", "type": "Disk", "inertia": 3, "damping": 0}]
    >>> _ = path.write_text(json.dumps({"components": [{"name": "line", "elements": elements}], "structure": []}))
    >>> rig = read_tors(path)
    >>> rig.nodes, list(rig.elements)
    (('rotor', 'load'), ['rotor', 'shaft', 'load'])
    """
    source = Path(path)
    if not source.is_file():
        raise UsageError(f'there is no file "{source}"')
    try:
        data = json.loads(source.read_text(encoding="utf-8-sig"))
    except UnicodeDecodeError:
        raise ModelError([Fault("the file is no text in UTF-8")], source.name) from None
    except RecursionError:
        raise ModelError([Fault("the entries of the file are nested too deep")], source.name) from None
    except json.JSONDecodeError as error:
        line = [*error.doc.split("\n"), ""][error.lineno - 1]  # JSON knows no other end of a line
        place = Position(source.name, error.lineno, error.colno, error.colno + 1, line[:200])
        raise ModelError([Fault(f"this is no JSON: {error.msg}", position=place)], source.name) from None
    try:
        return from_tors(data, source.name)
    except ModelError as error:
        raise ModelError(_placed(error.faults, source), source.name) from None


def _placed(faults: Iterable[Fault], source: Path) -> list[Fault]:
    """Faults of a TORS file with their line and column, for which the JSON is read once more, as YAML."""
    try:
        document = compose(source.read_text(encoding="utf-8-sig"), source.name)
    except ModelError:
        return list(faults)
    return [fault.at(document.position(fault.path)) for fault in faults]


def from_tors(data: Any, file: str = "TORS data") -> Drivetrain:
    """Drivetrain of the JSON data of a TORS file, as :func:`read_tors` gives for the file itself."""
    document, faults = read_document(data)
    if document is None or faults:
        raise ModelError(faults, file)
    builder = _Builder(document)
    builder.component(document.start, None)
    if builder.faults:
        raise ModelError(builder.faults, file)
    elements = builder.elements()
    for text in builder.differences:
        warnings.warn(text, TorsionnetWarning, stacklevel=2)
    return Drivetrain(document.name, elements, inputs=builder.inputs, source=f"TORS file {file}")


class _Place:
    """Node of the drivetrain before it has a name, which becomes the first good one that comes along."""

    def __init__(self, fallback: str) -> None:
        self.name, self.is_named, self.fallback = "", False, fallback


class _Builder:
    """Builder of a drivetrain, which follows the chains of a TORS file's components and collects elements."""

    def __init__(self, document: TorsDocument) -> None:
        self.document = document
        self.names = Names([GROUND])
        self.nodes = Names([GROUND])
        self.short = _short_names(document)
        self.made: list[tuple[str, Entry, tuple[_Place, ...]]] = []
        self.gears: dict[tuple[str, str], tuple[Entry, _Place]] = {}
        self.inputs: dict[str, dict[str, str]] = {}
        self.excited: list[tuple[str, _Place]] = []
        self.faults: list[Fault] = []
        self.differences: list[str] = []

    def component(self, start: str, place: _Place | None) -> None:
        """Add a component and all that begin at its elements, without recursion, so that chains may be long."""
        open_names: list[tuple[str, _Place | None]] = [(start, place)]
        while open_names:
            name, place = open_names.pop()
            entries = self.document.components[name]
            here = place or _Place(f"{name}_start")
            branched = ""
            for entry in entries:
                child = entry.kind == "GearElement" and entry.parent
                if branched and not child:
                    self._differs(f"{entry.label} follows {branched}, at whose end another component begins")
                here = self._entry(entry, here)
                targets = self.document.onward.get((name, entry.name), ())
                if len(targets) > 1:
                    self._differs(f"{len(targets)} components begin at {entry.label}")
                branched = entry.label if targets else ""
                open_names += [(target, here) for target in reversed(targets)]

    def _differs(self, what: str) -> None:
        self.differences.append(f"{what}; {VERSION} takes the wrong node there, this model has the right one")

    def _entry(self, entry: Entry, here: _Place) -> _Place:
        """Add an element of a TORS file that begins at ``here`` and return the place where it ends."""
        end = here
        if entry.kind.startswith("Shaft"):
            end = _Place(f"{self.short[entry.label]}_end")
            self._check_shaft(entry)
        elif entry.parent:
            end = _Place(f"{self.short[entry.label]}")
            self._check_wheels(entry)
        wish = entry.node or ("" if entry.kind.startswith("Shaft") else self.short[entry.label])
        if wish and not end.is_named:
            end.name, end.is_named = wish, True
        if entry.kind == "GearElement":
            parent = self.gears.get((entry.component, entry.parent))
            self.gears[entry.component, entry.name] = (entry, end)
            self.made.append(("gear", entry, (parent[1], end) if parent else (end,)))
        else:
            self.made.append((entry.kind, entry, (here, end) if entry.kind.startswith("Shaft") else (here,)))
        if entry.excited:
            self.excited.append((self.short[entry.label], here if entry.kind.startswith("Shaft") else end))
        return end

    def _check_shaft(self, entry: Entry) -> None:
        values = entry.values
        if values.get("innerDiameter", 0) >= values.get("outerDiameter", float("inf")):
            self.faults.append(Fault("the inner diameter must be smaller than the outer one", entry.path))
        if entry.kind == "ShaftContinuous" and values.get("damping"):
            self.differences.append(f"{entry.label} has damping, which {VERSION} leaves out of continuous shafts")

    def _check_wheels(self, entry: Entry) -> None:
        parent = self.gears[entry.component, entry.parent][0]
        if not _common(parent, entry):
            text = f"{parent.label} and {entry.label} mesh; give both teeth, or both a diameter"
            self.faults.append(Fault(text, entry.path))

    def elements(self) -> list[Element]:
        """Elements in the order of the TORS file, with nodes named on the way, so that each has its first good name."""
        known: dict[_Place, str] = {}
        for _, _, places in self.made:
            for place in places:
                if place not in known:
                    known[place] = self.nodes.new(place.name or place.fallback)
        names = Names()
        self.inputs = {names.new(f"T_{label}"): {"torque": known[place]} for label, place in self.excited}
        return [
            element
            for kind, entry, places in self.made
            for element in self._made(kind, entry, [known[p] for p in places])
        ]

    def _made(self, kind: str, entry: Entry, nodes: list[str]) -> Iterator[Element]:
        label, values = self.short[entry.label], entry.values
        if kind == "ShaftDiscrete" and not values["stiffness"]:
            yield Damper.from_entries(self.names.new(label), nodes=nodes, damping=values.get("damping", 0))
        elif kind == "ShaftDiscrete":
            yield Spring.from_entries(self.names.new(label), nodes=nodes, **_pick(values, "stiffness", "damping"))
        elif kind == "ShaftContinuous":
            yield _continuous(self.names.new(label), nodes, values)
        if kind == "gear" and entry.parent:
            parent = self.gears[entry.component, entry.parent][0]
            yield Gear.from_entries(
                self.names.new(f"{label}_mesh" if values.get("inertia") else label),
                nodes=nodes,
                **_ratio(parent, entry),
            )
        if values.get("inertia") and kind in ("Disk", "gear"):
            yield Inertia.from_entries(self.names.new(label), node=nodes[-1], inertia=values["inertia"])
        if values.get("damping") and kind == "Disk":
            name = f"{label}_damping" if values.get("inertia") else label
            yield Damper.from_entries(self.names.new(name), nodes=(nodes[-1], GROUND), damping=values["damping"])
        if values.get("stiffness") and kind == "Disk":
            self.differences.append(f"{entry.label} has a stiffness to ground, which {VERSION} leaves out of disks")
            yield Spring.from_entries(
                self.names.new(f"{label}_stiffness"), nodes=(nodes[-1], GROUND), stiffness=values["stiffness"]
            )


def _pick(values: Any, *keys: str) -> dict[str, Any]:
    return {key: values[key] for key in keys if values.get(key)}


def _continuous(name: str, nodes: list[str], values: Any) -> Shaft:
    metres = {"outer_diameter": "outerDiameter", "inner_diameter": "innerDiameter", "length": "length"}
    sizes: dict[str, Any] = {ours: f"{values[theirs]!r} mm" for ours, theirs in metres.items() if values.get(theirs)}
    return Shaft.from_entries(
        name, nodes=nodes, shear_modulus=SHEAR_MODULUS, density=values.get("density", DENSITY), segments=1, **sizes,
        **_pick(values, "damping"),
    )  # fmt: skip


def _common(parent: Entry, child: Entry) -> str:
    return next((key for key in ("teeth", "diameter") if key in parent.values and key in child.values), "")


def _ratio(parent: Entry, child: Entry) -> dict[str, Any]:
    """Entries of a gear with the ratio of two wheels, negative as wheels in mesh turn in opposite senses."""
    key = _common(parent, child)
    first, second = parent.values[key], child.values[key]
    if key == "teeth" and first == int(first) and second == int(second):
        return {"teeth": (int(first), -int(second))}
    return {"ratio": f"-{second!r}/{first!r}"}


def _short_names(document: TorsDocument) -> dict[str, str]:
    """Short name of each element by ``component.element``, its own name where no other element has it."""
    entries = [entry for component in document.components.values() for entry in component]
    names = [entry.name for entry in entries]
    return {
        entry.label: entry.name if names.count(entry.name) == 1 else f"{entry.component}_{entry.name}"
        for entry in entries
    }
