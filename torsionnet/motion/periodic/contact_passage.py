"""March through the contact states of a period, exact between events, with its monodromy.

Between events z' = A z, of which exponentials give the motion and its changes alike. Where a guard n^T z reaches zero,
the state passes to the next contact state by its refresh R, and a change of the state by the saltation matrix

    S = R + (A_after R z - R A_before z) n^T / (n^T A_before z)

(M. di Bernardo et al., Piecewise-smooth Dynamical Systems, chapter 2). It is R alone where the vector field is
continuous, as at the corners of a spring in stages, and more where a contact with damping closes or a slider lets go.
The product over a period is the monodromy; its eigenvalues are the multipliers of the motion.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.law_stiffness import Functional
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.motion.contact_states import Contact, ContactStates, relative_state
from torsionnet.motion.march_tables import guard_rows, in_steps
from torsionnet.motion.motion_plant import Drive, Layout, MotionPlant
from torsionnet.motion.motion_record import reading_plan, reading_rows
from torsionnet.motion.periodic.periodic_problem import PeriodicMotion, PeriodicProblem, over_time, samples

BLOCK = 16
"""Looks that are taken together."""
ROUNDING = 1e-13
"""Share of a state by which a period that closes may stay open."""
NOTHING = 1e-9
"""Entry of a monodromy that is rounding."""
FEWEST_LOOKS = 64
"""Times in a period at which the guards are looked at, at least."""
LONGEST_TURN = 0.4
"""Angle in rad that the fastest vibration may turn between two looks."""
LOCATED = 1e-14
"""Part of a look to which an event is located."""
MOST_EVENTS = 2000
"""Most events in a period."""
SLIPPING = 1e-7
"""Share of what friction holds by which its torque may seem to lie below while it slips."""
AT_BOUND = 1e-11
"""Value of a guard, over its terms, up to which a state lies on it."""


@dataclass(frozen=True, eq=False)
class PeriodStretch:
    """Part of a period in one contact state: its time in s, its length, and the state z (N,) at its beginning."""

    time: float
    length: float
    contact: Contact
    z: FloatArray


@dataclass(frozen=True, eq=False)
class Passage:
    """Period of a motion: its stretches, the state z at its end, and the monodromy (N, N)."""

    stretches: tuple[PeriodStretch, ...]
    end: FloatArray
    monodromy: FloatArray


class ContactMarch:
    """Plant of straight pieces under the torques of a periodic problem, in the contact states that it visits."""

    def __init__(self, problem: PeriodicProblem, parameter: float) -> None:
        self.problem, self.parameter = problem, parameter
        split = problem.plant.in_time
        self.plant = split.plant
        omega = problem.drive.omega(parameter)
        self.period = 2 * math.pi * problem.subharmonics / omega
        loads = problem.drive.loads(parameter)
        kinds = [(h, entry) for h, entry in zip(*np.nonzero(loads[1:]), strict=True)]
        F, S = np.zeros((2 * len(kinds),) * 2), np.zeros((loads.shape[1], 2 * len(kinds)))
        self.w = np.zeros(2 * len(kinds))
        for number, (h, entry) in enumerate(kinds):
            # d/dt of (Re, Im) A exp(j h w t) = [[0, -h w], [h w, 0]] (Re, Im)
            own = slice(2 * number, 2 * number + 2)
            F[own, own] = [[0.0, -(h + 1) * omega], [(h + 1) * omega, 0.0]]
            S[entry, 2 * number] = 1.0
            self.w[own] = loads[h + 1, entry].real, loads[h + 1, entry].imag
        self.means = loads[0].real
        drive = Drive(problem.plant.columns, tuple(-1 for _ in split.phases), 0, F, S)
        n_c = sum(len(action.F) for action in self.plant.actions)
        self.at = Layout(len(problem.plant.columns), n_c, len(F), loads.shape[1])
        self.states = ContactStates(split.plant, split.phases, drive, self.at, relative=True)
        self._tables: dict[Contact, tuple[FloatArray, FloatArray, FloatArray]] = {}
        self._changing: dict[Contact, NDArray[np.intp]] = {}

    def start(self, motion: PeriodicMotion) -> tuple[FloatArray, Contact]:
        """State z (N,) and contact state of a motion at the beginning of its period."""
        at, problem = self.at, self.problem
        q, _ = problem.coordinates(motion)
        s = 1j * motion.omega * np.arange(len(q))[:, None]
        z = np.zeros(at.size)
        z[at.q], z[at.v] = q.sum(axis=0).real, (s * q).sum(axis=0).real
        place = at.controllers.start
        for action in self.plant.actions:
            # x_k = (s - F)^-1 (G_0 + s G_1) y_k
            y = q @ action.sensed
            for k, value in enumerate(y):
                drive = action.G[:, 0] + s[k, 0] * action.G[:, 1]
                x = np.linalg.solve(s[k, 0] * np.eye(len(drive)) - action.F, drive * value) if len(drive) else drive
                z[place : place + len(action.F)] += x.real
            place += len(action.F)
        z[at.w], z[at.constant], z[at.u] = self.w, 1.0, self.means
        z = np.asarray(relative_state(self.states.plant, at, z))
        contact = self.states.at_start(*self._motions(motion), np.ones(len(self.states.laws)))
        return z, self._sticking_state(contact, motion)

    def _motions(self, motion: PeriodicMotion) -> tuple[FloatArray, FloatArray]:
        twists = self.problem.coordinates(motion)[0] @ self.problem.plant.rows.T
        s = 1j * motion.omega * np.arange(len(twists))[:, None]
        return twists.sum(axis=0).real, (s * twists).sum(axis=0).real

    def _sticking_state(self, contact: Contact, motion: PeriodicMotion) -> Contact:
        """Contact state in which friction sticks where its torque is below what it holds."""
        places = list(contact)
        for number, law in enumerate(self.states.laws):
            hold = next((at for at, piece in enumerate(law.phases) if piece.kind == "hold" and law.over_rate), None)
            if hold is None:
                continue
            torque = float(self._torque(motion, number)[0])
            phase = law.phases[hold]
            way = int(torque >= phase.high * (1 - SLIPPING)) - int(torque <= phase.low * (1 - SLIPPING))
            if np.sign(law.phases[places[number]].place - phase.place) != way:
                places[number] = law.of_piece(phase.place + way)
        return tuple(places)

    def _torque(self, motion: PeriodicMotion, law: int) -> FloatArray:
        """Torque (N,) in N m of a law over the period."""
        force, n = self.problem.forces[law], samples(motion.harmonics)
        return force.answer_to(over_time(motion.x[:, law], n), None).torque

    def _guards_of_block(self, contact: Contact) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Guards (n_g, N), exponential over one look, and guards at all looks of a block (n, n_g, N)."""
        if contact not in self._tables:
            form = self.states.form(contact)
            guards = guard_rows(form, self.states.laws, contact, self.at, self.states.drive.scale_of)
            constant = np.eye(self.at.size)[self.at.constant]
            own = np.flatnonzero((guards != constant).any(axis=1))
            step = np.asarray(scipy.linalg.expm(form.A * self.look))
            ahead = [guards[own]]
            for _ in range(BLOCK):
                ahead.append(ahead[-1] @ step)
            self._changing[contact] = own
            self._tables[contact] = guards[own], step, np.array(ahead)
        return self._tables[contact]

    @property
    def look(self) -> float:
        """Time in s between two looks at the guards."""
        return self._look

    def passage(self, z: FloatArray, contact: Contact) -> Passage:
        """Period of the motion from a state z in a contact state.

        Raises
        ------
        SolveError
            Too many events, or a law that is left.
        """
        self._set_look(contact)
        states, at = self.states, self.at
        states.h = self.look
        units = in_steps(at, states.h)
        contact = states.fixed(contact, z / units)
        refresh = states.form(contact).refresh
        z = refresh @ z
        # Monodromy: the product of exp(A t) of all stretches, with what each event changes between them.
        change, time = refresh.copy(), 0.0
        stretches: list[PeriodStretch] = []
        while self.period - time > LOCATED * self.period:
            form = states.form(contact)
            length, guard = self._next_event(z, contact, self.period - time)
            stretches.append(PeriodStretch(time, length, contact, z))
            # Within one contact state z' = A z, and a small disturbance moves alike.
            passed = np.asarray(scipy.linalg.expm(form.A * length))
            z, change, time = passed @ z, passed @ change, time + length
            if guard < 0:
                break
            if len(stretches) > MOST_EVENTS:
                owner = states.laws[guard // 3].owner
                text = f"{owner}: its torque changes its piece more than {MOST_EVENTS} times in a period"
                raise SolveError(text, kind="no-period")
            following, _ = states.state_after(contact, guard, z / units, time)
            # Saltation: beside the orbit the event moves in time by rows.dz / speed, over which the other rates act.
            rows = guard_rows(form, states.laws, contact, at, states.drive.scale_of)[guard]
            entered = states.form(following)
            speed = float(rows @ form.A @ z)
            # Saltation S = R + (f+ - R f-) n^T / (n^T f-): a disturbance moves the event, between unlike rates f.
            jump = entered.A @ (entered.refresh @ z) - entered.refresh @ (form.A @ z)
            saltation = entered.refresh + np.outer(jump, rows) / speed if speed else entered.refresh
            z, change, contact = entered.refresh @ z, saltation @ change, following
        return Passage(tuple(stretches), z, change)

    def _set_look(self, contact: Contact) -> None:
        turning = self.states.form(contact).largest_rates[0]
        for law_number, law in enumerate(self.states.laws):
            for phase in range(len(law.phases)):
                other = (*contact[:law_number], phase, *contact[law_number + 1 :])
                if law.phases[phase].kind == "slope":
                    turning = max(turning, self._turning(other))
        count = max(FEWEST_LOOKS, math.ceil(self.period * turning / LONGEST_TURN))
        self._look = self.period / count
        self._tables.clear()

    def _turning(self, contact: Contact) -> float:
        try:
            return self.states.form(contact).largest_rates[0]
        except SolveError:
            return 0.0

    def _next_event(self, z: FloatArray, contact: Contact, left: float) -> tuple[float, int]:
        """Time in s to the next event and its guard, or the time left and -1."""
        guards, step, ahead = self._guards_of_block(contact)
        if not len(guards):
            return left, -1
        A, passed = self.states.form(contact).A, 0.0
        while passed < left:
            # Guards and their rates at all looks of a block by one product each.
            values = ahead @ z
            rates = ahead @ (A @ z)
            sizes = np.abs(guards) @ np.abs(z)
            # Looks at which a guard has fallen below zero are narrowed down; the first event within one counts.
            for number in range(BLOCK):
                if passed + number * self.look >= left:
                    return left, -1
                which = self._falls(values[number : number + 2], rates[number : number + 2])
                if not len(which):
                    continue
                here = np.linalg.matrix_power(step, number) @ z
                times = [(self._located(here, A, guards[guard], sizes[guard]), guard) for guard in which]
                events = [(time, guard) for time, guard in times if time is not None]
                if events:
                    time, guard = min(events)
                    whole = passed + number * self.look + time
                    return (whole, int(self._changing[contact][guard])) if whole < left else (left, -1)
            z = np.linalg.matrix_power(step, BLOCK) @ z
            passed += BLOCK * self.look
        return left, -1

    def _falls(self, values: FloatArray, rates: FloatArray) -> list[int]:
        """Guards that may fall below zero within a look: they end below, or dip in between."""
        ends_below = values[1] < 0
        # A dip: falling at the beginning and rising at the end, near enough to zero.
        dips = (rates[0] < 0) & (rates[1] > 0) & (np.minimum(*values) < self.look * np.maximum(-rates[0], rates[1]))
        return np.flatnonzero(ends_below | dips).tolist()

    def _located(self, z: FloatArray, A: FloatArray, guard: FloatArray, size: float) -> float | None:
        """Time in s within a look at which a guard falls through zero, by bisection and Newton's method; else None."""

        def at(time: float) -> tuple[float, float]:
            there = scipy.linalg.expm(A * time) @ z
            return float(guard @ there), float(guard @ (A @ there))

        low, high = 0.0, self.look
        value, rate = at(0.0)
        # It falls at once, unless its rate is rounding, as of friction that has just stopped.
        if value <= AT_BOUND * size and rate * self.look < -AT_BOUND * size:
            return 0.0
        if value < 0:  # just left: it rises, and falls later on
            value = 0.0
        end = at(high)[0]
        if end >= 0:
            # the lowest point between, where the rate changes its sign
            a, b = low, high
            for _ in range(60):
                middle = 0.5 * (a + b)
                there, slope = at(middle)
                if there < 0:
                    high, end = middle, there
                    break
                a, b = (middle, b) if slope < 0 else (a, middle)
            else:
                return None
        time = 0.5 * (low + high)
        for _ in range(60):
            there, slope = at(time)
            if there > 0:
                low = time
            else:
                high = time
            following = time - there / slope if slope else 0.5 * (low + high)
            if not low < following < high:
                following = 0.5 * (low + high)
            if abs(following - time) <= LOCATED * self.look:
                return following
            time = following
        return time

    def multipliers(self, passage: Passage) -> ComplexArray:
        """Multipliers of a period, the largest first, without those of what turns freely as a whole."""
        at = self.at
        own = slice(0, 2 * at.n_q + at.n_c)
        monodromy = passage.monodromy[own, own]
        return multipliers_of(without_turning(monodromy, self.states.plant, at))

    def closed(self, z: FloatArray, contact: Contact, most: int) -> tuple[Passage, FloatArray, float]:
        """Period that closes, by Newton's method from a state near it, with its first state and what is left open."""
        own = slice(0, 2 * self.at.n_q + self.at.n_c)
        passage, turned = self.passage(z, contact), self._turned()
        z = passage.stretches[0].z
        opening = math.inf
        for number in range(most + 1):
            gap = (passage.end - z)[own]
            gap[turned] = 0.0
            smaller = float(np.abs(gap).max()) / (float(np.abs(z[own]).max()) or 1.0)
            if smaller < ROUNDING or smaller > 0.5 * opening or number == most:
                break
            opening = smaller
            # z(T) - z = 0, whose slope is the monodromy less 1; what turns on is free to.
            matrix = passage.monodromy[own, own] - np.eye(len(gap))
            step = np.linalg.lstsq(matrix, gap, rcond=1e-12)[0]
            step[turned] = 0.0
            z = z.copy()
            z[own] -= step
            z = self.states.form(passage.stretches[0].contact).refresh @ z
            passage = self.passage(z, contact)
        return passage, z, min(opening, smaller)

    def _turned(self) -> list[int]:
        return [self.at.q.start + pivot for pivot, _ in self.states.plant.turning]

    def extremes(self, passage: Passage, readings: Sequence[Functional], points: int) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest values (n_out,) of readings over a period, from parabolas through their points."""
        tops = [[-_tops(-values), _tops(values)] for values in self._stretches_read(passage, readings, points)]
        return np.min([low for low, _ in tops], axis=0), np.max([high for _, high in tops], axis=0)

    def harmonics(self, passage: Passage, readings: Sequence[Functional], points: int, count: int) -> ComplexArray:
        """One-sided harmonics (count + 1, n_out) of readings, the mean first, by Simpson's rule along every stretch."""
        k = np.arange(count + 1)[:, None]
        total = np.zeros((count + 1, len(readings)), dtype=complex)
        stretches = zip(passage.stretches, self._stretches_read(passage, readings, points), strict=True)
        for stretch, values in stretches:
            times = stretch.time + np.linspace(0.0, stretch.length, len(values))
            # Simpson's weights, h/3 times 1, 4, 2, 4 and so on to 4, 1
            weights = np.full(len(values), stretch.length / (3 * (len(values) - 1)))
            weights[1:-1:2] *= 4
            weights[2:-1:2] *= 2
            total += 2 / self.period * (weights * np.exp(-2j * math.pi * k * times / self.period)) @ values
        total[0] /= 2
        return total

    def _stretches_read(self, passage: Passage, readings: Sequence[Functional], points: int) -> Iterator[FloatArray]:
        """Yield readings (n, n_out) of every stretch, its two ends included."""
        plan = reading_plan(self.states.plant, readings, self.problem.plant.inputs)
        for stretch in passage.stretches:
            form = self.states.form(stretch.contact)
            rows = reading_rows(self.states.plant, readings, self.problem.plant.inputs, form, self.at, plan)
            count = 2 * max(1, math.ceil(points * stretch.length / (2 * self.period)))
            step = np.asarray(scipy.linalg.expm(form.A * (stretch.length / count)))
            z = [stretch.z]
            for _ in range(count):
                z.append(step @ z[-1])
            yield np.array(z) @ rows.T


def _tops(values: FloatArray) -> FloatArray:
    """Highest values (n_out,) of courses (n, n_out): at an end, or the top of the parabola through three points."""
    places, columns = values.argmax(axis=0), np.arange(values.shape[1])
    # Parabola through three points: the top is (y_+ - y_-)^2/(8 (2 y_0 - y_- - y_+)) above the middle one.
    inner = np.clip(places, 1, len(values) - 2)
    before, here, after = (values[inner + step, columns] for step in (-1, 0, 1))
    bend = before - 2 * here + after
    top = here - (after - before) ** 2 / (8 * np.where(bend, bend, 1.0))
    return np.asarray(np.where((inner == places) & (bend < 0), top, values[places, columns]))


def without_turning(monodromy: FloatArray, plant: MotionPlant, at: Layout) -> FloatArray:
    """Monodromy of what twists: the angle of what turns freely moves nothing, nor does an undamped speed of it."""
    turned = [at.q.start + pivot for pivot, _ in plant.turning]
    left = [place for place in range(len(monodromy)) if place not in turned]
    for pivot, _ in plant.turning:
        place = at.v.start + pivot
        column = np.delete(monodromy[:, place], [*turned, place])
        if np.abs(column).max(initial=0.0) < NOTHING and abs(monodromy[place, place] - 1) < NOTHING:
            left.remove(place)
    return monodromy[np.ix_(left, left)]


def multipliers_of(monodromy: FloatArray) -> ComplexArray:
    """Eigenvalues of a monodromy, the largest first."""
    multipliers = np.asarray(np.linalg.eigvals(monodromy), dtype=np.complex128)
    return multipliers[np.argsort(-np.abs(multipliers), kind="stable")]
