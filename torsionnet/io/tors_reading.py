"""Reading of TORS files of openTorsion as drivetrains."""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import Fault, ModelError, Position, UsageError, warn_user
from torsionnet.base.plain_names import Names
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.tors_file import (
    SHEAR_MODULUS,
    Disk,
    GearElement,
    ShaftContinuous,
    ShaftDiscrete,
    TorsElement,
    TorsFile,
)
from torsionnet.model.elements import GROUND, Damper, Element, Gear, Inertia, Shaft, Spring
from torsionnet.model.files.fault_places import located_faults
from torsionnet.model.files.located_yaml import compose

# Elements, nodes and inputs of the drivetrain that a TORS file describes.

VERSION = "openTorsion 0.3.2"
"""Version of openTorsion whose reading of TORS files is taken as the rule."""


@dataclass(eq=False)
class _Place:
    """Node of the drivetrain before it has a name, which becomes the first good one that comes along."""

    fallback: str
    name: str = ""


@dataclass(frozen=True, eq=False)
class _Piece:
    """Element of a TORS file as ``component.element``, where it begins and ends, and the wheel it meshes with."""

    path: str
    element: TorsElement
    begin: _Place
    end: _Place
    parent: GearElement | None


class DrivetrainBuilder:
    """Builder of a drivetrain, which follows the chains of a TORS file's components and collects elements."""

    def __init__(self, content: TorsFile) -> None:
        self.content = content
        self.names = Names([GROUND])
        self.labels = _labels(content)
        self.pieces: list[_Piece] = []
        self.differences: list[str] = []
        self._follow(content.starts[0])
        nodes = Names([GROUND])
        places = dict.fromkeys(place for piece in self.pieces for place in (piece.begin, piece.end))
        self.nodes = {place: nodes.new(place.name or place.fallback) for place in places}

    def _follow(self, start: str) -> None:
        """Add a component and all that begin at its elements, without recursion, so that chains may be long."""
        open_names = [(start, _Place(f"{start}_start"))]
        while open_names:
            name, here = open_names.pop()
            branched = ""
            wheels: dict[str, tuple[GearElement, _Place]] = {}
            for element in self.content.chains[name]:
                path = f"{name}.{element.name}"
                parent, begin = None, here
                # A gear wheel begins where the wheel that drives it ends, not at the element before.
                if isinstance(element, GearElement) and element.parent:
                    parent, begin = wheels[element.parent]
                elif branched:
                    self._differs(f"{path} follows {branched}, at whose end another component begins")
                here = self._end(path, element, here, is_new=element.is_shaft or parent is not None)
                if isinstance(element, GearElement):
                    wheels[element.name] = (element, here)
                self.pieces.append(_Piece(path, element, begin, here, parent))
                targets = self.content.onward.get((name, element.name), ())
                if len(targets) > 1:
                    self._differs(f"{len(targets)} components begin at {path}")
                branched = path if targets else ""
                open_names += [(target, here) for target in reversed(targets)]

    def _differs(self, what: str) -> None:
        self.differences.append(f"{what}; {VERSION} takes the wrong node there, this model has the right one")

    def _end(self, path: str, element: TorsElement, here: _Place, *, is_new: bool) -> _Place:
        """Place where an element ends, named after it where a name is still wanted."""
        label = self.labels[path]
        end = _Place(f"{label}_end" if element.is_shaft else label) if is_new else here
        wish = element.node if isinstance(element.node, str) else ""
        end.name = end.name or wish or ("" if element.is_shaft else label)
        return end

    def inputs(self) -> dict[str, dict[str, str]]:
        """Inputs of the drivetrain by name, the torques on excited elements."""
        names = Names()
        return {
            names.new(f"T_{self.labels[piece.path]}"): {"torque": self.nodes[place]}
            for piece in self.pieces
            if piece.element.excitation is not None
            for place in [piece.begin if piece.element.is_shaft else piece.end]
        }

    def elements(self) -> list[Element]:
        """Elements of the drivetrain in the order of the TORS file."""
        return [element for piece in self.pieces for element in self._made(piece)]

    def _made(self, piece: _Piece) -> Iterator[Element]:
        label, new = self.labels[piece.path], self.names.new
        nodes = (self.nodes[piece.begin], self.nodes[piece.end])
        match piece.element:
            case ShaftDiscrete(stiffness=0, damping=damping):
                yield Damper.from_entries(new(label), nodes=nodes, damping=damping)
            case ShaftDiscrete() as shaft:
                yield Spring.from_entries(new(label), nodes=nodes, stiffness=shaft.stiffness, **_damping(shaft))
            case ShaftContinuous() as shaft:
                if shaft.damping:
                    text = f"{piece.path} has damping, which {VERSION} leaves out of continuous shafts"
                    self.differences.append(text)
                yield _continuous(new(label), nodes, shaft)
            case GearElement() as wheel:
                if piece.parent:
                    name = f"{label}_mesh" if wheel.inertia else label
                    yield Gear.from_entries(new(name), nodes=nodes, **_ratio(piece.parent, wheel))
                if wheel.inertia:
                    yield Inertia.from_entries(new(label), node=nodes[1], inertia=wheel.inertia)
            case Disk() as disk:
                yield from self._disk(piece.path, disk, nodes[1])

    def _disk(self, path: str, disk: Disk, node: str) -> Iterator[Element]:
        label, new, nodes = self.labels[path], self.names.new, (node, GROUND)
        if disk.inertia:
            yield Inertia.from_entries(new(label), node=node, inertia=disk.inertia)
        if disk.damping:
            name = f"{label}_damping" if disk.inertia else label
            yield Damper.from_entries(new(name), nodes=nodes, damping=disk.damping)
        if disk.stiffness:
            self.differences.append(f"{path} has a stiffness to ground, which {VERSION} leaves out of disks")
            yield Spring.from_entries(new(f"{label}_stiffness"), nodes=nodes, stiffness=disk.stiffness)


def _damping(shaft: ShaftDiscrete | ShaftContinuous) -> dict[str, Any]:
    return {"damping": shaft.damping} if shaft.damping else {}


def _continuous(name: str, nodes: tuple[str, str], shaft: ShaftContinuous) -> Shaft:
    metres = {"outer_diameter": shaft.outerDiameter, "inner_diameter": shaft.innerDiameter, "length": shaft.length}
    sizes: dict[str, Any] = {key: f"{size!r} mm" for key, size in metres.items() if size}
    return Shaft.from_entries(
        name, nodes=nodes, shear_modulus=SHEAR_MODULUS, density=shaft.density, segments=1, **sizes, **_damping(shaft)
    )


def _ratio(parent: GearElement, child: GearElement) -> dict[str, Any]:
    """Entries of a gear with the ratio of two wheels, negative as wheels in mesh turn in opposite senses."""
    first, second = not_none(child.sizes_against(parent))
    if parent.teeth and child.teeth and first == int(first) and second == int(second):
        return {"teeth": (int(first), -int(second))}
    return {"ratio": f"-{second!r}/{first!r}"}


def _labels(content: TorsFile) -> dict[str, str]:
    """Label of each element by ``component.element``, its own name where no other element has it."""
    counts = Counter(element for _, element in content.ends.values())
    return {
        path: element if counts[element] == 1 else f"{component}_{element}"
        for path, (component, element) in content.ends.items()
    }


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
        raise UsageError(f'there is no file "{source}"', kind="missing-file")
    try:
        text = source.read_text(encoding="utf-8-sig")
        data = json.loads(text)
    except UnicodeDecodeError:
        raise ModelError([Fault("the file is no text in UTF-8", kind="unreadable-file")], source.name) from None
    except RecursionError:
        raise ModelError(
            [Fault("the entries of the file are nested too deep", kind="too-large")], source.name
        ) from None
    except json.JSONDecodeError as error:
        line = [*error.doc.split("\n"), ""][error.lineno - 1]  # JSON knows no other end of a line
        place = Position(source.name, error.lineno, error.colno, error.colno + 1, line[:200])
        raise ModelError(
            [Fault(f"this is no JSON: {error.msg}", position=place, kind="wrong-file")], source.name
        ) from None
    try:
        return from_tors(data, source.name)
    except ModelError as error:
        raise ModelError(_placed(error.faults, text, source.name), source.name) from None


def _placed(faults: tuple[Fault, ...], text: str, file: str) -> list[Fault]:
    """Faults of a TORS file with their line and column, for which the JSON is read once more, as YAML."""
    try:
        return located_faults(faults, compose(text, file))
    except ModelError:
        return [*faults]


def from_tors(data: Any, file: str = "TORS data") -> Drivetrain:
    """Drivetrain of the JSON data of a TORS file, as :func:`read_tors` gives for the file itself."""
    if not isinstance(data, Mapping) or not isinstance(data.get("components"), list):
        text = 'this is no TORS file: it has no list of "components" (elements) and "structure" (connections)'
        raise ModelError([Fault(text, kind="wrong-file")], file)
    content, faults = TorsFile.read(data)
    if content is None:
        raise ModelError(faults, file)
    builder = DrivetrainBuilder(content)
    elements, inputs = builder.elements(), builder.inputs()
    for text in builder.differences:
        warn_user(text)
    title = content.name if isinstance(content.name, str) else ""
    return Drivetrain(title or "TORS model", elements, inputs=inputs, source=f"TORS file {file}")
