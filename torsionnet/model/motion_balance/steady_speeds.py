"""Speeds at which laws of motion over the rate are in balance with the mean torques, all of them with their stability.

At steady speed springs pass speeds on, inertias and dampers take no torque. What is left are the motions that no spring
resists, w, on which torques from outside f and laws over the rate act: f = sum_l r_l T_l(r_l^T w). A law whose torque
follows from these equations alone is inverted; of the others all solutions along their common motion are bracketed
between the corners of the curves.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.core.errors import Fault, ModelError
from torsionnet.core.units import RPM
from torsionnet.model.element_base.torque_curve import AT_REST, MotionState
from torsionnet.model.elements import MotionLaw
from torsionnet.model.kinematics import exact_row
from torsionnet.model.load.external_torques import UNBALANCED_SHARE
from torsionnet.model.motion_balance.law_network import LawNetwork, PlacedMotionLaw
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve

FloatArray = NDArray[np.float64]

ZERO_SHARE = 1e-9
"""Size of a number over those that it was made of below which it counts as zero."""
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


@dataclass(frozen=True, eq=False)
class SteadySpeeds:
    """Speeds of a steady motion by node in rad/s, and the state of every law over the rate.

    ``left_over`` are the torques in N m on the free motions that nothing takes.
    """

    speeds: Mapping[str, float]
    laws: Mapping[PlacedMotionLaw, LawSpeed]
    is_stable: bool
    left_over: Mapping[str, float]
    distance: float = 0.0
    """Distance in rad/s of the rates from those that the given speeds ask for."""


def steady_speeds(
    network: LawNetwork, external: Mapping[str, float], given: Mapping[str, float], title: str
) -> list[SteadySpeeds]:
    """Steady motions of a drivetrain under torques in N m by node, by rising rates of its laws.

    Speeds in rad/s that are ``given`` by node hold for laws that slip with friction alone; other laws have the speeds
    at which they are in balance.

    Raises
    ------
    ModelError
        There is none: a torque beyond the breakdown torque, or torques that leave something over.
    """
    return _Motions.of(network, external, given, title).found()


@dataclass(frozen=True, eq=False)
class _Motions:
    """Free motions of a drivetrain with the torques on them and the rows of the laws over the rate."""

    network: LawNetwork
    external: Mapping[str, float]
    title: str
    shares: Mapping[str, FloatArray]
    torques: FloatArray
    sizes: FloatArray
    rows: Mapping[PlacedMotionLaw, FloatArray]
    asked: FloatArray
    directions: FloatArray

    @classmethod
    def of(cls, network: LawNetwork, external: Mapping[str, float], given: Mapping[str, float], title: str) -> _Motions:
        place = {name: number for number, name in enumerate(network.free_motions)}

        def row_of(row: Mapping[str, Any]) -> FloatArray:
            found = np.zeros(len(place))
            for name, share in network.free.in_floats(exact_row(row)).items():
                found[place[name]] = share
            return found

        nodes = {*external, *given}
        shares = {node: row_of({node: 1}) for node in network.nodes if node in nodes or len(network.over_rate)}
        torques, sizes = np.zeros(len(place)), np.zeros(len(place))
        for node, torque in external.items():
            torques += torque * shares[node]
            sizes += abs(torque) * np.abs(shares[node])
        known = [node for node in given if node in shares and shares[node].any()]
        matrix = np.array([shares[node] for node in known]).reshape(len(known), len(place))
        back = np.linalg.pinv(matrix)
        asked = back @ np.array([given[node] for node in known])
        rows = {one: row_of(one.law.row) for one in network.over_rate}
        return cls(network, external, title, shares, torques, sizes, rows, asked, back @ matrix)

    def _is_asked(self, row: FloatArray) -> bool:
        """Whether given speeds determine the motion of a row."""
        return bool(row.any()) and bool(
            np.abs(row - row @ self.directions).max(initial=0.0) < ZERO_SHARE * np.abs(row).max()
        )

    def found(self) -> list[SteadySpeeds]:
        """Steady motions, by rising rates."""
        fixed = dict(self._fixed())
        torques = self.torques - sum(
            (self.rows[one] * speed.torque for one, speed in fixed.items() if speed.counts),
            start=np.zeros_like(self.torques),
        )
        left = [one for one in self.rows if one not in fixed]
        if not left:
            return [self._motion(fixed, self._require_balance(torques))]
        rows = np.array([self.rows[one] for one in left])
        needed, *_ = np.linalg.lstsq(rows.T, torques, rcond=None)
        over = self._require_balance(torques - rows.T @ needed)
        return [self._motion({**fixed, **one}, over) for one in self._solutions(left, rows, needed)]

    def _fixed(self) -> Iterator[tuple[PlacedMotionLaw, LawSpeed]]:
        """Laws whose rate is known before any torque: by springs beside them, or by the speeds that are given."""
        balanced = self._is_balanced(self.torques)
        for one, row in self.rows.items():
            rate = float(row @ self.asked)
            if not row.any():
                yield one, LawSpeed(_state_at(one.law, 0.0), 0.0 if _sticks(one.law) else _torque(one.law, 0.0))
            elif self._is_asked(row) and (rate or not _sticks(one.law)):
                own = [torque for node, torque in self.external.items() if torque and set(one.law.row) == {node}]
                if own and balanced and not _sticks(one.law):  # the torque stated there is that of the law
                    share = float(next(iter(one.law.row.values())))
                    yield one, LawSpeed(_state_at(one.law, rate, self._sensed(one)), -own[0] / share, counts=False)
                elif _sticks(one.law) or one.law.sensed or not any(self.external.values()):
                    state = _state_at(one.law, rate, self._sensed(one))
                    yield one, LawSpeed(state, float(one.law.torque(0.0, rate, *state.sensed)))

    def _sensed(self, one: PlacedMotionLaw) -> tuple[float, ...]:
        return tuple(
            float(sum(float(share) * (self.shares[node] @ self.asked) for node, share in row.items()))
            for row in one.law.sensed
        )

    def _is_balanced(self, torques: FloatArray) -> bool:
        return bool((np.abs(torques) <= UNBALANCED_SHARE * self.sizes + ZERO_SHARE * self.sizes.max(initial=0.0)).all())

    def _require_balance(self, left_over: FloatArray) -> FloatArray:
        """Torques that are left over, unless the torques from outside are out of balance with and without the laws."""
        if self._is_balanced(left_over) or self._is_balanced(self.torques):
            return left_over
        worst = int(np.argmax(np.abs(left_over)))
        name = self.network.free_motions[worst]
        acting = ", ".join(f"{node} {torque:.6g} N*m" for node, torque in self.external.items() if torque)
        text = (
            f"the mean torques ({acting}) leave {float(left_over[worst]):.4g} N*m over at the speed of {name}, which "
            f"nothing takes{self._advice(worst, float(left_over[worst]))}"
        )
        raise ModelError([Fault(text, ("operating_point", "torque"), on_key=True)], self.title)

    def _advice(self, motion: int, torque: float) -> str:
        """Proposal of the torque at the node of the largest inertia that would bring a free motion into balance."""
        best, node = 0.0, ""
        for _, law in self.network.linear:
            if law.inertia != 0 and len(law.row) == 1 and not self.external.get(next(iter(law.row))):
                one = next(iter(law.row))
                share = self.network.free.in_floats({one: 1}).get(self.network.free_motions[motion], 0.0)
                if abs(share) * float(law.inertia) > best:
                    best, node = abs(share) * float(law.inertia), f"{one}: {-torque / share:.6g} N*m"
        return f'; give the torque of what is driven too, as "{node}"' if node else ""

    def _solutions(
        self, left: Sequence[PlacedMotionLaw], rows: FloatArray, needed: FloatArray
    ) -> Iterator[dict[PlacedMotionLaw, LawSpeed]]:
        """States of the laws whose rates are sought, in all combinations that are in balance."""
        for one in left:
            if one.law.sensed:
                text = "its torque follows the speeds of its nodes; give these as speed={node: value, ...}"
                raise ModelError([Fault(text, ("elements", one.owner))], self.title)
        shared = _null_space(rows.T)
        alone = [number for number in range(len(left)) if np.abs(shared[number]).max(initial=0.0) < ZERO_SHARE]
        others = [number for number in range(len(left)) if number not in alone]
        choices: list[list[dict[PlacedMotionLaw, LawSpeed]]] = []
        for number in alone:
            one, torque = left[number], float(needed[number])
            states = states_of_rate(one.law, torque)
            if not states:
                raise ModelError([Fault(_beyond(one.law, torque), ("elements", one.owner))], self.title)
            choices.append([{one: LawSpeed(state, torque)} for state in states])
        if others:
            some = [left[number] for number in others]
            together = rows[others].T @ needed[others]
            choices.append(list(self._together(some, rows[others], together)))
        for some_states in itertools.product(*choices):
            yield {one: speed for part in some_states for one, speed in part.items()}

    def _together(
        self, laws: Sequence[PlacedMotionLaw], rows: FloatArray, torques: FloatArray
    ) -> Iterator[dict[PlacedMotionLaw, LawSpeed]]:
        """States of laws that share a torque: along one motion all of them, else those near the speeds asked for."""
        names = ", ".join(dict.fromkeys(one.owner for one in laws))
        if all(_sticks(one.law) for one in laws):
            needed, *_ = np.linalg.lstsq(rows.T, torques, rcond=None)
            found = [_stuck(one.law, torque) for one, torque in zip(laws, needed.tolist(), strict=True)]
            if None not in found:
                yield {one: state for one, state in zip(laws, found, strict=True) if state is not None}
                return
        if np.linalg.matrix_rank(rows) > 1:
            text = f"{names} share the mean torques at more than one speed; give these as speed={{node: value, ...}}"
            raise ModelError([Fault(text, ("elements", laws[0].owner))], self.title)
        motion = rows[int(np.argmax(np.abs(rows).max(axis=1)))]
        motion = motion / np.linalg.norm(motion)
        factors, wanted = (rows @ motion).tolist(), float(torques @ motion)
        found_any = False
        for speed in _roots([one.law for one in laws], factors, wanted):
            found_any = True
            yield _states_at_speed(laws, factors, wanted, speed)
        if not found_any:
            text = f"the mean torques leave {wanted:.4g} N*m for {names}, which no speed of them gives"
            raise ModelError([Fault(text, ("elements", laws[0].owner))], self.title)

    def _motion(self, laws: Mapping[PlacedMotionLaw, LawSpeed], left_over: FloatArray) -> SteadySpeeds:
        solved = [one for one in laws if self.rows[one].any()]
        rows = np.array([self.rows[one] for one in solved]).reshape(len(solved), len(self.torques))
        rates = np.array([laws[one].state.rate for one in solved])
        motion = self.asked + np.linalg.pinv(rows) @ (rates - rows @ self.asked)
        both = np.concatenate([rows, self.directions])
        known = np.linalg.pinv(both) @ both
        speeds = {
            node: float(row @ motion)
            for node, row in self.shares.items()
            if np.abs(row - row @ known).max(initial=0.0) <= ZERO_SHARE * np.abs(row).max(initial=0.0)
        }
        asked = [number for number, row in enumerate(rows) if self._is_asked(row)]
        distance = float(np.abs(rows[asked] @ self.asked - rates[asked]).max(initial=0.0))
        over = dict(zip(self.network.free_motions, left_over.tolist(), strict=True))
        return SteadySpeeds(speeds, laws, self._is_stable(laws), over, distance)

    def _is_stable(self, laws: Mapping[PlacedMotionLaw, LawSpeed]) -> bool:
        """Whether the free motions, with the inertias that follow them, return to their speeds."""
        n = len(self.torques)
        inertia, damping = np.zeros((n, n)), np.zeros((n, n))
        for _, law in self.network.linear:
            if law.inertia != 0:
                row = self._row(law.row)
                inertia += float(law.inertia) * np.outer(row, row)
        stuck = []
        for one, speed in laws.items():
            if one.law.curve.holds(speed.state):
                stuck.append(self.rows[one])
            else:
                slope = float(one.law.scale) * float(one.law.curve.slopes(speed.state)[1])
                damping += slope * np.outer(self.rows[one], self.rows[one])
        moving = _null_space(np.array(stuck).reshape(len(stuck), n))
        inertia, damping = moving.T @ inertia @ moving, moving.T @ damping @ moving
        if not damping.size or not damping.any():
            return True
        if np.linalg.matrix_rank(inertia) < len(inertia):
            inertia = np.eye(len(inertia))
        rates = np.linalg.eigvals(np.linalg.solve(inertia, damping)).real
        return bool(rates.min() >= -ZERO_SHARE * np.abs(rates).max())

    def _row(self, row: Mapping[str, Any]) -> FloatArray:
        found = self.network.free.in_floats(exact_row(row))
        return np.array([found.get(name, 0.0) for name in self.network.free_motions])


def _null_space(matrix: FloatArray) -> FloatArray:
    """Orthonormal columns (n, n_null) of the null space of a matrix (m, n)."""
    if not matrix.shape[0]:
        return np.eye(matrix.shape[1])
    _, sizes, right = np.linalg.svd(matrix)
    rank = int((sizes > ZERO_SHARE * sizes.max(initial=0.0)).sum())
    return np.asarray(right[rank:].T)


def _sticks(law: MotionLaw) -> bool:
    """Whether the law is friction, which holds its row still up to some torque."""
    return law.curve.holds(AT_REST)


def _torque(law: MotionLaw, rate: float) -> float:
    return float(law.torque(0.0, rate, *([0.0] * len(law.sensed))))


def _state_at(law: MotionLaw, rate: float, sensed: tuple[float, ...] = ()) -> MotionState:
    number = law.curve.number_at(0.0, rate) if isinstance(law.curve, PieceCurve) else None
    return MotionState(0.0, rate, sensed or (0.0,) * len(law.sensed), number)


def _stuck(law: MotionLaw, torque: float) -> LawSpeed | None:
    """State of a friction that sticks under a torque in N m, or None where the torque makes it slip."""
    for number, piece in enumerate(law.curve.pieces if isinstance(law.curve, PieceCurve) else ()):
        if isinstance(piece, Hold) and piece.at == 0:
            low, high = float(law.scale) * float(piece.low), float(law.scale) * float(piece.high)
            return LawSpeed(MotionState(piece=number), torque) if low <= torque <= high else None
    return None


def states_of_rate(law: MotionLaw, torque: float) -> list[MotionState]:
    """States at which a law over the rate gives a torque in N m, by rising rate; of friction that sticks only that."""
    if not law.scale:
        return [] if torque else [AT_REST]
    found = law.curve.states_at(torque / law.scale)
    if found is None:
        rates = _roots([law], [1.0], torque)
        found = tuple(_state_at(law, rate) for rate in rates)
    holding = [state for state in found if law.curve.holds(state)]
    return holding or list(found)


def _roots(laws: Sequence[MotionLaw], factors: Sequence[float], wanted: float) -> list[float]:
    """Speeds in rad/s at which torques of laws along one motion add up to the torque wanted, sum_l a_l T_l(a_l w)."""
    from scipy.optimize import brentq

    def over(speed: float) -> float:
        return sum(factor * _torque(law, factor * speed) for law, factor in zip(laws, factors, strict=True)) - wanted

    places = {0.0}
    for law, factor in zip(laws, factors, strict=True):
        places |= {float(corner) / factor for corner in law.curve.corners()}
    if not all(isinstance(law.curve, PieceCurve) for law in laws):
        for low, high in itertools.pairwise(sorted(places)):
            places |= set(np.linspace(low, high, BETWEEN).tolist())
        places |= {sign * one for one in np.geomspace(SLOWEST, FASTEST, PLACES).tolist() for sign in (-1, 1)}
    ordered = sorted(places)
    reach = 1e3 * max(1.0, *map(abs, ordered))
    found: list[float] = []
    for low, high in itertools.pairwise((-reach, *ordered, reach)):
        inside = 1e-12 * (high - low)
        start, end = over(low + inside), over(high - inside)
        if start == 0:
            found.append(low + inside)
        if start * end < 0:
            found.append(float(brentq(over, low + inside, high - inside, xtol=1e-300, rtol=1e-14)))
    for place in ordered:  # at a step the torque takes every value between those beside it
        low, high = _range_at(laws, factors, place)
        if low <= wanted <= high and not any(_is_near(place, one) for one in found):
            found.append(place)
    return sorted(found)


def _is_near(one: float, other: float) -> bool:
    return abs(one - other) <= ZERO_SHARE * max(abs(one), abs(other), SLOWEST)


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
            low += factor * _torque(law, factor * speed)
            high += factor * _torque(law, factor * speed)
    return low, high


def _states_at_speed(
    laws: Sequence[PlacedMotionLaw], factors: Sequence[float], wanted: float, speed: float
) -> dict[PlacedMotionLaw, LawSpeed]:
    """States of laws at a speed in rad/s; those that stick share what the others leave by their ranges."""
    found = {
        one: LawSpeed(state := _state_at(one.law, factor * speed), float(one.law.torque(0.0, state.rate)))
        for one, factor in zip(laws, factors, strict=True)
    }
    held = [one for one in laws if one.law.curve.holds(found[one].state)]
    if held:
        by = dict(zip(laws, factors, strict=True))
        rest = wanted - sum(by[one] * found[one].torque for one in laws if one not in held)
        size = sum(by[one] ** 2 for one in held)
        for one in held:
            found[one] = replace(found[one], torque=rest * by[one] / size)
    return found


def _beyond(law: MotionLaw, torque: float) -> str:
    """Message that no rate gives a torque in N m, with the largest and smallest torque of the law."""
    places = [float(corner) for corner in law.curve.corners()] or [
        sign * one for one in np.geomspace(SLOWEST, FASTEST, PLACES).tolist() for sign in (-1, 1)
    ]
    torques = [_torque(law, place) for place in places] + [0.0]
    for piece in law.curve.pieces if isinstance(law.curve, PieceCurve) else ():
        if isinstance(piece, Hold):
            torques += [float(law.scale) * float(piece.low), float(law.scale) * float(piece.high)]
    return (
        f"the mean torques ask it for {torque:.6g} N*m, and it gives from {min(torques):.6g} to {max(torques):.6g} "
        "N*m; there is no steady speed: reduce the torque"
    )


def shown_speed(speed: float) -> str:
    """Text of a speed in rad/s, in rpm."""
    return f"{speed * RPM:.6g} rpm"
