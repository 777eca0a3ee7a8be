"""Reading of TORS files of openTorsion as drivetrains."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from torsionnet.base.errors import Fault, ModelError, Position, TorsionnetWarning, UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.tors_building import DrivetrainBuilder
from torsionnet.io.tors_file import TorsFile
from torsionnet.model.files.located_yaml import compose
from torsionnet.model.files.reader import located_faults


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
        text = source.read_text(encoding="utf-8-sig")
        data = json.loads(text)
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
        raise ModelError([Fault(text)], file)
    content, faults = TorsFile.read(data)
    if content is None:
        raise ModelError(faults, file)
    builder = DrivetrainBuilder(content)
    elements, inputs = builder.elements(), builder.inputs()
    for text in builder.differences:
        warnings.warn(text, TorsionnetWarning, stacklevel=2)
    title = content.name if isinstance(content.name, str) else ""
    return Drivetrain(title or "TORS model", elements, inputs=inputs, source=f"TORS file {file}")
