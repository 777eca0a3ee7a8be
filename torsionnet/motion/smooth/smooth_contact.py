"""Contact states of a smooth motion: equations, guards, readings, and powers by element, as rows over the state z."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.linear.assembly.law_stiffness import Functional
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.model.channels import Input
from torsionnet.motion.contact_form import ContactForm
from torsionnet.motion.contact_states import Contact, ContactStates
from torsionnet.motion.march_tables import guard_rows
from torsionnet.motion.motion_plant import LawRow, PlacedLaw
from torsionnet.motion.read_rows import reading_rows
from torsionnet.motion.smooth.smooth_form import SmoothForm, smooth_form
from torsionnet.motion.smooth_laws import SmoothLaw


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
    for place, one in zip(places, laws, strict=True):
        if one.held >= 0:
            torques[one.held] = torques[one.held] + ones[place]
    mine = [(place, one) for place, one in zip(places, laws, strict=True) if one.held < 0]
    rows = (LawRow(one.owner, one.law, one.number, one.row) for _, one in mine)
    whole = replace(plant, laws=(*plant.laws, *rows))
    read = replace(bare, torques=np.array([*torques, *(ones[place] for place, _ in mine)]).reshape(-1, at.size))
    return reading_rows(whole, readings, inputs, read, at)


def _powers(
    states: ContactStates, contact: Contact, form: SmoothForm, laws: Sequence[SmoothLaw], places: Sequence[int],
    n_in: int,
) -> Powers:  # fmt: skip
    """Powers of dampers, of laws of motion, of controllers and of torques from outside."""
    plant, at, bare = states.plant, states.at, form.form
    found: list[tuple[FloatArray, FloatArray, float, str]] = []
    system, speed, one = plant.assembly.system, bare.motion[1], np.eye(at.size)[at.one]
    for number, law in enumerate(plant.assembly.laws):
        if system.damping[number] and not isinstance(law, PlacedLaw):
            rate = system.rows[number] @ speed
            found.append((rate, rate, float(system.damping[number]), plant.assembly.owners[number]))
    for number, (law_of, place) in enumerate(zip(states.laws, contact, strict=True)):
        phase, rate = law_of.phases[place], bare.rates[number]
        if law_of.over_rate:
            found.append((bare.torques[number], rate, 1.0, law_of.owner))
        elif phase.kind == "free":
            found.append((phase.torque * one + phase.stiffness * bare.twists[number], rate, -1.0, law_of.owner))
        elif phase.kind == "slope" and phase.damping:
            found.append((rate, rate, phase.damping, law_of.owner))
    ones = np.eye(at.size)[at.u]
    for place, smooth in zip(places, laws, strict=True):
        if smooth.over_rate:
            found.append((ones[place], smooth.row @ speed, 1.0, smooth.owner))
        elif smooth.number < 0:  # the torque on the row is -u
            found.append((ones[place], smooth.row @ speed, -1.0, ""))
    columns = states.drive.columns[:, :n_in].T
    found += [(row, column @ speed, 1.0, "") for row, column in zip(bare.inputs, columns, strict=False)]
    for action, torque in zip(plant.actions, bare.act, strict=True):
        found.append((torque, action.row @ speed, 1.0, ""))
    firsts, seconds = (np.array([one[side] for one in found]).reshape(-1, at.size) for side in (0, 1))
    return Powers(firsts, seconds, np.array([one[2] for one in found]), tuple(one[3] for one in found))
