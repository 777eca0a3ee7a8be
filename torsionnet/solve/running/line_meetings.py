"""All speeds at which an order line meets a mode whose frequency follows the speed, and the least distance of the two.

On each piece of the mode's curve, a polynomial f, the ratio f/|g| of its frequency to that of the line g rises or
falls between the roots of f' g - f g' and the speed at which the line itself is zero. Between two of these speeds there
is one meeting or none, whatever the speeds of a response are. Where the curve leaps, as with the tangent stiffness of a
staged spring, the mode meets the line if it lies above on one side and below on the other.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev

from torsionnet.response.frequency_response import FloatArray
from torsionnet.response.order_line import OrderLine
from torsionnet.solve.running.modes_over_speed import DECAY, CurvePiece

TOUCHING = 1e-6
"""Relative distance of a mode from a line up to which the two meet, and of speeds up to which two meetings are one, as
frequencies and speeds are shown in six figures."""
SAME_POINT = 1e-9
"""Relative distance of speeds up to which pieces of a curve have an end in common."""
LEAP = 0.01
"""Change of the ratio of mode to line on the shortest piece of a curve from which on the curve may have leapt there."""
HALVINGS = 60
"""Number of times that a range of speeds with one meeting is halved, after which doubles leave nothing to halve."""


@dataclass(frozen=True)
class Meeting:
    """Speed at which a line meets a mode, or at which their ratio ends to rise or fall.

    Attributes
    ----------
    speed : float
        rad/s of the reference shaft.
    offset : float
        Frequency of the mode over that of the line, minus 1.
    slope : float
        Frequency of the line less that of the mode over speed, Hz s/rad; infinite where the mode leaps over the line.
    width : float
        Distance in rad/s over which the line leaves the resonance by its half width; 0 at a leap.
    meets : bool
    """

    speed: float
    offset: float
    slope: float
    width: float
    meets: bool = False


class LineOverModes:
    """Order line beside the curves of modes, in pieces by rising speed, with the operating range in rad/s."""

    def __init__(self, line: OrderLine, pieces: Sequence[CurvePiece], speed_range: tuple[float, float]) -> None:
        self.pieces, self.speed_range = pieces, speed_range
        self.rate, self.fixed = float(line.relative) / (2 * math.pi), line.fixed

    def meetings(self, number: int, curve: int) -> tuple[Meeting, ...]:
        """Speeds at which the line meets a curve of the mode of this number, rising; of a constant mode all above 0."""
        own = self._own(number, curve)
        if own and own[0].is_constant:
            frequency = float(own[0].coefficients[0])
            speeds = [(sign * frequency - self.fixed) / self.rate for sign in (1, -1)] if self.rate else []
            return tuple(replace(own[0].at(speed), meets=True) for speed in sorted(set(speeds)) if speed > 0)
        found: list[Meeting] = []
        for point in self._course(own):
            if point.meets and found and point.speed - found[-1].speed <= TOUCHING * point.speed:
                found[-1] = min(found[-1], point, key=lambda one: abs(one.offset))
            elif point.meets:
                found.append(point)
        return tuple(found)

    def approaches(self, number: int, curve: int) -> tuple[Meeting, ...]:
        """Meetings, and the points at which the line is nearest to a mode for a while without meeting it."""
        course = self._course(self._own(number, curve))
        sizes = [math.inf, *(0.0 if point.meets else abs(point.offset) for point in course), math.inf]
        return tuple(
            point
            for place, point in enumerate(course, 1)
            if point.meets or sizes[place] < min(sizes[place - 1], sizes[place + 1])
        )

    def nearest(self, number: int, curve: int) -> Meeting | None:
        """Point of the operating range at which the line is nearest to a mode, None where the mode is not there."""
        low, high = self.speed_range
        inside = [
            point
            for point in self._course(self._own(number, curve))
            if low * (1 - SAME_POINT) <= point.speed <= high * (1 + SAME_POINT)
        ]
        return min(reversed(inside), key=lambda point: 0.0 if point.meets else abs(point.offset), default=None)

    def _own(self, number: int, curve: int) -> list[_Stretch]:
        return [
            stretch
            for place, piece in enumerate(self.pieces)
            if number in piece.numbers and (stretch := _Stretch(self, place, piece.numbers.index(number), curve)).exists
        ]

    def _course(self, stretches: Sequence[_Stretch]) -> list[Meeting]:
        """Points between which the ratio of mode to line only rises or only falls, and meetings, by rising speed."""
        points: list[Meeting] = []
        links: list[Meeting | None] = [None]  # the meeting before each point
        joined = [False]  # whether the curve goes on between the point before and this one
        for place, stretch in enumerate(stretches):
            own = stretch.points()
            before = stretches[place - 1] if place else None
            if before is not None and stretch.place == before.place + 1:
                last, first = points[-1], own[0]
                if before.leaps_to(stretch):
                    is_smooth = abs(last.offset - first.offset) <= TOUCHING * (1 + abs(last.offset))
                    links.append(replace(first, offset=0.0, meets=True) if is_smooth else _leap(last.speed))
                    joined.append(True)
                    points.append(first)
                elif abs(last.offset - first.offset) > TOUCHING:
                    links.append(None)
                    joined.append(True)
                    points.append(first)
            elif points:
                links.append(None)
                joined.append(False)
                points.append(own[0])
            else:
                points.append(own[0])
            for here, there in pairwise(own):
                links.append(stretch.meeting(here, there))
                joined.append(True)
                points.append(there)
        return list(_with_meetings(points, links, joined))


def _with_meetings(
    points: Sequence[Meeting], links: Sequence[Meeting | None], joined: Sequence[bool]
) -> Iterator[Meeting]:
    """Yield points and the meetings between them, points marked as meetings at which a line touches a mode."""
    sizes = [abs(point.offset) for point in points]
    for place, point in enumerate(points):
        link = links[place]
        if link is not None:
            yield link
        is_last = place + 1 == len(points)
        between = link is not None or (not is_last and links[place + 1] is not None)
        falls = not place or not joined[place] or sizes[place] < sizes[place - 1]
        rises = is_last or not joined[place + 1] or sizes[place] <= sizes[place + 1]
        touches = sizes[place] <= TOUCHING and falls and rises and not between
        yield replace(point, meets=True) if touches else point


def _leap(speed: float) -> Meeting:
    return Meeting(speed, 0.0, math.inf, 0.0, meets=True)


@dataclass(frozen=True, eq=False)
class _Stretch:
    """Curve of a mode on one piece beside a line."""

    line: LineOverModes
    place: int
    row: int
    curve: int

    @cached_property
    def _piece(self) -> CurvePiece:
        return self.line.pieces[self.place]

    @cached_property
    def coefficients(self) -> FloatArray:
        """Coefficients of the frequency in Hz in Chebyshev polynomials over the piece."""
        return np.asarray(self._piece.coefficients[self.row, self.curve])

    @property
    def exists(self) -> bool:
        """Whether the mode has this frequency on the piece."""
        return bool(np.isfinite(self._piece.values[self.row, self.curve]).all())

    @property
    def is_constant(self) -> bool:
        """Whether the frequency is the same at all speeds."""
        return len(self.coefficients) == 1

    @cached_property
    def _middle(self) -> float:
        return float(self._piece.speeds[0] + self._piece.speeds[-1]) / 2

    @cached_property
    def _half(self) -> float:
        return float(self._piece.speeds[-1] - self._piece.speeds[0]) / 2

    def frequency(self, speed: float) -> float:
        """Frequency of the mode in Hz at a speed in rad/s."""
        return (
            float(chebyshev.chebval((speed - self._middle) / self._half, self.coefficients))
            if self._half
            else (float(self.coefficients[0]))
        )

    def at(self, speed: float, known: float | None = None) -> Meeting:
        """Point at a speed in rad/s, where the frequency in Hz may be known."""
        line = self.line.rate * speed + self.line.fixed
        frequency = self.frequency(speed) if known is None else known
        rise = self._derivative(self.coefficients, speed, 1)
        slope = math.copysign(self.line.rate, line * self.line.rate) - rise
        if self.is_constant:
            decay = float(self._piece.values[self.row, DECAY, 0])
        else:
            decay = float(np.interp(speed, self._piece.speeds, self._piece.values[self.row, DECAY]))
        bend = abs(self._derivative(self.coefficients, speed, 2))
        apart = abs(frequency - abs(line))
        # The distance of line and mode is slope * s + bend * s^2/2: as far as either makes it the half width.
        widths = [abs(decay / slope)] if slope else []
        widths += [math.sqrt(2 * max(abs(decay), apart) / bend)] if bend else []
        return Meeting(speed, frequency / abs(line) - 1 if line else math.inf, slope, min(widths, default=math.inf))

    def _derivative(self, coefficients: FloatArray, speed: float, times: int) -> float:
        if len(coefficients) <= times:
            return 0.0
        x = (speed - self._middle) / self._half
        return float(chebyshev.chebval(x, chebyshev.chebder(coefficients, times))) / self._half**times

    def points(self) -> list[Meeting]:
        """Points of the piece between which the ratio of mode to line only rises or only falls, by rising speed."""
        low, high = float(self._piece.speeds[0]), float(self._piece.speeds[-1])
        line = np.array([self.line.rate * self._middle + self.line.fixed, self.line.rate * self._half])
        places = list(self.line.speed_range)
        if self.line.rate:
            places.append(-self.line.fixed / self.line.rate)
        if not self.is_constant:
            rise = chebyshev.chebder(self.coefficients)
            turning = chebyshev.chebsub(chebyshev.chebmul(rise, line), line[1] * self.coefficients)
            scale = np.abs(turning).max()
            turning = chebyshev.chebtrim(turning, 1e-13 * scale) if scale else turning[:1]
            roots = chebyshev.chebroots(turning) if len(turning) > 1 else np.zeros(0)
            places += (self._middle + self._half * roots.real[np.abs(roots.imag) < 1e-6]).tolist()
        inner = [speed for speed in sorted(places) if low < speed < high]
        own = self._piece.values[self.row, self.curve]
        # At an end both pieces have the same frequency to the last bit, so that no meeting is lost between them.
        found = [self.at(low, float(own[0])), *map(self.at, inner), self.at(high, float(own[-1]))]
        lines = np.abs(self.line.rate * self._piece.speeds + self.line.fixed)
        if not self.is_constant and (np.abs(own - lines) <= TOUCHING * lines).all():
            return [replace(found[0], offset=0.0), replace(found[-1], offset=0.0)]  # they run together
        return found

    def meeting(self, before: Meeting, after: Meeting) -> Meeting | None:
        """Meeting between two points, or None without one."""
        if (before.offset < 0) == (after.offset < 0):
            return None
        low, high = before.speed, after.speed
        if len(self.coefficients) == 2 and abs(after.offset - before.offset) > LEAP:
            here = self._piece.values[:, self.curve]
            if not self._changes_side(self._piece.numbers, here[:, 0], here[:, -1], low, high):
                return None
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            line = abs(self.line.rate * middle + self.line.fixed)
            low, high = (middle, high) if (self.frequency(middle) < line) == (before.offset < 0) else (low, middle)
        return replace(self.at((low + high) / 2), offset=0.0, meets=True)

    def leaps_to(self, other: _Stretch) -> bool:
        """Whether the mode lies on the other side of the line at the beginning of the next piece."""
        here = dict(zip(self._piece.numbers, self._piece.values[:, self.curve, -1].tolist(), strict=True))
        there = dict(zip(other._piece.numbers, other._piece.values[:, self.curve, 0].tolist(), strict=True))
        both = [number for number in here if number in there]
        ends = float(self._piece.speeds[-1]), float(other._piece.speeds[0])
        before, after = (np.array([side[number] for number in both]) for side in (here, there))
        return self._changes_side(both, before, after, *ends)

    def _changes_side(
        self, numbers: Sequence[int], here: FloatArray, there: FloatArray, low: float, high: float
    ) -> bool:
        """Whether the mode goes from one side of the line to the other between neighbouring speeds in rad/s.

        It does if the mode of its rank does: damped modes may only have changed the undamped ones they belong to.
        """
        kept = np.isfinite(here) & np.isfinite(there)
        number = self._piece.numbers[self.row]
        names = [one for one, is_there in zip(numbers, kept.tolist(), strict=True) if is_there]
        order = np.argsort(here[kept], kind="stable")
        ranks = [names[place] for place in order.tolist()]
        lines = (abs(self.line.rate * speed + self.line.fixed) for speed in (low, high))
        sides = [np.sort(values[kept]) < line for values, line in zip((here, there), lines, strict=True)]
        return number in ranks and bool(sides[0][ranks.index(number)] != sides[1][ranks.index(number)])
