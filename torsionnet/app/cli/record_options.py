"""Options on how a file of recorded signals is read, and how spectra are estimated from the record."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import Command
from torsionnet.app.cli.declarations import Arguments, argument, option
from torsionnet.app.cli.options import LOWEST_FREQUENCY, PRESETS, DelayOption, FiniteFloat, PairOption, StepsOption
from torsionnet.base.errors import UsageError, did_you_mean

LEAST_PRESET_RATE = 100.0
"""Least sampling rate in Hz that a preset may leave, half of what it leaves of the records that it is for."""
if TYPE_CHECKING:
    from torsionnet.signals.record_blocks import Recordings
    from torsionnet.signals.recording import Recording
    from torsionnet.signals.welch import Welch

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
        "--rate",
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
        "--between-samples",
        type=PairOption("CHANNEL", "COURSE", "T_M=held"),
        help="Its course between samples: held, straight or band_limited. Repeatable.",
    )
    resample: bool = option(
        "--resample",
        help="Make uneven time stamps even by splines, and bring channels of other rates to --rate, or the highest.",
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
                raise UsageError(f"--delay {name}: no such channel{hint}; {path} has {', '.join(known)}")

    def cut(self, record: Recording) -> Recording:
        """Recording without the delays, between the times given; UsageError where nothing of it lies there."""
        if self.delays:
            from torsionnet.signals.channel_corrections import without_delays

            record = without_delays(record, dict(self.delays))
        found = record.between(self.start, self.stop)
        if not (len(found) or any(map(len, found.pulses))):
            raise UsageError(f"nothing of the record lies there: {found.notes[-1]}")
        return found


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
                f"{rate / factor:g} are left; leave the preset out, or replace the factor where there is --decimate"
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
    start: float = LOWEST_FREQUENCY
