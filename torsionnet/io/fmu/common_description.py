"""Model descriptions of FMUs, with what FMI 2.0 and 3.0 have in common."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from torsionnet.io.fmu.traced_matrices import FMI_UNITS, Variable, Variables

ROLE_ATTRIBUTES: Mapping[str, Mapping[str, str]] = {
    "time": {"causality": "independent", "variability": "continuous"},
    "input": {"causality": "input", "variability": "continuous"},
    "output": {"causality": "output", "variability": "continuous", "initial": "calculated"},
    "state": {"causality": "local", "variability": "continuous", "initial": "exact"},
    "rate": {"causality": "local", "variability": "continuous", "initial": "calculated"},
    "parameter": {"causality": "parameter", "variability": "fixed", "initial": "exact"},
    "derived": {"causality": "calculatedParameter", "variability": "fixed", "initial": "calculated"},
    "settled": {"causality": "local", "variability": "constant", "initial": "exact"},
    "flag": {"causality": "parameter", "variability": "fixed", "initial": "exact"},
}
"""Attributes causality, variability and initial of an FMU's variable, by its role."""
UNKNOWN_AT_START = ("output", "rate", "derived")
"""Roles of variables that a host has to calculate when it initialises the FMU."""


@dataclass(frozen=True)
class FmuDescription:
    """Content of an FMU's model description, its title, variables, dependencies and default step in s.

    Attributes
    ----------
    title, identifier, description, version, token : str
    step : float
        Communication step in s.
    variables : Variables
    dependencies : dict
        Reference of an output or a rate -> references of the states and inputs it takes.
    """

    title: str
    identifier: str
    description: str
    version: str
    token: str
    step: float
    variables: Variables
    dependencies: Mapping[int, tuple[int, ...]]


def description_root(
    subject: FmuDescription,
    about: Mapping[str, str],
    kinds: Mapping[str, Mapping[str, str]],
    sources: Sequence[str],
    add_variable: Callable[[Element, Variable], None],
) -> Element:
    """XML tree of an FMU's model description.

    ``about`` are attributes of its root, ``kinds`` the modes it can be run in.
    """
    common = {
        "description": subject.description,
        "generationTool": f"torsionnet {subject.version}",
        "variableNamingConvention": "flat",
    }
    root = Element("fmiModelDescription", xml_attributes({**about, **common}))
    for kind, abilities in kinds.items():
        entry = SubElement(root, kind, {"modelIdentifier": subject.identifier, **abilities})
        for name in sources:
            SubElement(SubElement(entry, "SourceFiles"), "File", name=name)
    _add_units(root, subject.variables)
    SubElement(SubElement(root, "LogCategories"), "Category", name="logStatusError")
    SubElement(root, "DefaultExperiment", startTime="0", stepSize=repr(subject.step))
    table = SubElement(root, "ModelVariables")
    for variable in subject.variables.all:
        add_variable(table, variable)
    return root


def _add_units(root: Element, variables: Variables) -> None:
    units = SubElement(root, "UnitDefinitions")
    for name in variables.units:
        unit = SubElement(units, "Unit", name=name)
        SubElement(unit, "BaseUnit", {base: str(power) for base, power in FMI_UNITS[name].items()})


def xml_attributes(attributes: Mapping[str, str]) -> dict[str, str]:
    """Attributes by name that are not empty, each on one line and without characters that XML cannot hold."""
    return {name: _plain(text) for name, text in attributes.items() if text}


def _plain(text: str) -> str:
    return "".join(sign for sign in " ".join(text.split()) if sign.isprintable())


def xml_document(root: Element) -> bytes:
    """Bytes of an XML document as it stands in the archive of an FMU."""
    indent(root)
    text = tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'.encode()
