"""Command ``torsionnet bench``, which tests a model in place of a rig and writes the record."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import click

from torsionnet.app.cli.command import NUMBERS, Answer, Command, result_path
from torsionnet.app.cli.options import SETTINGS, argument, file_option, option
from torsionnet.app.cli.terminal import print_warnings
from torsionnet.base.notes import is_warning
from torsionnet.bench.wheel_turning import TrueFault
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.rotation.pulse_channel import PulseChannel

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.bench import Bench


@dataclass(frozen=True, eq=False)
class BenchRun:
    """Record of a configuration and perhaps a steady point, with its file and the faults put into it."""

    SHOWN: ClassVar = (
        "record.title", "configuration", "file", "record.sampling_rate", "record.samples", "record.duration",
        "record.notes", "record.signals", "record.pulses", "faults",
    )  # fmt: skip

    configuration: str
    file: str
    record: Recording
    faults: tuple[TrueFault, ...]


class BenchCommand(Command):
    """Run a test on a model instead of a rig, and write the record.

    RIG is a model file with a bench: section, a file that names a model and has a bench:, or a bench of the library.

    A bench that turns gives a record for each steady point and for each recording system, NAME_600rpm.npz.

    \b
    torsionnet bench amt_bench -c II -o gear_II.tdms
    torsionnet bench dmf_bench --seed 7 --plot signals.png
    torsionnet bench marine_run_up -o run_up.npz
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
                    results.append(BenchRun(called, path, record, faults.get(point, ())))
                advance(1)
        print_warnings(note for run in results for note in run.record.notes)
        return Answer(
            screen=lambda: _screen(results),
            data=lambda: results,
            files=[(run.file, partial(write_recording, run.record)) for run in results],
            figures=lambda plot: [
                (run.configuration, plot.time_histories(with_wheel_speeds(run.record, bench.plan), conventions=degrees))
                for run in results
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


def _screen(results: list[BenchRun]) -> Iterator[Table | str]:
    from torsionnet.base.table import result_table

    for run in results:
        record = run.record
        if record.signals:
            span = f"{len(record)} samples at {record.sampling_rate:g} Hz, {record.duration:g} s"
            yield result_table(f"{record.title}: {span}", record.signals, Signal)
        if record.pulses:
            yield result_table(f"{record.title}: pulses", record.pulses, PulseChannel)
        if run.faults:
            yield f"faults put in: {_counted(run.faults)}"
        yield from (str(note) for note in record.notes if not is_warning(note))


def _counted(faults: tuple[TrueFault, ...]) -> str:
    """Text with the number of faults of each kind by channel."""
    counts = Counter((fault.channel, fault.kind) for fault in faults)
    return ", ".join(f"{channel} {kind} {number}x" for (channel, kind), number in counts.items())
