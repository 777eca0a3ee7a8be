"""Motions over time with laws of straight pieces, by CVODE with located events and matrices assembled here.

Nothing of the package takes part but the entries of the elements: their parts are added up in dense matrices, held rows
are eliminated by a null space, and CVODE integrates every contact state at tolerances near rounding. Turning points
of every twist are roots as well, so that a contact that closes and opens within one step of CVODE is found.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy

from support.collecting import OnDemand
from torsionnet.base.expressions import FLOAT
from torsionnet.model.element_base.laws import Constraint, Law, MotionLaw, Values
from torsionnet.model.motion_laws.piece_curve import Hold

sundials = OnDemand("sksundae.cvode")
RELATIVE, ABSOLUTE = 1e-12, 1e-15
STEPS_A_RADIAN = 8.0
"""Least steps while the fastest vibration turns by one radian."""
PUSH, FREE = 1, 0


@dataclass
class ReferenceMotion:
    """Angles (n_t, nodes) in rad, speeds in rad/s, works in J against each law of motion, and events (time, law)."""

    nodes: tuple[str, ...]
    times: np.ndarray
    angles: np.ndarray
    speeds: np.ndarray
    works: np.ndarray
    events: list[tuple[float, str, str]]
    owners: list[str] = field(default_factory=list)

    def angle(self, node: str) -> np.ndarray:
        return self.angles[:, self.nodes.index(node)]

    def speed(self, node: str) -> np.ndarray:
        return self.speeds[:, self.nodes.index(node)]


class _Law:
    """A law of motion over the coordinates: row b, pieces, and the state it is in (piece, pushing or free)."""

    def __init__(self, owner, law, row):
        self.owner, self.row, self.scale = owner, row, float(law.scale)
        self.over, self.curve = law.curve.over, law.curve
        self.pieces = law.curve.pieces
        self.piece, self.pushes, self.slider = 0, PUSH, None

    @property
    def now(self):
        return self.pieces[self.piece]

    @property
    def holds(self):
        return isinstance(self.now, Hold)

    def torque(self, twist, rate):
        """Of the straight piece in force, without a look at its bounds."""
        piece = self.now
        if self.pushes == FREE:
            return 0.0
        return self.scale * (float(piece.torque) + float(piece.stiffness) * twist + float(piece.damping) * rate)

    def full(self, twist, rate):
        piece = self.now
        return self.scale * (float(piece.torque) + float(piece.stiffness) * twist + float(piece.damping) * rate)

    def enter(self, piece, twist, rate):
        self.piece, self.pushes = piece, PUSH
        if not self.holds and self.now.side and self.now.damping:
            self.pushes = PUSH if self.now.side * self.full(twist, rate) > 0 else FREE


def dense_parts(drivetrain):
    """Matrices M, C, K (n, n), rows of constraints, and laws of motion (owner, law, row) over the nodes."""
    value = Values(drivetrain.exact_values, FLOAT)
    parts = [(element.name, part) for element in drivetrain.definition.active for part in element.whole_parts(value)]
    nodes = tuple(sorted({node for _, part in parts for node in part.row}))
    n = len(nodes)

    def dense(row):
        vector = np.zeros(n)
        for node, weight in row.items():
            vector[nodes.index(node)] += float(weight)
        return vector

    M, C, K = np.zeros((3, n, n))  # views, which the laws add to
    held, laws = [], []
    for owner, part in parts:
        row = dense(part.row)
        if isinstance(part, Constraint):
            held.append(row)
        elif isinstance(part, MotionLaw):
            laws.append((owner, part, row))
        elif isinstance(part, Law) and part.table is None and not part.loss_factor:
            for matrix, factor in ((M, part.inertia), (C, part.damping), (K, part.stiffness)):
                matrix[:] += float(factor) * np.outer(row, row)
        else:
            raise TypeError(f"{owner} has a part that this reference does not know")
    return nodes, M, C, K, np.array(held).reshape(-1, n), laws


class _Plant:
    """Coordinates x = E q with q = Y a + Z s: moving coordinates a, and massless sliders s of friction behind springs.

    State y = (a, a', s, works of the laws).
    """

    def __init__(self, drivetrain, torques):
        self.nodes, M, C, K, held, laws = dense_parts(drivetrain)
        E = scipy.linalg.null_space(held) if len(held) else np.eye(len(self.nodes))
        M, C, K = (E.T @ one @ E for one in (M, C, K))
        inertias, shapes = scipy.linalg.eigh(M)
        massless = inertias <= 1e-12 * inertias.max()
        Z, Y = shapes[:, massless], shapes[:, ~massless]
        self.laws = [_Law(owner, law, E.T @ row) for owner, law, row in laws]
        sliding = [law for law in self.laws if np.abs(Z.T @ law.row).max(initial=0) > 1e-9]
        if len(sliding) != Z.shape[1]:
            raise TypeError("every massless coordinate of this reference carries one friction")
        if sliding:
            Z = Z @ np.linalg.inv(np.array([law.row @ Z for law in sliding]))  # gamma of the law = s + b Y a
            Kzz = Z.T @ K @ Z
            assert np.abs(Kzz - np.diag(np.diag(Kzz))).max() < 1e-9 * np.abs(Kzz).max()
            assert np.abs(Z.T @ C).max() < 1e-9 * max(np.abs(C).max(), 1e-300) or not C.any()
        for place, law in enumerate(sliding):
            law.slider = place
        self.E, self.Y, self.Z = E, Y, Z
        self.M, self.C, self.K, self.Kz = Y.T @ M @ Y, Y.T @ C @ Y, Y.T @ K @ Y, Y.T @ K @ Z
        self.Kzz = np.diag(Z.T @ K @ Z) if sliding else np.zeros(0)
        self.inverse = np.linalg.inv(self.M)
        self.n, self.n_s = Y.shape[1], Z.shape[1]
        for law in self.laws:
            law.b = Y.T @ law.row
        weights = [(Y.T @ E.T @ np.eye(len(self.nodes))[self.nodes.index(node)], f) for node, f in torques.items()]
        self.force = lambda t: sum((w * f(t) for w, f in weights), np.zeros(self.n))
        stiff = self.K + sum(
            max((law.scale * float(getattr(p, "stiffness", 0)) for p in law.pieces), default=0) * np.outer(law.b, law.b)
            for law in self.laws
        )
        fastest = np.sqrt(max(scipy.linalg.eigh(stiff, self.M, eigvals_only=True).max(), 1e-6))
        self.longest = 1 / (STEPS_A_RADIAN * fastest)

    def split(self, y):
        n = self.n
        return y[:n], y[n : 2 * n], y[2 * n : 2 * n + self.n_s]

    def state_of(self, law, y):
        a, v, s = self.split(y)
        if law.slider is None:
            return law.b @ a, law.b @ v
        return s[law.slider] + law.b @ a, self.slides(law, v) + law.b @ v

    def slides(self, law, v):
        if law.holds:
            return -(law.b @ v)
        return -(self.Kz[:, law.slider] @ v) / self.Kzz[law.slider]

    def slider_torque(self, law, y):
        a, _, s = self.split(y)
        return -(self.Kzz[law.slider] * s[law.slider] + self.Kz[:, law.slider] @ a)

    def accelerations(self, t, y):
        """Accelerations of a, and the torques of laws that hold, by law."""
        a, v, s = self.split(y)
        free = self.force(t) - self.C @ v - self.K @ a - self.Kz @ s
        stuck = []
        for law in self.laws:
            if law.slider is not None:
                free -= law.b * self.slider_torque(law, y)
            elif law.holds:
                stuck.append(law)
            else:
                free -= law.b * law.torque(law.b @ a, law.b @ v)
        free_motion = self.inverse @ free
        if not stuck:
            return free_motion, {}
        B = np.array([law.b for law in stuck]).T
        across = self.inverse @ B
        torques = np.linalg.solve(B.T @ across, B.T @ free_motion)
        return free_motion - across @ torques, dict(zip(map(id, stuck), torques, strict=True))

    def rates(self, t, y, yp):
        n = self.n
        a, v, _ = self.split(y)
        acceleration, held = self.accelerations(t, y)
        yp[:n], yp[n : 2 * n] = v, acceleration
        for place, law in enumerate(self.laws):
            if law.slider is not None:
                yp[2 * n + law.slider] = self.slides(law, v)
                _, rate = self.state_of(law, y)
                torque = self.slider_torque(law, y)
            else:
                rate = law.b @ v
                torque = held[id(law)] if id(law) in held else law.torque(law.b @ a, rate)
            yp[2 * n + self.n_s + place] = torque * rate

    def guards(self):
        """Functions of (t, y, held torques), their direction, the law and what happens at their zero."""
        guards = []
        for law in self.laws:
            if law.holds:
                low, high = law.scale * float(law.now.low), law.scale * float(law.now.high)
                guards += [(self._held(law, high), 1, law, "above"), (self._held(law, low), -1, law, "below")]
                continue
            at = self._twist if law.over == "twist" else self._rate
            if law.now.upper is not None:
                guards.append((at(law, float(law.now.upper)), 1, law, "above"))
            if law.now.lower is not None:
                guards.append((at(law, float(law.now.lower)), -1, law, "below"))
            if law.over == "twist":
                guards.append((self._rate(law, 0.0), 0, law, "turn"))
                if law.now.side and law.now.damping:
                    way = -1 if law.pushes else 1
                    guards.append((self._pushing(law), way, law, "part" if law.pushes else "push"))
        return guards

    def _held(self, law, limit):
        if law.slider is not None:
            return lambda _, y, __: self.slider_torque(law, y) - limit
        return lambda _, __, held: held[id(law)] - limit

    def _twist(self, law, bound):
        return lambda _, y, __: self.state_of(law, y)[0] - bound

    def _rate(self, law, bound):
        return lambda _, y, __: self.state_of(law, y)[1] - bound

    def _pushing(self, law):
        return lambda _, y, __: law.now.side * law.full(*self.state_of(law, y))

    def begin(self, t, y):
        """Choose the pieces in which a motion starts."""
        for law in self.laws:
            law.pushes = PUSH
            twist, rate = law.b @ self.split(y)[0], law.b @ self.split(y)[1]
            if law.slider is not None:
                twist, rate = twist + self.split(y)[2][law.slider], 0.0
            law.enter(law.curve.number_at(twist, rate), twist, rate)
            if law.over == "twist" and law.holds and rate:
                law.enter(law.piece + (1 if rate > 0 else -1), twist, rate)
            elif law.over == "twist" and not law.holds and rate < 0 and twist == law.now.lower:
                law.enter(law.piece - 1, twist, rate)
        return self.settle(t, y)

    def pass_on(self, law, what, y):
        """Carry a law over an event."""
        twist, rate = self.state_of(law, y)
        if what in ("push", "part"):
            law.pushes = PUSH if what == "push" else FREE
        elif what in ("above", "below"):
            step = 1 if what == "above" else -1
            was_held = law.holds
            law.enter(law.piece + step, twist, rate)
            if law.over == "twist" and law.holds and not was_held:
                law.enter(law.piece + step, twist, rate)  # a step of the torque does not stop what moves

    def settle(self, t, y):
        """Let laws slip whose torque to stick is beyond their range, and stop the rates of those that stick."""
        y = y.copy()
        n = self.n
        for law in self.laws:
            if law.slider is not None:
                y = self._settle_slider(law, y)
        for _ in range(4 * len(self.laws) + 1):
            stuck = [law for law in self.laws if law.holds and law.slider is None]
            if not stuck:
                return y
            _, held = self.accelerations(t, y)
            excess = []
            for law in stuck:
                low, high, torque = law.scale * float(law.now.low), law.scale * float(law.now.high), held[id(law)]
                slack = 1e-11 * (high - low)
                excess.append(max(torque - high - slack, low - torque - slack, 0.0) * (1 if torque > high else -1))
            worst = int(np.argmax(np.abs(excess)))
            if excess[worst] == 0:
                B = np.array([law.b for law in stuck]).T
                across = self.inverse @ B
                y[n : 2 * n] -= across @ np.linalg.solve(B.T @ across, B.T @ y[n : 2 * n])
                return y
            stuck[worst].enter(stuck[worst].piece + (1 if excess[worst] > 0 else -1), 0.0, 0.0)
        raise RuntimeError("no consistent set of sticking laws")

    def _settle_slider(self, law, y):
        """Slider that slides, or has slid before the start, carries exactly the torque of its friction."""
        place = 2 * self.n + law.slider
        a = y[: self.n]
        if law.holds:
            carried, low, high = self.slider_torque(law, y), law.scale * law.now.low, law.scale * law.now.high
            if low - 1e-11 * (high - low) <= carried <= high + 1e-11 * (high - low):
                return y
            torque = law.scale * float(law.pieces[law.piece + (1 if carried > high else -1)].torque)
        else:
            torque = law.scale * float(law.now.torque)
        y[place] = -(torque + self.Kz[:, law.slider] @ a) / self.Kzz[law.slider]
        return y


def _stretch(plant, t, y, stops):
    """States (t, y) at stops up to the next root, time and state there or at the last stop, and what happens there."""
    guards = plant.guards()

    def events(t, y, out):
        held = plant.accelerations(t, y)[1]
        for place, (guard, *_) in enumerate(guards):
            out[place] = guard(t, y, held)

    options = {}
    if guards:
        events.terminal, events.direction = [True] * len(guards), [way for _, way, _, _ in guards]
        options = {"eventsfn": events, "num_events": len(guards)}
    solver = sundials.CVODE(plant.rates, method="Adams", rtol=RELATIVE, atol=ABSOLUTE, max_step=plant.longest,
                   max_num_steps=10_000_000, **options)  # fmt: skip
    # two times would ask for every step
    whole = [t, *stops] if len(stops) > 1 else [t, (t + stops[0]) / 2, stops[0]]
    solved = solver.solve(whole, y)
    if solved.status < 0:
        raise RuntimeError(solved.message)
    wanted = set(stops)
    reached = [(one, np.array(state)) for one, state in zip(solved.t.tolist(), solved.y, strict=True) if one in wanted]
    if guards and solved.i_events is not None and len(solved.i_events):
        fired = [guards[place][2:] for place in np.flatnonzero(solved.i_events[-1])]
        at = float(solved.t_events[-1])
        return [one for one in reached if one[0] < at], at, np.array(solved.y_events[-1]), fired
    return reached, *reached[-1], []


def _beyond(plant, y):
    """Whether a twist lies outside its piece: an event was missed."""
    for law in plant.laws:
        if law.over == "twist" and not law.holds:
            twist = plant.state_of(law, y)[0]
            for bound, way in ((law.now.upper, 1), (law.now.lower, -1)):
                if bound is not None and way * (twist - float(bound)) > 1e-13 * abs(float(bound)):
                    return True
    return False


def reference_motion(
    drivetrain,
    torques: Mapping[str, Callable[[float], float]],
    times: Sequence[float],
    *,
    angles: Mapping[str, float] = {},
    speeds: Mapping[str, float] = {},
    breaks: Sequence[float] = (),
) -> ReferenceMotion:
    """Motion of a drivetrain at times in s under torques in N m over time at nodes, from angles and speeds of nodes.

    At ``breaks`` the torques have corners.
    """
    plant = _Plant(drivetrain, torques)
    n = plant.n
    shape = plant.E @ plant.Y
    y = np.zeros(2 * n + plant.n_s + len(plant.laws))
    for part, given in ((slice(0, n), angles), (slice(n, 2 * n), speeds)):
        x = np.array([given.get(node, 0.0) for node in plant.nodes])
        y[part] = np.linalg.lstsq(shape, x, rcond=None)[0]
        assert np.allclose(shape @ y[part], x, atol=1e-12) or plant.n_s, "constraints tie these nodes"
    t = float(times[0])
    y = plant.begin(t, y)
    states_at, seen = {t: y}, []
    corners = sorted(one for one in map(float, breaks) if times[0] < one < times[-1])
    stops = sorted({*map(float, times[1:]), *corners})
    for end in (*corners, float(times[-1])):
        while t < end:
            ahead = [one for one in stops if t < one <= end]
            before = (t, y)
            reached, t, y, fired = _stretch(plant, t, y, ahead)
            if _beyond(plant, y) and all(what == "turn" for _, what in fired):
                ahead = [one for one in ahead if one < t]
                reached, t, y, fired = _stretch(plant, *before, [*ahead, t])
                if not fired:
                    raise RuntimeError(f"an event near {t} s was not found again")
            states_at.update(reached)
            for law, what in fired:
                if what != "turn":
                    seen.append((t, law.owner, what))
                    plant.pass_on(law, what, y)
            if fired:
                y = plant.settle(t, y)
    rows = [states_at[float(one)] for one in times]
    states = np.array(rows)
    a, v, s = states[:, :n], states[:, n : 2 * n], states[:, 2 * n : 2 * n + plant.n_s]
    slid = np.array([[plant.slides(law, one) for law in plant.laws if law.slider is not None] for one in v])
    x, w = a @ plant.Y.T + s @ plant.Z.T, v @ plant.Y.T + slid.reshape(len(v), plant.n_s) @ plant.Z.T
    owners = [law.owner for law in plant.laws]
    return ReferenceMotion(plant.nodes, np.array(times, dtype=float), x @ plant.E.T, w @ plant.E.T,
                           states[:, 2 * n + plant.n_s :], seen, owners)  # fmt: skip
