"""Excitation by errors of gear teeth, imposed on a compliant mesh."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple, Self

import numpy as np

from torsionnet.base.entries.composite import Nested, one_exactly
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, entry
from torsionnet.base.errors import EntryPath, Fault, ModelName, Worded
from torsionnet.machinery.excitations.harmonic_torque import PHASE, TableByOrder
from torsionnet.machinery.excitations.order_excitation import FloatArray, OrderTorques, register_excitation
from torsionnet.machinery.excitations.twist_excitation import TwistExcitation
from torsionnet.model.element_base.element_entries import ElementName
from torsionnet.model.elements import Element
from torsionnet.model.elements.rigid import Gear


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
    >>> found = mesh.torques(np.array([100.0]))
    >>> found.orders.tolist(), found.amplitudes[0, :, 0].real.round(9).tolist()
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
            return [Fault(text, on_key=True)]
        if self.base_radius is not None:
            return []
        ways = [line for line in self._lines() if line.error.way is not None]
        return [
            Fault("an error given as a way needs the base radius of the wheel: base_radius: 40 mm", (*line.path, "way"))
            for line in ways
        ]

    def _lines(self) -> Iterator[_Line]:
        """Lines of the gear errors (path, order, error), orders in revolutions of the wheel on ``speed_of``."""
        for multiple, error in self.transmission_error.items():
            yield _Line(("transmission_error", f"{multiple:g}"), multiple * (self.teeth or 1), error)
        if self.run_out:
            yield _Line(("run_out",), 1.0, self.run_out)
        if self.mate_run_out:
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
            text = Worded("{} is a {}; mesh is the name of an element of type gear", mesh, gear.kind)
            if gear.kind in KINDS_WITH_SEVERAL_MESHES:
                own = "write the pair in question as an element of its own, {type: gear, teeth: ..., stiffness: ...}"
                text = Worded("{}; {}", text, own)
            return [Fault(text, ("mesh",))]
        if self.speed_of not in gear.nodes:
            said = "{} connects {} and {}; speed_of is one of them"
            return [Fault(Worded(said, mesh, *map(ModelName, gear.nodes)), ("speed_of",))]
        if gear.housing is not None:
            said = "{} is in a housing that turns; its tooth frequency is not known"
            return [Fault(Worded(said, mesh), ("mesh",))]
        given = [gear.teeth, gear.teeth and gear.teeth[::-1]][gear.nodes.index(self.speed_of)]
        faults = []
        for place, name in enumerate(("teeth", "mate_teeth")):
            count = getattr(self, name)
            needed = self.mate_run_out or (name == "teeth" and self.transmission_error)
            if count is None and needed:
                faults.append(Fault(Worded("{} is given by its ratio; give {}: 23 too", mesh, name), on_key=True))
            elif count is not None and given is not None and count != abs(given[place]):
                text = Worded("{} has {} teeth there, not {}", mesh, abs(given[place]), count)
                faults.append(Fault(text, (name,)))
        return faults

    def torques(self, speeds: FloatArray) -> OrderTorques:
        lines = list(self._lines())
        radius = self.base_radius or 1.0
        sizes = [line.error.angle if line.error.way is None else line.error.way / radius for line in lines]
        errors = np.array(sizes) * np.exp(1j * np.array([line.error.phase for line in lines]))
        amplitudes = np.broadcast_to(errors[None, :, None], (len(speeds), len(lines), 1)).copy()
        return OrderTorques(np.array([line.order for line in lines]), (self.mesh,), amplitudes)
