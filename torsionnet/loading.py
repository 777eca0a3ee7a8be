"""Loading of drivetrains from model files and texts."""

from __future__ import annotations

import os
from pathlib import Path

from torsionnet.base.errors import Fault, ModelError
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.definition import Definition
from torsionnet.model.files.reader import find_model, read_file, read_text


def load(model: str | os.PathLike[str]) -> Drivetrain:
    """Load the drivetrain of a model file, or a library model by name.

    Parameters
    ----------
    model : str or path
        A ``.yaml``, ``.yml`` or ``.json`` file, or a name out of :func:`library_models`.

    Raises
    ------
    ModelError
        With every fault of the file and its place.
    UsageError
        There is no such file or library model.

    Examples
    --------
    >>> load("dmf_rig").nodes
    ('motor', 'primary', 'secondary')
    """
    path = find_model(model)
    return _drivetrain(*read_file(path), path.name)


def loads(text: str, file: str = "<text>", folder: str | os.PathLike[str] | None = None) -> Drivetrain:
    """Load the drivetrain described by the text of a model file; files that it names lie in ``folder``.

    Examples
    --------
    >>> text = "{torsionnet: 1, name: wheel, elements: {disc: {type: inertia, node: a, inertia: 2}}}"
    >>> loads(text).name
    'wheel'
    """
    return _drivetrain(*read_text(text, file, None if folder is None else Path(folder)), file)


def _drivetrain(definition: Definition | None, faults: list[Fault], title: str) -> Drivetrain:
    if definition is None:
        raise ModelError([fault for fault in faults if fault.severity == "error"], title)
    return Drivetrain.from_definition(definition, faults)
