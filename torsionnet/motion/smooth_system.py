"""Motion over time of a drivetrain with laws that do not follow straight pieces, by Runge-Kutta methods between events.

Laws of straight pieces beside them keep their contact states: in each the motion is linear but for the smooth laws,
whose torques are worked out at every time. Events are located on the dense output of the method.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import scipy
from numpy.polynomial import chebyshev

from torsionnet.base.errors import SolveError, TorsionnetError
from torsionnet.linear.assembly.law_stiffness import Functional
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.model.channels import Input
from torsionnet.motion.contact_states import Contact, relative_state
from torsionnet.motion.driving import Driving, Stretch
from torsionnet.motion.march_tables import in_steps
from torsionnet.motion.motion_record import MotionOverTime
from torsionnet.motion.motion_works import losing_law, remembered_energies
from torsionnet.motion.smooth_laws import SplitPlant
from torsionnet.motion.smooth_plant import SmoothContact, SmoothPlant
from torsionnet.signals.recording import EnergyBalance, MotionEvent

# First event within a step of a Runge-Kutta method: where a guard falls below zero, also between two points.

NODES = 13
"""Number of Chebyshev points in a step, on which a polynomial of degree 12 is exact: dense output has degree 7."""
GUARD_ROUNDING = 1e-12
"""Share of the sizes of its terms up to which a guard counts as zero."""
ASTRAY = 1e3
"""Roundings by which a guard that has just come into force may lie below zero if it then rises, as a rate that has just
changed its sign."""


@lru_cache(maxsize=1)
def nodes() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Places (NODES,) from 0 to 1, weights of Clenshaw and Curtis over them, and the matrix to Chebyshev coefficients.

    >>> places, weights, _ = nodes()
    >>> round(float(weights @ places**9), 15)
    0.1
    """
    x = -np.cos(np.pi * np.arange(NODES) / (NODES - 1))
    matrix = np.linalg.inv(chebyshev.chebvander(x, NODES - 1))
    # Integral of the Chebyshev polynomial T_k from -1 to 1: 2 / (1 - k^2) for even k, else 0.
    integrals = np.array([2 / (1 - k**2) if k % 2 == 0 else 0.0 for k in range(NODES)])
    return (x + 1) / 2, np.asarray(integrals @ matrix / 2), np.asarray(matrix)


def first_event(values: FloatArray, sizes: FloatArray, guard_at: Callable[[int, float], float]) -> tuple[float, int]:
    """Place from 0 to 1 in a step of the first event, and the number of its guard; (-1, -1) without one.

    Parameters
    ----------
    values : (n_g, NODES) array
        Guards at the nodes.
    sizes : (n_g,) array
        Sizes of the terms of each guard.
    guard_at : callable
        Value of a guard at a place in the step.
    """
    first, which = -1.0, -1
    # Between two nodes a guard is taken to dip by no more than it changes from node to node.
    swing = np.abs(np.diff(values, axis=1)).max(axis=1)
    for guard in np.flatnonzero(values.min(axis=1) <= swing + GUARD_ROUNDING * sizes).tolist():
        place = _first_root(values[guard], GUARD_ROUNDING * float(sizes[guard]), guard, guard_at)
        if place >= 0 and (which < 0 or place < first):
            first, which = place, guard
    return first, which


def _first_root(values: FloatArray, rounding: float, guard: int, guard_at: Callable[[int, float], float]) -> float:
    if values[0] < -rounding and not (values[0] >= -ASTRAY * rounding and values[1] > 0):
        return 0.0
    series = nodes()[2] @ values
    # Between its turning points the series is monotone, so that signs there tell each fall.
    turning = chebyshev.chebroots(chebyshev.chebder(series)) if np.abs(series[2:]).max() > 0 else np.zeros(0)
    real = (root.real for root in np.atleast_1d(turning) if abs(root.imag) < 1e-6)
    inside = sorted(float(place + 1) / 2 for place in real if -1 < place < 1)
    last, positive = 0.0, values[0] > rounding
    for place in (*inside, 1.0):
        value = float(values[-1]) if place == 1.0 else float(chebyshev.chebval(2 * place - 1, series))
        if value < -rounding:
            if not positive:
                return last
            return _refined(guard, last, place, guard_at)
        if value > rounding:
            last, positive = place, True
    return -1.0


def _refined(guard: int, above: float, below: float, guard_at: Callable[[int, float], float]) -> float:
    """Place between one where a guard is positive and one where it is not."""
    if guard_at(guard, above) <= 0:
        return above
    if guard_at(guard, below) > 0:
        return below
    return float(scipy.optimize.brentq(lambda place: guard_at(guard, place), above, below, xtol=1e-16, rtol=1e-15))


# Runge-Kutta method for a smooth motion: explicit, or implicit where the motion is stiff.

RELATIVE, ABSOLUTE = 1e-11, 1e-13
"""Tolerances of the Runge-Kutta method in a step, relative and in rad and rad/s: its twists are differences of angles
that grow, of which the eleventh digit still counts."""
STIFF = 300.0
"""Ratio of the quickest decay to the fastest vibration from which an implicit method is cheaper. The explicit one takes
a step per 6 time constants of the decay, the implicit one about 50 in a radian at these tolerances."""
STEPS_BETWEEN_LOOKS = 200
"""Steps after which the poles of the motion are looked at again, which cost as much as two or three."""
ROUNDING = 2.3e-14
"""Least relative tolerance that the methods take."""


class SmoothMethod:
    """Choice of the method for each part of a motion, by the poles of the motion where it has got to.

    ``turning`` is the largest circular frequency in rad/s seen so far.
    """

    def __init__(self, plant: SmoothPlant, refinement: int) -> None:
        self.plant = plant
        tighter = float(refinement) ** 5
        self.tolerances = {"rtol": max(RELATIVE / tighter, ROUNDING), "atol": ABSOLUTE / tighter}
        self.turning = 1 / max(plant.driving.duration, 1e-300)
        self.stiff = False
        self._stiff_in: dict[Contact, bool] = {}
        self.steps, self.looked = 0, -STEPS_BETWEEN_LOOKS
        self.size: float | None = None

    def entered(self, now: SmoothContact) -> None:
        """Take the method of a contact state that is known, and look at the motion in a new one."""
        self.turning = max(self.turning, now.turning)
        if now.contact in self._stiff_in:
            self.stiff = self._stiff_in[now.contact]
        else:
            self.looked = self.steps - STEPS_BETWEEN_LOOKS

    def solver(self, now: SmoothContact, stretch: Stretch, time: float, y: FloatArray) -> Any:
        """Solver from a time in s and states y to the end of a stretch."""
        from scipy.integrate import DOP853, Radau

        right = self.plant.right_side(now, stretch)
        if self.steps - self.looked >= STEPS_BETWEEN_LOOKS:
            self._look(now, right, time, y)
        first = None if self.size is None else min(self.size, stretch.end - time)
        method = Radau if self.stiff else DOP853
        return method(right, time, y, stretch.end, first_step=first, **self.tolerances)

    def passed(self, now: SmoothContact, stretch: Stretch, start: float, solver: Any) -> bool:
        """Whether the method changes after a step that began at a time in s."""
        self.steps += 1
        self.size = max(solver.t - start, 1e-12 * solver.t)
        if self.steps - self.looked < STEPS_BETWEEN_LOOKS or solver.status != "running":
            return False
        before = self.stiff
        self._look(now, self.plant.right_side(now, stretch), solver.t, solver.y)
        return before != self.stiff

    def _look(self, now: SmoothContact, right: Any, time: float, y: FloatArray) -> None:
        self.looked = self.steps
        slopes = slopes_of(right, time, y)
        poles = np.linalg.eigvals(slopes) if len(y) and np.isfinite(slopes).all() else np.zeros(0)
        self.turning = max(self.turning, float(np.abs(poles.imag).max(initial=0.0)))
        self.stiff = float(np.abs(poles.real).max(initial=0.0)) > STIFF * self.turning
        self._stiff_in[now.contact] = self.stiff


def slopes_of(right: Any, time: float, y: FloatArray) -> FloatArray:
    """Slopes (n, n) of rates of change over states y (n,), by differences.

    >>> slopes_of(lambda t, y: np.array([y[1], -4 * y[0]]), 0.0, np.array([1.0, 0.0])).round(6) + 0.0
    array([[ 0.,  1.],
           [-4.,  0.]])
    """
    base = right(time, y)
    slopes = np.zeros((len(y), len(y)))
    # The root of eps in each state balances rounding against curvature.
    step = np.sqrt(np.finfo(float).eps) * np.maximum(np.abs(y), 1e-3 * np.abs(y).max(initial=0.0) + 1e-9)
    for number, size in enumerate(step.tolist()):
        moved = y.copy()
        moved[number] += size
        slopes[:, number] = (right(time, moved) - base) / size
    return slopes


STORM_WINDOW, MOST_EVENTS = 64.0, 2_000
"""Angle in rad that the fastest vibration turns in a window, and most events in it: as in :mod:`.piece_system`."""
MOST_STEPS, STEPS_BETWEEN_REPORTS = 2_000_000, 20_000
"""Most steps of the Runge-Kutta method, some ten minutes of work, and steps after which those to come are estimated."""
BOUNCE_STEP = 0.1
"""Angle in rad of the fastest vibration in the step that says how short a flight may be, see :mod:`.contact_states`."""

BEYOND = "the motion grows beyond all numbers; something drives it, as a controller or a spring that softens"

__all__ = ["BEYOND", "RELATIVE", "simulate_smooth"]


def simulate_smooth(
    split: SplitPlant,
    readings: Sequence[Functional],
    inputs: Sequence[Input],
    driving: Driving,
    z0: FloatArray,
    contact: Contact | None = None,
    refinement: int = 1,
    *,
    settled: bool = True,
) -> MotionOverTime:
    """Motion of a plant with smooth laws from a state z0 = (q, q', controllers, 1, ...) in SI units.

    Parameters
    ----------
    split : SplitPlant
    readings : sequence of Functional
        Of the drivetrain of the plant.
    inputs : sequence of Input
        Where the torques act.
    driving : Driving
        Torques in N m of the inputs, then the scales of ``split``.
    z0 : array
        Its first 2 n_q + n_c entries count.
    contact : tuple of int, optional
        Contact state at the start; default: that of the motion.
    refinement : int
        The tolerances are as many times smaller, to the fifth power, to see how much that changes.
    settled : bool
        Whether the torques of laws that lag stand on their curves at the start; else they are zero.

    Raises
    ------
    UsageError
        Parts that stick in a loop, or smooth laws where nothing has inertia.
    SolveError
        Too many events or steps, or a motion that leaves a curve.
    """
    plant = SmoothPlant(split, readings, inputs, driving)
    return _SmoothMotion(plant, SmoothMethod(plant, refinement)).whole(z0, contact, settled=settled)


class _SmoothMotion:
    """Smooth motion under way: what has been read, events, and works in J by element."""

    def __init__(self, plant: SmoothPlant, method: SmoothMethod) -> None:
        self.plant, self.method, self.driving = plant, method, plant.driving
        self.events: list[MotionEvent] = []
        self.works: dict[str, float] = {"": 0.0}
        self.recent: deque[float] = deque(maxlen=MOST_EVENTS)
        self.values = np.zeros((len(plant.readings), plant.driving.n))
        self.sample, self.steps = 0, 0
        self.looked = 0.0

    def whole(self, z0: FloatArray, contact: Contact | None, *, settled: bool) -> MotionOverTime:
        """Motion from a state z0 to the last sample."""
        plant, driving, at = self.plant, self.driving, self.plant.at
        z = np.zeros(at.size)
        own = slice(0, 2 * at.n_q + at.n_c)
        z[own], z[at.constant] = z0[own], 1.0
        z[at.u][plant.outside] = driving.first
        now = plant.contact(contact or plant.first_contact(z))
        self.method.entered(now)
        z = relative_state(plant.split.plant, at, z)
        lags = plant.settled(now, now.form.form.refresh @ z) if settled else np.zeros(len(plant.lagging))
        y = plant.states_of(now, z, lags)
        last = None
        first = plant.whole(now, 0.0, y, None)
        begun = energy = plant.stored_energy(now, first)
        kept = remembered_energies(plant.states, now.contact, first)
        for stretch in driving.stretches():
            # A torque that jumps at a break moves at once what has no inertia, and supplies that energy.
            self.works[""] += plant.stored_energy(now, plant.whole(now, stretch.start, y, stretch)) - energy
            now, y = self._through(stretch, now, y)
            energy, last = plant.stored_energy(now, plant.whole(now, stretch.end, y, stretch)), stretch
        z = plant.whole(now, driving.duration, y, last)
        self.values[:, self.sample :] = (now.reads @ z)[:, None]
        for owner, value in remembered_energies(plant.states, now.contact, z).items():
            self.works[owner] = self.works.get(owner, 0.0) + kept[owner] - value
        supplied = self.works.pop("")
        return MotionOverTime(self.values, tuple(self.events), EnergyBalance(supplied, energy - begun, self.works))

    def _through(self, stretch: Stretch, now: SmoothContact, y: FloatArray) -> tuple[SmoothContact, FloatArray]:
        """Contact state and states y at the end of a stretch."""
        time = stretch.start
        while time < stretch.end:
            try:
                solver = self.method.solver(now, stretch, time, y)
                time, now, y = self._until_event(solver, stretch, now)
            except OverflowError as error:
                raise SolveError(f"after {time:.6g} s {BEYOND}", kind="no-solution") from error
            except (ArithmeticError, ValueError) as error:
                if isinstance(error, TorsionnetError):
                    raise
                raise SolveError(
                    f"at {time:.6g} s the torques of the laws have no value: {error}", kind="no-solution"
                ) from error
        return now, y

    def _until_event(
        self, solver: Any, stretch: Stretch, now: SmoothContact
    ) -> tuple[float, SmoothContact, FloatArray]:
        plant = self.plant
        while solver.status == "running":
            start = solver.t
            self.steps += 1
            message = solver.step()
            if solver.status == "failed" or self._is_too_long(solver.t):
                text = "the motion cannot be followed" if message else "the motion needs too many steps"
                owner = plant.quickest(now, plant.whole(now, solver.t, solver.y, stretch))
                raise SolveError(
                    f"at {solver.t:.6g} s {text}; look at the torque and the motion of {owner} there",
                    kind="no-solution",
                )
            # Guards at Chebyshev points of the step, through which an event inside it shows as a root.
            course, end = solver.dense_output(), solver.t
            places, weights, _ = nodes()
            Z = plant.whole_states(now, course, start + places * (end - start), stretch)
            if not np.isfinite(Z).all():
                raise SolveError(f"after {start:.6g} s {BEYOND}", kind="no-solution")
            self._require_range(now, Z, start, end)
            guards = now.guards @ Z
            sizes = (np.abs(now.guards) @ np.abs(Z)).max(axis=1)

            def guard_at(guard: int, place: float, *, first: float = start, size: float = end - start,
                         course: Any = course) -> float:  # fmt: skip
                time = first + place * size
                return float(now.guards[guard] @ plant.whole(now, time, course(time), stretch))

            place, which = first_event(guards, sizes, guard_at) if len(plant.states.laws) else (-1.0, -1)
            if which < 0:
                self._count(now, Z, weights * (end - start))
                self._read_samples(now, course, end, stretch)
                if self.method.passed(now, stretch, start, solver):
                    return end, now, solver.y
                continue
            at = float(start + place * (end - start))
            if at > start:
                Z = plant.whole_states(now, course, start + places * (at - start), stretch)
                self._count(now, Z, weights * (at - start))
                self._read_samples(now, course, at, stretch)
            return at, *self._event(now, which, course(at), at, stretch)
        return solver.t, now, solver.y

    def _is_too_long(self, time: float) -> bool:
        """Whether the rest of the motion needs too many steps if these stay as long as the last ones."""
        if self.steps % STEPS_BETWEEN_REPORTS:
            return False
        passed, self.looked = time - self.looked, time
        left = (self.driving.duration - time) * STEPS_BETWEEN_REPORTS
        return self.steps + left / max(passed, 1e-300) > MOST_STEPS

    def _event(
        self, now: SmoothContact, guard: int, y: FloatArray, time: float, stretch: Stretch
    ) -> tuple[SmoothContact, FloatArray]:
        plant, turning = self.plant, self.method.turning
        z = plant.whole(now, time, y, stretch)
        self.recent.append(time)
        window = STORM_WINDOW / turning
        if len(self.recent) == MOST_EVENTS and time - self.recent[0] < window:
            owner = plant.states.laws[guard // 3].owner
            rate = MOST_EVENTS / window
            text = f"{owner}: at {time:.6g} s its torque changes its piece more than {rate:.3g} times a second"
            raise SolveError(
                f"{text}, without an end to be seen; give the contact or the friction a stiffness or a damping",
                kind="no-solution",
            )
        # The fastest vibration says how short a flight may be.
        plant.states.h = BOUNCE_STEP / turning
        contact, _ = plant.states.state_after(now.contact, guard, z / in_steps(plant.at, plant.states.h), time)
        self.events += [MotionEvent(time, *change) for change in plant.states.changes(now.contact, contact)]
        following = plant.contact(contact)
        self.method.entered(following)
        after = plant.states_of(following, z, plant.lags_in(y))
        # What is lost at once, as by friction that catches, is the fall of the stored energy.
        loser = losing_law(plant.states.laws, now.contact, contact)
        if loser:
            left = plant.stored_energy(following, plant.whole(following, time, after, stretch))
            self.works[loser] = self.works.get(loser, 0.0) + plant.stored_energy(now, z) - left
        return following, after

    def _read_samples(self, now: SmoothContact, course: Any, end: float, stretch: Stretch) -> None:
        """Read samples before a time in s."""
        rate = self.driving.rate
        last = min(self.driving.n, int(np.ceil(end * rate - 1e-9)))
        if last <= self.sample:
            return
        times = np.arange(self.sample, last) / rate
        self.values[:, self.sample : last] = now.reads @ self.plant.whole_states(now, course, times, stretch)
        self.sample = last

    def _count(self, now: SmoothContact, Z: FloatArray, weights: FloatArray) -> None:
        for owner, value in now.powers.works(Z, weights):
            self.works[owner] = self.works.get(owner, 0.0) + value

    def _require_range(self, now: SmoothContact, Z: FloatArray, start: float, end: float) -> None:
        owner, message = self.plant.rows_left(now, Z[:, -1])
        if message:
            raise SolveError(f"{owner}: between {start:.6g} s and {end:.6g} s {message}", kind="no-solution")
