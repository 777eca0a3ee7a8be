"""Reading and writing of recordings in files of any known format."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Generator, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from torsionnet.base.errors import Fault, ModelError, UsageError, remedy
from torsionnet.signals.formats.registry import FORMATS, format_of, reading
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.assembling import encoder_recording, recordings, with_given_clock, with_given_courses
from torsionnet.signals.records.channel_choice import ReadOptions, choose
from torsionnet.signals.records.source import Source
from torsionnet.signals.records.stored_pulses import with_readings
from torsionnet.signals.resampling import Recordings, resampled
from torsionnet.signals.rotation.counter import PulseReading


def read_recording(
    path: str | os.PathLike[str],
    quantities: Mapping[str, str] | None = None,
    names: Sequence[str] | Mapping[str, str] | None = None,
    sampling_rate: float | None = None,
    units: Mapping[str, str] | None = None,
    pulses: Mapping[str, float] | None = None,
    pulse_readings: Mapping[str, PulseReading] | None = None,
    *,
    resample: bool = False,
    between: Mapping[str, str] | None = None,
    **dialect: str,
) -> Recording:
    r"""Read a recording from a file, its values converted to SI, and what was assumed in its notes.

    Parameters
    ----------
    path : str or path
        A file ending in .csv, .txt, .tsv, .lvm, .npz or .mat, or with an extra in .tdms, .uff, .h5, .parquet or .mf4.
    quantities : mapping, optional
        Quantity of channels whose unit does not tell it: ``{"M1": "torque"}``.
    names : sequence or mapping, optional
        Channels to read, under new names where it is a mapping; all of the file if left out. A channel asked for by
        name must have a quantity; others that have none are kept as they are, with a note.
    sampling_rate : float, optional
        Hz, where the file does not tell it; of a file with channels of several rates, the one that is read.
    units : mapping, optional
        Unit of channels where the file has none or a wrong one; one of time makes a channel the time stamps.
    pulses : mapping, optional
        Channels that hold the pulses of an incremental encoder, with its steps per revolution: ``{"n1": 60}``. They
        become angles, band-limited between the pulses: see :func:`~torsionnet.signals.encoder.angle_from_pulses`. A
        channel whose values only increase holds the times of the pulses, and may have a length of its own; others
        were sampled with the rest. The record is cut to where there are pulses.
    pulse_readings : mapping, optional
        Channels that hold the counts or times of pulses, and how to read them: ``{"n1": PulseReading(clock="80 MHz",
        bits=32)}``. They become ``Recording.pulses``, each of a length of its own; with an entry in ``pulses`` too,
        the angle is made of them.
    resample : bool
        Bring the channels of other sampling rates or starts to ``sampling_rate``, by default the highest of even ones,
        band-limited, with a note on the error. Without it they are left out, with a note, or refused where they are
        named; those that begin whole samples apart are cut to the time they share.
    between : mapping, optional
        Course of channels between samples, ``{"T_M": "held"}`` for the output of a converter, ``"straight"`` for a
        torque that was simulated so; without it, and where the file does not say it, ``"band_limited"``.
    **dialect : str
        ``separator`` and ``decimal`` of a text file, instead of finding them out.

    Raises
    ------
    ModelError
        The file is faulty; everything found is listed.
    UsageError
        There is no such file, or its ending is not known.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "test.csv")
    >>> _ = path.write_text("time;T_T [kNm]\n0,0;1,0\n0,1;2,5\n")
    >>> record = read_recording(path)
    >>> record["T_T"].values.tolist(), record.sampling_rate
    ([1000.0, 2500.0], 10.0)
    >>> record.notes[0]
    '"time" was taken for the time stamps'
    """
    options = ReadOptions(
        names,
        quantities or {},
        units or {},
        sampling_rate,
        pulses or {},
        pulse_readings or {},
        resample,
        between or {},
    )
    records = list(_read(Path(path), options, None, dialect))
    if len(records) > 1:
        raise _several(len(records), len(records[0]), Path(path))
    return records[0]


def read_even(path: str | os.PathLike[str], **reading: Any) -> Recording:
    """Recording as :func:`read_recording` gives it; ``resample`` makes uneven time stamps even, too."""
    recording = read_recording(path, **reading)
    return resampled(recording) if reading.get("resample") and recording.times is not None else recording


def read_tests(path: str | os.PathLike[str], **reading: Any) -> list[Recording]:
    """Recordings of a file in SI, one, or one for each of its blocks that do not follow each other.

    Arguments are those of :func:`read_recording`, without ``pulses``.
    """
    dialect: dict[str, str] = {key: reading.pop(key) for key in ("separator", "decimal") if key in reading}
    return list(_read(Path(path), ReadOptions(**reading), None, dialect))


def _several(count: int, length: int, path: Path) -> ModelError:
    text = f"the file holds {count} blocks that do not follow each other, as after a trigger, the first of {length} "
    text += f"samples: {remedy('iter_blocks()')} takes them as separate tests, which are averaged; for anything else "
    return ModelError([Fault(f"{text}save each block in a file of its own", kind="unlike-results")], path.name)


def iter_blocks(
    path: str | os.PathLike[str],
    seconds: float,
    quantities: Mapping[str, str] | None = None,
    names: Sequence[str] | Mapping[str, str] | None = None,
    sampling_rate: float | None = None,
    units: Mapping[str, str] | None = None,
    pulse_readings: Mapping[str, PulseReading] | None = None,
    *,
    resample: bool = False,
    between: Mapping[str, str] | None = None,
    **dialect: str,
) -> Iterator[Recording]:
    """Yield recordings of ``seconds`` each in SI, one after the other, from a large file that is never read as a whole.

    Text, NPZ (arrays of one dimension), HDF5, MAT v7.3, TDMS and Parquet files never are in memory as a whole; of
    the other formats the library reads everything. Arguments are those of :func:`read_recording`, without ``pulses``.
    Channels that begin at different times, and those that ``resample`` brings to another rate, are read whole, too.
    Each block has the pulses from its first sample to that of the next; those of a whole file are read at once.
    """
    if not seconds > 0:
        raise UsageError(f"blocks must last a positive number of seconds, got {seconds}", kind="out-of-range")
    options = ReadOptions(
        names, quantities or {}, units or {}, sampling_rate, {}, pulse_readings or {}, resample, between or {}
    )
    return _read(Path(path), options, seconds, dialect)


def channel_names(path: str | os.PathLike[str], **dialect: str) -> tuple[str, ...]:
    """Names of the channels in a file that :func:`read_recording` can read without further arguments."""
    with _opened(Path(path), dialect) as source:
        names = dict.fromkeys(channel.name for channel in source.channels)
        return tuple(name for name in names if not choose(source, [name], {}, {})[1])


def pulse_names(path: str | os.PathLike[str], **dialect: str) -> tuple[str, ...]:
    """Names of the channels of a file that hold times of pulses in s, as this package writes them."""
    with _opened(Path(path), dialect) as source:
        return tuple(stored.channel.name for stored in source.pulses)


def _read(
    path: Path, options: ReadOptions, seconds: float | None, dialect: dict[str, str]
) -> Generator[Recording, None, None]:
    with _opened(path, dialect) as opened:
        read = with_readings(opened, options.readings, options.units, path.name)
        source, options = with_given_clock(read, options)
        source = with_given_courses(source, options.between, path.name)
        if options.pulses:
            record = encoder_recording(source, options, path.name)
            if source.seams:
                raise _several(len(source.seams) + 1, source.seams[0][0], path)
            yield record
        else:
            yield from recordings(source, options, path.name, seconds)


@contextlib.contextmanager
def _opened(path: Path, dialect: dict[str, str]) -> Iterator[Source]:
    with reading(path, "recording") as form:
        if dialect and (form.label != "text" or not dialect.keys() <= {"separator", "decimal"}):
            raise UsageError(f"{', '.join(dialect)} cannot be given for a {form.label} file", kind="needless-entry")
        assert form.open_source is not None
        with form.open_source(path, **dialect) as source:
            yield source


def write_recording(recording: Recording, path: str | os.PathLike[str]) -> None:
    """Write a recording in the format of the ending of ``path``, whole or not at all.

    Reading the file again gives the same names, quantities, values, rate, start and notes. UFF58 files keep of the
    notes and names what fits into lines of 80 characters.

    Raises
    ------
    UsageError
        The ending is not known, two channels would have one name in the file, or the format cannot hold pulses.
    MissingExtraError
        The package for the format is not installed.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> from torsionnet.signals.recording import Signal
    >>> path = Path(tempfile.mkdtemp(), "test.npz")
    >>> write_recording(Recording((Signal("T_T", "torque", np.array([0.0, 1.0])),), sampling_rate=10e3), path)
    >>> read_recording(path)
    <Recording T_T: 2 samples at 10000 Hz, 0.0002 s>
    """
    target = Path(path)
    form = format_of(target, "recording")
    if form.write is None:
        raise UsageError(
            f'"{target.name}": {form.label} files are read only; write .npz, .h5 or .csv', kind="wrong-file"
        )
    if recording.pulses and not form.holds_pulses:
        names = ", ".join(channel.name for channel in recording.pulses)
        endings = ", ".join(other.endings[0] for other in FORMATS if other.holds_pulses)
        raise UsageError(
            f'"{target.name}": channels of a {form.label} file are of one length, and pulses have their own ({names}); '
            f"write one of {endings}, or leave the pulses out: replace(recording, pulses=())",
            kind="no-counterpart",
        )
    form.write(recording, target)


# Signals of a record of any size: a large file is read in blocks, so that it does not fill the memory.

LARGE_FILE = 300_000_000
"""Bytes of a file of signals above which it is read in blocks, so that it does not fill the memory; a larger value
takes more memory, a smaller one blocks needlessly."""
BLOCK_SECONDS = 30.0
"""Duration in s of a block of a large file, as longer ones take more memory and shorter ones more reads: 19 MB for 8
channels at 10 kHz."""


def is_large_record(path: str | os.PathLike[str]) -> bool:
    """Whether the file of a record is so large that it is read in blocks."""
    return Path(path).is_file() and Path(path).stat().st_size > LARGE_FILE


def blocks_of_record(path: str | os.PathLike[str], **reading: Any) -> Iterator[Recording]:
    """Blocks of a large file in SI; arguments are those of :func:`read_recording`, without ``pulses``."""
    return iter_blocks(path, BLOCK_SECONDS, **reading)


def record_or_blocks(path: str | os.PathLike[str], **reading: Any) -> Recordings:
    """Recording of a file in SI, or an iterator of its blocks if the file is large."""
    return blocks_of_record(path, **reading) if is_large_record(path) else read_recording(path, **reading)
