"""Tables of a report on what varies in a study: distributions, values and correlations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from torsionnet.base.number_text import typeset_unit
from torsionnet.report.document_tree import Cell, Heading, NumberText, TableBlock, Text
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import first_names, symbol_or_words, unit
from torsionnet.study.shown_units import ShownUnits
from torsionnet.study.space.variations.nominal import NominalReader, nominals

if TYPE_CHECKING:
    from torsionnet.study.study import Study

SIGNIFICANT_DIGITS = 5
"""Number of significant digits that a report writes of the numbers in a distribution."""
MOST_NAMES = 4
"""Largest number of configurations that a row of a study's table names."""


@dataclass(frozen=True)
class EqualVariation:
    """Variation of a parameter in the configurations in which it varies in the same way; numbers in SI."""

    cases: tuple[str, ...]
    given: float | None
    sizes: dict[str, float]


def varied_parameters(study: Study, units: ShownUnits) -> TableBlock:
    """Table of the parameters that a study varies.

    Unit, value in the model, distribution, and its text in the study.
    """
    alike = {name: list(_by_configuration(study, name)) for name in study.space.names}
    columns = (
        Heading("Parameter"),
        Heading("Configuration"),
        Heading("Unit"),
        Heading("In the model", numeric=True),
        Heading("Distribution"),
        Heading("Numbers", wide=True),
        Heading("As written"),
    )
    rows: list[tuple[Cell, ...]] = []
    for name, variation in study.space.entries.vary.items():
        written = ", ".join(f"{key} {_plain(value)}" for key, value in variation.written_entries().items())
        for one in alike[name]:
            where = first_names(one.cases, MOST_NAMES) if len(alike[name]) > 1 else ""
            given = "" if one.given is None else NumberText(one.given * units.scale(name), SIGNIFICANT_DIGITS)
            numbers = _numbers(one.sizes, units.scale(name))
            rows.append(
                (symbol_or_words(name), where, unit(units.unit(name)), given, variation.words, numbers, written)
            )
    return table("What varies", columns, rows)


def correlations(study: Study) -> Iterator[TableBlock]:
    """Table of a study's correlated parameters and their coefficients of correlation.

    Nothing where none are correlated.
    """
    rows: list[tuple[Cell, ...]] = [
        (_names(one.between), NumberText(one.coefficient)) for one in study.space.entries.correlation
    ]
    if rows:
        columns = (Heading("Parameters"), Heading("Coefficient", numeric=True))
        note = "Linear correlation of the values, of every two where more are named (Gaussian copula)."
        yield table("Correlation of the parameters", columns, rows, [note])


def _names(names: tuple[str, ...]) -> Text:
    first, *others = names
    return (symbol_or_words(first), *(part for name in others for part in (", ", symbol_or_words(name))))


def _by_configuration(study: Study, name: str) -> Iterator[EqualVariation]:
    """Variations of a parameter in a study, configurations with the same value in the model together."""
    found: dict[tuple[float | None, ...], EqualVariation] = {}
    for case in study.configurations:
        nominal = nominals(study.model_in(case), [name])[name]
        sizes = study.space.entries.vary[name].sizes(NominalReader(nominal))
        key = (nominal.value, *sizes.values())
        cases = (*found[key].cases, case) if key in found else (case,)
        found[key] = EqualVariation(cases, nominal.value, sizes)
    yield from found.values()


def _numbers(sizes: Mapping[str, float], scale: float) -> Text:
    """Text of the numbers of a distribution, such as its mean and standard deviation.

    ``mean 0.46, standard deviation 0.018``.
    """
    parts = [
        part for what, size in sizes.items() for part in (f", {what} ", NumberText(size * scale, SIGNIFICANT_DIGITS))
    ]
    return (str(parts[0]).removeprefix(", "), *parts[1:])


def _plain(value: object) -> str:
    if isinstance(value, list):
        return ", ".join(map(_plain, value))
    return typeset_unit(str(value)).replace("-", "−").replace(" %", "\N{NO-BREAK SPACE}%")
