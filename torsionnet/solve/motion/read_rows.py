"""Rows over the state of a contact state for what sensors read."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from torsionnet.assembly.functionals import Functional, Term, powers_of_s
from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import UsageError
from torsionnet.model.channels import Input
from torsionnet.solve.dynamic_stiffness.state_space import action_share
from torsionnet.solve.motion.contact_form import ContactForm, Layout
from torsionnet.solve.motion.motion_plant import MotionPlant, PlacedLaw


def reading_rows(
    plant: MotionPlant, readings: Sequence[Functional], inputs: Sequence[Input], form: ContactForm, at: Layout
) -> FloatArray:
    """Rows (n_out, N) of readings in SI units over the state z of a contact state.

    Raises
    ------
    UsageError
        The torque of a law on a rigid connection is read.
    """
    found = np.zeros((len(readings), at.size))
    for number, reading in enumerate(readings):
        for term in reading.terms:
            found[number] += float(term.factor) * _term(plant, term, form, at)
        for place, channel in enumerate(inputs):
            found[number] += float(reading.direct(channel.row)) * form.inputs[place]
        for action, torque in zip(plant.actions, form.act, strict=True):
            found[number] += action_share(plant.assembly, reading, action) * torque
    return found


def _term(plant: MotionPlant, term: Term, form: ContactForm, at: Layout) -> FloatArray:
    law = None if term.law is None else plant.assembly.laws[term.law]
    if isinstance(law, PlacedLaw):
        for one, torque in zip(plant.laws, form.torques, strict=True):
            if one.number == term.law:
                return np.asarray(torque)
        owner = plant.assembly.owners[term.law or 0]
        raise UsageError(f"{owner}: rigid connections hold its twist still, so that its torque is not determined")
    factors = [float(value) for value in powers_of_s(plant.assembly, term)]
    return np.asarray(
        sum(factor * (term.row @ part) for factor, part in zip(factors, form.motion, strict=True) if factor)
        + np.zeros(at.size)
    )
