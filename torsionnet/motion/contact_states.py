"""Contact states that a motion has visited, with their equations and tables, and what follows on an event."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError, UsageError, did_you_mean
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.motion.contact_form import (
    NEGLIGIBLE_ENTRY,
    ContactForm,
    LooseMotionError,
    Slip,
    balanced_slips,
    contact_form,
    relative_form,
)
from torsionnet.motion.march_tables import (
    GUARDS_PER_LAW,
    HOLD_TOLERANCE,
    LOWER,
    MOST_BYTES,
    MOST_TURN,
    PUSH,
    MarchTable,
    StepMatrices,
    guard_count,
    guard_rows,
    in_steps,
    march_table,
    step_matrices,
    table_steps,
)
from torsionnet.motion.motion_plant import Drive, LawPhases, Layout, MotionPlant, Phase
from torsionnet.motion.smooth_laws import ChainPhases

# State of motion from which a simulation starts.


@dataclass(frozen=True)
class MotionStart:
    """Angles in rad and speeds in rad/s of nodes at the first sample of a simulation; nodes not named stand at zero.

    Attributes
    ----------
    angles : mapping
        Node -> rad.
    speeds : mapping
        Node -> rad/s.

    Examples
    --------
    >>> MotionStart(speeds={"rotor": 2.0}).speeds["rotor"]
    2.0
    """

    angles: Mapping[str, float] = field(default_factory=dict)
    speeds: Mapping[str, float] = field(default_factory=dict)


# State of a motion at its start from given angles and speeds of nodes.


def start_state(plant: MotionPlant, at: Layout, start: MotionStart) -> FloatArray:
    """State z (N,) in SI units of given angles and speeds of nodes.

    Raises
    ------
    UsageError
        Unknown nodes, numbers that are not finite, or nodes that rigid connections tie to others with another motion.
    """
    assembly = plant.assembly
    for name in (*start.angles, *start.speeds):
        if name not in assembly.node_index:
            raise UsageError(f'no node is named "{name}"{did_you_mean(name, assembly.nodes)}', kind="unknown-node")
    z = np.zeros(at.size)
    z[at.constant] = 1.0
    for place, given in ((at.q, start.angles), (at.v, start.speeds)):
        if not given:
            continue
        # nodes not named follow those tied to them; free ones stand
        named = [assembly.node_index[name] for name in given]
        wanted = np.array([_number(name, value) for name, value in given.items()])
        rows = assembly.T[named]
        motion = np.linalg.lstsq(rows, wanted, rcond=None)[0]
        if np.abs(rows @ motion - wanted).max() > 1e-9 * np.abs(wanted).max(initial=1e-300):
            names = ", ".join(given)
            raise UsageError(
                f"{names} cannot start with these angles or speeds: rigid connections tie them",
                kind="contradicting-values",
            )
        z[place] = motion
    return z


def _number(name: str, value: float) -> float:
    if not (isinstance(value, int | float | np.number) and np.isfinite(value)):
        raise UsageError(
            f"a motion starts with finite angles in rad and speeds in rad/s; that of {name} is {value}",
            kind="not-finite",
        )
    return float(value)


def relative_state(plant: MotionPlant, at: Layout, z: FloatArray) -> FloatArray:
    """State z with coordinates counted from those that turn with the whole, from one with all angles."""
    relative = z.copy()
    for pivot, column in plant.turning:
        for place in (at.q, at.v):
            others = np.where(np.arange(at.n_q) == pivot, 0.0, column)
            relative[place] -= others * z[place][pivot]
    return relative


def absolute_rates(plant: MotionPlant, rates: FloatArray) -> FloatArray:
    """Rates (n_q,) of coordinates from those counted from what turns with the whole."""
    absolute = rates.copy()
    for pivot, column in plant.turning:
        absolute += np.where(np.arange(len(rates)) == pivot, 0.0, column) * rates[pivot]
    return absolute


Contact = tuple[int, ...]

LONGEST_BOUNCE = 0.05
"""Longest flight in steps from which a row that returns to a step over the twist stays there. Its bounces against a
damper shorten for ever, so that some flight has to be the last; in this one the twist strays by less than
a (0.05 h)^2/8 = 3e-4 a h^2 and the relative motion of all masses behind it loses what it has of energy."""
TOLERANCE = 1e-12
"""Share of the sizes of its terms by which a twist beyond a step may seem to lie before it by rounding."""
SLACK = 1.25
"""Share by which the motion of a contact state visited later may be quicker than the step was made for."""
FIRST_STATES = 64
"""Number of contact states for which there is room at first: memory that nothing is written to is free, and to copy
the tables of a large drivetrain into a larger room takes longer than to make them."""


class FinerStepError(Exception):
    """Signal that a contact state moves quicker than the steps can follow, with its rates in rad/s."""

    def __init__(self, rates: tuple[float, float]) -> None:
        self.rates = rates
        super().__init__("the step is too long")


class ContactStates:
    """Contact states of a plant by number, in the order of their first visit, with stacked tables for the march.

    ``relative`` counts coordinates from those that turn with the whole, see :func:`.relative_form`.
    """

    def __init__(
        self, plant: MotionPlant, laws: Sequence[LawPhases], drive: Drive, at: Layout, *, relative: bool = False
    ) -> None:
        self.relative = relative
        self.plant, self.laws, self.drive, self.at = plant, tuple(laws), drive, at
        self._forms: dict[Contact, ContactForm] = {}
        self.h, self.n_sub = 1.0, 4
        self.numbers: dict[Contact, int] = {}
        self.contacts: list[Contact] = []
        self.tables: list[NDArray[Any]] = []
        self.following: NDArray[np.int64] = np.zeros((0, guard_count(len(self.laws))), dtype=np.int64)

    def with_steps(self, h: float, n_sub: int) -> None:
        """Begin again with steps of h seconds, with ``n_sub`` points in each."""
        self.h, self.n_sub = h, n_sub
        self.clear()

    def clear(self) -> None:
        """Forget all tables."""
        self.numbers, self.contacts, self.tables = {}, [], []
        self.following = np.zeros((0, guard_count(len(self.laws))), dtype=np.int64)

    @property
    def is_large(self) -> bool:
        """Whether the tables take more memory than they may."""
        return sum(array.nbytes for array in self.tables) * len(self.contacts) > MOST_BYTES * max(
            map(len, self.tables), default=1
        )

    def form(self, contact: Contact) -> ContactForm:
        """Equations of motion in a contact state in SI units, made when first asked for."""
        if contact not in self._forms:
            if len(self._forms) * self.at.size**2 * 16 > MOST_BYTES:
                self._forms.clear()
            form = contact_form(self.plant, self.laws, contact, self.drive)
            self._forms[contact] = relative_form(self.plant, self.at, form) if self.relative else form
        return self._forms[contact]

    def number(self, contact: Contact) -> int:
        """Number of a contact state, whose tables are made when it is first visited.

        Raises
        ------
        FinerStepError
            It moves quicker than the steps can follow.
        """
        if contact not in self.numbers:
            form = self.form(contact)
            turning, largest = form.largest_rates
            # Later contact states may be quicker by SLACK; beyond that all steps have to be shorter.
            if turning * self.h > SLACK or largest * self.h > SLACK * MOST_TURN * self.n_sub:
                raise FinerStepError((turning, largest))
            guards = guard_rows(form, self.laws, contact, self.at, self.drive.scale_of)
            self._add(march_table(form, guards, self.at, self.h, self.n_sub))
            self.numbers[contact] = len(self.contacts)
            self.contacts.append(contact)
        return self.numbers[contact]

    def steps(self, contact: Contact) -> StepMatrices:
        """Matrices of whole steps in a contact state."""
        if contact not in self.numbers:
            units = in_steps(self.at, self.h)
            A = self.h * self.form(contact).A * units / units[:, None]
            return step_matrices(np.asarray(scipy.linalg.expm(A)), self.at)
        return table_steps(self.tables, self.numbers[contact], self.at)

    def _add(self, table: MarchTable) -> None:
        place = len(self.contacts)
        if not self.tables:
            size = sum(array.nbytes for array in table.arrays)
            count = min(max(2, MOST_BYTES // size), FIRST_STATES)
            self.tables = [np.zeros((count, *array.shape), dtype=array.dtype) for array in table.arrays]
        elif place == len(self.tables[0]):
            self.tables = [_twice_as_long(stack) for stack in self.tables]
        if len(self.following) < len(self.tables[0]):
            grown = np.full((len(self.tables[0]), self.following.shape[1]), -1, dtype=np.int64)
            grown[: len(self.following)] = self.following
            self.following = grown
        for stack, array in zip(self.tables, table.arrays, strict=True):
            stack[place] = array

    def values(self, z: FloatArray, contact: Contact) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Twists in rad, rates in rad/s and torques in N m of all laws in a contact state, of a state z in steps.

        The state is refreshed first.
        """
        form = self.form(contact)
        whole = form.refresh @ (z * in_steps(self.at, self.h))
        return form.twists @ whole, form.rates @ whole, form.torques @ whole

    def at_start(self, twists: FloatArray, rates: FloatArray, scales: FloatArray) -> Contact:
        """Contact state of rows at rest or in motion, (n_laws,) each in SI units; ``scales`` of all laws."""
        given = zip(self.laws, twists.tolist(), rates.tolist(), scales.tolist(), strict=True)
        return tuple(self._at(*motion) for motion in given)

    def _at(self, law: LawPhases, twist: float, rate: float, scale: float) -> int:
        if isinstance(law, ChainPhases):
            return law.begun(twist, rate)
        at, trend = (rate, 0.0) if law.over_rate else (twist, rate)
        place = 0
        for phase in law.phases:
            # On a step itself: held at rest if the step has a width, else on the side to which the motion goes.
            if phase.kind == "hold" and at == phase.lower:
                wide = scale * (phase.high - phase.low) > 0
                place = phase.place + (0 if trend == 0 and wide else -1 if trend < 0 else 1)
                break
            if at >= phase.lower and phase.kind == "slope":
                place = phase.place
        return self._phase(law, place, twist, rate)

    def fixed(self, contact: Contact, z: FloatArray) -> Contact:
        """Contact state in which friction fixes what has neither inertia nor anything else that does, at z in steps.

        Raises
        ------
        LooseMotionError
            Its torques are greater than all friction beside it.
        """
        try:
            self.form(contact)
        except LooseMotionError as loose:
            return self._balanced(contact, z, loose)
        return contact

    def _balanced(self, contact: Contact, z: FloatArray, loose: LooseMotionError) -> Contact:
        plant, at = self.plant, self.at
        rates = (z * in_steps(at, self.h))[at.v]
        rates = absolute_rates(plant, rates) if self.relative else rates
        # Torques on the loose motions: those from outside, and of laws that cannot stick.
        outside = self.drive.columns.T @ loose.motions
        u = z[at.u] + self.drive.S @ z[at.w]
        torques = u[: len(outside)] @ outside
        slips: dict[int, Slip] = {}
        for number, (law, own) in enumerate(zip(self.laws, plant.laws, strict=True)):
            phase, way, scale = law.phases[contact[number]], own.row @ loose.motions, self._scale(number, z)
            if phase.kind == "hold" or not (np.abs(way) > NEGLIGIBLE_ENTRY * np.abs(own.row).max()).any():
                continue
            hold = next((at for at in law.phases if law.over_rate and at.kind == "hold" and at.lower == 0), None)
            torque = scale * phase.torque
            if hold is None:
                torques -= torque * way
            else:
                # The torque of friction has the sign of the side on which its rate lies.
                sign = -1 if phase.place < hold.place else 1
                slips[number] = Slip(way, float(own.row @ rates), sign, abs(torque), scale * hold.high)
        left = balanced_slips(list(slips.values()), torques)
        if left is None:
            raise loose
        for number, rate in zip(slips, left.tolist(), strict=True):
            contact = _changed(contact, number, self._at(self.laws[number], 0.0, rate, 1.0))
        return self.fixed(contact, z)

    @staticmethod
    def _phase(law: LawPhases, place: int, twist: float, rate: float) -> int:
        number = law.of_piece(place)
        phase = law.phases[number]
        loose = phase.side * phase.at(twist, rate) < 0 and phase.kind == "slope"
        return law.of_piece(place, "free") if loose else number

    def state_after(self, contact: Contact, guard: int, z: FloatArray, time: float) -> tuple[Contact, bool]:
        """Contact state after an event at a state z in steps, and whether that always follows on this event.

        Raises
        ------
        SolveError
            A row leaves the last piece of its curve.
        UsageError
            Rows stick in a loop, or nothing fixes what has no inertia.
        """
        following, always = self._following(contact, guard, z, time)
        fixed = self.fixed(following, z)
        return fixed, always and fixed == following

    def _following(self, contact: Contact, guard: int, z: FloatArray, time: float) -> tuple[Contact, bool]:
        number, kind = divmod(guard, GUARDS_PER_LAW)
        law, phase = self.laws[number], self.laws[number].phases[contact[number]]
        if isinstance(law, ChainPhases):
            if kind != PUSH:
                return _changed(contact, number, law.passed_corner()), True
            turned = law.turned(float(self.values(z, contact)[0][number]))
            return _changed(contact, number, turned), False
        if kind == PUSH:
            # The torque of a contact passes zero: it opens within the overlap, or closes again.
            other = "free" if phase.kind == "slope" else ""
            return _changed(contact, number, law.of_piece(phase.place, other)), True
        step = -1 if kind == LOWER else 1
        place = phase.place + step
        if not 0 <= place <= law.last_place:
            what, unit = ("rate", "rad/s") if law.over_rate else ("twist", "rad")
            end = phase.lower if step < 0 else phase.upper
            text = f"at {time:.6g} s its {what} passes {end:.6g} {unit}, where its rows end"
            raise SolveError(
                f"{law.owner}: {text}; give rows for the motion beyond, or a smaller torque", kind="beyond-table"
            )
        target = law.phases[law.of_piece(place)]
        if target.kind == "hold" and phase.kind != "hold":
            return self._at_hold(contact, number, target, step, z), False
        if target.side and target.side == phase.side:
            twists, rates, _ = self.values(z, contact)
            return _changed(contact, number, self._phase(law, place, twists[number], rates[number])), False
        return _changed(contact, number, law.of_piece(place)), True

    def _at_hold(self, contact: Contact, number: int, hold: Phase, step: int, z: FloatArray) -> Contact:
        law = self.laws[number]
        beyond = _changed(contact, number, law.of_piece(hold.place + step))
        held = _changed(contact, number, law.of_piece(hold.place))
        scale = self._scale(number, z)
        if scale <= 0 and hold.high > hold.low and law.over_rate:  # a clamp that closes holds from zero on
            z, scale = self._changes(held, number, z)
        low, high = scale * hold.low, scale * hold.high
        # A step without width holds nothing, one over the twist only what would be back at once.
        if high <= low or not (law.over_rate or self._returns(beyond, number, hold.lower, step, z)):
            return beyond
        # Held while the torque for it lies between both ends of the step; else it goes on to where it pushes.
        torque = self.values(z, held)[2][number]
        rounding = HOLD_TOLERANCE * max(abs(low), abs(high))
        if torque > high + rounding or torque < low - rounding:
            return _changed(contact, number, law.of_piece(hold.place + (1 if torque > high else -1)))
        return held

    def _changes(self, held: Contact, number: int, z: FloatArray) -> tuple[FloatArray, float]:
        """Rate of change of the state z in steps where a row is held, and of its scale, by which both soon differ.

        The scale is zero where the row already needs a torque to be held.
        """
        form, units = self.form(held), in_steps(self.at, self.h)
        whole = form.refresh @ (z * units)
        needed, terms = form.torques[number] @ whole, np.abs(form.torques[number]) @ np.abs(whole)
        if abs(needed) > TOLERANCE * terms:
            return z, 0.0
        changed = form.A @ whole / units
        return changed, self._scale(number, changed)

    def _returns(self, beyond: Contact, number: int, twist: float, step: int, z: FloatArray) -> bool:
        """Whether a row that has passed a step over the twist is back at once, or never gets beyond without inertia."""
        form = self.form(beyond)
        whole = form.refresh @ (z * in_steps(self.at, self.h))
        # Rounding of the twist against the place of the step.
        there, rate = float(form.twists[number] @ whole), float(form.rates[number] @ whole) * step
        terms = float(np.abs(form.twists[number]) @ np.abs(whole)) + abs(twist)
        if (there - twist) * step < -TOLERANCE * terms or rate <= 0:
            return True
        # Flight time 2 rate / back: the last bounce is one shorter than LONGEST_BOUNCE steps.
        back = -float(form.accelerations[number] @ whole) * step
        return back > 0 and 2 * rate < LONGEST_BOUNCE * self.h * back

    def _scale(self, number: int, z: FloatArray) -> float:
        place = self.drive.scale_of[number]
        if place < 0:
            return 1.0
        inputs: Any = self.drive.S[place] @ z[self.at.w]
        return float(z[self.at.u][place] + inputs)

    def changes(self, before: Contact, after: Contact) -> tuple[tuple[str, str], ...]:
        """Elements and changes in words between two contact states, of those to tell."""
        laws = zip(self.laws, before, after, strict=True)
        words = [(law.owner, _in_words(law, law.phases[a], law.phases[b])) for law, a, b in laws if a != b]
        return tuple(change for change in words if change[1])


def _twice_as_long(stack: NDArray[Any]) -> NDArray[Any]:
    longer = np.zeros((2 * len(stack), *stack.shape[1:]), dtype=stack.dtype)
    longer[: len(stack)] = stack
    return longer


def _changed(contact: Contact, number: int, phase: int) -> Contact:
    return (*contact[:number], phase, *contact[number + 1 :])


def _in_words(law: LawPhases, before: Phase, after: Phase) -> str:
    if law.over_rate:
        if "hold" in (before.kind, after.kind):
            return "sticks" if after.kind == "hold" else "slips"
        return "reverses" if abs(after.place - before.place) > 1 else ""
    if "hold" in (before.kind, after.kind):
        return "stands" if after.kind == "hold" else "moves on"
    touching, touched = (bool(phase.side) and phase.kind == "slope" for phase in (after, before))
    if touching != touched:
        return "closes" if touching else "opens"
    if before.kind == "free" or after.kind == "free" or after.sense:
        return ""
    return phrase("stage {number}", number=_stage(law, after))


def _stage(law: LawPhases, phase: Phase) -> int:
    """Number of a stage, counted from 1 at the piece without twist."""
    slopes = [slope for slope in law.phases if slope.kind == "slope"]
    home = min(range(len(slopes)), key=lambda place: _distance(slopes[place]))
    here = next(place for place, slope in enumerate(slopes) if slope.place == phase.place)
    still = [place for place, slope in enumerate(slopes) if _distance(slope) == _distance(slopes[home])]
    return 1 + min(abs(here - place) for place in still)


def _distance(phase: Phase) -> float:
    return max(phase.lower, -phase.upper, 0.0) if math.isfinite(phase.lower) or math.isfinite(phase.upper) else 0.0
