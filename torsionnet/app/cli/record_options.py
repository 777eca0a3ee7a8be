"""Options on how a file of recorded signals is read, and how spectra are estimated from the record."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import Command
from torsionnet.app.cli.options import (
    PRESETS,
    USABLE_BAND,
    Arguments,
    DelayOption,
    FiniteFloat,
    PairOption,
    StepsOption,
    argument,
    option,
)
from torsionnet.app.cli.terminal import message, print_faults
from torsionnet.base.errors import Fault, ModelError, UsageError, did_you_mean
from torsionnet.base.notes import Note, about_channel, is_warning
from torsionnet.signals.recording import Recording
from torsionnet.signals.recording_checks import check_recording
from torsionnet.signals.records import recording_files
from torsionnet.signals.records.recording_files import read_recording, read_tests
from torsionnet.signals.resampling import Recordings, resampled

if TYPE_CHECKING:
    from torsionnet.signals.welch import Welch


LEAST_PRESET_RATE = 100.0
"""Least sampling rate in Hz that a preset may leave, half of what it leaves of the records that it is for."""

ESTIMATORS = ("H1", "H2", "Hv", "Hs", "Hr")


class RecordReading(Arguments):
    """Options on reading a file of signals, such as units, sampling rate, text format and encoder pulses."""

    quantities: tuple[tuple[str, str], ...] = option(
        "--quantity",
        type=PairOption("CHANNEL", "QUANTITY", "M1=torque"),
        help="What a channel is: torque, angle, velocity or acceleration. Repeatable.",
    )
    units: tuple[tuple[str, str], ...] = option(
        "--unit", type=PairOption("CHANNEL", "UNIT", "M1=kNm"), help="Its unit in the file. Repeatable."
    )
    rate: float | None = option(
        "--sampling-rate",
        type=FiniteFloat(0, min_open=True),
        help="Sampling rate in Hz, if the file has none, or which of several.",
    )
    separator: str | None = option("--separator", help="Between the cells of a text file, instead of finding it out.")
    decimal: str | None = option("--decimal", type=click.Choice([".", ","]), help="Decimal sign of a text file.")
    pulses: tuple[tuple[str, float], ...] = option(
        "--pulses",
        type=StepsOption(),
        help="A channel of encoder pulses, or of their times, and its steps per revolution: it becomes an angle. "
        "Repeatable.",
    )
    courses: tuple[tuple[str, str], ...] = option(
        "--between",
        type=PairOption("CHANNEL", "COURSE", "T_M=held"),
        help="Its course between samples: held, straight or band_limited. Repeatable.",
    )
    resample: bool = option(
        "--resample",
        help="Make uneven time stamps even by splines, and bring channels to --sampling-rate, or the highest.",
    )

    @property
    def arguments(self) -> dict[str, Any]:
        """Keyword arguments of :func:`read_recording` that follow from these options, by name."""
        dialect = {"separator": self.separator, "decimal": self.decimal}
        return {
            "quantities": dict(self.quantities),
            "units": dict(self.units),
            "sampling_rate": self.rate,
            **({"pulses": dict(self.pulses)} if self.pulses else {}),
            **({"between": dict(self.courses)} if self.courses else {}),
            **({"resample": True} if self.resample else {}),
            **{key: value for key, value in dialect.items() if value is not None},
        }


class RecordSpan(Arguments):
    """Options on the part of a record that counts, and on channels that come late, as entries of a campaign say it."""

    start: float | None = option("--start", type=FiniteFloat(), help="Time in s from which the record counts.")
    stop: float | None = option("--stop", type=FiniteFloat(), help="Time in s up to which the record counts.")

    delays: tuple[tuple[str, float], ...] = option(
        "--delay", type=DelayOption(), help="A channel comes late by this time, as T=1.2ms. Repeatable."
    )

    def check(self, path: str) -> None:
        """Refuse delays of channels that a record does not have."""
        from torsionnet.signals.records.recording_files import channel_names, pulse_names

        known = [*channel_names(path), *pulse_names(path)] if self.delays else []
        for name, _ in self.delays:
            if name not in known:
                hint = did_you_mean(name, known)
                raise UsageError(
                    f"--delay {name}: no such channel{hint}; {path} has {', '.join(known)}", kind="unknown-channel"
                )

    def cut(self, record: Recording) -> Recording:
        """Recording without the delays, between the times given; UsageError where nothing of it lies there."""
        if self.delays:
            from torsionnet.signals.calculus import without_delays

            record = without_delays(record, dict(self.delays))
        part = record.between(self.start, self.stop)
        if not (len(part) or any(map(len, part.pulses))):
            raise UsageError(f"nothing of the record lies there: {part.notes[-1]}", kind="out-of-range")
        return part


class Averaging(Arguments):
    """Options on averaging spectra, a preset and settings that replace some of the preset."""

    preset: str | None = option(
        "--preset", type=click.Choice(PRESETS), help="Start from these settings; paper: Galvagno (2015)."
    )
    window: str | None = option("--window", help="Name of a window.  [default: hamming]")
    seconds: float | None = option(
        "--seconds", type=FiniteFloat(0, min_open=True), help="Length of a segment in s.  [default: 2]"
    )
    overlap: float | None = option(
        "--overlap", type=FiniteFloat(0, 1, max_open=True), help="Share of a segment.  [default: 0.8]"
    )
    detrend: str | None = option(
        "--detrend", type=click.Choice(["mean", "linear", "none"]), help="Out of every segment."
    )
    decimation: int | None = option(
        "--decimate", type=click.IntRange(1), help="Keep every n-th sample, behind a filter."
    )

    def settings(self, **more: Any) -> Welch:
        """Settings of Welch's method from the options on averaging, with further settings given by keyword."""
        from torsionnet.signals.welch import PAPER, Welch  # loads numpy

        base = PAPER if self.preset == "paper" else Welch()
        given = {name: value for name, value in {**vars(self), **more}.items() if value is not None}
        given.pop("preset", None)
        return replace(base, **given)

    def suited(self, measured: Recordings) -> Recordings:
        """Record, or its blocks, at a rate that the preset does not decimate too far; UsageError where it does."""
        from torsionnet.signals.recording import Recording

        if not isinstance(measured, Recording):
            return (self._suited(block) for block in measured)
        return self._suited(measured)

    def _suited(self, record: Recording) -> Recording:
        factor, rate = self.settings().decimation, record.sampling_rate
        if self.preset and self.decimation is None and rate / factor < LEAST_PRESET_RATE:
            raise UsageError(
                f"--preset {self.preset} is for records at 10 kHz: it keeps every {factor}th sample; of {rate:g} Hz "
                f"{rate / factor:g} are left; leave the preset out, or replace the factor where there is --decimate",
                kind="out-of-range",
            )
        return record


class Estimator(Arguments):
    """Options on the estimator of a frequency response (H1, H2, Hv, Hs, Hr)."""

    estimator: str | None = option(
        "--estimator",
        type=click.Choice(ESTIMATORS),
        help="Default: Hr with --reference, else H2 with --preset paper, else H1.",
    )
    references: tuple[str, ...] = option(
        "--reference",
        metavar="CHANNEL",
        help="For Hr: the set-point, or what else drives the input and is free of its noise. Repeatable.",
    )


class RecordCommand(Command):
    """Arguments of a command that reads a record of signals."""

    record: str = argument("RECORD")
    reading: RecordReading


class EstimateArguments(RecordCommand):
    """Arguments of a command that estimates frequency responses from a record."""

    outputs: tuple[str, ...] = option("--output", metavar="CHANNEL", required=True, help="Repeatable.")
    inputs: tuple[str, ...] = option("--input", metavar="CHANNEL", required=True, help="Repeatable.")
    averaging: Averaging
    estimator: Estimator
    band: tuple[float, float] | None = USABLE_BAND


# Recordings of signals read and checked for commands; a large file is read in blocks.

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
    if recording_files.is_large_record(path) and not has_pulses:
        return _checked_blocks(path, reading, wanted, window, advance, span, tests=tests)
    read: Callable[..., Recording | list[Recording]] = read_tests if tests and not has_pulses else read_recording
    read_records = read(path, names=wanted, **reading.arguments)
    if isinstance(read_records, list) and len(read_records) > 1:
        return _checked_tests(read_records, reading, path, window, advance)
    record = read_records[0] if isinstance(read_records, list) else read_records
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
    blocks: Sequence[Recording], reading: RecordReading, path: str, window: float, advance: Callable[[float], None]
) -> list[Recording]:
    """Checked blocks of a file that do not follow each other; that each has few windows is no fault."""
    _tell_notes(blocks[-1])  # how many blocks there are is known at the end
    records = [_even(record, reading, path) for record in blocks]
    for record in records:
        faults = check_recording(record, window)
        _refuse([fault for fault in faults if fault.severity == "error" or fault.kind != "too-short"], path)
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
    message("note", f"{path} is large: read in blocks of {recording_files.BLOCK_SECONDS:g} s")
    end: float | None = None
    told: Recording | None = None
    for block in recording_files.blocks_of_record(path, names=names, **reading.arguments):
        if span is not None and span.delays:
            raise UsageError(
                f"{path} is read in blocks, across which no delay can be taken out; cut the record first",
                kind="too-large",
            )
        if not tests and end is not None and abs(block.start - end) * block.sampling_rate > SAME_CLOCK:
            raise UsageError(
                f"{path} holds blocks that do not follow each other; save each in a file of its own",
                kind="uneven-samples",
            )
        _tell_notes(block, told)
        end, told = block.start + block.duration, block
        kept = block if span is None else block.between(span.start, span.stop)
        if not len(kept):
            advance(block.duration)
            continue
        even = _even(kept, reading, path)
        _refuse([fault for fault in check_recording(even, window) if fault.kind != "too-short"], path)
        yield even
        advance(even.duration)


def _even(record: Recording, reading: RecordReading, path: str) -> Recording:
    if reading.resample:
        return resampled(record)
    if record.times is not None:
        faults = [fault for fault in check_recording(record) if fault.path[:1] == ("time",)]
        texts = [replace(fault, severity="error", path=()) for fault in faults]
        raise ModelError(
            texts or [Fault("the time stamps are not uniform: --resample makes them so", kind="uneven-samples")], path
        )
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
