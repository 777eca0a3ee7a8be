"""Frequency responses (transfer functions over frequency), calculated from a model or estimated from a test."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.packages import UNSAVED, SavedResult
from torsionnet.base.registers import settle

if TYPE_CHECKING:
    import control
    import pandas

    from torsionnet.base.notes import NoteOrText
    from torsionnet.base.table import Table
    from torsionnet.linear.between_samples import BetweenSamples
    from torsionnet.linear.estimation import Estimation

FloatArray: TypeAlias = NDArray[np.float64]
ComplexArray: TypeAlias = NDArray[np.complex128]

SIGN_NOTE = "motion ~ exp(+j omega t): a lag is a negative phase; torque at a cut is positive when it drives"
"""Text of the note on sign conventions below tables and in files of responses."""
DERIVATIVE_ORDERS = {"rad": 0, "rad/s": 1, "rad/s^2": 2}
"""Order of the time derivative of an angle (0, 1, 2) that each SI unit of motion belongs to, by unit."""
KINDS_BY_UNIT = {"rad": "receptance", "rad/s": "mobility", "rad/s^2": "accelerance"}
"""Name of a frequency response to torque, such as mobility, by SI unit of its output."""


@dataclass(frozen=True)
class Channel:
    """Signal of a frequency response with name and SI unit (rad, rad/s, rad/s^2 or N*m).

    Of a response estimated from samples ``course`` is that between them, for which it was corrected.

    Examples
    --------
    >>> import torsionnet as tn
    >>> tn.Channel("theta_1", "rad")
    Channel(name='theta_1', unit='rad')
    """

    name: str
    unit: str
    course: BetweenSamples | None = field(default=None, compare=False, repr=False, metadata=UNSAVED)


@dataclass(frozen=True, eq=False, repr=False)
class FrequencyResponse(SavedResult):
    """Transfer functions from inputs to outputs in SI units over frequency in Hz, shape (n_f, n_out, n_in).

    Attributes
    ----------
    frequencies : (n_f,) array
        Frequencies, Hz.
    values : (n_f, n_out, n_in) complex array
        SI units, rad for angles.
    outputs, inputs : tuple of Channel
    title : str
        Name of the model or test, with its configuration.
    conditioning : (n_f,) array, optional
        Size of a measured input over the sum of its terms; near 0 the response at this frequency is unreliable.
    coherence : (n_f, n_out, n_in) array, optional
        Coherence of an estimated response, 0 to 1.
    notes : tuple of str or Note
        Provenance and remarks.
    usable_up_to : float, optional
        Highest usable frequency of an estimate in Hz: above, the motion is too small for the steps of its sensor, or
        decimation aliases.
    estimation : Estimation, optional
        Averaging by which the response was estimated from records.
    has_phase : bool
        False where only magnitudes are known; the values are then real.
    model, configuration : str
        Names of the model and of its configuration, of a calculated response.

    Values and coherence of one output over one input may be given as (n_f,).

    Raises
    ------
    UsageError
        The shapes of the arrays do not fit the frequencies and channels.

    Examples
    --------
    Arrays of a test, from degrees into SI, beside the model:

    >>> import numpy as np
    >>> import torsionnet as tn
    >>> measured = np.array([0.26 - 0.05j, 0.11 - 0.02j])  # deg/(N*m) at 5 and 10 Hz
    >>> theta, torque = tn.Channel("theta_1", "rad"), tn.Channel("T_M", "N*m")
    >>> test = tn.FrequencyResponse(np.array([5.0, 10.0]), measured * np.pi / 180, (theta,), (torque,), "run 7")
    >>> print(test.kind(), test.values.shape)
    receptance (2, 1, 1)
    >>> tn.load("dmf_rig").frequency_response("theta_1", "T_M", test.frequencies).inputs == test.inputs
    True
    """

    picture: ClassVar[str] = "bode"
    PARTS: ClassVar[Mapping[str, str]] = {
        "Estimation": "torsionnet.linear.estimation",
        "NoteOrText": "torsionnet.base.notes",
    }

    frequencies: FloatArray
    values: ComplexArray
    outputs: tuple[Channel, ...]
    inputs: tuple[Channel, ...]
    title: str = ""
    conditioning: FloatArray | None = None
    coherence: FloatArray | None = None
    notes: tuple[NoteOrText, ...] = ()
    usable_up_to: float | None = None
    estimation: Estimation | None = None
    has_phase: bool = True
    model: str = ""
    configuration: str = ""

    def __post_init__(self) -> None:
        settled: dict[str, Any] = {
            "frequencies": np.asarray(self.frequencies, dtype=float),
            "values": np.asarray(self.values, dtype=complex),
            "coherence": None if self.coherence is None else np.asarray(self.coherence),
            "outputs": tuple(self.outputs),
            "inputs": tuple(self.inputs),
        }
        # Frequencies are (n_f,), the others (n_f, n_out, n_in), or (n_f,) too where there is one output over one input.
        shape = (settled["frequencies"].size, len(settled["outputs"]), len(settled["inputs"]))
        for name, wanted in {"frequencies": shape[:1], "values": shape, "coherence": shape}.items():
            array = settled[name]
            if array is not None and array.shape == wanted[:1] and wanted[1:] == (1, 1):
                settled[name] = array.reshape(wanted)
            elif array is not None and array.shape != wanted:
                form = "(n_f,)" if len(wanted) == 1 else "(n_f, n_out, n_in)"
                raise UsageError(f"{name} have the shape {array.shape}; expected {form} = {wanted}", kind="wrong-count")
        settle(self, **settled)

    @property
    def magnitude(self) -> FloatArray:
        """Magnitude of the transfer functions in SI units of output over input, shape (n_f, n_out, n_in)."""
        return np.abs(self.values)

    @property
    def phase(self) -> FloatArray:
        """Phase of the transfer functions in degrees, -180 to 180, shape (n_f, n_out, n_in).

        Negative when the output lags, NaN if unknown.
        """
        return np.degrees(np.angle(self.values)) if self.has_phase else np.full(self.values.shape, np.nan)

    def decibels(self, conventions: Conventions = SI) -> FloatArray:
        """Magnitude of the transfer functions in dB over the reference in the unit shown, shape (n_f, n_out, n_in)."""
        scale = np.array(
            [[self.scale(conventions, o, i) for i in range(len(self.inputs))] for o in range(len(self.outputs))]
        )
        with np.errstate(divide="ignore"):
            return np.asarray(20 * np.log10(self.magnitude * scale / conventions.db_reference))

    def _units(self, output: int | str, input: int | str) -> tuple[str, str]:
        """SI units of an output and an input, given by place or by name."""
        sides = (output, self.outputs, "output"), (input, self.inputs, "input")
        above, below = (
            channels[_indices(key, channels, what)[0] if isinstance(key, str) else key].unit
            for key, channels, what in sides
        )
        return above, below

    def scale(self, conventions: Conventions, output: int | str = 0, input: int | str = 0) -> float:
        """Factor from SI to the unit in which the transfer function of one output over one input is shown."""
        above, below = self._units(output, input)
        return conventions.scale(above) / conventions.scale(below)

    def unit(self, output: int | str = 0, input: int | str = 0, conventions: Conventions = SI) -> str:
        """Text of the unit in which the transfer function of an output over an input is shown.

        Both are given by place or by name. ``1`` for like signals.

        Examples
        --------
        >>> import torsionnet as tn
        >>> tn.load("dmf_rig").frequency_response("theta_1", "T_T", [8]).unit("theta_1", "T_T")
        'rad/(N*m)'
        """
        above, below = map(conventions.unit, self._units(output, input))
        return quotient_unit(above, below)

    def kind(self, output: int | str = 0, input: int | str = 0) -> str:
        """Name of the kind of transfer function of one output over one input, such as receptance or mobility."""
        above, below = self._units(output, input)
        if below == "N*m":
            return KINDS_BY_UNIT.get(above, "torque ratio")
        if above == "N*m":
            return "dynamic stiffness" if below == "rad" else "transfer function"
        return "motion ratio" if above == below else "transfer function"

    def select(
        self, output: str | Sequence[str] | None = None, input: str | Sequence[str] | None = None
    ) -> FrequencyResponse:
        """Frequency response of the named outputs to the named inputs only."""
        rows, columns = _indices(output, self.outputs, "output"), _indices(input, self.inputs, "input")
        pick = np.ix_(range(len(self.frequencies)), rows, columns)
        return replace(
            self,
            values=self.values[pick],
            outputs=tuple(self.outputs[row] for row in rows),
            inputs=tuple(self.inputs[column] for column in columns),
            coherence=None if self.coherence is None else self.coherence[pick],
        )

    def between(self, start: float, stop: float | None = None) -> FrequencyResponse:
        """Frequency response at the frequencies from ``start`` to ``stop`` Hz only; to the last if ``stop`` is None.

        Examples
        --------
        >>> import torsionnet as tn
        >>> tn.load("dmf_rig").frequency_response("theta_1", "T_M", [1, 2, 3, 4]).between(2, 3).frequencies.tolist()
        [2.0, 3.0]
        """
        last = np.inf if stop is None else stop
        return self.at_lines((self.frequencies >= start) & (self.frequencies <= last))

    def at_lines(self, kept: NDArray[np.bool_]) -> FrequencyResponse:
        """Frequency response at the frequencies that the mask ``kept`` (n_f,) marks only."""
        return replace(
            self,
            frequencies=self.frequencies[kept],
            values=self.values[kept],
            conditioning=None if self.conditioning is None else self.conditioning[kept],
            coherence=None if self.coherence is None else self.coherence[kept],
        )

    def receptance(self) -> FrequencyResponse:
        """Receptance (angle per torque, rad/(N m)) over frequency, integrated from velocity or acceleration outputs."""
        return self._of_order("rad")

    def mobility(self) -> FrequencyResponse:
        """Mobility (angular velocity per torque, rad/s/(N m)) over frequency, j omega times the receptance."""
        return self._of_order("rad/s")

    def accelerance(self) -> FrequencyResponse:
        """Accelerance (angular acceleration per torque, rad/s^2/(N m)) over frequency, -omega^2 times receptance."""
        return self._of_order("rad/s^2")

    def _of_order(self, unit: str) -> FrequencyResponse:
        wrong = [channel.name for channel in self.outputs if channel.unit not in DERIVATIVE_ORDERS]
        if wrong:
            raise UsageError(
                f"{', '.join(wrong)} is not an angle, velocity or acceleration; select the outputs of motion first",
                kind="unfit-channel",
            )
        s: ComplexArray = (2j * np.pi * self.frequencies[:, None]).astype(complex)
        steps = np.array([DERIVATIVE_ORDERS[unit] - DERIVATIVE_ORDERS[channel.unit] for channel in self.outputs])
        with np.errstate(divide="ignore", invalid="ignore"):
            values = np.asarray(self.values * (s**steps)[:, :, None], dtype=np.complex128)
        values = values if self.has_phase else np.abs(values).astype(np.complex128)
        estimation = None if self.estimation is None else replace(self.estimation, record=None)
        outputs = tuple(Channel(channel.name, unit) for channel in self.outputs)
        return replace(self, values=values, outputs=outputs, estimation=estimation)

    def dynamic_stiffness(self) -> FrequencyResponse:
        """Dynamic stiffness (torque per angle, N m/rad), the inverse of the receptance *matrix* at every frequency.

        Raises
        ------
        UsageError
            The receptance matrix is not square, or not finite.
        """
        receptance = self.receptance()
        if len(self.outputs) != len(self.inputs):
            size = f"{len(self.outputs)} x {len(self.inputs)}"
            raise UsageError(
                f"dynamic stiffness is the inverse of a square receptance matrix; this one is {size}",
                kind="wrong-count",
            )
        if not self.has_phase and len(self.inputs) > 1:
            raise UsageError(
                "a matrix of magnitudes without phases cannot be inverted; select one output and one input",
                kind="wrong-count",
            )
        if not np.isfinite(receptance.values).all():
            raise UsageError(
                "the receptance is not finite at some frequency; leave that frequency out", kind="not-finite"
            )
        values: ComplexArray = np.linalg.inv(receptance.values).astype(np.complex128)
        outputs, inputs = receptance.inputs, receptance.outputs
        return replace(receptance, values=values, outputs=outputs, inputs=inputs, coherence=None, estimation=None)

    def response_amplitude(self, input_amplitudes: Any, conventions: Conventions = SI) -> FloatArray:
        """Amplitude (n_f, n_out) of outputs, in units shown, under inputs of *peak* amplitude (n_in,) or (n_f, n_in).

        In the angle unit and the kind of amplitude (peak, RMS, peak-to-peak) of ``conventions``.
        """
        amplitudes = np.broadcast_to(np.asarray(input_amplitudes), (len(self.frequencies), len(self.inputs)))
        response = np.abs(np.einsum("foi,fi->fo", self.values, amplitudes))
        scales = np.array([conventions.scale(channel.unit) for channel in self.outputs])
        return np.asarray(response * scales * conventions.amplitude_scale)

    def table(self, conventions: Conventions = SI) -> Table:
        """Table of magnitude, phase in deg and coherence, where known, of each output over each input by frequency."""
        from torsionnet.base.table import Column, Table
        from torsionnet.linear.estimation import estimation_text

        columns = [Column("frequency", conventions.frequency)]
        data: list[FloatArray] = [self.frequencies * conventions.frequency_scale]
        for o, out in enumerate(self.outputs):
            for i, into in enumerate(self.inputs):
                label = f"{out.name}/{into.name}"
                columns.append(Column(f"|{label}|", self.unit(o, i, conventions)))
                data.append(self.magnitude[:, o, i] * self.scale(conventions, o, i))
                if self.has_phase:
                    columns.append(Column(f"phase {label}", "deg"))
                    data.append(self.phase[:, o, i])
                if self.coherence is not None:
                    columns.append(Column(f"coherence {label}", "1"))
                    data.append(self.coherence[:, o, i])
        rows = tuple(tuple(float(cell) for cell in row) for row in zip(*data, strict=True))
        keys = filter(None, [usable_limit_text(self), estimation_text(self.estimation)])
        return Table(self.title, tuple(columns), rows, (*map(str, self.notes), *keys, SIGN_NOTE))

    def to_dataframe(self) -> pandas.DataFrame:
        """Frequency response as a pandas.DataFrame of complex values in SI units, with the frequencies in Hz as index.

        The columns are named ``output/input``; ``attrs`` has the title, the units by column and the notes.

        Raises
        ------
        MissingExtraError
            pandas is not installed.
        """
        from torsionnet.base.table import data_frame

        pairs = [(o, i) for o in range(len(self.outputs)) for i in range(len(self.inputs))]
        units = {f"{self.outputs[o].name}/{self.inputs[i].name}": self.unit(o, i) for o, i in pairs}
        values = self.values.reshape(len(self.frequencies), len(units))
        return data_frame(values, ("frequency [Hz]", self.frequencies), units, self.title, self.notes)

    def to_csv(self, path: str | Path | None = None, conventions: Conventions = SI) -> str:
        """Table of the frequency response as CSV text, also written to the file ``path`` if given."""
        return self.table(conventions).to_csv(path)

    def to_control(self) -> control.FrequencyResponseData:
        """Frequency response as FrequencyResponseData of python-control, signals named, SI units, omega in rad/s."""
        import control

        return control.FrequencyResponseData(
            np.moveaxis(self.values, 0, 2),
            2 * np.pi * self.frequencies,
            inputs=[channel.name for channel in self.inputs],
            outputs=[channel.name for channel in self.outputs],
        )

    def __repr__(self) -> str:
        outputs, inputs = (", ".join(channel.name for channel in side) for side in (self.outputs, self.inputs))
        count = len(self.frequencies)
        span = f"{self.frequencies.min():g} to {self.frequencies.max():g} Hz" if count else "no frequencies"
        return f"<FrequencyResponse {outputs} / {inputs}: {count} frequencies, {span}>"


def usable_limit_text(response: FrequencyResponse) -> str:
    """Key and highest usable frequency in Hz of a response, as files and tables say it; empty without a limit.

    >>> y, u = Channel("y", "rad"), Channel("u", "N*m")
    >>> usable_limit_text(FrequencyResponse([1.0], [[[1j]]], [y], [u], usable_up_to=16.8))
    'usable_up_to: 16.8 Hz'
    """
    return "" if response.usable_up_to is None else f"usable_up_to: {response.usable_up_to:.6g} Hz"


def _indices(names: str | Sequence[str] | None, channels: tuple[Channel, ...], what: str) -> list[int]:
    known = [channel.name for channel in channels]
    if names is None:
        return list(range(len(known)))
    wanted = [names] if isinstance(names, str) else list(names)
    for name in wanted:
        if name not in known:
            raise UsageError(
                f'no {what} is named "{name}"{did_you_mean(name, known)}; there is {", ".join(known)}',
                kind="unknown-channel",
            )
    return [known.index(name) for name in wanted]


def quotient_unit(above: str, below: str) -> str:
    """Text of the unit of one quantity over another, from the texts of both units.

    >>> quotient_unit("rad", "N*m"), quotient_unit("N*m", "N*m"), quotient_unit("N*m", "rad")
    ('rad/(N*m)', '1', 'N*m/rad')
    """
    if above == below:
        return "1"
    return f"{above}/({below})" if "*" in below or "/" in below else f"{above}/{below}"
