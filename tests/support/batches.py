"""Batches against single models: what every batch has to agree with."""

import numpy as np

import torsionnet as tn
from torsionnet.linear.assembly.law_stiffness import law_stiffness
from torsionnet.linear.batch.batch_plan import batch_plan

OMEGA = np.array([0.7, 30.0, 900.0])


def require_like_single_models(batch, rel=1e-14):
    """Every variant by itself: as possible, with the same coefficients; how many there are of each kind."""
    counts = {"together": 0, "apart": 0, "impossible": 0}
    for index in range(len(batch)):
        try:
            single = batch.model(index)
        except tn.ModelError:
            assert batch.impossible[index], f"{_values(batch, index)} is refused"
            counts["impossible"] += 1
            continue
        assert not batch.impossible[index], f"{_values(batch, index)} is possible"
        if batch.separate[index]:
            counts["apart"] += 1
            continue
        counts["together"] += 1
        own, nominal = single.assembly, batch.drivetrain.assembly
        assert own.system.law_rows.maps == nominal.system.law_rows.maps
        assert own.owners == nominal.owners
        for name in ("inertia", "damping", "stiffness"):
            np.testing.assert_allclose(getattr(batch, name)[index], getattr(own.system, name), rtol=rel, atol=0)
        part = batch.part([index]).law_stiffness(OMEGA)
        whole = law_stiffness([own.system], OMEGA)
        np.testing.assert_allclose(part.by_law, whole.by_law, rtol=10 * rel, atol=0)
        for ours, theirs in zip(part.actions, whole.actions, strict=True):
            np.testing.assert_array_equal(ours, theirs)
    return counts


def _values(batch, index):
    return {name: float(column[index]) for name, column in batch.values.items()}


def drawn(rng, model, names, count):
    """Values around those of a model; two in five variants have one that is zero, below zero or no number at all."""
    values = {name: model.parameters[name] * rng.uniform(0.4, 1.8, count) for name in names}
    for place in np.flatnonzero(rng.random(count) < 0.4):
        values[str(rng.choice(list(names)))][place] *= rng.choice([0.0, -0.3, 1e3, np.nan, 1e45])
    return values


def batch_of(model, values):
    """None where variants have rows of their own."""
    plan = batch_plan(model, values)
    return None if plan is None else plan.batch(values)
