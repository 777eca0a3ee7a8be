"""Lumped-parameter torsional models of drivetrains.

Describe a drivetrain as elements between nodes, in a model file or in Python; get natural frequencies, damping ratios,
mode shapes and transfer functions between any two sensors, also against a measured input.

>>> import torsionnet as tn
>>> rig = tn.load("dmf_rig")
>>> rig.modes().natural_frequencies.round(3).tolist()
[7.105, 80.983]
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

from torsionnet.core.lazy import names_on_demand
from torsionnet.core.version import __version__

_HOMES = {
    "Adaptive": "torsionnet.solve.responses.grid",
    "Bench": "torsionnet.bench",
    "Channel": "torsionnet.response",
    "Conventions": "torsionnet.response",
    "Drivetrain": "torsionnet.drivetrain",
    "Element": "torsionnet.model.elements",
    "Fault": "torsionnet.core.errors",
    "Fit": "torsionnet.identification",
    "FrequencyResponse": "torsionnet.response",
    "FrequencyResponses": "torsionnet.response",
    "Input": "torsionnet.model.channels",
    "Measurement": "torsionnet.identification",
    "MissingExtraError": "torsionnet.core.errors",
    "ModelError": "torsionnet.core.errors",
    "Modes": "torsionnet.response",
    "OperatingPoint": "torsionnet.model.operating_point",
    "Parameter": "torsionnet.model.parameters",
    "Sensor": "torsionnet.model.channels",
    "SolveError": "torsionnet.core.errors",
    "TorsionnetError": "torsionnet.core.errors",
    "TorsionnetWarning": "torsionnet.core.errors",
    "Unknown": "torsionnet.identification",
    "UsageError": "torsionnet.core.errors",
    "convert_damping": "torsionnet.core.damping",
    "library_models": "torsionnet.model.files",
    "identify": "torsionnet.identification",
    "library_benches": "torsionnet.model.files",
    "load": "torsionnet.loading",
    "load_bench": "torsionnet.bench",
    "load_study": "torsionnet.study",
    "loads": "torsionnet.loading",
    "write_report": "torsionnet.report",
}

_PACKAGES = {
    "bench": "torsionnet.bench",
    "identification": "torsionnet.identification",
    "io": "torsionnet.io",
    "modal": "torsionnet.modal",
    "plot": "torsionnet.plot",
    "report": "torsionnet.report",
    "sensitivity": "torsionnet.solve.sensitivity",
    "signals": "torsionnet.signals",
    "study": "torsionnet.study",
    "units": "torsionnet.core.units",
}
_RENAMED = {"document": "report", "interchange": "io"}

if TYPE_CHECKING:
    from torsionnet import bench, identification, io, modal, plot, report, signals, study
    from torsionnet import io as interchange
    from torsionnet import report as document
    from torsionnet.bench import Bench, load_bench
    from torsionnet.core import units
    from torsionnet.core.damping import convert_damping
    from torsionnet.core.errors import (
        Fault,
        MissingExtraError,
        ModelError,
        SolveError,
        TorsionnetError,
        TorsionnetWarning,
        UsageError,
    )
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.identification import Fit, Measurement, Unknown, identify
    from torsionnet.loading import load, loads
    from torsionnet.model.channels import Input, Sensor
    from torsionnet.model.elements import Element
    from torsionnet.model.elements.element_types import *
    from torsionnet.model.files import library_benches, library_models
    from torsionnet.model.operating_point import OperatingPoint
    from torsionnet.model.parameters import Parameter
    from torsionnet.report import write_report
    from torsionnet.response import Channel, Conventions, FrequencyResponse, FrequencyResponses, Modes
    from torsionnet.solve import sensitivity
    from torsionnet.solve.responses.grid import Adaptive
    from torsionnet.study.loading_study import load_study


_offered = names_on_demand(__name__, {**_HOMES, **_PACKAGES})


def __getattr__(name: str) -> object:
    if name in _RENAMED:
        instead = _RENAMED[name]
        warnings.warn(f"torsionnet.{name} is called torsionnet.{instead} now", DeprecationWarning, stacklevel=2)
        return _offered(instead)
    if name == "__all__":
        return _public_names()
    if name[:1].isupper() and name not in _HOMES and name in _element_types():
        return _element_types()[name]
    value = globals()[name] = _offered(name)
    return value


def _element_types() -> dict[str, type[Element]]:
    """Those that files of the package or of a program have registered by now."""
    from torsionnet.model.elements import element_classes

    return element_classes()


def _public_names() -> list[str]:
    return ["__version__", *_HOMES, *_PACKAGES, *_RENAMED, *_element_types()]


def __dir__() -> list[str]:
    return sorted(_public_names())
