"""Results of a chunk of variants (kept values, moments, histograms, bits of limits) and their file format."""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.variant_block import NOTHING_READ
from torsionnet.study.reductions.histogram import Histogram
from torsionnet.study.reductions.limit_counts import LimitBits
from torsionnet.study.reductions.moments import Moments

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
