"""Speeds at which laws of motion over the rate are in balance with the mean torques, all of them with their stability.

At steady speed springs pass speeds on, and inertias take no torque. What is left are the motions that no spring
resists, w, on which torques from outside f and laws over the rate act, those of dampers among them: f = sum_l r_l
T_l(r_l^T w). A law whose torque follows from these equations alone is inverted; of the others all solutions along their
common motion are bracketed between the corners of the curves. Where given speeds fix a motion and the torques given are
in balance, they hold as given: what dampers take there is part of them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import Fault, ModelError
from torsionnet.model.element_base.laws import AT_REST
from torsionnet.model.elements import MotionLaw
from torsionnet.model.kinematics import exact_row
from torsionnet.model.law_network import LawNetwork, PlacedMotionLaw
from torsionnet.model.load.external_torques import UNBALANCED_SHARE
from torsionnet.model.motion_laws.piece_curve import PieceCurve, Slope
from torsionnet.motion.balance.rate_states import (
    ZERO_SHARE,
    LawSpeed,
    beyond_reach,
    null_space,
    returns_to_speeds,
    roots_along,
    shared_by_sticking,
    state_at,
    states_at_speed,
    states_of_rate,
    sticks,
    torque_at,
)

FloatArray = NDArray[np.float64]

DIGITS = 14
"""Number of digits of torques from equilibrium: rounding beyond them would carry one as large as that of sticking, or
as the breakdown torque, past it."""
MOST_COMBINATIONS = 100
"""Largest number of combinations of states of laws that are listed: each costs a balance of the twists."""


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

    @property
    def sticking(self) -> int:
        """Number of laws that stick."""
        return sum(map(_holds, self.laws.items()))

    @property
    def slipping(self) -> dict[str, float]:
        """Slip in rad/s by element of friction that slips."""
        return {
            law.owner: speed.state.rate
            for law, speed in self.laws.items()
            if sticks(law.law) and not law.law.curve.holds(speed.state)
        }


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
    return _Motions.of(network, external, given, title).steady()


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
            coefficients = np.zeros(len(place))
            for name, share in network.free.in_floats(exact_row(row)).items():
                coefficients[place[name]] = share
            return coefficients

        nodes = {*external, *given}
        shares = {node: row_of({node: 1}) for node in network.nodes if node in nodes or len(network.over_rate)}
        torques, sizes = np.zeros(len(place)), np.zeros(len(place))
        for node, torque in external.items():
            torques += torque * shares[node]
            sizes += abs(torque) * np.abs(shares[node])
        known = [node for node in given if node in shares and shares[node].any()]
        matrix = np.array([shares[node] for node in known]).reshape(len(known), len(place))
        # Free motions of least length that have the speeds given, and the projection on what these fix.
        back = np.linalg.pinv(matrix)
        asked = back @ np.array([given[node] for node in known])
        rows = {law: row_of(law.law.row) for law in network.over_rate}
        motions = cls(network, external, title, shares, torques, sizes, rows, asked, back @ matrix)
        balanced = motions._is_balanced(torques)
        if balanced and not rows:
            return motions
        resisting = {damper: row_of(damper.law.row) for damper in network.dampers}
        rows |= {damper: row for damper, row in resisting.items() if not (balanced and motions._is_asked(row))}
        return replace(motions, shares={node: row_of({node: 1}) for node in network.nodes}, rows=rows)

    def _is_asked(self, row: FloatArray) -> bool:
        """Whether given speeds determine the motion of a row."""
        return bool(row.any()) and bool(
            np.abs(row - row @ self.directions).max(initial=0.0) < ZERO_SHARE * np.abs(row).max()
        )

    def steady(self) -> list[SteadySpeeds]:
        """Steady motions, by rising rates."""
        fixed = dict(self._fixed())
        torques = self.torques - sum(
            (self.rows[law] * speed.torque for law, speed in fixed.items() if speed.counts),
            start=np.zeros_like(self.torques),
        )
        left = [law for law in self.rows if law not in fixed]
        if not left:
            return [self._motion(fixed, self._require_balance(torques, fixed))]
        rows = np.array([self.rows[law] for law in left])
        # f = sum_l r_l T_l, with the least torques where several laws share a motion.
        least, *_ = np.linalg.lstsq(rows.T, torques, rcond=None)
        needed = np.array([float(f"{torque:.{DIGITS}g}") for torque in least.tolist()])
        over = self._require_balance(torques - rows.T @ needed, fixed)
        return [self._motion({**fixed, **states}, over) for states in self._solutions(left, rows, needed)]

    def _fixed(self) -> Iterator[tuple[PlacedMotionLaw, LawSpeed]]:
        """Laws whose rate is known before any torque: by springs beside them, or by the speeds that are given."""
        balanced = self._is_balanced(self.torques)
        for law, row in self.rows.items():
            rate = float(row @ self.asked)
            if not row.any():
                yield law, LawSpeed(state_at(law.law, 0.0), 0.0 if sticks(law.law) else torque_at(law.law, 0.0))
            elif self._is_asked(row) and (rate or not sticks(law.law)):
                own = [torque for node, torque in self.external.items() if torque and set(law.law.row) == {node}]
                if own and balanced and not sticks(law.law):  # the torque stated there is that of the law
                    share = float(next(iter(law.law.row.values())))
                    yield law, LawSpeed(state_at(law.law, rate, self._sensed(law)), -own[0] / share, counts=False)
                elif sticks(law.law) or law.law.sensed or not any(self.external.values()):
                    state = state_at(law.law, rate, self._sensed(law))
                    yield law, LawSpeed(state, float(law.law.torque(0.0, rate, *state.sensed)))

    def _sensed(self, law: PlacedMotionLaw) -> tuple[float, ...]:
        return tuple(
            float(sum(float(share) * (self.shares[node] @ self.asked) for node, share in row.items()))
            for row in law.law.sensed
        )

    def _is_balanced(self, torques: FloatArray) -> bool:
        return bool((np.abs(torques) <= UNBALANCED_SHARE * self.sizes + ZERO_SHARE * self.sizes.max(initial=0.0)).all())

    def _require_balance(self, left_over: FloatArray, fixed: Mapping[PlacedMotionLaw, LawSpeed]) -> FloatArray:
        """Torques that are left over, unless the torques from outside are out of balance with and without the laws."""
        if self._is_balanced(left_over) or self._is_balanced(self.torques):
            return left_over
        worst = int(np.argmax(np.abs(left_over)))
        name = self.network.free_motions[worst]
        acting = [f"{node} {torque:.6g} N*m" for node, torque in self.external.items() if torque]
        acting += [
            f"{law.owner} {speed.torque:.6g} N*m against its slip of {speed.state.rate:.6g} rad/s"
            for law, speed in fixed.items()
            if speed.torque and speed.counts
        ]
        text = (
            f"the mean torques ({', '.join(acting)}) leave {float(left_over[worst]):.4g} N*m over at the speed of "
            f"{name}, which nothing takes{self._advice(worst, float(left_over[worst]))}"
        )
        raise ModelError(
            [Fault(text, ("operating_point", "torque"), on_key=True, kind="unbalanced-torques")], self.title
        )

    def _advice(self, motion: int, torque: float) -> str:
        """Proposal of the torque at the node of the largest inertia that would bring a free motion into balance."""
        best, node = 0.0, ""
        for _, law in self.network.linear:
            if law.inertia != 0 and len(law.row) == 1 and not self.external.get(next(iter(law.row))):
                own = next(iter(law.row))
                share = self.network.free.in_floats({own: 1}).get(self.network.free_motions[motion], 0.0)
                if abs(share) * float(law.inertia) > best:
                    best, node = abs(share) * float(law.inertia), f"{own}: {-torque / share:.6g} N*m"
        return f'; give the torque of what is driven too, as "{node}"' if node else ""

    def _solutions(
        self, left: Sequence[PlacedMotionLaw], rows: FloatArray, needed: FloatArray
    ) -> Iterator[dict[PlacedMotionLaw, LawSpeed]]:
        """States of the laws whose rates are sought, in all combinations that are in balance."""
        for law in left:
            if law.law.sensed:
                text = "its torque follows the speeds of its nodes; give these as speed={node: value, ...}"
                raise ModelError([Fault(text, ("elements", law.owner), kind="no-solution")], self.title)
        # Torques that laws could exchange; a law without a share in any has that of equilibrium alone.
        shared = null_space(rows.T)
        alone = [number for number in range(len(left)) if np.abs(shared[number]).max(initial=0.0) < ZERO_SHARE]
        others = [number for number in range(len(left)) if number not in alone]
        choices: list[list[dict[PlacedMotionLaw, LawSpeed]]] = []
        for number in alone:
            law, torque = left[number], float(needed[number])
            states = states_of_rate(law.law, torque)
            if not states:
                raise ModelError(
                    [Fault(beyond_reach(law.law, torque), ("elements", law.owner), kind="no-solution")], self.title
                )
            choices.append([{law: LawSpeed(state, torque)} for state in states])
        if others:
            some = [left[number] for number in others]
            together = rows[others].T @ needed[others]
            choices.append(list(self._together(some, rows[others], together)))
        if math.prod(map(len, choices)) > MOST_COMBINATIONS:
            # Of too many states friction takes those in which it sticks.
            choices = [[choice for choice in some if any(map(_holds, choice.items()))] or some for some in choices]
        if math.prod(map(len, choices)) > MOST_COMBINATIONS:
            names = ", ".join(dict.fromkeys(law.owner for law in left))
            text = (
                f"{names} have {math.prod(map(len, choices))} balances together; give speeds as speed={{node: value}}"
            )
            raise ModelError([Fault(text, ("operating_point", "speed"), kind="missing-entry")], self.title)
        for some_states in itertools.product(*choices):
            yield {law: speed for part in some_states for law, speed in part.items()}

    def _together(
        self, laws: Sequence[PlacedMotionLaw], rows: FloatArray, torques: FloatArray
    ) -> Iterator[dict[PlacedMotionLaw, LawSpeed]]:
        """States of laws that share a torque: along one motion all of them, else those that stick."""
        names = ", ".join(dict.fromkeys(law.owner for law in laws))
        if np.linalg.matrix_rank(rows) > 1:
            against = list(self._against_dampers(laws, rows, torques))
            if against:
                yield from against
                return
            held = shared_by_sticking([law.law for law in laws], rows, torques)
            if held is None or not all(sticks(law.law) for law in laws):
                text = (
                    f"{names} share the mean torques at more than one speed; give these as speed={{node: value, ...}}"
                )
                raise ModelError([Fault(text, ("elements", laws[0].owner), kind="no-solution")], self.title)
            yield {law: LawSpeed(state_at(law.law, 0.0), torque) for law, torque in zip(laws, held, strict=True)}
            return
        # All laws act along one motion, so that one speed is sought.
        motion = rows[int(np.argmax(np.abs(rows).max(axis=1)))]
        motion = motion / np.linalg.norm(motion)
        factors, wanted = (rows @ motion).tolist(), float(torques @ motion)
        balances = [
            states_at_speed(laws, factors, wanted, speed)
            for speed in roots_along([law.law for law in laws], factors, wanted)
        ]
        if not balances:
            text = f"the mean torques leave {wanted:.4g} N*m for {names}, which no speed of them gives"
            raise ModelError([Fault(text, ("elements", laws[0].owner), kind="missing-entry")], self.title)
        yield from [states for states in balances if not any(map(_is_beyond, states.items()))] or balances

    def _against_dampers(
        self, laws: Sequence[PlacedMotionLaw], rows: FloatArray, torques: FloatArray
    ) -> Iterator[dict[PlacedMotionLaw, LawSpeed]]:
        """States of one law among dampers, which give all motions over its torque T: D w = f - r T, with g = r^T w.

        That leaves T(g) + g/s = r^T D^-1 f/s, s = r^T D^-1 r, of which all roots are taken.
        """
        linear = np.array([law in self.network.dampers for law in laws])
        D = (rows[linear].T * [law.law.curve.slopes(AT_REST)[1] for law in laws if law in self.network.dampers]) @ rows[
            linear
        ]
        if np.count_nonzero(~linear) > 1 or np.linalg.matrix_rank(D) < np.linalg.matrix_rank(rows):
            return
        back = np.linalg.pinv(D)
        motions = [(back @ torques, 0.0)]
        if not linear.all():
            (row,), (bent,) = rows[~linear], [law for law in laws if law not in self.network.dampers]
            s, free = float(row @ back @ row), float(row @ back @ torques)
            # The network of dampers acts on the bent law as one damper 1/s would, driven by free/s.
            path = MotionLaw(bent.law.row, PieceCurve("rate", (Slope(damping=1 / s),)))
            roots = roots_along([bent.law, path], [1.0, 1.0], free / s)
            motions = [(back @ (torques - row * torque), torque) for torque in ((free - rate) / s for rate in roots)]
        for motion, torque in motions:
            rates = (rows @ motion).tolist()
            yield {
                law: LawSpeed(state := state_at(law.law, rate), torque_at(law.law, state.rate) if damps else torque)
                for law, rate, damps in zip(laws, rates, linear.tolist(), strict=True)
            }

    def _motion(self, laws: Mapping[PlacedMotionLaw, LawSpeed], left_over: FloatArray) -> SteadySpeeds:
        solved = [law for law in laws if self.rows[law].any()]
        rows = np.array([self.rows[law] for law in solved]).reshape(len(solved), len(self.torques))
        rates = np.array([laws[law].state.rate for law in solved])
        # The least change of the speeds given that has the rates found.
        motion = self.asked + np.linalg.pinv(rows) @ (rates - rows @ self.asked)
        both = np.concatenate([rows, self.directions])
        # Rates and given speeds determine the speeds in this projection and no others.
        known = np.linalg.pinv(both) @ both
        speeds = {
            node: float(row @ motion)
            for node, row in self.shares.items()
            if np.abs(row - row @ known).max(initial=0.0) <= ZERO_SHARE * np.abs(row).max(initial=0.0)
        }
        asked = [number for number, row in enumerate(rows) if self._is_asked(row)]
        distance = float(np.abs(rows[asked] @ self.asked - rates[asked]).max(initial=0.0))
        over = dict(zip(self.network.free_motions, left_over.tolist(), strict=True))
        return SteadySpeeds(speeds, laws, returns_to_speeds(self.network, self.rows, laws), over, distance)


def _holds(pair: tuple[PlacedMotionLaw, LawSpeed]) -> bool:
    return pair[0].law.curve.holds(pair[1].state)


def _is_beyond(pair: tuple[PlacedMotionLaw, LawSpeed]) -> bool:
    """Whether a state lies beyond an end of its curve."""
    state = pair[1].state
    return bool(pair[0].law.curve.left(state.twist, state.rate, *state.sensed))
