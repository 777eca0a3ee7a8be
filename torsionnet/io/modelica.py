"""Export of drivetrains as Modelica text, made of components of Modelica.Mechanics.Rotational 4.0."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from torsionnet.base.atomic import write_text
from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import UsageError
from torsionnet.base.plain_names import Names
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.export_losses import describe_element_part, export_losses, refuse_laws_of_motion
from torsionnet.io.modelica_parts import (
    COMPONENTS,
    FIXED,
    KEYWORDS,
    ROTATIONAL,
    ModelicaExpressions,
    Net,
    declared,
    export_unit,
    factor,
    has_counterpart,
    parameter_kinds,
    port,
    quoted,
    unit_of,
    write_parts,
)
from torsionnet.linear.dynamic_stiffness.state_space import active_channels
from torsionnet.model.channels import UNITS, Input, Sensor
from torsionnet.model.elements import Differential, Element, Gear, Law, Planetary, Shaft, Values
from torsionnet.model.parameters import dimensions

# Modelica components of gears, sets and shafts, which Modelica.Mechanics.Rotational has counterparts of.

Writer = Callable[[Any, Net, ModelicaExpressions], None]


def _compliant(element: Any, net: Net, words: ModelicaExpressions, entrance: str) -> str:
    """Connection point behind the compliance of a mesh at its first port; the port itself for a rigid mesh."""
    if element.stiffness is None:
        return entrance
    stiffness = words.expression(element.stiffness)
    values = f"c={stiffness}, d={words.damping(element.damping, element.stiffness)}"
    name = declared(element, net, "SpringDamper", values, "_mesh")
    net.points.join(entrance, f"{name}.flange_a")
    return f"{name}.flange_b"


def _gear(element: Gear, net: Net, words: ModelicaExpressions) -> None:
    ratio = _quotient(element.teeth) if element.teeth else words.expression(not_none(element.ratio))
    support = ", useSupport=true" if element.housing else ""
    name = declared(element, net, "IdealGear", f"ratio={ratio}{support}")
    net.points.join(_compliant(element, net, words, port(element, "first")), f"{name}.flange_a")
    net.points.join(port(element, "second"), f"{name}.flange_b")
    if element.housing:
        net.points.join(port(element, "housing"), f"{name}.support")


def _quotient(teeth: Any) -> str:
    return f"{int(teeth[1])}/{factor(str(int(teeth[0])))}"


def _planetary(element: Planetary, net: Net, words: ModelicaExpressions) -> None:
    ratio = _quotient(element.teeth) if element.teeth else words.expression(not_none(element.ratio))
    name = declared(element, net, "IdealPlanetary", f"ratio={ratio}")
    net.points.join(_compliant(element, net, words, port(element, "sun")), f"{name}.sun")
    for side in ("ring", "carrier"):
        net.points.join(port(element, side), f"{name}.{side}")
    if words.values(element.planet_inertia):
        # A planet rolls on the sun: against the carrier it turns by -2/(z - 1) of what the sun does.
        roll = declared(element, net, "IdealGear", f"ratio=-({ratio} - 1)/2, useSupport=true", "_planet_mesh")
        total = f"{element.planets}*{factor(words.expression(element.planet_inertia))}"
        net.points.join(port(element, "sun"), f"{roll}.flange_a")
        net.points.join(port(element, "carrier"), f"{roll}.support")
        net.points.join(f"{roll}.flange_b", f"{declared(element, net, 'Inertia', f'J={total}', '_planets')}.flange_a")
    if words.values(element.planet_mass) and words.values(element.orbit_radius):
        mass, radius = (factor(words.expression(value)) for value in (element.planet_mass, element.orbit_radius))
        orbit = declared(element, net, "Inertia", f"J={element.planets}*{mass}*{radius}^2", "_orbit")
        net.points.join(port(element, "carrier"), f"{orbit}.flange_a")


def _differential(element: Differential, net: Net, words: ModelicaExpressions) -> None:
    del words
    sides = {"cage": "carrier", "left": "sun", "right": "ring"}
    if element.locked:
        net.points.join(*(port(element, side) for side in sides))
        return
    # A planetary set of ratio 1 turns its carrier with the mean of sun and ring.
    name = declared(element, net, "IdealPlanetary", "ratio=1")
    for ours, theirs in sides.items():
        net.points.join(port(element, ours), f"{name}.{theirs}")


def _shaft(element: Shaft, net: Net, words: ModelicaExpressions) -> None:
    n = element.segments
    area = (
        f"Modelica.Constants.pi*({_power(words, element.outer_diameter)} - {_power(words, element.inner_diameter)})/32"
    )
    length, modulus, density = (
        factor(words.expression(value)) for value in (element.length, element.shear_modulus, element.density)
    )
    # Of one segment k = n G I/L and J = rho I L/n, with I = pi (D^4 - d^4)/32.
    stiffness, inertia = f"{n}*{modulus}*{area}/{length}", f"{density}*{area}*{length}/{n}"
    laws = (part for part in element.parts(words.values) if isinstance(part, Law))
    damping = next(float(law.damping) for law in laws if law.is_elastic)
    points = [port(element, "first"), *(f"node:{node}" for node in element.internal_nodes), port(element, "second")]
    for index in range(n):
        suffix = f"_{index + 1}" if n > 1 else ""
        values = f"c={stiffness}, d={damping!r}" if damping else f"c={stiffness}"
        name = declared(element, net, "SpringDamper" if damping else "Spring", values, suffix)
        net.points.join(points[index], f"{name}.flange_a")
        net.points.join(points[index + 1], f"{name}.flange_b")
        if element.inertia != "none":
            _segment_inertia(element, net, inertia, points[index : index + 2], suffix)


def _power(words: ModelicaExpressions, value: Any) -> str:
    return f"{factor(words.expression(value))}^4"


def _segment_inertia(element: Shaft, net: Net, inertia: str, ends: list[str], suffix: str) -> None:
    """Write the inertia of a shaft segment on its ends, and of a consistent one two thirds on the mean angle."""
    # Consistent: J (w_1^2 + w_1 w_2 + w_2^2)/3 = J w_1^2/6 + J w_2^2/6 + (2 J/3) ((w_1 + w_2)/2)^2.
    share = 6 if element.inertia == "consistent" else 2
    for end, side in zip(ends, "ab", strict=True):
        lump = declared(element, net, "Inertia", f"J={inertia}/{share}", f"{suffix}_inertia_{side}")
        net.points.join(end, f"{lump}.flange_a")
    if element.inertia == "consistent":
        # A planetary set of ratio 1 has the mean of both angles on its carrier.
        mean = declared(element, net, "IdealPlanetary", "ratio=1", f"{suffix}_mean")
        middle = declared(element, net, "Inertia", f"J=2*{inertia}/3", f"{suffix}_inertia_mean")
        net.points.join(ends[0], f"{mean}.sun")
        net.points.join(ends[1], f"{mean}.ring")
        net.points.join(f"{mean}.carrier", f"{middle}.flange_a")


_WRITERS: dict[type[Element], Writer] = {
    Gear: _gear,
    Planetary: _planetary,
    Differential: _differential,
    Shaft: _shaft,
}


def write_element(element: Element, net: Net, words: ModelicaExpressions) -> None:
    """Declare and connect the Modelica components of an element."""
    # The nicer components take their values from the entries, which may be quoted at another shaft.
    write = write_parts if element.other_laws or element.has_motion_laws else _WRITERS.get(type(element), write_parts)
    write(element, net, words)


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
        raise UsageError(
            f"Modelica.Mechanics.Rotational has no counterpart of {'; '.join(without)}", kind="no-counterpart"
        )


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
                raise UsageError(
                    f"{name} is referred to {sensor.referred_to}, which is not written to Modelica",
                    kind="no-counterpart",
                )
            if sensor.quantity == "stress":
                raise UsageError(
                    f"{name} is a stress, which is not written to Modelica; measure torque({sensor.of})",
                    kind="no-counterpart",
                )
            if sensor.quantity == "torque":
                element = drivetrain.elements[sensor.of]
                meters.setdefault((sensor.of, element.place_of(sensor.at)), []).append(read[name])
        # A sensor of torque sits between the flange of an element and its node.
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
        dimension_of = dimensions(self.drivetrain.parameter_definitions)[0]
        kinds = parameter_kinds(self.drivetrain.elements.values(), dimension_of)
        lines = []
        for name, parameter in self.drivetrain.parameter_definitions.items():
            unit = unit_of(dimension_of.get(name), kinds.get(name), parameter.value)
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
