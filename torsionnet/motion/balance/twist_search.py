"""Twists at which springs and laws of motion are in balance with the mean torques, by a semismooth Newton's method.

The torque of every law rises with its twist, so that the balance is the minimum of the energy
E(q) = q^T K q/2 + sum_l E_l(b_l^T q) - f^T q. A step counts if the energy or the residual falls; else the step goes to
the minimum of the energy along its direction. The pieces found are then solved as the linear system they are, which
proves them: of a convex energy there is one minimum.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError
from torsionnet.model.element_base.laws import MotionState
from torsionnet.model.elements import Law, MotionLaw
from torsionnet.model.kinematics import exact_row
from torsionnet.model.law_network import LawNetwork
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve, Slope

# Torque over twist of one law as numbers that a search can follow, with steps made steep ramps.


@dataclass(frozen=True)
class MonotoneGraph:
    """Torque in N m over the twist in rad of a law of straight pieces, or of one with a smooth curve.

    ``places`` are corners, ``torques`` the torques there, ``slopes`` those below, between and above the corners; they
    are empty for a smooth curve.
    """

    law: MotionLaw
    places: tuple[float, ...] = ()
    torques: tuple[float, ...] = ()
    slopes: tuple[float, ...] = ()

    def at(self, twist: float) -> tuple[float, float]:
        """Torque in N m and slope in N m/rad at a twist in rad."""
        if not self.slopes:
            stiffness = self.law.scale * self.law.curve.slopes(MotionState(twist))[0]
            return float(self.law.torque(twist, 0.0)), float(stiffness)
        if not self.places:
            return self.torques[0] + self.slopes[0] * twist, self.slopes[0]
        place = bisect_right(self.places, twist)
        slope, corner = self.slopes[place], max(place - 1, 0)
        return self.torques[corner] + slope * (twist - self.places[corner]), slope

    def number_at(self, twist: float) -> int | None:
        """Number of the piece of the curve in force at a twist in rad, None for a smooth curve."""
        return bisect_right(self.places, twist) if self.slopes else None

    @property
    def stiffest(self) -> float:
        """Largest stiffness in N m/rad of the pieces, that of a smooth curve at rest."""
        return max(self.slopes) if self.slopes else abs(self.at(0.0)[1])


def monotone_graph(law: MotionLaw, ramp: float) -> MonotoneGraph:
    """Graph of a law of motion over the twist at rest, with ramps of ``ramp`` times its largest stiffness."""
    curve, scale = law.curve, float(law.scale)
    if not isinstance(curve, PieceCurve):
        return MonotoneGraph(law)
    stiffest = max((float(piece.stiffness) for piece in curve.pieces if isinstance(piece, Slope)), default=0.0) or 1.0
    places: list[float] = []
    slopes: list[float] = []
    torques: list[float] = []
    # Half the width of the ramp in place of a step: its height over the stiffness, less than its neighbours have.
    halves = [
        min(
            (float(piece.high) - float(piece.low)) / (2 * ramp * stiffest),
            _quarter(curve.pieces[max(0, number - 1) :][:3]),
        )
        if isinstance(piece, Hold)
        else 0.0
        for number, piece in enumerate(curve.pieces)
    ]
    for number, piece in enumerate(curve.pieces):
        slopes.append(scale * float(piece.stiffness) if isinstance(piece, Slope) else scale * ramp * stiffest)
        if number + 1 == len(curve.pieces):
            break
        after = curve.pieces[number + 1]
        line = piece if isinstance(piece, Slope) else after
        assert isinstance(line, Slope)  # two steps do not follow each other
        corner = float(piece.at) if isinstance(piece, Hold) else float(piece.upper)
        places.append(corner + halves[number] - halves[number + 1])
        torques.append(scale * float(line.at(places[-1], 0.0)))
    for number, piece in enumerate(curve.pieces):  # a ramp joins the lines beside it
        if isinstance(piece, Hold) and 0 < number < len(places):
            rise, width = (ends[number] - ends[number - 1] for ends in (torques, places))
            slopes[number] = rise / width
    if not places:
        torques = [scale * float(piece.torque) for piece in curve.pieces if isinstance(piece, Slope)]
    return MonotoneGraph(law, tuple(places), tuple(torques), tuple(slopes))


def _quarter(around: Sequence[Slope | Hold]) -> float:
    """Quarter of the shortest of some pieces in rad, more than which no ramp takes from them."""
    ends = [(piece.lower, piece.upper) for piece in around if isinstance(piece, Slope)]
    return min((float(upper - lower) / 4 for lower, upper in ends if None not in (lower, upper)), default=math.inf)


# Matrices over coordinates, dense for few of these and sparse for many, and solutions of their equations.

FloatArray = NDArray[np.float64]

SMALL_RESIDUAL = 1e-10
"""Size of a residual over that of the right side below which a solution counts as one."""
DENSE_COORDINATES = 400
"""Number of coordinates from which sparse matrices are quicker."""


def row_matrix(rows: Sequence[Mapping[str, float]], place: Mapping[str, int]) -> Any:
    """Rows over the coordinates, dense for few of these."""
    entries = [
        (number, place[name], share) for number, row in enumerate(rows) for name, share in row.items() if name in place
    ]
    shape = (len(rows), len(place))
    if len(place) <= DENSE_COORDINATES:
        dense = np.zeros(shape)
        for number, column, share in entries:
            dense[number, column] = share
        return dense
    from scipy import sparse

    triples: Any = zip(*entries, strict=True) if entries else ((), (), ())
    numbers, columns, shares = triples
    placed: Any = (shares, (numbers, columns))
    return sparse.csr_array(placed, shape=shape, dtype=float)


def gram(rows: Any, sizes: FloatArray) -> Any:
    """Matrix sum_l size_l b_l b_l^T over the coordinates."""
    if isinstance(rows, np.ndarray):
        return rows.T @ (sizes[:, None] * rows)
    from scipy import sparse

    return sparse.csc_array(rows.T @ (sparse.diags_array(sizes) @ rows))


def bordered(stiffness: Any, rows: Any) -> Any:
    """Matrix [[K, B^T], [B, 0]] of coordinates under constraints on the rows B."""
    if isinstance(stiffness, np.ndarray):
        m = len(rows)
        return np.block([[stiffness, rows.T], [rows, np.zeros((m, m))]]) if m else stiffness
    from scipy import sparse

    return sparse.block_array([[stiffness, rows.T], [rows, None]]).tocsc() if rows.shape[0] else stiffness


def solution(matrix: Any, right: FloatArray) -> FloatArray:
    """Solution of a system of equations, not a number where a sparse one is singular."""
    if isinstance(matrix, np.ndarray):
        try:
            return np.asarray(np.linalg.solve(matrix, right))
        except np.linalg.LinAlgError:
            return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0])
    from scipy.sparse.linalg import splu

    try:
        return np.asarray(splu(matrix.tocsc()).solve(right))
    except RuntimeError:
        return np.full(len(right), np.nan)


MOST_STEPS = 200
"""Largest number of steps of the search; random plants with loops took at most 40."""
LOAD_STEPS = 20
"""Number of steps in which the load is raised where the search from rest to the whole load fails."""
RAMPS = (3.0, 1e2, 1e3, 1e4, 1e5)
"""Stiffnesses of the ramps in place of steps, over the largest stiffness of the curve, one after the other."""
SETTLED = 1e-12
"""Change of the twists, over the largest, at which Newton's method on smooth curves ends."""
SLACK = 1e-9
"""Share of a bound of a piece by which rounding may carry a solution beyond it."""
ROUNDED = 4e-15
"""Rounding of twists over the largest angle, which the stiffest law turns into a residual torque, and of torques over
the largest at a corner, of which the lines are made: some units of the last digit."""
LEAST_SLOPE = 1e-9
"""Stiffness that gives level pieces a direction, over the largest one of the law."""
CORRECTIONS = 3
"""Number of solutions with level pieces made so steep; each leaves an error of their steepness of the one before."""


@dataclass(frozen=True, eq=False)
class TwistBalance:
    """Twists in rad, torques in N m and states of all laws over the twist of a drivetrain, in their order."""

    twists: FloatArray
    torques: FloatArray
    states: tuple[MotionState, ...]


def twist_balance(network: LawNetwork, external: Mapping[str, float]) -> TwistBalance:
    """Balance of all laws over the twist under torques in N m on nodes, with free motions held.

    Steps of the curves are ramps at first, which are made steeper until the pieces found hold the solution.

    Raises
    ------
    SolveError
        No balance was found.
    """
    q = np.zeros(len(network.coordinates))
    for ramp in RAMPS:
        search = _Search.of(network, external, ramp)
        reached = search.balance(q, 1.0)
        if reached is None:
            reached = search.raised(np.zeros(len(q)))
        if reached is None:
            break
        q = reached
        exact = search.in_pieces(q)
        if exact is not None:
            return exact
    names = ", ".join(dict.fromkeys(law.owner for law in network.over_twist))
    raise SolveError(f"no balance of the mean torques was found at the laws of motion of {names}", kind="no-solution")


@dataclass(frozen=True, eq=False)
class _Search:
    """Linear stiffness, rows and graphs of laws, and torques over the coordinates that springs resist."""

    stiffness: Any
    rows: Any
    torques: FloatArray
    graphs: tuple[MonotoneGraph, ...]
    floors: FloatArray

    @property
    def largest(self) -> float:
        """Largest torque in N m at a corner of a law."""
        return max((abs(torque) for graph in self.graphs for torque in graph.torques), default=0.0)

    @classmethod
    def of(cls, network: LawNetwork, external: Mapping[str, float], ramp: float) -> _Search:
        place = {name: number for number, name in enumerate(network.coordinates)}
        torques = np.zeros(len(place))
        for node, torque in external.items():
            for name, share in network.reduction.in_floats({node: 1}).items():
                if name in place:
                    torques[place[name]] += share * torque
        springs = [law for _, law in network.elastic]
        rows = row_matrix([network.reduction.in_floats(exact_row(law.row)) for law in springs], place)
        sizes = np.array([_stiffness_at_rest(law) for law in springs])
        laws = [law.law for law in network.over_twist]
        own = row_matrix([network.reduction.in_floats(exact_row(law.row)) for law in laws], place)
        graphs = tuple(monotone_graph(law.rounded, ramp) for law in network.over_twist)
        floors = np.array([LEAST_SLOPE * (graph.stiffest or 1.0) for graph in graphs])
        return cls(gram(rows, sizes), own, torques, graphs, floors)

    def _laws(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torques in N m and slopes in N m/rad of all laws."""
        pairs = [graph.at(twist) for graph, twist in zip(self.graphs, (self.rows @ q).tolist(), strict=True)]
        return np.array([torque for torque, _ in pairs]), np.array([slope for _, slope in pairs])

    def _residual(self, q: FloatArray, load: float) -> tuple[FloatArray, FloatArray, float]:
        """Residual torques on the coordinates, slopes of the laws, and the residual that counts as none."""
        own, slopes = self._laws(q)
        inner, outer = self.stiffness @ q, load * self.torques
        shares = self.rows.T @ own
        size = float(max(np.abs(part).max(initial=0.0) for part in (outer, inner, shares)))
        rounded = ROUNDED * (float(slopes.max(initial=0.0)) * float(np.abs(q).max(initial=0.0)) + self.largest)
        return outer - inner - shares, slopes, SMALL_RESIDUAL * size + rounded

    def balance(self, q: FloatArray, load: float) -> FloatArray | None:
        """Coordinates in balance with a share of the load, from others, or None where the search fails."""
        residual, slopes, none = self._residual(q, load)
        for _ in range(MOST_STEPS):
            if np.abs(residual).max(initial=0.0) <= none:
                return q
            # Newton: (K + sum_l k_l b_l b_l^T) step = residual
            step = solution(self.stiffness + gram(self.rows, np.maximum(slopes, self.floors)), residual)
            if not np.isfinite(step).all():
                return None
            after = self._residual(q + step, load)
            # The whole step if energy falls up to its end or the residual halves, else to the minimum along it.
            falls = step @ after[0] >= 0 or np.linalg.norm(after[0]) < np.linalg.norm(residual) / 2
            if not falls:
                step = step * _zero(partial(self._fall, q, step, load))
                after = self._residual(q + step, load)
            q = q + step
            residual, slopes, none = after
        return None

    def _fall(self, q: FloatArray, step: FloatArray, load: float, share: float) -> float:
        """Fall of the energy per share of a step, after a share of it."""
        return float(step @ self._residual(q + share * step, load)[0])

    def raised(self, q: FloatArray) -> FloatArray | None:
        """Coordinates in balance, from rest with the load raised in steps, or None where that fails too."""
        for step in range(1, LOAD_STEPS + 1):
            reached = self.balance(q, step / LOAD_STEPS)
            if reached is None:
                return None
            q = reached
        return q

    def in_pieces(self, q: FloatArray) -> TwistBalance | None:
        """Balance in the pieces in force at some coordinates, or None where these do not hold the solution.

        Straight pieces make a linear system, in which steps are constraints; smooth curves are followed by Newton's
        method.
        """
        n, rows, twists = len(self.torques), self.rows, self.rows @ q
        numbers = [graph.number_at(twist) for graph, twist in zip(self.graphs, twists.tolist(), strict=True)]
        pieces = [
            None if number is None or not isinstance(graph.law.curve, PieceCurve) else graph.law.curve.pieces[number]
            for graph, number in zip(self.graphs, numbers, strict=True)
        ]
        held = [place for place, piece in enumerate(pieces) if isinstance(piece, Hold)]
        places = [float(piece.at) for piece in pieces if isinstance(piece, Hold)]
        torques, unknowns = np.zeros(len(pieces)), np.concatenate([q, np.zeros(len(held))])
        for _ in range(MOST_STEPS):
            # Lines of the pieces in force: T_l = begun + slope gamma, and of steps b_l q = place as constraints.
            lines = [_line(*parts) for parts in zip(self.graphs, pieces, twists.tolist(), strict=True)]
            begun, slopes = (np.array([line[part] for line in lines]) for part in (0, 1))
            matrix = bordered(self.stiffness + gram(rows, slopes), rows[held])
            sloping = bordered(self.stiffness + gram(rows, np.maximum(slopes, self.floors)), rows[held])
            right = np.concatenate([self.torques - rows.T @ begun, places])
            for _ in range(CORRECTIONS):  # what level pieces leave open stays where it is
                unknowns = unknowns + solution(sloping, right - matrix @ unknowns)
            size = (abs(matrix) @ np.abs(unknowns) + np.abs(right)).max(initial=0.0)
            if not np.abs(matrix @ unknowns - right).max(initial=0.0) <= SMALL_RESIDUAL * size:
                return None
            before, twists = twists, rows @ unknowns[:n]
            torques = begun + slopes * twists
            torques[held] = unknowns[n:]
            twists[held] = places
            if all(piece is not None for piece in pieces) or (
                np.abs(twists - before).max(initial=0.0) <= SETTLED * np.abs(twists).max(initial=0.0)
            ):
                break
        laws = [graph.law for graph in self.graphs]
        if not all(map(_is_within, laws, pieces, twists.tolist(), torques.tolist())):
            return None
        states = [MotionState(twist, piece=number) for twist, number in zip(twists.tolist(), numbers, strict=True)]
        return TwistBalance(twists, torques, tuple(states))


def _line(graph: MonotoneGraph, piece: Slope | Hold | None, twist: float) -> tuple[float, float]:
    """Torque in N m at twist zero and slope in N m/rad of the line in place of a law; of a step there is none."""
    if isinstance(piece, Hold):
        return 0.0, 0.0
    if piece is not None:
        return float(graph.law.scale * piece.torque), float(graph.law.scale * piece.stiffness)
    torque, slope = graph.at(twist)
    return torque - slope * twist, slope


def _is_within(law: MotionLaw, piece: Slope | Hold | None, twist: float, torque: float) -> bool:
    """Whether a twist in rad, of a step the torque in N m, lies within a piece, but for rounding."""
    if piece is None:
        return True
    if isinstance(piece, Hold):
        low, high = float(law.scale) * float(piece.low), float(law.scale) * float(piece.high)
        slack = SLACK * max(abs(low), abs(high))
        return low - slack <= torque <= high + slack
    lower, upper = (None if end is None else float(end) for end in (piece.lower, piece.upper))
    slack = SLACK * max(abs(end) for end in (lower or 0.0, upper or 0.0))
    outermost = isinstance(law.curve, PieceCurve) and law.curve.pieces[0] is piece
    last = isinstance(law.curve, PieceCurve) and law.curve.pieces[-1] is piece
    above = lower is None or outermost or twist >= lower - slack
    return above and (upper is None or last or twist <= upper + slack)


def _stiffness_at_rest(law: Law) -> float:
    own = float(law.stiffness)
    return own + (float(law.table.kappa(np.zeros(1))[0].real) if law.table is not None else 0.0)


def _zero(slope: Callable[[float], float]) -> float:
    """Share of a step from 0 to 1 at which the energy along it stops falling, where ``slope`` changes its sign."""
    low, high = 0.0, 1.0
    at_low, at_high = slope(low), slope(high)
    for count in range(200):
        # False position, every third time a bisection, so that no end stays where it is.
        share = (low + high) / 2 if count % 3 == 2 else low + (high - low) * at_low / (at_low - at_high)
        value = slope(share)
        if value > 0:
            low, at_low = share, value
        elif value < 0:
            high, at_high = share, value
        if value == 0 or high - low <= 1e-15 * high:
            return share
    return (low + high) / 2
