"""Excitations that impose a twist in an element: universal joints at an angle, and errors of gear teeth."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple, Self

import numpy as np

from torsionnet.base.entries.composite import Nested, one_exactly
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, entry
from torsionnet.base.errors import EntryPath, Fault, named_list
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.machinery.excitations.harmonic_torque import PHASE, TableByOrder
from torsionnet.machinery.excitations.order_excitation import (
    FloatArray,
    OrderExcitation,
    OrderTorques,
    register_excitation,
)
from torsionnet.model.element_base.element_entries import ElementName, NodeName
from torsionnet.model.elements import GROUND, Element
from torsionnet.model.elements.gears import Gear

# Base class of excitations that impose a twist in an element, as errors of teeth and universal joints.


@dataclass(frozen=True, kw_only=True)
class TwistExcitation(OrderExcitation):
    """Base class of excitations by a twist in one element, with the orders of a shaft at one of its ends."""

    element_field: ClassVar[str] = ""
    """Name of the entry that names the twisted element, in the class of an excitation."""

    speed_of: str | None = entry(
        NodeName(
            "the wheel or input shaft whose angles and revolutions are meant; default: the first node of the element",
            allow_ground=False,
        ),
        None,
    )

    common: ClassVar[tuple[str, ...]] = ("enabled", "speed_of")

    @property
    def shaft(self) -> str:
        return str(self.speed_of or "")

    @property
    def quantity(self) -> str:
        return "twist"

    @property
    def element_entry(self) -> tuple[EntryPath, str]:
        return (self.element_field,), getattr(self, self.element_field)

    def with_element_data(self, elements: Mapping[str, Element]) -> Self:
        element = elements.get(self.element_entry[1])
        if self.speed_of or element is None:
            return self
        return replace(self, speed_of=next(iter(shafts_of(element)), None))


def shafts_of(element: Element) -> list[str]:
    """Names of an element's nodes without the ground."""
    return [node for node in element.ports.values() if node != GROUND]


# Excitation by the non-uniform rotation of a universal joint at an angle.

LARGEST_JOINT_ANGLE = math.radians(45)
"""Largest angle in rad for which cross joints are built, as one in degrees without its unit is far above."""


@register_excitation
@dataclass(frozen=True, kw_only=True)
class UniversalJoint(TwistExcitation):
    """A cross joint at the angle beta: tan(out) = tan(in)/cos(beta), in = phi + phase of its input yoke.

    Its output runs ahead by out - in = sum_n tan(beta/2)^(2n)/n sin(2 n in), which is imposed as a twist in the element
    ``joint``: the spring between input and output, as the shaft beside the joint. The yoke's angle is 0 where its arms
    lie in the plane of both shafts. What the joint does by the torque it carries (bending, and a part of that
    torque at twice the speed) is not included.

    Examples
    --------
    >>> cross = UniversalJoint(joint="shaft", speed_of="gearbox", angle="10 deg")
    >>> pulsation = cross.torques(np.array([100.0]))
    >>> pulsation.orders.tolist(), abs(pulsation.amplitudes[0, :, 0]).round(8).tolist()
    ([2.0, 4.0], [0.00765427, 2.929e-05])
    """

    kind: ClassVar[str] = "universal_joint"
    element_field: ClassVar[str] = "joint"

    joint: str = entry(ElementName("the element between its input and its output, a spring or a compliant gear"))
    angle: float = entry(Value("angle between input and output shaft", "angle"))
    phase: float = entry(
        Value("angle of the input yoke where phi is 0; 90 deg if in line with that of the last joint", "angle", None), 0
    )
    multiples: int = entry(Count("how many multiples of twice the speed act", 1, 10), 2)

    def contradictions(self) -> list[Fault]:
        if self.angle < LARGEST_JOINT_ANGLE:
            return []
        text = f"a universal joint works at less than {math.degrees(LARGEST_JOINT_ANGLE):g} deg"
        return [Fault(f"{text}; a bare number is in radians, write 10 deg", ("angle",), kind="missing-unit")]

    def element_faults(self, elements: Mapping[str, Element]) -> list[Fault]:
        element = elements[self.joint]
        if element.glyph not in ("spring", "shaft"):
            said = "{} is a {}; a joint is in a spring between its two shafts"
            return [Fault(phrase(said, ModelName(self.joint), element.kind), ("joint",), kind="not-applicable")]
        shafts = shafts_of(element)
        if self.speed_of in shafts:
            return []
        said = "the input of a joint is an end of its element; {} connects {}"
        text = phrase(said, ModelName(self.joint), named_list(shafts, between=" and "))
        return [Fault(text, ("speed_of",), kind="no-ratio")]

    def torques(self, speeds: FloatArray) -> OrderTorques:
        count = np.arange(1, self.multiples + 1)
        # out - in = sum_n tan(beta/2)^(2n)/n sin(2 n in).
        sizes = math.tan(self.angle / 2) ** (2 * count) / count
        # cos(x - pi/2) is sin x; what counts is how far the input is ahead of the output.
        lag = -sizes * -1j * np.exp(2j * count * self.phase)
        amplitudes = np.broadcast_to(lag[None, :, None], (len(speeds), len(count), 1)).copy()
        return OrderTorques(np.asarray(2.0 * count, dtype=float), (self.joint,), amplitudes)


# Excitation by errors of gear teeth, imposed on a compliant mesh.


@dataclass(frozen=True, kw_only=True)
class MeshError(Declared):
    """Peak value and phase of an error: a way along the line of action, or an angle of the wheel."""

    kind: ClassVar[str] = "mesh error"
    article: ClassVar[str] = "an error of a mesh"
    form: ClassVar[str] = "{way: 4 um, phase: 0 deg} or {angle: 60 urad}"

    way: float | None = entry(Value("peak value along the line of action", "length"), None)
    angle: float | None = entry(Value("peak value as an angle of the wheel", "angle"), None)
    phase: float = entry(PHASE, 0)

    def contradictions(self) -> list[Fault]:
        return one_exactly(self, "way", "angle", of="an error", form=self.form)


KINDS_WITH_SEVERAL_MESHES = ("gearbox", "final_drive")
"""Kinds of elements with several gear pairs, in which no single twist can be imposed."""

_ERROR = Nested("peak value and phase", lambda: MeshError, "mesh_error", shown="{way: 4 um}")


class _Line(NamedTuple):
    path: EntryPath
    order: float
    error: MeshError


@register_excitation
@dataclass(frozen=True, kw_only=True)
class GearMesh(TwistExcitation):
    """Transmission error of a gear stage by multiples of its tooth frequency, and run-out of both wheels.

    The error e is how far the wheel on ``speed_of`` runs ahead without load. It is imposed on the mesh, whose torque is
    k (gamma - e) + c d(gamma - e)/dt with the stiffness and damping of the gear: a mesh without them has none.

    Examples
    --------
    >>> mesh = GearMesh(mesh="stage", speed_of="pinion", teeth=17, base_radius="40 mm",
    ...     transmission_error={1: {"way": "4 um"}}, run_out={"way": "10 um"})
    >>> pulsation = mesh.torques(np.array([100.0]))
    >>> pulsation.orders.tolist(), pulsation.amplitudes[0, :, 0].real.round(9).tolist()
    ([17.0, 1.0], [0.0001, 0.00025])
    """

    kind: ClassVar[str] = "gear_mesh"
    element_field: ClassVar[str] = "mesh"

    mesh: str = entry(ElementName("the gear, an element with a mesh stiffness", "the name of a gear"))
    teeth: int | None = entry(Count("teeth of that wheel; default: as the gear says", 1, 1_000_000), None)
    mate_teeth: int | None = entry(Count("teeth of the other wheel; default: as the gear says", 1, 1_000_000), None)
    base_radius: float | None = entry(
        Value("base radius of that wheel, for errors given as a way", "length", exclusive=True), None
    )
    transmission_error: Mapping[float, MeshError] = entry(
        TableByOrder("multiple of the tooth frequency -> peak value and phase", _ERROR, fewest=0), None
    )
    run_out: MeshError | None = entry(
        Nested("once per revolution of that wheel, half of the total run-out", lambda: MeshError, "run_out"), None
    )
    mate_run_out: MeshError | None = entry(
        Nested("the same of the other wheel", lambda: MeshError, "mate_run_out"), None
    )

    def contradictions(self) -> list[Fault]:
        if not (self.transmission_error or self.run_out or self.mate_run_out):
            text = "a mesh needs transmission_error: {1: {way: 4 um}}, run_out: {way: 10 um} or mate_run_out"
            return [Fault(text, on_key=True, kind="missing-entry")]
        if self.base_radius is not None:
            return []
        ways = [line for line in self._error_lines() if line.error.way is not None]
        return [
            Fault(
                "an error given as a way needs the base radius of the wheel: base_radius: 40 mm",
                (*line.path, "way"),
                kind="missing-entry",
            )
            for line in ways
        ]

    def _error_lines(self) -> Iterator[_Line]:
        """Lines of the gear errors (path, order, error), orders in revolutions of the wheel on ``speed_of``."""
        for multiple, error in self.transmission_error.items():
            yield _Line(("transmission_error", f"{multiple:g}"), multiple * (self.teeth or 1), error)
        if self.run_out:
            yield _Line(("run_out",), 1.0, self.run_out)
        if self.mate_run_out:
            # The mate turns z/z_mate times per revolution of this wheel.
            yield _Line(("mate_run_out",), (self.teeth or 1) / (self.mate_teeth or 1), self.mate_run_out)

    def with_element_data(self, elements: Mapping[str, Element]) -> Self:
        gear, fitted = elements.get(self.mesh), super().with_element_data(elements)
        if not isinstance(gear, Gear) or gear.teeth is None or fitted.speed_of not in gear.nodes:
            return fitted
        own, mate = map(abs, gear.teeth if fitted.speed_of == gear.nodes[0] else gear.teeth[::-1])
        return replace(fitted, teeth=self.teeth or own, mate_teeth=self.mate_teeth or mate)

    def element_faults(self, elements: Mapping[str, Element]) -> list[Fault]:
        gear, mesh = elements[self.mesh], ModelName(self.mesh)
        if not isinstance(gear, Gear):
            text = phrase("{} is a {}; mesh is the name of an element of type gear", mesh, gear.kind)
            if gear.kind in KINDS_WITH_SEVERAL_MESHES:
                own = "write the pair in question as an element of its own, {type: gear, teeth: ..., stiffness: ...}"
                text = phrase("{}; {}", text, own)
            return [Fault(text, ("mesh",), kind="not-applicable")]
        if self.speed_of not in gear.nodes:
            said = "{} connects {} and {}; speed_of is one of them"
            return [Fault(phrase(said, mesh, *map(ModelName, gear.nodes)), ("speed_of",), kind="unknown-node")]
        if gear.housing is not None:
            said = "{} is in a housing that turns; its tooth frequency is not known"
            return [Fault(phrase(said, mesh), ("mesh",), kind="not-applicable")]
        given = [gear.teeth, gear.teeth and gear.teeth[::-1]][gear.nodes.index(self.speed_of)]
        faults = []
        for place, name in enumerate(("teeth", "mate_teeth")):
            count = getattr(self, name)
            needed = self.mate_run_out or (name == "teeth" and self.transmission_error)
            if count is None and needed:
                faults.append(
                    Fault(
                        phrase("{} is given by its ratio; give {}: 23 too", mesh, name),
                        on_key=True,
                        kind="missing-entry",
                    )
                )
            elif count is not None and given is not None and count != abs(given[place]):
                text = phrase("{} has {} teeth there, not {}", mesh, abs(given[place]), count)
                faults.append(Fault(text, (name,), kind="contradicting-values"))
        return faults

    def torques(self, speeds: FloatArray) -> OrderTorques:
        lines = list(self._error_lines())
        radius = self.base_radius or 1.0
        # A way e along the line of action is an angle e/r_b of the wheel with base radius r_b.
        sizes = [line.error.angle if line.error.way is None else line.error.way / radius for line in lines]
        errors = np.array(sizes) * np.exp(1j * np.array([line.error.phase for line in lines]))
        amplitudes = np.broadcast_to(errors[None, :, None], (len(speeds), len(lines), 1)).copy()
        return OrderTorques(np.array([line.order for line in lines]), (self.mesh,), amplitudes)
