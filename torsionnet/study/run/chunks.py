"""Division of the variants of a study into chunks of fixed size."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil, gcd

from torsionnet.study.quantities.quantity_limit import QuantityLimit
from torsionnet.study.study import Study

KEPT_VALUES = 10_000_000
"""Largest number of values that a study keeps, 80 MB, those of a part of the variants where it has more."""


def kept_every(study: Study) -> int:
    """Number m with which every m-th variant of a study keeps its values, 1 where all do.

    m has no factor in common with the number of values on any axis, nor with two: of a grid every tenth variant could
    have one and the same value of a parameter, and every other point of a Sobol sequence lies in the same half.
    """
    if study.count * len(study.quantities) <= KEPT_VALUES:
        return 1
    model = study.model_in(study.configurations[0])
    forms = [one.measured(model, study.quantities) for one in study.quantities.values()]
    each = len(study.space.names) + sum(2 if form.is_curve else 1 for form in forms)
    every = ceil(study.count * each / KEPT_VALUES)
    while gcd(every, 2 * study.space.count) > 1:
        every += 1
    return every


def counted_limits(study: Study, every: int) -> dict[str, QuantityLimit]:
    """Limits, by quantity, by which variants are counted while they are calculated, sorted by name.

    None where all are kept.
    """
    return {} if every == 1 else dict(sorted(study.limits.items()))


@dataclass(frozen=True)
class Chunk:
    """Chunk of a study, the variants ``start`` to ``stop - 1`` of one configuration of the model."""

    number: int
    case: int
    start: int
    stop: int

    def __len__(self) -> int:
        return self.stop - self.start


@dataclass(frozen=True)
class Chunks:
    """Chunks of a study by number, those of the first configuration first.

    Attributes
    ----------
    cases : int
    count : int
        Number of variants in each case.
    size : int
        Number of variants in a chunk; the last one of a case may have fewer.

    Examples
    --------
    >>> chunks = Chunks(cases=2, count=250, size=100)
    >>> chunks.total, chunks[5]
    (6, Chunk(number=5, case=1, start=200, stop=250))
    """

    cases: int
    count: int
    size: int

    @property
    def each(self) -> int:
        """Number of chunks of variants in each configuration."""
        return ceil(self.count / self.size)

    @property
    def total(self) -> int:
        return self.cases * self.each

    def __getitem__(self, number: int) -> Chunk:
        if not 0 <= number < self.total:
            raise IndexError(f"chunks are 0 to {self.total - 1}, asked for {number}")
        case, place = divmod(number, self.each)
        start = place * self.size
        return Chunk(number, case, start, min(start + self.size, self.count))

    def side_by_side(self) -> Iterator[range]:
        """Numbers of the chunks with the same variants in all configurations, a range for each such group.

        >>> [list(numbers) for numbers in Chunks(cases=2, count=250, size=100).side_by_side()]
        [[0, 3], [1, 4], [2, 5]]
        """
        return (range(place, self.total, self.each) for place in range(self.each))
