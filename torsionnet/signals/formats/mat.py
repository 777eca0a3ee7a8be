"""Recordings and frequency responses in MAT files, v5 through scipy, v7.3, which is HDF5, through h5py.

A response has the variables frequencies, values (n_f x n_out x n_in), names and units, ready for Matlab.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.atomic import write_bytes
from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.signals import response_description
from torsionnet.signals.foreign import Content
from torsionnet.signals.foreign.content import ROW
from torsionnet.signals.formats import hdf5
from torsionnet.signals.formats.extras import open_foreign
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.arrays import array_source, with_left_out
from torsionnet.signals.records.exported_structures import structured_source, unknown_structures
from torsionnet.signals.records.source import (
    KEY,
    TIME,
    Source,
    channel_names,
    plain_keys,
    recording_json,
    saved_columns,
)
from torsionnet.signals.response_description import refuse_response, response_arrays, response_of_arrays

LONGEST_NAME = 63
"""Most characters of a variable's name that Matlab takes."""
LARGEST_VARIABLE = 2**31  # bytes of one variable
"""Most bytes of one variable that a MAT v5 file can hold."""
HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""First bytes of an HDF5 file, after MATLAB's own header, by which a MAT v7.3 file is recognised."""
VECTORS = ("frequencies", "conditioning")
"""Names of the arrays of a frequency response that have one value for each frequency."""
HEADER_TEXT_BYTES = 116
"""Number of bytes of free text at the beginning of a MAT v5 file, where scipy writes today's date."""


@contextlib.contextmanager
def open_source(path: Path) -> Iterator[Source]:
    """Yield the channels of a MAT file, from numeric variables, structures of test systems, and fields of others."""
    if _is_hdf5(path):
        with hdf5.open_source(path) as source:
            yield source
        return
    with open_foreign(path, "mat") as content:
        text = str(content.attributes.get(KEY, ""))
        known = None if text else structured_source(content.arrays, content.blocks, content.attributes, path.stem)
        hint = "" if text else unknown_structures(content.arrays)
        if not (text or known):
            refuse_response(content.arrays)
        source = known or replace(array_source(content.arrays, content.blocks, text, path.stem), hint=hint)
        yield with_left_out(source, content.others)


def _is_hdf5(path: Path) -> bool:
    with path.open("rb") as file:
        start = file.read(len(HDF5_SIGNATURE))
        file.seek(512)  # MATLAB puts its own header of 512 bytes first
        return HDF5_SIGNATURE in (start, file.read(len(HDF5_SIGNATURE)))


def write(recording: Recording, path: Path) -> None:
    """Write a MAT v5 file of one column in SI for every signal, with a description of the recording."""
    keys = plain_keys(channel_names(recording), "[^A-Za-z0-9_]|^(?=[^A-Za-z])", (TIME, KEY))
    longest = max([len(recording), *map(len, recording.pulses)])
    if any(len(key) > LONGEST_NAME for key in keys) or 8 * longest >= LARGEST_VARIABLE:
        raise UsageError(
            "a MAT v5 file takes names of 63 characters and 2 GB for each signal; write an .h5 or .npz file",
            kind="too-large",
        )
    keys = [f"x{key}" if key.startswith("_") else key for key in keys]
    content = {column.name: column.values for column in saved_columns(recording, keys)}
    write_bytes(path, mat_bytes({**content, KEY: recording_json(recording, keys)}))


def read_response(path: Path) -> FrequencyResponse:
    """Frequency response in SI from a MAT file that :func:`write_response` has written, or of arrays as Freq and H."""
    with open_foreign(path, "hdf5" if _is_hdf5(path) else "mat") as content:
        names = [item.name for item in content.arrays]
        plain = None if response_description.KEY in content.attributes else response_arrays(content.arrays)
        if plain:
            axis, *others = (_values(content, number) for number in (plain[0], *plain[1]))
            arrays = {names[number]: values for number, values in zip(plain[1], others, strict=True)}
            return response_of_arrays((names[plain[0]], axis), arrays, path)
        response_description.check_members([*names, *content.attributes, *content.others], path, "file", "has nothing")
        arrays = {name: _values(content, names.index(name)) for name in response_description.NUMBERS if name in names}
        text = str(content.attributes.get(response_description.KEY, ""))
    numbers = {name: values.ravel() if name in VECTORS else _cubic(values) for name, values in arrays.items()}
    return response_description.response_from(text, numbers | {"values": np.asarray(numbers["values"], dtype=complex)})


def _values(content: Content, number: int) -> Any:
    values = next(content.blocks([number], 0))[0]
    return values.T if content.arrays[number].attributes.get(ROW) else values


def _cubic(values: Any) -> Any:
    """Values with three dimensions, the third of which Matlab drops when it saves again, if it is one."""
    return values if values.ndim == 3 else values[:, :, None]


def write_response(response: FrequencyResponse, path: Path) -> None:
    """Write a MAT v5 file of the arrays of a frequency response in SI, and cell arrays of names and units."""
    sides = {"output": response.outputs, "input": response.inputs}
    names = {f"{side}_names": cell_array(channel.name for channel in channels) for side, channels in sides.items()}
    units = {f"{side}_units": cell_array(channel.unit for channel in channels) for side, channels in sides.items()}
    values = np.asarray(response.values, dtype=complex)
    content = {**response_description.arrays(response), "values": values, **names, **units, "title": response.title}
    write_bytes(path, mat_bytes({**content, response_description.KEY: response_description.description(response)}))


def mat_bytes(content: Mapping[str, Any]) -> memoryview:
    """Bytes of a MAT v5 file with these variables by name; equal content gives equal bytes."""
    from scipy.io import savemat

    buffer = io.BytesIO()
    write: Any = savemat  # takes a stream, whatever its types say
    write(buffer, dict(content), oned_as="column", long_field_names=True)
    image = buffer.getbuffer()
    image[:HEADER_TEXT_BYTES] = b"MATLAB 5.0 MAT-file, torsionnet".ljust(HEADER_TEXT_BYTES)
    return image


def cell_array(texts: Iterable[str]) -> Any:
    """Cell array of Matlab, (1, n), with a row of texts."""
    listed = list(texts)
    row = np.empty((1, len(listed)), dtype=object)
    row[0, :] = listed
    return row
