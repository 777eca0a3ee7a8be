"""Coordinates of the state space of an FMU, chosen so that its matrices have zeros where the mechanics has them.

The kept coordinates q of a drivetrain are changed, exactly, into three kinds:

    heavy    inertia acts on these, and on nothing else:      M h'' + ..
    damped   massless, but dampers act on these:              C b' + ..
    static   only springs act on these, which give them at once

Angles that change in a rigid-body motion are separate from angles relative to it, so that stiffnesses never see how far
a drivetrain has rotated: their columns for such an angle are empty, not merely small.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from torsionnet.base.errors import UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.fmu.traced_numbers import NumberTape, Traced
from torsionnet.linear.assembly.rows import refuse_actions
from torsionnet.model.elements import Law, Values
from torsionnet.model.elimination import reduce_rows, substitute
from torsionnet.model.kinematics import Kinematics, kinematics_on
from torsionnet.model.parameters import Parameter, evaluation_order

_Names: TypeAlias = tuple[str, ...]


@dataclass(frozen=True)
class Motion:
    """Laws of a drivetrain over the coordinates of its FMU, with how they follow from the parameters.

    Attributes
    ----------
    tape : NumberTape
    parameters : dict
        Every parameter on the tape.
    values : Values
        Values of expressions, on the tape.
    kinematics : Kinematics
        Constraints and coordinates of the drivetrain, on the tape.
    changes : tuple of dict
        Coordinate -> row over the coordinates of the next stage, one after the other.
    heavy, damped, static : tuple of str
        Names of the coordinates, each that of a node.
    relative : frozenset of str
        Coordinates that are no longer the angle of their node alone.
    """

    tape: NumberTape
    parameters: dict[str, Traced]
    values: Values
    kinematics: Kinematics
    changes: tuple[dict[str, Any], ...]
    heavy: tuple[str, ...]
    damped: tuple[str, ...]
    static: tuple[str, ...]
    relative: frozenset[str]

    def over_coordinates(self, row: Mapping[str, Any]) -> dict[str, Traced]:
        """Row of factors on node angles converted to one on the FMU's coordinates, by their names."""
        current: dict[str, Any] = self.kinematics.reduced({node: self.tape.number(a) for node, a in row.items()})
        for change in self.changes:
            current = substitute(current, change)
        return {name: self.tape.number(value) for name, value in current.items()}


def trace_motion(drivetrain: Drivetrain) -> Motion:
    """Coordinates and laws of a drivetrain as they follow from parameters, as many of them left open as possible."""
    settled: set[str] = set()
    while True:
        motion = _traced(drivetrain, settled)
        if motion.tape.settled <= settled:
            return motion
        settled |= motion.tape.settled


def _traced(drivetrain: Drivetrain, settled: Iterable[str]) -> Motion:
    refuse_actions(drivetrain.assembly.system.actions, "an FMU is")
    definition, tape = drivetrain.definition, NumberTape()
    parameters = _parameters(tape, definition.parameters, drivetrain.exact_values, settled)
    values = Values(parameters, tape.algebra)
    kinematics = kinematics_on(values, drivetrain.assembly.kinematics, definition)
    kinds = _Kinds(tape, kinematics)
    return Motion(tape, parameters, values, kinematics, *kinds.found())


class _Kinds:
    """Separation of an FMU's coordinates into heavy, damped and static ones, in three stages."""

    def __init__(self, tape: NumberTape, kinematics: Kinematics) -> None:
        self.tape = tape
        self.coordinates = kinematics.coordinates
        laws = [law for _, law in kinematics.laws if law.acts]
        rows = [kinematics.reduced({node: tape.number(a) for node, a in law.row.items()}) for law in laws]
        self.laws: list[tuple[Law, dict[str, Any]]] = list(zip(laws, rows, strict=True))
        self.changes: list[dict[str, Any]] = []
        self.relative: set[str] = set()

    def found(self) -> tuple[tuple[dict[str, Any], ...], _Names, _Names, _Names, frozenset[str]]:
        """Changes of coordinates, and names of those with inertia, massless with dampers, without either, relative."""
        inertial = [row for law, row in self.laws if self._is_there(law.inertia, row)]
        massless = self._separated(inertial, self.coordinates)
        heavy = tuple(name for name in self.coordinates if name not in massless)
        inside = [(law, {name: a for name, a in row.items() if name in massless}) for law, row in self.laws]
        damping = [row for law, row in inside if row and self._is_there(law.damping, row)]
        static = self._separated(damping, massless)
        damped = tuple(name for name in massless if name not in static)
        elastic = [row for law, row in self.laws if law.is_elastic]
        free = self._separated(elastic, (*heavy, *damped, *static))
        self._require_held(free, static)
        return tuple(self.changes), heavy, damped, static, frozenset(self.relative)

    def _is_there(self, coefficient: Any, row: Mapping[str, Any]) -> bool:
        return bool(row) and bool(self.tape.number(coefficient) != 0)

    def _separated(self, rows: list[dict[str, Any]], order: tuple[str, ...]) -> tuple[str, ...]:
        """Names of the coordinates that ``rows`` leave free, while the others become relative to these."""
        reduction = reduce_rows(rows, {name: place for place, name in enumerate(order)})
        free = tuple(name for name in order if reduction.is_free(name))
        change: dict[str, Any] = {}
        for name in order:
            taken = {} if name in free else reduction.reduced({name: 1})
            if taken:
                change[name] = {name: self.tape.number(1), **taken}
                self.relative.add(name)
        self.laws = [(law, substitute(row, change)) for law, row in self.laws]
        self.changes.append(change)
        return free

    def _require_held(self, free: tuple[str, ...], static: tuple[str, ...]) -> None:
        loose = [name for name in free if name in static]
        if loose:
            raise UsageError(f"nothing resists the motion of {', '.join(loose)}: no inertia, no damper and no spring")


def _parameters(
    tape: NumberTape, definitions: Mapping[str, Parameter], values: Mapping[str, Any], settled: Iterable[str]
) -> dict[str, Traced]:
    """Parameters of a model by name as traced numbers; derived ones follow from others, settled ones are constants."""
    traced: dict[str, Traced] = {}
    for name in evaluation_order(definitions)[0]:
        expression = definitions[name].value
        if name in settled:
            traced[name] = tape.number(values[name])
        elif expression.names:
            traced[name] = expression.evaluate(traced, tape.algebra)
        else:
            traced[name] = tape.parameter(name, values[name])
    return {name: tape.number(traced[name]) for name in definitions}
