"""Energy stored in a plant at a state of motion, as squares of rows over the state z and energies of laws of motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.model.elements import MotionLaw
from torsionnet.motion.contact_states import Contact, ContactStates
from torsionnet.motion.march_tables import in_steps
from torsionnet.motion.motion_plant import PlacedLaw


@dataclass(frozen=True, eq=False)
class EnergyRows:
    """Rows over z whose squares times weights are energies in J, and laws of motion with rows of their twists."""

    squares: FloatArray
    weights: FloatArray
    laws: tuple[MotionLaw, ...]
    twists: FloatArray

    def at(self, Z: FloatArray) -> FloatArray:
        """Kinetic energy and energy stored in springs in J, shape (n,), at states Z (N, n)."""
        found = self.weights @ (self.squares @ Z) ** 2
        for law, twists in zip(self.laws, self.twists @ Z, strict=True):
            found += [float(law.energy(twist)) for twist in twists.tolist()]
        return np.asarray(found)


def energy_rows(states: ContactStates, contact: Contact) -> EnergyRows:
    """Energy rows of a contact state over a state z that counts time in steps."""
    plant, at = states.plant, states.at
    form, system = states.form(contact), plant.assembly.system
    refresh = form.refresh * in_steps(at, states.h)
    position, speed = (rows @ refresh for rows in form.motion[:2])
    linear = np.array([not isinstance(law, PlacedLaw) for law in plant.assembly.laws], dtype=bool)
    squares = np.vstack([system.rows @ speed, system.rows @ position])
    weights = np.concatenate([system.inertia, system.stiffness * linear]) / 2
    storing = [number for number, one in enumerate(plant.laws) if one.law.curve.over == "twist"]
    laws = tuple(plant.laws[number].law for number in storing)
    return EnergyRows(squares[weights != 0], weights[weights != 0], laws, form.twists[storing] @ refresh)


def stored_energy(states: ContactStates, contact: Contact, z: FloatArray) -> float:
    """Kinetic energy and energy stored in springs in J at a state z, which counts time in steps."""
    return float(energy_rows(states, contact).at(z[:, None])[0])
