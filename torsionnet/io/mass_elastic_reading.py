"""Reading of makers' mass-elastic sheets as drivetrains."""

from __future__ import annotations

import os
from pathlib import Path

from torsionnet.base.errors import UsageError, did_you_mean, readable_text
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.elements.mass_elastic import sheet_elements
from torsionnet.model.sheets.factor_readings import READINGS
from torsionnet.model.sheets.mass_elastic_sheet import SIDES, MassElasticSheet, SheetReading, read_sheet


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
            raise UsageError(f'{name} is {" or ".join(allowed)}, not "{value}"{did_you_mean(value, allowed)}')
    if not source.is_file():
        raise UsageError(f'there is no file "{source}"')
    return read_sheet(source, reading=SheetReading(values, factors))


def sheet_drivetrain(sheet: MassElasticSheet) -> Drivetrain:
    """Drivetrain of a mass-elastic sheet that was read, its nodes named after the masses."""
    nodes = {mass.name: mass.name for mass in sheet.masses}
    title = readable_text(Path(sheet.file).stem.replace("_", " "))
    return Drivetrain(
        title, list(sheet_elements(sheet, nodes)), source=f"mass-elastic sheet {readable_text(sheet.file)}"
    )
