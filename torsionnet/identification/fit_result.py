"""Values of a fit with standard errors and intervals, and the curves of test and model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.packages import NotebookResult
from torsionnet.base.table import Column, Table
from torsionnet.drivetrain import Drivetrain
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.lack_of_fit import LackOfFit
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray


@dataclass(frozen=True, eq=False)
class Compared:
    """Frequency responses or orders (n,) of test and fitted model for one measurement, by the same estimator, SI.

    Attributes
    ----------
    name : str
    frequencies : (n,) array
        Hz.
    measured, fitted : (n,) complex array
        SI.
    deviation : (n,) array
        Standard deviation of each line by its noise, SI.
    misfit : float
        RMS of the weighted residuals: 1 where the model explains all but noise.
    unit : str
    has_phase : bool
        Whether the test has a phase; without, its values are magnitudes.
    orders, speeds : (n,) array, optional
        Of a measurement of orders: the order of each line and the speed of the reference shaft, rad/s.
    """

    name: str
    frequencies: FloatArray
    measured: ComplexArray
    fitted: ComplexArray
    deviation: FloatArray
    misfit: float
    unit: str
    has_phase: bool = True
    orders: FloatArray | None = None
    speeds: FloatArray | None = None


@dataclass(frozen=True, eq=False, repr=False)
class FitResult(NotebookResult):
    """Result of a fit as written to a file, with values and standard errors; fields as in :class:`torsionnet.Fit`."""

    picture: ClassVar[str] = "fit"

    values: Mapping[str, float]
    standard_errors: Mapping[str, float]
    correlation: FloatArray
    chi_squared: float
    degrees_of_freedom: int
    comparisons: tuple[Compared, ...]
    verdicts: tuple[str, ...]
    notes: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)
    title: str = ""
    steps: Mapping[str, tuple[tuple[float, ...], ...]] = field(default_factory=dict)
    lack_of_fit: LackOfFit | None = None
    problem: FitProblem | None = field(default=None, repr=False)
    loss: str = "linear"

    def intervals(self, level: float = 0.95) -> dict[str, tuple[float, float]]:
        """Confidence interval (lower, upper) of each fitted value in SI by name, sensor steps included."""
        from torsionnet.identification.interval_width import interval_half_width

        if not 0 < level < 1:
            raise UsageError(f"the confidence level is a number between 0 and 1, such as 0.95, got {level}")
        freedom, found = max(self.degrees_of_freedom, 1), {}
        for name, value in self.values.items():
            half = interval_half_width(level, self.standard_errors[name], self.steps.get(name, ()), freedom)
            found[name] = (value - half, value + half)
        return found

    def configured(self, model: Drivetrain) -> Drivetrain:
        """Copy of the model with the fitted values of the parameters that all configurations share.

        Values fitted per configuration are in ``values`` only. Numbers of excitations are entries of the model, which
        it has in every configuration that does not change them.
        """
        from torsionnet.identification.orders.parametric_orders import numbers_of_excitations

        shared = {name: value for name, value in self.values.items() if name in model.parameter_definitions}
        numbers = numbers_of_excitations(model, [name for name in self.values if "." in name and "[" not in name])
        if numbers:
            model = model.with_excitation_numbers({name: self.values[name] for name in numbers})
        return model.configured(**shared)

    @property
    def aicc(self) -> float:
        """Corrected Akaike criterion (AICc) of the fit; lower is better among fits with the same noise."""
        k, n = len(self.values), self.degrees_of_freedom + len(self.values)
        return self.chi_squared + 2 * k + 2 * k * (k + 1) / max(n - k - 1, 1)

    def table(self, level: float = 0.95, true: Mapping[str, float] | None = None) -> Table:
        """Table of fitted values with standard errors and intervals, and ``true`` values where they are known."""
        intervals = self.intervals(level)
        columns = [Column("parameter"), Column("value"), Column("standard error", "", 2)]
        columns += [Column(f"{100 * level:g} % from"), Column("to"), Column("unit")]
        columns += [Column("true"), Column("inside")] if true is not None else []
        rows = []
        for name, value in self.values.items():
            row = [name, value, self.standard_errors[name], *intervals[name], self.units.get(name, "")]
            if true is not None:
                known = true.get(name)
                low, high = intervals[name]
                row += [known, "" if known is None or np.isinf(low) else "yes" if low <= known <= high else "no"]
            rows.append(tuple(row))
        return Table(self.title, tuple(columns), tuple(rows), (*self.verdicts, *self.notes))

    def __repr__(self) -> str:
        shown = ", ".join(f"{name} = {value:.4g}" for name, value in self.values.items())
        return f"<Fit {shown}>"
