"""Writing of modelDescription.xml of FMI 2.0."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from torsionnet.io.fmu.common_description import (
    ROLE_ATTRIBUTES,
    UNKNOWN_AT_START,
    FmuDescription,
    description_root,
    xml_attributes,
    xml_document,
)
from torsionnet.io.fmu.traced_matrices import Variable

STATES = {"canGetAndSetFMUstate": "true", "canSerializeFMUstate": "true", "providesDirectionalDerivative": "true"}
STEPS = {"canHandleVariableCommunicationStepSize": "true", "canInterpolateInputs": "true"}
KINDS = {"ModelExchange": STATES, "CoSimulation": STEPS | STATES}


def describe(subject: FmuDescription) -> bytes:
    """Bytes of the model description of an FMU for FMI 2.0."""
    about = {"fmiVersion": "2.0", "modelName": subject.title, "guid": subject.token}
    root = description_root(subject, about, KINDS, ["all.c"], _add_variable)
    root.set("numberOfEventIndicators", "0")
    _add_structure(root, subject)
    return xml_document(root)


def _add_variable(table: Element, variable: Variable) -> None:
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


def _add_structure(root: Element, subject: FmuDescription) -> None:
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
