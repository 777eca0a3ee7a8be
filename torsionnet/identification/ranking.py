"""Ranking of the causes of a misfit, each value freed alone, and the choice between several models by AICc."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, ClassVar

import numpy as np

from torsionnet.base.errors import TorsionnetError, UsageError
from torsionnet.base.packages import SavedResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.base.threads import one_thread
from torsionnet.drivetrain import Drivetrain
from torsionnet.identification.causes import (
    CHANNEL_CAUSES,
    CauseFit,
    explaining_fits,
    fit_causes,
    overall_misfit,
    possible_causes,
    starts_of_causes,
    sum_of_squares,
    under_own_noise,
)
from torsionnet.identification.fit import Fit
from torsionnet.identification.fit_problem import FitProblem, make_problem
from torsionnet.identification.fit_result import FitResult
from torsionnet.identification.fit_search import (
    CONVERGENCE_TOLERANCE,
    ROUNDED_MISFIT,
    LeastSquaresSolution,
    local_optimum,
)
from torsionnet.identification.fitting import best_optimum, identify, refit_with_noise_of
from torsionnet.identification.lack_of_fit import cause_in_words
from torsionnet.identification.plan.fit_entries import Unknown, read_unknowns
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray

# Ranking of the causes of a misfit, each value of the model freed alone, with the value it would need.

SMALL_SHARE = 1e-3
"""Share of the value in the model below which a fitted value may stand for zero."""
SAME_MISFIT = 1e-6
"""Share by which a misfit may be larger and count as the same."""


@dataclass(frozen=True)
class RankedCause:
    """Cause of a misfit with its rank, one value freed besides the parameters that were free before.

    Attributes
    ----------
    kind : {"delay", "gain", "reference_angle", "moving_inertia", "hysteretic", "viscous", "ratio", "value",
        "misfire", "gas_torque", "between", "friction", "stage"}
    of : str
        The value, the signals of a gain, delay or reference angle, the element with another kind of damping, or the
        cylinder that misfires.
    unknown : str
        Name of the value freed: ``gearbox.ratio``, ``gain``.
    before : float or None
        Value in the model, SI; None if it has none.
    value : float
        Value with which the model fits best, SI; the mean where it is fitted for each measurement.
    misfit : float
        RMS of model minus test over that of the test with this value freed, of all measurements.
    left : float
        Share of the sum of the squared weighted residuals that is left.
    explains : bool
        Whether little is left, and not much more than by the best cause.
    between : str
        Course of the input between samples instead of a value freed, which is then NaN; empty for other kinds.
    """

    kind: str
    of: str
    unknown: str
    before: float | None
    value: float
    misfit: float
    left: float
    explains: bool
    between: str = ""

    @property
    def factor(self) -> float | None:
        """Fitted value over the value in the model, or None if the model has none."""
        if self.kind == "gain":
            return self.value
        return self.value / self.before if self.before else None

    def __str__(self) -> str:
        return cause_in_words(self.kind, self.of, self.value, self.before, self.between)


@dataclass(frozen=True, repr=False)
class Ranking(SavedResult):
    """Causes of a misfit ranked by the misfit that each leaves when freed, the best first.

    Attributes
    ----------
    causes : tuple of RankedCause
    misfit : float
        RMS of model minus test over that of the test with nothing freed, of all measurements.
    """

    SHOWN: ClassVar = ("causes",)

    causes: Annotated[tuple[RankedCause, ...], Out(json="ranking")]
    misfit: float

    @property
    def verdict(self) -> str:
        """Sentence that names the causes that explain the misfit, or says that no single one does."""
        if not self.misfit:
            return "the model fits but for rounding: there is no misfit to explain"
        good = [str(cause) for cause in self.causes if cause.explains]
        if not good:
            return "no single value explains the misfit"
        return f"only {', or '.join(good)} explains the misfit"

    def table(self) -> Table:
        """Table with a row for each cause of a misfit, its value in the model, the value needed, the misfit left."""
        columns = (
            Column("freed alone"),
            Column("model has"),
            Column("would be"),
            Column("factor", "", 3),
            Column("misfit left", "%", 3),
            Column("explains it"),
        )
        rows = []
        for cause in self.causes:
            what = f"{cause.kind.replace('_', ' ')} of {cause.of}" if cause.unknown in CHANNEL_CAUSES else cause.unknown
            what = f"{cause.of} between samples" if cause.between else what
            rows.append(
                (
                    what,
                    cause.before,
                    cause.between.replace("_", "-") or cause.value,
                    cause.factor,
                    100 * cause.misfit,
                    "yes" if cause.explains else "no",
                )
            )
        note = f"misfit {100 * self.misfit:.3g} % (RMS of model minus test over test) with nothing freed"
        return Table("What would explain the misfit", columns, tuple(rows), (self.verdict, note))


@one_thread()
def rank_causes(
    model: AssembledModel | Fit,
    measurements: Measurement | Sequence[Measurement] = (),
    parameters: str | Sequence[str] | Mapping[str, Unknown | float | None] = (),
    *,
    residual: str = "complex",
) -> Ranking:
    """Ranking of the causes of a misfit, each value freed alone, by the misfit that is left.

    Tried are a gain and a delay of the outputs' channels, other courses of the inputs between samples, every inertia,
    stiffness, damping and ratio of the model, the frequencies of tuned dampers, and the other kind of damping of its
    springs; for measured orders also the angle of their reference, a misfire of each cylinder, and amplitudes and
    phases of propellers and other given torques.

    Parameters
    ----------
    model : Drivetrain or Fit
        A fit brings its model, measurements and parameters, which are fitted again with every cause.
    measurements : Measurement or sequence of these, optional
    parameters : str, sequence of str, or mapping, optional
        Parameters that are fitted together with each cause, as for :func:`identify`; none by default.
    residual : {"complex", "log", "magnitude"}, optional

    Returns
    -------
    Ranking

    Raises
    ------
    UsageError
        There is nothing measured, or as for :func:`identify`.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("dmf_rig")
    >>> test = rig.configured(I_2=0.2).frequency_response("theta_1", "T_T", [4.0, 6.0, 9.0, 12.0])
    >>> ranking = rank_causes(rig, tn.Measurement(test, "theta_1", "T_T"))
    >>> ranking.causes[0].unknown, round(ranking.causes[0].value, 6)
    ('I_2', 0.2)
    """
    problem, values, loss = _prepared(model, measurements, parameters, residual)

    def solve(tried: FitProblem, start: FloatArray, tolerance: float = CONVERGENCE_TOLERANCE) -> LeastSquaresSolution:
        return local_optimum(tried, start, loss, tolerance)

    whole = sum_of_squares(problem, values)
    tried = fit_causes(problem, possible_causes(problem), starts_of_causes(problem, values), solve, whole)
    misfit = _without_rounding(overall_misfit(problem, values))
    good = {cause_fit.cause for cause_fit in explaining_fits(tried, whole)} if misfit else set()
    ranked = [
        _ranked(replace(cause_fit, values=under_own_noise(cause_fit, solve).x), whole, explains=True)
        if cause_fit.cause in good
        else _ranked(cause_fit, whole, explains=False)
        for cause_fit in tried
    ]
    return Ranking(tuple(ranked), misfit)


def _prepared(
    model: AssembledModel | Fit,
    measurements: Measurement | Sequence[Measurement],
    parameters: str | Sequence[str] | Mapping[str, Unknown | float | None],
    residual: str,
) -> tuple[FitProblem, FloatArray, str]:
    """Problem whose misfit is to be explained, its values, and the loss that measures it."""
    if isinstance(model, Fit):
        if model.problem is None:
            raise UsageError("a fit read from a file has no data to compare with; fit again", kind="missing-data")
        return model.problem, np.array(list(model.values.values())), model.loss
    listed = [measurements] if isinstance(measurements, Measurement) else list(measurements)
    if not listed:
        raise UsageError("there is nothing measured to compare with", kind="missing-entry")
    problem = make_problem(model, listed, read_unknowns(parameters) if parameters else {}, residual)
    if parameters:
        return problem, best_optimum(problem, "linear").x, "linear"
    problem.learn_noise(problem.start)
    return problem, problem.start, "linear"


def _without_rounding(misfit: float) -> float:
    """Misfit unchanged, or 0 where rounding is all of it."""
    return misfit if misfit > ROUNDED_MISFIT else 0.0


def _fits_at_zero(cause_fit: CauseFit, places: list[int]) -> bool:
    """Whether a value that is small beside the one in the model, or that it lacks, explains as much as exactly zero."""
    start, values = cause_fit.problem.start[places], cause_fit.values.copy()
    if np.any(np.abs(values[places]) > SMALL_SHARE * np.abs(start)) and np.any(start):
        return False
    values[places] = 0.0
    try:
        misfit = overall_misfit(cause_fit.problem, values)
    except (TorsionnetError, ArithmeticError):  # as without a stiffness
        return False
    return bool(misfit <= max(cause_fit.misfit * (1 + SAME_MISFIT), ROUNDED_MISFIT))


def _ranked(cause_fit: CauseFit, whole: float, *, explains: bool) -> RankedCause:
    mine = [
        place for place, name in enumerate(cause_fit.problem.names) if name.partition("[")[0] == cause_fit.cause.unknown
    ]
    cause, value, begin = cause_fit.cause, float("nan"), 0.0
    if mine:
        value = 0.0 if _fits_at_zero(cause_fit, mine) else float(np.mean(cause_fit.values[mine]))
        begin = float(np.mean(cause_fit.problem.start[mine]))
    return RankedCause(
        kind=cause.kind,
        of=cause.place(cause_fit.problem),
        unknown=cause.unknown,
        before=begin if cause.is_value else None,
        value=value,
        misfit=_without_rounding(cause_fit.misfit),
        left=cause_fit.sum_of_squares / whole if whole else 0.0,
        explains=explains,
        between=cause.between,
    )


# Fit with what a command was asked beside it.


@dataclass(frozen=True)
class FittedValue:
    """Fitted value of a parameter with its standard error and 95 % intervals in SI, and the true value if known."""

    name: str
    value: float
    standard_error: float
    interval: Annotated[tuple[float, float], Out(json="interval_95")]
    profile: Annotated[tuple[float, float] | None, Out(json="profile_95")]
    unit: str
    true: float | None


@dataclass(frozen=True, eq=False)
class FitAnswer:
    """Fit with what was asked beside it: profile intervals and true values of its parameters, ranked causes."""

    SHOWN: ClassVar = (
        "fit.title", "parameters", "fit.correlation", "fit.chi_squared", "fit.degrees_of_freedom", "fit.aicc",
        "fit.verdicts", "fit.lack_of_fit", "fit.notes", "fit.comparisons", "causes",
    )  # fmt: skip

    fit: FitResult
    ranking: Ranking | None = None
    profiles: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    true: Mapping[str, float] = field(default_factory=dict)

    @property
    def parameters(self) -> tuple[FittedValue, ...]:
        """Fitted values with their intervals, true values where they are known."""
        fit, intervals = self.fit, self.fit.intervals()
        return tuple(
            FittedValue(
                name, value, fit.standard_errors[name], intervals[name], self.profiles.get(name),
                fit.units.get(name, ""), self.true.get(name),
            )
            for name, value in fit.values.items()
        )  # fmt: skip

    @property
    def causes(self) -> Annotated[tuple[RankedCause, ...] | None, Out(json="ranking", optional=True)]:
        """Ranked causes of a misfit, None where they were not asked for."""
        return None if self.ranking is None else self.ranking.causes


# Choice between several models of the same data, such as viscous or hysteretic damping, by AICc.

CLEAR_AICC_DIFFERENCE, SLIGHT_AICC_DIFFERENCE = 10.0, 4.0
"""Differences of the AICc of two models that leave next to no support, or little, to the worse one (Burnham and
Anderson)."""


@dataclass(frozen=True)
class Candidate:
    """Model to choose from, with the parameters of it that are to be fitted."""

    model: Drivetrain
    parameters: Sequence[str] | Mapping[str, Unknown | float | None]


@dataclass(frozen=True, eq=False, repr=False)
class Choice(SavedResult):
    """Result of a choice between models, with a fit of each to the same data, weighed by the same noise.

    Attributes
    ----------
    fits : mapping of str to Fit
        In the order of the criterion, the best first.
    """

    fits: Mapping[str, Fit]

    @property
    def best(self) -> str:
        """Name of the model with the lowest AICc, the preferred one."""
        return next(iter(self.fits))

    @property
    def differences(self) -> dict[str, float]:
        """AICc of each model minus that of the best one, by name of the model."""
        least = self.fits[self.best].aicc
        return {name: fit.aicc - least for name, fit in self.fits.items()}

    @property
    def verdict(self) -> str:
        """Sentence that names the preferred model and says how clearly it is better than the others."""
        others = [f"{name} is {rise:.3g} worse in AICc ({_how(rise)})" for name, rise in self.differences.items()][1:]
        return f"{self.best} is preferred: {', '.join(others)}" if others else f"only {self.best} was tried"

    def table(self) -> Table:
        """Table with a row for each model, its parameters, AICc above that of the best, and misfit."""
        columns = (Column("model"), Column("parameters"), Column("AICc above best", "", 4), Column("misfit", "", 3))
        rows = []
        for name, fit in self.fits.items():
            values = ", ".join(f"{key} = {value:.4g}" for key, value in fit.values.items())
            misfit = float(np.sqrt(np.mean([compared.misfit**2 for compared in fit.comparisons])))
            rows.append((name, values, self.differences[name], misfit))
        return Table("Models by AICc", columns, tuple(rows), (self.verdict,))


def _how(rise: float) -> str:
    return "clearly" if rise > CLEAR_AICC_DIFFERENCE else "somewhat" if rise > SLIGHT_AICC_DIFFERENCE else "hardly"


def choose_model(candidates: Mapping[str, Candidate], measurements: Measurement | Sequence[Measurement]) -> Choice:
    """Choice between several models by fits to the same measurements, ranked by Akaike's criterion for few data.

    All are weighed by the noise that the most successful one leaves unexplained: a model that explains little cannot
    call the rest noise.

    Parameters
    ----------
    candidates : mapping of str to Candidate
        Such as a viscous damper, a hysteretic spring, and both.
    measurements : Measurement or sequence of these

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("dmf_rig")
    >>> test = tn.Measurement(rig.frequency_response("theta_1", "T_T", np.linspace(1, 20, 40)), "theta_1", "T_T")
    >>> candidates = {"damped": Candidate(rig.configured(c_2=9), ["c_2"]), "stiff": Candidate(rig, ["k_1"])}
    >>> choose_model(candidates, test).best
    'damped'
    """
    if not candidates:
        raise UsageError("name at least one model to choose", kind="missing-entry")
    listed = [measurements] if isinstance(measurements, Measurement) else list(measurements)
    fits = {name: identify(candidate.model, listed, candidate.parameters) for name, candidate in candidates.items()}
    closest = min(fits.values(), key=_distance)
    again = {name: refit_with_noise_of(closest, candidates[name].model, fit) for name, fit in fits.items()}
    return Choice(dict(sorted(again.items(), key=lambda item: item[1].aicc)))


def _distance(fit: Fit) -> float:
    """Sum of squares of relative differences between model and test, over all lines of a fit."""
    ratios = [
        compared.fitted / compared.measured if compared.has_phase else np.abs(compared.fitted / compared.measured)
        for compared in fit.comparisons
    ]
    return sum(float(np.sum(np.abs(ratio - 1) ** 2)) for ratio in ratios)
