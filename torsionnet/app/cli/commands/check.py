"""Command ``torsionnet check``, which checks model files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import click

from torsionnet.app.cli.command import JSON, Answer, Command, click_command
from torsionnet.app.cli.options import STANDARD_INPUT, argument, checked_model, option
from torsionnet.app.cli.terminal import message, print_line
from torsionnet.base.errors import Fault, UsageError

WRONG_MODEL, WRONG_USAGE = 1, 2  # exit codes


class CheckCommand(Command):
    """Check model files; every error, warning and note is shown with its place. Exit code 1 if there are errors."""

    forms = JSON

    models: tuple[str, ...] = argument("MODEL...")
    watch: bool = option("--watch", help="Check again whenever a file changes, until Ctrl-C; exit code 0 then.")

    def answer(self) -> Answer:
        from torsionnet.base.fault_rows import check_record

        if self.watch:
            self._watch()
            return Answer()
        reports, code = self._checked()
        return Answer(
            screen=lambda: _lines(reports),
            data=lambda: [check_record(model, faults) for model, faults in reports.items()],
            exit_code=code,
        )

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
                message("error", str(error))
                code = WRONG_USAGE
        if any(map(_errors, reports.values())):
            code = code or WRONG_MODEL
        return reports, code

    def _watch(self) -> None:
        from time import strftime

        from torsionnet.app.cli.watching import watch
        from torsionnet.model.files.reader import find_model

        if self.output.as_json:
            text = "--watch prints for a reader; a program calls check --json when it wants to know"
            raise click.UsageError(f"{text}, or speaks with torsionnet language-server")
        if STANDARD_INPUT in self.models:
            raise click.UsageError("standard input does not change; --watch needs files")
        for model in self.models:
            find_model(model)  # a name that is wrong from the start is told at once

        def check() -> None:
            print_line(strftime("%H:%M:%S"))
            for line in _lines(self._checked()[0]):
                print_line(line)

        watch(self.models, check)


def _errors(faults: Sequence[Fault]) -> int:
    return sum(fault.severity == "error" for fault in faults)


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


command = click_command("check", CheckCommand)
