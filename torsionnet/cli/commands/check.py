"""Command ``torsionnet check``, which checks model files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from torsionnet.cli.command import JSON, Answer, Command, click_command
from torsionnet.cli.declarations import argument
from torsionnet.cli.models import checked_model
from torsionnet.cli.terminal import message
from torsionnet.core.errors import Fault, UsageError

WRONG_MODEL, WRONG_USAGE = 1, 2  # exit codes


class CheckCommand(Command):
    """Check model files; every error, warning and note is shown with its place. Exit code 1 if there are errors."""

    forms = JSON

    models: tuple[str, ...] = argument("MODEL...")

    def answer(self) -> Answer:
        from torsionnet.core.fault_rows import check_record

        reports: dict[str, Sequence[Fault]] = {}
        code = 0
        for model in dict.fromkeys(self.models):
            try:
                reports[model] = checked_model(model)
            except UsageError as error:
                message("error", str(error))
                code = WRONG_USAGE
        if any(map(_errors, reports.values())):
            code = code or WRONG_MODEL
        return Answer(
            screen=lambda: _lines(reports),
            data=lambda: [check_record(model, faults) for model, faults in reports.items()],
            exit_code=code,
        )


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
