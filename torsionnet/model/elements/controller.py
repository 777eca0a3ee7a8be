"""Controller element, a torque that follows the motion of a node by a transfer function."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity, check_unit
from torsionnet.base.entries.spec import EntryError, Spec, entry
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.expressions import Expression
from torsionnet.model.element_base.control_entries import (
    ControlLaw,
    ControlLawEntry,
    OneOrTwoNodes,
    SensedEntry,
    SensedMotion,
    law_expressions,
)
from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.laws import Action, Part, Row, Values, difference, make_row


@register
@dataclass(frozen=True, eq=False, repr=False)
class Controller(Element):
    """A controlled torque: governor, active damper, anti-jerk control, load of a test rig.

    The torque T(s) = H(s) e^(-s tau) y(s) drives the first node of ``act`` and reacts on the second, or on ground; y is
    the angle, velocity or acceleration of a node, or of one node against another. It is positive where it drives, so a
    controller that opposes what it senses has a negative law: ``-300 N*m*s/rad`` on a velocity damps like a damper of
    300 N m s/rad. y is the deviation from the set point, which itself is constant.

    The law H is a gain; ``{p, i, d, filter}``, p + i/s + d s/(1 + filter s); ``{numerator, denominator}``,
    coefficients with the highest power of s first; ``{zeros, poles, gain}`` in rad/s, a complex pair as [re, im]; or
    ``{A, B, C, D}``. Coefficients of the last three are in SI units, numbers or expressions of parameters. In Python it
    may be a ``TransferFunction`` or ``StateSpace`` of python-control. Such an element takes or gives energy at will: a
    drivetrain with one need not be stable (K. J. Astrom and R. M. Murray, Feedback Systems, 2nd ed., chapter 10).

    Examples
    --------
    >>> governor = Controller("governor", sense={"velocity": "crank"}, act="crank", law={"p": -40, "i": -90})
    >>> (action,) = governor.parts(Values({}))
    >>> [int(value) for value in action.numerator], [int(value) for value in action.denominator]
    ([0, -90, -40], [0, 1])
    """

    kind: ClassVar[str] = "controller"
    glyph: ClassVar[str] = "controller"
    sign: ClassVar[str] = "positive when it drives the node in the positive sense"
    drives: ClassVar[bool] = True
    may_feed: ClassVar[bool] = True

    sense: SensedMotion = entry(
        SensedEntry("what it senses: {velocity: node}, or {velocity: [node, node]}; angle, acceleration")
    )
    act: tuple[str, ...] = entry(
        OneOrTwoNodes("the node it drives, or [node, housing] with the one on which the torque reacts")
    )
    law: ControlLaw = entry(
        ControlLawEntry("torque per sensed motion H(s): a gain, PID, polynomials, roots or matrices")
    )
    delay: Expression = entry(PhysicalQuantity("delay of the torque", "time", "tau"), 0)

    @property
    def ports(self) -> dict[str, str]:
        named = zip(("node", "housing", "sensed", "sensed_against"), (*self._pair, *self.sense.nodes), strict=False)
        ports: dict[str, str] = {}
        for name, node in named:
            if node and node not in ports.values():
                ports[name] = node
        return ports

    @property
    def _pair(self) -> tuple[str, str]:
        return self.act[0], self.act[1] if len(self.act) > 1 else ""

    def expressions(self) -> Iterator[tuple[EntryPath, Spec[object], Expression, str]]:
        specs = dict(self.specs())
        for path, expression, dimension in law_expressions(self.law, self.sense.power):
            yield ("law", *path), specs["law"], expression, dimension
        yield from super().expressions()

    def contradictions(self) -> list[Fault]:
        faults = []
        for path, expression, dimension in law_expressions(self.law, self.sense.power):
            try:
                check_unit(expression, dimension or "1")
            except EntryError as error:
                of = f"{error}, for it follows the {self.sense.quantity}" if dimension else f"{error}, in SI units"
                faults.append(Fault(of, ("law", *path), kind="wrong-unit"))
        return faults

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        numerator, denominator = self.law.quotient(value)
        row, sensed = (_row(nodes) for nodes in (self.act, self.sense.nodes))
        rate = (0,) * self.sense.power
        return (Action(row, sensed, (*rate, *numerator), denominator, value(self.delay)),)


def _row(nodes: tuple[str, ...]) -> Row:
    return difference(*nodes) if len(nodes) > 1 else make_row([(nodes[0], 1)])
