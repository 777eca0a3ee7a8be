"""Outputs and inputs that the explore page offers for responses: sensors, nodes, inputs and torques on nodes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from torsionnet.app.explore.over_speed import runs
from torsionnet.base.errors import TorsionnetError, UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.dynamic_stiffness.transfer_request import usable_channels
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.model.channels import UNITS, Sensor
from torsionnet.model.element_base.round_section import section_fault
from torsionnet.model.elements import GROUND

TWISTING = ("shaft", "spring", "clearance")
"""Glyphs of the elements whose torque the page offers as an output."""
MOTIONS = ("angle", "velocity", "acceleration", "twist")
"""Quantities of sensors, all of motion, that the page takes first as the output of a response."""


@dataclass(frozen=True)
class ResponseChoice:
    """Frequency response chosen by the names of its output and input.

    Examples
    --------
    >>> read_pair("torque(gearbox, output_shaft)/T_M")
    ResponseChoice(output='torque(gearbox, output_shaft)', input='T_M')
    """

    output: str
    input: str

    def __str__(self) -> str:
        return f"{self.output}/{self.input}"


def read_pair(text: str) -> ResponseChoice:
    """Output and input of a response, read from ``OUTPUT/INPUT``; UsageError where the text has another form."""
    output, slash, into = (part.strip() for part in text.partition("/"))
    if not (slash and output and into) or "/" in into:
        raise UsageError(f'a transfer function is written OUTPUT/INPUT, as in theta_1/T_M; got "{text}"')
    return ResponseChoice(output, into)


def default_pair(rig: Drivetrain, overlay: FrequencyResponse | None = None) -> ResponseChoice:
    """Names of output and input of the first response shown, the measured ones if the model has them, else its first.

    Examples
    --------
    >>> import torsionnet as tn
    >>> print(default_pair(tn.load("amt_rig")))
    theta_1/T_M
    """
    if overlay is not None:
        measured = ResponseChoice(overlay.outputs[0].name, overlay.inputs[0].name)
        if measured.output in {*rig.sensors, *rig.nodes} and measured.input in {*rig.inputs, *rig.sensors, *rig.nodes}:
            return measured
    try:
        inputs, sensors = usable_channels(rig)
        moving = rig.assembly.kinematics.coordinates or rig.nodes
    except TorsionnetError:  # an operating point out of balance, of which the page tells
        inputs, sensors, moving = list(rig.inputs), list(rig.sensors), rig.nodes
    motions = [name for name in sensors if rig.sensors[name].quantity in MOTIONS]
    return ResponseChoice([*motions, *sensors, *moving][0], [*inputs, *moving][0])


def choices(rig: Drivetrain, pairs: Sequence[ResponseChoice], over_speed: Sequence[str] = ()) -> dict[str, Any]:
    """Groups of outputs and inputs that the page offers, and the names of measured inputs and excitations.

    ``pairs`` and ``over_speed`` are the responses and the outputs asked for by name. Of a model that runs, torques in
    shafts and springs and stresses in shafts are outputs, too: they are what is examined over speed.
    """
    sensors = [(name, _what(sensor)) for name, sensor in rig.sensors.items()]
    nodes = [(node, f"angle of {node}") for node in rig.nodes if node not in rig.sensors]
    inputs = [(name, str(entry)) for name, entry in rig.inputs.items()]
    torques = [(node, f"torque on {node}") for node in rig.nodes if node not in {*rig.inputs, *rig.sensors}]
    known = ({name for name, _ in (*sensors, *nodes)}, {name for name, _ in (*inputs, *sensors, *torques)})
    outputs = (*over_speed, *(pair.output for pair in pairs))
    asked = (_others(outputs, known[0]), _others((pair.input for pair in pairs), known[1]))
    inside, sheared = ([one for one in group if one[0] not in outputs] for group in _in_elements(rig))
    return {
        "outputs": _groups(
            ("sensors", sensors),
            ("asked for", asked[0]),
            ("torques in elements", inside),
            ("stresses in shafts", sheared),
            ("angles of nodes", nodes),
        ),
        "inputs": _groups(("inputs", inputs), ("measured", [*sensors, *asked[1]]), ("torques on nodes", torques)),
        "measured": [*rig.sensors, *(name for name, _ in asked[1])],
        "excitations": [*rig.inputs, *(() if rig.inputs else rig.nodes)],
    }


def _in_elements(rig: Drivetrain) -> tuple[list[tuple[str, str]], list[tuple[str, str]]]:
    """Names and labels of the torques in shafts and springs between nodes, and of the stresses in shafts."""
    every = rig.elements.values() if runs(rig) else ()
    twisting = [one for one in every if one.glyph in TWISTING and GROUND not in one.ports.values()]
    shafts = [one for one in twisting if not section_fault(one)]
    torques = [Sensor("torque", one.name) for one in twisting]
    stresses = [Sensor("stress", one.name) for one in shafts]
    return [(str(one), _what(one)) for one in torques], [(str(one), _what(one)) for one in stresses]


def _what(sensor: Sensor) -> str:
    return f"{sensor}, {UNITS[sensor.quantity]}"


def _others(names: Iterable[str], known: set[str]) -> list[tuple[str, str]]:
    return [(name, name) for name in dict.fromkeys(names) if name not in known]


def _groups(*groups: tuple[str, list[tuple[str, str]]]) -> list[dict[str, Any]]:
    return [
        {"label": label, "entries": [{"name": name, "what": what} for name, what in entries]}
        for label, entries in groups
        if entries
    ]
