"""Table of the file formats of recordings and frequency responses, with endings and the functions that read and write.

``open_source(path)`` of a format is a context manager that gives a
:class:`~torsionnet.signals.records.source.Source` of a record: channels with names and units as they stand in the file,
and a reader of rows in blocks.
``write(recording, path)`` writes one, through :func:`torsionnet.base.atomic.replacing`. ``read_response(path)`` and
``write_response(response, path)`` are for frequency responses. ``npz.py`` is a short module to begin from,
``text/record_text.py`` one for text; what is written carries ``recording_json(recording)`` and is read with
``with_description``; ``arrays.array_source`` makes a source of named arrays, ``headings.split_heading`` takes a unit
off a name, and ``extras.open_foreign`` asks a library in a process of its own. What is wrong with a file is a
ValueError in words, with the line where there is one: :func:`reading` adds the name of the file.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from torsionnet.base.errors import Fault, ModelError, TorsionnetError, UsageError, did_you_mean
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.signals.formats import hdf5, mat, mdf, npz, parquet, record_uff, response_uff, tdms, wav
from torsionnet.signals.formats.text import record_text, response_text
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.source import Source

Holding = Literal["recording", "frequency response"]


@dataclass(frozen=True)
class Format:
    """File format, which holds recordings where it has ``open_source``, responses where it has ``read_response``.

    Only where channels may differ in length do files hold pulses.
    """

    label: str
    endings: tuple[str, ...]
    open_source: Callable[..., AbstractContextManager[Source]] | None = None
    write: Callable[[Recording, Path], None] | None = None
    read_response: Callable[[Path], FrequencyResponse] | None = None
    write_response: Callable[[FrequencyResponse, Path], None] | None = None
    holds_pulses: bool = False

    def holds(self, what: Holding) -> bool:
        """Whether files of the format hold recordings, or frequency responses."""
        return (self.open_source if what == "recording" else self.read_response) is not None


FORMATS = (
    Format("text", (".csv", ".txt", ".tsv", ".asc", ".dat", ".lvm"), record_text.open_source, record_text.write),
    Format("CSV", (".csv",), read_response=response_text.read, write_response=response_text.write),
    Format("NPZ", (".npz",), npz.open_source, npz.write, npz.read_response, npz.write_response, holds_pulses=True),
    Format("MAT", (".mat",), mat.open_source, mat.write, mat.read_response, mat.write_response, holds_pulses=True),
    Format("TDMS", (".tdms",), tdms.open_source, tdms.write, holds_pulses=True),
    Format("UFF58", (".uff", ".unv"), record_uff.open_source, record_uff.write, response_uff.read, response_uff.write),
    Format("HDF5", (".h5", ".hdf5", ".hdf"), hdf5.open_source, hdf5.write, holds_pulses=True),
    Format("Parquet", (".parquet", ".pq"), parquet.open_source, parquet.write),
    Format("MDF", (".mf4", ".mdf"), mdf.open_source, mdf.write, holds_pulses=True),
    Format("WAV", (".wav",), wav.open_source),
)
"""File formats of recordings and frequency responses, with endings, reading and writing functions."""
EXPORTS = {
    (".d7d", ".d7z", ".dxd", ".dxz"): ("a file of Dewesoft", "as Matlab (.mat), UFF (.unv) or text"),
    (".bin",): ("a file of catman or of another program", "in catman as MDF4 (.mf4), Matlab (.mat) or ASCII"),
    (".psdata",): ("a file of PicoScope", "as CSV or Matlab (.mat)"),
    (".wfm", ".isf"): ("a file of an oscilloscope", "as CSV"),
    (".tdm", ".tdx"): ("a file of DIAdem", "as TDMS"),
    (".lms", ".ldsf", ".tsw"): ("a file of Simcenter Testlab", "as Matlab (.mat) or UFF (.unv)"),
    (".raw", ".famos"): ("a file of imc FAMOS", "as MDF4 (.mf4), Matlab (.mat) or ASCII"),
    (".dmd", ".oxd"): ("a file of OXYGEN of Dewetron or of OROS", "as MDF4 (.mf4), Matlab (.mat) or UFF (.unv)"),
    (".rpc", ".rsp"): ("an RPC file", "as UFF (.unv), Matlab (.mat) or text"),
    (".xlsx", ".xls", ".xlsm", ".ods"): ("a spreadsheet", "as CSV"),
}
"""Files of programs that are not read, by their endings, with what they are and the export to make."""


SIGNATURES = {b"MDF     ": "MDF", b"UnFinMF ": "MDF", b"TDSm": "TDMS", b"\x89HDF\r\n": "HDF5", b"PAR1": "Parquet"}
"""First bytes of files of other formats that may have an ending of text, with the label of their format."""


def format_of(path: Path, what: Holding) -> Format:
    """File format of a path by its ending.

    Raises :class:`UsageError` where no format of that ending holds such data.
    """
    known = {ending: form for form in FORMATS if form.holds(what) for ending in form.endings}
    ending = path.suffix.lower()
    if ending not in known:
        for endings, (kind, export) in EXPORTS.items():
            if ending in endings:
                raise UsageError(
                    f'"{path.name}" is {kind}, which is not read here; export it there {export}', kind="wrong-file"
                )
        text = f'"{path.name}" has no ending of a {what}{did_you_mean(ending, known)}; expected one of '
        raise UsageError(text.replace("?;", "?") + ", ".join(known), kind="wrong-file")
    return known[ending]


@contextlib.contextmanager
def reading(path: Path, what: Holding) -> Iterator[Format]:
    """Yield the format that reads a file, turning errors in the ``with`` block into errors that name the file.

    Raises
    ------
    ModelError
        The file is faulty.
    UsageError
        There is no such file, or its ending is not known.
    """
    form = format_of(path, what)
    if not path.is_file():
        raise UsageError(f'there is no file "{path}"', kind="missing-file")
    if form.label == "text":
        form = _by_signature(path) or form
    try:
        yield form
    except TorsionnetError:
        raise
    # A library says of a damaged file what it likes: struct.error, zlib.error, IndexError.
    except Exception as error:
        said = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ModelError(
            [Fault(f"the file cannot be read as {form.label}: {said}", kind="unreadable-file")], path.name
        ) from error


def _by_signature(path: Path) -> Format | None:
    """Format of a file of records that its first bytes tell, whatever its ending; None where they tell none."""
    with path.open("rb") as file:
        start = file.read(max(map(len, SIGNATURES)))
    label = next((label for signature, label in SIGNATURES.items() if start.startswith(signature)), None)
    return next((form for form in FORMATS if form.label == label), None)
