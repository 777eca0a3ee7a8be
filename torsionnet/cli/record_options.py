"""Options about a file of recorded signals, and about the spectra estimated from it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

import click

from torsionnet.cli.options import Finite

if TYPE_CHECKING:
    from torsionnet.signals.welch import Welch

    PairType = click.ParamType[tuple[str, str]]
else:  # not generic before click 8.2
    PairType = click.ParamType

F = TypeVar("F", bound=Callable[..., Any])
PRESETS = ("paper",)
ESTIMATORS = ("H1", "H2", "Hv", "Hs", "Hr")


class RecordPair(PairType):
    """``CHANNEL=WORD``."""

    def __init__(self, word: str, example: str) -> None:
        self.name, self.example = f"CHANNEL={word}", example

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        channel, equals, word = (part.strip() for part in value.partition("="))
        if not (channel and equals and word):
            self.fail(f'expected {self.name}, as in "{self.example}", got "{value}"', param, ctx)
        return channel, word


class StepsOption(RecordPair):
    """``CHANNEL=STEPS``, a number above 0."""

    def __init__(self) -> None:
        super().__init__("STEPS", "n1=60")

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        channel, word = super().convert(value, param, ctx)
        try:
            steps = float(word)
        except ValueError:
            steps = 0.0
        if not 0 < steps < float("inf"):
            self.fail(f"{channel}: the steps per revolution must be a positive number, got {word}", param, ctx)
        return channel, steps


@dataclass(frozen=True)
class RecordReading:
    """How a file of signals is read."""

    quantities: tuple[tuple[str, str], ...] = ()
    units: tuple[tuple[str, str], ...] = ()
    rate: float | None = None
    separator: str | None = None
    decimal: str | None = None
    resample: bool = False
    pulses: tuple[tuple[str, float], ...] = ()

    @property
    def arguments(self) -> dict[str, Any]:
        """For :func:`read_recording`."""
        dialect = {"separator": self.separator, "decimal": self.decimal}
        return {
            "quantities": dict(self.quantities),
            "units": dict(self.units),
            "sampling_rate": self.rate,
            **({"pulses": dict(self.pulses)} if self.pulses else {}),
            **{key: value for key, value in dialect.items() if value is not None},
        }


@dataclass(frozen=True)
class Averaging:
    """How spectra are averaged: a preset, and what is said against it."""

    preset: str | None = None
    window: str | None = None
    seconds: float | None = None
    overlap: float | None = None
    detrend: str | None = None
    decimation: int | None = None
    estimator: str | None = None
    references: tuple[str, ...] = ()

    def settings(self) -> Welch:
        from torsionnet.signals.welch import PAPER, Welch  # loads numpy

        base = PAPER if self.preset == "paper" else Welch()
        names = ("window", "seconds", "overlap", "detrend", "decimation", "estimator")
        given = {name: value for name in names if (value := getattr(self, name)) is not None}
        return replace(base, **given)


def record_options(command: F) -> F:
    """RECORD and how it is read, as one argument ``reading``."""
    options = [
        click.argument("record", metavar="RECORD"),
        click.option(
            "--quantity",
            "quantities",
            type=RecordPair("QUANTITY", "M1=torque"),
            multiple=True,
            help="What a channel is: torque, angle, velocity or acceleration. Repeatable.",
        ),
        click.option(
            "--unit",
            "units",
            type=RecordPair("UNIT", "M1=kNm"),
            multiple=True,
            help="Its unit in the file. Repeatable.",
        ),
        click.option("--rate", type=Finite(0, min_open=True), help="Sampling rate in Hz, if the file has none."),
        click.option("--separator", help="Between the cells of a text file, instead of finding it out."),
        click.option("--decimal", type=click.Choice([".", ","]), help="Decimal sign of a text file."),
        click.option(
            "--pulses",
            type=StepsOption(),
            multiple=True,
            help="A channel of encoder pulses, or of their times, and its steps per revolution: it becomes an angle. "
            "Repeatable.",
        ),
        click.option("--resample", is_flag=True, help="Make uneven time stamps even by splines."),
    ]
    return _gathered(command, options, "reading", RecordReading)


def estimator_options(command: F) -> F:
    """Settings of Welch's method, and the estimator, as one argument ``averaging``."""
    options = [
        click.option(
            "--estimator",
            type=click.Choice(ESTIMATORS),
            help="Default: Hr with --reference, else H2 with --preset paper, else H1.",
        ),
        click.option(
            "--reference",
            "references",
            metavar="CHANNEL",
            multiple=True,
            help="For Hr: the set-point, or what else drives the input and is free of its noise. Repeatable.",
        ),
    ]
    for option in reversed(options):
        command = option(command)
    return averaging_options(command)


def averaging_options(command: F) -> F:
    """Settings of Welch's method as one argument ``averaging``."""
    options = [
        click.option("--preset", type=click.Choice(PRESETS), help="Start from these settings; paper: Galvagno (2015)."),
        click.option("--window", help="Name of a window.  [default: hamming]"),
        click.option("--seconds", type=Finite(0, min_open=True), help="Length of a segment in s.  [default: 2]"),
        click.option("--overlap", type=Finite(0, 1, max_open=True), help="Share of a segment.  [default: 0.8]"),
        click.option("--detrend", type=click.Choice(["mean", "linear", "none"]), help="Out of every segment."),
        click.option(
            "--decimate", "decimation", type=click.IntRange(1), help="Keep every n-th sample, behind a filter."
        ),
    ]
    return _gathered(command, options, "averaging", Averaging)


def _gathered(command: F, options: Sequence[Callable[[Any], Any]], name: str, cls: type[Any]) -> F:
    """The command with these options, handed over together as one object."""
    import functools

    @functools.wraps(command)
    def gathering(*args: Any, **kwargs: Any) -> Any:
        own = {key: kwargs.pop(key) for key in cls.__dataclass_fields__ if key in kwargs}
        return command(*args, **{name: cls(**own)}, **kwargs)

    wrapped: Any = gathering
    for option in reversed(options):
        wrapped = option(wrapped)
    result: F = wrapped
    return result
