"""All speeds at which an order line meets a mode whose frequency follows the speed, and the least distance of the two.

On each piece of the mode's curve, a polynomial f, the ratio f/|g| of its frequency to that of the line g rises or
falls between the roots of f' g - f g' and the speed at which the line itself is zero. Between two of these speeds there
is one meeting or none, whatever the speeds of a response are. Where the curve leaps, as with the tangent stiffness of a
staged spring, the mode meets the line if it lies above on one side and below on the other.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev

from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.table_range import told_of_reads
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.linear.modes.natural_modes import modes
from torsionnet.machinery.criticals.modes_over_speed import DAMPED, DECAY, CurvePiece, ModesOverSpeed
from torsionnet.machinery.orders.order_line import OrderLine

TOUCHING = 1e-6
"""Relative distance of a mode from a line up to which the two meet, and of speeds up to which two meetings are one, as
frequencies and speeds are shown in six figures."""
SAME_POINT = 1e-9
"""Relative distance of speeds, and of a line from a mode, that is no more than rounding."""
LEAP = 0.01
"""Change of the ratio of mode to line on the shortest piece of a curve from which on the curve may have leapt there."""
NEARLY_REAL = 1e-6
"""Imaginary part of a root, of a piece from -1 to 1, up to which it counts as real; one too many does no harm."""
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
        self._courses: dict[tuple[int, int], list[Meeting]] = {}
        self._stretches: dict[tuple[int, int], list[_Stretch]] = {}

    @classmethod
    def of(cls, line: OrderLine, over_speed: ModesOverSpeed) -> LineOverModes:
        """Line beside modes over speed, worked out once."""
        return over_speed.memo.once(
            cls, (line.relative, line.fixed), lambda: cls(line, over_speed.pieces, over_speed.speed_range)
        )

    def meetings(self, number: int, curve: int) -> tuple[Meeting, ...]:
        """Speeds at which the line meets a curve of the mode of this number, rising; of a constant mode all above 0."""
        own = self._own(number, curve)
        if own and own[0].is_constant:
            frequency = float(own[0].coefficients[0])
            # A constant f meets |r n/2pi + f_0| where r n/2pi + f_0 = f or -f.
            speeds = [(sign * frequency - self.fixed) / self.rate for sign in (1, -1)] if self.rate else []
            return tuple(replace(own[0].at(speed), meets=True) for speed in sorted(set(speeds)) if speed > 0)
        meetings: list[Meeting] = []
        for point in self._course(number, curve):
            # Two pieces may both find the meeting at their common end: the closer one is kept.
            if point.meets and meetings and point.speed - meetings[-1].speed <= TOUCHING * point.speed:
                meetings[-1] = min(meetings[-1], point, key=lambda meeting: abs(meeting.offset))
            elif point.meets:
                meetings.append(point)
        return tuple(meetings)

    def approaches(self, number: int, curve: int) -> tuple[Meeting, ...]:
        """Meetings, and the points at which the line is nearest to a mode for a while without meeting it."""
        course = self._course(number, curve)
        sizes = [math.inf, *(0.0 if point.meets else abs(point.offset) for point in course), math.inf]
        own = self._own(number, curve)
        return tuple(
            # Kept are the meetings and the local minima of the distance along the course.
            point if point.meets else next(stretch for stretch in own if point.speed <= stretch.ends[1]).at(point.speed)
            for place, point in enumerate(course, 1)
            if point.meets or sizes[place] < min(sizes[place - 1], sizes[place + 1])
        )

    def nearest(self, number: int, curve: int) -> Meeting | None:
        """Point of the operating range at which the line is nearest to a mode, None where the mode is not there."""
        low, high = self.speed_range
        inside = [
            point
            for point in self._course(number, curve)
            if low * (1 - SAME_POINT) <= point.speed <= high * (1 + SAME_POINT)
        ]
        # Of equally near points the one at the highest speed, hence reversed.
        return min(reversed(inside), key=lambda point: 0.0 if point.meets else abs(point.offset), default=None)

    def _own(self, number: int, curve: int) -> list[_Stretch]:
        if (number, curve) not in self._stretches:
            self._stretches[number, curve] = [
                stretch
                for place, piece in enumerate(self.pieces)
                if number in piece.numbers
                and (stretch := _Stretch(self, place, piece.numbers.index(number), curve)).exists
            ]
        return self._stretches[number, curve]

    def _course(self, number: int, curve: int) -> list[Meeting]:
        """Points between which the ratio of mode to line only rises or only falls, and meetings, by rising speed."""
        if (number, curve) not in self._courses:
            self._courses[number, curve] = self._calculated_course(self._own(number, curve))
        return self._courses[number, curve]

    def _calculated_course(self, stretches: Sequence[_Stretch]) -> list[Meeting]:
        points: list[tuple[_Stretch, Meeting]] = []
        links: list[Meeting | None] = []  # the meeting before each point
        joined: list[bool] = []  # whether the curve goes on between the point before and this one
        before: _Stretch | None = None
        for stretch in stretches:
            first, *rest = stretch.points()
            goes_on = before is not None and stretch.place == before.place + 1
            leap = before.leap_to(stretch, points[-1][1]) if before is not None and goes_on else None
            # Where the curve simply goes on, the end of one piece and the beginning of the next are one point.
            if not goes_on or leap is not None or abs(points[-1][1].offset - first.offset) > TOUCHING:
                points.append((stretch, first))
                links.append(leap)
                joined.append(goes_on)
            for here, there in pairwise((first, *rest)):
                points.append((stretch, there))
                links.append(stretch.meeting(here, there))
                joined.append(True)
            before = stretch
        return list(_with_meetings(points, links, joined))


def _with_meetings(
    points: Sequence[tuple[_Stretch, Meeting]], links: Sequence[Meeting | None], joined: Sequence[bool]
) -> Iterator[Meeting]:
    """Yield points and the meetings between them, points marked as meetings at which a line touches a mode."""
    sizes, links = [abs(point.offset) for _, point in points], [*links, None]
    for place, size in enumerate(sizes):
        if size <= SAME_POINT and links[place] and links[place + 1]:  # rounding makes two of a point of contact
            links[place : place + 2] = [None, None]
    for place, (stretch, point) in enumerate(points):
        link = links[place]
        if link is not None:
            yield link
        is_last = place + 1 == len(points)
        between = link is not None or links[place + 1] is not None
        # A minimum of the distance without a change of sign is a point at which the line touches the mode.
        falls = not place or not joined[place] or sizes[place] < sizes[place - 1]
        rises = is_last or not joined[place + 1] or sizes[place] <= sizes[place + 1]
        touches = sizes[place] <= TOUCHING and falls and rises and not between
        yield replace(stretch.at(point.speed), offset=point.offset, slope=0.0, meets=True) if touches else point


def _sum(coefficients: Sequence[float], place: float) -> float:
    """Sum of Chebyshev polynomials with these coefficients at a place from -1 to 1, by Clenshaw's recurrence."""
    before = here = 0.0
    for coefficient in reversed(coefficients[1:]):
        before, here = here, coefficient + 2 * place * here - before
    return coefficients[0] + place * here - before


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
    def coefficients(self) -> list[float]:
        """Coefficients of the frequency in Hz in Chebyshev polynomials over the piece."""
        coefficients: list[float] = self._piece.coefficients[self.row, self.curve].tolist()
        return coefficients

    @property
    def exists(self) -> bool:
        """Whether the mode has this frequency on the piece."""
        return bool(np.isfinite(self._piece.values[self.row, self.curve]).all())

    @property
    def is_constant(self) -> bool:
        """Whether the frequency is the same at all speeds."""
        return len(self.coefficients) == 1

    @cached_property
    def ends(self) -> tuple[float, float]:
        """Lowest and highest speed of the piece in rad/s."""
        return float(self._piece.speeds[0]), float(self._piece.speeds[-1])

    def _place(self, speed: float) -> float:
        """Place from -1 to 1 on the piece of a speed in rad/s."""
        low, high = self.ends
        return (2 * speed - low - high) / (high - low) if high > low else 0.0

    def frequency(self, speed: float) -> float:
        """Frequency of the mode in Hz at a speed in rad/s."""
        return _sum(self.coefficients, self._place(speed))

    def _point(self, speed: float, frequency: float | None = None) -> Meeting:
        """Point at a speed in rad/s, where the frequency in Hz may be known, without slope and width."""
        # Ratio f/|g| less 1; a line at 0 Hz is infinitely far below any mode.
        line = abs(self.line.rate * speed + self.line.fixed)
        own = self.frequency(speed) if frequency is None else frequency
        return Meeting(speed, own / line - 1 if line else math.inf, math.nan, math.nan)

    def at(self, speed: float) -> Meeting:
        """Point at a speed in rad/s with slope and width."""
        line, frequency = self.line.rate * speed + self.line.fixed, self.frequency(speed)
        low, high = self.ends
        rises = self._piece.slopes[0][self.row, self.curve]
        rise, bend = 0.0, 0.0
        if not self.is_constant:
            # Derivatives to speed: x runs from -1 to 1 over high - low, so that dx/dn = 2/(high - low).
            rise = _sum(rises.tolist(), self._place(speed)) * 2 / (high - low)
            bend = abs(_sum(chebyshev.chebder(rises).tolist(), self._place(speed))) * 4 / (high - low) ** 2
        # d|g|/dn - df/dn: a line at a negative frequency falls in magnitude where g rises.
        slope = math.copysign(self.line.rate, line * self.line.rate) - rise
        decays = self._piece.values[self.row, DECAY]
        decay = float(decays[0] if self.is_constant else np.interp(speed, self._piece.speeds, decays))
        # The distance of line and mode is slope * s + bend * s^2/2: as far as either makes it the half width.
        widths = [abs(decay / slope)] if slope else []
        widths += [math.sqrt(2 * max(abs(decay), abs(frequency - abs(line))) / bend)] if bend else []
        return replace(self._point(speed, frequency), slope=slope, width=min(widths, default=math.inf))

    def points(self) -> list[Meeting]:
        """Points of the piece between which the ratio of mode to line only rises or only falls, by rising speed."""
        low, high = self.ends
        places = [*self.line.speed_range, *([-self.line.fixed / self.line.rate] if self.line.rate else [])]
        if not self.is_constant:
            # g = g_0 + g_1 x on the piece: the ratio f/g turns where f' g - f g' = g_0 f' + g_1 (x f' - f) = 0.
            line = self.line.rate * (low + high) / 2 + self.line.fixed, self.line.rate * (high - low) / 2
            rise, times = (slopes[self.row, self.curve] for slopes in self._piece.slopes)
            turning = line[0] * rise + line[1] * (times - self._piece.coefficients[self.row, self.curve])
            sizes = np.abs(turning)
            # Chebyshev polynomials are at most 1: where the first coefficient outweighs the others there is no root.
            if sizes[0] <= sizes[1:].sum() and sizes[0] < math.inf:
                roots = chebyshev.chebroots(chebyshev.chebtrim(turning, 1e-13 * sizes.max()))
                real = roots.real[np.abs(roots.imag) < NEARLY_REAL]
                places += ((low + high) / 2 + (high - low) / 2 * real).tolist()
        own = self._piece.values[self.row, self.curve]
        # At an end both pieces have the same frequency to the last bit, so that no meeting is lost between them.
        inner = [self._point(speed) for speed in sorted(places) if low < speed < high]
        points = [self._point(low, float(own[0])), *inner, self._point(high, float(own[-1]))]
        if not self.is_constant and all(abs(point.offset) <= TOUCHING for point in points):
            # A line on the mode all along the piece has no single meeting: only the ends count.
            lines = np.abs(self.line.rate * self._piece.speeds + self.line.fixed)
            if (np.abs(own - lines) <= TOUCHING * lines).all():
                return [replace(points[0], offset=0.0), replace(points[-1], offset=0.0)]  # they run together
        return points

    def meeting(self, before: Meeting, after: Meeting) -> Meeting | None:
        """Meeting between two points, or None without one."""
        if (before.offset < 0) == (after.offset < 0):
            return None
        low, high = before.speed, after.speed
        # The shortest pieces have two points: a step across the line there may be a leap between two modes and no
        # crossing.
        if len(self.coefficients) == 2 and abs(after.offset - before.offset) > LEAP:
            here = self._piece.values[:, self.curve]
            if not self._changes_side(self._piece.numbers, here[:, 0], here[:, -1], low, high):
                return None
        # Bisection: f/|g| only rises or only falls between the two points, so that there is one crossing.
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            line = abs(self.line.rate * middle + self.line.fixed)
            low, high = (middle, high) if (self.frequency(middle) < line) == (before.offset < 0) else (low, middle)
        return replace(self.at((low + high) / 2), offset=0.0, meets=True)

    def leap_to(self, other: _Stretch, last: Meeting) -> Meeting | None:
        """Meeting between the last point here and the next piece, where the mode is on the other side of the line."""
        if self.ends[1] == other.ends[0]:
            return None  # the same modes
        here = dict(zip(self._piece.numbers, self._piece.values[:, self.curve, -1].tolist(), strict=True))
        there = dict(zip(other._piece.numbers, other._piece.values[:, self.curve, 0].tolist(), strict=True))
        # Only modes on both sides of the leap can be ranked against each other.
        both = [number for number in here if number in there]
        before, after = (np.array([side[number] for number in both]) for side in (here, there))
        if not self._changes_side(both, before, after, self.ends[1], other.ends[0]):
            return None
        number = self._piece.numbers[self.row]
        if abs(there[number] - here[number]) <= TOUCHING * here[number]:
            return replace(self.at(last.speed), offset=0.0, meets=True)
        return Meeting(last.speed, 0.0, math.inf, 0.0, meets=True)

    def _changes_side(
        self, numbers: Sequence[int], here: FloatArray, there: FloatArray, low: float, high: float
    ) -> bool:
        """Whether the mode goes from one side of the line to the other between neighbouring speeds in rad/s.

        It does if the mode of its rank does: damped modes may only have changed the undamped ones they belong to.
        """
        kept = np.isfinite(here) & np.isfinite(there)
        number = self._piece.numbers[self.row]
        names = [mode for mode, is_there in zip(numbers, kept.tolist(), strict=True) if is_there]
        order = np.argsort(here[kept], kind="stable")
        # The n-th frequency before is compared with the n-th one after, whatever numbers they bear.
        ranks = [names[place] for place in order.tolist()]
        lines = (abs(self.line.rate * speed + self.line.fixed) for speed in (low, high))
        sides = [np.sort(values[kept]) < line for values, line in zip((here, there), lines, strict=True)]
        return number in ranks and bool(sides[0][ranks.index(number)] != sides[1][ranks.index(number)])


# Speeds to add around resonances of order lines with modes that are narrower than a step of the speeds.

HALF_WIDTHS_AROUND = (-3.0, -1.0, 0.0, 1.0, 3.0)
"""Distances from a critical speed at which speeds are added, in half widths of the resonance.

The sum of a resonance and of all else is largest where their phases agree, up to a few half widths away.
"""
WIDEST_REFINED = 8.0
"""Half width, in steps of speed, from which on a resonance needs no further speeds: half a step beside its top it has
lost a fifth of a per cent. Around wider resonances than a step no speed but its own is added.

A larger value adds speeds to resonances that the steps show already.
"""
SMALLEST_DAMPING_RATIO = 1e-7
"""Damping ratio that a mode is taken to have at least, since the half width of an undamped resonance would be 0."""
NEAR_RESONANCE = 0.1
"""Relative distance of a line from a mode up to which their nearest place counts as a resonance, without a crossing."""
FOLLOWED_ABOVE = 1.1
"""Ratio of a mode's frequency to the highest of any line above which the mode has no resonance here."""
Resonance = tuple[float, float]
"""Critical speed and half width of a resonance, both in rad/s of the reference shaft."""


def around_resonances(
    drivetrain: AssembledModel, reference: str, lines: Sequence[OrderLine], speeds: FloatArray
) -> FloatArray:
    """Speeds (n,) in rad/s to add around every resonance that is narrower than a step of the rising ``speeds``."""
    limits = float(speeds[0]), float(speeds[-1])
    # Modes well above the highest line meet none, and their curves need not be resolved.
    highest = FOLLOWED_ABOVE * max((float(np.abs(line.frequency(np.array(limits))).max()) for line in lines), default=0)
    over_speed = ModesOverSpeed(drivetrain, reference, limits, highest=highest).shared()
    if over_speed.is_speed_dependent:
        return _around(_following(over_speed, _distinct(lines)), speeds)
    with told_of_reads(None):
        poles = modes(drivetrain).eigenvalues
    return around_poles(poles, lines, speeds)


def around_poles(poles: ComplexArray, lines: Sequence[OrderLine], speeds: FloatArray) -> FloatArray:
    """Speeds (n,) in rad/s to add around resonances with poles (rad/s) that are the same at every speed."""
    resonances = (
        resonance
        for pole in poles[poles.imag > 0].tolist()
        for line in _distinct(lines)
        # lambda = -delta +- j omega_d: damped frequency omega_d/2pi, half width delta/2pi, natural frequency
        # |lambda|/2pi, all in Hz.
        for resonance in _met(line, pole.imag / (2 * math.pi), -pole.real / (2 * math.pi), abs(pole) / (2 * math.pi))
    )
    return _around(resonances, speeds)


def _distinct(lines: Sequence[OrderLine]) -> list[OrderLine]:
    return list({(line.relative, line.fixed): line for line in lines}.values())


def _around(resonances: Iterable[Resonance], speeds: FloatArray) -> FloatArray:
    added: list[float] = []
    for speed, width in resonances:
        after = min(max(int(np.searchsorted(speeds, speed)), 1), len(speeds) - 1)
        # The step in which the resonance lies decides whether the grid shows it.
        step = float(speeds[after] - speeds[after - 1])
        if speeds[0] <= speed <= speeds[-1] and width < WIDEST_REFINED * step:
            added += [speed + width * times for times in HALF_WIDTHS_AROUND if width * abs(times) < step]
    return np.array(added)


def _met(line: OrderLine, damped: float, width: float, natural: float) -> Iterator[Resonance]:
    """Yield resonances of an order line with a mode of this damped frequency, half width, natural frequency, in Hz.

    Each is a critical speed with a half width, in rad/s.
    """
    rate = float(line.relative) / (2 * math.pi)
    # r n/2pi + f_0 = +-f; a half width in Hz is one of speed after division by r/2pi.
    for frequency in (damped, -damped) if rate else ():
        yield (frequency - line.fixed) / rate, max(abs(width), SMALLEST_DAMPING_RATIO * natural) / abs(rate)


def _following(over_speed: ModesOverSpeed, lines: Sequence[OrderLine]) -> Iterator[Resonance]:
    """Yield resonances of order lines with modes that follow the speed, as speed and half width in rad/s.

    A line that comes near a mode and turns away has a resonance where it is nearest.
    """
    numbers = sorted({number for piece in over_speed.pieces for number in piece.numbers})
    for line in lines:
        beside = LineOverModes.of(line, over_speed)
        for number in numbers:
            for near in beside.approaches(number, DAMPED):
                if near.meets or abs(near.offset) < NEAR_RESONANCE:
                    yield (near.speed, max(near.width, SMALLEST_DAMPING_RATIO * near.speed if near.width else 0.0))
