"""Laws of motion of a plant that do not follow straight pieces, apart from those that do, and phases of arc springs.

Phases of arc springs over time, made as the motion comes to them.

Between two reversals of the twist the torque of a chain of segments is a line of straight pieces, whose corners are the
twists at which another segment begins to slide. At a reversal the chain takes the twist, and a new branch begins: each
piece of a branch is a phase that ends at its corner, or where the rate changes its sign. A phase is never come back to.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import FLOAT
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.model.arc_spring.arc_curve import ArcCurve
from torsionnet.model.arc_spring.segment_chain import SegmentChain
from torsionnet.model.element_base.laws import MotionState, TorqueCurve
from torsionnet.model.elements import MotionLaw, Values
from torsionnet.model.motion_laws.piece_curve import PieceCurve, Slope
from torsionnet.motion.motion_plant import LawOverCoordinates, LawPhases, MotionPlant, Phase, PlacedLaw, law_phases
from torsionnet.motion.scenarios.scenario import GridTie

# Phases of arc springs over time, made as the motion comes to them.

FAR = 10.0
"""Twist in rad beyond a reversal up to which a branch is worked out; its last piece goes on."""
SHORTEST = 1e-13
"""Twist in rad below which a piece of a branch is none."""


@dataclass(frozen=True)
class ChainPhase(Phase):
    """Straight piece of a branch on which the twist goes the way ``sense``; ``chain`` is that at its reversal."""

    chain: SegmentChain | None = None

    def energy(self, twist: float) -> float:
        """Energy in J in the springs of the chain at a twist in rad on the branch."""
        if self.chain is None:
            return 0.0
        here = copy.copy(self.chain)
        here.lead(twist)
        return here.energy


@dataclass(frozen=True, eq=False)
class ChainPhases(LawPhases):
    """Phases of a law of arc springs in the order in which a motion comes to them; ``course`` has the branch ahead."""

    phases: list[Phase]
    course: ChainCourse

    def begun(self, twist: float, rate: float) -> int:
        """Number of the phase in which a motion begins at a twist in rad: springs loaded to it from nothing."""
        self.course.chain = SegmentChain(self.course.curve.springs, self.course.curve.segments)
        self.course.chain.lead(twist)
        return self._entered(self.course.branch(-1 if rate < 0 else 1))

    def passed_corner(self) -> int:
        """Number of the phase behind the corner at the end of the last one."""
        return self._entered(self.course.ahead)

    def turned(self, twist: float) -> int:
        """Number of the phase behind a reversal at a twist in rad."""
        self.course.chain.lead(twist)
        return self._entered(self.course.branch(-self.phases[-1].sense))

    def _entered(self, ahead: list[ChainPhase]) -> int:
        self.phases.append(replace(ahead.pop(0), place=len(self.phases)))
        return len(self.phases) - 1


def chain_phases(owner: str, curve: ArcCurve) -> ChainPhases:
    """Phases of arc springs before their motion: the stiffest piece, by which steps are chosen."""
    stiffest = Phase("slope", 0, stiffness=2 * curve.segments * curve.springs.stiffness)
    return ChainPhases(owner, False, [stiffest], ChainCourse(curve, SegmentChain(curve.springs, curve.segments), []))


@dataclass
class ChainCourse:
    """Chain at its last reversal, and the pieces of the branch that lie ahead."""

    curve: ArcCurve
    chain: SegmentChain
    ahead: list[ChainPhase]

    def branch(self, sense: int) -> list[ChainPhase]:
        """Pieces of the branch that begins at the last reversal, in the way ``sense`` of the twist."""
        begun = copy.copy(self.chain)
        line = copy.copy(begun).lead(begun.twist + sense * FAR)
        self.ahead = []
        for place in range(len(line.twists) - 1):
            start, end = line.twists[place : place + 2].tolist()
            torque, reached = line.torques[place : place + 2].tolist()
            if abs(end - start) <= SHORTEST:
                continue
            # Straight between the twists at which a further coil begins to move; each piece ends where the next begins.
            stiffness = (reached - torque) / (end - start)
            self.ahead.append(
                ChainPhase(
                    "slope", 0, torque - stiffness * start, stiffness, sense=sense, chain=begun,
                    lower=-math.inf if sense > 0 else end, upper=end if sense > 0 else math.inf,
                )
            )  # fmt: skip
        self.ahead[-1] = replace(self.ahead[-1], lower=-math.inf, upper=math.inf)
        return self.ahead


# Laws of motion of a plant that do not follow straight pieces, apart from those that do.

Scale = tuple[str, str]
"""Element, and the name of what scales its torque, as ``("clutch", "clamp")``."""


@dataclass(frozen=True, eq=False)
class SmoothLaw:
    """Law of motion whose torque is worked out at every time, over the coordinates.

    Attributes
    ----------
    owner : str
    law : MotionLaw
        With floats as coefficients.
    number : int
        Number of the placed law in the assembly, -1 for one that supplies power from outside, as that of a grid.
    row : (n_q,) array
        Weights of the coordinates in gamma.
    sensed : (n_sensed, n_q) array
        Those of the rows whose rates the curve follows.
    scale : int
        Number of the entry among the scales that scales the torque, -1 for none.
    held : int
        Number of the law of straight pieces that holds the row still where this one sticks, -1 for none.
    lag : float
        Time constant in s with which the torque follows the curve, 0 for none.
    """

    owner: str
    law: MotionLaw
    number: int
    row: FloatArray
    sensed: FloatArray
    scale: int = -1
    held: int = -1
    lag: float = 0.0

    @property
    def over_rate(self) -> bool:
        """Whether the torque follows the rate."""
        return self.law.curve.over == "rate"

    def torque(self, twist: float, rates: FloatArray, scale: float) -> float:
        """Torque in N m against the motion from the twist in rad and the rates of the row and of the sensed rows."""
        return scale * float(self.law.curve.torque(twist, *rates.tolist()))

    def slope(self, twist: float, rates: FloatArray, bends: FloatArray, scale: float) -> float:
        """Rate of change in N m/s of the torque under a constant scale, with the rates of change of ``rates``."""
        rate, *sensed = rates.tolist()
        # dT/dt = dT/dgamma gamma' + dT/dgamma' gamma'' + the same over the rates sensed
        over_twist, *others = self.law.curve.slopes(MotionState(twist, rate, tuple(sensed)))
        own = float(over_twist) * float(rate)
        rest = sum(float(slope) * float(bend) for slope, bend in zip(others, bends, strict=False))
        return scale * (own + rest)

    def on_piece(self, place: int) -> SmoothLaw:
        """Law with the straight line of one piece of its curve throughout, so that no stage of a step meets a jump."""
        curve = self.law.curve
        assert isinstance(curve, PieceCurve)
        piece = curve.pieces[place]
        assert isinstance(piece, Slope)
        line = replace(piece, lower=None, upper=None)
        return replace(self, law=replace(self.law, curve=PieceCurve(curve.over, (line,))))

    def left(self, twist: float, rates: FloatArray) -> str:
        """Message that the motion lies beyond an end of the curve; else empty."""
        return self.law.curve.left(twist, *rates.tolist())


@dataclass(frozen=True, eq=False)
class SplitPlant:
    """Plant with its laws of straight pieces, their phases, and its smooth laws.

    ``scale_of`` is for each law of straight pieces the number of its scale among ``scales``, -1 for none.
    """

    plant: MotionPlant
    phases: tuple[LawPhases, ...]
    scale_of: tuple[int, ...]
    smooth: tuple[SmoothLaw, ...]
    scales: tuple[Scale, ...]


def split_plant(drivetrain: AssembledModel, plant: MotionPlant, scales: tuple[Scale, ...] = ()) -> SplitPlant:
    """Plant of a drivetrain with its laws of straight pieces apart from its smooth ones.

    ``scales`` are what is given over time: a law that grows with its motion and is scaled over time counts as smooth.

    Raises
    ------
    UsageError
        Nothing that the model has is scaled so.
    """
    floats = float_laws(drivetrain, plant)
    named = {(row.owner, floats[row.number].scaled_by) for row in plant.laws if floats[row.number].scaled_by}
    for owner, what in scales:
        if (owner, what) not in named:
            own = ", ".join(name for element, name in sorted(named) if element == owner) or "nothing"
            raise UsageError(
                f'the torque of {owner} does not follow "{what}" over time; {own} scales it', kind="unsupported-law"
            )
    pieces: list[LawOverCoordinates] = []
    phases: list[LawPhases] = []
    scale_of: list[int] = []
    smooth: list[SmoothLaw] = []
    for placed in plant.laws:
        law = floats[placed.number]
        key = (placed.owner, law.scaled_by)
        scale = scales.index(key) if key in scales else -1
        if isinstance(law.curve, ArcCurve):
            pieces.append(replace(placed, law=law))
            phases.append(chain_phases(placed.owner, law.curve))
            scale_of.append(-1)
            continue
        straight = isinstance(law.curve, PieceCurve)
        # A slope times a scale over time is no straight piece.
        grows = isinstance(law.curve, PieceCurve) and any(
            isinstance(part, Slope) and bool(part.stiffness or part.damping) for part in law.curve.pieces
        )
        if scale >= 0 and law.curve.over == "twist":
            raise UsageError(
                f"{placed.owner}: a torque over the twist cannot be scaled over time", kind="unsupported-law"
            )
        if straight and not (scale >= 0 and grows):
            pieces.append(replace(placed, law=law))
            phases.append(law_phases(placed.owner, law, scaled=scale >= 0))
            scale_of.append(scale)
            continue
        sensed = np.array([plant.assembly.rows_of(row)[0] for row in law.sensed]).reshape(-1, len(placed.row))
        held = -1
        # Steps, in which friction sticks, stay with the straight pieces and have no torque on these.
        if straight:
            held = len(pieces)
            pieces.append(replace(placed, law=law))
            phases.append(_steps_alone(placed.owner, law))
            scale_of.append(scale)
        smooth.append(SmoothLaw(placed.owner, law, placed.number, placed.row, sensed, scale, held, float(law.lag)))
    return SplitPlant(replace(plant, laws=tuple(pieces)), tuple(phases), tuple(scale_of), tuple(smooth), scales)


def tied_plant(split: SplitPlant, tie: GridTie, laws: Sequence[TorqueCurve], row: FloatArray) -> SplitPlant:
    """Plant with curves of a grid over a row of the coordinates, each scaled by an entry after the other scales."""
    count = len(split.scales)
    added = tuple(
        SmoothLaw(tie.machine, MotionLaw({}, curve), -1, row, np.zeros((0, len(row))), count + number)
        for number, curve in enumerate(laws)
    )
    scales = tuple((tie.machine, f"grid {number}") for number in range(len(laws)))
    return replace(split, smooth=(*split.smooth, *added), scales=(*split.scales, *scales))


def float_laws(drivetrain: AssembledModel, plant: MotionPlant) -> Mapping[int, MotionLaw]:
    """Laws of motion with floats as coefficients, by the number of their placed laws."""
    value = Values(drivetrain.exact_values, FLOAT)
    own: dict[str, list[Any]] = {
        element.name: [part for part in element.whole_parts(value) if isinstance(part, MotionLaw)]
        for element in drivetrain.definition.switched_on
    }
    laws: dict[int, MotionLaw] = {}
    for number, (owner, law) in enumerate(zip(plant.assembly.owners, plant.assembly.laws, strict=True)):
        if isinstance(law, PlacedLaw):
            laws[number] = own[owner].pop(0)
    return laws


def _steps_alone(owner: str, law: MotionLaw) -> LawPhases:
    """Phases of a law of straight pieces with its steps, and without torque on its pieces."""
    assert isinstance(law.curve, PieceCurve)
    bare = tuple(
        replace(piece, torque=0.0, stiffness=0.0, damping=0.0) if isinstance(piece, Slope) else piece
        for piece in law.curve.pieces
    )
    return law_phases(owner, replace(law, curve=replace(law.curve, pieces=bare)), scaled=True)
