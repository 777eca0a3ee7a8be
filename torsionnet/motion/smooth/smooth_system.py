"""Motion over time of a drivetrain with laws that do not follow straight pieces, by Runge-Kutta methods between events.

Laws of straight pieces beside them keep their contact states: in each the motion is linear but for the smooth laws,
whose torques are worked out at every time. Events are located on the dense output of the method.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Any

import numpy as np

from torsionnet.base.errors import SolveError, TorsionnetError
from torsionnet.linear.assembly.law_stiffness import Functional
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.model.channels import Input
from torsionnet.motion.contact_states import Contact
from torsionnet.motion.driving import Driving, Stretch
from torsionnet.motion.event_losses import losing_law
from torsionnet.motion.march_tables import in_steps
from torsionnet.motion.motion_over_time import MotionOverTime
from torsionnet.motion.smooth.guard_roots import first_event, nodes
from torsionnet.motion.smooth.smooth_contact import SmoothContact
from torsionnet.motion.smooth.smooth_method import RELATIVE, SmoothMethod
from torsionnet.motion.smooth.smooth_plant import SmoothPlant
from torsionnet.motion.smooth_laws import SplitPlant
from torsionnet.motion.start_state import relative_state
from torsionnet.signals.energy_balance import EnergyBalance
from torsionnet.signals.motion_event import MotionEvent

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
        z[own], z[at.one] = z0[own], 1.0
        z[at.u][plant.outside] = driving.first
        now = plant.contact(contact or plant.first_contact(z))
        self.method.entered(now)
        z = relative_state(plant.split.plant, at, z)
        lags = plant.settled(now, now.form.form.refresh @ z) if settled else np.zeros(len(plant.lagging))
        y = plant.states_of(now, z, lags)
        last = None
        begun = energy = plant.stored_energy(now, plant.whole(now, 0.0, y, None))
        for stretch in driving.stretches():
            self.works[""] += plant.stored_energy(now, plant.whole(now, stretch.start, y, stretch)) - energy
            now, y = self._through(stretch, now, y)
            energy, last = plant.stored_energy(now, plant.whole(now, stretch.end, y, stretch)), stretch
        z = plant.whole(now, driving.duration, y, last)
        self.values[:, self.sample :] = (now.reads @ z)[:, None]
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
                raise SolveError(f"after {time:.6g} s {BEYOND}") from error
            except (ArithmeticError, ValueError) as error:
                if isinstance(error, TorsionnetError):
                    raise
                raise SolveError(f"at {time:.6g} s the torques of the laws have no value: {error}") from error
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
                raise SolveError(f"at {solver.t:.6g} s {text}; look at the torque and the motion of {owner} there")
            course, end = solver.dense_output(), solver.t
            places, weights, _ = nodes()
            Z = plant.whole_states(now, course, start + places * (end - start), stretch)
            if not np.isfinite(Z).all():
                raise SolveError(f"after {start:.6g} s {BEYOND}")
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
                self._read(now, course, end, stretch)
                if self.method.passed(now, stretch, start, solver):
                    return end, now, solver.y
                continue
            at = float(start + place * (end - start))
            if at > start:
                Z = plant.whole_states(now, course, start + places * (at - start), stretch)
                self._count(now, Z, weights * (at - start))
                self._read(now, course, at, stretch)
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
                f"{text}, without an end to be seen; give the contact or the friction a stiffness or a damping"
            )
        plant.states.h = BOUNCE_STEP / turning
        contact, _ = plant.states.after(now.contact, guard, z / in_steps(plant.at, plant.states.h), time)
        self.events += [MotionEvent(time, *change) for change in plant.states.changes(now.contact, contact)]
        following = plant.contact(contact)
        self.method.entered(following)
        after = plant.states_of(following, z, plant.lags_in(y))
        loser = losing_law(plant.states.laws, now.contact, contact)
        if loser:
            left = plant.stored_energy(following, plant.whole(following, time, after, stretch))
            self.works[loser] = self.works.get(loser, 0.0) + plant.stored_energy(now, z) - left
        return following, after

    def _read(self, now: SmoothContact, course: Any, end: float, stretch: Stretch) -> None:
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
            raise SolveError(f"{owner}: between {start:.6g} s and {end:.6g} s {message}")
