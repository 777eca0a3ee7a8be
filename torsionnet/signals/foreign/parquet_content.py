"""Reading of Parquet files through pyarrow, with columns of numbers, and of times, which become seconds."""

from __future__ import annotations

import contextlib
import importlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import torsionnet.signals.foreign.content as resource_limits
from torsionnet.signals.foreign.content import Blocks, Content, Plain, StoredArray, plain_attributes

if TYPE_CHECKING:
    from numpy.typing import NDArray

BATCH_ROWS = 1 << 16
"""Rows of a Parquet file that are decoded at a time, as more take more memory, fewer more time."""
SECONDS_PER_UNIT = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
"""Seconds in each unit of time of pyarrow."""


def load() -> None:
    """Import pyarrow.parquet for Parquet files before the limits of memory and time begin."""
    import pyarrow.parquet  # noqa: F401

    # pyarrow itself imports pandas where that is installed, at the first missing value; on a slow machine that alone
    # takes longer than a small file is given.
    with contextlib.suppress(ImportError):
        importlib.import_module("pandas")


@contextlib.contextmanager
def open_content(path: Path) -> Iterator[Content]:
    """Yield the columns of a Parquet file with their metadata, times counted in s from their first entry (``zero``)."""
    from pyarrow.parquet import ParquetFile

    with ParquetFile(path) as file:
        schema = file.schema_arrow
        resource_limits.check(resource_limits.BYTES_PER_SAMPLE * file.metadata.num_rows * len(schema), path)
        every = [schema.field(number) for number in range(len(schema))]
        columns = [column for column in every if _is_numeric(column) or _is_time(column)]
        others = tuple(column.name for column in every if column not in columns)
        zeros = _common_zeros({column.name: _first(file, column.name) for column in columns if _is_time(column)})
        arrays = [StoredArray(column.name, (file.metadata.num_rows,), _attributes(column, zeros)) for column in columns]
        blocks = _blocks(file, columns, zeros)
        yield Content(tuple(arrays), blocks, plain_attributes(_decoded(schema.metadata)), others)


def _decoded(metadata: Any) -> dict[str, str]:
    return {key.decode(errors="replace"): value.decode(errors="replace") for key, value in (metadata or {}).items()}


def _attributes(column: Any, zeros: dict[str, Any]) -> dict[str, Plain]:
    zero = zeros.get(column.name)
    return plain_attributes(_decoded(column.metadata)) | (
        {"zero": "" if zero is None else str(zero)} if column.name in zeros else {}
    )


def _is_numeric(column: Any) -> bool:
    from pyarrow import types

    kind = column.type
    return bool(types.is_integer(kind) or types.is_floating(kind) or types.is_boolean(kind) or types.is_decimal(kind))


def _is_time(column: Any) -> bool:
    from pyarrow import types

    return bool(types.is_timestamp(column.type) or types.is_duration(column.type) or types.is_time(column.type))


def _first(file: Any, name: str) -> Any:
    """First entry of a Parquet column that is not null, as a scalar of pyarrow, None if there is none."""
    for batch in file.iter_batches(batch_size=BATCH_ROWS, columns=[name]):
        known = batch.column(0).drop_null()
        if len(known):
            return known[0]
    return None


def _common_zeros(firsts: dict[str, Any]) -> dict[str, Any]:
    """First entries of columns of times, that of the first column for all of its kind, so that they share a clock."""
    import pyarrow as pa

    dates = [first for first in firsts.values() if first is not None and pa.types.is_timestamp(first.type)]
    return {name: dates[0].cast(first.type, safe=False) if first in dates else first for name, first in firsts.items()}


def _seconds(column: Any, zero: Any) -> NDArray[Any]:
    """Seconds (n,) of a column of times since ``zero``, by differences of whole numbers, so that no digit is lost."""
    import numpy as np
    import pyarrow as pa

    whole = pa.int32() if pa.types.is_time32(column.type) else pa.int64()
    ticks = column.cast(whole).cast(pa.int64())
    start = 0 if zero is None else zero.cast(whole).as_py()
    counts = ticks.fill_null(start).to_numpy(zero_copy_only=False) - start
    seconds = np.asarray(counts * SECONDS_PER_UNIT[column.type.unit], dtype=float)
    seconds[np.asarray(column.is_null().to_numpy(zero_copy_only=False), dtype=bool)] = np.nan
    return seconds


def _blocks(file: Any, columns: Sequence[Any], zeros: dict[str, Any]) -> Blocks:
    import numpy as np

    def values(column: Any, name: str) -> NDArray[Any]:
        if name in zeros:
            return _seconds(column, zeros[name])
        return np.asarray(column.to_numpy(zero_copy_only=False), dtype=float)

    def blocks(numbers: Sequence[int], count: int) -> Iterator[list[NDArray[Any]]]:
        names = [columns[number].name for number in numbers]
        kept: list[list[NDArray[Any]]] = [[] for _ in names]
        have = 0
        for batch in file.iter_batches(
            batch_size=min(count or BATCH_ROWS, BATCH_ROWS), columns=list(dict.fromkeys(names))
        ):
            for store, name in zip(kept, names, strict=True):
                store.append(values(batch.column(name), name))
            have += len(batch)
            while count and have >= count:
                joined = [np.concatenate(store) for store in kept]
                yield [column[:count] for column in joined]
                kept, have = [[column[count:]] for column in joined], have - count
        if have:
            yield [np.concatenate(store) for store in kept]

    return blocks
