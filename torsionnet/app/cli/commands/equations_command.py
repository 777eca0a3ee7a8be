"""Command ``torsionnet equations``, which prints equations of motion or transfer functions in symbols.

Also texts and tables of equations and matrices for ``torsionnet show``.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import JSON, Answer, ConfiguredCase, ModelCommand
from torsionnet.app.cli.options import SIMPLIFY, EntryOption, WrongUsage, band_option, option
from torsionnet.app.cli.output import (
    EquationsOfMotion,
    WrittenTransferFunction,
    dependent_angles,
    equations_of_motion,
    matrix_rows,
)
from torsionnet.base.table import Column, Table

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.model.channels import Pair
    from torsionnet.symbolic.simplified import Simplified
    from torsionnet.symbolic.transfer_function import TransferFunction

MATRICES = (
    ("M", "kg*m^2", "Inertia matrix"),
    ("C", "N*m*s/rad", "Damping matrix"),
    ("K", "N*m/rad", "Stiffness matrix"),
)
EQUATION_WIDTH = 100
"""Characters of a line after which an equation goes on in the next line, as terminals are about as wide."""
FORMS = ("mechanical", "polynomial", "normalised", "program", "expanded", "python")


class EquationsCommand(ModelCommand):
    """Equations of motion, or transfer functions, in the model's own symbols.

    \b
    torsionnet equations amt_rig -c V
    torsionnet equations dmf_rig --tf theta_1/T_T --form normalised
    torsionnet equations dmf_rig --tf theta_1/T_M --simplify 1% --band 0.5 20 --latex
    """

    forms = JSON

    pairs: tuple[Any, ...] = option(
        "--tf",
        type=EntryOption("OUTPUT/INPUT", "model.channels:PAIR"),
        help='A transfer function, "theta_1/T_T". Repeatable.',
    )
    form: str | None = option("--form", type=click.Choice(FORMS), help="How it is written.  [default: mechanical]")
    simplify: float | None = SIMPLIFY
    band: tuple[float, float] | None = band_option("The band of --simplify in Hz.  [default: around the lowest mode]")
    latex: bool = option("--latex", help="As LaTeX.")

    def answer(self) -> Answer:
        self._refuse_what_would_be_ignored()
        cases = self.cases()
        return Answer(
            screen=lambda: self._parts(cases),
            data=lambda: [case.data(equations) for case in cases for equations in self._results(case)],
        )

    def _refuse_what_would_be_ignored(self) -> None:
        for name, given in (("--form", self.form), ("--simplify", self.simplify)):
            if given is not None and not self.pairs:
                raise WrongUsage(
                    f"{name} is about a transfer function; say which by --tf OUTPUT/INPUT", kind="missing-entry"
                )
        if self.band is not None and self.simplify is None:
            raise WrongUsage(
                "--band has no effect without --simplify; write --simplify 1% --band 0.5 20, or leave it out",
                kind="needless-entry",
            )
        if self.latex and self.form == "python":
            raise WrongUsage(
                "--latex and --form python are two ways of writing; choose one", kind="contradicting-entries"
            )

    def _parts(self, cases: list[ConfiguredCase]) -> Iterator[str]:
        for number, case in enumerate(cases):
            yield from [""] if number else []
            if not self.pairs:
                yield case.drivetrain.symbolic().to_latex() if self.latex else equations_text(case.drivetrain)
            for place, pair in enumerate(self.pairs):
                yield from [""] if place else []
                function, short = self._functions(case.drivetrain, pair)
                # What is not the expression is a comment, so that the whole can be pasted.
                mark = "% " if self.latex else "# " if self.form == "python" else ""
                yield f"{mark}{case.drivetrain.title}: {pair}"
                if short is not None:
                    low, high = short.band
                    yield f"{mark}left out: {'; '.join(short.changes) or 'nothing'}"
                    yield f"{mark}error {low:g} to {high:g} Hz: {short.errors}"
                yield self._written(function)

    def _results(self, case: ConfiguredCase) -> Iterator[EquationsOfMotion | WrittenTransferFunction]:
        if not self.pairs:
            yield equations_of_motion(case.drivetrain)
        for pair in self.pairs:
            function, short = self._functions(case.drivetrain, pair)
            more = (short.changes, short.band, short.errors) if short is not None else ()
            yield WrittenTransferFunction(str(pair), self._written(function), *more)

    def _functions(self, rig: Drivetrain, pair: Pair) -> tuple[TransferFunction, Simplified | None]:
        symbolic = rig.symbolic()
        names = (pair.output, pair.input, pair.excitation or None)
        if self.simplify is None:
            return symbolic.transfer_function(*names), None
        short = symbolic.simplified(*names, tolerance=self.simplify, band=self.band)
        return short.transfer_function, short

    def _written(self, function: TransferFunction) -> str:
        form = self.form or "mechanical"
        return function.to_latex(form) if self.latex else function.to_text(form)


def equations_text(rig: Drivetrain) -> str:
    """Text of a drivetrain's equations of motion, of the angles of dependent nodes, and of terms taken to be zero."""
    from torsionnet.symbolic.formula_text import for_display

    system = rig.symbolic()
    lines = [f"{rig.title}: equations of motion (' is d/dt)"]
    for name, equation in zip(system.coordinates, system.equations(), strict=True):
        lines += [f"{name}:", *_folded(equation)]
    for action, law in zip(system.actions, system.laws(), strict=True):
        lines += [f"{action.owner}:", *_folded(law)]
    others = [f"theta_{node} = {text}" for node, text in dependent_angles(system).items()]
    others += [f"{name} = {for_display(formula)}" for name, formula in system.formulas.items()]
    lines += ["where", *(f"    {text}" for text in others)] if others else []
    if system.conditions:
        lines += ["taking the values into account:", *(f"    {condition} = 0" for condition in system.conditions)]
    return "\n".join(lines)


def _folded(equation: str) -> list[str]:
    """Lines of an equation as texts, broken between terms and indented."""
    lines = [" " * 4]
    for term in _terms(equation):
        if len(lines[-1]) + len(term) >= EQUATION_WIDTH:
            lines.append(" " * 8)
        lines[-1] += term if lines[-1].isspace() else f" {term}"
    return lines


def _terms(equation: str) -> list[str]:
    """Terms of an equation as texts, split before every sign or = outside parentheses."""
    terms: list[str] = []
    depth = 0
    for word in equation.split(" "):
        if not terms or (depth == 0 and word in ("+", "-", "=")):
            terms.append(word)
        else:
            terms[-1] += f" {word}"
        depth += word.count("(") - word.count(")")
    return terms


def matrix_tables(rig: Drivetrain) -> list[Table]:
    """Tables of a drivetrain's matrices M, C and K in SI units, with a row and a column for each coordinate."""
    coordinates = rig.assembly.kinematics.coordinates
    columns = (Column(""), *(Column(name) for name in coordinates))
    notes: tuple[str, ...] = ("frequency-dependent stiffness is not included",) if rig.assembly.system.dynamic else ()
    notes += ("torques of controllers are not included",) if rig.assembly.system.actions else ()
    return [
        Table(
            f"{rig.title}: {title} {symbol} [{unit}]",
            columns,
            tuple((name, *row) for name, row in zip(coordinates, matrix_rows(rig, symbol), strict=True)),
            notes,
        )
        for symbol, unit, title in MATRICES
    ]
