"""``torsionnet spectrogram``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from torsionnet.cli.options import Finite, csv_option, json_option, plot_option
from torsionnet.cli.record_options import Averaging, RecordReading, averaging_options, record_options
from torsionnet.cli.terminal import print_json, print_table, wrote

if TYPE_CHECKING:
    from torsionnet.response import Table
    from torsionnet.response.recording import Recording
    from torsionnet.signals.spectrogram import Spectrogram


@click.command("spectrogram")
@record_options
@click.option("--channel", "channels", metavar="CHANNEL", multiple=True, help="Repeatable; default: all of the record.")
@averaging_options
@click.option("--to", "highest", type=Finite(0, min_open=True), help="Highest frequency in Hz.")
@click.option("--span", type=Finite(0, min_open=True), default=60.0, show_default=True, help="dB shown.")
@click.option("--angle", type=click.Choice(["rad", "deg"]), default="rad", show_default=True, help="Unit of angles.")
@json_option
@csv_option
@plot_option("the level over time and frequency")
def command(
    record: str,
    reading: RecordReading,
    channels: tuple[str, ...],
    averaging: Averaging,
    highest: float | None,
    span: float,
    angle: str,
    as_json: bool,
    csv_file: str | None,
    plot_file: str | None,
) -> None:
    """Level over time and frequency; on the screen the strongest line along the record.

    \b
    torsionnet spectrogram test.npz --channel T_T --decimate 50 --plot torque.png
    """
    from torsionnet.cli.progress import progress
    from torsionnet.cli.records import load_record
    from torsionnet.response.recording import Recording
    from torsionnet.signals.decimation import decimated
    from torsionnet.signals.spectrogram import spectrogram

    settings = averaging.settings()
    with progress("transforming", None) as advance:
        found = load_record(record, reading, channels or None, settings.seconds, advance)
        if not isinstance(found, Recording):  # only what is left after decimation is kept in memory
            found = _joined(list(decimated(found, settings.decimation)))
            settings = replace(settings, decimation=1)
        seen = [spectrogram(found, name, settings) for name in channels or found.names]
    for one in seen:
        if csv_file:
            path = _file(csv_file, one.name, len(seen))
            _table(one, every=True).to_csv(path)
            wrote(path)
        if plot_file:
            _plot(one, _file(plot_file, one.name, len(seen)), highest, span, angle)
    if as_json:
        print_json([_as_data(one) for one in seen])
    else:
        for one in seen:
            print_table(_table(one))


def _joined(blocks: list[Recording]) -> Recording:
    import numpy as np

    first = blocks[0]
    signals = tuple(
        replace(signal, values=np.concatenate([block[signal.name].values for block in blocks])) for signal in first
    )
    return replace(first, signals=signals)


def _file(file: str, name: str, count: int) -> str:
    path = Path(file)
    return file if count == 1 else str(path.with_name(f"{path.stem}_{name}{path.suffix}"))


def _plot(seen: Spectrogram, file: str, highest: float | None, span: float, angle: str) -> None:
    import torsionnet.plot as plot
    from torsionnet.response import Conventions

    plot.save(plot.spectrogram(seen, highest=highest, span=span, conventions=Conventions(angle=angle)), file)
    wrote(file)


def _table(seen: Spectrogram, *, every: bool = False) -> Table:
    """The strongest line at every time; on the screen at about twenty of them."""
    from torsionnet.response import Column, Table

    columns = (
        Column("time", "s", 5),
        Column("strongest line", "Hz", 5),
        Column("amplitude", seen.unit, 4),
    )
    step = 1 if every else max(1, len(seen.times) // 20)
    strongest = seen.amplitude.max(axis=0)
    rows = tuple(zip(*(values[::step].tolist() for values in (seen.times, seen.ridge, strongest)), strict=True))
    return Table(seen.name, columns, rows, seen.notes)


def _as_data(seen: Spectrogram) -> dict[str, Any]:
    return {
        "channel": seen.name,
        "unit": seen.unit,
        "notes": list(seen.notes),
        "times_s": seen.times.tolist(),
        "frequencies_Hz": seen.frequencies.tolist(),
        "amplitude": seen.amplitude.tolist(),
    }
