"""Case of an answer, a configuration of a study with its evaluator and space, for answers that choose variants."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import AskedStudy
from torsionnet.study.answers.answer_inputs import case_label
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.quantities.variant_block import VariantBlock
from torsionnet.study.space.space import Space

OfPoints = Callable[[FloatArray], FloatArray]
"""Function from points (n, d) of the unit cube or of standard normal space to a quantity's values (n,)."""

OfVariants = Callable[[Mapping[str, FloatArray]], FloatArray]
"""Function from the parameters of n variants, (n,) in SI by name, to a quantity's values (n,) in SI."""


@dataclass(frozen=True, eq=False)
class AnswerCase:
    """Configuration of a study with the evaluator of its variants and the space of its varied parameters.

    Parameters that take the values of a list or range keep that of the model where an answer draws at random.
    """

    configuration: str
    evaluator: Evaluator
    space: Space

    @property
    def label(self) -> str:
        """Name of the configuration in tables, "as given" for the model as it stands."""
        return case_label(self.configuration)

    def calculated(self, values: Mapping[str, FloatArray], names: tuple[str, ...]) -> dict[str, FloatArray]:
        """Quantities of n variants by name in SI, each (n,), or (n, n_points) for a curve.

        Parameters that are not given have their values in the model.
        """
        return self.evaluator(self._whole(values), names)

    def singly(self, values: Mapping[str, float], quantity: str) -> float:
        """Value in SI of a quantity of one variant, built and solved as a single model."""
        whole = self._whole({name: np.array([value]) for name, value in values.items()})
        block = VariantBlock(self.evaluator.model, whole, self.evaluator.quantities, None)
        return float(block.of(quantity)[0, 0])

    def nominal(self, name: str) -> float:
        """Value in SI of a varied parameter in the model of this configuration."""
        value = self.space.nominal[name]
        if np.isnan(value):
            raise UsageError(f"{name} has no value in the model {self.label}; give it a distribution or a value")
        return value

    def _whole(self, values: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        count = len(next(iter(values.values())))
        return {
            name: values[name] if name in values else np.full(count, self.nominal(name)) for name in self.space.names
        }


def answer_cases(study: AskedStudy) -> Iterator[AnswerCase]:
    """Yield every configuration of a study with its evaluator and its space."""
    for configuration in study.configurations:
        evaluator = study.evaluator(configuration)
        yield AnswerCase(configuration, evaluator, study.space.at(evaluator.model))
