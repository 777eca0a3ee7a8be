"""Motion over time of a drivetrain with laws that do not follow straight pieces, by Runge-Kutta methods between events.

Laws of straight pieces beside them keep their contact states: in each the motion is linear but for the smooth laws,
whose torques are worked out at every time. Events are located on the dense output of the method.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from torsionnet.assembly.functionals import Functional
from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import SolveError, TorsionnetError
from torsionnet.model.channels import Input
from torsionnet.response.motion.energy_balance import EnergyBalance
from torsionnet.response.motion.motion_event import MotionEvent
from torsionnet.solve.motion.contact_states import Contact, ContactStates
from torsionnet.solve.motion.driving import Driving, Stretch
from torsionnet.solve.motion.guard_roots import first_event, nodes
from torsionnet.solve.motion.march_tables import guard_rows, in_steps
from torsionnet.solve.motion.motion_over_time import MotionOverTime
from torsionnet.solve.motion.motion_plant import LawRow, PlacedLaw
from torsionnet.solve.motion.read_rows import reading_rows
from torsionnet.solve.motion.smooth_form import SmoothForm, smooth_form
from torsionnet.solve.motion.smooth_laws import SmoothLaw, SplitPlant
from torsionnet.solve.motion.start_state import relative_state
from torsionnet.solve.motion.state_layout import Drive, Layout

RELATIVE, ABSOLUTE = 1e-11, 1e-13
"""Tolerances of the Runge-Kutta method in a step, relative and in rad and rad/s: its twists are differences of angles
that grow, of which the eleventh digit still counts."""
STIFF = 300.0
"""Ratio of the quickest decay to the fastest vibration from which an implicit method is cheaper. The explicit one takes
a step per 6 time constants of the decay, the implicit one about 50 in a radian at these tolerances."""
STORM_WINDOW, MOST_EVENTS = 64.0, 2_000
"""Angle in rad that the fastest vibration turns in a window, and most events in it: as in :mod:`.piece_system`."""
MOST_STEPS = 2_000_000
"""Most steps of the Runge-Kutta method, some ten minutes of work."""
BOUNCE_STEP = 0.1
"""Angle in rad of the fastest vibration in the step that says how short a flight may be, see :mod:`.contact_states`."""


@dataclass(frozen=True, eq=False)
class _Contact:
    """Contact state with its equations, guards, and rows of readings and powers over z."""

    contact: Contact
    form: SmoothForm
    guards: FloatArray
    reads: FloatArray
    powers: tuple[FloatArray, FloatArray, FloatArray]
    owners: tuple[str, ...]
    needs_slopes: bool
    stiff: bool


def simulate_smooth(
    split: SplitPlant,
    readings: Sequence[Functional],
    inputs: Sequence[Input],
    driving: Driving,
    z0: FloatArray,
    contact: Contact | None = None,
    refinement: int = 1,
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

    Raises
    ------
    UsageError
        Parts that stick in a loop, or smooth laws where nothing has inertia.
    SolveError
        Too many events or steps, or a motion that leaves a curve.
    """
    return _SmoothMotion(split, readings, inputs, driving, refinement).whole(z0, contact)


class _SmoothMotion:
    """Smooth motion under way: time, contact state, states y, and what is read."""

    def __init__(
        self, split: SplitPlant, readings: Sequence[Functional], inputs: Sequence[Input], driving: Driving,
        refinement: int,
    ) -> None:  # fmt: skip
        plant = split.plant
        self.split, self.readings, self.inputs, self.driving = split, readings, inputs, driving
        columns = np.array([plant.assembly.rows_of(channel.row)[0] for channel in inputs]).reshape(len(inputs), -1).T
        n_q = len(columns)
        self.n_in, self.n_s = columns.shape[1], len(split.smooth)
        own = -np.array([one.row for one in split.smooth]).reshape(-1, n_q).T
        first_scale = self.n_in + self.n_s
        scale_of = tuple(-1 if one < 0 else first_scale + one for one in split.scale_of)
        n_scales = len(split.scales)
        n_u = first_scale + n_scales
        drive = Drive(np.hstack([columns, own]), scale_of, n_scales, np.zeros((0, 0)), np.zeros((n_u, 0)))
        self.at = Layout(n_q, sum(len(one.F) for one in plant.actions), 0, n_u)
        self.states = ContactStates(plant, split.phases, drive, self.at, relative=True)
        self.outside = np.array([*range(self.n_in), *range(first_scale, n_u)], dtype=int)
        self.places = list(range(self.n_in, first_scale))
        tighter = float(refinement) ** 5
        self.tolerances = {"rtol": max(RELATIVE / tighter, 2.3e-14), "atol": ABSOLUTE / tighter}
        self.known: dict[Contact, _Contact] = {}
        self.events: list[MotionEvent] = []
        self.works: dict[str, float] = {}
        self.recent: deque[float] = deque(maxlen=MOST_EVENTS)
        self.values = np.zeros((len(readings), driving.n))
        self.sample, self.steps = 0, 0
        self.step: float | None = None
        self.turning = 0.0

    def whole(self, z0: FloatArray, contact: Contact | None) -> MotionOverTime:
        """Motion from a state z0 to the last sample."""
        driving, at = self.driving, self.at
        z = np.zeros(at.size)
        own = slice(0, 2 * at.n_q + at.n_c)
        z[own], z[at.one] = z0[own], 1.0
        z[at.u][self.outside] = driving.first
        now = self._known(contact or self._at_start(z))
        y = now.form.take @ relative_state(self.split.plant, at, z)
        begun = self._energy(now, self._whole(now, 0.0, y, None))
        for stretch in driving.stretches():
            now, y = self._through(stretch, now, y)
        end = driving.duration
        last = driving.stretches()[-1] if driving.n > 1 else None
        z = self._whole(now, end, y, last)
        if self.sample < driving.n:
            self.values[:, self.sample :] = (now.reads @ z)[:, None]
        supplied = self.works.pop("", 0.0)
        balance = EnergyBalance(supplied, self._energy(now, z) - begun, self.works)
        return MotionOverTime(self.values, tuple(self.events), balance)

    def _at_start(self, z: FloatArray) -> Contact:
        rows = np.array([one.row for one in self.split.plant.laws]).reshape(-1, self.at.n_q)
        scales = np.array([1.0 if one < 0 else z[self.at.u][one] for one in self.states.drive.scale_of])
        return self.states.at_start(rows @ z[self.at.q], rows @ z[self.at.v], scales)

    def _known(self, contact: Contact) -> _Contact:
        if contact not in self.known:
            if len(self.known) >= 256:
                self.known.clear()
            self.known[contact] = self._made(contact)
        return self.known[contact]

    def _made(self, contact: Contact) -> _Contact:
        states, at, laws = self.states, self.at, self.split.smooth
        bare = states.form(contact)
        form = smooth_form(bare, at, laws, self.places)
        poles = np.linalg.eigvals(form.A)
        turning = max(float(np.abs(poles.imag).max(initial=0.0)), 1 / max(self.driving.duration, 1e-300))
        self.turning = max(self.turning, turning)
        guards = guard_rows(bare, states.laws, contact, at, states.drive.scale_of)
        torques = list(bare.torques)
        ones = np.eye(at.size)[at.u]
        for place, one in zip(self.places, laws, strict=True):
            if one.held >= 0:
                torques[one.held] = torques[one.held] + ones[place]
        mine = [one for one in laws if one.held < 0]
        extra = [ones[self.places[laws.index(one)]] for one in mine]
        plant = self.split.plant
        whole_plant = replace(plant, laws=(*plant.laws, *(LawRow(o.owner, o.law, o.number, o.row) for o in mine)))
        read_form = replace(bare, torques=np.array([*torques, *extra]).reshape(-1, at.size))
        reads = reading_rows(whole_plant, self.readings, self.inputs, read_form, at)
        firsts, seconds, factors, owners = self._powers(contact, form)
        own = np.vstack([reads, firsts, seconds]) @ form.over_s[:, self.places] if laws else np.zeros(1)
        direct = np.abs(reads[:, at.slope][:, self.places]).max(initial=0.0)
        needs = bool(max(np.abs(own).max(initial=0.0), direct) > 0)
        stiff = bool(np.abs(poles).max(initial=0.0) > STIFF * turning)
        return _Contact(contact, form, guards, reads, (firsts, seconds, factors), owners, needs, stiff)

    def _powers(self, contact: Contact, form: SmoothForm) -> tuple[FloatArray, FloatArray, FloatArray, tuple[str, ...]]:
        """Powers as products of rows over z with factors, and their owners; that outside is ""."""
        plant, at, bare = self.split.plant, self.at, form.form
        found: list[tuple[FloatArray, FloatArray, float, str]] = []
        system, speed, one = plant.assembly.system, bare.motion[1], np.eye(at.size)[at.one]
        for number, law in enumerate(plant.assembly.laws):
            if system.damping[number] and not isinstance(law, PlacedLaw):
                rate = system.rows[number] @ speed
                found.append((rate, rate, float(system.damping[number]), plant.assembly.owners[number]))
        for number, (law_of, place) in enumerate(zip(self.states.laws, contact, strict=True)):
            phase, rate = law_of.phases[place], bare.rates[number]
            if law_of.over_rate:
                found.append((bare.torques[number], rate, 1.0, law_of.owner))
            elif phase.kind == "free":
                found.append((phase.torque * one + phase.stiffness * bare.twists[number], rate, -1.0, law_of.owner))
            elif phase.kind == "slope" and phase.damping:
                found.append((rate, rate, phase.damping, law_of.owner))
        ones = np.eye(at.size)[at.u]
        for place, smooth in zip(self.places, self.split.smooth, strict=True):
            if smooth.over_rate:
                found.append((ones[place], smooth.row @ speed, 1.0, smooth.owner))
        columns = self.states.drive.columns[:, : self.n_in].T
        found += [(row, column @ speed, 1.0, "") for row, column in zip(bare.inputs, columns, strict=False)]
        for action, torque in zip(plant.actions, bare.act, strict=True):
            found.append((torque, action.row @ speed, 1.0, ""))
        shape = (-1, at.size)
        return (np.array([one for one, _, _, _ in found]).reshape(shape),
                np.array([one for _, one, _, _ in found]).reshape(shape),
                np.array([factor for _, _, factor, _ in found]), tuple(owner for _, _, _, owner in found))  # fmt: skip

    def _energy(self, now: _Contact, z: FloatArray) -> float:
        """Kinetic energy and energy stored in springs in J."""
        plant = self.split.plant
        system = plant.assembly.system
        q, v = (rows @ z for rows in now.form.form.motion[:2])
        twists, rates = system.rows @ q, system.rows @ v
        linear = np.array([not isinstance(law, PlacedLaw) for law in plant.assembly.laws], dtype=bool)
        found = 0.5 * float(system.inertia @ rates**2 + system.stiffness[linear] @ twists[linear] ** 2)
        rows = [(one.law, one.row) for one in plant.laws] + [(o.law, o.row) for o in self.split.smooth if o.held < 0]
        return found + sum(float(law.energy(float(row @ q))) for law, row in rows)

    def _active(self, one: SmoothLaw, contact: Contact) -> bool:
        return one.held < 0 or self.states.laws[one.held].phases[contact[one.held]].kind == "slope"

    def _torques(self, now: _Contact, y: FloatArray, u: FloatArray, slopes: FloatArray) -> list[FloatArray]:
        """Write the torques of the smooth laws into u (n_u,); twist and rates of each."""
        motions, form = [], now.form
        for place, one, rows in zip(self.places, self.split.smooth, form.motions, strict=True):
            motion = rows @ (form.over_y @ y + form.over_u @ u + form.over_s @ slopes)
            motions.append(motion)
            if self._active(one, now.contact):
                scale = 1.0 if one.scale < 0 else u[self.n_in + self.n_s + one.scale]
                u[place] = one.torque(float(motion[0]), motion[1:], float(scale))
        return motions

    def _u(self, time: float, stretch: Stretch | None) -> tuple[FloatArray, FloatArray]:
        u, slopes = np.zeros(self.at.n_u), np.zeros(self.at.n_u)
        if stretch is None:
            u[self.outside] = self.driving.first
        else:
            value, slope = stretch.at(np.array([time]))
            u[self.outside], slopes[self.outside] = value[:, 0], slope[:, 0]
        return u, slopes

    def _whole(self, now: _Contact, time: float, y: FloatArray, stretch: Stretch | None) -> FloatArray:
        """State z at a time, with the torques of the smooth laws and their rates of change in it."""
        u, slopes = self._u(time, stretch)
        motions = self._torques(now, y, u, slopes)
        z = now.form.whole(y, u, slopes)
        if now.needs_slopes:
            bent = now.form.form.motion[2] @ z
            for place, one, motion in zip(self.places, self.split.smooth, motions, strict=True):
                if self._active(one, now.contact):
                    rows = np.vstack([one.row, one.sensed])
                    scale = 1.0 if one.scale < 0 else float(u[self.n_in + self.n_s + one.scale])
                    slopes[place] = one.slope(float(motion[0]), motion[1:], rows @ bent, scale)
                    if one.scale >= 0:
                        changed = float(slopes[self.n_in + self.n_s + one.scale])
                        slopes[place] += one.torque(float(motion[0]), motion[1:], changed)
            z = now.form.whole(y, u, slopes)
        return z

    def _right_side(self, now: _Contact, stretch: Stretch) -> Any:
        form, laws = now.form, self.split.smooth
        A = form.A
        n_scale = self.n_in + self.n_s
        active = [
            (place, one, rows @ form.over_y, rows @ form.over_u, rows @ form.over_s)
            for place, one, rows in zip(self.places, laws, form.motions, strict=True)
            if self._active(one, now.contact)
        ]
        steady = not stretch.waves and not stretch.slopes.any()
        u0 = np.zeros(self.at.n_u)
        u0[self.outside] = stretch.values
        none = np.zeros(self.at.n_u)

        def rates(time: float, y: FloatArray) -> FloatArray:
            if steady:
                u, slopes = u0.copy(), none
            else:
                u, slopes = self._u(time, stretch)
            for place, one, over_y, over_u, over_s in active:
                motion = over_y @ y + over_u @ u + over_s @ slopes
                scale = 1.0 if one.scale < 0 else float(u[n_scale + one.scale])
                u[place] = one.torque(float(motion[0]), motion[1:], scale)
            return np.asarray(A @ y + form.U @ u + form.S @ slopes)

        return rates

    def _through(self, stretch: Stretch, now: _Contact, y: FloatArray) -> tuple[_Contact, FloatArray]:
        """Contact state and states y at the end of a stretch."""
        from scipy.integrate import DOP853, Radau

        time = stretch.start
        while time < stretch.end:
            method = Radau if now.stiff else DOP853
            first = None if self.step is None else min(self.step, stretch.end - time)
            try:
                solver = method(
                    self._right_side(now, stretch), time, y, stretch.end, first_step=first, **self.tolerances
                )
                time, now, y = self._until_event(solver, stretch, now)
            except (ArithmeticError, ValueError) as error:
                if isinstance(error, TorsionnetError):
                    raise
                raise SolveError(f"at {time:.6g} s the torques of the laws have no value: {error}") from error
        return now, y

    def _until_event(self, solver: Any, stretch: Stretch, now: _Contact) -> tuple[float, _Contact, FloatArray]:
        while solver.status == "running":
            start = solver.t
            self.steps += 1
            message = solver.step()
            if solver.status == "failed" or self.steps > MOST_STEPS:
                text = "the motion cannot be followed" if message else "the motion needs too many steps"
                raise SolveError(f"at {solver.t:.6g} s {text}; {self._most_bent(now, solver.y, stretch, solver.t)}")
            dense, end = solver.dense_output(), solver.t
            places, weights, _ = nodes()
            Z = self._states_at(now, dense, start + places * (end - start), stretch)
            self._require_range(now, Z, start, end)
            guards = now.guards @ Z
            sizes = (np.abs(now.guards) @ np.abs(Z)).max(axis=1)

            def guard_at(guard: int, place: float, *, first: float = start, size: float = end - start,
                         course: Any = dense) -> float:  # fmt: skip
                time = first + place * size
                return float(now.guards[guard] @ self._whole(now, time, course(time), stretch))

            place, which = first_event(guards, sizes, guard_at) if len(self.states.laws) else (-1.0, -1)
            if which < 0:
                self._count(now, Z, weights * (end - start))
                self._read(now, dense, end, stretch)
                self.step = max(end - start, 1e-12 * end)
                continue
            at = float(start + place * (end - start))
            if at > start:
                self._count(now, self._states_at(now, dense, start + places * (at - start), stretch),
                            weights * (at - start))  # fmt: skip
                self._read(now, dense, at, stretch)
            z = self._whole(now, at, dense(at), stretch)
            return at, *self._event(now, which, z, at)
        return solver.t, now, solver.y

    def _states_at(self, now: _Contact, dense: Any, times: FloatArray, stretch: Stretch) -> FloatArray:
        """States z (N, n) at times."""
        Y = dense(times)
        if not self.split.smooth or now.needs_slopes:
            return np.array([self._whole(now, time, y, stretch) for time, y in zip(times.tolist(), Y.T, strict=True)]).T
        u, slopes = np.zeros((self.at.n_u, len(times))), np.zeros((self.at.n_u, len(times)))
        u[self.outside], slopes[self.outside] = stretch.at(times)
        for number in range(len(times)):
            self._torques(now, Y[:, number], u[:, number], slopes[:, number])
        return now.form.whole(Y, u, slopes)

    def _event(self, now: _Contact, guard: int, z: FloatArray, time: float) -> tuple[_Contact, FloatArray]:
        self.recent.append(time)
        window = STORM_WINDOW / self.turning
        if len(self.recent) == MOST_EVENTS and time - self.recent[0] < window:
            owner = self.states.laws[guard // 3].owner
            rate = MOST_EVENTS / window
            text = f"{owner}: at {time:.6g} s its torque changes its piece more than {rate:.3g} times a second"
            raise SolveError(
                f"{text}, without an end to be seen; give the contact or the friction a stiffness or a damping"
            )
        self.states.h = BOUNCE_STEP / self.turning
        contact, _ = self.states.after(now.contact, guard, z / in_steps(self.at, self.states.h), time)
        owner, what = self.states.change(now.contact, contact)
        if what:
            self.events.append(MotionEvent(time, owner, what))
        following = self._known(contact)
        return following, following.form.take @ z

    def _read(self, now: _Contact, dense: Any, end: float, stretch: Stretch) -> None:
        """Read samples before a time in s."""
        rate = self.driving.rate
        last = min(self.driving.n, int(np.ceil(end * rate - 1e-9)))
        if last <= self.sample:
            return
        times = np.arange(self.sample, last) / rate
        self.values[:, self.sample : last] = now.reads @ self._states_at(now, dense, times, stretch)
        self.sample = last

    def _count(self, now: _Contact, Z: FloatArray, weights: FloatArray) -> None:
        firsts, seconds, factors = now.powers
        sums = factors * (((firsts @ Z) * (seconds @ Z)) @ weights)
        for owner, value in zip(now.owners, sums.tolist(), strict=True):
            self.works[owner] = self.works.get(owner, 0.0) + value

    def _require_range(self, now: _Contact, Z: FloatArray, start: float, end: float) -> None:
        for one, rows in zip(self.split.smooth, now.form.motions, strict=True):
            motion = rows @ Z[:, -1]
            message = one.left(float(motion[0]), motion[1:])
            if message:
                raise SolveError(f"{one.owner}: between {start:.6g} s and {end:.6g} s {message}")

    def _most_bent(self, now: _Contact, y: FloatArray, stretch: Stretch, time: float) -> str:
        """Advice with the name of the smooth law whose motion is quickest."""
        z = self._whole(now, time, y, stretch)
        sizes = [(float(np.abs(rows @ z).max()), one.owner) for one, rows in
                 zip(self.split.smooth, now.form.motions, strict=True)]  # fmt: skip
        owner = max(sizes)[1] if sizes else "the drivetrain"
        return f"look at the torque and the motion of {owner} there"
