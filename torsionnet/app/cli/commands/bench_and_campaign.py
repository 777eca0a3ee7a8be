"""Command ``torsionnet bench``, which tests a model in place of a rig and writes the record."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import click

from torsionnet.app.cli.command import NUMBERS, TABLE, Answer, Command, result_path, separated_by_lines
from torsionnet.app.cli.options import ANGLE, SETTINGS, OutputFolder, argument, file_option, option
from torsionnet.app.cli.terminal import message, print_warnings
from torsionnet.base.notes import is_warning
from torsionnet.bench.wheel_turning import TrueFault
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.rotation.pulse_channel import PulseChannel

if TYPE_CHECKING:
    from types import ModuleType

    from matplotlib.figure import Figure

    from torsionnet.base.conventions import Conventions
    from torsionnet.base.table import Table
    from torsionnet.bench import Bench
    from torsionnet.bench.campaign.running_campaign import CampaignResult


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
        # An ending that no format has is refused before the tests run.
        format_of(Path(target), "recording")
        benches = _benches(bench, self.configurations, dict(self.settings))
        results = []
        with progress("testing", len(benches)) as advance:
            for name, tested in benches:
                records, faults = _tested(tested, self.seed, truth=self.truth)
                for point, record in records.items():
                    # Names of configuration and operating point part the files; a single run keeps the name as given.
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
    test = bench.turned(seed)
    return test.records, test.faults


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


# Command ``torsionnet campaign``, which works out all records of a rotating test from one file.

ENDINGS = (".html", ".pdf", ".docx", ".tex", ".md", ".htm")


class CampaignCommand(Command):
    """Work out a test with all its records: orders or responses beside the calculation, repeatability, fit, report.

    CAMPAIGN is a YAML file, or one of the library: model, wheels, channels with calibrations, records with
    configuration and condition, the orders or frequency responses wanted, and perhaps a fit. Tracked orders are kept in
    CAMPAIGN.orders, a file for each channel, and responses in a file for each record; a record is worked out again only
    where it or its entries have changed.

    \b
    torsionnet bench marine_run_up -o run_up.npz
    torsionnet campaign marine_campaign -o report.html --plot orders.png
    """

    forms = TABLE
    picture = "measured orders or responses over the calculated ones, for each record"

    file: str = argument("CAMPAIGN")
    report: str | None = file_option("Write the report: .html, .pdf, .docx, .tex or .md.", ENDINGS)
    sections: tuple[str, ...] = option("--section", metavar="NAME", help="Of the report, as of torsionnet report.")
    folder: str | None = option(
        "--orders-folder", type=OutputFolder(), help="Keep the tracked orders there.  [default: CAMPAIGN.orders]"
    )
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions

        result, conventions = self._result(), Conventions(angle=self.angle)
        return Answer(
            screen=lambda: _campaign_screen(result, conventions),
            data=lambda: result,
            csv=lambda: _csv(result, conventions),
            files=[(self.report, lambda file: self._write_report(result, file))],
            figures=lambda plot: _figures(plot, result, conventions),
            exit_code=1 if result.fails else 0,
        )

    def _result(self) -> CampaignResult:
        from torsionnet.app.cli.terminal import stages
        from torsionnet.bench.campaign.campaign import load_campaign
        from torsionnet.bench.campaign.running_campaign import run_campaign
        from torsionnet.report.report import writer_for

        if self.report:
            writer_for(self.report)  # tells what is not installed before the records are worked out
        campaign = load_campaign(self.file)
        with stages() as show:
            result = run_campaign(
                campaign, self.folder, progress=lambda words, done, total: show("records", done, total, words)
            )
        for finding in result.findings:
            if finding.consequence:
                message("error" if finding.consequence == "fails" else "warning", finding.remark)
        for verdict in () if result.fit is None else result.fit.verdicts:
            message("warning", verdict)
        return result

    def _write_report(self, result: CampaignResult, file: str) -> None:
        from torsionnet.app.cli.terminal import stages
        from torsionnet.report.report import campaign_report, writer_for

        write = writer_for(Path(file))
        with stages() as show:
            report = campaign_report(
                result,
                sections=self.sections,
                progress=lambda name, done, total: show("sections", done, total, f"section {name.replace('_', ' ')}"),
            )
            show("writing", 0, None, f"writing {Path(file).name}")
            write(report, Path(file))


def _csv(result: CampaignResult, conventions: Conventions) -> list[tuple[str, Table]]:
    """Verdicts on orders, and the lines of the frequency responses, each where the campaign has them."""
    tables = [("orders", result.verdict_table())] if result.campaign.of_orders else []
    return tables + ([("responses", result.response_lines(conventions))] if result.campaign.of_responses else [])


def _campaign_screen(result: CampaignResult, conventions: Conventions) -> Iterator[Table | str]:
    firsts = [result.table()] if result.campaign.of_orders else []
    firsts += [*result.comparisons(conventions), *([result.response_table()] if result.campaign.of_responses else [])]
    yield from separated_by_lines(firsts)
    tables: Iterable[Table | None] = (
        result.repeatability() if result.spreads else None,
        result.response_repeatability() if result.response_spreads else None,
        None if result.fit is None else result.fit.table(),
        None if result.ranking is None else result.ranking.table(),
    )
    for table in tables:
        if table is not None:
            yield ""
            yield table


def _figures(plot: ModuleType, result: CampaignResult, conventions: Conventions) -> Iterator[tuple[str, Figure]]:
    from torsionnet.plot.order_overlay_plot import order_overlay

    for name, record in result.records.items():
        if record.calculated is not None and record.tests:
            title = f"{result.campaign.title}: {name}"
            yield name, order_overlay(record.calculated, record.tests, conventions=conventions, title=title)
    for name, response in result.responses.items():
        for test, model in response.pairs():
            yield (
                f"{name}_{test.outputs[0].name}",
                plot.comparison(test, model, conventions=conventions, title=f"{result.campaign.title}: {name}"),
            )
    if result.fit is not None:
        yield "fit", plot.fit(result.fit, conventions=conventions)
