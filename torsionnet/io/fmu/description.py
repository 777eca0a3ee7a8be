"""Model descriptions of FMUs: what FMI 2.0 and 3.0 have in common, and what each writes in its own way."""

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


# modelDescription.xml of FMI 2.0.

STATES_2 = {"canGetAndSetFMUstate": "true", "canSerializeFMUstate": "true", "providesDirectionalDerivative": "true"}
STEPS_2 = {"canHandleVariableCommunicationStepSize": "true", "canInterpolateInputs": "true"}
KINDS_2 = {"ModelExchange": STATES_2, "CoSimulation": STEPS_2 | STATES_2}


def describe_fmi2(subject: FmuDescription) -> bytes:
    """Bytes of the model description of an FMU for FMI 2.0."""
    about = {"fmiVersion": "2.0", "modelName": subject.title, "guid": subject.token}
    root = description_root(subject, about, KINDS_2, ["all.c"], _add_variable2)
    root.set("numberOfEventIndicators", "0")
    _add_structure2(root, subject)
    return xml_document(root)


def _add_variable2(table: Element, variable: Variable) -> None:
    about = {"name": variable.name, "valueReference": str(variable.reference), "description": variable.description}
    entry = SubElement(table, "ScalarVariable", xml_attributes({**about, **ROLE_ATTRIBUTES[variable.role]}))
    if variable.role == "flag":
        SubElement(entry, "Boolean", start="true")
        return
    numbers = {
        "unit": variable.unit,
        "start": "" if variable.start is None else repr(variable.start),
        "derivative": "" if variable.of is None else _index(variable.of),
    }
    SubElement(entry, "Real", xml_attributes(numbers))


def _add_structure2(root: Element, subject: FmuDescription) -> None:
    structure = SubElement(root, "ModelStructure")
    for kind, role in (("Outputs", "output"), ("Derivatives", "rate")):
        variables = subject.variables.of(role)
        unknowns = SubElement(structure, kind) if variables else structure  # the standard has no empty list
        for variable in variables:
            takes = " ".join(_index(reference) for reference in subject.dependencies[variable.reference])
            SubElement(unknowns, "Unknown", index=_index(variable.reference), dependencies=takes)
    initial = SubElement(structure, "InitialUnknowns")
    for variable in subject.variables.of(*UNKNOWN_AT_START):
        SubElement(initial, "Unknown", index=_index(variable.reference))


def _index(reference: int) -> str:
    """Index of an FMU's variable as FMI 2.0 counts, from 1 in the order of the references."""
    return str(reference + 1)


# modelDescription.xml and buildDescription.xml of FMI 3.0.

STATES_3 = {"canGetAndSetFMUState": "true", "canSerializeFMUState": "true", "providesDirectionalDerivatives": "true"}
STEPS_3 = {
    "canHandleVariableCommunicationStepSize": "true",
    "providesIntermediateUpdate": "true",
    "hasEventMode": "true",
}
KINDS_3 = {"ModelExchange": STATES_3, "CoSimulation": STATES_3 | STEPS_3}


def describe_fmi3(subject: FmuDescription) -> bytes:
    """Bytes of the model description of an FMU for FMI 3.0."""
    about = {"fmiVersion": "3.0", "modelName": subject.title, "instantiationToken": subject.token}
    root = description_root(subject, about, KINDS_3, [], _add_variable3)
    _add_structure3(root, subject)
    return xml_document(root)


def _add_variable3(table: Element, variable: Variable) -> None:
    about = {
        "name": variable.name,
        "valueReference": str(variable.reference),
        "description": variable.description,
        **ROLE_ATTRIBUTES[variable.role],
    }
    if variable.role == "flag":
        SubElement(table, "Boolean", xml_attributes({**about, "start": "true"}))
        return
    numbers = {
        "unit": variable.unit,
        "start": "" if variable.start is None else repr(variable.start),
        "derivative": "" if variable.of is None else str(variable.of),
        "intermediateUpdate": "true" if variable.role == "input" else "",
    }
    SubElement(table, "Float64", xml_attributes({**about, **numbers}))


def _add_structure3(root: Element, subject: FmuDescription) -> None:
    structure = SubElement(root, "ModelStructure")
    for kind, role in (("Output", "output"), ("ContinuousStateDerivative", "rate")):
        for variable in subject.variables.of(role):
            takes = " ".join(map(str, subject.dependencies[variable.reference]))
            SubElement(structure, kind, valueReference=str(variable.reference), dependencies=takes)
    for variable in subject.variables.of(*UNKNOWN_AT_START):
        SubElement(structure, "InitialUnknown", valueReference=str(variable.reference))


def describe_build(identifier: str) -> bytes:
    """Bytes of buildDescription.xml of an FMU, which says how the C sources are compiled."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = SubElement(root, "BuildConfiguration", modelIdentifier=identifier)
    SubElement(SubElement(configuration, "SourceFileSet", language="C99"), "SourceFile", name="all.c")
    return xml_document(root)
