"""Quantities of any variants of one configuration, for answers that choose their variants themselves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.drivetrain import Drivetrain
from torsionnet.response.modes import Modes
from torsionnet.solve.batch.batch_plan import BatchPlan, batch_plan
from torsionnet.solve.modes import natural_modes
from torsionnet.study.quantity import StudyQuantity
from torsionnet.study.single_responses import GRAPH
from torsionnet.study.variant_block import VariantBlock

TOGETHER = 2000
"""Variants solved together, which bounds the memory."""


@dataclass(frozen=True, eq=False)
class Evaluator:
    """``evaluator({"k_2": values}) -> {"f_1": values}``.

    Attributes
    ----------
    model : Drivetrain
        In the configuration that is meant.
    names : tuple of str
        Parameters that are varied.
    quantities : mapping
        By name.
    method : str
        Of the solver of responses.
    """

    model: Drivetrain
    names: tuple[str, ...]
    quantities: Mapping[str, StudyQuantity]
    method: str = GRAPH

    @cached_property
    def plan(self) -> BatchPlan | None:
        return batch_plan(self.model, self.names)

    @cached_property
    def nominal_modes(self) -> Modes:
        """Those of the model, which modes of variants are told by."""
        return natural_modes(self.model)[0]

    def block(self, values: Mapping[str, FloatArray]) -> VariantBlock:
        """Variants with these values, (n,) each."""
        batch = None if self.plan is None else self.plan.batch(values)
        return VariantBlock(
            self.model, values, self.quantities, batch, method=self.method, nominal=lambda: self.nominal_modes
        )

    def __call__(self, values: Mapping[str, FloatArray], names: tuple[str, ...] = ()) -> dict[str, FloatArray]:
        """Quantities (n,), of curves (n, n_points); all, or those of ``names``."""
        count = len(next(iter(values.values())))
        wanted = names or tuple(self.quantities)
        found: dict[str, list[FloatArray]] = {name: [] for name in wanted}
        for start in range(0, count, TOGETHER):
            block = self.block({name: column[start : start + TOGETHER] for name, column in values.items()})
            for name in wanted:
                found[name].append(block.of(name))
        curves = {name: self.quantities[name].measured(self.model, self.quantities).is_curve for name in wanted}
        joined = {name: np.concatenate(parts) for name, parts in found.items()}
        return {name: array if curves[name] else array[:, 0] for name, array in joined.items()}
