"""Blocks of variants for tests of quantities: with their coefficients where that is possible, and without."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

import torsionnet as tn
from torsionnet.study.quantities.variant_block import VariantBlock


def spread(model: tn.Drivetrain, names: tuple[str, ...], count: int = 5, width: float = 0.2) -> dict[str, np.ndarray]:
    """Values around those of the model, different ones in every variant."""
    rng = np.random.default_rng(7)
    return {name: model.parameters[name] * rng.uniform(1 - width, 1 + width, count) for name in names}


def singly(model: tn.Drivetrain, values: Mapping[str, np.ndarray], **quantities: object) -> VariantBlock:
    """A block whose variants are models of their own."""
    return VariantBlock(model, values, quantities, None)


def together(model: tn.Drivetrain, values: Mapping[str, np.ndarray], **quantities: object) -> VariantBlock:
    """A block whose variants are solved together."""
    from torsionnet.solve.batch.batch_plan import batch_plan

    plan = batch_plan(model, tuple(values))
    assert plan is not None
    return VariantBlock(model, values, quantities, plan.batch(values))


def columns(values: Mapping[str, np.ndarray]) -> list[dict[str, float]]:
    """The values of every variant."""
    return [dict(zip(values, map(float, row), strict=True)) for row in zip(*values.values(), strict=True)]
