"""Plant with smooth laws under torques over time: its states y, their rates of change, and the whole states z.

y are the states of the contact state, as few as there are, followed by the torques of laws that lag behind their curve.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.law_stiffness import Functional
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.model.channels import Input
from torsionnet.motion.contact_form import ContactForm
from torsionnet.motion.contact_states import Contact, ContactStates, relative_state
from torsionnet.motion.driving import Driving, Stretch
from torsionnet.motion.march_tables import guard_rows, in_steps
from torsionnet.motion.motion_plant import Drive, LawOverCoordinates, Layout, Phase, PlacedLaw
from torsionnet.motion.motion_record import reading_rows
from torsionnet.motion.motion_works import remembered_energies
from torsionnet.motion.smooth_laws import SmoothLaw, SplitPlant

# Equations of motion in one contact state over as few states as there are, with smooth laws as torques u.

LEAST_SINGULAR = 0.5
"""Singular value that parts the motions of the refresh, a projection whose others are 1 or more, from rounding."""
FEEDBACK = 1e-9
"""Share of the largest weight in a row by which the torque of a law may seem to change its own motion at once."""


@dataclass(frozen=True, eq=False)
class SmoothForm:
    """Equations y' = A y + U u + S u' in one contact state, z = Z_y y + Z_u u + Z_s u', and y = take z.

    Attributes
    ----------
    form : ContactForm
    A, U, S : arrays (r, r), (r, n_u), (r, n_u)
    over_y, over_u, over_s : arrays (N, r), (N, n_u), (N, n_u)
    take : (r, N) array
    motions : tuple of arrays
        Rows over z of the twist and of all rates of each smooth law, the twist first.
    """

    form: ContactForm
    A: FloatArray
    U: FloatArray
    S: FloatArray
    over_y: FloatArray
    over_u: FloatArray
    over_s: FloatArray
    take: FloatArray
    motions: tuple[FloatArray, ...]

    def whole(self, y: FloatArray, u: FloatArray, slopes: FloatArray) -> FloatArray:
        """States z from y, u and the rates of change of u."""
        return np.asarray(self.over_y @ y + self.over_u @ u + self.over_s @ slopes)


def smooth_form(form: ContactForm, at: Layout, laws: Sequence[SmoothLaw], places: Sequence[int]) -> SmoothForm:
    """Equations of motion over as few states as there are; the torques of laws stand at ``places`` in u.

    Raises
    ------
    UsageError
        The torque of a law changes its own motion at once, since nothing there has inertia.
    """
    # The refresh is a projection with singular values of 0, or 1 and more: its range holds the states y.
    own = form.refresh[: at.n_p, : at.n_p]
    left, sizes, _ = np.linalg.svd(own)
    basis = left[:, : int((sizes > LEAST_SINGULAR).sum())]
    take = np.zeros((basis.shape[1], at.size))
    take[:, : at.n_p] = basis.T @ own
    over_y, over_u, over_s = form.refresh[:, : at.n_p] @ basis, form.refresh[:, at.u], form.refresh[:, at.slope]
    # y' = take A z, with z = Z_y y + Z_u u + Z_s u'
    rates = take @ form.A
    angles, speeds, _ = form.motion
    motions = tuple(np.vstack([law.row @ angles, law.row @ speeds, law.sensed @ speeds]) for law in laws)
    prompt = [place for place, law in zip(places, laws, strict=True) if not law.lag]
    # Largest acceleration that a torque of 1 N m gives to a coordinate.
    felt = max(1e-300, float(np.abs(form.motion[2][:, at.u]).max(initial=0.0)))
    for law, rows in zip(laws, motions, strict=True):
        used = rows[1:] if law.over_rate else rows[:1]
        if law.lag:
            continue
        # What prompt torques change at once in the motion that a law follows has to be nothing.
        at_once = np.hstack([used @ over_u[:, prompt], used @ over_s[:, prompt]])
        if np.abs(at_once).max(initial=0.0) > FEEDBACK * felt:
            text = "its torque acts where nothing has inertia, so that its motion follows from a curve alone"
            raise UsageError(f"{law.owner}: {text}; give the node an inertia", kind="indeterminate-motion")
    return SmoothForm(form, rates @ over_y, rates @ over_u, rates @ over_s, over_y, over_u, over_s, take, motions)


# Contact states of a smooth motion: equations, guards, readings, and powers by element, as rows over the state z.


@dataclass(frozen=True, eq=False)
class Powers:
    """Powers in W as products of two rows (n, N) over z with a factor, and their owners; that outside is ""."""

    firsts: FloatArray
    seconds: FloatArray
    factors: FloatArray
    owners: tuple[str, ...]

    def works(self, Z: FloatArray, weights: FloatArray) -> Iterator[tuple[str, float]]:
        """Yield owner and work in J of each power over states Z (N, n) with quadrature weights (n,) in s."""
        sums = self.factors * (((self.firsts @ Z) * (self.seconds @ Z)) @ weights)
        yield from zip(self.owners, sums.tolist(), strict=True)


@dataclass(frozen=True, eq=False)
class SmoothContact:
    """Contact state with its equations, guards (n_g, N), readings (n_out, N) and powers over z.

    ``poles`` (n,) in 1/s are those of the motion without the smooth laws. ``needs_slopes`` says whether guards,
    readings or powers follow how the torques of the smooth laws change.
    """

    contact: Contact
    form: SmoothForm
    guards: FloatArray
    reads: FloatArray
    powers: Powers
    poles: ComplexArray
    needs_slopes: bool

    @property
    def turning(self) -> float:
        """Largest circular frequency of a vibration in rad/s without the smooth laws."""
        return float(np.abs(self.poles.imag).max(initial=0.0))


def smooth_contact(
    states: ContactStates, contact: Contact, laws: Sequence[SmoothLaw], places: Sequence[int],
    readings: Sequence[Functional], inputs: Sequence[Input],
) -> SmoothContact:  # fmt: skip
    """Contact state of a plant whose smooth laws have their torques at ``places`` in u.

    Raises
    ------
    UsageError
        Parts that stick in a loop, or smooth laws where nothing has inertia.
    """
    at, bare = states.at, states.form(contact)
    form = smooth_form(bare, at, laws, places)
    guards = guard_rows(bare, states.laws, contact, at, states.drive.scale_of)
    reads = _readings(states, bare, laws, places, readings, inputs)
    powers = _powers(states, contact, form, laws, places, len(inputs))
    own = np.vstack([reads, powers.firsts, powers.seconds, guards]) @ form.over_s[:, list(places)]
    direct = np.abs(reads[:, at.slope][:, list(places)]).max(initial=0.0)
    needs = bool(max(np.abs(own).max(initial=0.0), direct) > 0)
    return SmoothContact(contact, form, guards, reads, powers, np.linalg.eigvals(form.A).astype(complex), needs)


def _readings(
    states: ContactStates, bare: ContactForm, laws: Sequence[SmoothLaw], places: Sequence[int],
    readings: Sequence[Functional], inputs: Sequence[Input],
) -> FloatArray:  # fmt: skip
    """Rows (n_out, N) of the readings, in which the torques of smooth laws stand in u."""
    plant, at = states.plant, states.at
    torques, ones = list(bare.torques), np.eye(at.size)[at.u]
    for place, smooth in zip(places, laws, strict=True):
        if smooth.held >= 0:
            torques[smooth.held] = torques[smooth.held] + ones[place]
    mine = [(place, smooth) for place, smooth in zip(places, laws, strict=True) if smooth.held < 0]
    rows = (LawOverCoordinates(smooth.owner, smooth.law, smooth.number, smooth.row) for _, smooth in mine)
    whole = replace(plant, laws=(*plant.laws, *rows))
    read = replace(bare, torques=np.array([*torques, *(ones[place] for place, _ in mine)]).reshape(-1, at.size))
    return reading_rows(whole, readings, inputs, read, at)


def _powers(
    states: ContactStates, contact: Contact, form: SmoothForm, laws: Sequence[SmoothLaw], places: Sequence[int],
    n_in: int,
) -> Powers:  # fmt: skip
    """Powers of dampers, of laws of motion, of controllers and of torques from outside."""
    plant, at, bare = states.plant, states.at, form.form
    powers: list[tuple[FloatArray, FloatArray, float, str]] = []
    system, speed, steady = plant.assembly.system, bare.motion[1], np.eye(at.size)[at.constant]
    # c gamma'^2 of dampers, T gamma' of laws over the rate, and what contacts lose.
    for number, law in enumerate(plant.assembly.laws):
        if system.damping[number] and not isinstance(law, PlacedLaw):
            rate = system.rows[number] @ speed
            powers.append((rate, rate, float(system.damping[number]), plant.assembly.owners[number]))
    for number, (law_of, place) in enumerate(zip(states.laws, contact, strict=True)):
        phase, rate = law_of.phases[place], bare.rates[number]
        if law_of.over_rate:
            powers.append((bare.torques[number], rate, 1.0, law_of.owner))
        elif phase.kind == "free":
            powers.append((phase.torque * steady + phase.stiffness * bare.twists[number], rate, -1.0, law_of.owner))
        elif phase.sense:
            powers.append((bare.torques[number], rate, 1.0, law_of.owner))
        elif phase.kind == "slope" and phase.damping:
            powers.append((rate, rate, phase.damping, law_of.owner))
    ones = np.eye(at.size)[at.u]
    for place, smooth in zip(places, laws, strict=True):
        if smooth.over_rate:
            powers.append((ones[place], smooth.row @ speed, 1.0, smooth.owner))
        elif smooth.number < 0:  # the torque on the row is -u
            powers.append((ones[place], smooth.row @ speed, -1.0, ""))
    columns = states.drive.columns[:, :n_in].T
    powers += [(row, column @ speed, 1.0, "") for row, column in zip(bare.inputs, columns, strict=False)]
    for action, torque in zip(plant.actions, bare.act, strict=True):
        powers.append((torque, action.row @ speed, 1.0, ""))
    firsts, seconds = (np.array([power[side] for power in powers]).reshape(-1, at.size) for side in (0, 1))
    return Powers(firsts, seconds, np.array([power[2] for power in powers]), tuple(power[3] for power in powers))


MOST_CONTACTS = 256
"""Most contact states whose equations are kept."""


class SmoothPlant:
    """Plant with smooth laws, read and driven: u are the torques of inputs, those of the laws, and the scales."""

    def __init__(
        self, split: SplitPlant, readings: Sequence[Functional], inputs: Sequence[Input], driving: Driving
    ) -> None:
        plant = split.plant
        self.split, self.readings, self.inputs, self.driving = split, readings, inputs, driving
        columns = np.array([plant.assembly.rows_of(channel.row)[0] for channel in inputs]).reshape(len(inputs), -1).T
        n_q = len(columns)
        n_in = columns.shape[1]
        own = -np.array([smooth.row for smooth in split.smooth]).reshape(-1, n_q).T
        self.first_scale = n_in + len(split.smooth)
        scale_of = tuple(-1 if scale < 0 else self.first_scale + scale for scale in split.scale_of)
        n_u = self.first_scale + len(split.scales)
        drive = Drive(np.hstack([columns, own]), scale_of, len(split.scales), np.zeros((0, 0)), np.zeros((n_u, 0)))
        self.at = Layout(n_q, sum(len(action.F) for action in plant.actions), 0, n_u)
        self.states = ContactStates(plant, split.phases, drive, self.at, relative=True)
        self.outside = np.array([*range(n_in), *range(self.first_scale, n_u)], dtype=int)
        self.places = list(range(n_in, self.first_scale))
        self.lagging = [number for number, smooth in enumerate(split.smooth) if smooth.lag > 0]
        self._known: dict[Contact, SmoothContact] = {}
        self._forces: dict[Contact, tuple[SmoothLaw, ...]] = {}

    def contact(self, contact: Contact) -> SmoothContact:
        """Contact state with its equations and rows, made when first asked for."""
        if contact not in self._known:
            if len(self._known) >= MOST_CONTACTS:
                self._known.clear()
            self._known[contact] = smooth_contact(
                self.states, contact, self.split.smooth, self.places, self.readings, self.inputs
            )
        return self._known[contact]

    def first_contact(self, z: FloatArray) -> Contact:
        """Contact state of a motion that begins at z."""
        rows = np.array([law.row for law in self.split.plant.laws]).reshape(-1, self.at.n_q)
        scales = np.array([1.0 if scale < 0 else z[self.at.u][scale] for scale in self.states.drive.scale_of])
        first = self.states.at_start(rows @ z[self.at.q], rows @ z[self.at.v], scales)
        begun = relative_state(self.split.plant, self.at, z) / in_steps(self.at, self.states.h)
        return self.states.fixed(first, begun)

    def states_of(self, now: SmoothContact, z: FloatArray, lags: FloatArray) -> FloatArray:
        """States y from z, and from the torques (n_lags,) in N m of laws that lag."""
        return np.concatenate([now.form.take @ z, lags])

    def settled(self, now: SmoothContact, z: FloatArray) -> FloatArray:
        """Torques (n_lags,) in N m of laws that lag, after a long time at the motion z."""
        u = np.zeros(self.at.n_u)
        u[self.outside] = self.driving.first
        return self._targets([rows @ z for rows in now.form.motions], u)

    def lags_in(self, y: FloatArray) -> FloatArray:
        """Torques (n_lags,) in N m of laws that lag, in states y."""
        return y[len(y) - len(self.lagging) :]

    def outside_at(self, time: float, stretch: Stretch | None) -> tuple[FloatArray, FloatArray]:
        """Entries u (n_u,) and their rates of change without the laws, at a time in s of a stretch or at the start."""
        u, slopes = np.zeros(self.at.n_u), np.zeros(self.at.n_u)
        if stretch is None:
            u[self.outside] = self.driving.first
        else:
            value, slope = stretch.at(np.array([time]))
            u[self.outside], slopes[self.outside] = value[:, 0], slope[:, 0]
        return u, slopes

    def whole(self, now: SmoothContact, time: float, y: FloatArray, stretch: Stretch | None) -> FloatArray:
        """State z at a time in s, with the torques of the smooth laws and their rates of change in it."""
        u, slopes = self.outside_at(time, stretch)
        own = y[: len(now.form.A)]
        motions = self._torques(now, y, u, slopes)
        z = now.form.whole(own, u, slopes)
        # The accelerations first, from which follows how the torques change, and z once more with that.
        if now.needs_slopes:
            self._bend(now, y, u, slopes, motions, now.form.form.motion[2] @ z)
            z = now.form.whole(own, u, slopes)
        return z

    def whole_states(
        self, now: SmoothContact, course: Callable[[FloatArray], FloatArray], times: FloatArray, stretch: Stretch
    ) -> FloatArray:
        """States z (N, n) at times (n,) in s of a course of y."""
        Y = course(times)
        if not self.split.smooth or now.needs_slopes:
            pairs = zip(times.tolist(), Y.T, strict=True)
            return np.array([self.whole(now, time, y, stretch) for time, y in pairs]).T
        u, slopes = np.zeros((self.at.n_u, len(times))), np.zeros((self.at.n_u, len(times)))
        u[self.outside], slopes[self.outside] = stretch.at(times)
        for number in range(len(times)):
            self._torques(now, Y[:, number], u[:, number], slopes[:, number])
        return now.form.whole(Y[: len(now.form.A)], u, slopes)

    def right_side(self, now: SmoothContact, stretch: Stretch) -> Callable[[float, FloatArray], FloatArray]:
        """Rates of change of y over the time in s and y, in one contact state and stretch."""
        form = now.form
        A, n = form.A, len(form.A)
        active = [
            (place, law, rows @ form.over_y, rows @ form.over_u, rows @ form.over_s)
            for place, law, rows in zip(self.places, self._in_force(now.contact), form.motions, strict=True)
            if self._active(law, now.contact)
        ]
        at_once = [row for row in active if not row[1].lag]
        late = [row for row in active if row[1].lag]
        steady = not stretch.waves and not stretch.slopes.any()
        u0, none = self.outside_at(stretch.start, stretch)

        def rates(time: float, y: FloatArray) -> FloatArray:
            u, slopes = (u0.copy(), none) if steady else self.outside_at(time, stretch)
            own = y[:n]
            for row, torque in zip(late, y[n:].tolist(), strict=True):
                u[row[0]] = torque
            try:
                for place, law, over_y, over_u, over_s in at_once:
                    u[place] = self._torque(law, over_y @ own + over_u @ u + over_s @ slopes, u)
                # A torque that lags: T' = (T_curve - T) / lag.
                changes = [
                    (self._torque(law, over_y @ own + over_u @ u + over_s @ slopes, u) - u[place]) / law.lag
                    for place, law, over_y, over_u, over_s in late
                ]
            except OverflowError:
                # Where a torque begins the first trial step may be far too long: the method shortens what has no error.
                return np.full(len(y), np.nan)
            # y' = A y + U u + S u'
            return np.concatenate([A @ own + form.U @ u + form.S @ slopes, changes])

        return rates

    def stored_energy(self, now: SmoothContact, z: FloatArray) -> float:
        """Kinetic energy and energy stored in springs in J."""
        plant = self.split.plant
        system = plant.assembly.system
        q, v = (rows @ z for rows in now.form.form.motion[:2])
        twists, rates = system.rows @ q, system.rows @ v
        linear = np.array([not isinstance(law, PlacedLaw) for law in plant.assembly.laws], dtype=bool)
        # sum of J gamma'^2 / 2 and k gamma^2 / 2 of linear laws; laws of motion add energies of their own.
        energy = 0.5 * float(system.inertia @ rates**2 + system.stiffness[linear] @ twists[linear] ** 2)
        laws = [(placed.law, placed.row) for placed in plant.laws]
        laws += [(smooth.law, smooth.row) for smooth in self.split.smooth if smooth.held < 0]
        energy += sum(float(law.energy(float(row @ q))) for law, row in laws)
        return energy + sum(remembered_energies(self.states, now.contact, z).values())

    def rows_left(self, now: SmoothContact, z: FloatArray) -> tuple[str, str]:
        """Element whose motion at z lies beyond an end of its curve, and the message; both empty without one."""
        for law, rows in zip(self.split.smooth, now.form.motions, strict=True):
            motion = rows @ z
            message = law.left(float(motion[0]), motion[1:])
            if message:
                return law.owner, message
        return "", ""

    def quickest(self, now: SmoothContact, z: FloatArray) -> str:
        """Element of the smooth law whose motion at z is quickest."""
        sizes = [
            (float(np.abs(rows @ z).max()), law.owner)
            for law, rows in zip(self.split.smooth, now.form.motions, strict=True)
        ]
        return max(sizes)[1] if sizes else "the drivetrain"

    def _in_force(self, contact: Contact) -> tuple[SmoothLaw, ...]:
        """Smooth laws of a contact state, those with steps on the piece of their curve that is in force there."""
        if contact not in self._forces:
            if len(self._forces) >= MOST_CONTACTS:
                self._forces.clear()
            places = [None if law.held < 0 else self._phase(law, contact).place for law in self.split.smooth]
            self._forces[contact] = tuple(
                law.on_piece(place) if place is not None and self._active(law, contact) else law
                for law, place in zip(self.split.smooth, places, strict=True)
            )
        return self._forces[contact]

    def _phase(self, law: SmoothLaw, contact: Contact) -> Phase:
        return self.states.laws[law.held].phases[contact[law.held]]

    def _active(self, law: SmoothLaw, contact: Contact) -> bool:
        return law.held < 0 or self._phase(law, contact).kind == "slope"

    def _scale(self, law: SmoothLaw, u: FloatArray) -> float:
        return 1.0 if law.scale < 0 else float(u[self.first_scale + law.scale])

    def _torque(self, law: SmoothLaw, motion: FloatArray, u: FloatArray) -> float:
        return law.torque(float(motion[0]), motion[1:], self._scale(law, u))

    def _targets(self, motions: Sequence[FloatArray], u: FloatArray) -> FloatArray:
        return np.array([self._torque(self.split.smooth[number], motions[number], u) for number in self.lagging])

    def _torques(self, now: SmoothContact, y: FloatArray, u: FloatArray, slopes: FloatArray) -> list[FloatArray]:
        """Write the torques of the smooth laws into u (n_u,); twist and rates of each."""
        form, own = now.form, y[: len(now.form.A)]
        for number, torque in zip(self.lagging, self.lags_in(y).tolist(), strict=True):
            u[self.places[number]] = torque
        motions = []
        for place, law, rows in zip(self.places, self._in_force(now.contact), form.motions, strict=True):
            motion = rows @ (form.over_y @ own + form.over_u @ u + form.over_s @ slopes)
            motions.append(motion)
            if not law.lag and self._active(law, now.contact):
                u[place] = self._torque(law, motion, u)
        return motions

    def _bend(
        self, now: SmoothContact, y: FloatArray, u: FloatArray, slopes: FloatArray, motions: Sequence[FloatArray],
        bent: Any,
    ) -> None:  # fmt: skip
        """Write the rates of change of the torques of the smooth laws, at accelerations (n_q,), into slopes (n_u,)."""
        late = iter(zip(self._targets(motions, u), self.lags_in(y), strict=True))
        for place, law, motion in zip(self.places, self._in_force(now.contact), motions, strict=True):
            if law.lag:
                target, torque = next(late)
                slopes[place] = (target - torque) / law.lag
            elif self._active(law, now.contact):
                rows = np.vstack([law.row, law.sensed])
                slopes[place] = law.slope(float(motion[0]), motion[1:], rows @ bent, self._scale(law, u))
                # (scale T)' has a part scale' T beside scale T'.
                if law.scale >= 0:
                    changed = float(slopes[self.first_scale + law.scale])
                    slopes[place] += law.torque(float(motion[0]), motion[1:], changed)
