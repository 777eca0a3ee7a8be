"""Reading of HDF5 files, and of MAT v7.3 files, which are HDF5, with every dataset of numbers inside the file."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsionnet.signals.foreign.content import (
    COMPLEX,
    FACTOR_NAMES,
    INTERVAL_NAMES,
    MISSING,
    OFFSET_NAMES,
    RATE_NAMES,
    START_NAMES,
    UNIT_NAMES,
    WAVE_INTERVAL,
    WAVE_NAME,
    WAVE_OFFSET,
    WAVE_START,
    WAVE_UNIT,
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

SCALE, OFFSET, LIMITS = "scale_factor", "add_offset", ("valid_range", "valid_min", "valid_max")
"""Attributes of datasets whose values are packed (CF conventions): multiplied, then added to, but for missing ones."""
WRITTEN_BY_NETCDF = "_NCProperties"
"""Attribute of the files that the netCDF library wrote."""
NETCDF_FILLS = {
    "i2": (-32767,), "u2": (65535,), "i4": (-2147483647,), "u4": (4294967295,), "f4": (9.969209968386869e36,),
    "f8": (9.969209968386869e36,),
}  # fmt: skip
"""Values that the netCDF library puts where nothing was written, by type, unless a dataset says others."""
STAMP = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d(?:\.\d{1,9})?Z?")
"""Pattern of time stamps as texts, in UTC."""
NO_START = datetime(1904, 1, 1, tzinfo=UTC)
"""Time at which channels began of which LabVIEW knows none."""
CLOCK_NAMES = (*RATE_NAMES, *INTERVAL_NAMES, *START_NAMES)
"""Attributes of a dataset, or of a group for its datasets, that tell the times of the samples."""
WAVE_NAMES = (WAVE_INTERVAL, WAVE_OFFSET, WAVE_START, WAVE_UNIT, WAVE_NAME)
ATTRIBUTES = (*UNIT_NAMES, *CLOCK_NAMES, *WAVE_NAMES, "quantity", SCALE, OFFSET, *FACTOR_NAMES, *OFFSET_NAMES)
"""Attributes of HDF5 datasets that are passed on to the reading process."""
NO_SCALE = "This is a netCDF dimension"
"""Beginning of the name of a dimension scale that netCDF writes for a dimension without coordinates."""
CLASS = "MATLAB_class"
"""Attribute of a dataset in which MATLAB keeps the class of a variable."""
PARTS = ("real", "imag")
"""Fields in which MATLAB keeps complex numbers."""
MOST_LETTERS, LONGEST_VARIABLE = 1000, 10**6
"""Most letters of a text in a structure, and cells of an array of texts, and letters of a variable that is a text, that
are read from an HDF5 file."""
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
        datasets = _datasets(file)
        # MATLAB keeps rows and columns the other way round, and text and references as numbers.
        matlab = any(CLASS in item.attrs for _, item in datasets)
        across = {
            scale.name for _, item in datasets if len(item.shape or ()) == 2 for scale in _scales(item, matlab, 1)
        }
        kept = [
            (name, item)
            for name, item in datasets
            if (_is_channel(name, item) and item.name not in across) or (matlab and _is_complex(name, item))
        ]
        arrays = [_stored(name, item, matlab) for name, item in kept]
        begun = _begun([(item, stored) for (_, item), stored in zip(kept, arrays, strict=True)])
        first = min(begun.values(), default=None)
        arrays = [_from(first, stored, begun) for stored in arrays]
        readers = [_reader(item, first, across=_is_across(item, matlab)) for _, item in kept]
        texts = dict(_texts(file, datasets)) if matlab else {}
        blocks = sliced_blocks(readers, [item.length for item in arrays])
        taken = {name for name, _ in kept}
        others = [name.replace("/", ".") for name, item in datasets if name not in taken and _is_other(name, item)]
        yield Content(tuple(arrays), blocks, texts | _attributes(file), tuple(others))


def _datasets(file: Any) -> list[tuple[str, Any]]:
    import h5py

    links: list[tuple[str, Any]] = []
    file.visititems_links(lambda name, link: links.append((name, link)))
    for name, link in links:
        if isinstance(link, h5py.ExternalLink):
            raise ForeignFileError(_elsewhere(name, link.filename))
    datasets: list[tuple[str, Any]] = []
    file.visititems(lambda name, item: datasets.append((name, item)) if isinstance(item, h5py.Dataset) else None)
    for name, item in datasets:
        for other in _other_files(item):
            raise ForeignFileError(_elsewhere(name, other))
    return datasets


def _other_files(item: Any) -> list[str]:
    """Names of other files that hold samples of a dataset, as external storage or as sources of a virtual dataset."""
    if item.is_virtual:
        return [source.file_name for source in item.virtual_sources() if source.file_name != HERE]
    return [part[0] for part in item.external or ()]


def _elsewhere(name: str, other: Any) -> str:
    return f'dataset "{name}" keeps its samples in another file, "{other}"; only what is inside the file is read'


def _attributes(item: Any) -> dict[str, Plain]:
    """Attributes of a dataset or file, by name, that h5py can decode and that are text or a number."""
    attributes: dict[str, Any] = {}
    for name in item.attrs:
        with contextlib.suppress(TypeError):
            attributes[name] = _single(item.attrs[name])
    return plain_attributes(attributes)


def _texts(file: Any, datasets: list[tuple[str, Any]]) -> Iterator[tuple[str, Plain]]:
    """Yield the texts of MATLAB, also those in structures and in cells of these, by their names."""
    for name, item in datasets:
        kind = item.attrs.get(CLASS, b"")
        if name.startswith("#") or item.size > (MOST_LETTERS if "/" in name else LONGEST_VARIABLE):
            continue
        label = name.replace("/", ".")
        if kind in (b"char", "char") and item.dtype.kind == "u":
            yield label, _letters(item)
        elif kind in (b"cell", "cell") and item.dtype.kind == "O" and "/" in name:
            for number, reference in enumerate(item[()].ravel(), 1):
                cell: Any = file[reference] if reference else None
                if getattr(getattr(cell, "dtype", None), "kind", "") == "u" and cell.size <= MOST_LETTERS:
                    yield f"{label}{{{number}}}", _letters(cell)


def _letters(item: Any) -> str:
    return "".join(chr(int(code)) for code in item[()].ravel() if code)


def _is_channel(name: str, item: Any) -> bool:
    text = item.attrs.get(CLASS, b"double") in (b"char", b"cell", "char", "cell")
    known = item.dtype.kind in "fiub" and item.shape is not None and 0 <= item.ndim <= 2
    known = known or _is_text(item)
    return bool(not text and not name.startswith("#") and known and not _is_bare_dimension(item))


def _is_complex(name: str, item: Any) -> bool:
    """Whether a dataset holds complex numbers of MATLAB, of up to three dimensions."""
    return bool(item.dtype.names == PARTS and item.shape is not None and 1 <= item.ndim <= 3 and name[0] != "#")


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
    if item.ndim != 2:
        return bool(item.ndim == 3)
    # Channels by samples, of which dimension scales tell both: samples are more than channels.
    scaled = len(item.dims[0]) and len(item.dims[1]) and item.shape[1] > item.shape[0]
    # A row of MATLAB has one column in the file, and is a channel like a column of its.
    return bool((transposed and item.shape[1] != 1) or item.shape[0] == 1 or scaled)


def _scales(item: Any, transposed: bool, along: int) -> list[Any]:
    """Dimension scales of a dataset beside itself, along its samples (0) or across them (1)."""
    axis = along if not _is_across(item, transposed) else 1 - along
    return [scale for scale in item.dims[axis].values() if scale.name != item.name] if item.ndim > axis else []


def _stored(name: str, item: Any, transposed: bool) -> StoredArray:
    sizes = (*item.shape, 1, 1)[: max(item.ndim, 2)]
    shape = sizes[::-1] if _is_across(item, transposed) else sizes
    above = plain_attributes({key: _single(item.parent.attrs[key]) for key in CLOCK_NAMES if key in item.parent.attrs})
    given = plain_attributes({key: _single(item.attrs[key]) for key in ATTRIBUTES if key in item.attrs})
    for names in ((*RATE_NAMES, *INTERVAL_NAMES), START_NAMES):
        above = above if given.keys().isdisjoint(names) else {key: above[key] for key in above.keys() - {*names}}
    given = ({} if item.parent.name == "/" else above) | given | _scale_of_times(item, transposed)
    if _is_text(item):
        return StoredArray(name.replace("/", "."), shape, given | {"unit": "s"})
    given |= {MISSING: missing} if (missing := _packing(item).missing) else {}
    if item.dtype.names:
        return StoredArray(name.replace("/", "."), shape, {COMPLEX: True})
    value = float(item[()].ravel()[0]) if shape == (1, 1) else None
    return StoredArray(name.replace("/", "."), shape, given, value)


def _single(value: Any) -> Any:
    """Value of an attribute, of arrays of one entry the entry, as netCDF writes all attributes as arrays."""
    return value.ravel()[0] if getattr(value, "shape", ()) and value.size == 1 else value


def _scale_of_times(item: Any, transposed: bool) -> dict[str, Plain]:
    """Name of the dimension scale of the samples of a dataset, as ``clock``, where it has one beside itself.

    One without values tells which datasets were sampled together.
    """
    scales = _scales(item, transposed, 0)
    return {"clock": scales[0].name.strip("/").replace("/", ".")} if scales else {}


def _begun(datasets: Sequence[tuple[Any, StoredArray]]) -> dict[str, datetime]:
    """Times at which datasets began, by name, of attributes with a date and time and of time stamps as texts."""
    begun = dict[str, datetime]()
    for item, stored in datasets:
        texts = [str(stored.attributes[key]) for key in (*START_NAMES, WAVE_START) if key in stored.attributes]
        for text in texts if not _is_text(item) else [item.asstr()[0]]:
            with contextlib.suppress(ValueError):
                begin = datetime.fromisoformat(text)
                begun[stored.name] = begin if begin.tzinfo else begin.replace(tzinfo=UTC)
    return {name: begin for name, begin in begun.items() if begin != NO_START}


def _from(first: datetime | None, stored: StoredArray, begun: Mapping[str, datetime]) -> StoredArray:
    """Array whose start, if it is a date and time, is in s from the earliest in the file."""
    begin = begun.get(stored.name)
    key = WAVE_START if WAVE_START in stored.attributes else START_NAMES[0]
    late = (begin - first).total_seconds() if begin and first else 0.0
    dated = begin or key == WAVE_START
    return replace(stored, attributes={**stored.attributes, key: late}) if dated else stored


def _is_text(item: Any) -> bool:
    """Whether a dataset holds time stamps as texts, with date and time, as npTDMS writes them."""
    import h5py

    is_list = h5py.check_string_dtype(item.dtype) is not None and item.ndim == 1 and item.size > 1
    return bool(is_list and STAMP.fullmatch(item.asstr()[0]))


def _stamps(item: Any, first: datetime) -> Slice:
    """Reader of time stamps as texts, in s from the earliest time in the file."""
    import numpy as np

    zero = np.datetime64(first.astimezone(UTC).replace(tzinfo=None), "ns")

    def read(begin: int, end: int) -> NDArray[Any]:
        texts = item.asstr()[begin:end]
        wrong = next((text for text in texts if not STAMP.fullmatch(text)), None)
        if wrong is not None:
            raise ForeignFileError(f'dataset "{item.name}" has "{wrong}" among its time stamps')
        plain = np.array([text.removesuffix("Z") for text in texts], dtype="M8[ns]")
        return (plain - zero) / np.timedelta64(1, "s")

    return read


@dataclass(frozen=True)
class _Packing:
    """Packing of the values of a dataset, by the conventions of netCDF (NUG, appendix A; CF, 2.5 and 8.1).

    ``fills`` and the ``least`` and ``most`` valid value are those of the packed values, or with ``of_unpacked`` the two
    limits are those of the values themselves.
    """

    scale: float = 1.0
    offset: float = 0.0
    fills: tuple[float, ...] = ()
    least: float | None = None
    most: float | None = None
    of_unpacked: bool = False
    unsigned: bool = False

    @property
    def missing(self) -> str:
        """Words on values taken for missing ones, empty where there are none."""
        fills = ", ".join(dict.fromkeys(f"{fill:g}" for fill in self.fills))
        below = "" if self.least is None else f"below {self.least:g}"
        above = "" if self.most is None else f"above {self.most:g}"
        what = " or ".join(filter(None, [fills and f"of {fills}", below, above]))
        return f"values {what} are missing, as NaN" if what else ""

    def unpacked(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values in their unit, NaN where they are missing."""
        import numpy as np

        if self == _Packing():
            return values
        packed = values.view(f"u{values.dtype.itemsize}") if self.unsigned else values
        unpacked = packed.astype(float) * self.scale + self.offset
        tested, absent = unpacked if self.of_unpacked else packed, np.isin(packed, self.fills)
        absent |= False if self.least is None else tested < self.least
        absent |= False if self.most is None else tested > self.most
        return np.where(absent, np.nan, unpacked)


def _packing(item: Any) -> _Packing:
    """Packing of a dataset as its attributes say, with the fill value of netCDF where they say none."""
    import numpy as np

    def numbers(*names: str) -> list[float]:
        given = (np.ravel(item.attrs[name]) for name in names if name in item.attrs)
        plain = (own.view(f"u{own.dtype.itemsize}") if unsigned and own.dtype.kind == "i" else own for own in given)
        return [number for own in plain if own.dtype.kind in "fiu" for number in own.tolist() if number == number]

    unsigned = str(_single(item.attrs.get("_Unsigned", ""))).lower().strip("b'") == "true" and item.dtype.kind == "i"
    try:
        scale, offset = (float(_single(item.attrs.get(key, plain))) for key, plain in ((SCALE, 1.0), (OFFSET, 0.0)))
    except (TypeError, ValueError):
        raise ForeignFileError(f'dataset "{item.name}" has a {SCALE} or {OFFSET} that is not one number') from None
    fills = numbers("_FillValue", "missing_value")
    if "_FillValue" not in item.attrs and WRITTEN_BY_NETCDF in item.file.attrs:
        fills += NETCDF_FILLS.get(item.dtype.str[1:], ())
    limits = numbers("valid_range")
    least, most = limits if len(limits) == 2 else (None, None)
    least, most = ([*numbers(key), known][0] for key, known in (("valid_min", least), ("valid_max", most)))
    # Limits of a wider type than the packed values, that of the scale, are in the unit of the values.
    wide = any(np.asarray(item.attrs[key]).dtype.kind == "f" for key in LIMITS if key in item.attrs)
    packed = {SCALE, OFFSET} & {*item.attrs} and item.dtype.kind in "iu"
    return _Packing(scale, offset, tuple(fills), least, most, bool(wide and packed), unsigned)


def _reader(item: Any, first: datetime | None, *, across: bool) -> Slice:
    if _is_text(item) and first:
        return _stamps(item, first)
    packing = None if item.dtype.names else _packing(item)

    def read(begin: int, end: int) -> NDArray[Any]:
        stored = item[()].reshape(1) if item.ndim == 0 else item[..., begin:end].T if across else item[begin:end]
        real, imaginary = PARTS
        return packing.unpacked(stored) if packing else stored[real] + 1j * stored[imaginary]

    return read
