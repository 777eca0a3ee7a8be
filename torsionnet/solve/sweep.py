"""The numbers of an elimination plan: every operation on a vector of lanes at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.solve.doubt import Array, Doubt
from torsionnet.solve.plan import Plan, Reaction, Step


@dataclass
class Sweep:
    """Values (n_read, n_exc, n_lanes), and a mask (n_lanes,) of lanes that have lost digits."""

    values: Array
    doubtful: NDArray[np.bool_]


def sweep(plan: Plan, kappa: Array) -> Sweep:
    """Eliminate, and go back along the rows that were asked for.

    Parameters
    ----------
    plan : Plan
    kappa : (n_laws, n_lanes) array
        Dynamic stiffness of every law.
    """
    doubt = Doubt(kappa.shape[-1])
    links: list[Any] = [_gathered(kappa, source, doubt) for source in plan.sources]
    links += [None] * (plan.n_slots - len(links))
    weights, kept = _weights(plan), plan.read_slots
    back = [_eliminate(step, links, weights, kept, doubt) for step in plan.steps]
    values = _back(plan, back, doubt)
    found = np.zeros((len(plan.outputs) + len(plan.reactions), plan.n_excitations, kappa.shape[-1]), dtype=kappa.dtype)
    for number, (slot, factor) in enumerate(plan.outputs):
        if slot >= 0 and values[slot] is not None:
            found[number] = factor * values[slot]
    for number, reaction in enumerate(plan.reactions, len(plan.outputs)):
        torque = _reaction(reaction, links, weights, values, doubt)
        if torque is not None:
            found[number] = torque
    return Sweep(found, doubt.marked)


def _gathered(kappa: Array, source: Sequence[tuple[int, float]], doubt: Doubt) -> Array:
    total = None
    for law, factor in source:
        total = _plus(total, kappa[law] if factor == 1.0 else factor * kappa[law], doubt)
    return np.asarray(total)


def _plus(known: Any, term: Array, doubt: Doubt) -> Array:
    """Known + term; ``known`` is None where there is nothing yet."""
    if known is None:
        return term
    total = np.asarray(known + term)
    doubt.sums(known, total)
    return total


def _weights(plan: Plan) -> list[Any]:
    """Weights (n_exc, 1) of the loads to begin with."""
    weights: list[Any] = [None] * plan.n_loads
    for slot, excitation, factor in plan.weights:
        if weights[slot] is None:
            weights[slot] = np.zeros((plan.n_excitations, 1))
        weights[slot][excitation] += factor
    return weights


_Back: TypeAlias = tuple[Sequence[Any], Any]


def _eliminate(step: Step, links: list[Any], weights: list[Any], kept: frozenset[int], doubt: Doubt) -> _Back:
    """Eliminate one coordinate; returns the shares kappa_i / S and the load over S for the way back."""
    for slot, parts in step.handed_on:
        for target, weight in parts:
            links[target] = _plus(links[target], weight * links[slot], doubt)
        if slot not in kept:
            links[slot] = None
    terms = [links[slot] for slot, _ in step.terms]
    shares, load = _shares(step, terms, weights, doubt)
    for i, j, factor, target in step.pairs:
        product = shares[i] * terms[j]
        if factor != 1.0:
            product *= factor
        links[target] = _plus(links[target], product, doubt)
    for slot, i, factor, target in step.passed:
        weights[target] = _plus(weights[target], (factor * weights[slot]) * shares[i], doubt)
    for slot, _ in step.terms:
        links[slot] = None
    return shares, load


def _shares(step: Step, terms: Sequence[Array], weights: list[Any], doubt: Doubt) -> _Back:
    """kappa_i / S for the terms that need it, and f_v / S."""
    shares: list[Any] = [None] * len(terms)
    if not step.shared and not step.loads:
        return shares, None
    S = _pivot(step, terms, doubt)
    if len(step.shared) == 1 and not step.loads:
        shares[step.shared[0]] = terms[step.shared[0]] / S
    else:
        inverse = 1.0 / S
        for i in step.shared:
            shares[i] = terms[i] * inverse
    for i in step.shared:
        doubt.shares(shares[i])
    load = None
    for slot, factor in step.loads:
        load = _plus(load, factor * weights[slot], doubt)
    return shares, None if load is None else load * inverse


def _pivot(step: Step, terms: Sequence[Array], doubt: Doubt) -> Array:
    """S; its shares tell where it is small, or the sum itself where more than one term has none."""
    parts = [term if square == 1.0 else square * term for term, (_, square) in zip(terms, step.terms, strict=True)]
    if not parts:
        return np.zeros(1)
    seen = len(step.shared) >= len(parts) - 1
    total = parts[0]
    for part in parts[1:]:
        total = total + part if seen else _plus(total, part, doubt)
    return total


def _back(plan: Plan, back: Sequence[_Back], doubt: Doubt) -> list[Any]:
    """Motions (n_exc, n_lanes) of rows, None where nothing moves them."""
    values: list[Any] = [None] * plan.n_motions
    for slot, motions in plan.given:
        if any(motions):
            values[slot] = np.array(motions)[:, None]
    for step, (shares, load) in zip(reversed(plan.steps), reversed(back), strict=True):
        for motion in step.motions:
            total = None if load is None or not motion.load else motion.load * load
            for i, factor, source in motion.parts:
                if values[source] is not None:
                    part = shares[i] * values[source]
                    if factor != 1.0:
                        part *= factor
                    total = _plus(total, part, doubt)
            values[motion.slot] = total
    return values


def _reaction(
    reaction: Reaction, links: Sequence[Any], weights: Sequence[Any], values: Sequence[Any], doubt: Doubt
) -> Any:
    """Torque (n_exc, n_lanes) on a given column, None where nothing arrives."""
    total = None
    for slot, factor, motion in reaction.laws:
        if values[motion] is not None:
            total = _plus(total, (factor * links[slot]) * values[motion], doubt)
    for slot, factor in reaction.loads:
        if weights[slot] is not None:
            total = _plus(total, factor * weights[slot], doubt)
    return total
