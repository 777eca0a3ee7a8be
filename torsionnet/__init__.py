"""Lumped-parameter torsional models of drivetrains.

Describe a drivetrain as elements between nodes, in a model file or in Python; get natural frequencies, damping ratios,
mode shapes and transfer functions between any two sensors, also against a measured input.

>>> import torsionnet as tn
>>> rig = tn.load("dmf_rig")
>>> rig.modes().natural_frequencies.round(3).tolist()
[7.105, 80.983]
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.base.packages import lazy_exports
from torsionnet.base.version import __version__ as __version__

if TYPE_CHECKING:
    from torsionnet.model.elements import Element

_named, _attribute, _ = lazy_exports(
    __name__,
    {
        "Adaptive": "torsionnet.linear.responses.grid",
        "Bench": "torsionnet.bench",
        "Channel": "torsionnet.linear.frequency_response",
        "Conventions": "torsionnet.base.conventions",
        "Drivetrain": "torsionnet.drivetrain",
        "Element": "torsionnet.model.elements",
        "Fault": "torsionnet.base.errors",
        "Fit": "torsionnet.identification",
        "FrequencyResponse": "torsionnet.linear.frequency_response",
        "Measurement": "torsionnet.identification",
        "MissingExtraError": "torsionnet.base.errors",
        "ModelError": "torsionnet.base.errors",
        "Modes": "torsionnet.linear.modes.modes",
        "ShortCircuitScenario": "torsionnet.motion.scenarios.short_circuit",
        "SolveError": "torsionnet.base.errors",
        "Table": "torsionnet.base.table",
        "TorqueScenario": "torsionnet.motion.scenarios.torques_of_nodes",
        "TorsionnetError": "torsionnet.base.errors",
        "TorsionnetWarning": "torsionnet.base.errors",
        "Unknown": "torsionnet.identification",
        "UsageError": "torsionnet.base.errors",
        "convert_damping": "torsionnet.model.damping",
        "identify": "torsionnet.identification",
        "library_models": "torsionnet.model.files.library",
        "load": "torsionnet.drivetrain",
        "load_bench": "torsionnet.bench",
        "load_campaign": "torsionnet.bench.campaign.campaign",
        "load_study": "torsionnet.study",
        "loads": "torsionnet.drivetrain",
        "run_campaign": "torsionnet.bench.campaign.running_campaign",
        "write_report": "torsionnet.report",
    },
    modules=(
        "torsionnet.bench",
        "torsionnet.extend",
        "torsionnet.identification",
        "torsionnet.io",
        "torsionnet.machinery",
        "torsionnet.modal",
        "torsionnet.motion",
        "torsionnet.plot",
        "torsionnet.report",
        "torsionnet.linear.sensitivity",
        "torsionnet.signals",
        "torsionnet.study",
        "torsionnet.base.units",
    ),
)


def __getattr__(name: str) -> object:
    """Public object or element class by its name, imported when it is first asked for."""
    if name == "__all__":
        return _public_names()
    if name[:1].isupper() and name not in _named:
        from torsionnet.model.elements import element_class

        if (element := element_class(name)) is not None:
            return element
    return _attribute(name)


def __dir__() -> list[str]:
    return sorted(_public_names())


def _public_names() -> list[str]:
    return ["__version__", *_named, *_element_types()]


def _element_types() -> dict[str, type[Element]]:
    """Element classes by name that the package or a program has registered so far."""
    from torsionnet.model.elements import element_classes

    return element_classes()
