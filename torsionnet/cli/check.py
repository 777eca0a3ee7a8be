"""``torsionnet check``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import click

from torsionnet.cli.models import read_model
from torsionnet.cli.options import json_option
from torsionnet.cli.terminal import message, print_json, say
from torsionnet.core.errors import Fault, UsageError

WRONG_MODEL, WRONG_USAGE = 1, 2


@click.command("check")
@click.argument("models", metavar="MODEL...", nargs=-1, required=True)
@json_option
def command(models: tuple[str, ...], as_json: bool) -> None:
    """Check model files; every error, warning and note is shown with its place. Exit code 1 if there are errors."""
    reports: dict[str, Sequence[Fault]] = {}
    code = 0
    for model in dict.fromkeys(models):
        try:
            reports[model] = read_model(model)[1]
        except UsageError as error:
            message("error", str(error))
            code = WRONG_USAGE
    if as_json:
        print_json([_as_data(model, faults) for model, faults in reports.items()])
    else:
        for model, faults in reports.items():
            _show(model, faults)
    if any(_errors(faults) for faults in reports.values()):
        code = code or WRONG_MODEL
    raise click.exceptions.Exit(code)


def _errors(faults: Sequence[Fault]) -> int:
    return sum(fault.severity == "error" for fault in faults)


def _show(model: str, faults: Sequence[Fault]) -> None:
    for fault in faults:
        say(str(fault))
    say(f"{model}: {summary(faults)}")


def summary(faults: Sequence[Fault]) -> str:
    """``2 errors, 1 note``; errors are always counted, the rest if there is any.

    >>> summary([Fault("x", severity="note"), Fault("y", severity="note")])
    'no errors, 2 notes'
    """
    counts = {kind: sum(fault.severity == kind for fault in faults) for kind in ("error", "warning", "note")}
    return ", ".join(
        f"{count or 'no'} {kind}{'' if count == 1 else 's'}"
        for kind, count in counts.items()
        if count or kind == "error"
    )


def _as_data(model: str, faults: Sequence[Fault]) -> dict[str, Any]:
    listed = [
        {
            "severity": fault.severity,
            "message": fault.text,
            "meant": fault.meant,
            "configuration": fault.configuration,
            "path": list(fault.path),
            "position": None if fault.position is None else asdict(fault.position),
        }
        for fault in faults
    ]
    return {"model": model, "errors": _errors(faults), "faults": listed}
