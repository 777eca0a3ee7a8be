"""Phases of arc springs over time, made as the motion comes to them.

Between two reversals of the twist the torque of a chain of segments is a line of straight pieces, whose corners are the
twists at which another segment begins to slide. At a reversal the chain takes the twist, and a new branch begins: each
piece of a branch is a phase that ends at its corner, or where the rate changes its sign. A phase is never come back to.
"""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass, replace

from torsionnet.model.arc_spring.arc_curve import ArcCurve
from torsionnet.model.arc_spring.segment_chain import SegmentChain
from torsionnet.motion.motion_plant import LawPhases, Phase

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
