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


def sweep(plan: Plan, kappa: Array, *, lossy: bool = False) -> Sweep:
    """Eliminate, and go back along the rows that were asked for.

    Parameters
    ----------
    plan : Plan
    kappa : (n_laws, n_lanes) array
        Dynamic stiffness of every law.
    lossy : bool
        Sums of dynamic stiffnesses are known not to vanish.
    """
    doubt = Doubt(kappa.shape[-1])
    watch = None if lossy else doubt
    links: list[Any] = [_gathered(kappa, source, watch) for source in plan.sources]
    links += [None] * (plan.n_slots - len(links))
    weights, kept = _weights(plan), plan.read_slots
    back = [_eliminate(step, links, weights, kept, watch, doubt) for step in plan.steps]
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


def _gathered(kappa: Array, source: Sequence[tuple[int, float]], watch: Doubt | None) -> Array:
    law, factor = source[0]
    total = kappa[law] if factor == 1.0 else factor * kappa[law]
    for law, factor in source[1:]:
        total = _plus(total, factor * kappa[law], watch)
    return total


def _plus(known: Any, term: Array, watch: Doubt | None) -> Array:
    """Known + term; ``known`` is None where there is nothing yet, and ``term`` may be written over."""
    if known is None:
        return term
    total = np.add(known, term, out=term) if term.size >= known.size else np.add(known, term)
    if watch is not None:
        watch.sums(known, total)
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


def _eliminate(
    step: Step, links: list[Any], weights: list[Any], kept: frozenset[int], watch: Doubt | None, doubt: Doubt
) -> _Back:
    """Eliminate one coordinate; returns the shares kappa_i / S and the load over S for the way back."""
    for slot, parts in step.handed_on:
        for target, weight in parts:
            links[target] = _plus(links[target], weight * links[slot], watch)
        if slot not in kept:
            links[slot] = None
    terms = [links[slot] for slot, _ in step.terms]
    shares, inverse = _shares(step, terms, watch)
    for i, j, factor, target in step.pairs:
        product = shares[i] * terms[j]
        if factor != 1.0:
            product *= factor
        links[target] = _plus(links[target], product, watch)
    for slot, i, factor, target in step.passed:
        weights[target] = _plus(weights[target], (factor * weights[slot]) * shares[i], doubt)
    for slot, _ in step.terms:
        links[slot] = None
    load = None
    for slot, factor in step.loads:
        load = _plus(load, factor * weights[slot], doubt)
    return shares, None if load is None else load * inverse


def _shares(step: Step, terms: Sequence[Array], watch: Doubt | None) -> tuple[list[Any], Any]:
    """kappa_i / S for the terms that need it, and 1 / S where a load does."""
    shares: list[Any] = [None] * len(terms)
    if not step.shared and not step.loads:
        return shares, None
    S, inverse = _pivot(step, terms, watch), None
    if len(step.shared) == 1 and not step.loads:
        shares[step.shared[0]] = terms[step.shared[0]] / S
    else:
        inverse = 1.0 / S
        for i in step.shared:
            shares[i] = terms[i] * inverse
    if watch is not None:
        for i in step.shared:
            watch.shares(shares[i])
    return shares, inverse


def _pivot(step: Step, terms: Sequence[Array], watch: Doubt | None) -> Array:
    """S; its shares tell where it is small, or the sum itself where more than one term has none."""
    if not terms:
        return np.zeros(1)
    if len(step.shared) >= len(terms) - 1:
        watch = None
    squares = [square for _, square in step.terms]
    total = terms[0] if squares[0] == 1.0 else squares[0] * terms[0]
    for term, square in zip(terms[1:], squares[1:], strict=True):
        part = term if square == 1.0 else square * term
        before, total = total, total + part
        if watch is not None:
            watch.sums(before, total)
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
