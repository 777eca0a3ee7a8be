"""Natural frequencies and damping ratios found without a measured input, and those from ambient records."""

from __future__ import annotations

import contextlib
import importlib
import io
import logging
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

import torsionnet.modal.matrix_fraction as pole_numbers
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import MissingExtraError, SolveError, UsageError
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.base.packages import SavedResult, one_of
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.linear.frequency_response import Channel
from torsionnet.modal.matching import Match
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray
from torsionnet.signals.recording import Recording

# Natural frequencies and damping ratios found without a measured input, with 95 % intervals.

NORMAL_95 = 1.959964
"""Half width of the 95 % interval of a normally distributed number over its standard deviation."""


@dataclass(frozen=True, eq=False)
class OperationalMode:
    """Natural frequency (Hz) and damping ratio of one mode found without an input, with half widths at 95 %."""

    mode: Annotated[int, Out("mode")]
    natural_frequency: Annotated[float, Out("natural frequency", "Hz", "natural_frequency_Hz")]
    frequency_half_width: Annotated[float, Out("95 % interval +-", "Hz", "frequency_half_width_Hz", digits=2)]
    damping_ratio: Annotated[float, Out("damping ratio", "1")]
    damping_half_width: Annotated[float, Out("95 % interval +-", "1", "damping_half_width", digits=2)]
    amplitude: Annotated[float, Out("largest amplitude", digits=4)]
    remark: Annotated[str, Out("remark")]


@dataclass(frozen=True, eq=False, repr=False)
class OperationalModes(SavedResult):
    """Modes found without a measured input, with natural frequencies in Hz, damping ratios and 95 % intervals.

    Attributes
    ----------
    poles : (n_modes,) complex array
        lambda in rad/s, Im > 0, rising in size.
    frequency_half_widths, damping_half_widths : (n_modes,) arrays
        Half widths of the 95 % intervals, Hz and 1, of random errors only; NaN where none is known.
    amplitudes : (n_modes,) array
        Largest amplitude of the contribution of each mode in SI units of the channel; NaN where none is known.
    channel, unit : str
        Channel read, and its SI unit.
    method : str
    evidence : object
        What the numbers were read from, for a picture: :class:`SweptFit`, :class:`DecayFit` or :class:`AmbientPoles`.
    mode_remarks : tuple of str
        NoteOrText on each mode, empty where there is none.
    title : str
    notes : tuple of str or Note
        Remarks on all; those to heed are of severity warning.
    against_model : Match or None
        Modes of a model that these were compared with, to be shown beside them.
    """

    picture: ClassVar[str] = "operational_modes"
    SHOWN: ClassVar = ("title", "channel", "unit", "method", "notes", "modes", "against_model.pairs")
    outputs: ClassVar[tuple[Channel, ...]] = ()
    """Sensors with shapes, none: :func:`torsionnet.modal.match` compares poles alone."""

    poles: ComplexArray
    frequency_half_widths: FloatArray
    damping_half_widths: FloatArray
    amplitudes: FloatArray
    channel: str
    unit: str
    method: str
    evidence: object = field(
        metadata=one_of(
            "torsionnet.modal.operational.run_up_modes:SweptFit",
            "torsionnet.modal.operational.decay_modes:DecayFit",
            "torsionnet.modal.operational.ambient_modes:AmbientPoles",
        )
    )
    mode_remarks: tuple[str, ...]
    title: str = ""
    notes: tuple[NoteOrText, ...] = ()
    against_model: Match | None = None

    def __len__(self) -> int:
        return len(self.poles)

    @property
    def shapes(self) -> ComplexArray:
        """Mode shapes at no sensor, shape (0, n_modes): one channel has none."""
        return np.zeros((0, len(self)), dtype=complex)

    @cached_property
    def natural_frequencies(self) -> FloatArray:
        """Natural frequencies ``|lambda| / 2 pi`` of the modes found without an input in Hz, (n_modes,)."""
        return pole_numbers.natural_frequencies(self.poles)

    @cached_property
    def damping_ratios(self) -> FloatArray:
        """Damping ratios ``-Re lambda / |lambda|`` of the modes found without an input, (n_modes,)."""
        return pole_numbers.damping_ratios(self.poles)

    def only(self, modes: NDArray[np.bool_]) -> OperationalModes:
        """Copy with only some modes, those where the mask (n_modes,) is true."""
        names = ("poles", "frequency_half_widths", "damping_half_widths", "amplitudes")
        remarks = tuple(text for text, kept in zip(self.mode_remarks, modes, strict=True) if kept)
        return replace(
            self, mode_remarks=remarks, against_model=None, **{name: getattr(self, name)[modes] for name in names}
        )

    @property
    def modes(self) -> tuple[OperationalMode, ...]:
        """Modes found without an input, one for each mode, in the order of ``|lambda|``."""
        return tuple(
            OperationalMode(
                mode + 1, float(self.natural_frequencies[mode]), float(self.frequency_half_widths[mode]),
                float(self.damping_ratios[mode]), float(self.damping_half_widths[mode]),
                float(self.amplitudes[mode]), self.mode_remarks[mode],
            )
            for mode in range(len(self))
        )  # fmt: skip

    def table(self, conventions: Conventions = SI) -> Table:
        """Table with a row for each mode, its frequency and damping with half widths of their 95 % intervals."""
        title = f"{self.title}: modes by {self.method}".removeprefix(": ")
        unit = f"; amplitudes of {self.channel} in {self.unit or 'the unit of the channel'}"
        notes = (f"95 % intervals of random errors{unit}", *self.notes)
        return result_table(title, self.modes, OperationalMode, (), conventions, notes)

    def __repr__(self) -> str:
        listed = ", ".join(
            f"{f:.4g} Hz ({100 * z:.3g} %)" for f, z in zip(self.natural_frequencies, self.damping_ratios, strict=True)
        )
        return f"<OperationalModes: {listed or 'none'}>"


# Natural frequencies and damping ratios from ambient records, by stochastic subspace identification.

PYOMA_NEEDED = 'ambient records need the package pyOMA_2: pip install "torsionnet[ambient]"'
"""Message where the package of the subspace identification is not installed."""
BLOCK_ROWS = 30
"""Block rows of the Hankel matrix: some cycles of a tenth of the highest frequency."""
SAMPLES_PER_CYCLE = 3.2
"""Sampling rate over the highest frequency of interest, which leaves room for the anti-alias filter."""
SEGMENTS = 50
"""Parts of the record whose scatter gives the intervals."""
HIGHEST_ORDER = 20
"""Highest order of the model, twice the number of modes and poles of noise."""
LARGEST_DAMPING = 0.3
"""Damping ratio above which a pole is one of noise."""
SAME_FREQUENCY, SAME_DAMPING = 0.01, 0.2
"""Relative changes of frequency and damping up to which a pole is stable from one order of the model to the next."""
UNDAMPED = 0.001
"""Damping ratio below which a pole is that of a sine, and its sign is chance."""
STABLE_ORDERS = 4
"""Orders of the model at which a mode must be stable."""
SINE_KURTOSIS = -0.75
"""Excess kurtosis of a narrow band below which it holds a sine (-1.5), not a mode excited by noise (0)."""
NEAR_ORDER = 0.02
"""Relative distance of a natural frequency from that of an order at which it is named."""
FEWEST_CYCLES = 200
"""Cycles of a mode below which its damping from an ambient record is biased and scatters widely."""


@dataclass(frozen=True, eq=False)
class AmbientPoles:
    """Poles of the models of rising order of an ambient record, for a stabilisation diagram.

    Attributes
    ----------
    orders : (n,) int array
        Order of the model of each pole.
    poles : (n,) complex array
        rad/s, Im > 0.
    stable : (n,) bool array
        Whether the order before has it, too.
    """

    orders: FloatArray
    poles: ComplexArray
    stable: NDArray[np.bool_]


def modes_from_ambient(
    recording: Recording,
    channels: Sequence[str],
    *,
    up_to: float,
    orders: Sequence[float] = (),
    speeds: tuple[float, float] | None = None,
    model_order: int = HIGHEST_ORDER,
) -> OperationalModes:
    """Natural frequencies and damping ratios from a record of vibration that noise excites, with 95 % intervals.

    Covariance-driven stochastic subspace identification with intervals by M. Doehler and L. Mevel (2013), of the
    package pyOMA_2. Orders of a running machine look like lightly damped modes; such are marked.

    Parameters
    ----------
    recording : Recording
    channels : sequence of str
    up_to : float
        Highest frequency of interest, Hz.
    orders : sequence of float, optional
        Orders of the machine that runs meanwhile.
    speeds : (float, float), optional
        Lowest and highest speed meanwhile, rad/s.
    model_order : int, optional
        Highest order of the model.

    Raises
    ------
    MissingExtraError
        pyOMA_2 is not installed.
    UsageError
        Channels or frequencies do not fit the record.
    SolveError
        No mode is stable.
    """
    from scipy.signal import resample_poly

    if not channels:
        raise UsageError("name at least one channel of the ambient record", kind="wrong-count")
    if recording.times is not None:
        raise UsageError("an ambient record is read from even samples: resample it first", kind="uneven-samples")
    if not 0 < up_to < recording.sampling_rate / 2:
        raise UsageError(
            f"the highest frequency must lie between 0 and {recording.sampling_rate / 2:g} Hz", kind="out-of-range"
        )
    rows = np.stack([recording[name].values for name in channels])
    if not np.isfinite(rows).all():
        raise UsageError("the record has values that are no numbers; repair it first", kind="not-finite")
    # Thinned to some samples per cycle of the highest frequency, as the subspace spans a number of samples.
    factor = max(1, int(recording.sampling_rate / (SAMPLES_PER_CYCLE * up_to)))
    rows = rows - rows.mean(axis=1, keepdims=True)
    thinned = resample_poly(rows, 1, factor, axis=1) if factor > 1 else rows
    step = factor / recording.sampling_rate
    # Channels of unlike units and sizes count alike.
    scaled = thinned / np.maximum(thinned.std(axis=1, keepdims=True), np.finfo(float).tiny)
    by_order = _subspace(scaled, step, model_order)
    evidence, poles, errors = _stable(*by_order, up_to)
    if not len(poles):
        raise SolveError("no mode is stable: record longer, or give a higher order of the model", kind="no-resonance")
    told = [_remark(pole, scaled, step, tuple(orders), speeds, recording.duration) for pole in poles]
    remarks = tuple(remark for remark, _ in told)
    notes: list[NoteOrText] = [f"{recording.duration:.4g} s at {1 / step:.4g} Hz, model orders up to {model_order}"]
    notes.append("the excitation is taken for white noise; orders of a running machine are none")
    if any(may_be_order for _, may_be_order in told):
        notes.append(warning("some of these are orders of the machine rather than modes: see the remarks"))
    frequencies, zeta = NORMAL_95 * errors[0], NORMAL_95 * errors[1]
    name, unit = ", ".join(channels), recording[channels[0]].unit if len(channels) == 1 else ""
    return OperationalModes(
        poles, frequencies, zeta, np.full(len(poles), np.nan), name, unit, "ambient record (stochastic subspace)",
        evidence, remarks, recording.title, tuple(notes),
    )  # fmt: skip


def _package() -> Any:
    """Module of pyOMA_2 for stochastic subspaces, whose import leaves numpy's warnings and the log as they were."""
    kept = np.geterr()
    try:
        module = importlib.import_module("pyoma2.functions.ssi")
    except ImportError as error:
        raise MissingExtraError(PYOMA_NEEDED) from error
    finally:
        np.seterr(**kept)
    logging.getLogger("pyoma2").setLevel(logging.WARNING)
    return module


def _subspace(rows: FloatArray, step: float, highest: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Frequencies in Hz, damping ratios and their standard errors, (n, n_orders), NaN where an order has fewer."""
    ssi = _package()
    if rows.shape[1] < SEGMENTS * 2 * BLOCK_ROWS:
        needed = SEGMENTS * 2 * BLOCK_ROWS * step
        raise SolveError(
            f"{rows.shape[1] * step:.3g} s are too short for an ambient record: take {needed:.3g} s or more",
            kind="too-short",
        )
    highest = min(highest, BLOCK_ROWS * len(rows) - len(rows))
    with contextlib.redirect_stderr(io.StringIO()), np.errstate(all="ignore"):  # its bars of progress
        hankel, spread = ssi.build_hank(rows, rows, BLOCK_ROWS, "cov", calc_unc=True, nb=SEGMENTS)
        observed, states, outputs, _ = ssi.SSI_fast(hankel, BLOCK_ROWS, highest)
        of_orders = ssi.SSI_poles(
            observed, states, outputs, highest, step, HC=False, calc_unc=True, H=hankel, T=spread
        )  # fmt: skip
    return of_orders[0], of_orders[1], of_orders[4], of_orders[5]


def _stable(
    frequencies: FloatArray, damping: FloatArray, frequency_errors: FloatArray, damping_errors: FloatArray, top: float
) -> tuple[AmbientPoles, ComplexArray, FloatArray]:
    """All poles, those of the modes (rad/s) and the standard errors of their frequencies (Hz) and damping ratios."""
    listed: list[tuple[int, float, float, float, float, bool]] = []
    before: list[tuple[float, float]] = []
    for order in range(2, frequencies.shape[1], 2):
        here: list[tuple[float, float]] = []
        for place in range(frequencies.shape[0]):
            f, zeta = frequencies[place, order], damping[place, order]
            if not (0 < f <= top and -UNDAMPED < zeta < LARGEST_DAMPING) or any(abs(f - g) < 1e-9 * f for g, _ in here):
                continue
            here.append((f, zeta))
            same = any(
                abs(f / g - 1) < SAME_FREQUENCY and abs(zeta - z) < max(SAME_DAMPING * abs(z), UNDAMPED)
                for g, z in before
            )
            listed.append((order, f, zeta, frequency_errors[place, order], damping_errors[place, order], same))
        before = here
    table = np.array([row[:5] for row in listed]).reshape(-1, 5)
    stable = np.array([row[5] for row in listed], dtype=bool)
    evidence = AmbientPoles(table[:, 0], _poles(table[:, 1], table[:, 2]), stable)
    # Of the poles of a mode over the orders, that of the smallest error of damping.
    chosen = [group[np.argsort(group[:, 4])[0]] for group in _groups(table[stable]) if len(group) >= STABLE_ORDERS]
    modes = np.array(chosen).reshape(-1, 5)
    return evidence, _poles(modes[:, 1], modes[:, 2]), modes[:, 3:].T


def _groups(rows: FloatArray) -> list[FloatArray]:
    """Poles of about one frequency, rows of order, frequency, damping ratio and errors."""
    rising = rows[np.argsort(rows[:, 1], kind="stable")]
    if not len(rising):
        return []
    breaks = np.flatnonzero(np.diff(rising[:, 1]) > SAME_FREQUENCY * rising[1:, 1]) + 1
    return np.split(rising, breaks)


def _poles(frequencies: FloatArray, damping: FloatArray) -> ComplexArray:
    return np.asarray(2 * np.pi * frequencies * (-damping + 1j * np.sqrt(1 - damping**2)))


def _remark(
    pole: complex,
    rows: FloatArray,
    step: float,
    orders: tuple[float, ...],
    speeds: tuple[float, float] | None,
    length: float,
) -> tuple[str, bool]:
    """Remark on a pole, and whether it may be an order of the machine."""
    frequency = abs(pole) / (2 * np.pi)
    remarks = []
    if speeds is not None:
        low, high = np.array(speeds) / (2 * np.pi)
        near = [o for o in orders if low * o * (1 - NEAR_ORDER) <= frequency <= high * o * (1 + NEAR_ORDER)]
        remarks += [f"at order {near[0]:g}: it may be no mode"] if near else []
    if _kurtosis(rows, step, frequency) < SINE_KURTOSIS:
        remarks.append("vibrates as a sine, not as noise: an order rather than a mode")
    may_be_order = bool(remarks)
    if frequency * length < FEWEST_CYCLES:
        remarks.append(f"only {frequency * length:.0f} cycles: record longer")
    return "; ".join(remarks), may_be_order


def _kurtosis(rows: FloatArray, step: float, frequency: float) -> float:
    """Smallest excess kurtosis of the channels in a narrow band about a frequency in Hz."""
    from scipy.stats import kurtosis

    lines = np.fft.rfftfreq(rows.shape[1], step)
    # The excess kurtosis is -1.5 of a sine, 0 of Gaussian noise.
    narrow = np.fft.rfft(rows, axis=1) * (np.abs(lines / frequency - 1) < NEAR_ORDER)
    return float(np.min(kurtosis(np.fft.irfft(narrow, rows.shape[1], axis=1), axis=1)))
