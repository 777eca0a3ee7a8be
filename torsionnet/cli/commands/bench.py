"""Command ``torsionnet bench``, which tests a model in place of a rig and writes the record."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import click

from torsionnet.cli.command import NUMBERS, Answer, Command, click_command, result_path
from torsionnet.cli.declarations import argument, option
from torsionnet.cli.options import SETTINGS, file_option
from torsionnet.cli.terminal import print_warnings
from torsionnet.core.result_rows import Out

if TYPE_CHECKING:
    from torsionnet.bench import Bench
    from torsionnet.response import Table
    from torsionnet.response.recording import Recording

    Result = tuple[str, str, Recording]
    """Name of the configuration, path of the file, record."""


@dataclass(frozen=True)
class ChannelRow:
    """Channel of a record with its smallest and largest value and its RMS."""

    name: Annotated[str, Out("channel")]
    unit: Annotated[str, Out("unit")]
    smallest: Annotated[float, Out("smallest", digits=4)]
    largest: Annotated[float, Out("largest", digits=4)]
    rms: Annotated[float, Out("RMS", json="RMS", digits=4)]
    notes: tuple[str, ...]

    @property
    def joined_notes(self) -> Annotated[str, Out("notes", json=None, after="notes")]:
        """Notes on a channel as one text, joined by semicolons."""
        return "; ".join(self.notes)


@dataclass(frozen=True)
class BenchRecord:
    """Record of one configuration, as ``torsionnet bench --json`` prints it."""

    title: str
    configuration: str
    file: str
    sampling_rate: Annotated[float, Out(json="sampling_rate_Hz")]
    samples: int
    duration: Annotated[float, Out(json="duration_s")]
    notes: tuple[str, ...]
    channels: tuple[ChannelRow, ...]


class BenchCommand(Command):
    """Run a test on a model instead of a rig, and write the record.

    RIG is a model file with a bench: section, a file that names a model and has a bench:, or a bench of the library.

    \b
    torsionnet bench amt_bench -c II -o gear_II.tdms
    torsionnet bench dmf_bench --seed 7 --plot signals.png
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
        from torsionnet.bench import load_bench
        from torsionnet.cli.progress import progress
        from torsionnet.io.formats.registry import format_of
        from torsionnet.io.recording_files import write_recording
        from torsionnet.response import Conventions

        bench, degrees = load_bench(self.rig), Conventions(angle="deg")
        target = self.output_file or f"{Path(self.rig).stem}.npz"
        format_of(Path(target), "recording")
        benches = _benches(bench, self.configurations, dict(self.settings))
        results = []
        with progress("testing", len(benches)) as advance:
            for name, one in benches:
                record = one.truth if self.truth else one.run(self.seed)
                results.append((name, result_path(target, name, len(benches)), record))
                advance(1)
        print_warnings(note for *_, record in results for note in record.notes)
        return Answer(
            screen=lambda: _screen(results),
            data=lambda: [_record(*result) for result in results],
            files=[(path, partial(write_recording, record)) for _, path, record in results],
            figures=lambda plot: [
                (name, plot.time_histories(record, conventions=degrees)) for name, _, record in results
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


def _screen(results: list[Result]) -> Iterator[Table | str]:
    for *_, record in results:
        yield _table(record)
        yield from (note for note in record.notes if not note.startswith("warning: "))


def _table(record: Recording) -> Table:
    from torsionnet.response.table import result_table

    span = f"{len(record)} samples at {record.sampling_rate:g} Hz, {record.duration:g} s"
    return result_table(f"{record.title}: {span}", _channels(record), ChannelRow)


def _channels(record: Recording) -> tuple[ChannelRow, ...]:
    return tuple(ChannelRow(one.name, one.unit, *_sizes(one.values), one.notes) for one in record)


def _sizes(values: Any) -> tuple[float, float, float]:
    return float(values.min()), float(values.max()), float((values**2).mean() ** 0.5)


def _record(name: str, path: str, record: Recording) -> BenchRecord:
    return BenchRecord(
        record.title, name, path, record.sampling_rate, len(record), record.duration, record.notes, _channels(record)
    )


command = click_command("bench", BenchCommand)
