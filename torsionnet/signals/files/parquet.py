"""Parquet files, through pyarrow: every numeric column is a channel."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.atomic import replacing
from torsionnet.signals.files.extras import needed
from torsionnet.signals.files.headings import split_heading
from torsionnet.signals.files.source import Channel, Source
from torsionnet.signals.files.stored import KEY, TIME, checked_names, stored, with_stored
from torsionnet.signals.recording import FloatArray, Recording

BATCH, GROUP = 1 << 16, 1 << 20


@contextlib.contextmanager
def opened(path: Path) -> Iterator[Source]:
    """A Parquet file; units are in the metadata of columns, or in their names in brackets."""
    parquet = needed("parquet")
    with parquet.ParquetFile(path) as file:
        schema = file.schema_arrow
        text = (schema.metadata or {}).get(KEY.encode(), b"").decode()
        channels = [
            _channel(schema.field(number), number, file.metadata.num_rows, plain=bool(text))
            for number in range(len(schema))
            if _is_numeric(schema.field(number))
        ]
        source = Source(tuple(channels), _blocks(file, schema.names), title=path.stem)
        yield with_stored(source, text) if text else source.with_time_found()


def _is_numeric(column: Any) -> bool:
    with contextlib.suppress(NotImplementedError):
        return np.dtype(column.type.to_pandas_dtype()).kind in "fiub"
    return False


def _channel(column: Any, number: int, length: int, *, plain: bool) -> Channel:
    metadata = {key.decode(): value.decode() for key, value in (column.metadata or {}).items()}
    name, unit = (column.name, "") if plain else split_heading(column.name)
    return Channel(name, number, metadata.get("unit", unit), metadata.get("quantity") or None, length)


def _blocks(file: Any, names: Sequence[str]) -> Any:
    def blocks(columns: Sequence[int], count: int) -> Iterator[list[FloatArray]]:
        wanted = [names[column] for column in columns]
        kept: list[list[FloatArray]] = [[] for _ in columns]
        have = 0
        for batch in file.iter_batches(batch_size=min(count or BATCH, BATCH), columns=list(dict.fromkeys(wanted))):
            for store, name in zip(kept, wanted, strict=True):
                store.append(np.asarray(batch.column(name).to_numpy(zero_copy_only=False), dtype=float))
            have += len(batch)
            while count and have >= count:
                joined = [np.concatenate(store) for store in kept]
                yield [values[:count] for values in joined]
                kept, have = [[values[count:]] for values in joined], have - count
        if have:
            yield [np.concatenate(store) for store in kept]

    return blocks


def write(recording: Recording, path: Path) -> None:
    """A Parquet file of one column for every signal, with units as metadata."""
    checked_names(recording)
    parquet = needed("parquet")
    import pyarrow as pa

    fields = [
        pa.field(signal.name, pa.float64(), metadata={"unit": signal.unit, "quantity": signal.quantity})
        for signal in recording
    ]
    columns = [signal.values for signal in recording]
    if recording.times is not None:
        fields.append(pa.field(TIME, pa.float64(), metadata={"unit": "s"}))
        columns.append(recording.times)
    schema = pa.schema(fields, metadata={KEY: stored(recording)})
    with replacing(path) as temporary, parquet.ParquetWriter(temporary, schema) as writer:
        for first in range(0, len(recording), GROUP):
            arrays = [pa.array(np.asarray(values[first : first + GROUP], dtype=float)) for values in columns]
            writer.write_table(pa.Table.from_arrays(arrays, schema=schema))
