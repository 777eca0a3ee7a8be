"""Choice between several models of the same data, such as viscous or hysteretic damping, by AICc."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.packages import SavedResult
from torsionnet.base.table import Column, Table
from torsionnet.drivetrain import Drivetrain
from torsionnet.identification.fit import Fit
from torsionnet.identification.fitting import identify, refit_with_noise_of
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.identification.unknown_parameter import Unknown

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
