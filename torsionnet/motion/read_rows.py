"""Rows over the state of a contact state for what sensors read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.law_stiffness import Functional, Term, powers_of_s
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.dynamic_stiffness.state_space import action_share
from torsionnet.model.channels import Input
from torsionnet.motion.contact_form import ContactForm
from torsionnet.motion.motion_plant import MotionPlant, PlacedLaw
from torsionnet.motion.state_layout import Layout


@dataclass(frozen=True, eq=False)
class ReadingPlan:
    """Parts of readings that are the same in every contact state, in floats.

    Attributes
    ----------
    terms : tuple of tuple
        For each reading its terms: factors (3,) of the angle, rate and acceleration of a row (n_q,), or None and the
        place of a law of motion with the factor of its torque.
    direct : (n_out, n_in) array
        Shares of torques from outside.
    actions : (n_out, n_actions) array
        Shares of the torques of controllers.
    """

    terms: tuple[tuple[tuple[FloatArray | None, FloatArray, int], ...], ...]
    direct: FloatArray
    actions: FloatArray


def reading_plan(plant: MotionPlant, readings: Sequence[Functional], inputs: Sequence[Input]) -> ReadingPlan:
    """Plan of readings, which all contact states share.

    Raises
    ------
    UsageError
        The torque of a law on a rigid connection is read.
    """
    places = {one.number: place for place, one in enumerate(plant.laws)}
    direct = [[float(reading.direct(channel.row)) for channel in inputs] for reading in readings]
    actions = [[action_share(plant.assembly, reading, action) for action in plant.actions] for reading in readings]
    return ReadingPlan(
        tuple(tuple(_term(plant, term, places) for term in reading.terms) for reading in readings),
        np.array(direct).reshape(len(readings), len(inputs)),
        np.array(actions).reshape(len(readings), len(plant.actions)),
    )


def _term(plant: MotionPlant, term: Term, places: Mapping[int, int]) -> tuple[FloatArray | None, FloatArray, int]:
    number = -1 if term.law is None else term.law
    if number >= 0 and isinstance(plant.assembly.laws[number], PlacedLaw):
        if number not in places:
            owner = plant.assembly.owners[number]
            raise UsageError(f"{owner}: rigid connections hold its twist still, so that its torque is not determined")
        return None, np.array([float(term.factor)]), places[number]
    factors = [float(term.factor) * float(value) for value in powers_of_s(plant.assembly, term)]
    return term.row, np.array(factors), -1


def reading_rows(
    plant: MotionPlant,
    readings: Sequence[Functional],
    inputs: Sequence[Input],
    form: ContactForm,
    at: Layout,
    plan: ReadingPlan | None = None,
) -> FloatArray:
    """Rows (n_out, N) of readings in SI units over the state z of a contact state.

    ``plan`` are the parts that are the same in every contact state, if known.

    Raises
    ------
    UsageError
        The torque of a law on a rigid connection is read.
    """
    plan = reading_plan(plant, readings, inputs) if plan is None else plan
    found = np.zeros((len(readings), at.size)) + plan.direct @ form.inputs[: plan.direct.shape[1]]
    found += plan.actions @ form.act
    for number, terms in enumerate(plan.terms):
        for row, factors, place in terms:
            if row is None:
                found[number] += factors[0] * form.torques[place]
                continue
            for factor, part in zip(factors, form.motion, strict=True):
                if factor:
                    found[number] += factor * (row @ part)
    return found
