"""Natural frequencies and mode shapes at any speed, as smooth curves in pieces, where parameters follow the speed.

A piece ends where a table goes on in another row, or a law of motion in another of its parts; within a piece
frequencies are polynomials through Chebyshev points, of which every other one predicts the rest, else the piece is
halved. Shapes at neighbouring points tell which mode is which: modes that cross keep their shapes and so their numbers,
modes that veer keep their order unless they exchange shapes within a part of the range too short to matter.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import KW_ONLY, dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from torsionnet.base.errors import ModelError, UsageError
from torsionnet.base.registers import Memo, RecentResults
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.table_range import told_of_reads
from torsionnet.linear.batch.mode_steps import SAME_MODE_ENERGY
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.linear.modes.mode_pairs import REPEATED_FREQUENCY, VibrationMode, vibration_modes
from torsionnet.linear.modes.natural_modes import modes
from torsionnet.linear.responses.shared_response import mechanics_key
from torsionnet.machinery.orders.operating_groups import drivetrains_at_speeds, own_ratio, values_at_speeds
from torsionnet.model.operating_values import OperatingPoints

MODE_BYTES, USUAL_SETS = 100, 50
"""Size in bytes of a mode per node, with shape and texts, and usual number of speeds at which modes are known, as
counted against the memory for kept results."""
COMPARED_SPEEDS = 5
"""Number of speeds at which values that follow the speed are compared before conditions share their modes."""
CURVE_POINTS = (5, 9, 17)
"""Numbers of Chebyshev points on a piece of a curve, tried one after the other before it is halved; each set has the
points of the one before."""
CURVE_PRECISION = 1e-6
"""Relative difference of frequencies from those that half the points predict, up to which a piece is known; all points
together are several digits better."""
FAR_FROM_CURVE = 0.03
"""Relative difference from which on a piece is halved at once, as more points do not help where a curve leaps."""
SLOW_GAIN = 0.1
"""Share of that difference left with the next number of points from which on the piece is halved: within a piece that
is smooth far less is left, while a curve that bends, as where a frequency reaches a row of a table, leaves half."""
SHARE_OF_WIDTH = 1e-3
"""Difference of a frequency over the half width of its resonance that is known well enough where such bends occur:
critical speeds keep the digits that are printed."""
NARROWEST_PIECE = 1e-4
"""Length of a piece over that of the speeds with the same rows of tables below which it is a straight line, and modes
are matched as well as they can be: modes that veer there have exchanged their shapes."""
LIGHT_DAMPING = 0.3
"""Damping ratio up to which the damped frequency has to be known, which bends too sharply near critical damping."""
FIRST_SPEEDS = 33
"""Number of speeds at which the rows of tables and parts of laws in force are compared before changes are sought."""
SAME_BREAK = 1e-13
"""Relative distance of two speeds between which a change of rows lies exactly enough."""
CURVES = ("undamped_frequency", "natural_frequency", "damped_frequency", "decay")
"""Names of the curves of a mode over speed in Hz; decay is the half width of its resonance, ``-Re lambda/2pi``."""
UNDAMPED, NATURAL, DAMPED, DECAY = range(4)


@dataclass(frozen=True, eq=False)
class CurvePiece:
    """Curves of all modes in Hz over a range of speeds in which they are smooth.

    Attributes
    ----------
    speeds : (n_points,) array
        rad/s, rising Chebyshev points with both ends.
    numbers : tuple of int
        Number of each mode.
    values : (n_modes, 4, n_points) array
        The curves named in ``CURVES``, in Hz; NaN for a mode that is not there.
    """

    speeds: FloatArray
    numbers: tuple[int, ...]
    values: FloatArray

    @cached_property
    def coefficients(self) -> FloatArray:
        """Coefficients of the curves in Chebyshev polynomials over the piece, in Hz, in the shape of the values."""
        return np.asarray(self.values @ _transform(self.values.shape[-1]).T)

    @cached_property
    def slopes(self) -> tuple[FloatArray, FloatArray]:
        """Coefficients of the curves' derivatives f' to x, which goes from -1 to 1 over the piece, and of x f'."""
        own = self.coefficients
        if own.shape[-1] == 1:
            return np.zeros_like(own), np.zeros_like(own)
        rise = np.zeros_like(own)
        rise[..., :-1] = chebyshev.chebder(own, axis=-1)
        # x T_k = (T_(k+1) + T_|k-1|)/2, and f' ends one degree before f.
        times = np.zeros_like(own)
        times[..., 1:] += rise[..., :-1] / 2
        times[..., :-1] += rise[..., 1:] / 2
        times[..., 1] += rise[..., 0] / 2
        return rise, times


@dataclass(eq=False)
class ModesOverSpeed:
    """Vibration modes over the speed of a reference node, where parameters follow the operating point.

    Where none does there is one set of modes. ``numbers`` are the numbers of the modes at the operating point, by
    rising undamped frequency; a mode keeps its number as long as its shape goes on. The curves reach ``reach`` beyond
    the range of speeds on either side, as a share of its ends, as far as tables and laws do; modes that stay above
    ``highest`` (Hz) are not followed closely.
    """

    drivetrain: AssembledModel
    reference: str
    speed_range: tuple[float, float]
    numbers: Sequence[int] = ()
    _: KW_ONLY
    reach: float = 0.0
    highest: float = math.inf
    memo: Memo = field(default_factory=Memo, init=False)
    _sets: dict[float, tuple[VibrationMode, ...]] = field(default_factory=dict, init=False)

    def shared(self) -> ModesOverSpeed:
        """Modes over speed that are followed once for all conditions that differ in excitations alone."""
        values: list[tuple[tuple[str, float], ...]] = []
        if self.is_speed_dependent:
            compared = np.linspace(*self.speed_range, COMPARED_SPEEDS)
            values = [tuple(piece.items()) for piece in values_at_speeds(self.drivetrain, self.reference, compared)]
        question = self.reference, self.speed_range, tuple(self.numbers), self.reach, self.highest, tuple(values)
        return _recent(self.drivetrain).once(
            ModesOverSpeed,
            (mechanics_key(self.drivetrain), question),
            lambda: self,
            lambda _: _usual_size(self.drivetrain),
        )

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest speed in rad/s to which the curves reach."""
        return self.speed_range[0] * (1 - self.reach), self.speed_range[1] * (1 + self.reach)

    @cached_property
    def _solved(self) -> dict[Hashable, tuple[VibrationMode, ...]]:
        """Sets of modes by the values that they depend on, the same for all conditions and ranges of speeds."""
        return _recent(self.drivetrain).once(
            dict, mechanics_key(self.drivetrain), dict, lambda _: _usual_size(self.drivetrain)
        )

    @cached_property
    def is_speed_dependent(self) -> bool:
        """Whether modes differ from speed to speed, because parameters follow the operating point."""
        return self.drivetrain.definition.follows_speed

    @cached_property
    def known(self) -> tuple[float, float]:
        """Lowest and highest speed in rad/s, within the limits, between which tables and laws give the modes."""
        low, high = self.speed_range
        return self._nearest_reached(low, self.limits[0]), self._nearest_reached(high, self.limits[1])

    @cached_property
    def pieces(self) -> tuple[CurvePiece, ...]:
        """Pieces of the curves of all modes, by rising speed."""
        if not self.is_speed_dependent:
            every = self._modes_at(self.speed_range[0])
            # One point: curves of constant modes are polynomials of degree 0.
            curves = np.array([_curves(mode) for mode in every]).reshape(len(every), len(CURVES), 1)
            return (CurvePiece(np.array(self.known), self._first_numbers(len(every)), curves),)
        pieces = []
        for piece, numbers in zip(self._pieces, self._numbers_of_pieces, strict=True):
            kept = [place for place, number in enumerate(numbers) if number]
            pieces.append(CurvePiece(piece.speeds, tuple(numbers[place] for place in kept), piece.values[kept]))
        return tuple(pieces)

    def at(self, speed: float) -> tuple[VibrationMode, ...]:
        """Vibration modes at a known speed of the reference node in rad/s, numbered, by rising undamped frequency."""
        return self.memo.once(tuple, speed, lambda: self._numbered(speed))

    def _numbered(self, speed: float) -> tuple[VibrationMode, ...]:
        every = self._modes_at(speed)
        if not self.is_speed_dependent:
            numbers: Sequence[int] = self._first_numbers(len(every))
        else:
            # Beyond the last piece its end is the nearest known set of modes.
            place = next((at for at, piece in enumerate(self._pieces) if speed <= piece.speeds[-1]), -1)
            numbers = self._handed_on(place, int(np.argmin(np.abs(self._pieces[place].speeds - speed))), every)
        return tuple(replace(mode, number=number) for mode, number in zip(every, numbers, strict=True))

    def _modes_at(self, speed: float) -> tuple[VibrationMode, ...]:
        """Vibration modes at a speed in rad/s, by rising undamped frequency, before they are numbered."""
        if speed in self._sets:
            return self._sets[speed]
        at = np.array([speed])
        (values,) = values_at_speeds(self.drivetrain, self.reference, at) if self.is_speed_dependent else ({},)
        # Speeds with equal values of all parameters have the same modes; tangents of laws also follow the speed
        # itself.
        question = (*values.items(), speed if self._has_tangents else None)
        if question not in self._solved:
            ((rig, _),) = drivetrains_at_speeds(self.drivetrain, self.reference, at)
            with told_of_reads(None):
                self._solved[question] = tuple(vibration_modes(rig, modes(rig)))
        self._sets[speed] = self._solved[question]
        return self._sets[speed]

    @property
    def _has_tangents(self) -> bool:
        """Whether laws of motion have other tangents at other speeds."""
        definition = self.drivetrain.definition
        return definition.tangents is not None and definition.load is not None

    def _first_numbers(self, count: int) -> tuple[int, ...]:
        """Numbers of so many modes at the operating point, by rising undamped frequency."""
        return tuple([*self.numbers, *range(len(self.numbers) + 1, count + 1)][:count])

    # --- where the curves break ---------------------------------------------------------------------------------------

    @cached_property
    def _points(self) -> OperatingPoints:
        return OperatingPoints(self.drivetrain.external_torques)

    def _parts_in_force(self, speed: float) -> Hashable:
        """Rows of tables and parts of laws of motion that are in force at a speed in rad/s."""
        rows = self._points.rows(speed * own_ratio(self.drivetrain, self.reference))
        if not self._has_tangents:
            return rows
        ((rig, _),) = drivetrains_at_speeds(self.drivetrain, self.reference, np.array([speed]))
        tangents = rig.definition.tangents
        assert tangents is not None
        states = tangents.state.states.items()
        return rows, tuple((name, tuple(state.piece for state in some)) for name, some in states)

    def _nearest_reached(self, inside: float, outside: float) -> float:
        """Speed in rad/s nearest to ``outside`` that tables and laws reach."""
        if self._reaches(outside):
            return outside
        while abs(outside - inside) > SAME_BREAK * inside:
            # Bisection to the end of tables and laws, which answer beyond it with an error only.
            middle = (inside + outside) / 2
            inside, outside = (middle, outside) if self._reaches(middle) else (inside, middle)
        return inside

    def _reaches(self, speed: float) -> bool:
        if not self.is_speed_dependent:
            return True
        try:
            self._parts_in_force(speed)
        except (UsageError, ModelError):
            return False
        return True

    @cached_property
    def _anchor(self) -> float:
        """Known speed in rad/s nearest to that of the operating point, at which modes have their first numbers."""
        try:
            own = self.drivetrain.external_torques.operating_speed / own_ratio(self.drivetrain, self.reference)
        except UsageError:
            own = self.speed_range[1]
        return float(np.clip(own, *self.known))

    def _stretches(self) -> Iterator[tuple[float, float]]:
        """Yield ranges of speeds in rad/s, rising, in each of which the same rows of tables are in force."""
        first = np.union1d(np.linspace(*self.known, FIRST_SPEEDS), [*self.speed_range, self._anchor]).tolist()
        start = first[0]
        if len(first) == 1:
            yield start, start
        for (low, here), (high, there) in pairwise((speed, self._parts_in_force(speed)) for speed in first):
            for before, after in self._changes(low, high, here, there):
                # Tangents leap, so that each side has its own modes; tables only bend.
                end, begin = (before, after) if self._has_tangents else (after, after)
                if end > start:
                    yield start, end
                start = begin
            if high in (*self.speed_range, self._anchor, first[-1]) and high > start:
                yield start, high
                start = high

    def _changes(self, low: float, high: float, here: Hashable, there: Hashable) -> Iterator[tuple[float, float]]:
        """Yield neighbouring speeds in rad/s, rising, between which rows of tables or parts of laws change."""
        if here == there:
            return
        # Bisection keeps halves whose ends differ; a row that comes and goes within a step of first speeds is not
        # seen.
        middle = (low + high) / 2
        if high - low <= SAME_BREAK * high:
            yield low, high
            return
        between = self._parts_in_force(middle)
        yield from self._changes(low, middle, here, between)
        yield from self._changes(middle, high, between, there)

    # --- curves -------------------------------------------------------------------------------------------------------

    @cached_property
    def _pieces(self) -> tuple[_FollowedPiece, ...]:
        return tuple(
            piece
            for low, high in self._stretches()
            for piece in self._resolved(low, high, NARROWEST_PIECE * (high - low))
        )

    def _resolved(self, low: float, high: float, shortest: float) -> Iterator[_FollowedPiece]:
        """Yield pieces of the curves between two speeds in rad/s, each known or shorter than ``shortest``."""
        if high - low <= shortest:
            yield self._continued_modes(np.unique([low, high]))
            return
        before = math.inf
        for count in CURVE_POINTS:
            speeds = _chebyshev_points(low, high, count)
            # Polynomials cannot follow a leap: the curve is cut on either side of it and each part resolved anew.
            if leap := self._leap(speeds.tolist(), shortest):
                for ends in pairwise((low, *leap, high)):
                    if ends[0] < ends[1]:
                        yield from self._resolved(*ends, shortest)
                return
            piece = self._continued_modes(speeds)
            unknown = self._unknown(piece)
            if unknown <= CURVE_PRECISION:
                yield piece
                return
            # More points of a higher degree gain little here: two halves converge sooner.
            if unknown > min(FAR_FROM_CURVE, SLOW_GAIN * before):
                break
            before = unknown
        middle = float(_chebyshev_points(low, high, 3)[1])
        yield from self._resolved(low, middle, shortest)
        yield from self._resolved(middle, high, shortest)

    def _leap(self, speeds: Sequence[float], shortest: float) -> tuple[float, float] | None:
        """Two speeds in rad/s at most ``shortest`` apart between which vibrations appear, end or become overdamped."""
        kinds = [self._kinds(speed) for speed in speeds]
        first = next((place for place, (here, there) in enumerate(pairwise(kinds)) if here != there), None)
        if first is None:
            return None
        low, high = speeds[first : first + 2]
        while high - low > shortest:
            # Bisection to the speed at which a vibration appears or ends.
            middle = (low + high) / 2
            low, high = (middle, high) if self._kinds(middle) == kinds[first] else (low, middle)
        return low, high

    def _kinds(self, speed: float) -> Hashable:
        """Pair of flags of each mode at a speed in rad/s, whether it lacks an undamped and a natural frequency."""
        every = [mode for mode in self._modes_at(speed) if self._matters(mode)]
        return tuple(tuple(map(math.isnan, _curves(mode)[:DAMPED])) for mode in every)

    def _continued_modes(self, speeds: FloatArray) -> _FollowedPiece:
        """Modes at speeds in rad/s, each in the row of the mode at the first speed whose shape it continues."""
        sets = [self._modes_at(speed) for speed in speeds.tolist()]
        places = [np.arange(len(sets[0]))]
        clear = len({len(at_speed) for at_speed in sets}) == 1
        for before, after in pairwise(sets):
            step, alike = self._successors(before, after)
            # Rows follow their mode from point to point; one lost before stays lost.
            known = places[-1] >= 0
            places.append(np.where(known, step[places[-1]], -1))
            near = [self._matters(mode) for mode in before]
            clear &= bool((alike >= SAME_MODE_ENERGY)[near].all())
        every = np.array(places).T
        values = np.array([
            [_curves(some[place]) if place >= 0 else (math.nan,) * len(CURVES)
             for some, place in zip(sets, row, strict=True)] for row in every
        ]).reshape(len(every), len(sets), len(CURVES))  # fmt: skip
        return _FollowedPiece(speeds, every, np.swapaxes(values, 1, 2), clear)

    def _matters(self, mode: VibrationMode) -> bool:
        return not min(_curves(mode)[:2], key=lambda f: math.inf if math.isnan(f) else f) > self.highest

    def _unknown(self, piece: _FollowedPiece) -> float:
        """Largest relative difference of frequencies from those that every other point predicts."""
        if not piece.is_clear:
            return math.inf
        own = piece.values[:, :DECAY]
        near = ~(np.nan_to_num(own[:, :2], nan=math.inf).min(axis=(1, 2)) > self.highest)
        there = np.isfinite(own[near])
        if (there.any(axis=2) != there.all(axis=2)).any():
            return math.inf  # a vibration that becomes overdamped on the way
        # The decay itself counts nothing, and of a strongly damped mode its damped frequency does not: it may go to
        # 0.
        lightly = piece.values[near, DECAY] < LIGHT_DAMPING * own[near, NATURAL]
        counts = np.stack([np.ones_like(lightly), np.ones_like(lightly), lightly], axis=1)
        # Every other Chebyshev point of 2^m + 1 is a Chebyshev point of 2^(m-1) + 1: these predict the points
        # between.
        half = len(piece.speeds) // 2 + 1
        places = -np.cos(np.pi * np.arange(1, len(piece.speeds), 2) / (len(piece.speeds) - 1))
        predicted = own[near][..., ::2] @ (_transform(half).T @ chebyshev.chebvander(places, half - 1).T)
        actual = own[near][..., 1::2]
        with np.errstate(invalid="ignore", divide="ignore"):
            apart = np.abs(predicted - actual) / np.abs(actual)
            # Tables over frequency make curves bend at speeds that are not known before.
            if self.drivetrain.assembly.system.dynamic:
                width = piece.values[near, DECAY, None, 1::2]
                apart = np.where(np.abs(predicted - actual) <= SHARE_OF_WIDTH * width, 0.0, apart)
        return float(np.nan_to_num(np.where(counts[..., 1::2], apart, 0.0)).max(initial=0.0))

    # --- which mode is which ------------------------------------------------------------------------------------------

    def _successors(
        self, before: Sequence[VibrationMode], after: Sequence[VibrationMode]
    ) -> tuple[NDArray[np.intp], FloatArray]:
        """Index (n,) among the modes of a neighbouring speed of each mode's successor, and how alike their shapes are.

        -1 where there is none. Modes of one frequency count together, as any mixture of their shapes is a shape.
        """
        alike = self._likeness(before, after)
        same = min(len(before), len(after))
        frequencies = np.array([np.nan_to_num(mode.undamped_frequency) for mode in after[:same]])
        equal = np.abs(frequencies[:, None] - frequencies) <= REPEATED_FREQUENCY * frequencies
        # Shapes of a repeated frequency are any basis of one subspace: their criteria are summed over it.
        own = np.where(equal, alike[:same, :same], 0.0).sum(axis=1)
        # Mostly the order by frequency is that of the shapes: no assignment is needed.
        if len(before) == len(after) and (own >= SAME_MODE_ENERGY).all():
            return np.arange(same), own
        from scipy.optimize import linear_sum_assignment

        successors, shares = np.full(len(before), -1), np.zeros(len(before))
        # Where shapes decide nothing, as of equal modes, the rank does.
        rows, columns = linear_sum_assignment(-alike - 1e-9 * np.eye(*alike.shape))
        successors[rows], shares[rows] = columns, alike[rows, columns]
        shares[:same] = np.where(successors[:same] == np.arange(same), np.maximum(own, shares[:same]), shares[:same])
        return successors, shares

    def _likeness(self, before: Sequence[VibrationMode], after: Sequence[VibrationMode]) -> FloatArray:
        """Modal assurance criterion (n, m) of mode shapes, weighted with the inertias."""
        first, second = (
            np.array([mode.shape[self._coordinates] for mode in some]).reshape(len(some), -1).T
            for some in (before, after)
        )
        weighted = self.drivetrain.assembly.system.M @ second
        # MAC_ij = |phi_i^H M phi_j|^2 / ((phi_i^H M phi_i)(phi_j^H M phi_j)): 1 for the same shape, whatever its
        # scale.
        common = np.abs(first.conj().T @ weighted) ** 2
        sizes = np.outer(self._sizes(first), self._sizes(second))
        return np.asarray(np.divide(common, sizes, out=np.zeros_like(common), where=sizes > 0))

    def _sizes(self, shapes: ComplexArray) -> FloatArray:
        return np.asarray(np.sum(shapes.conj() * (self.drivetrain.assembly.system.M @ shapes), axis=0).real)

    @cached_property
    def _coordinates(self) -> list[int]:
        assembly = self.drivetrain.assembly
        return [assembly.node_index[name] for name in assembly.kinematics.coordinates]

    @cached_property
    def _numbers_of_pieces(self) -> tuple[tuple[int, ...], ...]:
        """Numbers of the modes of each piece, handed on from the speed of the operating point by the mode shapes."""
        pieces = self._pieces
        first = next((at for at, piece in enumerate(pieces) if self._anchor <= piece.speeds[-1]), len(pieces) - 1)
        count = len(self._modes_at(self._anchor))
        known: dict[int, tuple[int, ...]] = {}
        at = int(np.argmin(np.abs(pieces[first].speeds - self._anchor)))
        known[first] = pieces[first].numbers(at, self._first_numbers(count))
        # From the operating point to higher, then to lower speeds, each piece numbered by its neighbour.
        for place in range(first + 1, len(pieces)):
            known[place] = self._beside(pieces[place - 1], -1, known[place - 1], pieces[place], 0)
        for place in range(first - 1, -1, -1):
            known[place] = self._beside(pieces[place + 1], 0, known[place + 1], pieces[place], -1)
        return tuple(known[place] for place in range(len(pieces)))

    def _beside(
        self, numbered: _FollowedPiece, end: int, numbers: Sequence[int], other: _FollowedPiece, begin: int
    ) -> tuple[int, ...]:
        """Numbers of the modes of a piece beside another one whose modes are numbered."""
        before, after = (self._modes_at(float(piece.speeds[at])) for piece, at in ((numbered, end), (other, begin)))
        return other.numbers(begin, self._carried(before, numbered.in_set(end, numbers, len(before)), after))

    def _handed_on(self, place: int, at: int, every: Sequence[VibrationMode]) -> tuple[int, ...]:
        """Numbers of a set of modes near the point ``at`` of a piece, by the shapes there."""
        piece = self._pieces[place]
        near = self._modes_at(float(piece.speeds[at]))
        return self._carried(near, piece.in_set(at, self._numbers_of_pieces[place], len(near)), every)

    def _carried(
        self, before: Sequence[VibrationMode], numbers: Sequence[int], after: Sequence[VibrationMode]
    ) -> tuple[int, ...]:
        """Numbers of the modes of a neighbouring speed that continue numbered ones; the others have the next ones."""
        if before is after:
            return tuple(numbers)
        step, _ = self._successors(before, after)
        by_place = {int(place): number for place, number in zip(step, numbers, strict=True) if place >= 0}
        free = iter(range(max([*numbers, *self.numbers], default=0) + 1, 10**6))
        return tuple(by_place[place] if place in by_place else next(free) for place in range(len(after)))


def _recent(drivetrain: AssembledModel) -> RecentResults:
    """Modes over speed of a drivetrain in all its conditions, apart from other results, which are many more."""
    return drivetrain.assembly.system.memo.once(RecentResults, ModesOverSpeed, RecentResults)


def _usual_size(drivetrain: AssembledModel) -> int:
    return USUAL_SETS * MODE_BYTES * len(drivetrain.nodes) ** 2


@dataclass(frozen=True, eq=False)
class _FollowedPiece:
    """Modes at neighbouring speeds: indices (n_modes, n_points) in the set of each speed, -1 for none, and curves."""

    speeds: FloatArray
    places: NDArray[np.intp]
    values: FloatArray
    is_clear: bool

    def numbers(self, at: int, of_set: Sequence[int]) -> tuple[int, ...]:
        """Numbers of the rows, from those of the set of modes at one of the points; 0 for a mode not in it."""
        return tuple(of_set[place] if place >= 0 else 0 for place in self.places[:, at].tolist())

    def in_set(self, at: int, numbers: Sequence[int], count: int) -> tuple[int, ...]:
        """Numbers of the set of ``count`` modes at one of the points, from those of the rows; next ones for others."""
        by_place = dict(zip(self.places[:, at].tolist(), numbers, strict=True))
        free = iter(range(max(numbers, default=0) + 1, 10**6))
        return tuple(by_place[place] if place in by_place else next(free) for place in range(count))


def _curves(mode: VibrationMode) -> tuple[float, float, float, float]:
    """Undamped, natural and damped frequency of a mode and its decay, in Hz; see ``CURVES``."""
    # delta/2pi = zeta |lambda|/2pi.
    decay = mode.damping_ratio * mode.natural_frequency
    return mode.undamped_frequency, mode.natural_frequency, mode.damped_frequency, decay


def _chebyshev_points(low: float, high: float, count: int) -> FloatArray:
    """Rising Chebyshev points (count,) from ``low`` to ``high``, both included, in their unit."""
    # Extrema of T_(count-1); the ends are set exactly, so that neighbouring pieces meet at the same speed.
    inner = -np.cos(np.pi * np.arange(1, count - 1) / (count - 1))
    return np.concatenate([[low], (low + high) / 2 + (high - low) / 2 * inner, [high]])


@lru_cache
def _transform(count: int) -> FloatArray:
    """Matrix (count, count) from values at Chebyshev points to coefficients of Chebyshev polynomials."""
    points = _chebyshev_points(-1.0, 1.0, count) if count > 1 else np.zeros(1)
    # V c = f with V_ij = T_j(x_i), well conditioned at Chebyshev points.
    return np.asarray(np.linalg.inv(chebyshev.chebvander(points, count - 1)))
