"""Arguments and options that several commands share, refused before anything is calculated."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    SettingType = click.ParamType[tuple[str, str]]
    FileType = click.ParamType[str]
else:  # not generic before click 8.2
    SettingType = FileType = click.ParamType

F = TypeVar("F", bound=Callable[..., Any])

PLOT_ENDINGS = (".svg", ".png", ".pdf")


class CommandSettings(SettingType):
    """``NAME=VALUE``, with a value that can be read."""

    name = "NAME=VALUE"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        from torsionnet.core.entries.scalars import read_value
        from torsionnet.core.entries.spec import EntryError

        name, equals, text = (part.strip() for part in value.partition("="))
        if not (name and equals and text):
            self.fail(f'expected NAME=VALUE, as in "c_O=360 N*m*s/rad", got "{value}"', param, ctx)
        try:
            read_value(text)
        except EntryError as error:
            self.fail(f"{name}: {error}", param, ctx)
        return name, text


class Finite(click.FloatRange):
    """A number within limits; not a number is within none."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{number} is no finite number", param, ctx)
        return number


class OutputFile(FileType):
    """A file that could be written, with one of the endings if there is a choice."""

    name = "FILE"

    def __init__(self, endings: tuple[str, ...] = ()) -> None:
        self.endings = endings

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        path = Path(value)
        if self.endings and path.suffix.lower() not in self.endings:
            self.fail(f'"{value}" does not end in {", ".join(self.endings)}', param, ctx)
        if path.is_dir():
            self.fail(f'"{value}" is a folder', param, ctx)
        if not path.parent.is_dir():
            self.fail(f'"{value}": there is no folder {path.parent}', param, ctx)
        return str(value)


def model_options(command: F) -> F:
    """MODEL, --configuration, --set."""
    command = click.option(
        "--set",
        "settings",
        type=CommandSettings(),
        multiple=True,
        help='Change a parameter: "c_O=360 N*m*s/rad", a bare number is SI. Repeatable.',
    )(command)
    command = click.option(
        "--configuration",
        "-c",
        "configurations",
        metavar="NAME",
        multiple=True,
        help='A configuration ("V"; "gear=V,clutch=open" on several axes), or "all". Repeatable.',
    )(command)
    return click.argument("model", metavar="MODEL")(command)


def output_file_option(text: str, endings: tuple[str, ...] = (), *, required: bool = False) -> Callable[[F], F]:
    """-o, --output-file: what a command makes, if that is a file."""
    return click.option("-o", "--output-file", type=OutputFile(endings), required=required, help=text)


def json_option(command: F) -> F:
    return click.option("--json", "as_json", is_flag=True, help="Print JSON instead of tables.")(command)


def csv_option(command: F) -> F:
    return click.option("--csv", "csv_file", type=OutputFile(), help="Write the table as CSV, in full precision.")(
        command
    )


def plot_option(what: str) -> Callable[[F], F]:
    text = f"Write {what} as {', '.join(ending[1:].upper() for ending in PLOT_ENDINGS)}, by the ending."
    return click.option("--plot", "plot_file", type=OutputFile(PLOT_ENDINGS), help=text)


def frequency_unit_option(command: F) -> F:
    return click.option(
        "--frequency-unit",
        type=click.Choice(["Hz", "rpm", "cpm", "rad/s"], case_sensitive=False),
        default="Hz",
        show_default=True,
        help="Unit of frequencies, given and shown.",
    )(command)
