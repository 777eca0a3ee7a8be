"""Measurement for a fit with its data, channels, band, and the configuration of the rig it was made in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.core.errors import UsageError
from torsionnet.response import FrequencyResponse
from torsionnet.response.recording import Recording
from torsionnet.signals.welch import Welch


@dataclass(frozen=True, eq=False)
class Measurement:
    """Measurement for a fit, a record of signals or an estimated frequency response, with channels and band.

    Attributes
    ----------
    data : Recording or FrequencyResponse
        With a record, the model predicts the output from the measured input, and test and prediction go through the
        same estimator, which avoids a bias by leakage. A record begins at rest, or see ``settling``.
    output, input : str
        Names in the data, and in the model unless ``model_output`` and ``model_input`` say otherwise.
    configuration : str, optional
        Configuration of the model: ``"II"``, ``"gear=II,clutch=open"``.
    band : tuple of float, optional
        Lowest and highest frequency in Hz; by default all up to where the data can be used.
    excluded : tuple of tuple of float, optional
        Bands in Hz that are left out.
    settings : Welch, optional
        Averaging of a record; by default that of the source paper, decimated if the rate is above 1 kHz. Estimators
        are H1, H2 and Hr.
    model_output, model_input, excitation : str, optional
    delay, gain : bool, optional
        Whether a delay (s) and a gain of the output's channel are found along with the parameters; the gain is negative
        where a channel is reversed, unless only magnitudes are compared.
    reference : str, optional
        Signal of a record that drives the input and shares no noise with it, such as the exciter's set-point: noise on
        the input then biases nothing. By default the channel named after the model's input with ``_set``, if there
        is one and ``settings`` name no other estimator.
    settling : float, optional
        Seconds at the start of a record that are left out, where it does not begin at rest.
    name : str, optional
        By default the configuration.
    error : float, optional
        Relative standard error of a response, instead of what its coherence says: 0.05 is 5 % of every magnitude.
    """

    data: Recording | FrequencyResponse
    output: str
    input: str
    configuration: str = ""
    band: tuple[float, float] | None = None
    excluded: tuple[tuple[float, float], ...] = ()
    settings: Welch | None = None
    model_output: str = ""
    model_input: str = ""
    excitation: str | None = None
    delay: bool = False
    gain: bool = False
    reference: str = ""
    settling: float = 0.0
    name: str = ""
    error: float | None = None

    def __post_init__(self) -> None:
        for low, high in (*([self.band] if self.band else ()), *self.excluded):
            if not (np.isfinite(low) and low >= 0 and high > low):
                raise UsageError(f"a band goes from a frequency >= 0 to a higher one, in Hz, got {low}, {high}")
        if isinstance(self.data, FrequencyResponse) and (self.settings or self.settling or self.reference):
            raise UsageError(
                "settings, settling and reference belong to records; this is a response that has been estimated"
            )
        if self.error is not None and not (np.isfinite(self.error) and self.error > 0):
            raise UsageError(f"a relative standard error is a number above 0, got {self.error}")
        if self.error is not None and isinstance(self.data, Recording):
            raise UsageError(
                "error is for a response that was estimated before; leave it "
                "out for a record, whose noise is taken from the data"
            )

    @property
    def label(self) -> str:
        """Name of the measurement in tables and messages."""
        return self.name or self.configuration or "measurement"
