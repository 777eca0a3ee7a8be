"""The space of a study as tolerances around designs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import UsageError
from torsionnet.study.design.design_tolerances import even_shares, random_shares
from torsionnet.study.space.space import Space


@dataclass(frozen=True, eq=False)
class SpaceDraws:
    """Draws of a space; those of a parameter that is designed are moved in proportion to the design.

    Attributes
    ----------
    drawn : mapping
        Values (count,) around the model as it stands.
    nominal : mapping
        Values in the model.
    """

    drawn: Mapping[str, FloatArray]
    nominal: Mapping[str, float]

    @property
    def count(self) -> int:
        """Samples of each design."""
        return len(next(iter(self.drawn.values())))

    def around(self, designs: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Values (n * count,) of all parameters, the samples of the first of n designs first."""
        size = len(next(iter(designs.values())))
        found = {name: np.repeat(values, self.count) for name, values in designs.items()}
        for name, drawn in self.drawn.items():
            if name in designs:
                found[name] = np.outer(designs[name] / self.nominal[name], drawn).ravel()
            else:
                found[name] = np.tile(drawn, size)
        return found


@dataclass(frozen=True, eq=False)
class SpaceTolerances:
    """Distributions of a study around its model; correlation is kept."""

    space: Space
    designed: tuple[str, ...]

    def __post_init__(self) -> None:
        if not self.space.random_names:
            raise UsageError("a robust design needs the tolerance of a parameter: a distribution under vary")
        for name in self.designed:
            if name in self.space.random_names and not self.space.nominal[name] > 0:
                raise UsageError(
                    f"{name} is {self.space.nominal[name]:g} in the model: its tolerance has no proportion"
                )

    def evenly(self, count: int, seed: int) -> SpaceDraws:
        """Draws of a scrambled Sobol sequence; ``count`` is rounded up to a power of two."""
        return self._drawn(even_shares(len(self.space.random_names), count, seed))

    def randomly(self, count: int, seed: int) -> SpaceDraws:
        """Independent draws."""
        return self._drawn(random_shares(len(self.space.random_names), count, seed))

    def _drawn(self, shares: FloatArray) -> SpaceDraws:
        return SpaceDraws(self.space.from_unit(shares), self.space.nominal)
