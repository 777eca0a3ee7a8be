"""Reading of HDF5 files, and of MAT v7.3 files, which are HDF5, with every dataset of numbers inside the file."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsionnet.io.foreign.content import (
    FACTOR_NAMES,
    INTERVAL_NAMES,
    OFFSET_NAMES,
    RATE_NAMES,
    START_NAMES,
    UNIT_NAMES,
    Content,
    ForeignFileError,
    Plain,
    Slice,
    StoredArray,
    plain_attributes,
    sliced_blocks,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

SCALE, OFFSET, FILLS = "scale_factor", "add_offset", ("_FillValue", "missing_value")
"""Attributes of datasets whose values are packed (CF conventions): multiplied, then added to, but for missing ones."""
CLOCK_NAMES = (*RATE_NAMES, *INTERVAL_NAMES, *START_NAMES)
"""Attributes of a dataset, or of a group for its datasets, that tell the times of the samples."""
ATTRIBUTES = (*UNIT_NAMES, *CLOCK_NAMES, "quantity", SCALE, OFFSET, *FILLS, *FACTOR_NAMES, *OFFSET_NAMES)
"""Attributes of HDF5 datasets that are passed on to the reading process."""
NO_SCALE = "This is a netCDF dimension"
"""Beginning of the name of a dimension scale that netCDF writes for a dimension without coordinates."""
CLASS = "MATLAB_class"
"""Attribute of a dataset in which MATLAB keeps the class of a variable."""
MOST_LETTERS = 1000
"""Most letters of a text in a structure, and cells of an array of texts, that are read from an HDF5 file."""
HERE = "."
"""Name by which a virtual dataset of HDF5 refers to its own file."""


def load() -> None:
    """Import h5py for HDF5 files before the limits of memory and time begin."""
    import h5py  # noqa: F401


@contextlib.contextmanager
def open_content(path: Path) -> Iterator[Content]:
    """Yield the datasets of numbers of an HDF5 file, those of MATLAB with rows and columns exchanged."""
    import h5py

    with h5py.File(path, "r") as file:
        found = _datasets(file)
        # MATLAB keeps rows and columns the other way round, and text and references as numbers.
        matlab = any(CLASS in item.attrs for _, item in found)
        kept = [(name, item) for name, item in found if _is_channel(name, item)]
        arrays = [_stored(name, item, matlab) for name, item in kept]
        readers = [_reader(item, across=_is_across(item, matlab)) for _, item in kept]
        texts = dict(_texts(file, found)) if matlab else {}
        blocks = sliced_blocks(readers, [item.length for item in arrays])
        others = [name.replace("/", ".") for name, item in found if _is_other(name, item)]
        yield Content(tuple(arrays), blocks, texts | _attributes(file), tuple(others))


def _datasets(file: Any) -> list[tuple[str, Any]]:
    import h5py

    links: list[tuple[str, Any]] = []
    file.visititems_links(lambda name, link: links.append((name, link)))
    for name, link in links:
        if isinstance(link, h5py.ExternalLink):
            raise ForeignFileError(_elsewhere(name, link.filename))
    found: list[tuple[str, Any]] = []
    file.visititems(lambda name, item: found.append((name, item)) if isinstance(item, h5py.Dataset) else None)
    for name, item in found:
        for other in _other_files(item):
            raise ForeignFileError(_elsewhere(name, other))
    return found


def _other_files(item: Any) -> list[str]:
    """Names of other files that hold samples of a dataset, as external storage or as sources of a virtual dataset."""
    if item.is_virtual:
        return [source.file_name for source in item.virtual_sources() if source.file_name != HERE]
    return [part[0] for part in item.external or ()]


def _elsewhere(name: str, other: Any) -> str:
    return f'dataset "{name}" keeps its samples in another file, "{other}"; only what is inside the file is read'


def _attributes(item: Any) -> dict[str, Plain]:
    """Attributes of a dataset or file, by name, that h5py can decode and that are text or a number."""
    found: dict[str, Any] = {}
    for name in item.attrs:
        with contextlib.suppress(TypeError):
            found[name] = _single(item.attrs[name])
    return plain_attributes(found)


def _texts(file: Any, found: list[tuple[str, Any]]) -> Iterator[tuple[str, Plain]]:
    """Yield the texts in structures of MATLAB, also those in cells, by their names."""
    for name, item in found:
        kind = item.attrs.get(CLASS, b"")
        if "/" not in name or name.startswith("#") or item.size > MOST_LETTERS:
            continue
        label = name.replace("/", ".")
        if kind in (b"char", "char") and item.dtype.kind == "u":
            yield label, _letters(item)
        elif kind in (b"cell", "cell") and item.dtype.kind == "O":
            for number, reference in enumerate(item[()].ravel(), 1):
                cell: Any = file[reference] if reference else None
                if getattr(getattr(cell, "dtype", None), "kind", "") == "u" and cell.size <= MOST_LETTERS:
                    yield f"{label}{{{number}}}", _letters(cell)


def _letters(item: Any) -> str:
    return "".join(chr(int(code)) for code in item[()].ravel() if code)


def _is_channel(name: str, item: Any) -> bool:
    text = item.attrs.get(CLASS, b"double") in (b"char", b"cell", "char", "cell")
    known = item.dtype.kind in "fiub" and item.shape is not None and 0 <= item.ndim <= 2
    return bool(not text and not name.startswith("#") and known and not _is_bare_dimension(item))


def _is_bare_dimension(item: Any) -> bool:
    """Whether a dataset stands for a dimension of netCDF without coordinates, and has no values of its own."""
    return str(item.attrs.get("NAME", "")).removeprefix("b'").startswith(NO_SCALE)


def _is_other(name: str, item: Any) -> bool:
    """Whether a dataset holds numbers, but no columns of them: a table of fields, complex ones, or a picture."""
    text = item.attrs.get(CLASS, b"double") in (b"char", b"cell", "char", "cell")
    return bool(item.dtype.kind in "fiubcV" and item.size and not text and not name.startswith("#")) and not (
        _is_channel(name, item) or _is_bare_dimension(item)
    )


def _is_across(item: Any, transposed: bool) -> bool:
    # A row of MATLAB has one column in the file, and is a channel like a column of its.
    return bool(item.ndim == 2 and ((transposed and item.shape[1] != 1) or item.shape[0] == 1))


def _stored(name: str, item: Any, transposed: bool) -> StoredArray:
    rows, columns = (*item.shape, 1, 1)[:2]
    shape = (columns, rows) if _is_across(item, transposed) else (rows, columns)
    above = plain_attributes({key: _single(item.parent.attrs[key]) for key in CLOCK_NAMES if key in item.parent.attrs})
    given = plain_attributes({key: _single(item.attrs[key]) for key in ATTRIBUTES if key in item.attrs})
    for names in ((*RATE_NAMES, *INTERVAL_NAMES), START_NAMES):
        above = above if given.keys().isdisjoint(names) else {key: above[key] for key in above.keys() - {*names}}
    given = ({} if item.parent.name == "/" else above) | given | _scale_of_times(item)
    value = float(item[()].ravel()[0]) if shape == (1, 1) else None
    return StoredArray(name.replace("/", "."), shape, given, value)


def _single(value: Any) -> Any:
    """Value of an attribute, of arrays of one entry the entry, as netCDF writes all attributes as arrays."""
    return value.ravel()[0] if getattr(value, "shape", ()) and value.size == 1 else value


def _scale_of_times(item: Any) -> dict[str, Plain]:
    """Name of the dimension scale of the samples of a dataset, as ``clock``, where it has one beside itself.

    One without values tells which datasets were sampled together.
    """
    if not item.ndim or not len(item.dims[0]):
        return {}
    scale = item.dims[0][0]
    return {"clock": scale.name.strip("/").replace("/", ".")} if scale.name != item.name else {}


def _reader(item: Any, *, across: bool) -> Slice:
    import numpy as np

    given = {key: _single(item.attrs[key]) for key in (SCALE, OFFSET, *FILLS) if key in item.attrs}
    fills = [given[key] for key in FILLS if key in given]
    try:
        scale, offset = float(given.get(SCALE, 1.0)), float(given.get(OFFSET, 0.0))
    except (TypeError, ValueError):
        raise ForeignFileError(f'dataset "{item.name}" has a {SCALE} or {OFFSET} that is not one number') from None

    def unpacked(values: NDArray[Any]) -> NDArray[Any]:
        if not given:
            return values
        found = np.array(values, dtype=float)
        found[np.isin(values, fills)] = np.nan
        return found * scale + offset

    def read(first: int, last: int) -> NDArray[Any]:
        if item.ndim == 0:
            return unpacked(item[()].reshape(1))
        return unpacked(item[:, first:last].T if across else item[first:last])

    return read
