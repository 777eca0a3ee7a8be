"""Commands on a linear drivetrain: ``modes``, ``margins``, ``sensitivity`` and ``frf``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import TABLE, Answer, ConfiguredCase, ModelCommand, separated_by_lines
from torsionnet.app.cli.options import (
    ANGLE,
    DRIVEN_BY,
    FREQUENCY_UNIT,
    REFERRED_TO,
    band_option,
    option,
    referred_outputs,
)
from torsionnet.app.cli.terminal import blank_zero_shares, message
from torsionnet.base.errors import UsageError

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.linear.frequency_response import FloatArray, FrequencyResponse
    from torsionnet.linear.modes.modes import Modes
    from torsionnet.linear.responses.grid import Solver
    from torsionnet.linear.sensitivity.sensitivities_of_modes import ModeSensitivities


# Command ``torsionnet modes``, which prints natural frequencies, damping ratios and shapes.

EIGENVALUES = ("Re lambda", "Im lambda")


class ModesCommand(ModelCommand):
    """Complex modes: natural frequencies |lambda|/2pi, damping ratios, descriptions.

    The eigenvalues, shapes and energy shares are all in --json; --csv has the eigenvalues.

    \b
    torsionnet modes amt_rig -c all --energies
    torsionnet modes amt_rig -c V --shapes --plot shapes.png
    torsionnet modes dmf_rig --measured-input T_T
    """

    forms = TABLE
    picture = "the mode shapes"

    measured_input: str | None = option(
        "--measured-input",
        metavar="SENSOR",
        help="The poles of responses against this sensor: those of the cut system.",
    )
    driven_by: str | None = DRIVEN_BY
    lowest: int | None = option(
        "--lowest",
        type=click.IntRange(min=1),
        metavar="N",
        help="Only the N lowest vibrations, with rigid bodies and real poles below them; default: all modes, or 20 "
        "with continuous shafts.",
    )
    up_to: float | None = option(
        "--up-to",
        type=click.FloatRange(min=0, min_open=True),
        metavar="HZ",
        help="Only modes up to this natural frequency in Hz; with continuous shafts all of these.",
    )
    shapes: bool = option("--shapes", help="Also the mode shapes, at every node.")
    referred_to: str | None = option(
        "--referred-to", metavar="NODE", help="Shapes with all angles referred to the shaft of this node."
    )
    energies: bool = option("--energies", help="Also the share of every element in the energies.")
    frequency_unit: str = FREQUENCY_UNIT

    def answer(self) -> Answer:
        cases = self.cases()
        from torsionnet.base.conventions import Conventions

        conventions = Conventions(frequency=self.frequency_unit)
        modes_by_case = self.each(
            "modes",
            cases,
            self._modes,
        )
        results = [self._referred(case, modes) for case, modes in zip(cases, modes_by_case, strict=True)]
        tables = [modes.table(conventions) for modes in results]
        pairs = list(zip(cases, results, strict=True))
        return Answer(
            screen=lambda: separated_by_lines(
                part for pair in zip(results, tables, strict=True) for part in self.parts(*pair)
            ),
            data=lambda: [case.data(modes) for case, modes in pairs],
            csv=lambda: [("", self.combined_table(cases, tables))],
            # overlaid the shapes of several configurations could not be told apart
            figures=lambda plot: [
                (
                    case.configuration,
                    plot.mode_shapes(modes, case.drivetrain, referred_to=self.referred_to, conventions=conventions),
                )
                for case, modes in zip(cases, modes_by_case, strict=True)
            ],
        )

    def _modes(self, case: ConfiguredCase) -> Modes:
        """Modes of a case, with as many vibrations as are asked for, if it has them."""
        from torsionnet.linear.modes.modes import OSCILLATORY

        asked = self.lowest
        while True:
            modes = case.drivetrain.modes(
                measured_input=self.measured_input, driven_by=self.driven_by, lowest=asked, up_to=self.up_to
            )
            # Rigid bodies and real poles are among the modes, and not among the vibrations that are counted.
            missing = (self.lowest or 0) - modes.kinds.count(OSCILLATORY)
            if asked is None or missing <= 0 or len(modes) < asked:
                return modes
            asked += missing

    def _referred(self, case: ConfiguredCase, modes: Modes) -> Modes:
        """Modes of a case with shapes referred to the shaft asked for."""
        if self.referred_to is None:
            return modes
        from torsionnet.linear.modes.mode_pairs import referred_shapes

        return referred_shapes(case.drivetrain, modes, self.referred_to)

    def parts(self, modes: Modes, table: Table) -> Iterator[Table]:
        """Tables of the modes of one configuration for the screen, with shapes and energy shares if asked for."""
        from torsionnet.base.table import split_table

        yield without_eigenvalues(table)
        if self.shapes:
            yield from split_table(self.output.with_digits(modes.shape_table()), 2)
        if self.energies:
            yield from split_table(self.output.with_digits(blank_zero_shares(modes.energy_table())), 3)


def without_eigenvalues(table: Table) -> Table:
    """Copy of the table of modes without the columns of eigenvalues, which only files have."""
    return table.chosen([index for index, column in enumerate(table.columns) if column.name not in EIGENVALUES])


# Command ``torsionnet margins``, which prints the stability margins of the loop opened at a controller.

if TYPE_CHECKING:
    pass


class MarginsCommand(ModelCommand):
    """Stability margins of the loop opened at a controller: gain, phase, delay, and the distance from -1.

    All other loops are closed. --plot draws Nyquist's plot.

    \b
    torsionnet margins plant.yaml --plot nyquist.png
    """

    forms = TABLE
    picture = "Nyquist's plot"

    controller: str | None = option("--controller", metavar="NAME", help="The controller.  [default: the only one]")

    def answer(self) -> Answer:
        cases = self.cases()
        margins_of_cases = self.each("margins", cases, lambda case: case.drivetrain.loop_margins(self.controller))
        tables = [case_margins.table() for case_margins in margins_of_cases]
        pairs = list(zip(cases, margins_of_cases, strict=True))
        return Answer(
            screen=lambda: separated_by_lines(tables),
            data=lambda: [case.data(margins) for case, margins in pairs],
            csv=lambda: [("", self.combined_table(cases, tables))],
            figures=lambda plot: [(case.configuration, plot.nyquist(case_margins)) for case, case_margins in pairs],
        )


# Command ``torsionnet sensitivity``, which derives natural frequencies and damping ratios by the parameters.

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
    driven_by: str | None = DRIVEN_BY
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
                driven_by=self.driven_by,
            ),
        )
        _require(self.modes, results)
        tables = [_chosen(sensitivities, self.modes) for sensitivities in results]
        every = self.full or self.modes or self.parameters
        short = tables if every else [_largest(*sensitivities) for sensitivities in zip(results, tables, strict=True)]
        pairs = list(zip(cases, results, strict=True))
        return Answer(
            screen=lambda: [self.combined_table(cases, short)],
            data=lambda: [_chosen_data(case.data(effects), self.modes) for case, effects in pairs],
            csv=lambda: [("", self.combined_table(cases, tables))],
            figures=lambda plot: [
                (case.configuration, plot.tornado(sensitivities, mode=list(self.modes) or None))
                for case, sensitivities in pairs
            ],
        )


def _require(modes: tuple[int, ...], results: list[ModeSensitivities]) -> None:
    every = {sensitivities.number(mode) for sensitivities in results for mode in range(len(sensitivities.poles))}
    known = sorted(number for number in every if number is not None)
    for mode in modes:
        if mode not in known:
            raise UsageError(
                f"there is no mode {mode}; the model has the modes {', '.join(map(str, known)) or '(none)'}",
                kind="unknown-mode",
            )


def _chosen(sensitivities: ModeSensitivities, modes: tuple[int, ...]) -> Table:
    """Table of the effects of parameters on the modes chosen, without effects that are rounding errors.

    None chosen: all modes.
    """
    table = sensitivities.table()
    rows = tuple(
        row
        for row in table.rows
        if (not modes or row[0] in modes) and max(abs(row[4]), abs(row[5])) > NEGLIGIBLE_EFFECT
    )
    words, rest = table.notes[: len(sensitivities.poles)], table.notes[len(sensitivities.poles) :]
    notes = (*(note for index, note in enumerate(words) if not modes or sensitivities.number(index) in modes), *rest)
    return replace(table, rows=rows, notes=notes)


def _chosen_data(data: dict[str, Any], modes: tuple[int, ...]) -> dict[str, Any]:
    """JSON data of sensitivities of the modes chosen alone, or of all."""
    chosen = [entry for entry in data["modes"] if entry["mode"] in modes]
    return {**data, "modes": chosen or data["modes"]}


def _largest(sensitivities: ModeSensitivities, table: Table) -> Table:
    """Table of the effects that change an eigenvalue most relative to its size, without the words on other modes."""
    if len(table.rows) <= EFFECTS_SHOWN:
        return table
    rows = sorted(table.rows, key=lambda row: math.hypot(row[4], row[2] * row[5]), reverse=True)[:EFFECTS_SHOWN]
    seen = {row[:2] for row in rows}
    abouts = zip(
        map(sensitivities.number, range(len(sensitivities.poles))),
        sensitivities.natural_frequencies.tolist(),
        strict=True,
    )
    others = {text for about, text in zip(abouts, sensitivities.words(), strict=True) if about not in seen}
    notes = [note for note in table.notes if note not in others]
    rest = f"the {EFFECTS_SHOWN} largest of {len(table.rows)} effects; --mode and --parameter choose, --full prints all"
    return replace(table, rows=tuple(rows), notes=(*notes, rest))


# Command ``torsionnet frf``, which calculates frequency responses.

QUANTITIES = ("receptance", "mobility", "accelerance", "dynamic_stiffness")


class FrfCommand(ModelCommand):
    """Frequency responses: static value and peaks on the screen, every frequency in files.

    \b
    torsionnet frf dmf_rig --output theta_1 --input T_T --angle-unit deg --plot bode.png
    torsionnet frf amt_rig -c all --output theta_1 --input T_M --band 0.3 40 --csv gears.csv
    """

    forms = TABLE
    picture = "a Bode plot"

    outputs: tuple[str, ...] = option(
        "--output",
        metavar="NAME",
        required=True,
        help='Sensor or node, or "torque(gearbox, output_shaft)". Repeatable.',
    )
    inputs: tuple[str, ...] = option(
        "--input",
        metavar="NAME",
        required=True,
        help="Input or node (a torque there), or a sensor: a measured input. Repeatable.",
    )
    driven_by: tuple[str, ...] = option(
        "--driven-by",
        metavar="INPUT",
        help="What drives the drivetrain while the input is measured, if it has several inputs.",
    )
    band: tuple[float, float] | None = band_option("Frequencies, in the unit chosen.  [default: from the modes]")
    points: int | None = option(
        "--points", type=click.IntRange(2, 1_000_000), help="How many frequencies.  [default: 500]"
    )
    logarithmic: bool | None = option(
        "--log/--linear", default=None, help="Spacing; default: logarithmic over more than a decade."
    )
    listed: str | None = option(
        "--frequencies", metavar="LIST", help='"0.1:40:0.1" (start:stop:step) or "1,2,5" instead.'
    )
    frequency_unit: str = FREQUENCY_UNIT
    referred_to: str | None = REFERRED_TO
    kind: str | None = option("--kind", type=click.Choice(QUANTITIES), help="Default: as the sensor measures.")
    angle: str = ANGLE
    decibels: bool = option("--db", help="Magnitudes in dB re 1 of their unit.")
    full: bool = option("--full", help="Print every frequency instead of static value and peaks.")

    def answer(self) -> Answer:
        cases = self.cases()
        from torsionnet.app.cli.frf_output import (
            OF_ESTIMATES,
            DisplayUnits,
            Sampling,
            full_table,
            peak_table,
            solved_curves,
        )
        from torsionnet.base.conventions import Conventions

        shown = DisplayUnits(Conventions(angle=self.angle, frequency=self.frequency_unit), self.decibels)
        sampling = Sampling(self.band, self.points, self.logarithmic, self.listed)
        frequencies = sampling.frequencies(cases, shown.conventions.frequency_scale)
        cases, solvers, responses = _answered(self, cases, frequencies)
        trios = list(zip(cases, responses, solvers, strict=True))

        def full() -> list[Table]:
            return [full_table(response, shown) for response in responses]

        def brief() -> list[Table]:
            return [peak_table(response, solve, shown) for _, response, solve in trios]

        return Answer(
            screen=lambda: [self.combined_table(cases, full() if self.full else brief())],
            data=lambda: [
                case.data(solved_curves(response, solve, shown.conventions), OF_ESTIMATES)
                for case, response, solve in trios
            ],
            csv=lambda: [("", self.combined_table(cases, full()))],
            figures=lambda plot: [("", plot.bode(responses, conventions=shown.conventions, decibels=self.decibels))],
        )

    def solver(self, case: ConfiguredCase) -> Solver:
        def solve(frequencies: FloatArray) -> FrequencyResponse:
            response = case.drivetrain.frequency_response(
                referred_outputs(self.outputs, self.referred_to),
                list(self.inputs),
                frequencies,
                driven_by=list(self.driven_by) or None,
            )
            return getattr(response, self.kind)() if self.kind else response

        return solve


def _answered(
    request: FrfCommand, cases: list[ConfiguredCase], frequencies: FloatArray
) -> tuple[list[ConfiguredCase], list[Solver], list[FrequencyResponse]]:
    """Cases that have the outputs and inputs asked for, functions that solve them, and their frequency responses.

    Notes name the cases left out.
    """
    answered: list[tuple[ConfiguredCase, Solver, FrequencyResponse]] = []
    refusals: dict[str, UsageError] = {}
    for case in cases:
        solve = request.solver(case)
        try:
            answered.append((case, solve, solve(frequencies)))
        except UsageError as error:
            refusals[case.configuration] = error
    if not answered:
        raise next(iter(refusals.values()))
    for name, refusal in refusals.items():
        message("note", f"configuration {name} is left out: {refusal}")
    left, solvers, responses = zip(*answered, strict=True)
    return list(left), list(solvers), list(responses)
