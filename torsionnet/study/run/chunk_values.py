"""Results of a chunk of variants (kept values, moments, histograms, bits of limits) and their file format."""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import ceil, gcd

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.quantity import QuantityLimit
from torsionnet.study.quantities.variant_block import NOTHING_READ
from torsionnet.study.reductions.limit_counts import LimitBits
from torsionnet.study.reductions.summaries import Histogram, Moments
from torsionnet.study.study import Study

PARTS = ("count", "mean", "squares", "smallest", "largest", "smallest_at", "largest_at")
"""Names of the arrays of moments in the file of a chunk of variants."""
CHECKSUM_BYTES = hashlib.sha256().digest_size
"""Length in bytes of the SHA-256 checksum behind the end of a chunk's file."""


class DamagedChunk(Exception):  # noqa: N818  (it is no fault of anybody: the chunk is done again)
    """Error of a chunk's file whose bytes are incomplete, changed or of another chunk."""


@dataclass(frozen=True, eq=False)
class ChunkValues:
    """Results of a chunk of n variants, their kept values and statistics in SI.

    Attributes
    ----------
    values : mapping
        Quantity that is a number -> values of the kept variants, all n or fewer; NaN where a variant has none.
    moments, histograms : mappings
        Quantity -> moments, histogram.
    impossible : int
        Number of variants whose values the model refuses.
    remarks : mapping
        Text of a warning -> how often.
    extremes : mapping
        Quantity of several points -> (n, 2), its smallest and largest value over them, of the variants that are kept.
    parameters : mapping
        Parameter -> (n,) values, where only a part of the variants is kept; else empty.
    beyond : LimitBits or None
        Variants beyond the limits; None where all values are kept.
    read : (2,) array
        Lowest and highest frequency in Hz at which laws over frequency are read.
    """

    values: Mapping[str, FloatArray]
    moments: Mapping[str, Moments]
    histograms: Mapping[str, Histogram]
    impossible: int
    remarks: Mapping[str, int]
    extremes: Mapping[str, FloatArray] = field(default_factory=dict)
    parameters: Mapping[str, FloatArray] = field(default_factory=dict)
    beyond: LimitBits | None = None
    read: FloatArray = field(default_factory=lambda: np.array(NOTHING_READ))

    def to_bytes(self, number: int) -> bytes:
        """Content of the file of chunk ``number``, an npz archive and its checksum, equal bytes for equal values."""
        arrays: dict[str, NDArray[np.generic]] = {"read": self.read}
        for place, name in enumerate(self.moments):
            if name in self.values:
                arrays[f"values_{place}"] = self.values[name]
            if name in self.extremes:
                arrays[f"extremes_{place}"] = self.extremes[name]
            for part in PARTS:
                arrays[f"{part}_{place}"] = getattr(self.moments[name], part)
            arrays[f"bins_{place}"] = self.histograms[name].bins
            arrays[f"counts_{place}"] = self.histograms[name].counts
        for place, column in enumerate(self.parameters.values()):
            arrays[f"parameter_{place}"] = column
        if self.beyond is not None:
            arrays |= {"beyond": self.beyond.bits, "missing": self.beyond.missing}
        head = {
            "chunk": number,
            "quantities": list(self.moments),
            "parameters": list(self.parameters),
            "impossible": self.impossible,
            "remarks": dict(sorted(self.remarks.items())),
        }
        arrays["head"] = np.frombuffer(json.dumps(head).encode(), dtype=np.uint8)
        stream = io.BytesIO()
        np.savez_compressed(stream, allow_pickle=False, **arrays)
        return stream.getvalue() + hashlib.sha256(stream.getvalue()).digest()

    @classmethod
    def from_bytes(cls, data: bytes, number: int) -> ChunkValues:
        """Read the results of chunk ``number`` of variants from the content of its file.

        Raises
        ------
        DamagedChunk
            Something is missing or changed, or it is another chunk.
        """
        whole, checksum = data[:-CHECKSUM_BYTES], data[-CHECKSUM_BYTES:]
        if hashlib.sha256(whole).digest() != checksum:
            raise DamagedChunk
        with np.load(io.BytesIO(whole), allow_pickle=False) as arrays:
            found = {name: arrays[name] for name in arrays.files}
        head = json.loads(found["head"].tobytes())
        if head["chunk"] != number:
            raise DamagedChunk
        places = dict(enumerate(head["quantities"]))
        return cls(
            {name: found[f"values_{place}"] for place, name in places.items() if f"values_{place}" in found},
            {name: Moments(*(found[f"{part}_{place}"] for part in PARTS)) for place, name in places.items()},
            {name: Histogram(found[f"bins_{place}"], found[f"counts_{place}"]) for place, name in places.items()},
            int(head["impossible"]),
            head["remarks"],
            {name: found[f"extremes_{place}"] for place, name in places.items() if f"extremes_{place}" in found},
            {name: found[f"parameter_{place}"] for place, name in enumerate(head["parameters"])},
            LimitBits(found["beyond"], found["missing"]) if "beyond" in found else None,
            found.get("read", np.array(NOTHING_READ)),
        )


def widest(read: Sequence[FloatArray]) -> FloatArray:
    """Lowest and highest of several pairs (2,) of frequencies in Hz, :data:`NOTHING_READ` without any.

    >>> widest([np.array([2.0, 5.0]), np.array(NOTHING_READ), np.array([3.0, 9.0])]).tolist()
    [2.0, 9.0]
    """
    low, high = np.array([NOTHING_READ, *read]).T
    return np.array([low.min(), high.max()])


# Division of the variants of a study into chunks of fixed size.

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
