"""Random plants with two and three rigid frictions, and their motion by an integrator that shares nothing with the package.

Between events the motion is a matrix exponential. At an event all states of the frictions at rest are tried, and one is
taken in which every torque that sticks stays within its limits and every slip begins in its own direction.
"""

import itertools
from dataclasses import dataclass

import numpy as np
import scipy

import torsionnet as tn

LARGEST_TURN = 0.125
"""Angle in rad that the fastest vibration turns between two looks at the frictions."""
SMALL = 1e-9
"""Share of the sizes of its terms below which a value or a derivative counts as zero where one is chosen."""

ROUNDING = 1e-14
"""Share of the sizes of its terms by which a guard, or its rate, may dip below zero by rounding."""


@dataclass
class RubbingPlant:
    """Inertias (n,), springs (i, j, k, c), frictions (i, j, T, T_s), and loads (i, mean, rise, amplitude, omega, phase).

    Node -1 is ground; a load is mean + rise t + amplitude cos(omega t + phase), in SI units. ``speeds`` (n,) begin.
    """

    inertias: list[float]
    springs: list[tuple[int, int, float, float]]
    frictions: list[tuple[int, int, float, float]]
    loads: list[tuple[int, float, float, float, float, float]]
    speeds: list[float]

    def row(self, i, j):
        row = np.zeros(len(self.inertias))
        row[i] = 1.0
        if j >= 0:
            row[j] = -1.0
        return row

    def drivetrain(self, beside=()):
        """Drivetrain, in which frictions that hold so many times as much stand in series behind each friction."""

        def nodes(i, j):
            return (f"n{i}", f"n{j}" if j >= 0 else "ground")

        elements = [tn.Inertia(f"J{i}", node=f"n{i}", inertia=J) for i, J in enumerate(self.inertias)]
        for number, (i, j, k, c) in enumerate(self.springs):
            elements.append(tn.Spring(f"k{number}", nodes=nodes(i, j), stiffness=k, damping=c))
        for number, (i, j, T, stick) in enumerate(self.frictions):
            first, last = nodes(i, j)
            chain = [first, *(f"m{number}_{place}" for place in range(len(beside))), last]
            torques = [(T, stick), *((factor * stick, factor * stick) for factor in beside)]
            for place, (torque, holds) in enumerate(torques):
                pair = (chain[place], chain[place + 1])
                elements.append(tn.Friction(f"f{number}_{place}", nodes=pair, torque=torque, stick=holds))
        return tn.Drivetrain("rubbing", elements)


def rubbing_plant(seed, frictions):
    """Tree of 4 to 7 inertias, joined by springs and as many rigid frictions, some to ground, in numbers of two digits."""
    rng = np.random.default_rng([seed, frictions])

    def drawn(low, high):
        return float(f"{10 ** rng.uniform(np.log10(low), np.log10(high)):.2g}")

    n = int(rng.integers(4, 8))
    rubs = set(rng.permutation(np.arange(1, n))[: frictions - int(rng.random() < 0.3)].tolist())
    springs, pairs = [], []
    for node in range(1, n):
        other = int(rng.integers(max(node - 2, 0), node))
        if node in rubs:
            pairs.append((other, node))
        else:
            springs.append((other, node, drawn(1e3, 1e5), float(rng.choice([0.0, drawn(0.05, 20)]))))
    pairs += [(int(rng.integers(n)), -1)] * (frictions - len(pairs))
    torques = [drawn(5, 400) for _ in pairs]
    factors = rng.choice([1.0, 1.0, 1.25], len(pairs)).tolist()
    waving, pulled = rng.permutation(n)[:2].tolist()
    mean, rise = drawn(1, 100) * float(rng.choice([-1, 1])), drawn(100, 5000) * float(rng.choice([-1, 1]))
    wave = waving, mean, 0.0, drawn(20, 600), 2 * np.pi * drawn(2, 60), round(float(rng.uniform(0, 6)), 1)
    loads = [wave, (pulled, 0.0, rise, 0.0, 1.0, 0.0)]
    if rng.random() < 0.5:
        springs.append((n - 1, -1, drawn(100, 5000), drawn(0.05, 5)))
    speeds = np.round(rng.uniform(-5, 5, n), 1) * (rng.random(n) < 0.7)
    drawn_frictions = [(*pair, T, T * over) for pair, T, over in zip(pairs, torques, factors, strict=True)]
    return RubbingPlant([drawn(0.03, 2) for _ in range(n)], springs, drawn_frictions, loads, speeds.tolist())


class _Motion:
    """Matrices over y = (q, q', 1, t, cos and sin of each load) in a state -1, 0 or 1 of each friction."""

    def __init__(self, plant):
        n, n_w = len(plant.inertias), 2 + 2 * len(plant.loads)
        self.n, self.frictions = n, plant.frictions
        self.B = np.array([plant.row(i, j) for i, j, *_ in plant.frictions])
        self.M = np.diag(plant.inertias)
        F = np.zeros((n, 2 * n + n_w))
        for i, j, k, c in plant.springs:
            b = plant.row(i, j)
            F[:, :n] -= k * np.outer(b, b)
            F[:, n : 2 * n] -= c * np.outer(b, b)
        self.w = np.zeros((n_w, n_w))
        self.w[1, 0] = 1.0
        y = [*np.zeros(n), *plant.speeds, 1.0, 0.0]
        for number, (i, mean, rise, amplitude, omega, phase) in enumerate(plant.loads):
            place = 2 + 2 * number
            self.w[place : place + 2, place : place + 2] = [[0, -omega], [omega, 0]]
            F[i, 2 * n : 2 * n + 2] += mean, rise
            F[i, 2 * n + place] += amplitude
            y += [np.cos(phase), np.sin(phase)]
        self.F, self.start, self.known = F, np.array(y), {}
        fastest = np.sqrt(scipy.linalg.eigh(-F[:, :n], self.M, eigvals_only=True).max())
        self.step = LARGEST_TURN / max(fastest, *(abs(one[4]) for one in plant.loads))

    def of(self, state):
        """A, torques (n_f, N) and rates (n_f, N) of the frictions, and the exponential of a step."""
        if state not in self.known:
            n, F = self.n, self.F.copy()
            torques = np.zeros((len(state), F.shape[1]))
            for number, way in enumerate(state):
                torques[number, 2 * n] = way * self.frictions[number][2]
            F -= self.B.T @ torques
            stuck = [number for number, way in enumerate(state) if not way]
            free = np.linalg.solve(self.M, F)
            if stuck:
                B = self.B[stuck]
                torques[stuck] = np.linalg.solve(B @ np.linalg.solve(self.M, B.T), B @ free)
                free -= np.linalg.solve(self.M, B.T @ torques[stuck])
            A = np.zeros((F.shape[1], F.shape[1]))
            A[:n, n : 2 * n], A[n : 2 * n], A[2 * n :, 2 * n :] = np.eye(n), free, self.w
            rates = np.hstack([np.zeros_like(self.B), self.B, np.zeros((len(state), len(self.w)))])
            self.known[state] = A, torques, rates, scipy.linalg.expm(A * self.step)
        return self.known[state]

    def guards(self, state):
        """Rows (n_guards, N) that stay above zero, each with its friction."""
        _, torques, rates, _ = self.of(state)
        rows, owners = [], []
        one = np.eye(torques.shape[1])[2 * self.n]
        for number, way in enumerate(state):
            stick = self.frictions[number][3]
            rows += [way * rates[number]] if way else [stick * one - torques[number], stick * one + torques[number]]
            owners += [number] * (1 if way else 2)
        return np.array(rows), owners

    def stopped(self, y, state):
        """State y in which frictions that stick have no rate, and all momenta beyond them are kept."""
        B, n = self.B[[number for number, way in enumerate(state) if not way]], self.n
        y = y.copy()
        if len(B):
            across = np.linalg.solve(self.M, B.T)
            y[n : 2 * n] -= across @ np.linalg.solve(B @ across, B @ y[n : 2 * n])
        return y

    def after(self, state, y, time):
        """State y after a time."""
        A, _, _, whole = self.of(state)
        return (whole if time == self.step else scipy.linalg.expm(A * time)) @ y

    def settled(self, y, before, changing=-1):
        """State of the frictions from y on, with as few changes as fit, that of the one ``changing`` first of all.

        What sticks goes on as long as it fits: it may hold more torque than it has while it slips.
        """
        at_rest = {number for number, way in enumerate(before) if not way} | {changing}
        choices = [(0, 1, -1) if number in at_rest else (way,) for number, way in enumerate(before)]
        fitting = [state for state in itertools.product(*choices) if self._fits(self.stopped(y, state), state, at_rest)]
        assert fitting, "no state of the frictions fits"

        def changes(state):
            other = [a != b for a, b in zip(state, before, strict=True)]
            return changing >= 0 and not other[changing], sum(other)

        return min(fitting, key=changes)

    def _fits(self, y, state, at_rest):
        A = self.of(state)[0]
        rows, owners = self.guards(state)
        for row, owner in zip(rows, owners, strict=True):
            derivative = row @ A if state[owner] else row  # the rate of what begins to slip is zero
            vector, size = y, np.abs(y)
            while owner in at_rest:
                value, terms = derivative @ vector, np.abs(derivative) @ size
                if abs(value) > SMALL * terms:
                    if value < 0:
                        return False
                    break
                vector, size = A @ vector, np.abs(A) @ size
                if not np.any(np.abs(vector) > 0) or size.max() > 1e40:
                    break
        return True


def rubbing_motion(plant, times):
    """Angles (n_t, n) in rad at times in s, and the events (time, friction, state)."""
    motion = _Motion(plant)
    y, t, events = motion.start, 0.0, []
    moving = tuple(int(np.sign(one)) for one in motion.B @ y[motion.n : 2 * motion.n])
    state = motion.settled(y, moving)
    angles = [y[: motion.n]]
    for end in times[1:]:
        while t < end:
            step = min(motion.step, end - t)
            part, owner = _first_event(motion, state, y, step)
            y = motion.after(state, y, step if part is None else part)
            t = t + part if part is not None else end if step < motion.step else t + step
            if part is not None:
                after = motion.settled(y, state, owner)
                assert after[owner] != state[owner], "an event that changes nothing"
                events += [(t, number, way) for number, way in enumerate(after) if way != state[number]]
                state, y = after, motion.stopped(y, after)
        angles.append(y[: motion.n])
    return np.array(angles), events


def _first_event(motion, state, y, step):
    """Time of the first guard that falls below zero within a step, and its friction, or nothing."""
    A = motion.of(state)[0]
    after, sizes = motion.after(state, y, step), np.abs(y) + step * np.abs(A) @ np.abs(y)
    first, owner = None, None
    for row, number in zip(*motion.guards(state), strict=True):

        def at(time, row=row):
            return row @ motion.after(state, y, time)

        below, rounding = step, ROUNDING * np.abs(row) @ sizes
        if row @ after >= 0:
            # What begins to slip where its torque just suffices has neither speed nor acceleration.
            if row @ A @ y >= -ROUNDING * np.abs(row) @ np.abs(A) @ np.abs(y) or row @ A @ after <= 0:
                continue
            below = scipy.optimize.brentq(lambda time, row=row @ A: at(time, row), 0, step)
            if at(below) >= -rounding:
                continue
        above = 0.0
        if row @ y <= rounding:  # begins at zero: the root after it has risen
            above = next((time for time in np.linspace(0, below, 65)[1:] if at(time) > 0), 0.0)
        root = scipy.optimize.brentq(at, above, below, xtol=1e-300, rtol=1e-15) if at(above) > 0 else 0.0
        if first is None or root < first:
            first, owner = root, number
    return first, owner
