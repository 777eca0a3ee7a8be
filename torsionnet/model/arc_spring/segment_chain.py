"""Arc springs as a chain of n segments with Coulomb's friction, marched slowly and exactly from reversal to reversal.

Springs 2 n k stand between the flange and the first segment and between the last one and its stop, n k between the
segments, T_0 = 2 n k (gamma - theta_1), T_j = n k (theta_j - theta_(j+1)), T_n = 2 n k theta_n. At both ends they push
and never pull. A segment rests while

    |T_(j-1) - T_j| <= (mu/n) (C + psi (T_(j-1) + T_j)/2),

which in u = T + C/psi is a bound rho = (1 + e/(2 n))/(1 - e/(2 n)) of the ratio of neighbouring u. While the twist goes
one way, sliding spreads inward from the flange: segments 1 to s slide, u_j = u_0 rho^(-+j), the others keep their
places. The balance is then linear in u_0, and between the twists at which another segment begins to slide the torque
is a straight line over the twist. Negative twists are the mirror image, pushed from the other end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.model.arc_spring.slow_loop import ArcSprings, SlowLoop

LOSS_SEGMENTS, STIFFNESS_SEGMENTS = 9.0, 4.0
"""n times depth for 1 % of the loss and of the stiffness; both errors fall as 1/n^2."""
CYCLES = 40
"""Most cycles until a loop repeats; without lifting of the flange the second does."""
REPEATED = 1e-9
"""Change of the torques at the tips, over the larger of them, below which a cycle repeats the one before."""


def segments_needed(depth: float, loss: float = 0.01, stiffness: float = math.inf) -> int:
    """Fewest segments that give loss and stiffness of a cycle within shares, n >= 9/depth and 4/depth for 1 %.

    >>> segments_needed(0.478), segments_needed(0.478, math.inf, 0.01)
    (19, 9)
    """
    fewest = max(LOSS_SEGMENTS * math.sqrt(0.01 / loss), STIFFNESS_SEGMENTS * math.sqrt(0.01 / stiffness))
    return max(2, math.ceil(fewest / depth - 1e-9))


@dataclass(frozen=True)
class LoopBranch:
    """Straight pieces of torque in N m over twist in rad from one reversal to the next."""

    twists: NDArray[np.float64]
    torques: NDArray[np.float64]

    @property
    def area(self) -> float:
        """Work done on the springs, integral of the torque over the twist in J."""
        return float(np.sum((self.torques[1:] + self.torques[:-1]) / 2 * np.diff(self.twists)))


class SegmentChain:
    """Places of the segments of arc springs, from nothing on, under a twist that is led slowly.

    >>> chain = SegmentChain(ArcSprings(700.0, 2.6, 0.12, 0.9, 0.11, 100 * math.pi), 40)
    >>> branch = chain.lead(math.radians(20))
    >>> round(float(branch.torques[-1]), 1)
    352.3
    """

    def __init__(self, springs: ArcSprings, segments: int) -> None:
        self.springs, self.segments = springs, segments
        share = springs.winding / (2 * segments)
        if share >= 1:
            raise ArithmeticError(f"{segments} segments are too few for mu psi = {springs.winding:.4g}")
        self.ratio = (1 + share) / (1 - share)
        self.places = np.zeros(segments)
        self.twist = 0.0
        self.moved = 0  # segments that slid at the end of the last branch

    @property
    def energy(self) -> float:
        """Energy in J stored in the springs between flange, segments and stops."""
        k, pushed = self.segments * self.springs.stiffness, (max(self.twist, 0.0), min(self.twist, 0.0))
        # 2 n k at both ends, which push only, and n k between: T^2/(2 k) of each.
        ends = max(0.0, pushed[0] - float(self.places[0])), max(0.0, float(self.places[-1]) - pushed[1])
        return k * (ends[0] ** 2 + ends[1] ** 2 + float(np.sum(np.diff(self.places) ** 2)) / 2)

    def lead(self, twist: float) -> LoopBranch:
        """Branch of torque over twist on the way to another twist in rad."""
        points: list[tuple[float, float]] = []
        while True:
            # At zero twist the flange leaves one end of the springs and takes up the other.
            crosses = self.twist * twist < 0
            to = 0.0 if crosses else twist
            side = math.copysign(1.0, self.twist or twist)
            points += self._led(side, to)
            self.twist = to
            if not crosses:
                break
        twists, torques = np.array(points).T
        return LoopBranch(twists, torques)

    def _led(self, side: float, twist: float) -> list[tuple[float, float]]:
        """Corners of the branch on one side of zero, where ``side`` is the sign of the twist."""
        # Mirrored, a negative twist is a positive one that pushes the last segment.
        places = self.places if side > 0 else -self.places[::-1]
        walk = _Walk(self, places, side * self.twist, side * twist)
        self.places = walk.places if side > 0 else -walk.places[::-1]
        self.moved = walk.front
        return [(side * at, side * torque) for at, torque in walk.corners]


class _Walk:
    """Motion of the chain while the flange goes one way from one positive twist to another.

    Attributes
    ----------
    corners : list of (float, float)
        Twist and torque at the start, wherever another segment begins to slide, and at the end.
    places : (n,) array
        theta_1 to theta_n in rad at the end.
    front : int
        Number of segments that slide at the end.
    """

    def __init__(self, chain: SegmentChain, places: NDArray[np.float64], start: float, end: float) -> None:
        self.rising, self.places = end >= start, places
        self.k, self.base = chain.segments * chain.springs.stiffness, chain.springs.base
        ratio = 1 / chain.ratio if self.rising else chain.ratio
        # u_j/u_0 of segments that slide, and its sum over the springs from the first segment to the front.
        self.powers = ratio ** np.arange(chain.segments + 1)
        self.sums = np.concatenate([[0.0], np.cumsum(self.powers[1:])])
        self.corners = [(start, max(0.0, 2 * self.k * (start - float(places[0]))))]
        if self.rising and end > places[0]:
            # A flange that had left the springs meets them again.
            self._note(float(places[0]), self.base)
        self.front = self._walk(end)

    def _walk(self, end: float) -> int:
        levels = self._releases()
        for front, level in enumerate([*levels, math.inf if self.rising else -math.inf]):
            if front == len(levels) and self.rising and self.places[-1] < 0 and self._moves_freely(levels[-1], end):
                return front
            if not self.rising and level <= self.base:
                # The flange leaves the springs at T_0 = 0 before another segment follows.
                lifts = self._twist(front, self.base)
                if end < lifts:
                    self._note(lifts, self.base)
                    self._settle(front, lifts, self.base)
                    self._note(end, self.base)
                    return front
            at = self._twist(front, level)
            if math.isinf(level) or (end <= at if self.rising else end >= at):
                reached = self._level(front, end)
                if reached >= self.base:
                    self._settle(front, end, reached)
                self._note(end, max(reached, self.base))
                return front
            self._note(at, level)
        raise AssertionError("the last front has no end")

    def _releases(self) -> list[float]:
        """Levels u_0 at which segments 1 to n begin to slide: u_(s-1) over the standing u_s is rho there."""
        gaps = self.places - np.append(self.places[1:], 0.0)
        gaps[-1] = max(0.0, 2 * gaps[-1])  # 2 n k to the stop, which does not pull
        levels: list[float] = ((self.k * gaps + self.base) / self.powers[1:]).tolist()
        return levels

    def _moves_freely(self, level: float, end: float) -> bool:
        """Push a chain that is off its stop on towards it, all segments sliding, and return whether it stays off."""
        meets = self._twist(len(self.places), level)
        if end <= meets:
            self._settle(len(self.places), end, level)
        self._note(min(end, meets), level)
        return end <= meets

    def _weights(self, front: int) -> tuple[float, float, float]:
        """Weights w of u_0, c of C/psi, and the place behind the front: gamma = place + (w u_0 - c C/psi)/(n k)."""
        # gamma = theta_(s+1) + sum T_j/(n k) + T_0/(2 n k), at the stop with T_n/(2 n k) in place of theta_(s+1).
        if front < len(self.places):
            return float(self.sums[front]) + 0.5, front + 0.5, float(self.places[front])
        return float(self.sums[-1] - self.powers[-1] / 2) + 0.5, float(front), 0.0

    def _twist(self, front: int, level: float) -> float:
        weight, count, place = self._weights(front)
        return place + (weight * level - count * self.base) / self.k

    def _level(self, front: int, twist: float) -> float:
        weight, count, place = self._weights(front)
        return (self.k * (twist - place) + count * self.base) / weight

    def _settle(self, front: int, twist: float, level: float) -> None:
        """Put the segments that slide to their places, one spring after the other from the flange on."""
        torques = level * self.powers[:front] - self.base
        steps = torques / self.k
        if front:
            steps[0] /= 2
            self.places = np.concatenate([twist - np.cumsum(steps), self.places[front:]])

    def _note(self, twist: float, level: float) -> None:
        ahead = twist > self.corners[-1][0] if self.rising else twist < self.corners[-1][0]
        if ahead:
            self.corners.append((twist, level - self.base))


def marched_loop(springs: ArcSprings, amplitude: float, mean_twist: float, segments: int) -> SlowLoop:
    """Loop of a chain between two twists in rad, after one loading from nothing to the upper one, once it repeats.

    Raises
    ------
    ArithmeticError
        No cycle repeats the one before.
    """
    chain = SegmentChain(springs, segments)
    tips: tuple[float, float] = (math.nan, math.nan)
    rising = chain.lead(mean_twist + amplitude)
    for _ in range(CYCLES):
        falling = chain.lead(mean_twist - amplitude)
        moved = chain.moved
        rising = chain.lead(mean_twist + amplitude)
        peaks = (float(rising.torques[-1]), float(falling.torques[-1]))
        if max(abs(peak - before) for peak, before in zip(peaks, tips, strict=True)) <= REPEATED * max(map(abs, peaks)):
            break
        tips = peaks
    else:
        raise ArithmeticError(f"the loop of {segments} segments does not repeat in {CYCLES} cycles")
    mean, first = (sum(pair) for pair in zip(*map(_over_half, (falling, rising)), strict=True))
    loss = falling.area + rising.area
    return SlowLoop(amplitude, mean_twist, peaks[0], peaks[1], mean, loss, first / amplitude, moved / segments)


def _over_half(branch: LoopBranch) -> tuple[float, float]:
    """Share of a branch in the mean and in the first harmonic of the torque, gamma = m + a cos(tau), piece by piece."""
    # From the ends 2 a cos^2(tau/2) and 2 a sin^2(tau/2): an arc cosine loses half its digits there.
    ends = branch.twists[[0, -1]]
    above, below = np.maximum(branch.twists - ends.min(), 0), np.maximum(ends.max() - branch.twists, 0)
    tau, twice = 2 * np.arctan2(np.sqrt(below), np.sqrt(above)), np.ptp(ends)
    cosines, sines = (above - below) / twice, 2 * np.sqrt(above * below) / twice
    slopes = np.diff(branch.torques) / np.where(np.diff(cosines) == 0, np.inf, np.diff(cosines))
    starts = branch.torques[:-1] - slopes * cosines[:-1]
    # T = s + b cos(tau): integrals of T and of T cos(tau) over tau; a step of the torque at one twist has none.
    angles, rises = np.diff(tau), np.diff(sines)
    squares = (angles + np.diff(sines * cosines)) / 2
    sign = math.copysign(1.0, branch.twists[0] - branch.twists[-1])
    mean = float(np.sum(starts * angles + slopes * rises))
    first = float(np.sum(starts * rises + slopes * squares))
    return sign * mean / (2 * math.pi), sign * first / math.pi
