"""Section of a report with the schematic of the drivetrain."""

from __future__ import annotations

from torsionnet.base.phrases import phrase
from torsionnet.report.document_tree import Picture, Section
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_text import as_words, first_names

HALF_PAGE = 135.0
"""Largest height in mm of a part of the schematic: with its caption half a page, so that pages can be filled."""


def schematic_section(subject: ReportData) -> Section:
    """Section of a report with the schematic of the drivetrain in the first configuration.

    A tall one is cut into parts. Others differ in values or switched elements.
    """
    from torsionnet.plot.schematics.schematic import schematic_parts

    case = subject.cases[0]
    rig = case.drivetrain
    where = phrase(", configuration {name}", name=case.configuration) if len(subject.cases) > 1 else ""
    legend = " Discs are inertias; curved arrows mark inputs, dots sensors of motion and diamonds sensors of torque."
    nodes = first_names([as_words(node) for node in rig.nodes])
    alt = f"Schematic of {rig.name}: {len(rig.elements)} elements between the nodes {nodes}"
    parts = schematic_parts(rig, HALF_PAGE)
    pictures = []
    for number, figure in enumerate(parts, 1):
        part = f", part {number} of {len(parts)}" if len(parts) > 1 else ""
        caption = (
            phrase("The drivetrain{where}, part {number} of {count}.", where=where, number=number, count=len(parts))
            if part
            else phrase("The drivetrain{where}.", where=where)
        )
        name = f"schematic_{number}" if part else "schematic"
        pictures.append(Picture(name, figure, (caption, *([legend] if number == 1 else [])), f"{alt}{part}"))
    return Section("schematic", ("Drivetrain",), tuple(pictures))
