"""Recordings in Parquet files, through pyarrow, with every numeric column as a channel."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from torsionnet.base.atomic import atomic_replacement
from torsionnet.base.delimited.dialect import split_heading
from torsionnet.signals.foreign import StoredArray
from torsionnet.signals.formats.extras import import_extra, open_foreign
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.arrays import channel_of, with_left_out, with_table_clocks
from torsionnet.signals.records.source import KEY, FileChannel, Source, recording_json, saved_columns, with_description

ROWS_PER_GROUP = 1 << 20
"""Rows of a row group of a Parquet file that is written, 8 MB a column, which is what is in memory at once."""
ZERO_ATTRIBUTE = "zero"
"""Attribute of a column of times with its first entry, from which the seconds count."""


@contextlib.contextmanager
def open_source(path: Path) -> Iterator[Source]:
    """Yield the channels of a Parquet file, with units from metadata or names of columns, and times in seconds."""
    with open_foreign(path, "parquet") as content:
        text = str(content.attributes.get(KEY, ""))
        channels = [_channel(item, number, plain=bool(text)) for number, item in enumerate(content.arrays)]
        source = Source(tuple(channels), content.blocks, title=path.stem, notes=_zero_notes(content.arrays))
        if text:
            yield with_description(source, text)
        else:
            yield with_left_out(with_table_clocks(source.with_time_channel()), content.others)


def _channel(item: StoredArray, number: int, *, plain: bool) -> FileChannel:
    name, unit = (item.name, "") if plain else split_heading(item.name)
    unit = "s" if ZERO_ATTRIBUTE in item.attributes else str(item.attributes.get("unit", unit))
    return channel_of(item, number, name, unit)


def _zero_notes(items: Sequence[StoredArray]) -> tuple[str, ...]:
    zeros = [(item.name, item.attributes.get(ZERO_ATTRIBUTE)) for item in items]
    return tuple(f"{name} counts from {zero}, the first entry" for name, zero in zeros if zero)


def write(recording: Recording, path: Path) -> None:
    """Write a Parquet file of one column in SI for every signal, with units as metadata."""
    columns = saved_columns(recording)
    parquet = import_extra("parquet")
    import pyarrow as pa

    fields = [pa.field(column.name, pa.float64(), metadata=column.attributes) for column in columns]
    schema = pa.schema(fields, metadata={KEY: recording_json(recording)})
    with atomic_replacement(path) as temporary, parquet.ParquetWriter(temporary, schema) as writer:
        for first in range(0, len(recording), ROWS_PER_GROUP):
            arrays = [
                pa.array(np.asarray(column.values[first : first + ROWS_PER_GROUP], dtype=float)) for column in columns
            ]
            writer.write_table(pa.Table.from_arrays(arrays, schema=schema))
