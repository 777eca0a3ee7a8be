"""Signal (instrumental variable) whose spectra multiply those of input and output in the estimate from a record.

Welch's H1 multiplies by the input itself, and the noise on that, squared, never averages out: H1 is low by its share. A
set-point shares no noise with the sensors, so its product with their noise averages out. Without one, segments in
which a line is not excited show the squared noise alone, which can be subtracted from the others. Antoni,
Wagstaff and Henrio (2004), IEEE Transactions on Instrumentation and Measurement 53(2), do so with random excitation
whose power rises and falls; a sweep passes each line once, which is as good.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray
from torsionnet.signals.estimators import LEAST_DRIVEN
from torsionnet.signals.recording import Recording
from torsionnet.signals.welch import Welch

EXCITED_POWER_SHARE = 0.1
"""Share of a line's power-weighted mean power above which a segment excites that line rather than showing noise
alone."""
MOST_EXCITED_SEGMENTS = 0.5
"""Share of segments that excite a line above which the remaining ones are too few to show the noise there."""


@dataclass(frozen=True)
class Instrument:
    """Estimator of a response and the signal (instrumental variable) whose lines multiply those of input and output.

    Attributes
    ----------
    estimator : str
        ``H1`` (the input itself), ``H2`` (the output) or ``Hr`` (a reference).
    signal : str
    asked : bool
        Whether the user asked for this signal; otherwise the input replaces a reference that does not drive it.
    plain : bool
        Whether its squared noise stays in the estimate, as by Welch's method.
    """

    estimator: str
    signal: str
    asked: bool = True
    plain: bool = False

    @property
    def is_clean(self) -> bool:
        """Whether the instrumental signal shares no noise with input and output."""
        return self.estimator == "Hr"

    def __str__(self) -> str:
        return f"Hr with {self.signal} as reference" if self.is_clean else self.estimator

    def lines(self, of_input: ComplexArray, of: Callable[[str], ComplexArray]) -> tuple[Instrument, ComplexArray]:
        """Instrument that drives the input, and the spectral lines of its signal, complex, (n_segments, n_b).

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
                f"{self.signal} explains {100 * share:.2g} % of the input: it does not drive it; name another reference"
            )
        return Instrument("H1", ""), of_input


def choose_instrument(
    model: AssembledModel, measurement: Measurement, record: Recording, settings: Welch
) -> Instrument:
    """Instrument for a measurement, which is the reference asked for, else a set-point in the record, else the input.

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
    why = "is not for the fit of a record; choose H1, H2, or Hr with a reference"
    if asked == "Hr":
        why = f"needs a reference, such as a set-point {' or '.join(set_points(model, measurement.excitation))}"
    raise UsageError(f"{measurement.label}: {asked} {why}")


def set_points(model: AssembledModel, excitation: str | None = None) -> tuple[str, ...]:
    """Channel names of the set-points of all inputs of the model, or of one input, such as ``T_M_set``.

    >>> import torsionnet as tn
    >>> set_points(tn.load("dmf_rig"))
    ('T_M_set',)
    """
    return tuple(f"{drive}_set" for drive in ([excitation] if excitation else model.inputs))


def _set_point(model: AssembledModel, measurement: Measurement, record: Recording) -> str:
    names = set_points(model, measurement.excitation)
    return next((name for name in names if name in record.names and name != measurement.input), "")


def without_background(lines: ComplexArray) -> tuple[ComplexArray, NDArray[np.bool_]]:
    """Lines (n_segments, n_b) of a signal, weighted so that squared noise, the same in all segments, cancels.

    Segments that excite a line get the weight 1 minus the share of such segments, all others minus that share. Lines
    that most segments excite are returned unchanged; the second array (n_b,) is True for them.
    """
    power = np.abs(lines) ** 2
    loud = power > EXCITED_POWER_SHARE * (power**2).sum(axis=0) / np.maximum(power.sum(axis=0), np.finfo(float).tiny)
    share = loud.mean(axis=0)
    kept = share > MOST_EXCITED_SEGMENTS
    return np.asarray(np.where(kept, lines, lines * (loud - share))), np.asarray(kept)
