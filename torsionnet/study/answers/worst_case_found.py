"""The variants with the largest and the smallest value of a quantity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any

from torsionnet.response.table import Column, Table
from torsionnet.study.answers.conclusion_data import PlainConclusion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SAME = 1e-6
"""Share by which a value may differ from the one solved singly."""


@dataclass(frozen=True, eq=False)
class WorstVariant:
    """The worst variant of a configuration.

    Attributes
    ----------
    configuration, direction : str
    value, nominal : float
        Of the quantity, here and for the values of the model.
    variant, tolerance : mapping
        Values of the parameters, and their bounds.
    at_lower, at_upper : tuple of str
        Parameters at a bound of their tolerance.
    singly : float
        The value of this variant made and solved as a model of its own.
    best_at_random : float
        The worst value among ``tried`` random variants.
    evaluations : int
        Variants calculated.
    """

    configuration: str
    direction: str
    value: float
    variant: Mapping[str, float]
    tolerance: Mapping[str, tuple[float, float]]
    nominal: float
    at_lower: tuple[str, ...]
    at_upper: tuple[str, ...]
    singly: float
    best_at_random: float
    tried: int
    evaluations: int

    @property
    def confirmed(self) -> bool:
        """Whether the model solved singly says the same."""
        return abs(self.singly - self.value) <= SAME * abs(self.value)


@dataclass(frozen=True, eq=False)
class WorstCaseFound(PlainConclusion):
    """Worst variants of all configurations; ``correlated`` are the pairs of parameters that a study correlates."""

    title: str
    quantity: str
    unit: str
    parameter_units: Mapping[str, str]
    variants: tuple[WorstVariant, ...]
    correlated: tuple[tuple[str, str], ...] = ()

    @property
    def sentences(self) -> tuple[str, ...]:
        said = [text for one in self.variants for text in self._about(one)]
        if self.correlated:
            pairs = ", ".join(" and ".join(pair) for pair in self.correlated)
            said.append(
                f"correlation is left out ({pairs}): each parameter lies anywhere within its tolerance, whatever the "
                "others are, so that a worst case may be a variant that hardly occurs"
            )
        return tuple(said)

    def _about(self, one: WorstVariant) -> list[str]:
        values = f"{one.value:.5g} {self.unit}".rstrip() + f" (as given {one.nominal:.5g})"
        inside = [name for name in one.variant if name not in one.at_lower + one.at_upper]
        places = [("at the lower bound", one.at_lower), ("at the upper bound", one.at_upper), ("between", inside)]
        where = ", ".join(f"{' and '.join(names)} {place}" for place, names in places if names)
        said = [f"{one.direction} {self.quantity}, {one.configuration}: {values}, {where}"]
        said.append(
            f"{one.configuration}: none of {one.tried} random variants beats it; their best is {one.best_at_random:.5g}"
        )
        if not one.confirmed:
            said.append(
                f"{one.configuration}: solved as a model of its own this variant has {one.singly:.8g}: not confirmed"
            )
        return said

    def table(self) -> Table:
        columns = (
            Column("configuration"), Column("sought"), Column(self.quantity, self.unit), Column("as given", self.unit),
            *(Column(name, unit, digits=5) for name, unit in self.parameter_units.items()),
            Column("best at random", self.unit), Column("singly", self.unit), Column("variants"),
        )  # fmt: skip
        rows = tuple(
            (one.configuration, one.direction, one.value, one.nominal,
             *(one.variant[name] for name in self.parameter_units), one.best_at_random, one.singly, one.evaluations)
            for one in self.variants
        )  # fmt: skip
        return Table(f"{self.title}: worst case of {self.quantity}", columns, rows, self.sentences)

    def figure(self, plot: ModuleType, **look: Any) -> Figure:
        return plot.worst_variants(self, **look)  # type: ignore[no-any-return]
