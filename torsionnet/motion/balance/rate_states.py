"""States of laws of motion over the rate under a torque: one law inverted, several along one motion bracketed."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.model.element_base.laws import AT_REST, MotionState
from torsionnet.model.elements import MotionLaw
from torsionnet.model.kinematics import exact_row
from torsionnet.model.law_network import LawNetwork, PlacedMotionLaw
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve

FloatArray = NDArray[np.float64]

NEAR = 1e-9
"""Share of a speed within which two of them are one, but for rounding."""
SLOWEST, FASTEST, PLACES = 1e-6, 1e5, 240
"""Rates in rad/s, and how many of them on either side of zero, between which roots of smooth curves are bracketed."""
BETWEEN = 40
"""Number of places from one corner of smooth curves to the next: sums of curves have more extremes than these."""


@dataclass(frozen=True)
class LawSpeed:
    """State of a law over the rate, its torque in N m, and whether that torque acts besides those from outside."""

    state: MotionState
    torque: float
    counts: bool = True


def sticks(law: MotionLaw) -> bool:
    """Whether the law is friction, which holds its row still up to some torque."""
    return law.curve.holds(AT_REST)


def torque_at(law: MotionLaw, rate: float) -> float:
    return float(law.torque(0.0, rate, *([0.0] * len(law.sensed))))


def state_at(law: MotionLaw, rate: float, sensed: tuple[float, ...] = ()) -> MotionState:
    number = law.curve.number_at(0.0, rate) if isinstance(law.curve, PieceCurve) else None
    return MotionState(0.0, rate, sensed or (0.0,) * len(law.sensed), number)


def states_of_rate(law: MotionLaw, torque: float) -> list[MotionState]:
    """States at which a law over the rate gives a torque in N m, by rising rate; friction may stick and slip alike."""
    if not law.scale:
        return [] if torque else [AT_REST]
    states = law.curve.states_at(torque / law.scale)
    if states is None:
        rates = roots_along([law], [1.0], torque)
        states = tuple(state_at(law, rate) for rate in rates)
    return list(states)


def roots_along(laws: Sequence[MotionLaw], factors: Sequence[float], wanted: float) -> list[float]:
    """Speeds in rad/s at which torques of laws along one motion add up to the torque wanted, sum_l a_l T_l(a_l w)."""
    from scipy.optimize import brentq

    def over(speed: float) -> float:
        return sum(factor * torque_at(law, factor * speed) for law, factor in zip(laws, factors, strict=True)) - wanted

    # Between corners sums of straight pieces are straight; smooth curves may turn there and need more places.
    places = {0.0}
    for law, factor in zip(laws, factors, strict=True):
        places |= {float(corner) / factor for corner in law.curve.corners()}
    if not all(isinstance(law.curve, PieceCurve) for law in laws):
        for low, high in itertools.pairwise(sorted(places)):
            places |= set(np.linspace(low, high, BETWEEN).tolist())
        places |= {sign * size for size in np.geomspace(SLOWEST, FASTEST, PLACES).tolist() for sign in (-1, 1)}
    ordered = sorted(places)
    reach = 1e3 * max(1.0, *map(abs, ordered))
    speeds: list[float] = []
    level: list[float] = []
    for low, high in itertools.pairwise((-reach, *ordered, reach)):
        # Just inside the ends, as the torque may jump at both.
        inside = 1e-12 * (high - low)
        start, end = over(low + inside), over(high - inside)
        if start == 0 and end == 0:
            level.append(low + inside if low >= 0 else high - inside)
        elif start == 0:
            speeds.append(low + inside)
        elif start * end < 0:
            speeds.append(float(brentq(over, low + inside, high - inside, xtol=1e-300, rtol=1e-14)))
    for place in ordered:  # at a step the torque takes every value between those beside it
        low, high = _range_at(laws, factors, place)
        if low <= wanted <= high and not any(_is_near(place, near) for near in speeds):
            speeds.append(place)
    return sorted(speeds) or level  # of a level piece, in balance at any speed, the place next to zero


def _is_near(speed: float, other: float) -> bool:
    return abs(speed - other) <= NEAR * max(abs(speed), abs(other), SLOWEST)


def _range_at(laws: Sequence[MotionLaw], factors: Sequence[float], speed: float) -> tuple[float, float]:
    """Range of torques in N m that laws may take together at a speed in rad/s."""
    low = high = 0.0
    for law, factor in zip(laws, factors, strict=True):
        held = [
            piece
            for piece in (law.curve.pieces if isinstance(law.curve, PieceCurve) else ())
            if isinstance(piece, Hold) and _is_near(float(piece.at), factor * speed)
        ]
        if held:
            ends = sorted(factor * float(law.scale) * float(end) for end in (held[0].low, held[0].high))
            low, high = low + ends[0], high + ends[1]
        else:
            low += factor * torque_at(law, factor * speed)
            high += factor * torque_at(law, factor * speed)
    return low, high


def states_at_speed(
    laws: Sequence[PlacedMotionLaw], factors: Sequence[float], wanted: float, speed: float
) -> dict[PlacedMotionLaw, LawSpeed]:
    """States of laws at a speed in rad/s; those that stick share what the others leave, each within its range."""
    speeds = {
        law: LawSpeed(state := state_at(law.law, factor * speed), float(law.law.torque(0.0, state.rate)))
        for law, factor in zip(laws, factors, strict=True)
    }
    held = {law: factor for law, factor in zip(laws, factors, strict=True) if law.law.curve.holds(speeds[law].state)}
    if held:
        others = ((law, factor) for law, factor in zip(laws, factors, strict=True) if law not in held)
        # What those that slip leave to those that stick.
        rest = wanted - sum(factor * speeds[law].torque for law, factor in others)
        rows = np.array([[factor] for factor in held.values()])
        torques = shared_by_sticking([law.law for law in held], rows, np.array([rest]))
        if torques is not None:
            speeds |= {law: replace(speeds[law], torque=torque) for law, torque in zip(held, torques, strict=True)}
    return speeds


def shared_by_sticking(laws: Sequence[MotionLaw], rows: FloatArray, torques: FloatArray) -> list[float] | None:
    """Torques in N m (n_laws,) with which friction that sticks holds torques on free motions; None where it slips.

    Of all that are within the ranges of friction they are the least in the sum of squares; ``rows`` are (n_laws, n).
    """
    # Least squares without bounds; only where one is passed, the search within bounds.
    least, *_ = np.linalg.lstsq(rows.T, torques, rcond=None)
    ranges = np.array([sticking_range(law) for law in laws]).T
    size = max(float(np.abs(torques).max(initial=0.0)), float(np.abs(ranges).max(initial=0.0)))
    if (ranges[0] <= least).all() and (least <= ranges[1]).all():
        shared = least
    else:
        from scipy.optimize import lsq_linear

        wide = ranges[1] > ranges[0]
        held = np.where(wide, 0.0, ranges[0])
        shared = held.copy()
        if wide.any():
            shared[wide] = lsq_linear(
                rows[wide].T, torques - rows.T @ held, (ranges[0, wide], ranges[1, wide]), tol=NEAR**2
            ).x
    enough = np.abs(rows.T @ shared - torques).max(initial=0.0) <= NEAR * size
    return shared.tolist() if enough else None


def sticking_range(law: MotionLaw) -> tuple[float, float]:
    """Smallest and largest torque in N m at which friction sticks."""
    for piece in law.curve.pieces if isinstance(law.curve, PieceCurve) else ():
        if isinstance(piece, Hold) and piece.at == 0:
            low, high = sorted(float(law.scale) * float(end) for end in (piece.low, piece.high))
            return low, high
    return 0.0, 0.0


def beyond_reach(law: MotionLaw, torque: float) -> str:
    """Message that no rate gives a torque in N m, with the largest and smallest torque of the law."""
    places = [float(corner) for corner in law.curve.corners()] or [
        sign * rate for rate in np.geomspace(SLOWEST, FASTEST, PLACES).tolist() for sign in (-1, 1)
    ]
    torques = [torque_at(law, place) for place in places] + [0.0]
    for piece in law.curve.pieces if isinstance(law.curve, PieceCurve) else ():
        if isinstance(piece, Hold):
            torques += [float(law.scale) * float(piece.low), float(law.scale) * float(piece.high)]
    return (
        f"the mean torques ask it for {torque:.6g} N*m, and it gives from {min(torques):.6g} to {max(torques):.6g} "
        "N*m; there is no steady speed: reduce the torque"
    )


# Stability of steady speeds under the slopes of laws of motion over the rate.

ZERO_SHARE = 1e-9
"""Size of a number over those that it was made of below which it counts as zero."""


def returns_to_speeds(
    network: LawNetwork, rows: Mapping[PlacedMotionLaw, FloatArray], laws: Mapping[PlacedMotionLaw, LawSpeed]
) -> bool:
    """Whether the free motions, with the inertias that follow them, return to their speeds.

    ``rows`` are those of the laws over the free motions, in which laws that stick allow no motion.
    """
    # M w' + D w = 0 over the free motions, D from the slopes of the laws over the rate.
    n = len(network.free_motions)
    inertia, damping = np.zeros((n, n)), np.zeros((n, n))
    for _, law in network.linear:
        if law.inertia != 0:
            row = free_row(network, law.row)
            inertia += float(law.inertia) * np.outer(row, row)
    stuck = []
    for placed, speed in laws.items():
        if placed.law.curve.holds(speed.state):
            stuck.append(rows[placed])
        else:
            scale, slopes = float(placed.law.scale), placed.law.curve.slopes(speed.state)
            _, slope, *others = (scale * float(slope) for slope in slopes)
            damping += slope * np.outer(rows[placed], rows[placed])
            for sensed, share in zip(placed.law.sensed, others, strict=True):
                damping += share * np.outer(rows[placed], free_row(network, sensed))
    # Friction that sticks allows its row no motion.
    moving = null_space(np.array(stuck).reshape(len(stuck), n))
    inertia, damping = moving.T @ inertia @ moving, moving.T @ damping @ moving
    if not damping.size or not damping.any():
        return True
    # Where some motion has no inertia the signs of D decide alone.
    if np.linalg.matrix_rank(inertia) < len(inertia):
        inertia = np.eye(len(inertia))
    # w' = -M^-1 D w returns unless M^-1 D has an eigenvalue below zero.
    rates = np.linalg.eigvals(np.linalg.solve(inertia, damping)).real
    return bool(rates.min() >= -ZERO_SHARE * np.abs(rates).max())


def returns_to_twists(network: LawNetwork, states: Mapping[PlacedMotionLaw, MotionState]) -> bool:
    """Whether the twists return where the torque of a law over the twist falls: its energy is least there.

    Steps hold their rows still; the stiffness of all other laws is positive on what is left.
    """
    slopes = {
        law: float(law.rounded.scale) * float(law.law.curve.slopes(state)[0])
        for law, state in states.items()
        if not law.law.curve.holds(state)
    }
    if all(slope >= 0 for slope in slopes.values()):
        return True
    place = {name: number for number, name in enumerate(network.coordinates)}

    def row_of(row: Mapping[str, Any]) -> FloatArray:
        coefficients = np.zeros(len(place))
        for name, share in network.reduction.in_floats(exact_row(row)).items():
            if name in place:
                coefficients[place[name]] = share
        return coefficients

    rows = [(row_of(law.row), float(law.stiffness)) for _, law in network.elastic]
    rows += [(row_of(law.law.row), slope) for law, slope in slopes.items()]
    held = [row_of(law.law.row) for law in states if law not in slopes]
    moving = null_space(np.array(held).reshape(len(held), len(place)))
    # The second derivative of the energy on the motions that steps leave free.
    stiffness = sum(size * np.outer(moving.T @ row, moving.T @ row) for row, size in rows)
    sizes = np.linalg.eigvalsh(stiffness)
    return bool(sizes.min() >= -ZERO_SHARE * np.abs(sizes).max())


def free_row(network: LawNetwork, row: Mapping[str, Any]) -> FloatArray:
    """Coefficients (n_free,) of a row of node angles over the free motions."""
    shares = network.free.in_floats(exact_row(row))
    return np.array([shares.get(name, 0.0) for name in network.free_motions])


def null_space(matrix: FloatArray) -> FloatArray:
    """Orthonormal columns (n, n_null) of the null space of a matrix (m, n)."""
    if not matrix.shape[0]:
        return np.eye(matrix.shape[1])
    _, sizes, right = np.linalg.svd(matrix)
    rank = int((sizes > ZERO_SHARE * sizes.max(initial=0.0)).sum())
    return np.asarray(right[rank:].T)
