"""What sensors read, on a tape: the twin of :mod:`torsionnet.assembly.functionals`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from torsionnet.assembly.functionals import port_of
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.fmu.motion import Motion
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import Law
from torsionnet.model.kinematics import virtual_motion

POWERS = {"angle": 0, "velocity": 1, "acceleration": 2}


@dataclass(frozen=True)
class TracedPart:
    """The motion of a row, its rate and acceleration times ``factors``, and shares of torques ``applied`` at nodes."""

    row: Mapping[str, Any] = field(default_factory=dict)
    factors: tuple[Any, Any, Any] = (0, 0, 0)
    applied: Mapping[str, Any] = field(default_factory=dict)


def parts_of(drivetrain: Drivetrain, motion: Motion, sensor: Sensor) -> list[TracedPart]:
    """The parts whose sum a sensor reads."""
    if sensor.quantity in POWERS:
        power = POWERS[sensor.quantity]
        return [TracedPart({sensor.of: 1}, (int(power == 0), int(power == 1), int(power == 2)))]
    element = drivetrain.elements[sensor.of]
    if sensor.quantity == "twist":
        return [TracedPart(element.twist(motion.values), (1, 0, 0))]
    node, sign = port_of(element, sensor.at)
    parts = [
        _torque(motion, law, sign * law.row[node])
        for owner, law in motion.kinematics.laws
        if owner == element.name and law.acts and node in law.row
    ]
    for index, (owner, row) in enumerate(motion.kinematics.constraints):
        if owner == element.name and node in row:
            parts += _reaction(motion, index, sign * row[node])
    return parts


def _torque(motion: Motion, law: Law, factor: Any) -> TracedPart:
    number = motion.tape.number
    weights = (number(law.stiffness), number(law.damping), number(law.inertia))
    return TracedPart(law.row, (weights[0] * factor, weights[1] * factor, weights[2] * factor))


def _reaction(motion: Motion, index: int, factor: Any) -> list[TracedPart]:
    """The torque of a rigid connection: the work of all laws and torques on the motion that opens it by one."""
    number = motion.tape.number
    opened = virtual_motion(motion.kinematics, index, number)
    parts = [TracedPart(applied={node: number(factor) * angle for node, angle in opened.items()})]
    for _, law in motion.kinematics.laws:
        work = number(0)
        for node in law.row.keys() & opened.keys():
            work = work + number(law.row[node]) * opened[node]
        if law.acts and not work.vanishes:
            parts.append(_torque(motion, law, -(work * factor)))
    return parts
