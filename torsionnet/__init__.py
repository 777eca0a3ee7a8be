"""Lumped-parameter torsional models of drivetrains.

Describe a drivetrain as elements between nodes, in a model file or in Python; get natural frequencies, damping ratios,
mode shapes and transfer functions between any two sensors, also against a measured input.

>>> import torsionnet as tn
>>> rig = tn.load("dmf_rig")
>>> rig.modes().natural_frequencies.round(3).tolist()
[7.105, 80.983]
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

__version__ = "0.1.0"

_HOMES = {
    "Adaptive": "solve.grid",
    "Bench": "virtual",
    "Channel": "response",
    "Conventions": "response",
    "Damper": "elements",
    "Differential": "elements",
    "Drivetrain": "drivetrain",
    "Element": "elements",
    "Fault": "errors",
    "Fit": "identification",
    "FrequencyResponse": "response",
    "FrequencyResponses": "response",
    "Gear": "elements",
    "HystereticSpring": "elements",
    "Inertia": "elements",
    "Input": "channels",
    "Lock": "elements",
    "Measurement": "identification",
    "MissingExtraError": "errors",
    "ModelError": "errors",
    "Modes": "response",
    "OperatingPoint": "operating_point",
    "Parameter": "parameters",
    "Planetary": "elements",
    "RigidCoupling": "elements",
    "Sensor": "channels",
    "Shaft": "elements",
    "SolveError": "errors",
    "Spring": "elements",
    "TabulatedSpring": "elements",
    "TorsionnetError": "errors",
    "TorsionnetWarning": "errors",
    "Unknown": "identification",
    "UsageError": "errors",
    "convert_damping": "damping",
    "library_models": "files",
    "identify": "identification",
    "library_benches": "files",
    "load": "loading",
    "load_bench": "virtual",
    "loads": "loading",
    "write_report": "document",
}

_PACKAGES = ("bench", "document", "identification", "interchange", "modal", "report", "sensitivity", "signals", "units")

__all__ = ["__version__", *_HOMES, *_PACKAGES]  # noqa: PLE0604

if TYPE_CHECKING:
    from torsionnet import bench, document, identification, interchange, modal, report, sensitivity, signals, units
    from torsionnet.channels import Input, Sensor
    from torsionnet.damping import convert_damping
    from torsionnet.document import write_report
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.elements import (
        Damper,
        Differential,
        Element,
        Gear,
        HystereticSpring,
        Inertia,
        Lock,
        Planetary,
        RigidCoupling,
        Shaft,
        Spring,
        TabulatedSpring,
    )
    from torsionnet.errors import (
        Fault,
        MissingExtraError,
        ModelError,
        SolveError,
        TorsionnetError,
        TorsionnetWarning,
        UsageError,
    )
    from torsionnet.files import library_benches, library_models
    from torsionnet.identification import Fit, Measurement, Unknown, identify
    from torsionnet.loading import load, loads
    from torsionnet.operating_point import OperatingPoint
    from torsionnet.parameters import Parameter
    from torsionnet.response import Channel, Conventions, FrequencyResponse, FrequencyResponses, Modes
    from torsionnet.solve.grid import Adaptive
    from torsionnet.virtual import Bench, load_bench


def __getattr__(name: str) -> object:
    """Import a public name where it is first used: starting up stays quick."""
    if name in _PACKAGES:
        return importlib.import_module(f"torsionnet.{name}")
    if name not in _HOMES:
        msg = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(msg)
    value = globals()[name] = getattr(importlib.import_module(f"torsionnet.{_HOMES[name]}"), name)
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
