"""What the spectra of a record are multiplied by, so that noise on both sensors averages out.

Welch's H1 multiplies by the input itself, and the noise on that, squared, never averages out: H1 is low by its share. A
set-point shares no noise with the sensors, so nothing is left of it (instrumental variables). Without one, segments in
which a line is not excited show the squared noise alone, and what they show can be taken off the others. Antoni,
Wagstaff and Henrio (2004), IEEE Transactions on Instrumentation and Measurement 53(2), do so with random excitation
whose power rises and falls; a sweep passes each line once, which is as good.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.assembly.rows import ComplexArray
from torsionnet.core.errors import UsageError
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.response.recording import Recording
from torsionnet.signals.estimators import LEAST_DRIVEN
from torsionnet.signals.welch import Welch

LOUD = 0.1
"""Share of the power of a line in segments that excite it (the mean that power itself weighs) above which one does."""
MOST_LOUD = 0.5
"""Share of segments that excite a line above which the others say too little of the noise."""


@dataclass(frozen=True)
class Instrument:
    """An estimator, and the signal whose lines multiply those of input and output.

    Attributes
    ----------
    estimator : str
        ``H1`` (the input itself), ``H2`` (the output) or ``Hr`` (a reference).
    signal : str
    asked : bool
        Whether it must be this one; otherwise the input stands in for a reference that does not drive it.
    plain : bool
        Whether its squared noise stays in all segments, as in an estimate by Welch's method.
    """

    estimator: str
    signal: str
    asked: bool = True
    plain: bool = False

    @property
    def is_clean(self) -> bool:
        """Whether it shares no noise with input and output."""
        return self.estimator == "Hr"

    def __str__(self) -> str:
        return f"Hr with {self.signal} as reference" if self.is_clean else self.estimator

    def lines(self, of_input: ComplexArray, of: Callable[[str], ComplexArray]) -> tuple[Instrument, ComplexArray]:
        """What it is in the end, and its lines (n_segments, n_b) from those of the input and of any signal.

        Raises
        ------
        UsageError
            The reference does not drive the input.
        """
        found = of(self.signal)
        if not self.is_clean:
            return self, found
        with np.errstate(divide="ignore", invalid="ignore"):
            both = np.abs((found.conj() * of_input).sum(axis=0)) ** 2
            shares = both / (np.abs(found) ** 2).sum(axis=0) / (np.abs(of_input) ** 2).sum(axis=0)
        share = float(np.median(np.nan_to_num(shares)))
        if share >= LEAST_DRIVEN:
            return self, found
        if self.asked:
            raise UsageError(
                f"{self.signal} explains {100 * share:.2g} % of the input: it does not drive it, and is no reference"
            )
        return Instrument("H1", ""), of_input


def instrument_of(model: AssembledModel, measurement: Measurement, record: Recording, settings: Welch) -> Instrument:
    """What the measurement asks for, else a set-point that the record has, else the input.

    Raises
    ------
    UsageError
        An estimator that the fit of a record does not have, or a reference that is not there.
    """
    if measurement.reference:
        return Instrument("Hr", record[measurement.reference].name)
    asked, found = settings.estimator, _set_point(model, measurement, record)
    if found and asked in ("", "Hr"):
        return Instrument("Hr", found, asked=asked == "Hr")
    own = {"": measurement.input, "H1": measurement.input, "H2": measurement.output}
    if asked in own:
        return Instrument(asked or "H1", own[asked])
    why = "is not for the fit of a record; there is H1, H2, and Hr with a reference"
    if asked == "Hr":
        why = f"needs a reference, such as a set-point {' or '.join(set_points(model, measurement.excitation))}"
    raise UsageError(f"{measurement.label}: {asked} {why}")


def set_points(model: AssembledModel, excitation: str | None = None) -> tuple[str, ...]:
    """What the set-points of the model's inputs are called, or that of one of them.

    >>> import torsionnet as tn
    >>> set_points(tn.load("dmf_rig"))
    ('T_M_set',)
    """
    return tuple(f"{drive}_set" for drive in ([excitation] if excitation else model.inputs))


def _set_point(model: AssembledModel, measurement: Measurement, record: Recording) -> str:
    names = set_points(model, measurement.excitation)
    return next((name for name in names if name in record.names and name != measurement.input), "")


def without_background(lines: ComplexArray) -> tuple[ComplexArray, NDArray[np.bool_]]:
    """Lines (n_segments, n_b) weighted so that squared noise, the same in all segments, adds up to nothing.

    Segments that excite a line count one less the share of such segments, all others minus that share. Lines that most
    segments excite stay as they are: whether they do, (n_b,).
    """
    power = np.abs(lines) ** 2
    loud = power > LOUD * (power**2).sum(axis=0) / np.maximum(power.sum(axis=0), np.finfo(float).tiny)
    share = loud.mean(axis=0)
    kept = share > MOST_LOUD
    return np.asarray(np.where(kept, lines, lines * (loud - share))), np.asarray(kept)
