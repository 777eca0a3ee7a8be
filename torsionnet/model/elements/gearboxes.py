"""Gearbox with several pairs of gears, and final drive with its differential."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import one_exactly
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import OneOf, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.base.expression_reading import scalar
from torsionnet.base.expressions import Expression
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodeName, Teeth
from torsionnet.model.element_base.laws import Constraint, Law, Part, Row, Values, difference, make_row
from torsionnet.model.element_base.quantity_table import TableByName

# Gearbox with several pairs of gears in mesh, one of which is engaged.

NEUTRAL = "neutral"
"""Word that ``engaged:`` of a gearbox has where no gear is engaged."""
MOST_GEARS = 100
"""Largest number of gears in a gearbox, as a longer table is a slip, and each gear adds a node."""


@register
@dataclass(frozen=True, eq=False, repr=False)
class Gearbox(Element):
    """A gearbox of spur gears: every pair stays in mesh, and a synchroniser joins one loose wheel to its shaft.

    Pair i has the ratio tau_i = omega_input / omega_output = z_output / z_input, negative for opposite senses. One of
    its wheels is fast on its shaft, the other is loose: on the output shaft (then the input shaft drives the loose
    wheels) or on the input shaft. Mesh row, with the loose wheel i on the output shaft: theta_input - tau_i theta_i
    (+ (tau_i - 1) theta_housing); on the input shaft: theta_i - tau_i theta_output (+ ...). It is held at zero, or by
    the stiffness of the teeth, referred to the input. The engaged wheel turns with its shaft; all others run along, so
    that the input shaft feels J_i / tau_i^2 of each loose wheel on the output shaft. In neutral no wheel is engaged.
    The node of wheel i is ``NAME.i``, as ``box.II``: its vibration makes loose gears rattle. Fast wheels belong to the
    inertias of the shafts (H. Naunheimer et al., Automotive Transmissions, 2nd ed.).

    Examples
    --------
    >>> box = Gearbox("box", input="in", output="out", ratios={"I": -4, "II": -2}, engaged="II",
    ...     wheel_inertias={"I": 0.004, "II": 0.002})
    >>> box.internal_nodes, box.engaged_ratio({})
    (('box.I', 'box.II'), Fraction(-2, 1))
    """

    kind: ClassVar[str] = "gearbox"
    glyph: ClassVar[str] = "gearbox"
    sign: ClassVar[str] = "positive when it drives from the input shaft into the gearbox"

    input: str = entry(NodeName("the node of the input shaft", allow_ground=False))
    output: str = entry(NodeName("the node of the output shaft", allow_ground=False))
    ratios: tuple[tuple[str, Expression], ...] = entry(
        TableByName(
            "speed of the input over speed of the output by gear, negative for opposite senses",
            PhysicalQuantity("speed of the input over speed of the output", "1", "tau", None, nonzero=True),
            "ratios by gear, as {I: 3.77, II: 1.96}",
            fewest=1,
        ),
        None,
    )
    teeth: tuple[tuple[str, tuple[int, int]], ...] = entry(
        TableByName(
            "instead: teeth counts [input, output] by gear, one negative for opposite senses",
            Teeth("teeth counts [input, output]"),
            "teeth by gear, as {I: [13, -49], II: [24, -47]}",
            fewest=1,
        ),
        None,
    )
    engaged: str | None = entry(Text(f"the gear that is engaged, or {NEUTRAL}", "the name of a gear"), None)
    loose_wheels: str = entry(OneOf("the shaft with the loose wheels and synchronisers", ("output", "input")), "output")
    wheel_inertias: tuple[tuple[str, Expression], ...] = entry(
        TableByName(
            "inertia of the loose wheels by gear",
            PhysicalQuantity("inertia of the loose wheel", "inertia", "J"),
            "inertias by gear, as {I: 0.004 kg*m^2}",
            fewest=1,
        ),
        None,
    )
    input_inertia: Expression = entry(PhysicalQuantity("input shaft with its fast wheels", "inertia", "J_in"), 0)
    output_inertia: Expression = entry(PhysicalQuantity("output shaft with its fast wheels", "inertia", "J_out"), 0)
    stiffness: tuple[tuple[str, Expression], ...] = entry(
        TableByName(
            "mesh stiffness by gear, referred to the input; none: rigid",
            PhysicalQuantity("mesh stiffness referred to the input", "stiffness", "k", exclusive=True),
            "stiffnesses by gear, as {I: 200 kN*m/rad}",
            fewest=1,
        ),
        None,
    )
    damping: Expression | DampingMeasure | None = entry(
        DampingQuantity("damping of each elastic mesh, referred to the input", "damping", "c"), None
    )
    housing: str | None = entry(NodeName("the node of the housing, if it moves"), None)

    def contradictions(self) -> list[Fault]:
        wrong = one_exactly(self, "ratios", "teeth")
        if wrong:
            return wrong
        if len(self.gears) > MOST_GEARS:
            return [
                Fault(f"{len(self.gears)} gears; a gearbox has at most {MOST_GEARS}", (self._field,), kind="too-large")
            ]
        faults = []
        if len({self.input, self.output, self.housing}) < 3:
            faults.append(Fault("input, output and housing must be on different nodes", ("output",), kind="same-node"))
        if self.engaged is None:
            text = (
                f"say which gear is engaged, as engaged: {self.gears[0]}; it has {', '.join(self.gears)} and {NEUTRAL}"
            )
            faults.append(Fault(text, on_key=True, kind="missing-entry"))
        elif self.engaged not in (*self.gears, NEUTRAL):
            known = f"it has {', '.join(self.gears)} and {NEUTRAL}"
            text = phrase('no gear of {} is named "{}"; {}', ModelName(self.name), self.engaged, known)
            faults.append(Fault(text, ("engaged",), kind="unknown-name"))
        for field in ("wheel_inertias", "stiffness"):
            for name, _ in getattr(self, field):
                if name not in self.gears:
                    said = 'no gear of {} is named "{}"; it has {}'
                    text = phrase(said, ModelName(self.name), name, ", ".join(self.gears))
                    faults.append(Fault(text, (field, name), on_key=True, kind="unknown-name"))
        if NEUTRAL in self.gears:
            faults.append(
                Fault(
                    f"{NEUTRAL} is the state without a gear; give the gear another name",
                    (self._field,),
                    kind="invalid-name",
                )
            )
        if self.damping is not None and not self.stiffness:
            faults.append(
                Fault("rigid meshes have no damping; give them a stiffness too", ("damping",), kind="missing-entry")
            )
        return faults

    @property
    def _field(self) -> str:
        return "teeth" if self.teeth else "ratios"

    @property
    def gears(self) -> tuple[str, ...]:
        """Names of the gears in the order of the file."""
        return tuple(name for name, _ in getattr(self, self._field))

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return tuple(f"{self.name}.{gear}" for gear in self.gears)

    def engaged_ratio(self, parameters: dict[str, Any]) -> Any:
        """Ratio omega_input / omega_output of the engaged gear for given parameter values; None in neutral."""
        return None if self.engaged in (None, NEUTRAL) else self._ratios(Values(parameters))[self.engaged]

    def twist(self, value: Values) -> Row:
        """Weights of node angles, by node, of the engaged gear's mesh; in neutral the mesh row of the first gear."""
        return self._mesh_row(self.gears[0] if self.engaged in (None, NEUTRAL) else self.engaged, value)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        # All gears mesh at all times; the wheel of the engaged one is locked to the shaft on which it is loose.
        parts = [self._mesh(gear, value) for gear in self.gears]
        if self.engaged not in (None, NEUTRAL):
            shaft = self.output if self.loose_wheels == "output" else self.input
            parts.append(Constraint(difference(f"{self.name}.{self.engaged}", shaft)))
        inertias = [(f"{self.name}.{gear}", inertia) for gear, inertia in self.wheel_inertias]
        for node, inertia in (*inertias, (self.input, self.input_inertia), (self.output, self.output_inertia)):
            body = Law(make_row([(node, 1)]), inertia=value(inertia))
            parts += [body] if body.acts else []
        return tuple(parts)

    def _ratios(self, value: Values) -> dict[str, Any]:
        if self.ratios:
            return {gear: value(ratio) for gear, ratio in self.ratios}
        return {gear: value(scalar(output)) / value(scalar(input_)) for gear, (input_, output) in self.teeth}

    def _mesh_row(self, gear: str, value: Values) -> Row:
        tau, wheel = self._ratios(value)[gear], f"{self.name}.{gear}"
        ends = (self.input, wheel) if self.loose_wheels == "output" else (wheel, self.output)
        housing = [] if self.housing is None else [(self.housing, tau - 1)]
        return make_row([(ends[0], 1), (ends[1], -tau), *housing])

    def _mesh(self, gear: str, value: Values) -> Part:
        row, given = self._mesh_row(gear, value), dict(self.stiffness)
        if gear not in given:
            return Constraint(row)
        stiffness = value(given[gear])
        return Law(row, stiffness=stiffness, damping=viscous(self.damping, stiffness, value))


# Final drive: pinion and crown wheel with the differential.


@register
@dataclass(frozen=True, eq=False, repr=False)
class FinalDrive(Element):
    """Pinion and crown wheel, and the differential whose cage the crown wheel is bolted to.

    Mesh row theta_pinion - tau theta_cage (+ (tau - 1) theta_housing) with tau = omega_pinion / omega_cage: held at
    zero, or by the stiffness of the teeth. Differential: 2 theta_cage = theta_left + theta_right; locked, all three
    turn as one; limited-slip, a damping c_s resists theta_left - theta_right besides, as a viscous coupling does, or
    plates whose torque rises with the difference of speeds (for small vibrations; one whose plates stick is locked).
    The cage is the node ``NAME.cage``, or one with a name of its own where a second pinion meshes with the crown wheel.
    The equations are those of ``gear`` and ``differential``.

    Examples
    --------
    >>> axle = FinalDrive("axle", pinion="out", left="l", right="r", ratio=3.45, cage_inertia="0.03 kg*m^2")
    >>> axle.internal_nodes, len(axle.parts(Values({})))
    (('axle.cage',), 3)
    """

    kind: ClassVar[str] = "final_drive"
    glyph: ClassVar[str] = "differential"
    sign: ClassVar[str] = "positive when it drives from the pinion into the final drive"

    pinion: str = entry(NodeName("the node of the pinion", allow_ground=False))
    left: str = entry(NodeName("the node of the left output"))
    right: str = entry(NodeName("the node of the right output"))
    ratio: Expression | None = entry(
        PhysicalQuantity("speed of the pinion over speed of the cage", "1", "tau", None, nonzero=True), None
    )
    teeth: tuple[int, int] | None = entry(
        Teeth("teeth counts [pinion, crown wheel]; one negative: opposite senses"), None
    )
    cage: str | None = entry(NodeName("a node for the cage, where another element meshes with it"), None)
    differential: str = entry(OneOf("what the differential does", ("open", "locked", "limited-slip")), "open")
    slip_damping: Expression | None = entry(
        PhysicalQuantity("limited-slip: torque between the outputs per difference of their speeds", "damping", "c_s"),
        None,
    )
    pinion_inertia: Expression = entry(PhysicalQuantity("inertia of the pinion", "inertia", "J_p"), 0)
    cage_inertia: Expression = entry(PhysicalQuantity("inertia of crown wheel and cage", "inertia", "J_c"), 0)
    stiffness: Expression | None = entry(
        PhysicalQuantity("mesh stiffness referred to the pinion; none: rigid", "stiffness", "k", exclusive=True), None
    )
    damping: Expression | DampingMeasure | None = entry(
        DampingQuantity("mesh damping referred to the pinion", "damping", "c"), None
    )
    housing: str | None = entry(NodeName("the node of the housing, if it moves"), None)

    def contradictions(self) -> list[Fault]:
        faults = one_exactly(self, "ratio", "teeth")
        if self.damping is not None and self.stiffness is None:
            faults.append(
                Fault("a rigid mesh has no damping; give the mesh a stiffness too", ("damping",), kind="missing-entry")
            )
        if (self.differential == "limited-slip") != (self.slip_damping is not None):
            field = "differential" if self.slip_damping is None else "slip_damping"
            faults.append(
                Fault(
                    "a limited-slip differential has a slip_damping, and no other has one",
                    (field,),
                    kind="contradicting-entries",
                )
            )
        nodes = [node for node in (self.pinion, self.left, self.right, self.cage, self.housing) if node is not None]
        if len(set(nodes)) < len(nodes):
            faults.append(
                Fault("pinion, outputs, cage and housing must be on different nodes", ("pinion",), kind="same-node")
            )
        return faults

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return () if self.cage is not None else (f"{self.name}.cage",)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        cage = self.cage if self.cage is not None else f"{self.name}.cage"
        inertias = ((self.pinion, self.pinion_inertia), (cage, self.cage_inertia))
        bodies = [Law(make_row([(node, 1)]), inertia=value(inertia)) for node, inertia in inertias]
        return (self._mesh(cage, value), *self._differential(cage, value), *(body for body in bodies if body.acts))

    def _mesh(self, cage: str, value: Values) -> Part:
        tau = value(self.ratio) if self.teeth is None else value(scalar(self.teeth[1])) / value(scalar(self.teeth[0]))
        # Against the housing theta_p = tau theta_c, so that theta_p - tau theta_c + (tau - 1) theta_h = 0.
        housing = [] if self.housing is None else [(self.housing, tau - 1)]
        row = make_row([(self.pinion, 1), (cage, -tau), *housing])
        if self.stiffness is None:
            return Constraint(row)
        stiffness = value(self.stiffness)
        return Law(row, stiffness=stiffness, damping=viscous(self.damping, stiffness, value))

    def _differential(self, cage: str, value: Values) -> tuple[Part, ...]:
        if self.differential == "locked":
            return Constraint(difference(cage, self.left)), Constraint(difference(cage, self.right))
        # The planets let the cage turn with the mean of both outputs: 2 theta_c = theta_l + theta_r.
        planets = Constraint(make_row([(cage, 2), (self.left, -1), (self.right, -1)]))
        if self.differential == "open":
            return (planets,)
        # Limited slip brakes the difference of the outputs.
        return planets, Law(difference(self.left, self.right), damping=value(self.slip_damping))
