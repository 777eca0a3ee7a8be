"""Plant of a motion over time: a drivetrain whose laws of motion are set apart from its linear parts."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray, RowSystem
from torsionnet.linear.assembly.system import Assembly
from torsionnet.linear.dynamic_stiffness.action_states import LawStates, law_states
from torsionnet.linear.dynamic_stiffness.row_algebra import null_space
from torsionnet.model.element_base.element import OtherLaws
from torsionnet.model.elements import Element, Law, MotionLaw, Part, Values

MOST_REMEMBERED = 256
"""Most things remembered of a plant, which take some ten kB each for large drivetrains."""


@dataclass(frozen=True)
class PlacedLaw(Law):
    """Law that holds the place of a law of motion among the linear laws; its coefficients stand for nothing."""

    motion: MotionLaw | None = None


@dataclass(frozen=True)
class PlacedLaws(OtherLaws):
    """Laws of an element in full, with a placed law for each law of motion."""

    def parts(self, value: Values) -> tuple[Part, ...]:
        return tuple(
            PlacedLaw(part.row, stiffness=1, motion=part) if isinstance(part, MotionLaw) else part
            for part in self.element.whole_parts(value)
        )


@dataclass(frozen=True, eq=False)
class LawRow:
    """Law of motion of an element over the coordinates.

    Attributes
    ----------
    owner : str
        Name of the element.
    law : MotionLaw
    number : int
        Number of the placed law in the assembly.
    row : (n_q,) array
        Weights of the coordinates in gamma.
    """

    owner: str
    law: MotionLaw
    number: int
    row: FloatArray


@dataclass(frozen=True, eq=False)
class MotionPlant:
    """Drivetrain with placed laws, its laws of motion, and its controllers.

    M q'' + C q' + K q + sum_l b_l T_l(gamma_l, gamma_l') = f, with gamma_l = b_l^T q.
    """

    drivetrain: AssembledModel
    laws: tuple[LawRow, ...]
    actions: tuple[LawStates, ...]
    memo: dict[Hashable, Any] = field(default_factory=dict, init=False, compare=False, repr=False)

    @property
    def assembly(self) -> Assembly:
        """Assembly of the plant, in which placed laws stand for the laws of motion."""
        return self.drivetrain.assembly

    @cached_property
    def linear(self) -> RowSystem:
        """System of the linear laws alone, with zeros in the places of the laws of motion."""
        whole = self.assembly.system
        placed = [number for number, law in enumerate(self.assembly.laws) if isinstance(law, PlacedLaw)]
        stiffness, damping = whole.stiffness.copy(), whole.damping.copy()
        stiffness[placed] = damping[placed] = 0.0
        return RowSystem(whole.law_rows, whole.inertia.copy(), damping, stiffness, actions=whole.actions)

    def remembered(self, key: Hashable, made: Callable[[], Any]) -> Any:
        """Object that contact states of the plant share under a key, made when first asked for."""
        if key not in self.memo:
            if len(self.memo) >= MOST_REMEMBERED:
                self.memo.clear()
            self.memo[key] = made()
        return self.memo[key]

    @cached_property
    def turning(self) -> tuple[tuple[int, FloatArray], ...]:
        """Motions of the coordinates that twist nothing, each with a coordinate that it turns by 1 and no other does.

        Their angles grow without bounds. Rounding of what they move, which is nothing, must not grow with them.
        """
        system = self.assembly.system
        laws = zip(system.sparse_rows, system.stiffness, self.assembly.laws, strict=True)
        elastic = [row for row, stiffness, law in laws if stiffness and not _is_over_rate(law)]
        felt = [one for one in self.actions if one.at_once[0] or one.G[:, 0].any()]  # with their states at rest
        sensed = [dict(enumerate(one.sensed.tolist())) for one in felt]
        rows = [*elastic, *({place: value for place, value in row.items() if value} for row in sensed)]
        found = []
        for column in null_space(rows, system.n_coordinates).columns:
            pivot, size = next(iter(column.items()))
            whole = np.zeros(system.n_coordinates)
            whole[list(column)] = np.array(list(column.values())) / size
            found.append((pivot, whole))
        return tuple(found)


def _is_over_rate(law: Law) -> bool:
    return isinstance(law, PlacedLaw) and law.motion is not None and law.motion.curve.over == "rate"


def has_laws_of_motion(drivetrain: AssembledModel) -> bool:
    """Whether an element of a drivetrain that is switched on has a law of motion in full.

    Elements that are linear about a working point of their own, as a clutch with a slip speed, ask for none.
    """
    value: Values | None = None
    for element in drivetrain.definition.switched_on:
        if element.has_motion_laws and not element.has_own_working_point:
            value = value or Values(drivetrain.exact_values)
            if any(isinstance(part, MotionLaw) for part in element.whole_parts(value)):
                return True
    return False


def motion_plant(drivetrain: AssembledModel) -> MotionPlant:
    """Plant of a drivetrain, with its laws of motion apart from its linear parts.

    Raises
    ------
    UsageError
        A delay, or a law that depends on frequency, beside laws of motion.
    """
    elements: dict[str, Element] = dict(drivetrain.definition.elements)
    for element in drivetrain.definition.switched_on:
        elements[element.name] = element.unchecked(
            other_laws=PlacedLaws(element),
            referred_to=None,  # these elements have been converted
        )
    plain = drivetrain.with_definition(replace(drivetrain.definition, elements=elements, tangents=None))
    assembly = plain.assembly
    _refuse(assembly)
    laws = tuple(
        LawRow(owner, law.motion, number, assembly.rows_of(law.row)[0])
        for number, (owner, law) in enumerate(zip(assembly.owners, assembly.laws, strict=True))
        if isinstance(law, PlacedLaw) and law.motion is not None
    )
    moving = tuple(one for one in laws if np.abs(one.row).max(initial=0.0) > 0)
    return MotionPlant(plain, moving, law_states(assembly))


def _refuse(assembly: Assembly) -> None:
    system = assembly.system
    over_frequency = {assembly.owners[number] for number, _ in system.dynamic}
    delayed = {one.owner for one in system.actions if one.delay}
    if over_frequency:
        names = ", ".join(sorted(over_frequency))
        text = "depends on frequency and cannot move in time beside laws of motion, nor from a given start"
        advice = "give a stiffness and a damping, or use at() for small motion about an operating point"
        raise UsageError(f"{names}: {text}; {advice}")
    if delayed:
        names = ", ".join(sorted(delayed))
        text = "a delay cannot act in time beside laws of motion, nor from a given start"
        raise UsageError(f"{names}: {text}; leave it out, or use at() for small motion about an operating point")
