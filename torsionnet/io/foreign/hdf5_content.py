"""Reading of HDF5 files, and of MAT v7.3 files, which are HDF5, with every dataset of numbers inside the file."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsionnet.io.foreign.content import (
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

ATTRIBUTES = (*UNIT_NAMES, "quantity")
"""Attributes of HDF5 datasets that are passed on to the reading process."""
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
        yield Content(tuple(arrays), blocks, texts | _attributes(file))


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
            found[name] = item.attrs[name]
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
    return bool(not text and not name.startswith("#") and known)


def _is_across(item: Any, transposed: bool) -> bool:
    # A row of MATLAB has one column in the file, and is a channel like a column of its.
    return bool(item.ndim == 2 and ((transposed and item.shape[1] != 1) or item.shape[0] == 1))


def _stored(name: str, item: Any, transposed: bool) -> StoredArray:
    rows, columns = (*item.shape, 1, 1)[:2]
    shape = (columns, rows) if _is_across(item, transposed) else (rows, columns)
    given = plain_attributes({key: item.attrs[key] for key in ATTRIBUTES if key in item.attrs})
    value = float(item[()].ravel()[0]) if shape == (1, 1) else None
    return StoredArray(name.replace("/", "."), shape, given, value)


def _reader(item: Any, *, across: bool) -> Slice:
    def read(first: int, last: int) -> NDArray[Any]:
        if item.ndim == 0:
            return item[()].reshape(1)  # type: ignore[no-any-return]
        values: NDArray[Any] = item[:, first:last].T if across else item[first:last]
        return values

    return read
