"""Coefficient arrays of a batch under construction, filled in by passes over the variants."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import ModelError
from torsionnet.base.expressions import LARGEST_SIZE, SMALLEST_SIZE
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.batch.batch import Batch
from torsionnet.linear.batch.batched_stiffness import BatchedStiffness
from torsionnet.linear.batch.variant_numbers import Decisions, variant_column
from torsionnet.model.element_base.dynamic_stiffness import ComplexStiffness, DynamicStiffness
from torsionnet.model.element_base.round_section import section_modulus
from torsionnet.model.elements import Law, Values


class BatchBuilder:
    """Batch under construction, with coefficient arrays in SI units and a state for every variant.

    The coefficients are at first those of the drivetrain.
    """

    def __init__(self, drivetrain: AssembledModel, values: Mapping[str, FloatArray]) -> None:
        self.drivetrain: AssembledModel = drivetrain
        self.values: Mapping[str, FloatArray] = values
        self.count: int = len(next(iter(values.values())))
        system = drivetrain.assembly.system
        self.inertia, self.damping, self.stiffness = (
            np.tile(one, (self.count, 1)) for one in (system.inertia, system.damping, system.stiffness)
        )
        self.dynamic: list[BatchedStiffness] = []
        self.moduli: dict[str, FloatArray] = {}
        # As `is_beyond_range` refuses the number of a single model.
        sizes = np.abs(np.array(list(values.values())))
        self.impossible = ~np.all((sizes == 0) | ((sizes > SMALLEST_SIZE) & (sizes < LARGEST_SIZE)), axis=0)
        self.separate, self.known = (np.zeros(self.count, dtype=bool) for _ in range(2))

    def followed(self, places: NDArray[np.intp], decisions: Decisions) -> FollowingPass:
        """Pass over a batch with the variants that have followed every decision of the first variant in it."""
        own = places[decisions.follows]
        self.known[own] = ~decisions.unsure[decisions.follows]
        return FollowingPass(self, own, decisions.follows)

    def settle(self) -> None:
        """Mark variants without certain coefficients as separate, and those that no model allows as impossible."""
        finite = np.ones(self.count, dtype=bool)
        for array in (self.inertia, self.damping, self.stiffness):
            finite &= np.isfinite(array).all(axis=1)
        for one in self.dynamic:
            finite[one.places] &= np.isfinite(one.coefficients).all(axis=0)
        self.separate |= ~(self.known & finite)
        self.separate &= ~self.impossible
        for index in np.flatnonzero(self.separate):
            try:
                self.drivetrain.configured(**{name: float(one[index]) for name, one in self.values.items()})
            except ModelError:
                self.impossible[index], self.separate[index] = True, False

    def batch(self) -> Batch:
        varied = {one.law for one in self.dynamic}
        same = (
            BatchedStiffness(law, np.arange(self.count), one, np.zeros((0, self.count)))
            for law, one in self.drivetrain.assembly.system.dynamic
            if law not in varied
        )
        coefficients = self.inertia, self.damping, self.stiffness, (*same, *self.dynamic)
        return Batch(self.drivetrain, self.values, *coefficients, self.impossible, self.separate, self.moduli)


@dataclass(frozen=True, eq=False)
class FollowingPass:
    """Variants ``own`` with valid numbers in one pass over a batch, and the mask ``follows`` that selects them."""

    filling: BatchBuilder
    own: NDArray[np.intp]
    follows: NDArray[np.bool_]

    def mark_separate(self) -> None:
        """Mark the variants of the pass as separate, since their rows differ from those of the drivetrain."""
        self.filling.separate[self.own] = True

    def _column(self, number: Any) -> FloatArray:
        return variant_column(number, len(self.follows))[self.follows]

    def take(self, law: Law, number: int | None) -> None:
        """Store a law's coefficients for the variants of the pass.

        The ``number`` is None where the law has no effect in the drivetrain.
        """
        filling, own = self.filling, self.own
        entries = law.inertia, law.damping, law.stiffness, law.loss_factor
        inertia, damping, stiffness, loss = map(self._column, entries)
        acts = (inertia != 0) | (damping != 0) | (stiffness != 0) | (law.table is not None)
        if number is None:
            filling.separate[own[acts]] = True
            return
        known = filling.drivetrain.assembly.laws[number]
        hysteretic = bool(known.loss_factor != 0)
        same = acts & ((stiffness != 0) == bool(known.stiffness != 0)) & ((loss != 0) == hysteretic)
        filling.separate[own[~same]] = True
        filling.inertia[own, number], filling.damping[own, number] = inertia, damping
        filling.stiffness[own, number] = 0.0 if hysteretic else stiffness
        if hysteretic:
            self._dynamic(number, ComplexStiffness(0j), np.array([stiffness, stiffness * loss]))
        elif law.table is not None:
            coefficients = [self._column(one) for one in law.table.coefficients]
            self._dynamic(number, law.table, np.array(coefficients).reshape(-1, len(own)))

    def _dynamic(self, number: int, of: DynamicStiffness, coefficients: FloatArray) -> None:
        self.filling.dynamic.append(BatchedStiffness(number, self.own, of, coefficients))

    def take_modulus(self, name: str, modulus: Any) -> None:
        """Store the polar section modulus of a shaft in each variant, as a ratio to that in the drivetrain."""
        drivetrain = self.filling.drivetrain
        known = float(section_modulus(drivetrain.elements[name], Values(drivetrain.exact_values)))
        ratios = self.filling.moduli.setdefault(name, np.ones(self.filling.count))
        ratios[self.own] = self._column(modulus) / known
