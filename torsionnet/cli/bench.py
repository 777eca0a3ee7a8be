"""``torsionnet bench``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from torsionnet.cli.options import CommandSettings, json_option, output_file_option, plot_option
from torsionnet.cli.terminal import message, print_json, print_table, say, wrote

if TYPE_CHECKING:
    from torsionnet.bench import Bench
    from torsionnet.response import Table
    from torsionnet.response.recording import Recording

ALL = "all"


@click.command("bench")
@click.argument("rig", metavar="RIG")
@click.option(
    "--configuration",
    "-c",
    "configurations",
    metavar="NAME",
    multiple=True,
    help='Of the model, instead of that in the file; or "all". Repeatable.',
)
@click.option(
    "--set", "settings", type=CommandSettings(), multiple=True, help="Change a parameter of the model. Repeatable."
)
@click.option("--seed", type=click.IntRange(0), help="Another run of the same test.")
@output_file_option("The record; default: RIG.npz here. The ending tells the format.")
@click.option("--truth", is_flag=True, help="Write torque and motion as they are, without errors of measurement.")
@json_option
@plot_option("the signals over time")
def command(
    rig: str,
    configurations: tuple[str, ...],
    settings: tuple[tuple[str, str], ...],
    seed: int | None,
    output_file: str | None,
    truth: bool,
    as_json: bool,
    plot_file: str | None,
) -> None:
    """Run a test on a model instead of a rig, and write the record.

    RIG is a model file with a bench: section, a file that names a model and has a bench:, or a bench of the library.

    \b
    torsionnet bench amt_bench -c II -o gear_II.tdms
    torsionnet bench dmf_bench --seed 7 --plot signals.png
    """
    from torsionnet.bench import load_bench
    from torsionnet.cli.progress import progress
    from torsionnet.io.formats.registry import format_of
    from torsionnet.io.recording_files import write_recording

    bench = load_bench(rig)
    target = Path(output_file or f"{Path(rig).stem}.npz")
    format_of(target, "recording")
    benches = _benches(bench, configurations, dict(settings))
    results = []
    with progress("testing", len(benches)) as advance:
        for name, one in benches:
            record = one.truth if truth else one.run(seed)
            path = target if len(benches) == 1 else target.with_name(f"{target.stem}_{name}{target.suffix}")
            write_recording(record, path)
            results.append((name, str(path), record))
            if plot_file:
                plot = Path(plot_file)
                _plot(record, plot if len(benches) == 1 else plot.with_name(f"{plot.stem}_{name}{plot.suffix}"))
            advance(1)
    _say(results, as_json=as_json)


def _benches(bench: Bench, configurations: tuple[str, ...], settings: dict[str, Any]) -> list[tuple[str, Bench]]:
    names = list(bench.drivetrain.configurations) if ALL in configurations else list(dict.fromkeys(configurations))
    if not names:
        return [("", bench.configured(**settings) if settings else bench)]
    return [(name.replace("=", "_").replace(",", "_"), bench.configured(name, **settings)) for name in names]


def _plot(record: Recording, path: Path) -> None:
    import torsionnet.plot as plot
    from torsionnet.response import Conventions

    plot.save(plot.time_histories(record, conventions=Conventions(angle="deg")), path)
    wrote(str(path))


def _say(results: list[tuple[str, str, Recording]], *, as_json: bool) -> None:
    if as_json:
        print_json([_as_data(name, path, record) for name, path, record in results])
        return
    for _, path, record in results:
        print_table(_table(record))
        for note in record.notes:
            kind, _, text = note.partition(": ")
            message("warning", text) if kind == "warning" else say(note)
        wrote(path)


def _table(record: Recording) -> Table:
    from torsionnet.response import Column, Table

    sizes = (Column(name, digits=4) for name in ("smallest", "largest", "RMS"))
    columns = (Column("channel"), Column("unit"), *sizes, Column("notes"))
    rows = tuple((s.name, s.unit, *_sizes(s.values), "; ".join(s.notes)) for s in record)
    span = f"{len(record)} samples at {record.sampling_rate:g} Hz, {record.duration:g} s"
    return Table(f"{record.title}: {span}", columns, rows)


def _sizes(values: Any) -> tuple[float, float, float]:
    return float(values.min()), float(values.max()), float((values**2).mean() ** 0.5)


def _as_data(name: str, path: str, record: Recording) -> dict[str, Any]:
    channels = [
        {"name": s.name, "unit": s.unit, **dict(zip(("smallest", "largest", "RMS"), _sizes(s.values), strict=True))}
        | {"notes": list(s.notes)}
        for s in record
    ]
    return {
        "title": record.title,
        "configuration": name,
        "file": path,
        "sampling_rate_Hz": record.sampling_rate,
        "samples": len(record),
        "duration_s": record.duration,
        "notes": list(record.notes),
        "channels": channels,
    }
