"""Evaluator of the quantities of any variants of one configuration."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.batch.batch_plan import BatchPlan, batch_plan
from torsionnet.study.quantities.quantity import GRAPH, StudyQuantity, VariantBlock

SINGLE_BLOCK_SIZE = 4
"""Number of variants in a block solved one by one, few, as a block is the smallest work for a worker."""
FEWEST_IN_BLOCK, MOST_IN_BLOCK, BLOCKS = 500, 2000, 32
"""Fewest and most variants in a block that are solved together, and number of blocks aimed at.

Small blocks cost more for each variant, large ones cannot be shared among workers.
"""

Values = Mapping[str, FloatArray]
"""Mapping of each parameter to its values (n,) in SI of n variants."""


class BlockCalculator(Protocol):
    """Calculator of blocks of variants for evaluators, which may return their values from an earlier run."""

    def rows(self, evaluator: Evaluator, blocks: Sequence[Values], names: tuple[str, ...]) -> list[FloatArray]:
        """Rows of each block of variants, (n, n_points of all + 2), as :meth:`Evaluator.rows` returns them."""
        ...

    def once(
        self, evaluator: Evaluator, what: str, values: Mapping[str, float], work: Callable[[], FloatArray]
    ) -> FloatArray:
        """Numbers (n,) that the function ``work`` returns for one variant, or returned in an earlier run."""
        ...


@dataclass(frozen=True, eq=False)
class Evaluator:
    """Function from parameter values (n,) of variants to their quantities, all in SI and by name.

    Attributes
    ----------
    model : Drivetrain
        Drivetrain in the configuration.
    names : tuple of str
        Varied parameters.
    quantities : mapping
        Name -> quantity.
    method : str
        Method of the response solver.
    configuration : str
        Name of the configuration.
    calculator : BlockCalculator or None
        Calculates the blocks; None: this process does, each time anew.
    """

    model: Drivetrain
    names: tuple[str, ...]
    quantities: Mapping[str, StudyQuantity]
    method: str = GRAPH
    configuration: str = ""
    calculator: BlockCalculator | None = None

    @cached_property
    def plan(self) -> BatchPlan | None:
        return batch_plan(self.model, self.names)

    def block(self, values: Values) -> VariantBlock:
        """Block of variants with these parameter values, (n,) each in SI."""
        batch = None if self.plan is None else self.plan.batch(values)
        return VariantBlock(self.model, values, self.quantities, batch, method=self.method)

    def rows(self, values: Values, names: tuple[str, ...]) -> FloatArray:
        """Quantities of some variants side by side (n, n_points of all + 2) in SI, calculated in this process.

        The last two columns are the lowest and the highest frequency in Hz at which laws over frequency were read.
        """
        block = self.block(values)
        columns = [block.of(name) for name in names]
        return np.concatenate([*columns, np.tile(block.read, (len(block), 1))], axis=1)

    def __call__(self, values: Values, names: tuple[str, ...] = ()) -> dict[str, FloatArray]:
        """Quantities by name in SI, (n,) of numbers, (n, n_points) of curves, all of them or those in ``names``.

        Variants are calculated in blocks whose size follows from their number alone, so that values are the same to the
        last bit on any number of workers.
        """
        count = len(next(iter(values.values())))
        wanted = names or tuple(self.quantities)
        singly = self.plan is None or any(self._is_singly(name) for name in wanted)
        together = SINGLE_BLOCK_SIZE if singly else max(FEWEST_IN_BLOCK, min(MOST_IN_BLOCK, count // BLOCKS))
        blocks = [
            {name: column[start : start + together] for name, column in values.items()}
            for start in range(0, count, together)
        ]
        if self.calculator is None:
            rows = np.concatenate([self.rows(block, wanted) for block in blocks])
        else:
            rows = np.concatenate(self.calculator.rows(self, blocks, wanted))
        forms = [self.quantities[name].measured(self.model, self.quantities) for name in wanted]
        parts = np.split(rows, np.cumsum([len(form.points) for form in forms]), axis=1)[:-1]
        return {
            name: part if form.is_curve else part[:, 0] for name, form, part in zip(wanted, forms, parts, strict=True)
        }

    def once(self, what: str, values: Mapping[str, float], work: Callable[[], FloatArray]) -> FloatArray:
        """Numbers (n,) that the function ``work`` returns for one variant, or returned as ``what`` in an old run."""
        return work() if self.calculator is None else self.calculator.once(self, what, values, work)

    def _is_singly(self, name: str) -> bool:
        quantity = self.quantities[name]
        return quantity.singly or any(self._is_singly(part) for part in quantity.parts)
