"""Values of a chunk of variants, and the files of a study's folder that hold them."""

from __future__ import annotations

import io
import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import ceil, gcd
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.atomic import write_bytes
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.quantity import NOTHING_READ, QuantityLimit, VariantBlock, remark
from torsionnet.study.reductions.limit_counts import LimitFlags
from torsionnet.study.reductions.summaries import GrowingHistogram, Histogram, Moments, extremes, kept_indices
from torsionnet.study.study import Study

# Results of some variants of a study (kept values, moments, histograms, limits), and how they are joined.


@dataclass(frozen=True, eq=False)
class ChunkValues:
    """Results of a block or chunk of n variants, their kept values and statistics in SI.

    Attributes
    ----------
    kept : mapping
        Quantity -> values (n,) of the variants that are kept, NaN where one has none; of a quantity of several points
        its smallest and largest value over them, (n, 2). Where not all are kept, also parameter -> (n,) values.
    moments, histograms : mappings
        Quantity -> moments, histogram.
    impossible : int
        Number of variants whose values the model refuses.
    remarks : mapping
        Text of a warning -> how often.
    beyond : LimitFlags or None
        Variants beyond the limits; None where all values are kept.
    read : (2,) array
        Lowest and highest frequency in Hz at which laws over frequency are read.
    """

    kept: Mapping[str, FloatArray]
    moments: Mapping[str, Moments]
    histograms: Mapping[str, Histogram]
    impossible: int
    remarks: Mapping[str, int]
    beyond: LimitFlags | None = None
    read: FloatArray = field(default_factory=lambda: np.array(NOTHING_READ))

    @classmethod
    def of(cls, block: VariantBlock, start: int, every: int, limits: Mapping[str, QuantityLimit]) -> Self:
        """Results of a block of variants, the first of which has the index ``start``.

        Parameters
        ----------
        block : VariantBlock
        start : int
        every : int
            Every how many-th variant keeps its values; with 1 all do, and parameters are not kept.
        limits : mapping
            Quantity -> limit by which variants are counted.
        """
        chosen = kept_indices(start, start + len(block), every)
        values = {name: block.of(name) for name in block.quantities}
        kept = {name: own[chosen, 0] if own.shape[1] == 1 else extremes(own[chosen]) for name, own in values.items()}
        if every > 1:
            kept |= {name: column[chosen] for name, column in block.values.items()}
        return cls(
            kept,
            {name: Moments.of(part, start) for name, part in values.items()},
            {name: Histogram.of(part) for name, part in values.items()},
            int(block.impossible.sum()),
            block.remarks,
            _flags([(limit, values[name]) for name, limit in limits.items()]),
            block.read,
        )


def _flags(limited: Sequence[tuple[QuantityLimit, FloatArray]]) -> LimitFlags | None:
    if not limited:
        return None
    from torsionnet.study.reductions.limit_counts import LimitFlags

    return LimitFlags.of(limited)


@dataclass
class JoinedValues:
    """Results of blocks or chunks of variants that are joined in their order, in bounded memory.

    Attributes
    ----------
    sharing : int
        How many of these grow side by side, in the same memory.
    """

    sharing: int = 1
    kept: dict[str, list[FloatArray]] = field(default_factory=dict)
    moments: dict[str, Moments] = field(default_factory=dict)
    histograms: dict[str, GrowingHistogram] = field(default_factory=dict)
    impossible: int = 0
    remarks: Counter[str] = field(default_factory=Counter)
    beyond: list[LimitFlags] = field(default_factory=list)
    read: FloatArray = field(default_factory=lambda: np.array(NOTHING_READ))

    def add(self, part: ChunkValues) -> None:
        """Add the results of the next variants."""
        for name, moments in part.moments.items():
            self.moments[name] = self.moments[name].joined(moments) if name in self.moments else moments
            self.histograms.setdefault(name, GrowingHistogram(sharing=self.sharing)).add(part.histograms[name])
        for name, values in part.kept.items():
            self.kept.setdefault(name, []).append(values)
        self.impossible += part.impossible
        for text, count in part.remarks.items():
            remark(self.remarks, text, count)
        self.beyond += [] if part.beyond is None else [part.beyond]
        self.read = widest_span([self.read, part.read])

    def whole(self) -> ChunkValues:
        """Results of all variants added."""
        return ChunkValues(
            {name: np.concatenate(parts) for name, parts in self.kept.items()},
            self.moments,
            {name: parts.whole() for name, parts in self.histograms.items()},
            self.impossible,
            self.remarks,
            self.beyond[0].joined(self.beyond) if self.beyond else None,
            self.read,
        )


def widest_span(read: Sequence[FloatArray]) -> FloatArray:
    """Lowest and highest of several pairs (2,) of frequencies in Hz, :data:`NOTHING_READ` without any.

    >>> widest_span([np.array([2.0, 5.0]), np.array(NOTHING_READ), np.array([3.0, 9.0])]).tolist()
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
    forms = [quantity.measured(model, study.quantities) for quantity in study.quantities.values()]
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


# Files of a study's chunks of variants, npz archives with a checksum that are whole or not there.

PARTS = ("count", "mean", "squares", "smallest", "largest", "smallest_at", "largest_at")
"""Names of the arrays of moments in the file of a chunk of variants."""
CHECKSUM_BYTES = 32
"""Length in bytes of the SHA-256 checksum behind the end of a chunk's file."""
CHUNKS = "chunks"
"""Name of the folder of chunks in that of the study."""


def chunk_file(folder: Path, number: int) -> Path:
    """Path of the file with the values of one chunk of variants."""
    return folder / CHUNKS / f"{number:08d}.npz"


def write_chunk(folder: Path, number: int, values: ChunkValues) -> None:
    """Write the results of chunk ``number`` of variants to its file."""
    write_bytes(chunk_file(folder, number), chunk_bytes(values, number))


def read_chunk(folder: Path, number: int) -> ChunkValues | None:
    """Results of chunk ``number`` of variants, None where its file is missing, incomplete, changed or of another."""
    try:
        return chunk_of_bytes(chunk_file(folder, number).read_bytes(), number)
    except OSError:
        return None


def chunk_bytes(values: ChunkValues, number: int) -> bytes:
    """Content of the file of chunk ``number``, an npz archive and its checksum, equal bytes for equal values."""
    arrays: dict[str, NDArray[np.generic]] = {"read": values.read}
    for place, (name, moments) in enumerate(values.moments.items()):
        arrays[f"{'values' if values.kept[name].ndim == 1 else 'extremes'}_{place}"] = values.kept[name]
        arrays |= {f"{part}_{place}": getattr(moments, part) for part in PARTS}
        arrays[f"bins_{place}"] = values.histograms[name].bins
        arrays[f"counts_{place}"] = values.histograms[name].counts
    parameters = [name for name in values.kept if name not in values.moments]
    arrays |= {f"parameter_{place}": values.kept[name] for place, name in enumerate(parameters)}
    if values.beyond is not None:
        arrays |= {"beyond": np.packbits(values.beyond.flags, axis=1), "missing": values.beyond.missing}
    head = {
        "chunk": number,
        "quantities": list(values.moments),
        "parameters": parameters,
        "impossible": values.impossible,
        "remarks": dict(sorted(values.remarks.items())),
    }
    arrays["head"] = np.frombuffer(json.dumps(head).encode(), dtype=np.uint8)
    from hashlib import sha256  # OpenSSL, which studies in memory do without

    stream = io.BytesIO()
    np.savez_compressed(stream, allow_pickle=False, **arrays)
    return stream.getvalue() + sha256(stream.getvalue()).digest()


def chunk_of_bytes(data: bytes, number: int) -> ChunkValues | None:
    """Results of chunk ``number`` from the content of its file, None where that is damaged or another chunk."""
    from hashlib import sha256

    whole, checksum = data[:-CHECKSUM_BYTES], data[-CHECKSUM_BYTES:]
    if sha256(whole).digest() != checksum:
        return None
    with np.load(io.BytesIO(whole), allow_pickle=False) as arrays:
        read = {name: arrays[name] for name in arrays.files}
    head = json.loads(read["head"].tobytes())
    if head["chunk"] != number:
        return None
    places = dict(enumerate(head["quantities"]))
    keys = {name: (f"values_{place}", f"extremes_{place}") for place, name in places.items()}
    kept = {name: read[key] for name, either in keys.items() for key in either if key in read}
    beyond = np.unpackbits(read["beyond"], axis=1).astype(bool) if "beyond" in read else None
    return ChunkValues(
        kept | {name: read[f"parameter_{place}"] for place, name in enumerate(head["parameters"])},
        {name: Moments(*(read[f"{part}_{place}"] for part in PARTS)) for place, name in places.items()},
        {name: Histogram(read[f"bins_{place}"], read[f"counts_{place}"]) for place, name in places.items()},
        int(head["impossible"]),
        head["remarks"],
        None if beyond is None else LimitFlags(beyond, read["missing"]),
        read.get("read", np.array(NOTHING_READ)),
    )
