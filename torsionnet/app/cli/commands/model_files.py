"""Commands on model files: ``library``, ``new``, ``check`` and ``show``."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import click

from torsionnet.app.cli.command import (
    JSON,
    TABLE,
    Answer,
    Command,
    ConfiguredCase,
    ModelCommand,
    separated_by_lines,
    text_answer,
)
from torsionnet.app.cli.options import STANDARD_INPUT, OutputFile, WrongUsage, argument, checked_model, option, refuse
from torsionnet.app.cli.terminal import message, print_line
from torsionnet.base.errors import Fault, UsageError, in_brackets, readable_text
from torsionnet.base.result_rows import Out

if TYPE_CHECKING:
    from torsionnet.base.entries.spec import Schema
    from torsionnet.base.plain_faults import CheckedModel
    from torsionnet.base.table import Table
    from torsionnet.drivetrain import Drivetrain


# Command ``torsionnet library``, which lists the models and studies that come with the package.

LIBRARY_KIND: Schema = {"enum": ["model", "part", "catalogue", "study", "campaign"]}
"""JSON Schema of the kind of a library file, such as a model or a part."""


@dataclass(frozen=True)
class LibraryFile:
    """File of the library with what it is about and where that is from."""

    name: Annotated[str, Out("name")]
    kind: Annotated[str, Out("kind", schema=LIBRARY_KIND)]
    what: Annotated[str, Out("what")]
    source: Annotated[str, Out("source")]
    file: str


class LibraryCommand(Command):
    """List models, studies and campaigns of the package, to be named in place of a file, parts and catalogues.

    \b
    torsionnet library
    torsionnet library --json
    """

    forms = JSON

    def answer(self) -> Answer:
        from torsionnet.base.table import result_table
        from torsionnet.model.files.library import (
            catalogue_entry,
            library_campaigns,
            library_catalogues,
            library_entry,
            library_models,
            library_parts,
            library_studies,
            study_entry,
        )

        kinds = (
            ("model", library_models(), library_entry),
            ("study", library_studies(), study_entry),
            ("campaign", library_campaigns(), study_entry),
            ("part", library_parts(), library_entry),
            ("catalogue", library_catalogues(), catalogue_entry),
        )
        rows = [
            LibraryFile(name, kind, *read(path), str(path))
            for kind, files, read in kinds
            for name, path in files.items()
        ]
        return Answer(screen=lambda: [result_table("", rows, LibraryFile)], data=lambda: rows)


# Command ``torsionnet new``, which writes a commented model file to start from.

KINDS = ("ship", "genset", "rig", "train", "turbine")
"""Kinds of starting models; each is a file of that name in the folder ``app/cli/starting_models``."""

ENDINGS = (".yaml", ".yml")
STDOUT = "-"
_NAME_LINE = "name: NAME\n"


class NewFile(OutputFile):
    """Type of the path of a model file that does not exist yet, or - for standard output."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if value == STDOUT:
            return value
        path = super().convert(value, param, ctx)
        if os.path.lexists(path):
            refuse(
                f'"{path}" exists already and is not overwritten; name another file by -o FILE',
                param,
                ctx,
                kind="unusable-place",
            )
        return path


MODEL_FILE = NewFile(ENDINGS)


class NewCommand(Command):
    """Write a commented model file to start from; all its figures are examples to be replaced.

    \b
    KIND:
      ship     two-stroke engine coupled directly to a propeller, limits of IACS UR M68, misfire
      genset   four-stroke engine, rubber coupling, generator, in its speed band
      rig      test rig from which parameters are found by frequency responses
      train    motor, reduction gear, reciprocating compressor
      turbine  wind turbine with two planetary stages

    NAME is the name of the model, or the path of the file with or without .yaml: NAME.yaml is written; default: KIND. A
    file that exists is never overwritten.

    \b
    torsionnet new ship sagafjord
    torsionnet new ship "M/S Sagafjord" -o sagafjord.yaml
    """

    kind: str = argument("KIND")
    name: str | None = argument("[NAME]", required=False)
    output_file: str | None = option(
        "-o", "--write", type=MODEL_FILE, help="The model file to write instead of NAME.yaml; - prints it."
    )

    def answer(self) -> Answer:
        if self.kind not in KINDS:
            from torsionnet.base.errors import did_you_mean

            hint = did_you_mean(self.kind, KINDS) or f"; there are {', '.join(KINDS)}"
            raise WrongUsage(f'no kind of starting model is named "{self.kind}"{hint}', kind="unknown-word")
        path, name = _path_and_name(self.kind if self.name is None else self.name, is_path=self.output_file is None)
        file = self.output_file or MODEL_FILE.convert(path, None, None)
        return text_answer(starting_model(self.kind, name), None if file == STDOUT else file)


def starting_model(kind: str, name: str) -> str:
    """Text of a model file of a kind of plant, with the name given in the place of the placeholder."""
    from torsionnet.model.files.writer import scalar_text

    template = (files("torsionnet.app.cli") / "starting_models" / f"{kind}.yaml").read_text(encoding="utf-8")
    return template.replace(_NAME_LINE, f"name: {scalar_text(readable_text(name))}\n", 1)


def _path_and_name(given: str, *, is_path: bool) -> tuple[str, str]:
    """Path of the file and name of the model; a name that is no path may have slashes in it."""
    path = given if given.lower().endswith(ENDINGS) else f"{given}.yaml"
    name = path[: path.rindex(".")]
    if is_path:
        name = "" if given.endswith(("/", os.sep)) else Path(name).name
    if not name.strip().strip("."):
        raise WrongUsage(
            f'"{given}" is no name of a model: give one, as in "torsionnet new ship sagafjord"', kind="invalid-name"
        )
    if name == STDOUT:
        raise WrongUsage("- is no name of a model: give one, and -o - prints the file", kind="invalid-name")
    return path, name.strip()


# Command ``torsionnet check``, which checks model files.

WRONG_MODEL, WRONG_USAGE = 1, 2  # exit codes


class CheckCommand(Command):
    """Check model files; every error, warning and note is shown with its place. Exit code 1 if there are errors.

    \b
    torsionnet check plant.yaml
    torsionnet check *.yaml --json
    torsionnet check plant.yaml --watch
    """

    forms = JSON

    models: tuple[str, ...] = argument("MODEL...")
    watch: bool = option("--watch", help="Check again whenever a file changes, until Ctrl-C; exit code 0 then.")

    def answer(self) -> Answer:
        if self.watch:
            self._watch()
            return Answer()
        reports, code = self._checked()
        return Answer(screen=lambda: _lines(reports), data=lambda: _records(reports), exit_code=code)

    def _checked(self) -> tuple[dict[str, Sequence[Fault]], int]:
        """Faults of each model that can be read, and the exit code; what cannot be read becomes a message."""
        reports: dict[str, Sequence[Fault]] = {}
        code = 0
        for model in dict.fromkeys(self.models):
            try:
                reports[model] = checked_model(model)
            except (UsageError, OSError) as error:
                if isinstance(error, OSError) and not self.watch:
                    raise
                message("error", f"{error}{in_brackets(getattr(error, 'kind', ''))}")
                code = WRONG_USAGE
        if any(fault.severity == "error" for faults in reports.values() for fault in faults):
            code = code or WRONG_MODEL
        return reports, code

    def _watch(self) -> None:
        from time import strftime

        from torsionnet.model.files.reader import find_model

        if self.output.as_json:
            text = "--watch prints for a reader; a program calls check --json when it wants to know"
            raise WrongUsage(f"{text}, or speaks with torsionnet language-server", kind="contradicting-entries")
        if STANDARD_INPUT in self.models:
            raise WrongUsage("standard input does not change; --watch needs files", kind="contradicting-entries")
        for model in self.models:
            find_model(model)  # a name that is wrong from the start is told at once

        def check() -> None:
            print_line(strftime("%H:%M:%S"))
            for line in _lines(self._checked()[0]):
                print_line(line)

        watch(self.models, check)


def _records(reports: dict[str, Sequence[Fault]]) -> list[CheckedModel]:
    from torsionnet.base.plain_faults import checked_model

    return [checked_model(model, faults) for model, faults in reports.items()]


def _lines(reports: dict[str, Sequence[Fault]]) -> Iterator[str]:
    for model, faults in reports.items():
        yield from map(str, faults)
        yield f"{model}: {summary(faults)}"


def summary(faults: Sequence[Fault]) -> str:
    """Text with the number of errors, warnings and notes, as ``2 errors, 1 note``.

    Warnings and notes only if there are any.

    >>> summary([Fault("x", severity="note"), Fault("y", severity="note")])
    'no errors, 2 notes'
    """
    counts = {kind: sum(fault.severity == kind for fault in faults) for kind in ("error", "warning", "note")}
    return ", ".join(
        f"{count or 'no'} {kind}{'' if count == 1 else 's'}"
        for kind, count in counts.items()
        if count or kind == "error"
    )


# Watching of model files, and of the files that they read, for changes.

BETWEEN_LOOKS = 0.3
"""Time in s between two looks at the files: a glance at the screen takes longer."""
UNTIL_WRITTEN = 0.05
"""Time in s in which a file must not change any more to count as written to its end."""


def watch(models: Iterable[str], check: Callable[[], None]) -> None:
    """Call a function at first and after each change of a model file, or of a file that it reads, until Ctrl-C.

    Changes are seen by time, size and number of a file, on all file systems alike; one that is gone, or replaced by
    another of its name, has changed, too.
    """
    from torsionnet.base.nearby_files import file_state, files_recorded
    from torsionnet.model.files.reader import find_model

    own: list[Path] = []
    for model in models:
        try:
            own.append(find_model(model))
        except UsageError:  # it may appear
            own.append(Path(model))
    watched: set[Path] = set(own)
    try:
        while True:
            seen = {file: file_state(file) for file in watched}
            with files_recorded() as read:
                check()
            watched = {*own, *read}
            seen = {**read, **seen}  # those of before the check, so that no change during it is missed
            while all(file_state(file) == seen[file] for file in watched):
                time.sleep(BETWEEN_LOOKS)
            _until_written(watched)
    except KeyboardInterrupt:
        return


def _until_written(files: Iterable[Path]) -> None:
    """Wait until an editor that empties a file, or takes it away, has written the new one."""
    from torsionnet.base.nearby_files import file_state

    known = list(files)
    before = None
    while before != (before := [file_state(file) for file in known]):
        time.sleep(UNTIL_WRITTEN)


# Command ``torsionnet show``, which prints the content of a model.


class ShowCommand(ModelCommand):
    """Elements with their values as written and in SI, parameters, inputs, sensors, configurations, mean speeds.

    With --equations, --matrices or --flat only these; --csv writes the table of elements.

    \b
    torsionnet show amt_rig -c V --plot rig.svg
    torsionnet show dmf_rig --equations
    torsionnet show dmf_rig --matrices
    """

    forms = TABLE
    picture = "the schematic"

    equations: bool = option("--equations", help="The equations of motion in the model's own symbols.")
    flat: bool = option("--flat", help="The model file with its parts put in, dots in the names of what they hold.")
    boxes: bool = option("--boxes", help="Draw each part that is used as one box.")
    matrices: bool = option("--matrices", help="M, C, K in numbers.")

    def answer(self) -> Answer:
        from torsionnet.app.cli.output import shown_model
        from torsionnet.model.overview import elements_table

        cases = self.cases()
        return Answer(
            screen=lambda: self.parts(cases),
            data=lambda: [
                shown_model(case.drivetrain, equations=self.equations, matrices=self.matrices) for case in cases
            ],
            csv=lambda: [("", self.combined_table(cases, [elements_table(case.drivetrain) for case in cases]))],
            figures=lambda plot: [
                (case.configuration, plot.schematic(case.drivetrain, boxes=self.boxes)) for case in cases
            ],
        )

    def parts(self, cases: list[ConfiguredCase]) -> Iterator[Table | str]:
        from torsionnet.model.files.writer import flat_text

        for number, case in enumerate(cases):
            if number:
                yield ""
            if self.flat:
                yield flat_text(case.drivetrain.definition).rstrip("\n")
                continue
            if not (self.equations or self.matrices):
                yield from _described(case.drivetrain)
            if self.equations:
                from torsionnet.app.cli.commands.equations_command import equations_text

                yield equations_text(case.drivetrain)
            if self.matrices:
                from torsionnet.app.cli.commands.equations_command import matrix_tables

                yield from [""] if self.equations else []
                yield from separated_by_lines(matrix_tables(case.drivetrain))


def _described(rig: Drivetrain) -> Iterator[Table | str]:
    from torsionnet.base.table import wrapped
    from torsionnet.model.overview import tables

    yield rig.title
    for text in (rig.description, rig.source and f"Source: {rig.source}"):
        yield from wrapped(text)
    for table in tables(rig):
        if table.rows:
            yield ""
            yield table
