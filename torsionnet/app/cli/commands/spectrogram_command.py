"""Command ``torsionnet spectrogram``, which shows the level of a recorded channel over time and frequency."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from torsionnet.app.cli.command import TABLE, Answer
from torsionnet.app.cli.options import ANGLE, FiniteFloat, option
from torsionnet.app.cli.record_options import Averaging, RecordCommand

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.signals.recording import Recording
    from torsionnet.signals.spectra import Spectrogram


class SpectrogramCommand(RecordCommand):
    """Level over time and frequency; on the screen the strongest line along the record.

    \b
    torsionnet spectrogram test.npz --channel T_T --decimate 50 --plot torque.png
    """

    forms = TABLE
    picture = "the level over time and frequency"

    channels: tuple[str, ...] = option("--channel", metavar="CHANNEL", help="Repeatable; default: all of the record.")
    averaging: Averaging
    up_to: float | None = option(
        "--up-to", type=FiniteFloat(0, min_open=True), help="Highest frequency in Hz; default: where the power ends."
    )
    span: float = option(
        "--span", type=FiniteFloat(0, min_open=True), default=60.0, show_default=True, help="dB shown."
    )
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions

        seen, shown = self.spectrograms(), Conventions(angle=self.angle)
        return Answer(
            screen=lambda: map(_strongest_lines, seen),
            data=lambda: seen,
            csv=lambda: [(channel.name, _strongest_lines(channel, every=True)) for channel in seen],
            figures=lambda plot: [
                (channel.name, plot.spectrogram(channel, up_to=self.up_to, span=self.span, conventions=shown))
                for channel in seen
            ],
        )

    def spectrograms(self) -> list[Spectrogram]:
        """Spectrograms of the recorded channels asked for."""
        from torsionnet.app.cli.record_options import load_record
        from torsionnet.app.cli.terminal import progress
        from torsionnet.signals.decimation import decimated
        from torsionnet.signals.recording import Recording
        from torsionnet.signals.spectra import spectrogram

        settings = self.averaging.settings()
        with progress("transforming", None) as advance:
            channels = self.channels or None
            record = self.averaging.suited(load_record(self.record, self.reading, channels, settings.seconds, advance))
            if not isinstance(record, Recording):  # only what is left after decimation is kept in memory
                record = _joined(list(decimated(record, settings.decimation)))
                settings = replace(settings, decimation=1)
            return [spectrogram(record, name, settings) for name in self.channels or record.names]


def _joined(blocks: list[Recording]) -> Recording:
    import numpy as np

    first = blocks[0]
    signals = tuple(
        replace(signal, values=np.concatenate([block[signal.name].values for block in blocks])) for signal in first
    )
    return replace(first, signals=signals)


def _strongest_lines(seen: Spectrogram, *, every: bool = False) -> Table:
    """Table of the strongest line of a spectrogram over time: at every time, or at about twenty for the screen."""
    from torsionnet.base.table import Column, Table

    columns = (
        Column("time", "s", 5),
        Column("strongest line", "Hz", 5),
        Column("amplitude", seen.unit, 4),
    )
    step = 1 if every else max(1, len(seen.times) // 20)
    strongest = seen.amplitude.max(axis=0)
    rows = tuple(zip(*(values[::step].tolist() for values in (seen.times, seen.ridge, strongest)), strict=True))
    return Table(seen.name, columns, rows, tuple(map(str, seen.notes)))
