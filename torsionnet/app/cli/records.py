"""Recordings of signals read and checked for commands; a large file is read in blocks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from torsionnet.app.cli.record_options import RecordReading, RecordSpan
from torsionnet.app.cli.terminal import message, print_faults
from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.base.notes import Note, about_channel, is_warning
from torsionnet.signals.record_blocks import Recordings
from torsionnet.signals.recording import Recording
from torsionnet.signals.recording_checks import check_recording
from torsionnet.signals.records import large_records
from torsionnet.signals.records.recording_files import read_recording, read_tests
from torsionnet.signals.resampling import resampled

SAME_CLOCK = 0.5
"""Share of a sampling interval by which a block of a large file may begin off the end of the one before."""


def load_record(
    path: str,
    reading: RecordReading,
    names: Sequence[str] | None,
    window: float,
    advance: Callable[[float], None],
    span: RecordSpan | None = None,
    *,
    tests: bool = False,
) -> Recordings:
    """Recording of the channels named, checked, or an iterator of its blocks if the file is large.

    With ``tests`` a file may hold several blocks that do not follow each other. Warnings go to stderr.

    Raises
    ------
    ModelError
        The record is faulty; all faults are listed.
    """
    wanted = None if names is None else list(dict.fromkeys(names))
    has_pulses = "pulses" in reading.arguments
    if large_records.is_large_record(path) and not has_pulses:
        return _checked_blocks(path, reading, wanted, window, advance, span, tests=tests)
    read: Callable[..., Recording | list[Recording]] = read_tests if tests and not has_pulses else read_recording
    found = read(path, names=wanted, **reading.arguments)
    if isinstance(found, list) and len(found) > 1:
        return _checked_tests(found, reading, path, window, advance)
    record = found[0] if isinstance(found, list) else found
    record = record if span is None else span.cut(record)  # what is cut away may be faulty
    record = checked_record(record, reading, path, window)
    advance(record.duration)
    return record


def checked_record(record: Recording, reading: RecordReading, path: str, window: float = 0.0) -> Recording:
    """Recording with even time stamps, its notes and the warnings of its checks told; ModelError where it is faulty."""
    _tell_notes(record)
    given, record = record, _even(record, reading, path)
    _tell_notes(record, given)
    _refuse(check_recording(record, window), path)
    return record


def _tell_notes(record: Recording, told: Recording | None = None) -> None:
    """Tell the notes of a record and of its signals, without those told of the record before it was changed."""
    before = _notes(told) if told else {}
    for note in _notes(record):
        if note not in before:
            message(note.severity, note.named)


def _notes(record: Recording) -> dict[Note, None]:
    """Notes of a record, of which warnings come with the result, and those of its signals."""
    own = [about_channel(note, "") for note in record.notes if not is_warning(note)]
    return dict.fromkeys([*own, *(about_channel(note, signal.name) for signal in record for note in signal.notes)])


def _checked_tests(
    found: Sequence[Recording], reading: RecordReading, path: str, window: float, advance: Callable[[float], None]
) -> list[Recording]:
    """Checked blocks of a file that do not follow each other; that each has few windows is no fault."""
    _tell_notes(found[-1])  # how many blocks there are is known at the end
    records = [_even(record, reading, path) for record in found]
    for record in records:
        faults = check_recording(record, window)
        _refuse([one for one in faults if one.severity == "error" or one.path != ("channels",)], path)
        advance(record.duration)
    return records


def _checked_blocks(
    path: str,
    reading: RecordReading,
    names: Sequence[str] | None,
    window: float,
    advance: Callable[[float], None],
    span: RecordSpan | None,
    *,
    tests: bool,
) -> Iterator[Recording]:
    """Checked blocks of a large file of signals, one after the other; a short last block is not reported as a fault."""
    message("note", f"{path} is large: read in blocks of {large_records.BLOCK_SECONDS:g} s")
    end: float | None = None
    told: Recording | None = None
    for block in large_records.blocks_of_record(path, names=names, **reading.arguments):
        if span is not None and span.delays:
            raise UsageError(f"{path} is read in blocks, across which no delay can be taken out; cut the record first")
        if not tests and end is not None and abs(block.start - end) * block.sampling_rate > SAME_CLOCK:
            raise UsageError(f"{path} holds blocks that do not follow each other; save each in a file of its own")
        _tell_notes(block, told)
        end, told = block.start + block.duration, block
        kept = block if span is None else block.between(span.start, span.stop)
        if not len(kept):
            advance(block.duration)
            continue
        even = _even(kept, reading, path)
        _refuse([fault for fault in check_recording(even, window) if fault.path != ("channels",)], path)
        yield even
        advance(even.duration)


def _even(record: Recording, reading: RecordReading, path: str) -> Recording:
    if reading.resample:
        return resampled(record)
    if record.times is not None:
        faults = [fault for fault in check_recording(record) if fault.path[:1] == ("time",)]
        texts = [replace(fault, severity="error", path=()) for fault in faults]
        raise ModelError(texts or [Fault("the time stamps are not uniform: --resample makes them so")], path)
    return record


def _refuse(faults: Sequence[Fault], path: str) -> None:
    errors = [fault for fault in faults if fault.severity == "error"]
    if errors:
        raise ModelError([_named(fault) for fault in errors], path)
    print_faults(_named(fault) for fault in faults)


def _named(fault: Fault) -> Fault:
    """Copy of a fault whose message names its channel, instead of its place in a file."""
    where = fault.path[-1] if len(fault.path) > 1 else ""
    return replace(fault, message=f"{where}: {fault.message}" if where else fault.message, path=())
