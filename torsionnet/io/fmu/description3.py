"""Writing of modelDescription.xml and buildDescription.xml of FMI 3.0."""

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

STATES = {"canGetAndSetFMUState": "true", "canSerializeFMUState": "true", "providesDirectionalDerivatives": "true"}
STEPS = {
    "canHandleVariableCommunicationStepSize": "true",
    "providesIntermediateUpdate": "true",
    "hasEventMode": "true",
}
KINDS = {"ModelExchange": STATES, "CoSimulation": STATES | STEPS}


def describe(subject: FmuDescription) -> bytes:
    """Bytes of the model description of an FMU for FMI 3.0."""
    about = {"fmiVersion": "3.0", "modelName": subject.title, "instantiationToken": subject.token}
    root = description_root(subject, about, KINDS, [], _add_variable)
    _add_structure(root, subject)
    return xml_document(root)


def _add_variable(table: Element, variable: Variable) -> None:
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


def _add_structure(root: Element, subject: FmuDescription) -> None:
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
