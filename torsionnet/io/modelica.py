"""Export of drivetrains as Modelica text, made of components of Modelica.Mechanics.Rotational 4.0."""

from __future__ import annotations

import os
from dataclasses import dataclass

from torsionnet.base.atomic import write_text
from torsionnet.base.errors import UsageError
from torsionnet.base.plain_names import Names
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.export_losses import export_losses
from torsionnet.io.modelica_elements import write_element
from torsionnet.io.modelica_net import Net
from torsionnet.io.modelica_parts import COMPONENTS, FIXED, has_counterpart, port
from torsionnet.io.modelica_syntax import (
    KEYWORDS,
    ROTATIONAL,
    ModelicaExpressions,
    export_unit,
    parameter_kinds,
    quoted,
    unit_of,
)
from torsionnet.io.part_descriptions import describe_element_part
from torsionnet.io.unlinear_laws import refuse_laws_of_motion
from torsionnet.linear.dynamic_stiffness.state_space import active_channels
from torsionnet.model.channels import UNITS, Input, Sensor
from torsionnet.model.elements import Values
from torsionnet.model.parameters import dimensions

BLOCKS = "Modelica.Blocks.Interfaces"
MOTIONS = {"angle": ("AngleSensor", "phi"), "velocity": ("SpeedSensor", "w"), "acceleration": ("AccSensor", "a")}
"""Component and signal of the Modelica library that measure each quantity of motion (angle, velocity, ...)."""


def to_modelica(drivetrain: Drivetrain) -> str:
    """Text of a Modelica model of a drivetrain in its configuration, in SI.

    Parameters stay parameters, with their expressions; elements become Inertia, Spring, Damper, SpringDamper,
    IdealGear, IdealPlanetary and Fixed, nodes connection sets, inputs and sensors ``RealInput`` and ``RealOutput``. An
    open differential is a planetary set of ratio 1; the consistent inertia of a shaft is put on its ends and, through
    another such set, on the mean of their angles. Element types without a component of their own become those of their
    laws and constraints. The same drivetrain always gives the same text.

    Raises
    ------
    UsageError
        Laws without counterpart: hysteresis, and tables over frequency.

    Examples
    --------
    >>> import torsionnet as tn
    >>> text = to_modelica(tn.load("dmf_rig"))
    >>> print(text.splitlines()[4].strip())
    parameter Real k_1(unit="N.m/rad") = 13300 "torque meter";
    """
    refuse_laws_of_motion(drivetrain, "Modelica as torsionnet writes it")
    _refuse(drivetrain)
    names = Names(KEYWORDS)
    title = names.new(drivetrain.title)
    model = _Model(drivetrain, title, names)
    model.write()
    body = [*model.parameters, *model.net.declarations]
    wires = [*model.net.equations, *model.net.connections()]
    head = [f"model {title} {quoted(drivetrain.description or drivetrain.title)}"]
    if drivetrain.source:
        head.append(f"  // {' '.join(f'source: {drivetrain.source}'.split())}")
    body += [f"// {' '.join(sentence.split())}" for sentence in export_losses(drivetrain, "modelica").sentences()]
    tail = ['  annotation(uses(Modelica(version="4.0.0")));', f"end {title};", ""]
    return "\n".join([*head, *(f"  {line}" for line in body), "equation", *(f"  {line}" for line in wires), *tail])


def write_modelica(drivetrain: Drivetrain, path: str | os.PathLike[str]) -> None:
    """Write the Modelica text of :func:`to_modelica` as a file, whole or not at all."""
    write_text(path, to_modelica(drivetrain))


def _refuse(drivetrain: Drivetrain) -> None:
    values = Values(drivetrain.exact_values)
    without = [
        describe_element_part(element, part)
        for element in drivetrain.elements.values()
        for part in element.parts(values)
        if not has_counterpart(part)
    ]
    if without:
        raise UsageError(f"Modelica.Mechanics.Rotational has no counterpart of {'; '.join(without)}")


@dataclass
class _Model:
    """Writer of a Modelica model, which declares and connects everything that a drivetrain has."""

    drivetrain: Drivetrain
    title: str
    names: Names

    def write(self) -> None:
        drivetrain, channels = self.drivetrain, active_channels(self.drivetrain)
        known = {name: self.names.new(name) for name in drivetrain.parameter_definitions}
        words = ModelicaExpressions(known, drivetrain.exact_values)
        self.parameters = self._parameters(known, words)
        self.net = Net(self.names)
        driven = {
            name: self._interface("RealInput", name, UNITS[entry.quantity]) for name, entry in channels.inputs.items()
        }
        read = {
            name: self._interface("RealOutput", name, UNITS[entry.quantity]) for name, entry in channels.sensors.items()
        }
        meters: dict[tuple[str, int], list[str]] = {}
        for name, sensor in channels.sensors.items():
            if sensor.referred_to is not None:
                raise UsageError(f"{name} is referred to {sensor.referred_to}, which is not written to Modelica")
            if sensor.quantity == "stress":
                raise UsageError(f"{name} is a stress, which is not written to Modelica; measure torque({sensor.of})")
            if sensor.quantity == "torque":
                element = drivetrain.elements[sensor.of]
                meters.setdefault((sensor.of, element.place_of(sensor.at)), []).append(read[name])
        for element in drivetrain.elements.values():
            write_element(element, self.net, words)
            for place, (name, node) in enumerate(element.ports.items()):
                self._attach(port(element, name), node, place, meters.pop((element.name, place), []))
        if FIXED in self.net.points.home:
            fixed = self.net.declare(f"{COMPONENTS}.Fixed", "fixed")
            self.net.points.join(FIXED, f"{fixed}.flange")
        for name, entry in channels.inputs.items():
            self._drive(driven[name], entry)
        for name, sensor in channels.sensors.items():
            if sensor.quantity != "torque":
                self._read(read[name], sensor)

    def _parameters(self, known: dict[str, str], words: ModelicaExpressions) -> list[str]:
        found = dimensions(self.drivetrain.parameter_definitions)[0]
        kinds = parameter_kinds(self.drivetrain.elements.values(), found)
        lines = []
        for name, parameter in self.drivetrain.parameter_definitions.items():
            unit = unit_of(found.get(name), kinds.get(name), parameter.value)
            attribute = f'(unit="{unit}")' if unit else ""
            comment = f" {quoted(parameter.description)}" if parameter.description else ""
            lines.append(f"parameter Real {known[name]}{attribute} = {words.expression(parameter.value)}{comment};")
        return lines

    def _interface(self, kind: str, name: str, unit: str) -> str:
        return self.net.declare(f"{BLOCKS}.{kind}", name, f'unit="{export_unit(unit)}"')

    def _attach(self, point: str, node: str, index: int, outputs: list[str]) -> None:
        """Connect a port of an element to its node, through a torque sensor if there are torque outputs there."""
        if not outputs:
            self.net.points.join(f"node:{node}", point)
            return
        meter = self.net.declare(f"{ROTATIONAL}.Sensors.TorqueSensor", f"{outputs[0]}_meter")
        inner, outer = ("flange_b", "flange_a") if index == 0 else ("flange_a", "flange_b")
        self.net.points.join(f"node:{node}", f"{meter}.{outer}")
        self.net.points.join(point, f"{meter}.{inner}")
        self.net.equations += [f"connect({meter}.tau, {output});" for output in outputs]

    def _drive(self, name: str, entry: Input) -> None:
        kind, signal = ("Torque", "tau") if entry.quantity == "torque" else ("Position", "phi_ref")
        values = ["exact=true"] * (kind == "Position") + ["useSupport=true"] * (entry.against is not None)
        source = self.net.declare(f"{ROTATIONAL}.Sources.{kind}", f"{name}_source", ", ".join(values))
        self.net.points.join(f"node:{entry.of}", f"{source}.flange")
        if entry.against is not None:
            self.net.points.join(f"node:{entry.against}", f"{source}.support")
        self.net.equations.append(f"connect({name}, {source}.{signal});")

    def _read(self, name: str, sensor: Sensor) -> None:
        if sensor.quantity in MOTIONS:
            if sensor.against is None:
                self.net.equations.append(f"connect({self._motion(name, sensor.quantity, sensor.of)}, {name});")
                return
            quantity, row = sensor.quantity, dict(sensor.row)
        else:
            quantity = "angle"
            row = dict(self.drivetrain.elements[sensor.of].twist(Values(self.drivetrain.exact_values)))
        shares = [f"{float(share)!r}*{self._motion(f'{name}_{node}', quantity, node)}" for node, share in row.items()]
        self.net.equations.append(f"{name} = {' + '.join(shares) or '0'};")

    def _motion(self, wish: str, quantity: str, node: str) -> str:
        kind, signal = MOTIONS[quantity]
        meter = self.net.declare(f"{ROTATIONAL}.Sensors.{kind}", f"{wish}_sensor")
        self.net.points.join(f"node:{node}", f"{meter}.flange")
        return f"{meter}.{signal}"
