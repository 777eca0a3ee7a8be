"""Base class of commands, their answers, and the function that writes and prints an answer.

Files are written before anything is printed, and nothing is written before every picture is drawn, so that an error
leaves no files behind. Of an answer only the forms asked for are made.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import click

from torsionnet.app.cli.options import (
    SETTINGS,
    Arguments,
    OutputFile,
    WrongUsage,
    argument,
    load_model,
    option,
    parameters,
    plot_option,
)
from torsionnet.app.cli.terminal import message, print_faults, print_file_written, print_json, print_line, print_table
from torsionnet.base.atomic import write_text
from torsionnet.base.errors import comma_list, remedies
from torsionnet.base.number_text import screen_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from torsionnet.base.errors import Fault
    from torsionnet.base.table import Table
    from torsionnet.drivetrain import Drivetrain


JSON = ("as_json",)
NUMBERS = (*JSON, "digits")
TABLE = ("as_json", "csv_file", "digits")
"""Names of the output options of a command that prints one table; JSON and NUMBERS: of commands that print words, or
numbers."""

OPTIONS = {
    "sampling_rate=": ("--sampling-rate", "reading: {rate: *}"), "driven_by=": ("--driven-by", "excitation: *"),
    "resample=True": ("--resample", "reading: {resample: true}"),
    "resampled()": ("--resample", "reading: {resample: true}"), "units=": ("--unit", "reading: {units: *}"),
    "quantities=": ("--quantity", "reading: {quantities: *}"), "separator=": ("--separator", "reading: {separator: *}"),
    "decimal=": ("--decimal", "reading: {decimal: *}"), "angle_from_pulses()": ("--pulses", "torsionnet angle"),
    "align=True": ("--align", "torsionnet estimate --align"),
    "output=": ("--output", "output: *"), "input=": ("--input", "input: *"),
}  # fmt: skip
"""Options for arguments and functions of Python in messages, each with what a command that lacks it has instead:
entries of the file that it is given."""
WORDS = {
    "unwrapped()": "counting the angle on",
    "iter_blocks()": "torsionnet estimate",
    "bridge_gaps=True": "a record without them",
}
"""Words for arguments and functions of Python in messages that no option stands for."""


def remedy_words(options: Collection[str]) -> dict[str, str]:
    """Words of a command with these options for arguments and functions of Python in messages.

    >>> remedy_words(["--sampling-rate"])["sampling_rate="], remedy_words([])["sampling_rate="]
    ('--sampling-rate', 'reading: {rate: *}')
    """
    return WORDS | {name: option if option in options else entry for name, (option, entry) in OPTIONS.items()}


class Output(Arguments):
    """Output options that commands share, for data, tables, digits and picture."""

    as_json: bool = option("--json", help="Print JSON instead of tables.")
    csv_file: str | None = option("--csv", type=OutputFile(), help="Write the table as CSV, in full precision.")
    digits: int | None = option(
        "--digits", type=click.IntRange(1, 17), metavar="N", help="Significant digits of numbers in tables."
    )
    plot_file: str | None = plot_option("a picture")

    def with_digits(self, table: Table) -> Table:
        """Copy of a table with as many significant digits as the command line asks for."""
        return table.with_digits(self.digits) if self.digits else table


@dataclass(frozen=True, kw_only=True)
class Answer:
    """Result of a command as functions that give its text, data, tables, pictures and files, and its exit code.

    Tables and pictures for files have a name (of a configuration or channel), which becomes part of the file's name.
    """

    screen: Callable[[], Iterable[Table | str | tuple[Any, ...]]] = tuple
    data: Callable[[], Any] = tuple
    csv: Callable[[], Sequence[tuple[str, Table]]] = tuple
    figures: Callable[[ModuleType], Iterable[tuple[str, Figure]]] = lambda _: ()
    """Function that gives names and figures of the pictures, called only if a picture is asked for."""
    files: Sequence[tuple[str | Path | None, Callable[[Any], Any]]] = ()
    exit_code: int = 0


class Command(Arguments):
    """Base class of commands, whose fields are the arguments; the docstring of a subclass is the command's help."""

    forms: ClassVar[tuple[str, ...]] = ()
    """Names of the options of :class:`Output` that the command has."""
    picture: ClassVar[str] = ""
    """Words on what the option ``--plot`` draws, for the help of the command; empty: the command draws nothing."""

    output: Output

    def answer(self) -> Answer:
        """Calculate the result of the command and return it as texts, data, tables and files to be written."""
        raise NotImplementedError


def click_command(name: str, declared: type[Command]) -> click.Command:
    """Click command made from a class of arguments."""

    def run(**values: Any) -> None:
        command = declared(**values)
        if command.output.as_json and command.output.digits:
            raise WrongUsage(
                "--digits rounds tables and --json has all digits: leave one of them out", kind="contradicting-entries"
            )
        with remedies(words):
            write_answer(command.answer(), command.output)

    forms = {parameter.name: parameter for parameter in parameters(Output)}
    params = [parameter for parameter in parameters(declared) if parameter.name not in forms]
    params += [forms[form] for form in declared.forms]
    params += [plot_option(declared.picture).parameter("plot_file", str | None)] if declared.picture else []
    words = remedy_words([option for parameter in params for option in parameter.opts])
    return CommandWithExamples(name, callback=run, params=params, help=inspect.getdoc(declared))


class CommandWithExamples(click.Command):
    """Click command in whose help the last paragraph of the text, lines to be typed, stands as examples at the end."""

    def format_help_text(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        del ctx
        text, _ = self._parts()
        formatter.write_paragraph()
        with formatter.indentation():
            formatter.write_text(text)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        del ctx
        _, examples = self._parts()
        if examples:
            with formatter.section("Examples"):
                formatter.write("".join(f"  {line}\n" for line in examples.splitlines()))

    def _parts(self) -> tuple[str, str]:
        text, _, examples = (self.help or "").rpartition("\n\n\b\n")
        return (text, examples) if examples.startswith("torsionnet ") else (self.help or "", "")


def write_answer(answer: Answer, output: Output) -> None:
    """Write and print the answer of a command in the forms asked for."""
    figures: list[tuple[str, Figure]] = []
    if output.plot_file:
        import torsionnet.plot as plot

        figures += answer.figures(plot)
    tables = answer.csv() if output.csv_file else ()
    for name, table in tables:
        path = result_path(str(output.csv_file), name, len(tables))
        table.to_csv(path)
        print_file_written(path)
    for file, write in answer.files:
        if file:
            write(file)
            print_file_written(str(file))
    for name, figure in figures:
        path = result_path(str(output.plot_file), name, len(figures))
        plot.save(figure, path)
        print_file_written(path)
    if output.as_json:
        from torsionnet.base.result_fields import to_json

        print_json(to_json(answer.data()))
    else:
        for part in answer.screen():
            _print(part, output)
    if answer.exit_code:
        raise click.exceptions.Exit(answer.exit_code)


def _print(part: Table | str | tuple[Any, ...], output: Output) -> None:
    if isinstance(part, (str, tuple)):
        print_line(screen_text(part, *([output.digits] if output.digits else [])))
    else:
        print_table(output.with_digits(part))


def result_path(file: str, name: str, count: int) -> str:
    """Path of one of several result files, as ``shapes_gear_V_clutch_open.png``; ``file`` itself if there is one."""
    if count == 1:
        return file
    path = Path(file)
    return str(path.with_name(f"{path.stem}_{name.replace('=', '_').replace(',', '_')}{path.suffix}"))


def text_answer(text: str, file: str | None) -> Answer:
    """Answer of a command whose result is one text: written to a file, or printed if none is given."""
    if file is None:
        click.echo(text, nl=False)
    return Answer(files=[(file, lambda path: write_text(path, text))])


def separated_by_lines(parts: Iterable[Table]) -> Iterator[Table | str]:
    """Tables one after the other, with an empty line between them."""
    for number, part in enumerate(parts):
        if number:
            yield ""
        yield part


# Drivetrains that a command calculates, one model in the configurations chosen, with parameters set.

Result = TypeVar("Result")
Entry = TypeVar("Entry")
CONFIGURATIONS_NAMED = 12
"""Number of configurations that a note names before it ends in "...", about two lines of a terminal."""


@dataclass(frozen=True)
class ConfiguredCase:
    """A drivetrain and the name of its configuration, empty for the model as written."""

    configuration: str
    drivetrain: Drivetrain

    def data(self, result: object, without: Collection[str] = ()) -> dict[str, Any]:
        """JSON data of a result of the case, without the fields with these names, with its configuration."""
        from torsionnet.base.result_fields import to_json

        return with_configuration(to_json(result, without), self.configuration)


def with_configuration(entries: Mapping[str, Entry], configuration: Entry) -> dict[str, Entry]:
    """Entries of a result by key, with that of its configuration behind the title, or first where it has none.

    >>> list(with_configuration({"title": "rig", "modes": ()}, "V"))
    ['title', 'configuration', 'modes']
    """
    title = {key: entries[key] for key in ("title",) if key in entries}
    return {**title, "configuration": configuration, **entries}


class ModelCommand(Command):
    """Arguments of a command that calculates a model in some of its configurations."""

    model: str = argument("MODEL")
    configurations: tuple[str, ...] = option(
        "--configuration",
        "-c",
        metavar="NAME",
        help='A configuration ("V"; "gear=V,clutch=open" on several axes), or "all". Repeatable.',
    )
    settings: tuple[tuple[str, str], ...] = SETTINGS

    def cases(self) -> list[ConfiguredCase]:
        """Drivetrain in every configuration that the command line asks for, with parameters set.

        Warnings and notes about the model go to stderr.
        """
        from torsionnet.app.cli.terminal import progress

        with progress("reading the model", None):
            rig = load_model(self.model)
            faults = list(rig.check())
        names = _names(rig, self.configurations)
        cases = []
        for name in names:
            changed = rig.configured(name, **dict(self.settings)) if name or self.settings else rig
            known = {fault.message for fault in faults}
            faults += [_of(fault, changed) for fault in changed.check() if fault.message not in known]
            cases.append(ConfiguredCase(changed.configuration, changed))
        print_faults(faults)
        return cases

    def each(
        self, what: str, cases: Sequence[ConfiguredCase], answer: Callable[[ConfiguredCase], Result]
    ) -> list[Result]:
        """Results of a function for each case, in their order, while a terminal shows what is calculated for which."""
        from torsionnet.app.cli.terminal import stages

        total, answers = (len(cases) if len(cases) > 1 else None), []
        with stages() as show:
            for done, case in enumerate(cases):
                show(what, done, total, f"{what} {case.configuration}".strip())
                answers.append(answer(case))
        return answers

    def require_one(self, why: str) -> None:
        """Raise an error with the message given where several configurations are asked for."""
        from torsionnet.model.configurations import ALL_CONFIGURATIONS

        if len(self.configurations) > 1 or ALL_CONFIGURATIONS in self.configurations:
            raise WrongUsage(why, kind="wrong-count")

    def combined_table(self, cases: Sequence[ConfiguredCase], tables: Sequence[Table]) -> Table:
        """Table with the rows of all drivetrains, and the configuration in the first column if any was named.

        Equal notes stand once; a note that is not on all cases begins with the names of its configurations.
        """
        from torsionnet.base.equal_remarks import configurations_in_words, grouped_remarks
        from torsionnet.base.table import Column

        first = tables[0]
        if not self.configurations:
            return first
        pairs = list(zip(cases, tables, strict=True))
        rows = tuple((case.configuration, *row) for case, table in pairs for row in table.rows)
        known = list(dict.fromkeys(case.configuration for case in cases))
        said = (("", case.configuration, note) for case, table in pairs for note in table.notes)
        notes = tuple(
            note if len(names) == len(known) else f"{configurations_in_words(names, known)}: {note}"
            for _, names, note in grouped_remarks(said)
        )
        title = cases[0].drivetrain.name if len(cases) > 1 else first.title
        columns = (Column("configuration"), *first.columns)
        return replace(first, title=title, columns=columns, rows=rows, notes=notes)


def _of(fault: Fault, changed: Drivetrain) -> Fault:
    return replace(fault, configuration=fault.configuration or changed.configuration)


def _names(rig: Drivetrain, configurations: Sequence[str]) -> list[str]:
    from torsionnet.model.configurations import ALL_CONFIGURATIONS

    available = rig.configurations
    if not configurations:
        if available:
            names = comma_list(available, CONFIGURATIONS_NAMED, ", ...")
            message("note", f"parameters as written; configurations: {names} (-c NAME, or -c all)")
        return [""]
    if ALL_CONFIGURATIONS in configurations and ALL_CONFIGURATIONS not in available:
        if not available:
            message("note", "the model has no configurations")
        return list(available) or [""]
    return list(dict.fromkeys(configurations))
