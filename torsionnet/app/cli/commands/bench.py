"""Command ``torsionnet bench``, which tests a model in place of a rig and writes the record."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import click

from torsionnet.app.cli.command import NUMBERS, Answer, Command, result_path
from torsionnet.app.cli.options import SETTINGS, argument, file_option, option
from torsionnet.app.cli.terminal import print_warnings
from torsionnet.base.notes import NoteOrText, is_warning
from torsionnet.base.result_rows import Out
from torsionnet.bench.wheel_turning import TrueFault

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.bench import Bench
    from torsionnet.signals.recording import Recording

    Result = tuple[str, str, Recording, tuple[TrueFault, ...]]
    """Name of the configuration and of the steady point, path of the file, record, faults put into it."""


@dataclass(frozen=True)
class ChannelRow:
    """Channel of a record with its smallest and largest value and its RMS."""

    name: Annotated[str, Out("channel")]
    unit: Annotated[str, Out("unit")]
    smallest: Annotated[float, Out("smallest", digits=4)]
    largest: Annotated[float, Out("largest", digits=4)]
    rms: Annotated[float, Out("RMS", json="RMS", digits=4)]
    notes: tuple[NoteOrText, ...]

    @property
    def joined_notes(self) -> Annotated[str, Out("notes", json=None, after="notes")]:
        """Notes on a channel as one text, joined by semicolons."""
        return "; ".join(map(str, self.notes))


@dataclass(frozen=True)
class PulseRow:
    """Channel of pulse times of a record, with their number, the first and the last in s, and the counter's tick."""

    name: Annotated[str, Out("channel of pulses")]
    count: Annotated[int, Out("pulses")]
    first: Annotated[float | None, Out("first", "s", json="first_s", digits=6)]
    last: Annotated[float | None, Out("last", "s", json="last_s", digits=6)]
    tick: Annotated[float, Out("tick", "s", json="tick_s", digits=4)]
    notes: tuple[NoteOrText, ...]

    @property
    def joined_notes(self) -> Annotated[str, Out("notes", json=None, after="notes")]:
        """Notes on a channel as one text, joined by semicolons."""
        return "; ".join(map(str, self.notes))


@dataclass(frozen=True)
class BenchRecord:
    """Record of one configuration, as ``torsionnet bench --json`` prints it."""

    title: str
    configuration: str
    file: str
    sampling_rate: Annotated[float, Out(json="sampling_rate_Hz")]
    samples: int
    duration: Annotated[float, Out(json="duration_s")]
    notes: tuple[NoteOrText, ...]
    channels: tuple[ChannelRow, ...]
    pulses: tuple[PulseRow, ...] = ()
    faults: tuple[TrueFault, ...] = ()


class BenchCommand(Command):
    """Run a test on a model instead of a rig, and write the record.

    RIG is a model file with a bench: section, a file that names a model and has a bench:, or a bench of the library.

    \b
    torsionnet bench amt_bench -c II -o gear_II.tdms
    torsionnet bench dmf_bench --seed 7 --plot signals.png
    torsionnet bench marine_run_up -o run_up.npz

    A bench that turns gives a record for each steady point and for each recording system, NAME_600rpm.npz.
    """

    forms = NUMBERS
    picture = "the signals over time"

    rig: str = argument("RIG")
    configurations: tuple[str, ...] = option(
        "--configuration", "-c", metavar="NAME", help='Of the model, instead of that in the file; or "all". Repeatable.'
    )
    settings: tuple[tuple[str, str], ...] = SETTINGS
    seed: int | None = option("--seed", type=click.IntRange(0), help="Another run of the same test.")
    output_file: str | None = file_option("The record; default: RIG.npz here. The ending tells the format.")
    truth: bool = option("--truth", help="Write torque and motion as they are, without errors of measurement.")

    def answer(self) -> Answer:
        from torsionnet.app.cli.terminal import progress
        from torsionnet.base.conventions import Conventions
        from torsionnet.bench import load_bench
        from torsionnet.bench.wheel_turning import with_wheel_speeds
        from torsionnet.signals.formats.registry import format_of
        from torsionnet.signals.records.recording_files import write_recording

        bench, degrees = load_bench(self.rig), Conventions(angle="deg")
        target = self.output_file or f"{Path(self.rig).stem}.npz"
        format_of(Path(target), "recording")
        benches = _benches(bench, self.configurations, dict(self.settings))
        results = []
        with progress("testing", len(benches)) as advance:
            for name, one in benches:
                records, faults = _tested(one, self.seed, truth=self.truth)
                for point, record in records.items():
                    called = "_".join(filter(None, (name, point)))
                    path = result_path(target, called, len(benches) * len(records) if called else 1)
                    results.append((called, path, record, faults.get(point, ())))
                advance(1)
        print_warnings(note for _, _, record, _ in results for note in record.notes)
        return Answer(
            screen=lambda: _screen(results),
            data=lambda: [_record(*result) for result in results],
            files=[(path, partial(write_recording, record)) for _, path, record, _ in results],
            figures=lambda plot: [
                (name, plot.time_histories(with_wheel_speeds(record, bench.plan), conventions=degrees))
                for name, _, record, _ in results
            ],
        )


def _benches(bench: Bench, configurations: tuple[str, ...], settings: dict[str, Any]) -> list[tuple[str, Bench]]:
    from torsionnet.model.configurations import ALL_CONFIGURATIONS

    names = (
        list(bench.drivetrain.configurations)
        if ALL_CONFIGURATIONS in configurations
        else list(dict.fromkeys(configurations))
    )
    if not names:
        return [("", bench.configured(**settings) if settings else bench)]
    return [(name.replace("=", "_").replace(",", "_"), bench.configured(name, **settings)) for name in names]


def _tested(
    bench: Bench, seed: int | None, *, truth: bool
) -> tuple[Mapping[str, Recording], Mapping[str, tuple[TrueFault, ...]]]:
    """Records of a test by name, and the faults put into each; the truth has none."""
    if truth:
        return bench.truths, {}
    if bench.plan.motion is None:
        return bench.records(seed), {}
    found = bench.turned(seed)
    return found.records, found.faults


def _screen(results: list[Result]) -> Iterator[Table | str]:
    from torsionnet.base.table import result_table

    for _, _, record, faults in results:
        if record.signals:
            yield _table(record)
        if record.pulses:
            yield result_table(f"{record.title}: pulses", _pulses(record), PulseRow)
        if faults:
            yield f"faults put in: {_counted(faults)}"
        yield from (str(note) for note in record.notes if not is_warning(note))


def _table(record: Recording) -> Table:
    from torsionnet.base.table import result_table

    span = f"{len(record)} samples at {record.sampling_rate:g} Hz, {record.duration:g} s"
    return result_table(f"{record.title}: {span}", _channels(record), ChannelRow)


def _channels(record: Recording) -> tuple[ChannelRow, ...]:
    return tuple(ChannelRow(one.name, one.unit, *_sizes(one.values), one.notes) for one in record)


def _pulses(record: Recording) -> tuple[PulseRow, ...]:
    return tuple(PulseRow(one.name, len(one), *_ends(one.times.tolist()), one.tick, one.notes) for one in record.pulses)


def _ends(times: list[float]) -> tuple[float | None, float | None]:
    return (times[0], times[-1]) if times else (None, None)


def _counted(faults: tuple[TrueFault, ...]) -> str:
    """Text with the number of faults of each kind by channel."""
    counts = Counter((fault.channel, fault.kind) for fault in faults)
    return ", ".join(f"{channel} {kind} {number}x" for (channel, kind), number in counts.items())


def _sizes(values: Any) -> tuple[float, float, float]:
    return float(values.min()), float(values.max()), float((values**2).mean() ** 0.5)


def _record(name: str, path: str, record: Recording, faults: tuple[TrueFault, ...]) -> BenchRecord:
    return BenchRecord(
        record.title, name, path, record.sampling_rate, len(record), record.duration, record.notes, _channels(record),
        _pulses(record), faults,
    )  # fmt: skip
