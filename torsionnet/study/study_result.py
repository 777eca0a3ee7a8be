"""Result of a study, the values, statistics and percentiles of every quantity in every configuration."""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.atomic import atomic_replacement
from torsionnet.base.entries.spec import Json
from torsionnet.base.errors import MissingExtraError, UsageError, did_you_mean
from torsionnet.base.packages import NotebookResult
from torsionnet.base.result_fields import to_json
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.base.version import __version__
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.study.answers.answer import AskedStudy
from torsionnet.study.reductions.summaries import ACCURACY, KeptValues, QuantityStatistics, Summary
from torsionnet.study.study import Study

if TYPE_CHECKING:
    from torsionnet.study.reductions.limit_counts import LimitTotals

# Conversion of a study's result to labelled arrays of xarray.

Cases = Mapping[tuple[str, str], FloatArray]


def labelled_variants(
    summaries: Mapping[tuple[str, str], Summary],
    values: Cases,
    bands: Cases,
    percentiles: tuple[float, ...],
    parameters: Mapping[str, Mapping[str, FloatArray]],
    attributes: Mapping[str, Any],
) -> Any:
    """Build an ``xarray.Dataset``, numbers over configuration and variant, curves over configuration and percentile.

    Parameters
    ----------
    summaries, values, bands : mapping
        By configuration and quantity; values (n,) of those numbers that are kept, percentiles (n_shares, n_points) of
        curves.
    percentiles : tuple of float
        Per cent.
    parameters : mapping
        Configuration -> parameter -> (n,) values.
    attributes : mapping
        Attributes of the dataset: title, seed, version, study, model, notes.
    """
    try:
        import xarray as xr
    except ImportError as error:
        raise MissingExtraError('labelled arrays need xarray: pip install "torsionnet[xarray]"') from error
    cases = list(parameters)
    variables: dict[str, Any] = {}
    coordinates: dict[str, Any] = {"configuration": cases, "percentile": list(percentiles)}
    for (case, name), summary in summaries.items():
        if case != cases[0]:
            continue
        unit = {"units": summary.measure.unit}
        if (case, name) in values:
            variables[name] = ("configuration", "variant"), np.stack([values[each, name] for each in cases]), unit
        elif (case, name) in bands:
            axis = f"{summary.measure.over}_of_{name}"
            coordinates[axis] = (
                axis,
                summary.measure.points,
                {"units": "Hz" if summary.measure.over == "frequency" else "rad/s"},
            )
            stacked = np.stack([bands[each, name] for each in cases])
            variables[name] = ("configuration", "percentile", axis), stacked, unit
    for name in parameters[cases[0]]:
        drawn = np.stack([parameters[case][name] for case in cases])
        variables[name] = ("configuration", "variant"), drawn, {"units": "SI"}
    return xr.Dataset(variables, coordinates, dict(attributes))


SHOWN = (2.5, 50.0, 97.5)
"""Percentiles that tables show of each quantity, in per cent, the median and the limits of the middle 95 %."""
CSV_BLOCK_LINES = 20_000
"""Number of CSV lines made into text together, as their text takes a hundred times the memory of their numbers."""


@dataclass(frozen=True, eq=False)
class StudyStatistics:
    """Statistics of all quantities of a study in SI, as they are written to JSON."""

    count: int
    seed: int | None
    model: str
    version: str
    percentiles: tuple[float, ...]
    quantities: tuple[QuantityStatistics, ...]
    notes: tuple[str, ...]
    kept_every: Annotated[int | None, Out(optional=True)]


def read_notes(study: AskedStudy, read: Mapping[str, FloatArray]) -> tuple[str, ...]:
    """Notes on tables over frequency that are read beyond their rows, from the frequencies (2,) by configuration."""
    read_at = {name: at for name, at in read.items() if np.isfinite(at).any()}
    notes = (note for name, at in read_at.items() for note in range_notes(study.model_in(name).assembly, at))
    return tuple(dict.fromkeys(notes))


@dataclass(frozen=True, eq=False, repr=False)
class StudyResult(NotebookResult):
    """Result of a study, the statistics and kept values of every quantity in every configuration.

    Attributes
    ----------
    study : Study
    summaries : mapping
        (configuration, quantity) -> Summary.
    kept : KeptValues
        Values of all variants, or of an even part of very many.
    impossible : mapping
        Configuration -> number of variants whose values the model refuses.
    remarks : mapping
        Configuration -> {text of a warning: how often}.
    folder : Path or None
    beyond : LimitTotals or None
        Variants beyond limits, where the values of a part only are kept.
    read : mapping
        Configuration -> lowest and highest frequency in Hz at which laws over frequency are read, (2,); infinite ones
        where none is.
    """

    study: Study
    summaries: Mapping[tuple[str, str], Summary]
    kept: KeptValues
    impossible: Mapping[str, int]
    remarks: Mapping[str, Mapping[str, int]]
    folder: Path | None = None
    beyond: LimitTotals | None = None
    read: Mapping[str, FloatArray] = field(default_factory=dict)

    def __repr__(self) -> str:
        names = ", ".join(self.study.quantities)
        return f"<StudyResult {self.study.title!r}: {self.study.count} variants, {names}>"

    def _key(self, quantity: str, configuration: str | None) -> tuple[str, str]:
        known = self.study.quantities
        if quantity not in known:
            raise UsageError(
                f'no quantity is named "{quantity}"{did_you_mean(quantity, known)}; known: {", ".join(known)}',
                kind="unknown-name",
            )
        cases = self.study.configurations
        case = cases[0] if configuration is None and len(cases) == 1 else configuration
        if case not in cases:
            kind = "missing-entry" if configuration is None else "unknown-configuration"
            raise UsageError(f"the study is of the configurations {', '.join(cases)}; name one of them", kind=kind)
        return case, quantity

    @property
    def _numbers(self) -> Cases:
        """Kept values (n,) in SI of the quantities of a single point, by configuration and quantity."""
        return {key: self.kept.values[key] for key in self.summaries if self.kept.values[key].ndim == 1}

    def summary(self, quantity: str, configuration: str | None = None) -> Summary:
        """Statistics (mean, deviation, extremes, percentiles) in SI of a quantity in one configuration."""
        return self.summaries[self._key(quantity, configuration)]

    def values(self, quantity: str, configuration: str | None = None) -> FloatArray:
        """Values of a quantity in SI, shape (n,), of all variants of one configuration.

        NaN where a variant has no value.

        Raises
        ------
        UsageError
            The quantity is a curve, or of so many variants only a part is kept.
        """
        key = self._key(quantity, configuration)
        if key not in self._numbers:
            raise UsageError(
                f"{quantity} is a curve; summary() has its mean, extremes and percentiles", kind="not-applicable"
            )
        if self.kept.every > 1:
            raise UsageError(
                f"{quantity} has too many values: those of one in {self.kept.every} variants are kept, which are in "
                "kept_values(); summary() has mean, extremes and percentiles of all",
                kind="too-large",
            )
        return self.kept.values[key]

    def kept_values(self, quantity: str, configuration: str | None = None) -> FloatArray:
        """Values of a quantity in SI of the kept variants, (n,), or smallest and largest value (n, 2) of a curve.

        The variants are those with the indices 0, m, 2 m, ..., where m is ``kept.every``; all where that is 1.
        """
        return self.kept.values[self._key(quantity, configuration)]

    def parameters(self, configuration: str | None = None) -> dict[str, FloatArray]:
        """Values (n,) in SI of every varied parameter, by name, for all variants of one configuration."""
        case, _ = self._key(next(iter(self.study.quantities)), configuration)
        space = self.study.space.at(self.study.model_in(case))
        return space.values(0, space.count)

    def kept_parameters(self, configuration: str | None = None) -> dict[str, FloatArray]:
        """Values (n,) in SI of every varied parameter, by name, for the kept variants of one configuration."""
        if self.kept.every == 1:
            return self.parameters(configuration)
        case, _ = self._key(next(iter(self.study.quantities)), configuration)
        return {name: self.kept.values[case, name] for name in self.study.space.names}

    def percentiles(self, quantity: str, shares: ArrayLike, configuration: str | None = None) -> FloatArray:
        """Percentiles (n_shares, n_points) in SI of a quantity at shares in per cent.

        Exact where all values are kept.
        """
        key = self._key(quantity, configuration)
        values = self._numbers.get(key, np.empty(0))
        if self.kept.every == 1 and np.isfinite(values).any():
            return np.asarray(np.percentile(values[np.isfinite(values)], np.asarray(shares), method="inverted_cdf"))[
                :, None
            ]
        return self.summaries[key].percentiles(shares)

    def model(self, variant: int, configuration: str | None = None) -> Drivetrain:
        """Drivetrain with the parameter values of variant ``variant`` in one configuration."""
        case, _ = self._key(next(iter(self.study.quantities)), configuration)
        model = self.study.model_in(case)
        values = self.study.space.at(model).values(variant, variant + 1)
        return model.configured(**{name: float(column[0]) for name, column in values.items()})

    def table(self) -> Table:
        """Table of the statistics of every quantity that is a number, a line for each quantity and configuration."""
        columns = [Column("quantity"), Column("configuration"), Column("unit"), Column("variants"), Column("mean")]
        columns += [Column("standard deviation"), Column("smallest")]
        columns += [Column(f"{share:g} %") for share in SHOWN] + [Column("largest"), Column("largest at variant")]
        rows = []
        for (case, name), summary in self.summaries.items():
            if summary.measure.is_curve:
                continue
            m = summary.moments
            shares = self.percentiles(name, SHOWN, case)[:, 0]
            numbers = [
                float(m.mean[0]),
                float(m.deviation[0]),
                float(m.smallest[0]),
                *map(float, shares),
                float(m.largest[0]),
            ]
            known = [number if np.isfinite(number) else None for number in numbers]
            rows.append((name, case, summary.measure.unit, int(m.count[0]), *known, int(m.largest_at[0])))
        chosen = [n for n in range(len(columns)) if n != 1 or any(row[1] for row in rows)]
        return Table(self.study.title, tuple(columns), tuple(rows), self.notes).chosen(chosen)

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the result as a tuple of texts, on numbers of variants, missing values, accuracy and warnings."""
        texts = [f"{self.study.count} variants; seed {self.study.seed}"] if self.study.seed is not None else []
        count = sum(self.impossible.values())
        if count:
            texts.append(f"{count} of {self.study.count} variants are no drivetrains and have no values")
        texts += self._missing()
        if self.kept.every > 1 or not self._numbers:
            texts.append(f"percentiles are within {ACCURACY:.1%} of themselves")
        if self.kept.every > 1:
            texts.append(f"values of single variants are kept of {self.kept.words(self.study.count)}")
        texts += read_notes(self.study, self.read)
        total: Counter[str] = Counter()
        for remarks in self.remarks.values():
            total.update(remarks)
        return (*texts, *(f"{text} ({count} variants)" for text, count in total.most_common()))

    def _missing(self) -> list[str]:
        """Notes on quantities without a finite value in some variants that the model accepts."""
        lacking: Counter[str] = Counter()
        for (case, name), summary in self.summaries.items():
            lacking[name] += self.study.space.count - self.impossible.get(case, 0) - int(summary.moments.count.max())
        return [
            f"{name} has no finite value in {count} of {self.study.count} variants"
            for name, count in lacking.items()
            if count
        ]

    def record(self) -> StudyStatistics:
        """Statistics of the study in full precision for JSON, without the values of single variants."""
        every, study = self.kept.every, self.study
        rows = tuple(
            own.row(name, case, self.percentiles(name, SHOWN, case)) for (case, name), own in self.summaries.items()
        )
        return StudyStatistics(
            study.count, study.seed, study.model.title, __version__, SHOWN, rows, self.notes,
            None if every == 1 else every,
        )  # fmt: skip

    def to_data(self) -> dict[str, Json]:
        """Statistics of the study as JSON data in full precision, without the values of single variants."""
        data: dict[str, Json] = to_json(self.record())
        return data

    def columns(self) -> dict[str, NDArray[Any]]:
        """Columns of the table of kept variants by name, configuration, parameters and quantities, each (n,) in SI.

        Where these are not all, ``variant`` has the index of each in its configuration.
        """
        cases, every = self.study.configurations, self.kept.every
        indices = np.arange(0, self.study.space.count, every)
        columns: dict[str, NDArray[Any]] = {}
        if any(cases):
            columns["configuration"] = np.repeat(np.array(cases), len(indices))
        if every > 1:
            columns["variant"] = np.tile(indices, len(cases))
        drawn = [self.kept_parameters(case) for case in cases]
        columns |= {name: np.concatenate([values[name] for values in drawn]) for name in self.study.space.names}
        numbers = [name for name in self.study.quantities if not self.summaries[cases[0], name].measure.is_curve]
        return columns | {name: np.concatenate([self.kept_values(name, case) for case in cases]) for name in numbers}

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write a CSV file with a line for every kept variant, in SI and full precision."""
        columns = self.columns()
        headings = tuple(Column(name, self._unit(name)) for name in columns)
        above = len(self.notes) + 2  # lines: the title, and the headings
        with atomic_replacement(path) as file, file.open("w", encoding="utf-8", newline="") as stream:
            for start in range(0, len(next(iter(columns.values()))), CSV_BLOCK_LINES):
                block = (column[start : start + CSV_BLOCK_LINES].tolist() for column in columns.values())
                text = Table(self.study.title, headings, tuple(zip(*block, strict=True)), self.notes).to_csv()
                stream.write(text if start == 0 else text.split("\n", above)[above])

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Write a Parquet file with a line for every kept variant, in SI, with model, seed and version as metadata."""
        try:
            import pyarrow as pa
            import pyarrow.parquet as pq
        except ImportError as error:
            raise MissingExtraError('Parquet needs pyarrow: pip install "torsionnet[parquet]"') from error
        table = pa.table(self.columns()).replace_schema_metadata(
            {"torsionnet": json.dumps(self._about, ensure_ascii=False)}
        )
        with atomic_replacement(path) as file:
            pq.write_table(table, file)

    def to_xarray(self) -> Any:
        """Result as an ``xarray.Dataset`` in SI, numbers over configuration and variant, curves as percentiles."""
        curves = [key for key, summary in self.summaries.items() if summary.measure.is_curve]
        bands = {(case, name): self.percentiles(name, SHOWN, case) for case, name in curves}
        parameters = {case: self.kept_parameters(case) for case in self.study.configurations}
        dataset = labelled_variants(self.summaries, self._numbers, bands, SHOWN, parameters, self._about)
        indices = np.arange(0, self.study.space.count, self.kept.every)
        return dataset if self.kept.every == 1 else dataset.assign_coords(variant=indices)

    @property
    def _about(self) -> dict[str, Any]:
        """Metadata of exported files by key, title, seed, version, study, model and notes."""
        seed, study = self.study.seed, json.dumps(self.study.to_data(), ensure_ascii=False)
        about: dict[str, Any] = {"title": self.study.title, "seed": -1 if seed is None else seed}
        return about | {
            "version": __version__,
            "study": study,
            "model": self.study.model_text,
            "notes": list(self.notes),
        }

    def _unit(self, name: str) -> str:
        key = (self.study.configurations[0], name)
        return self.summaries[key].measure.unit if key in self.summaries else ""
