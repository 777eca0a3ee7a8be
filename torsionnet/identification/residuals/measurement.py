"""Measurement for a fit with its data, channels, band, and the configuration of the rig it was made in.

Signal (instrumental variable) whose spectra multiply those of input and output in the estimate from a record. Welch's
H1 multiplies by the input itself, and the noise on that, squared, never averages out: H1 is low by its share. A
set-point shares no noise with the sensors, so its product with their noise averages out. Without one, segments in which
a line is not excited show the squared noise alone, which can be subtracted from the others. Antoni, Wagstaff and Henrio
(2004), IEEE Transactions on Instrumentation and Measurement 53(2), do so with random excitation whose power rises and
falls; a sweep passes each line once, which is as good.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.registers import settle
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray
from torsionnet.linear.between_samples import check_between
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.signals.estimators import LEAST_DRIVEN
from torsionnet.signals.orders.tracked_orders import MeasuredOrder, TrackedOrders
from torsionnet.signals.recording import Recording
from torsionnet.signals.stepped_levels import SteppedStiffness
from torsionnet.signals.welch import Welch

ONLY_OF_ORDERS = ("orders_used", "speeds", "speed_of", "reference_angle")
"""Attributes of a measurement that belong to orders of turning machinery."""


@dataclass(frozen=True, eq=False)
class Measurement:
    """Measurement for a fit: a record of signals, an estimated frequency response or orders, with channels and band.

    Attributes
    ----------
    data : Recording, FrequencyResponse, SteppedStiffness, TrackedOrders or sequence of MeasuredOrder
        With a record, the model predicts the output from the measured input, and test and prediction go through the
        same estimator, which avoids a bias by leakage. A record begins at rest, or see ``settling``. Orders are
        compared with those that the excitations of the model cause at the same speeds, over their intervals; without
        phases only amplitudes are. Steps of sines at several amplitudes are compared with the first harmonic of the
        twist under the torque, with laws of motion by their describing functions.
    output, input : str
        Names in the data, and in the model unless ``model_output`` and ``model_input`` say otherwise. Orders have no
        input, and those of a tracked channel have its name.
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
        Relative standard error of a response, instead of what its coherence says, or of steps: 0.05 is 5 % of every
        magnitude. Of orders it holds where they have no interval.
    orders_used : tuple of float, optional
        Orders that are compared; by default all that the model excites.
    speeds : tuple of float, optional
        Lowest and highest speed of the reference shaft in rad/s at which orders are compared.
    speed_of : str, optional
        Node of the shaft of which the test's orders and speeds are; by default that of the model's speeds.
    between : {"held", "straight", "band_limited"}, optional
        Course of the input between its samples, in place of what the data say; where another torque drives, as the
        motor's ahead of a torque meter, the course of that one.
    equations : bool, optional
        Whether laws of motion act in full along a record: their equation of motion is compared, over short times, as
        for loops of torque over twist, decays (which have no ``input``) and rattling. The output is the twist of their
        element, beside which one mass moves, or none.
    reference_angle : bool, optional
        Whether the angle is found along by which the test's reference comes after the zero of the model's angle of
        rotation, rad.
    moving_inertia : bool, optional
        Whether the inertia is found along that moves between the torque measured and the element, kg m^2, where
        ``equations`` are compared. One frequency does not tell it from the stiffness.
    """

    data: Recording | FrequencyResponse | SteppedStiffness | TrackedOrders | Sequence[MeasuredOrder]
    output: str = ""
    input: str = ""
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
    orders_used: tuple[float, ...] = ()
    speeds: tuple[float, float] | None = None
    speed_of: str = ""
    reference_angle: bool = False
    between: str | None = None
    equations: bool = False
    moving_inertia: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.data, Recording | FrequencyResponse | SteppedStiffness):
            self._take_orders(self.data)
        elif wrong := [name for name in ONLY_OF_ORDERS if getattr(self, name)]:
            raise UsageError(
                f"{', '.join(wrong)} {'belong' if len(wrong) > 1 else 'belongs'} to measured orders",
                kind="needless-entry",
            )
        elif not (self.output and (self.input or self.equations)):
            raise UsageError("name the output and the input of a record or response", kind="missing-entry")
        if self.equations:
            self._check_equations()
        elif self.moving_inertia:
            raise UsageError("moving_inertia belongs to equations of motion; leave it out", kind="needless-entry")
        if self.between:
            check_between(self.between)
            if isinstance(self.data, SteppedStiffness):
                raise UsageError(
                    "steps of sines have no course between samples; leave between out", kind="needless-entry"
                )
        for low, high in (*([self.band] if self.band else ()), *self.excluded):
            if not (np.isfinite(low) and low >= 0 and high > low):
                raise UsageError(
                    f"a band goes from a frequency >= 0 to a higher one, in Hz, got {low}, {high}",
                    kind="unordered-rows",
                )
        if not isinstance(self.data, Recording) and (self.settings or self.settling or self.reference):
            raise UsageError(
                "settings, settling and reference belong to records; this is a response that has been estimated",
                kind="needless-entry",
            )
        if self.error is not None and not (np.isfinite(self.error) and self.error > 0):
            raise UsageError(f"a relative standard error is a number above 0, got {self.error}", kind="out-of-range")
        if self.error is not None and isinstance(self.data, Recording):
            raise UsageError(
                "error is for a response that was estimated before; leave it "
                "out for a record, whose noise is taken from the data",
                kind="needless-entry",
            )

    def _check_equations(self) -> None:
        if not isinstance(self.data, Recording):
            raise UsageError("equations of motion are those of a record over time", kind="needless-entry")
        needless = ("band", "excluded", "settings", "reference", "between")
        if wrong := [name for name in needless if getattr(self, name)]:
            text = f"equations of motion are compared over time, without {', '.join(wrong)}; leave it out"
            raise UsageError(text, kind="needless-entry")

    def _take_orders(self, data: TrackedOrders | Sequence[MeasuredOrder]) -> None:
        """Check what is said about orders, and bring them and their output to the stored form."""
        if isinstance(data, TrackedOrders):
            settle(self, output=self.output or data.name)
        else:
            listed = tuple(data)
            if not listed or not all(isinstance(order, MeasuredOrder) for order in listed):
                raise UsageError(
                    "a measurement is a record, a frequency response, tracked orders or MeasuredOrders",
                    kind="wrong-form",
                )
            settle(self, data=listed)
        if not self.output:
            raise UsageError("name the output of the model that the orders were measured at", kind="missing-entry")
        if self.input or self.model_input or self.excitation or self.between:
            raise UsageError(
                "orders have no input: the excitations of the model cause them; leave input out", kind="needless-entry"
            )
        if self.settings or self.settling or self.reference:
            raise UsageError(
                "settings, settling and reference belong to records; these are orders", kind="needless-entry"
            )
        settle(self, orders_used=tuple(map(float, self.orders_used)))
        if self.speeds is not None and not 0 <= self.speeds[0] < self.speeds[1]:
            raise UsageError(
                f"a range of speeds goes from a lower to a higher one, in rad/s, got {self.speeds}",
                kind="unordered-rows",
            )

    @property
    def has_orders(self) -> bool:
        """Whether the measurement is of orders of turning machinery, not a record or a frequency response."""
        return not isinstance(self.data, Recording | FrequencyResponse | SteppedStiffness)

    @property
    def channels(self) -> str:
        """Text with output and input of the measurement, or orders and output: ``theta_1/T_T``, ``orders of T_cpl``."""
        if self.has_orders:
            return f"orders of {self.output}"
        return f"{self.output}/{self.input}" if self.input else self.output

    @property
    def label(self) -> str:
        """Name of the measurement in tables and messages."""
        return self.name or self.configuration or "measurement"


# Signal (instrumental variable) whose spectra multiply those of input and output in the estimate from a record.

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
        of_signal = of(self.signal)
        if not self.is_clean:
            return self, of_signal
        # Coherence |sum R^* X|^2/(sum |R|^2 sum |X|^2) with the input: near 0 the signal does not drive it.
        with np.errstate(divide="ignore", invalid="ignore"):
            both = np.abs((of_signal.conj() * of_input).sum(axis=0)) ** 2
            shares = both / (np.abs(of_signal) ** 2).sum(axis=0) / (np.abs(of_input) ** 2).sum(axis=0)
        share = float(np.median(np.nan_to_num(shares)))
        if share >= LEAST_DRIVEN:
            return self, of_signal
        if self.asked:
            text = f"{self.signal} explains {100 * share:.2g} % of the input: it does not drive it"
            raise UsageError(f"{text}; name another reference", kind="unrelated-signals")
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
    asked, set_point = settings.estimator, _set_point(model, measurement, record)
    if set_point and asked in ("", "Hr"):
        return Instrument("Hr", set_point, asked=asked == "Hr")
    own = {"": measurement.input, "H1": measurement.input, "H2": measurement.output}
    if asked in own:
        return Instrument(asked or "H1", own[asked])
    kind, why = "unknown-word", "is not for the fit of a record; choose H1, H2, or Hr with a reference"
    if asked == "Hr":
        kind = "missing-entry"
        why = f"needs a reference, such as a set-point {' or '.join(set_points(model, measurement.excitation))}"
    raise UsageError(f"{measurement.label}: {asked} {why}", kind=kind)


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
    # Excited segments by their share of the power's own weighted mean, sum P^2/sum P.
    loud = power > EXCITED_POWER_SHARE * (power**2).sum(axis=0) / np.maximum(power.sum(axis=0), np.finfo(float).tiny)
    share = loud.mean(axis=0)
    kept = share > MOST_EXCITED_SEGMENTS
    # These weights sum to 0 over the segments, so that noise of the same power in all of them cancels.
    return np.asarray(np.where(kept, lines, lines * (loud - share))), np.asarray(kept)
