"""Percentile bands, an answer of a study, the percentiles of a curve over frequency or speed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import Fault
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import (
    QUANTITY,
    AskedStudy,
    PlainConclusion,
    StudyAnswer,
    VariantValues,
    case_label,
    measure_of,
    register_answer,
)
from torsionnet.study.quantities.quantity import QuantityForm

DEFAULT_PERCENTILES = (2.5, 25.0, 50.0, 75.0, 97.5)
"""Percentiles of a curve that are drawn unless others are asked for, the median and the middle half and 95 %."""


@register_answer
@dataclass(frozen=True, kw_only=True)
class PercentileBands(StudyAnswer):
    """Percentiles of a curve over the variants, at each of its frequencies or speeds, in each configuration."""

    kind: ClassVar[str] = "percentile_bands"
    naming: ClassVar[Mapping[str, str]] = {"quantity": QUANTITY}

    quantity: str = entry(Text("quantity that is a curve"))
    percentiles: tuple[float, ...] = entry(
        Listed("per cent of the variants that are not above a line; default: 2.5, 25, 50, 75, 97.5",
               Value("per cent", "1", below=100.001)), None,
    )  # fmt: skip

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        if self.quantity in study.quantities and not measure_of(study, self.quantity).is_curve:
            yield Fault(f"{self.quantity} is a single number and no curve", ("quantity",), kind="not-applicable")

    def conclude(self, study: AskedStudy, result: VariantValues) -> PercentileBandsResult:
        shares = tuple(sorted(self.percentiles or DEFAULT_PERCENTILES))
        lines = {case_label(case): result.percentiles(self.quantity, shares, case) for case in study.configurations}
        return PercentileBandsResult(study.title, self.quantity, measure_of(study, self.quantity), shares, lines)


@dataclass(frozen=True, eq=False, repr=False)
class PercentileBandsResult(PlainConclusion):
    """Percentiles of a curve in SI by configuration, each (n_percentiles, n_points), rising."""

    drawing: ClassVar[str] = "torsionnet.plot.study.distributions:percentile_bands"

    title: str
    quantity: str
    measure: QuantityForm
    percentiles: tuple[float, ...]
    lines: Mapping[str, FloatArray]

    @property
    def sentences(self) -> tuple[str, ...]:
        return tuple(self._widest(case, lines) for case, lines in self.lines.items())

    def _widest(self, case: str, lines: FloatArray) -> str:
        width = lines[-1] - lines[0]
        place = int(width.argmax())
        span = f"{lines[0, place]:.4g} to {lines[-1, place]:.4g} {self.measure.unit}".rstrip()
        at = f"{self.measure.points[place]:.4g} {self.points_unit}"
        shares = f"{self.percentiles[0]:g} to {self.percentiles[-1]:g} %"
        return f"{self.quantity}, {case}: spreads most at {at}, {span} ({shares})"

    @property
    def points_unit(self) -> str:
        """Unit of the axis of the curve, Hz for frequencies and rad/s for speeds."""
        return "Hz" if self.measure.over == "frequency" else "rad/s"

    def table(self) -> Table:
        columns = (
            Column("configuration"), Column(self.measure.over, self.points_unit),
            *(Column(f"{share:g} %", self.measure.unit) for share in self.percentiles),
        )  # fmt: skip
        rows = tuple(
            (case, float(point), *map(float, lines[:, place]))
            for case, lines in self.lines.items()
            for place, point in enumerate(self.measure.points)
        )
        return Table.of(self.title, f"percentiles of {self.quantity}", columns, rows, self.sentences)
