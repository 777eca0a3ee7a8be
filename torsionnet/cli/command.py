"""A command: arguments, an answer to them, and the one way in which answers are given.

Files are written before anything is printed, and nothing is written before every picture is drawn, so that what is
refused is refused first. Of an answer only those forms are made that are asked for.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar

import click

from torsionnet.cli.declarations import Arguments, option, parameters
from torsionnet.cli.options import OutputFile, plot_option
from torsionnet.cli.terminal import print_json, print_table, say, wrote
from torsionnet.core.atomic import write_text
from torsionnet.core.number_text import on_screen

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from torsionnet.response.table import Table

JSON = ("as_json",)
NUMBERS = (*JSON, "digits")
TABLE = ("as_json", "csv_file", "digits")
"""Forms of commands that print words, numbers, one table."""


class Output(Arguments):
    """The forms of a result that are asked for, beside a file that is the result."""

    as_json: bool = option("--json", help="Print JSON instead of tables.")
    csv_file: str | None = option("--csv", type=OutputFile(), help="Write the table as CSV, in full precision.")
    digits: int | None = option(
        "--digits", type=click.IntRange(1, 17), metavar="N", help="Significant digits of numbers in tables."
    )
    plot_file: str | None = plot_option("a picture")

    def sized(self, table: Table) -> Table:
        """The table with the digits asked for."""
        return table.with_digits(self.digits) if self.digits else table


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What a command found, in every form it has.

    Tables and pictures for files have the name of what they are about, which tells several files apart.
    """

    screen: Callable[[], Iterable[Table | str | tuple[Any, ...]]] = tuple
    data: Callable[[], Any] = tuple
    csv: Callable[[], Sequence[tuple[str, Table]]] = tuple
    figures: Callable[[ModuleType], Iterable[tuple[str, Figure]]] = lambda _: ()
    """By :mod:`torsionnet.plot`, which is imported where a picture is asked for."""
    files: Sequence[tuple[str | Path | None, Callable[[Any], Any]]] = ()
    exit_code: int = 0


class Command(Arguments):
    """Arguments of a command; the text of the class is its help."""

    forms: ClassVar[tuple[str, ...]] = ()
    """Options of :class:`Output` that the command has."""
    picture: ClassVar[str] = ""
    """What ``--plot`` draws."""

    output: Output

    def answer(self) -> Answer:
        """Do what is asked for."""
        raise NotImplementedError


def click_command(name: str, declared: type[Command]) -> click.Command:
    """The command as click runs it."""

    def run(**values: Any) -> None:
        command = declared(**values)
        if command.output.as_json and command.output.digits:
            raise click.UsageError("--digits is about tables; --json has all digits")
        emit(command.answer(), command.output)

    forms = {one.name: one for one in parameters(Output)}
    params = [one for one in parameters(declared) if one.name not in forms]
    params += [forms[form] for form in declared.forms]
    params += [plot_option(declared.picture).parameter("plot_file", str | None)] if declared.picture else []
    return click.Command(name, callback=run, params=params, help=inspect.getdoc(declared))


def emit(answer: Answer, output: Output) -> None:
    """Give an answer in the forms asked for."""
    figures: list[tuple[str, Figure]] = []
    if output.plot_file:
        import torsionnet.plot as plot

        figures += answer.figures(plot)
    tables = answer.csv() if output.csv_file else ()
    for name, table in tables:
        path = beside(str(output.csv_file), name, len(tables))
        table.to_csv(path)
        wrote(path)
    for file, write in answer.files:
        if file:
            write(file)
            wrote(str(file))
    for name, figure in figures:
        path = beside(str(output.plot_file), name, len(figures))
        plot.save(figure, path)
        wrote(path)
    if output.as_json:
        print_json(answer.data())
    else:
        for part in answer.screen():
            _print(part, output)
    if answer.exit_code:
        raise click.exceptions.Exit(answer.exit_code)


def _print(part: Table | str | tuple[Any, ...], output: Output) -> None:
    if isinstance(part, (str, tuple)):
        say(on_screen(part, *([output.digits] if output.digits else [])))
    else:
        print_table(output.sized(part))


def beside(file: str, name: str, count: int) -> str:
    """The file itself for a single result, else one for each: ``shapes.png`` -> ``shapes_gear_V_clutch_open.png``."""
    if count == 1:
        return file
    path = Path(file)
    return str(path.with_name(f"{path.stem}_{name.replace('=', '_').replace(',', '_')}{path.suffix}"))


def text_answer(text: str, file: str | None) -> Answer:
    """A text that is the result itself: in a file, or else printed as it is."""
    if file is None:
        click.echo(text, nl=False)
    return Answer(files=[(file, lambda path: write_text(path, text))])


def spaced(parts: Iterable[Table]) -> Iterator[Table | str]:
    """Tables with an empty line between them."""
    for number, part in enumerate(parts):
        if number:
            yield ""
        yield part
