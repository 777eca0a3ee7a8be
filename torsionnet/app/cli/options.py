"""Declarations of command-line arguments as fields of a class.

Option words, type and help stand beside the name of the value.

The type of a field implies a flag, a repeatable or required option, or a number. An option of several commands is a
constant in ``app/cli/options.py``; options that go together are a class of their own, and a field of that class.

>>> class Run(Arguments):
...     seed: int | None = option("--seed", type=int)
...     names: tuple[str, ...] = option("--name")
>>> [option.opts for option in parameters(Run)], Run(seed=3).names
([['--seed'], ['--name']], ())
"""

from __future__ import annotations

import math
import sys
import types
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, get_args, get_origin, get_type_hints

import click

if TYPE_CHECKING:
    from torsionnet.base.errors import Fault
    from torsionnet.drivetrain import Drivetrain


class Declaration:
    """Settings from which a field of a class becomes a :class:`click.Option` or :class:`click.Argument`."""

    def __init__(self, makes: type[click.Parameter], words: tuple[str, ...], settings: dict[str, Any]) -> None:
        self.makes, self.words, self.settings = makes, words, settings

    def parameter(self, name: str, hint: Any) -> click.Parameter:
        """Click option or argument made from the settings, whose value has the name given.

        ``hint`` is the type of the field.
        """
        return self.makes([*self.words, name], **{**self._implied(hint), **self.settings})

    def default(self, hint: Any) -> Any:
        """Value of the field if its option is not on the command line."""
        return self.settings.get("default", () if get_origin(hint) is tuple else False if hint is bool else None)

    def _implied(self, hint: Any) -> dict[str, Any]:
        """Settings of click that follow from the type of the field, by name."""
        if self.makes is click.Argument:
            return {"nargs": -1, "required": True} if get_origin(hint) is tuple else {}
        if hint is bool:
            return {"is_flag": True}
        if get_origin(hint) is tuple:
            return {"multiple": True}
        optional = isinstance(hint, types.UnionType)
        number = float if float in (hint, *get_args(hint)) else None
        return {"type": number, "required": not optional and "default" not in self.settings}


def option(*words: str, **settings: Any) -> Any:
    """Declaration of a field as an option with its words, as ``--seed``.

    Settings are those of :class:`click.Option`.
    """
    return Declaration(click.Option, words, settings)


def argument(metavar: str, **settings: Any) -> Any:
    """Declaration of a field as a positional argument, shown in the help by its metavar.

    Settings are those of :class:`click.Argument`.
    """
    return Declaration(click.Argument, (), {"metavar": metavar, **settings})


class Arguments:
    """Base of classes whose fields are command-line arguments; fields that are not given have their defaults."""

    def __init__(self, **values: Any) -> None:
        for name, hint, declared in _fields(type(self)):
            if declared is None:
                vars(self)[name] = hint(**values)
            else:
                vars(self)[name] = values.get(name, declared.default(hint))


def parameters(declared: type[Arguments]) -> Iterator[click.Parameter]:
    """Click options and arguments of a class of arguments, those of base classes first."""
    for name, hint, declaration in _fields(declared):
        if declaration is None:
            yield from parameters(hint)
        else:
            yield declaration.parameter(name, hint)


def _fields(declared: type[Arguments]) -> Iterator[tuple[str, Any, Declaration | None]]:
    """Name, type and declaration of each field of a class of arguments.

    None as the declaration of a field that is a class of arguments.
    """
    for name, hint in get_type_hints(declared).items():
        declaration = getattr(declared, name, None)
        if isinstance(declaration, Declaration):
            yield name, hint, declaration
        elif isinstance(hint, type) and issubclass(hint, Arguments):
            yield name, hint, None


# Types of option values, which refuse wrong values before anything is calculated, and options of several commands.

if TYPE_CHECKING:
    PairType = click.ParamType[tuple[str, Any]]
    EntryType = click.ParamType[Any]
    FileType = click.ParamType[str]
else:  # not generic before click 8.2
    PairType = FileType = EntryType = click.ParamType

PLOT_ENDINGS = (".svg", ".png", ".pdf")
PRESETS = ("paper",)


class WrongUsage(click.UsageError):
    """Error of options and arguments that do not go together, with the kind of fault that they have."""

    def __init__(self, message: str, *, kind: str) -> None:
        super().__init__(message)
        self.kind = kind


def refuse(message: str, param: click.Parameter | None, ctx: click.Context | None, *, kind: str) -> NoReturn:
    """Raise an error of the value of an option, with its kind of fault."""
    error = click.BadParameter(message, ctx, param)
    error.kind = kind  # type: ignore[attr-defined]
    raise error


def kind_of_usage(error: click.UsageError) -> str:
    """Kind of fault of an error of the command line; those of click itself have that of their class."""
    if hasattr(error, "kind"):
        return str(error.kind)
    if isinstance(error, click.NoSuchOption):
        return "unknown-word"
    if isinstance(error, click.MissingParameter | click.BadOptionUsage):
        return "missing-entry"
    if not isinstance(error, click.BadParameter):
        return "needless-entry"  # an argument too many
    kind = error.param.type if error.param is not None else None
    if isinstance(kind, click.Choice):
        return "unknown-word"
    if isinstance(kind, click.Path | click.File):
        return "missing-file"
    return "not-a-number" if isinstance(error.__context__, ValueError) else "out-of-range"


class PairOption(PairType):
    """Type of an option value ``LEFT=RIGHT``, read as a pair of texts."""

    def __init__(self, left: str, right: str, example: str) -> None:
        self.name, self.example = f"{left}={right}", example

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        left, equals, right = (part.strip() for part in value.partition("="))
        if not (left and equals and right):
            refuse(f'expected {self.name}, as in "{self.example}", got "{value}"', param, ctx, kind="wrong-form")
        return left, right


class DelayOption(PairOption):
    """Type of an option value ``CHANNEL=TIME``, read as a channel and a time in s by which it comes late."""

    def __init__(self) -> None:
        super().__init__("CHANNEL", "TIME", "T=1.2ms")

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        from torsionnet.base.entries.scalars import Value
        from torsionnet.base.entries.spec import EntryError

        name, text = super().convert(value, param, ctx)
        try:
            return name, float(Value("delay", "time", lower=None).coerce(text))
        except EntryError as error:
            refuse(f"{name}: {error}", param, ctx, kind=error.fault.kind)


class SettingOption(PairOption):
    """Type of the option value ``--set NAME=VALUE``, read as a parameter and the text of its value.

    Refused if it has no known unit.
    """

    def __init__(self) -> None:
        super().__init__("NAME", "VALUE", "c_O=360 N*m*s/rad")

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        from torsionnet.base.entries.scalars import read_scalar
        from torsionnet.base.entries.spec import EntryError

        name, text = super().convert(value, param, ctx)
        try:
            read_scalar(text)
        except EntryError as error:
            refuse(f"{name}: {error}", param, ctx, kind=error.fault.kind)
        return name, text


class StepsOption(PairOption):
    """Type of an option value ``CHANNEL=STEPS``, read as a channel and its steps per revolution.

    The number of steps is above 0.
    """

    def __init__(self) -> None:
        super().__init__("CHANNEL", "STEPS", "n1=60")

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        channel, word = super().convert(value, param, ctx)
        try:
            steps = float(word)
        except ValueError:
            steps = 0.0
        if not 0 < steps < float("inf"):
            refuse(
                f"{channel}: the steps per revolution must be a positive number, got {word}",
                param,
                ctx,
                kind="out-of-range",
            )
        return channel, steps


class EntryOption(EntryType):
    """Type of an option value that is read like an entry of a model file, with its unit.

    ``entry`` is the ``module:name`` of the specification of that entry, imported when a value is read.
    """

    def __init__(self, name: str, entry: str) -> None:
        self.name, self.entry = name, entry

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        import importlib

        from torsionnet.base.entries.spec import EntryError

        module, _, name = self.entry.partition(":")
        try:
            return getattr(importlib.import_module(f"torsionnet.{module}"), name).coerce(value)
        except EntryError as error:
            refuse(str(error), param, ctx, kind=error.fault.kind)


class FiniteFloat(click.FloatRange):
    """Type of an option value that is a finite number within limits; nan and inf are refused."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            refuse(f"{number} is no finite number", param, ctx, kind="not-finite")
        return number


class OutputFile(FileType):
    """Type of an option value that is a file to write, refused if its folder is missing or its ending unknown."""

    name = "FILE"

    def __init__(self, endings: tuple[str, ...] = ()) -> None:
        self.endings = endings

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        path = Path(value)
        if self.endings and path.suffix.lower() not in self.endings:
            refuse(f'"{value}" does not end in {", ".join(self.endings)}', param, ctx, kind="unknown-word")
        if path.is_dir():
            refuse(f'"{value}" is a folder', param, ctx, kind="unusable-place")
        if not path.parent.is_dir():
            refuse(f'"{value}": there is no folder {path.parent}', param, ctx, kind="missing-file")
        return str(value)


class OutputFolder(FileType):
    """Type of an option value that is a folder which exists or can be made."""

    name = "FOLDER"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        path = Path(value)
        if path.exists() and not path.is_dir():
            refuse(f'"{value}" is a file, and a folder is needed', param, ctx, kind="unusable-place")
        if not path.parent.is_dir():
            refuse(f'"{value}": there is no folder {path.parent}', param, ctx, kind="missing-file")
        return str(value)


def file_option(text: str, endings: tuple[str, ...] = ()) -> Any:
    """Declaration of the option ``-o``, ``--write`` of a command that makes a file."""
    return option("-o", "--write", type=OutputFile(endings), help=text)


def plot_option(what: str) -> Any:
    """Declaration of the option ``--plot``, which names the file of a picture.

    ``what`` are the words for the picture in its help.
    """
    text = f"Write {what} as {', '.join(ending[1:].upper() for ending in PLOT_ENDINGS)}, by the ending."
    return option("--plot", type=OutputFile(PLOT_ENDINGS), help=text)


def band_option(text: str, bound: click.FloatRange | type[float] = float) -> Any:
    """Declaration of the option ``--band``, a lowest and a highest frequency."""
    return option("--band", type=(bound, bound), metavar="LOW HIGH", help=text)


USABLE_BAND = band_option("Frequencies in Hz that are used; HIGH may be inf.  [default: all of the record]")
SIMPLIFY = option(
    "--simplify",
    type=EntryOption("SHARE", "report.plan.report_plan:SIMPLIFY"),
    help="Leave out elements that move natural frequency and damping ratio of no mode in the band by more, as 1%.",
)
SETTINGS = option(
    "--set", type=SettingOption(), help='Change a parameter: "c_O=360 N*m*s/rad", a bare number is SI. Repeatable.'
)
FREQUENCY_UNIT = option(
    "--frequency-unit",
    type=click.Choice(["Hz", "rpm", "cpm", "rad/s"], case_sensitive=False),
    default="Hz",
    show_default=True,
    help="Unit of frequencies, given and shown.",
)
ANGLE = option(
    "--angle-unit", type=click.Choice(["rad", "deg"]), default="rad", show_default=True, help="Unit of angles."
)
ALIGN = option(
    "--align", help="Move the output by its lag before windows cut the record, and put the phase of the lag back."
)
STEPPED: Any = option(
    "--stepped",
    help="Of a sine that steps through amplitudes: k', k'' and eta_1 of the torque --output over the twist --input.",
)
NONLINEAR: Any = option(
    "--nonlinear",
    type=click.Choice(["linear", "periodic"]),
    help="Laws of motion linear about the operating point, or in full, of all periodic motions the largest stable one."
    "  [default: that of the model, else linear]",
)
DRIVEN_BY = option(
    "--driven-by",
    metavar="INPUT",
    help="What drives the drivetrain while an input is measured, if it has several inputs.",
)


REFERRED_TO: Any = option(
    "--referred-to", metavar="NODE", help="Outputs referred to the shaft of this node: torques, angles and their rates."
)


def referred_outputs(outputs: tuple[str, ...], shaft: str | None) -> list[str]:
    """Names of outputs, each with the shaft it is referred to if a shaft is given."""
    return [f"{name} referred to {shaft}" if shaft else name for name in outputs]


# Models loaded by file, by name in the library, or from standard input.

STANDARD_INPUT = "-"
STANDARD_INPUT_NAME = "<stdin>"


def load_model(model: str) -> Drivetrain:
    """Drivetrain of a model file, or of a library model called by its name.

    ``-`` reads the model from standard input.
    """
    from torsionnet.drivetrain import load, loads

    return loads(standard_input_text(), STANDARD_INPUT_NAME) if model == STANDARD_INPUT else load(model)


def checked_model(model: str) -> list[Fault]:
    """Errors, warnings and notes on a model, also on unstable modes in any of its configurations."""
    from torsionnet.app.text.unstable_configurations import unstable_configurations
    from torsionnet.model.files.reader import read_file, read_text

    if model == STANDARD_INPUT:
        return read_text(standard_input_text(), STANDARD_INPUT_NAME, further=unstable_configurations)[1]
    return read_file(model, unstable_configurations)[1]


def standard_input_text() -> str:
    """Text of a model read from standard input."""
    from torsionnet.model.files.library import decode

    return decode(sys.stdin.buffer.read(), STANDARD_INPUT_NAME)
