"""Command ``torsionnet sensitivity``, which derives natural frequencies and damping ratios by the parameters."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import click

from torsionnet.app.cli.cases import ModelCommand
from torsionnet.app.cli.command import TABLE, Answer, click_command
from torsionnet.app.cli.options import EXCITATION, option
from torsionnet.base.errors import UsageError

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.linear.sensitivity import ModeSensitivities

NEGLIGIBLE_EFFECT = 1e-9
"""Largest effect, in percent of frequency or damping per percent of a parameter, left out as mere rounding."""
EFFECTS_SHOWN = 10
"""Number of effects of parameters on modes that the screen shows unless modes, parameters or all are asked for."""


class SensitivityCommand(ModelCommand):
    """Exact derivatives of natural frequencies and damping ratios to the parameters of a model.

    \b
    torsionnet sensitivity amt_rig -c V --mode 1 --plot tornado.png
    """

    forms = TABLE
    picture = "a tornado plot"

    parameters: tuple[str, ...] = option(
        "--parameter", metavar="NAME", help="Or element.field; default: all. Repeatable."
    )
    modes: tuple[int, ...] = option("--mode", type=click.IntRange(1), help="Only this mode. Repeatable.")
    measured_input: str | None = option(
        "--measured-input", metavar="SENSOR", help="Poles of responses against this sensor instead."
    )
    excitation: str | None = EXCITATION
    full: bool = option("--full", help=f"Print every effect instead of the {EFFECTS_SHOWN} largest.")

    def answer(self) -> Answer:
        cases = self.cases()
        from torsionnet.linear.sensitivity import mode_sensitivities

        results = self.each(
            "sensitivities",
            cases,
            lambda case: mode_sensitivities(
                case.drivetrain,
                list(self.parameters) or None,
                measured_input=self.measured_input,
                excitation=self.excitation,
            ),
        )
        _require(self.modes, results)
        tables = [_chosen(one, self.modes) for one in results]
        every = self.full or self.modes or self.parameters
        short = tables if every else [_largest(*one) for one in zip(results, tables, strict=True)]
        pairs = list(zip(cases, results, strict=True))
        return Answer(
            screen=lambda: [self.combined_table(cases, short)],
            data=lambda: [effects.record(case.configuration, self.modes) for case, effects in pairs],
            csv=lambda: [("", self.combined_table(cases, tables))],
            figures=lambda plot: [
                (case.configuration, plot.tornado(one, modes=list(self.modes) or None)) for case, one in pairs
            ],
        )


def _require(modes: tuple[int, ...], results: list[ModeSensitivities]) -> None:
    every = {one.number(mode) for one in results for mode in range(len(one.poles))}
    known = sorted(number for number in every if number is not None)
    for mode in modes:
        if mode not in known:
            raise UsageError(
                f"there is no mode {mode}; the model has the modes {', '.join(map(str, known)) or '(none)'}"
            )


def _chosen(found: ModeSensitivities, modes: tuple[int, ...]) -> Table:
    """Table of the effects of parameters on the modes chosen, without effects that are rounding errors.

    None chosen: all modes.
    """
    table = found.table()
    rows = tuple(
        row
        for row in table.rows
        if (not modes or row[0] in modes) and max(abs(row[4]), abs(row[5])) > NEGLIGIBLE_EFFECT
    )
    words, rest = table.notes[: len(found.poles)], table.notes[len(found.poles) :]
    notes = (*(note for index, note in enumerate(words) if not modes or found.number(index) in modes), *rest)
    return replace(table, rows=rows, notes=notes)


def _largest(found: ModeSensitivities, table: Table) -> Table:
    """Table of the effects that change an eigenvalue most relative to its size, without the words on other modes."""
    if len(table.rows) <= EFFECTS_SHOWN:
        return table
    rows = sorted(table.rows, key=lambda row: math.hypot(row[4], row[2] * row[5]), reverse=True)[:EFFECTS_SHOWN]
    seen = {row[:2] for row in rows}
    abouts = zip(map(found.number, range(len(found.poles))), found.natural_frequencies.tolist(), strict=True)
    others = {text for about, text in zip(abouts, found.words(), strict=True) if about not in seen}
    notes = [note for note in table.notes if note not in others]
    rest = f"the {EFFECTS_SHOWN} largest of {len(table.rows)} effects; --mode and --parameter choose, --full prints all"
    return replace(table, rows=tuple(rows), notes=(*notes, rest))


command = click_command("sensitivity", SensitivityCommand)
