"""Reading of makers' mass-elastic sheets as drivetrains."""

from __future__ import annotations

import os
from pathlib import Path

from torsionnet.core.errors import UsageError, readable_text
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.elements.mass_elastic import sheet_elements
from torsionnet.model.sheets.mass_elastic_sheet import MassElasticSheet, read_sheet


def read_mass_elastic(path: str | os.PathLike[str]) -> Drivetrain:
    """Read a maker's mass-elastic sheet (CSV, or what a spreadsheet program saves as text) as a drivetrain.

    Masses become inertias on nodes of their names, shafts springs, changes of speed gears. What was taken as what is in
    :func:`mass_elastic_report`.

    Raises
    ------
    ModelError
        With the row and column of every fault.
    UsageError
        There is no such file.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "engine.csv")
    >>> _ = path.write_text("mass;J [kg m²];k [MNm/rad]\\ncyl 1;0,45;2,1\\nflywheel;14;", encoding="utf-8")
    >>> engine = read_mass_elastic(path)
    >>> engine.nodes, list(engine.elements)
    (('cyl_1', 'flywheel'), ['cyl_1', 'flywheel', 'cyl_1_to_flywheel'])
    """
    return sheet_drivetrain(mass_elastic_report(path))


def mass_elastic_report(path: str | os.PathLike[str]) -> MassElasticSheet:
    """Content of a mass-elastic sheet, whose ``report()`` is the table of what was taken as what, in which unit."""
    source = Path(path)
    if not source.is_file():
        raise UsageError(f'there is no file "{source}"')
    return read_sheet(source)


def sheet_drivetrain(sheet: MassElasticSheet) -> Drivetrain:
    """Drivetrain of a mass-elastic sheet that was read, its nodes named after the masses."""
    nodes = {mass.name: mass.name for mass in sheet.masses}
    title = readable_text(Path(sheet.file).stem.replace("_", " "))
    return Drivetrain(
        title, list(sheet_elements(sheet, nodes)), source=f"mass-elastic sheet {readable_text(sheet.file)}"
    )
