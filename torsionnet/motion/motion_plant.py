"""Plant of a motion over time: a drivetrain whose laws of motion are set apart from its linear parts.

Phases of a law of motion: straight pieces and steps of its curve, and contacts that are loose where bodies overlap. A
contact gives max(0, k d + c d') at a penetration d. Where that sum is negative the bodies are still within each other's
reach but free: the phase ``"free"`` of the piece.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import Assembly, FloatArray, RowSystem
from torsionnet.linear.dynamic_stiffness.action_states import LawStates, law_states
from torsionnet.linear.dynamic_stiffness.row_algebra import null_space
from torsionnet.model.element_base.element import OtherLaws
from torsionnet.model.elements import Element, Law, MotionLaw, Part, Values
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve, Slope

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
class LawOverCoordinates:
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
    laws: tuple[LawOverCoordinates, ...]
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
        # Motions that neither springs nor contacts nor controllers feel.
        elastic = [row for row, stiffness, law in laws if stiffness and not _is_over_rate(law)]
        felt = [law for law in self.actions if law.at_once[0] or law.G[:, 0].any()]  # with their states at rest
        sensed = [dict(enumerate(action.sensed.tolist())) for action in felt]
        rows = [*elastic, *({place: value for place, value in row.items() if value} for row in sensed)]
        turning = []
        for column in null_space(rows, system.n_coordinates).columns:
            pivot, size = next(iter(column.items()))
            whole = np.zeros(system.n_coordinates)
            whole[list(column)] = np.array(list(column.values())) / size
            turning.append((pivot, whole))
        return tuple(turning)


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
    plant = placed_plant(drivetrain)
    _refuse(plant.assembly)
    return replace(plant, actions=law_states(plant.assembly))


def over_time(drivetrain: AssembledModel) -> AssembledModel:
    """Drivetrain whose elements have the laws of their motion over time."""
    active = drivetrain.definition.switched_on
    moved = {element.name: element.over_time for element in active if element.over_time is not element}
    if not moved:
        return drivetrain
    elements = {**drivetrain.definition.elements, **moved}
    return drivetrain.with_definition(replace(drivetrain.definition, elements=elements))


def placed_plant(drivetrain: AssembledModel) -> MotionPlant:
    """Plant of a drivetrain over frequency, also with delays and tables, without states of its controllers."""
    elements: dict[str, Element] = dict(drivetrain.definition.elements)
    for element in drivetrain.definition.switched_on:
        elements[element.name] = element.unchecked(
            other_laws=PlacedLaws(element),
            referred_to=None,  # these elements have been converted
        )
    plain = drivetrain.with_definition(replace(drivetrain.definition, elements=elements, tangents=None))
    assembly = plain.assembly
    laws = tuple(
        LawOverCoordinates(owner, law.motion, number, assembly.rows_of(law.row)[0])
        for number, (owner, law) in enumerate(zip(assembly.owners, assembly.laws, strict=True))
        if isinstance(law, PlacedLaw) and law.motion is not None
    )
    moving = tuple(law for law in laws if np.abs(law.row).max(initial=0.0) > 0)
    return MotionPlant(plain, moving, ())


def _refuse(assembly: Assembly) -> None:
    system = assembly.system
    over_frequency = {assembly.owners[number] for number, _ in system.dynamic}
    delayed = {action.owner for action in system.actions if action.delay}
    if over_frequency:
        names = ", ".join(sorted(over_frequency))
        text = "depends on frequency and cannot move in time beside laws of motion, nor from a given start"
        advice = "give a stiffness and a damping, or use at() for small motion about an operating point"
        raise UsageError(f"{names}: {text}; {advice}", kind="unsupported-law")
    if delayed:
        names = ", ".join(sorted(delayed))
        text = "a delay cannot act in time beside laws of motion, nor from a given start"
        raise UsageError(
            f"{names}: {text}; leave it out, or use at() for small motion about an operating point",
            kind="unsupported-law",
        )


# Places of the parts of the state z of a motion, and what drives a plant from outside.


@dataclass(frozen=True)
class Layout:
    """Places of the parts of z, by their sizes.

    ``n_q`` coordinates, ``n_c`` states of controllers, ``n_w`` states of generators, ``n_u`` torques and scales.
    """

    n_q: int
    n_c: int
    n_w: int
    n_u: int

    @property
    def q(self) -> slice:
        return slice(0, self.n_q)

    @property
    def v(self) -> slice:
        return slice(self.n_q, 2 * self.n_q)

    @property
    def controllers(self) -> slice:
        return slice(2 * self.n_q, 2 * self.n_q + self.n_c)

    @property
    def w(self) -> slice:
        return slice(self.constant - self.n_w, self.constant)

    @property
    def constant(self) -> int:
        """Place of the state that is always 1, by which torques that do not depend on the motion enter its matrix."""
        return 2 * self.n_q + self.n_c + self.n_w

    @property
    def n_p(self) -> int:
        """Number of the states before the torques u."""
        return self.constant + 1

    @property
    def u(self) -> slice:
        return slice(self.n_p, self.n_p + self.n_u)

    @property
    def slope(self) -> slice:
        return slice(self.n_p + self.n_u, self.size)

    @property
    def size(self) -> int:
        return self.n_p + 2 * self.n_u


@dataclass(frozen=True, eq=False)
class Drive:
    """Torques and scales that act on a plant from outside.

    Attributes
    ----------
    columns : (n_q, n_torques) array
        Weights of the torques on the coordinates.
    scale_of : tuple of int
        For each law the number of the entry of u that scales it, -1 for none; scales stand in u after the torques.
    n_scales : int
    F : (n_w, n_w) array
        Generators w' = F w, in 1/s.
    S : (n_u, n_w) array
        What generators add to u.
    """

    columns: FloatArray
    scale_of: tuple[int, ...]
    n_scales: int
    F: FloatArray
    S: FloatArray

    @property
    def n_u(self) -> int:
        return int(self.columns.shape[1]) + self.n_scales


# Phases of a law of motion: straight pieces and steps of its curve, and contacts that are loose where bodies overlap.


@dataclass(frozen=True)
class Phase:
    """Phase of a law: torque + stiffness gamma + damping gamma' in SI units between bounds, or a row held at a place.

    ``place`` is the number of the piece in its curve. Of a hold, ``lower`` and ``upper`` are both the place where the
    row is held, and ``low`` and ``high`` the torques at which it lets go. A phase with a ``sense`` ends where the rate
    has not its sign.
    """

    kind: Literal["slope", "free", "hold"]
    place: int
    torque: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0
    lower: float = -math.inf
    upper: float = math.inf
    side: int = 0
    low: float = 0.0
    high: float = 0.0
    sense: int = 0

    def at(self, twist: float, rate: float) -> float:
        """Torque in N m of the straight line of the phase at a twist in rad and a rate in rad/s."""
        return self.torque + self.stiffness * twist + self.damping * rate


@dataclass(frozen=True)
class LawPhases:
    """Phases of one law of an element, with its scale left out where that is given over time.

    ``over_rate`` says whether the bounds are rates.
    """

    owner: str
    over_rate: bool
    phases: Sequence[Phase]

    def of_piece(self, place: int, kind: str = "") -> int:
        """Number of the phase of a piece, of its free phase with ``kind`` "free"."""
        numbers = [number for number, phase in enumerate(self.phases) if phase.place == place]
        return numbers[-1] if kind == "free" and len(numbers) > 1 else numbers[0]

    @property
    def last_place(self) -> int:
        return self.phases[-1].place


def law_phases(owner: str, law: MotionLaw, *, scaled: bool = False) -> LawPhases:
    """Phases of a law of straight pieces, as floats; ``scaled`` leaves its scale out.

    Raises
    ------
    UsageError
        The curve is not one of straight pieces, or a law whose scale is given over time is more than a torque.
    """
    curve = law.curve
    if not isinstance(curve, PieceCurve):
        raise UsageError(f"{owner}: its torque does not follow straight pieces", kind="unsupported-law")
    scale = 1.0 if scaled else float(law.scale)
    phases: list[Phase] = []
    for place, piece in enumerate(curve.pieces):
        if isinstance(piece, Hold):
            at = float(piece.at)
            phases.append(
                Phase("hold", place, lower=at, upper=at, low=scale * float(piece.low), high=scale * float(piece.high))
            )
        else:
            phases += _of_slope(place, piece, scale)
    if scaled and any(phase.stiffness or phase.damping for phase in phases):
        raise UsageError(
            f"{owner}: a law whose torque grows with its motion cannot be scaled over time here", kind="unsupported-law"
        )
    return LawPhases(owner, curve.over == "rate", tuple(phases))


def _of_slope(place: int, piece: Slope, scale: float) -> list[Phase]:
    lower = -math.inf if piece.lower is None else float(piece.lower)
    upper = math.inf if piece.upper is None else float(piece.upper)
    torque, stiffness, damping = (scale * float(value) for value in (piece.torque, piece.stiffness, piece.damping))
    phases = [Phase("slope", place, torque, stiffness, damping, lower, upper, piece.side)]
    # max(0, k d + c d'): within reach of each other, but free, where the damper would pull.
    if piece.side and damping:
        phases.append(Phase("free", place, torque, stiffness, damping, lower, upper, piece.side))
    return phases
