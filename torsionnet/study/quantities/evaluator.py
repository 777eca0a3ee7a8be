"""Quantities of any variants of one configuration, for answers that choose their variants themselves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.drivetrain import Drivetrain
from torsionnet.response.modes import Modes
from torsionnet.solve.batch.batch_plan import BatchPlan, batch_plan
from torsionnet.solve.modes.modes import natural_modes
from torsionnet.study.quantities.quantity import StudyQuantity
from torsionnet.study.quantities.variant_block import GRAPH, VariantBlock

SINGLY = 4
"""Variants of a block that are solved one by one."""
FEWEST, MOST, PARTS = 500, 2000, 32
"""Variants of a block that are solved together: small ones cost more, large ones cannot be shared among workers."""

Values = Mapping[str, FloatArray]
"""Parameter -> values (n,) in SI."""


class BlockDesk(Protocol):
    """Who calculates blocks of variants, and may know them from before."""

    def rows(self, evaluator: Evaluator, blocks: Sequence[Values], names: tuple[str, ...]) -> list[FloatArray]:
        """Of every block what :meth:`Evaluator.rows` gives."""
        ...

    def once(
        self, evaluator: Evaluator, what: str, values: Mapping[str, float], work: Callable[[], FloatArray]
    ) -> FloatArray:
        """Numbers (n,) that work on one variant comes to, or came to before: what else a search may ask."""
        ...


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
    configuration : str
        Its name.
    desk : BlockDesk or None
        Who calculates; None: this process, each time anew.
    """

    model: Drivetrain
    names: tuple[str, ...]
    quantities: Mapping[str, StudyQuantity]
    method: str = GRAPH
    configuration: str = ""
    desk: BlockDesk | None = None

    @cached_property
    def plan(self) -> BatchPlan | None:
        return batch_plan(self.model, self.names)

    @cached_property
    def nominal_modes(self) -> Modes:
        """Those of the model, which modes of variants are told by."""
        return natural_modes(self.model)[0]

    def block(self, values: Values) -> VariantBlock:
        """Variants with these values, (n,) each."""
        batch = None if self.plan is None else self.plan.batch(values)
        return VariantBlock(
            self.model, values, self.quantities, batch, method=self.method, nominal=lambda: self.nominal_modes
        )

    def rows(self, values: Values, names: tuple[str, ...]) -> FloatArray:
        """Quantities of some variants side by side (n, n_points of all), calculated here."""
        block = self.block(values)
        return np.concatenate([block.of(name) for name in names], axis=1)

    def __call__(self, values: Values, names: tuple[str, ...] = ()) -> dict[str, FloatArray]:
        """Quantities (n,), of curves (n, n_points); all, or those of ``names``.

        Variants go in blocks that follow from their number alone, so that values are the same to the last bit whoever
        calculates them.
        """
        count = len(next(iter(values.values())))
        wanted = names or tuple(self.quantities)
        singly = self.plan is None or any(self._is_singly(name) for name in wanted)
        together = SINGLY if singly else max(FEWEST, min(MOST, count // PARTS))
        blocks = [
            {name: column[start : start + together] for name, column in values.items()}
            for start in range(0, count, together)
        ]
        if self.desk is None:
            rows = np.concatenate([self.rows(block, wanted) for block in blocks])
        else:
            rows = np.concatenate(self.desk.rows(self, blocks, wanted))
        forms = [self.quantities[name].measured(self.model, self.quantities) for name in wanted]
        parts = np.split(rows, np.cumsum([len(form.points) for form in forms])[:-1], axis=1)
        return {
            name: part if form.is_curve else part[:, 0] for name, form, part in zip(wanted, forms, parts, strict=True)
        }

    def once(self, what: str, values: Mapping[str, float], work: Callable[[], FloatArray]) -> FloatArray:
        """Numbers (n,) that ``work`` on one variant comes to, or came to when ``what`` was asked before."""
        return work() if self.desk is None else self.desk.once(self, what, values, work)

    def _is_singly(self, name: str) -> bool:
        quantity = self.quantities[name]
        return quantity.singly or any(self._is_singly(part) for part in quantity.parts)
