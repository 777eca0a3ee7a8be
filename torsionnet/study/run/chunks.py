"""The variants of a study in parts of a fixed size, whoever calculates them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil


@dataclass(frozen=True)
class Chunk:
    """Variants ``start`` to ``stop - 1`` of one case, a configuration of the model."""

    number: int
    case: int
    start: int
    stop: int

    def __len__(self) -> int:
        return self.stop - self.start


@dataclass(frozen=True)
class Chunks:
    """All chunks of a study by number, those of the first case first.

    Attributes
    ----------
    cases : int
    count : int
        Variants in each case.
    size : int
        Variants in a chunk; the last one of a case may have fewer.

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
        """Chunks of a case."""
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
        """Numbers of all chunks, those of the same variants in all cases together.

        >>> [list(numbers) for numbers in Chunks(cases=2, count=250, size=100).side_by_side()]
        [[0, 3], [1, 4], [2, 5]]
        """
        return (range(place, self.total, self.each) for place in range(self.each))
