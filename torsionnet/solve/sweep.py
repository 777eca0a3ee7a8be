"""The numbers of an elimination plan: every operation on a vector of frequencies at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.solve.graph_plan import Plan, Step

Array: TypeAlias = NDArray[Any]
"""Real where nothing damps the system, else complex; the last axis is frequency."""

LARGE = 1e4
"""Where links among neighbours arise, kappa / S above this costs digits that refinement gives back."""


@dataclass
class Sweep:
    """Motions (n_outputs, n_exc, n_f), and a mask (n_f,) of frequencies to look at again (None: none)."""

    motion: Array
    doubtful: NDArray[np.bool_] | None


def sweep(plan: Plan, kappa: Array, loads: dict[int, Array], n_exc: int) -> Sweep:
    """Eliminate, and go back along the rows that were asked for.

    Parameters
    ----------
    plan : Plan
    kappa : (n_laws, n_f) array
    loads : dict
        Coordinate -> (n_exc, n_f or 1) array of loads; used up.
    n_exc : int
    """
    links: list[Any] = [_gathered(kappa, source) for source in plan.sources]
    links += [None] * (plan.n_slots - len(links))
    doubt = _Doubt(kappa.shape[-1])
    back = [_eliminate(step, links, loads, doubt) for step in plan.steps]
    return Sweep(_back(plan, back, n_exc, kappa), doubt.mask)


class _Doubt:
    def __init__(self, n_f: int) -> None:
        self.n_f, self.mask = n_f, None if n_f else np.zeros(0, dtype=bool)

    def look(self, share: Array) -> None:
        """Mark where kappa / S is so large that S is a small difference."""
        size = np.abs(share.view(float))
        if not size.max(initial=0.0) < LARGE:
            size = size.reshape(self.n_f, -1).max(axis=1)
            found = ~(size < LARGE)
            self.mask = found if self.mask is None else self.mask | found


def _gathered(kappa: Array, source: Sequence[tuple[int, float]]) -> Array:
    total = None
    for law, factor in source:
        part = kappa[law] if factor == 1.0 else factor * kappa[law]
        total = part if total is None else total + part
    return np.asarray(total)


_Back: TypeAlias = tuple[Sequence[Any], Any]


def _eliminate(step: Step, links: list[Any], loads: dict[int, Array], doubt: _Doubt) -> _Back:
    """Eliminate one coordinate; returns the shares kappa_i / S and the load over S for the way back."""
    for slot, parts in step.splits:
        for target, weight in parts:
            _add(links, target, weight * links[slot])
        links[slot] = None
    terms = [links[slot] for slot, _ in step.terms]
    S = _pivot([term if square == 1.0 else square * term for term, (_, square) in zip(terms, step.terms, strict=True)])
    shares = _shares(step, terms, S)
    for i, j, factor, target in step.pairs:
        product = shares[i] * terms[j]
        if factor != 1.0:
            product *= factor
        _add(links, target, product)
    if step.closes_loop:
        for share, term in zip(shares, terms, strict=True):
            if share is not None and term is not None:
                doubt.look(share)
    for slot, _ in step.terms:
        links[slot] = None
    load = loads.pop(step.coordinate, None)
    if load is None:
        return shares, None
    for i, j, factor in step.loads:
        part = (factor * load) * shares[i]
        loads[j] = loads[j] + part if j in loads else part
    return shares, load / S


def _add(links: list[Any], target: int, product: Array) -> None:
    known = links[target]
    links[target] = product if known is None else np.add(known, product, out=product)


def _shares(step: Step, terms: Sequence[Array], S: Array) -> list[Any]:
    """kappa_i / S for the terms that need it."""
    needed = step.shared
    if len(needed) == 1:
        shares: list[Any] = [None] * len(terms)
        shares[needed[0]] = terms[needed[0]] / S
        return shares
    inverse = 1.0 / S if needed else None
    return [term * inverse if i in needed else None for i, term in enumerate(terms)]


def _pivot(terms: Sequence[Array]) -> Array:
    if not terms:
        return np.zeros(1)
    total = terms[0]
    for term in terms[1:]:
        total = total + term
    return total


def _back(plan: Plan, back: Sequence[_Back], n_exc: int, kappa: Array) -> Array:
    values: list[Any] = [None] * plan.n_values
    for step, (shares, load) in zip(reversed(plan.steps), reversed(back), strict=True):
        for motion in step.motions:
            total = None if load is None or not motion.load else motion.load * load
            for i, factor, source in motion.parts:
                if values[source] is not None:
                    part = shares[i] * values[source]
                    if factor != 1.0:
                        part *= factor
                    total = part if total is None else total + part
            values[motion.slot] = total
    found = np.zeros((len(plan.outputs), n_exc, kappa.shape[-1]), dtype=kappa.dtype)
    for number, (slot, factor) in enumerate(plan.outputs):
        if slot >= 0 and values[slot] is not None:
            found[number] = factor * values[slot]
    return found
