"""Sections of a report, in their order, and the kinds of document they belong to."""

from __future__ import annotations

from dataclasses import dataclass

KINDS = {
    "rig": "the model with its equations, modes and transfer functions",
    "approval": "the torsional calculation that a classification society or a customer approves",
}
"""Description of every kind of document that a report may be, by its name."""


@dataclass(frozen=True)
class SectionContent:
    """Description of what a section of a report contains, and the kinds of document that have it unless asked."""

    description: str
    kinds: tuple[str, ...] = ("rig",)


APPROVAL, BOTH = ("approval",), ("rig", "approval")
"""Names of the kinds of document that have a section: the one for approval alone, or each."""

SECTIONS = {
    "conclusion": SectionContent(
        "verdict of every component, operating instructions, and what is not covered", APPROVAL
    ),
    "summary": SectionContent("natural frequencies, damping ratios, static values and peaks at a glance"),
    "conditions": SectionContent("conditions of operation: which were examined, which not and why", APPROVAL),
    "installation": SectionContent(
        "engine, propeller, gear and couplings with data and sources; power, speed and torque along the line", APPROVAL
    ),
    "schematic": SectionContent("the drivetrain drawn", BOTH),
    "elements": SectionContent("elements with their values, inputs and sensors"),
    "parameters": SectionContent("parameters, configurations, operating point"),
    "kinematics": SectionContent("which node follows which, and by what ratio"),
    "equations": SectionContent("equations of motion, M, C and K in symbols and numbers"),
    "mass_elastic": SectionContent("one table of all inertias, shafts and dampers, referred and as they are", APPROVAL),
    "modes": SectionContent("modes of every configuration, energy shares, shapes"),
    "natural_frequencies": SectionContent(
        "natural frequencies, relative amplitudes with nodes drawn, Holzer tables", APPROVAL
    ),
    "formulas": SectionContent("transfer functions in symbols with their limits"),
    "simplified": SectionContent(
        "the same without elements that hardly matter, with the error, if asked for or `simplify` is given"
    ),
    "responses": SectionContent("transfer functions over frequency, overlaid by configuration"),
    "excitations": SectionContent("what runs, at which speeds, and the torques it excites with by order"),
    "harmonics": SectionContent(
        "mean indicated pressure, tangential harmonics, vector sums by mode, misfire, propeller", APPROVAL
    ),
    "mean_torques": SectionContent("mean torque, stress and power of every element under the load"),
    "critical_speeds": SectionContent("orders against natural frequencies, interference diagram, Holzer tables"),
    "resonances": SectionContent(
        "critical speeds with equilibrium amplitude, generalised force, damping shares and stress at the peak", APPROVAL
    ),
    "orders": SectionContent("amplitudes over speed by order, and all orders together, in every configuration"),
    "forced_response": SectionContent(
        "stress or torque over speed of every component in every condition, and the orders of the peaks", APPROVAL
    ),
    "limits": SectionContent(
        "stresses, couplings, gears and dampers against what they bear; barred ranges and the conclusion"
    ),
    "components": SectionContent(
        "rules, factors and sources of shafts, crankshaft, couplings, gears, dampers and generators", APPROVAL
    ),
    "passage": SectionContent(
        "stress and cycles while a barred range of speeds is passed slowly and quickly", APPROVAL
    ),
    "scenarios": SectionContent("motion over time under scenarios: peaks, events, energies, signals drawn", BOTH),
    "measurement_plan": SectionContent(
        "where to measure on board, the amplitudes expected, and measured orders beside them", APPROVAL
    ),
    "test": SectionContent("tests over the model", BOTH),
    "fit": SectionContent("fitted parameters with intervals", BOTH),
    "study": SectionContent("what varies, every quantity over all variants, limits kept, and what is concluded", BOTH),
    "checks": SectionContent("findings of the checks, and how well the numbers agree with a second way to them"),
    "validity": SectionContent("what the results rest on", BOTH),
}
"""Content of every section of a report by the section's name, in the order of the document."""
