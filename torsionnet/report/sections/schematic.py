"""Section of a report with the schematic of the drivetrain."""

from __future__ import annotations

from torsionnet.report.document_tree import Picture, Section
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_text import as_words, first_names


def schematic_section(subject: ReportData) -> Section:
    """Section of a report with the schematic of the drivetrain in the first configuration.

    Others differ in values or switched elements.
    """
    from torsionnet.plot.schematic.schematic import schematic

    case = subject.cases[0]
    rig = case.drivetrain
    where = f", configuration {case.configuration}" if len(subject.cases) > 1 else ""
    caption = (
        f"The drivetrain{where}. Discs are inertias; curved arrows mark inputs, dots sensors of motion and diamonds "
        "sensors of torque."
    )
    nodes = first_names([as_words(node) for node in rig.nodes])
    alt = f"Schematic of {rig.name}: {len(rig.elements)} elements between the nodes {nodes}"
    return Section("schematic", ("Drivetrain",), (Picture("schematic", schematic(rig, title=""), (caption,), alt),))
