"""Gearbox with several pairs of gears in mesh, one of which is engaged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import one_exactly
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import OneOf, Text, entry
from torsionnet.base.errors import Fault, ModelName, Worded
from torsionnet.base.expression_reading import scalar
from torsionnet.base.expressions import Expression
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodeName, Teeth
from torsionnet.model.element_base.laws import Constraint, Law, Part, Row, Values, difference, make_row
from torsionnet.model.element_base.quantity_table import TableByName

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
            return [Fault(f"{len(self.gears)} gears; a gearbox has at most {MOST_GEARS}", (self._field,))]
        faults = []
        if len({self.input, self.output, self.housing}) < 3:
            faults.append(Fault("input, output and housing must be on different nodes", ("output",)))
        if self.engaged is None:
            text = (
                f"say which gear is engaged, as engaged: {self.gears[0]}; it has {', '.join(self.gears)} and {NEUTRAL}"
            )
            faults.append(Fault(text, on_key=True))
        elif self.engaged not in (*self.gears, NEUTRAL):
            known = f"it has {', '.join(self.gears)} and {NEUTRAL}"
            text = Worded('no gear of {} is named "{}"; {}', ModelName(self.name), self.engaged, known)
            faults.append(Fault(text, ("engaged",)))
        for field in ("wheel_inertias", "stiffness"):
            for name, _ in getattr(self, field):
                if name not in self.gears:
                    said = 'no gear of {} is named "{}"; it has {}'
                    text = Worded(said, ModelName(self.name), name, ", ".join(self.gears))
                    faults.append(Fault(text, (field, name), on_key=True))
        if NEUTRAL in self.gears:
            faults.append(Fault(f"{NEUTRAL} is the state without a gear; give the gear another name", (self._field,)))
        if self.damping is not None and not self.stiffness:
            faults.append(Fault("rigid meshes have no damping; give them a stiffness too", ("damping",)))
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
