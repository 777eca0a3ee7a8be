"""Writing of functional mock-up units, which are ZIP archives of model description, C sources and libraries."""

from __future__ import annotations

import hashlib
import io
import math
import os
import tempfile
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from torsionnet.base.atomic import write_bytes
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.plain_names import Names
from torsionnet.base.version import __version__
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.export_losses import export_losses
from torsionnet.io.fmu.c_source import compile_libraries, header_source, model_source
from torsionnet.io.fmu.traced_matrices import (
    FMI_UNITS,
    System,
    Variable,
    Variables,
    dependencies,
    list_variables,
    trace_system,
)

# Model descriptions of FMUs: what FMI 2.0 and 3.0 have in common, and what each writes in its own way.

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
    spaced = {name: " ".join(text.split()) for name, text in attributes.items() if text}
    return {name: "".join(filter(str.isprintable, text)) for name, text in spaced.items()}


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


C_SOURCES = (
    "export.h",
    "dense.c",
    "exponential.c",
    "system.c",
    "stepping.c",
    "instance.c",
    "advancing.c",
    "services.c",
)
"""Names of the files of C code that every FMU has, in the folder ``c``."""
VERSION_SOURCES = {
    "2.0": ("fmi2.h", "fmi2.c", "fmi2_modes.c"),
    "3.0": ("fmi3.h", "fmi3.c", "fmi3_modes.c", "fmi3_absent.c"),
}
"""Names of the files of C code by version of FMI, each with its types first, then its functions."""
LONGEST_IDENTIFIER = 60
"""Most characters of a title that go into the model identifier of an FMU, and so into names of files."""


STEPS_PER_PERIOD = 50
"""Steps of an FMU per period of its highest mode, at which inputs that run in straight lines are 0.8 % off."""
HIGHEST_EXCITED = 1000.0
"""Highest natural frequency in Hz that counts for the FMU's step, as what excites a drivetrain lies below."""


def write_fmu(
    drivetrain: Drivetrain, path: str | os.PathLike[str], step: float | None = None, *, version: str = "2.0"
) -> tuple[str, ...]:
    """Write a drivetrain as an FMU for co-simulation and model exchange, and return the names of its platforms.

    Inputs of the FMU are the torque inputs of the model in N m, outputs its sensors in SI units, parameters those of
    the model; angles and speeds at the start are zero unless they are set. In co-simulation, steps of any size are
    exact for inputs that run in straight lines from point to point.

    Parameters
    ----------
    drivetrain : Drivetrain
    path : str or path
        A file ending in .fmu.
    step : float, optional
        The communication step in s that hosts are advised to take. Default: 50 steps per period of the highest mode,
        or of 1 kHz where modes lie beyond.
    version : str
        Version of FMI: ``"2.0"`` or ``"3.0"``.

    Returns
    -------
    tuple of str
        The platforms the FMU has binaries for: five with the package ziglang, else the one it is written on.

    Raises
    ------
    UsageError
        No inputs or sensors, frequency-dependent laws, an imposed angle, a reading with the rate of an input in it,
        over 400 coordinates, a step that is not positive, another version or another ending.
    MissingExtraError
        There is no C compiler.

    Notes
    -----
    The FMU holds its sources. Equal drivetrains give equal bytes on one machine.

    Examples
    --------
    >>> import torsionnet as tn
    >>> path = Path(tempfile.mkdtemp(), "rig.fmu")
    >>> platforms = write_fmu(tn.load("dmf_rig"), path)
    >>> "sources/model.c" in zipfile.ZipFile(path).namelist()
    True
    """
    _refuse(path, step, version)
    system = trace_system(drivetrain)
    variables = list_variables(drivetrain, system)
    sources = _sources(version)
    body = model_source(system, variables, drivetrain.title)
    chosen = suggested_step(drivetrain) if step is None else float(step)
    identifier = Names().new(drivetrain.title[:LONGEST_IDENTIFIER])
    subject = _subject(drivetrain, system, variables, identifier, chosen, token="")
    token = _token(_description(subject, version), body, *sources.values())
    sources |= {"model.h": header_source(system, variables, token), "model.c": body}
    with tempfile.TemporaryDirectory(prefix="torsionnet_") as folder:
        made = compile_libraries(sources, identifier, version, Path(folder))
    subject = _subject(drivetrain, system, variables, identifier, chosen, token)
    files = {"modelDescription.xml": _description(subject, version), **made}
    files |= {f"sources/{name}": text.encode("ascii") for name, text in sources.items()}
    if version == "3.0":
        files["sources/buildDescription.xml"] = describe_build(identifier)
    write_bytes(path, _archive(files))
    return tuple(dict.fromkeys(name.split("/")[1] for name in made))


def _refuse(path: str | os.PathLike[str], step: float | None, version: str) -> None:
    if Path(path).suffix.lower() != ".fmu":
        raise UsageError(f'cannot write "{path}": give a file ending in .fmu', kind="wrong-file")
    if step is not None and not (isinstance(step, int | float) and math.isfinite(step) and step > 0):
        raise UsageError(f"the communication step is a positive time in s, got {step}", kind="out-of-range")
    if version not in VERSION_SOURCES:
        hint = did_you_mean(version, VERSION_SOURCES)
        raise UsageError(
            f'there are FMUs of version {" and ".join(VERSION_SOURCES)}, not "{version}"{hint}', kind="unknown-word"
        )


def _sources(version: str) -> dict[str, str]:
    """C sources of an FMU that are the same for all models, by name of the file."""
    folder = resources.files("torsionnet.io.fmu") / "c"
    names = (*C_SOURCES, *VERSION_SOURCES[version])
    sources = {name: (folder / name).read_text(encoding="ascii") for name in names}
    types, *functions = VERSION_SOURCES[version]
    unit = (folder / "all.c").read_text(encoding="ascii").replace("@TYPES@", types)
    sources["all.c"] = unit.replace("@FUNCTIONS@", "\n".join(f'#include "{name}"' for name in functions))
    return sources


def _subject(
    drivetrain: Drivetrain, system: System, variables: Variables, identifier: str, step: float, token: str
) -> FmuDescription:
    about = " ".join(filter(None, (drivetrain.description, *export_losses(drivetrain, "fmu").sentences())))
    return FmuDescription(
        drivetrain.title, identifier, about, __version__, token, step, variables, dependencies(system)
    )


def _description(subject: FmuDescription, version: str) -> bytes:
    return describe_fmi2(subject) if version == "2.0" else describe_fmi3(subject)


def _token(description: bytes, *texts: str) -> str:
    """Token of an FMU, a digest of all that is in it in the form of a GUID, different for any other content."""
    digest = hashlib.sha256(description + "".join(texts).encode()).hexdigest()
    return f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:32]}}}"


def _archive(files: Mapping[str, bytes]) -> bytes:
    """Bytes of a ZIP archive of the files, in alphabetical order and without today's date."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name)
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, files[name], zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


def suggested_step(drivetrain: Drivetrain) -> float:
    """Communication step in s that hosts of the FMU are advised to take, 1, 2 or 5 times a power of ten.

    Examples
    --------
    >>> import torsionnet as tn
    >>> suggested_step(tn.load("dmf_rig"))
    0.0002
    """
    frequencies = drivetrain.modes().natural_frequencies
    highest = max((float(f) for f in frequencies if math.isfinite(f) and 0 < f <= HIGHEST_EXCITED), default=0.0)
    if any(f > HIGHEST_EXCITED for f in frequencies):
        highest = HIGHEST_EXCITED
    longest = 1 / (STEPS_PER_PERIOD * (highest or 1.0))
    power = math.floor(math.log10(longest))
    return next(float(f"{digit}e{power}") for digit in (5, 2, 1) if digit * 10.0**power <= longest * (1 + 1e-9))
