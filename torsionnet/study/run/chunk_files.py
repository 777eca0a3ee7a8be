"""Files of a study's chunks of variants, npz archives with a checksum that are whole or not there."""

from __future__ import annotations

import hashlib
import io
import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.atomic import write_bytes
from torsionnet.study.quantities.variant_block import NOTHING_READ
from torsionnet.study.reductions.limit_counts import LimitFlags
from torsionnet.study.reductions.summaries import Histogram, Moments
from torsionnet.study.run.chunk_values import ChunkValues

PARTS = ("count", "mean", "squares", "smallest", "largest", "smallest_at", "largest_at")
"""Names of the arrays of moments in the file of a chunk of variants."""
CHECKSUM_BYTES = hashlib.sha256().digest_size
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
    stream = io.BytesIO()
    np.savez_compressed(stream, allow_pickle=False, **arrays)
    return stream.getvalue() + hashlib.sha256(stream.getvalue()).digest()


def chunk_of_bytes(data: bytes, number: int) -> ChunkValues | None:
    """Results of chunk ``number`` from the content of its file, None where that is damaged or another chunk."""
    whole, checksum = data[:-CHECKSUM_BYTES], data[-CHECKSUM_BYTES:]
    if hashlib.sha256(whole).digest() != checksum:
        return None
    with np.load(io.BytesIO(whole), allow_pickle=False) as arrays:
        found = {name: arrays[name] for name in arrays.files}
    head = json.loads(found["head"].tobytes())
    if head["chunk"] != number:
        return None
    places = dict(enumerate(head["quantities"]))
    keys = {name: (f"values_{place}", f"extremes_{place}") for place, name in places.items()}
    kept = {name: found[key] for name, either in keys.items() for key in either if key in found}
    beyond = np.unpackbits(found["beyond"], axis=1).astype(bool) if "beyond" in found else None
    return ChunkValues(
        kept | {name: found[f"parameter_{place}"] for place, name in enumerate(head["parameters"])},
        {name: Moments(*(found[f"{part}_{place}"] for part in PARTS)) for place, name in places.items()},
        {name: Histogram(found[f"bins_{place}"], found[f"counts_{place}"]) for place, name in places.items()},
        int(head["impossible"]),
        head["remarks"],
        None if beyond is None else LimitFlags(beyond, found["missing"]),
        found.get("read", np.array(NOTHING_READ)),
    )
