"""Quantities of designs in all configurations of a study, together and singly."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.design.exact_slopes import ExactSlopes
from torsionnet.study.quantities.variant_block import VariantBlock


@dataclass(frozen=True, eq=False)
class DesignQuantities:
    """Values of quantities in one configuration after the other, as points of one curve.

    So a target is one in every configuration, a limit holds in all, and what is made small is the worst of them.

    Attributes
    ----------
    evaluators : tuple of Evaluator
        One for each configuration.
    wanted : tuple of str
        Quantities that are asked for.
    """

    evaluators: tuple[Evaluator, ...]
    wanted: tuple[str, ...]

    def __call__(self, values: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Values (n, n_configurations * n_points) by quantity."""
        count = len(next(iter(values.values())))
        found = [one(_completed(one, values, count), self.wanted) for one in self.evaluators]
        return {name: np.concatenate([one[name].reshape(count, -1) for one in found], axis=1) for name in self.wanted}

    def slopes(self, values: Mapping[str, float]) -> dict[str, FloatArray]:
        """Exact derivatives (n_configurations * n_points, n_p) of those quantities that have some everywhere."""
        found = [one(values) for one in self._exact]
        everywhere = [name for name in self.wanted if all(name in one for one in found)]
        return {name: np.concatenate([one[name] for one in found]) for name in everywhere}

    @cached_property
    def _exact(self) -> list[ExactSlopes]:
        return [ExactSlopes(one, self.wanted) for one in self.evaluators]

    def singly(self, values: Mapping[str, float]) -> dict[str, FloatArray]:
        """The same values (n_configurations * n_points,) by models with these values of their own."""
        at = {name: np.array([value]) for name, value in values.items()}
        blocks = [VariantBlock(one.model, at, one.quantities, None) for one in self.evaluators]
        return {name: np.concatenate([block.of(name)[0] for block in blocks]) for name in self.wanted}


def _completed(evaluator: Evaluator, values: Mapping[str, FloatArray], count: int) -> dict[str, FloatArray]:
    """With the model's own values (count,) of what may vary and is not given."""
    own = evaluator.model.parameters
    return {name: values[name] if name in values else np.full(count, own[name]) for name in evaluator.names}
