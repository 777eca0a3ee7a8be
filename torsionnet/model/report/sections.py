"""Sections of a report, in their order."""

from __future__ import annotations

SECTIONS = {
    "summary": "natural frequencies, damping ratios, static values and peaks at a glance",
    "schematic": "the drivetrain drawn",
    "elements": "elements with their values, inputs and sensors",
    "parameters": "parameters, configurations, operating point",
    "kinematics": "which node follows which, and by what ratio",
    "equations": "equations of motion, M, C and K in symbols and numbers",
    "modes": "modes of every configuration, energy shares, shapes",
    "formulas": "transfer functions in symbols with their limits",
    "simplified": "the same without elements that hardly matter, with the error, if asked for or `simplify` is given",
    "responses": "transfer functions over frequency, overlaid by configuration",
    "excitations": "what runs, at which speeds, and the torques it excites with by order",
    "mean_torques": "mean torque, stress and power of every element under the load",
    "critical_speeds": "orders against natural frequencies, interference diagram, Holzer tables",
    "orders": "amplitudes over speed by order, and all orders together, in every configuration",
    "limits": "stresses, couplings, gears and dampers against what they bear; barred ranges and the conclusion",
    "test": "tests over the model",
    "fit": "fitted parameters with intervals",
    "study": "what varies, every quantity over all variants, limits kept, and what is concluded",
    "checks": "findings of the checks, and how well the numbers agree with a second way to them",
    "validity": "what the results rest on",
}
"""Description of what every section of a report contains, by the section's name."""
