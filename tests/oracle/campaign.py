"""Draw models, ask, compare, count."""

from __future__ import annotations

import random
from collections.abc import Iterable

import torsionnet as tn
from oracle.calls import Context, called, failed
from oracle.comparing_cuts import compare_measured_poles
from oracle.comparing_poles import compare_poles
from oracle.comparing_responses import compare_responses, parametric, respond, symbols
from oracle.description import Model
from oracle.drawing import draw
from oracle.package import configured, drivetrain
from oracle.questions import frequencies, measured_questions, refused_questions, response_questions, symbolic_questions
from oracle.roles import roles
from oracle.solution import Mechanics
from oracle.tally import Tally

MOST_PARAMETRIC, MOST_SYMBOLIC = 14, 7
"""Nodes up to which a model is also asked so."""
SHARES = {"configured": 0.2, "dense": 0.1, "compiled": 0.1, "parametric": 0.2, "symbols": 0.3}
"""How many of the models."""


def compare(seed: str, tally: Tally) -> None:
    """One model, in all quantities."""
    chance = random.Random(f"questions {seed}")
    compare_model(seed, draw(seed), chance, tally)


def compare_model(seed: str, model: Model, chance: random.Random, tally: Tally) -> None:
    mechanics = Mechanics(model)
    tally.models += 1
    tally.roles.update(roles(mechanics))
    changed = chance.random() < SHARES["configured"]
    built = called(lambda: configured(model, (0.5, 3.0, 1.7)) if changed else drivetrain(model))
    context = Context(seed, mechanics, built.value, tally)
    if failed(context, "building", built):
        return
    lowest = chance.choice((0, 1, 2, 5, 20))
    f = frequencies(compare_poles(context, lowest), chance)
    _compare_responses(context, f, chance)
    for asked in measured_questions(mechanics, chance):
        alone = len(asked.inputs) == 1
        name = "measured input" if alone else "several measured inputs"
        compare_responses(context, name, asked, [0.0, *f], respond(built.value), exact_zeros=alone)
        compare_measured_poles(context, asked)
    for asked in refused_questions(mechanics, chance):
        _expect_refusal(context, asked)
    if len(model.nodes) <= MOST_SYMBOLIC and chance.random() < SHARES["symbols"]:
        call = symbols(context)
        for asked in symbolic_questions(mechanics, chance):
            compare_responses(context, "symbols", asked, f[::3], call, exact_zeros=False)


def _compare_responses(context: Context, f: list[float], chance: random.Random) -> None:
    asked = response_questions(context.mechanics, chance)
    compare_responses(context, "responses", asked, [0.0, *f], respond(context.drivetrain))
    for method in ("dense", "compiled"):
        if chance.random() < SHARES[method]:
            call = respond(context.drivetrain, method=method)
            compare_responses(context, f"responses, {method}", asked, f, call, exact_zeros=method == "compiled")
    if len(context.mechanics.nodes) <= MOST_PARAMETRIC and chance.random() < SHARES["parametric"]:
        call = parametric(context, chance)
        if call:
            compare_responses(context, "parametric", asked, f, call, exact_zeros=False)


def _expect_refusal(context: Context, asked: tuple[str, str]) -> None:
    """A torque that the elements of a rigid loop could share in any way."""
    outcome = called(lambda: context.drivetrain.frequency_response(*asked, [1.0]))
    if isinstance(outcome.error, tn.UsageError):
        context.refused("indeterminate torques")
    else:
        context.wrong("indeterminate torques", f"{asked}", "refused", f"{outcome.value} {outcome.error!r}")


def run(seeds: Iterable[str]) -> Tally:
    tally = Tally()
    for seed in seeds:
        compare(seed, tally)
    return tally
