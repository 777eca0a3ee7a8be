"""Result of an identification of modes, with poles, residues, shapes, standard errors and tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

import torsionnet.modal.matrix_fraction as pole_numbers
from torsionnet.base.conventions import MODE_KIND, SI, Conventions
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.base.packages import UNSAVED, SavedResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table, result_table
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.modal.matching import Match, mpc
from torsionnet.modal.residues import Expansion
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray, Lines, powers_of


@dataclass(frozen=True, eq=False)
class IdentifiedMode:
    """Identified mode with natural frequency (Hz), damping ratio, their standard errors, pole and shape by sensor."""

    mode: Annotated[int, Out("mode")]
    kind: Annotated[str, Out("kind", schema=MODE_KIND)]
    natural_frequency: Annotated[float, Out("natural frequency |lambda|/2pi", "Hz", "natural_frequency_Hz")]
    frequency_error: Annotated[float, Out("+-", "Hz", "standard_error_Hz", digits=2)]
    damping_ratio: Annotated[float, Out("damping ratio", "1")]
    damping_error: Annotated[float, Out("+-", "1", "standard_error", digits=2)]
    pole: Annotated[complex, Out(json="pole_rad_per_s")]
    shape: Mapping[str, complex]
    damped_frequency: Annotated[float, Out("damped frequency Im lambda/2pi", "Hz", None)]
    collinearity: Annotated[float, Out("MPC", "1", None, digits=4)]
    contribution: Annotated[float, Out("contribution", "1", None, digits=3)]


IDENTIFIED_COLUMNS = (
    "mode", "natural_frequency", "frequency_error", "damped_frequency", "damping_ratio", "damping_error", "kind",
    "collinearity", "contribution",
)  # fmt: skip


@dataclass(frozen=True, eq=False, repr=False)
class ModalEstimate(SavedResult):
    """Modes identified from frequency responses, one for each conjugate pair or real pole, sorted by ``|lambda|``.

    Attributes
    ----------
    poles : (n_modes,) complex array
        lambda in rad/s, Im >= 0.
    residues : (n_modes, n_out, n_in) complex array
        R of the receptance form: ``H = s^p (sum R / (s - lambda) + conjugate + lower / s^2 + upper)``, where p turns
        angles into the quantities measured (1 for velocities, 2 for accelerations).
    lower, upper : (n_out, n_in) arrays
        Residual terms for what is below and above the band.
    outputs, inputs : tuple of Channel
        Channels as measured.
    frequencies : (n_f,) array
        Frequencies of the lines of the fit, Hz.
    contributions : (n_modes,) array
        Root mean square of the contribution of each mode, over that of the responses.
    misfit : (n_out, n_in) array
        Root mean square of the residual of the fit, over that of the response.
    frequency_errors, damping_errors : (n_modes,) arrays
        Standard errors, Hz and 1; nan where none is known. Random errors only.
    method : str
    title : str
    notes : tuple of str or Note
        Remarks; those to heed are of severity warning.
    by_record : bool
        Whether the fit is to the record behind the estimate, in which no window widens a peak.
    outside_poles : (n,) complex array
        Poles outside the band, rad/s, which stand for what is beyond it and are no modes; in ``response``.
    outside_residues : (n, n_out, n_in) complex array
    against_model : Match or None
        Modes of a model that these were compared with, to be shown beside them.

    See Also
    --------
    torsionnet.modal.identify_modes
    """

    SHOWN: ClassVar = ("title", "method", "notes", "modes", "against_model.pairs")

    poles: ComplexArray
    residues: ComplexArray
    lower: FloatArray
    upper: FloatArray
    outputs: tuple[Channel, ...]
    inputs: tuple[Channel, ...]
    frequencies: FloatArray
    contributions: FloatArray
    misfit: FloatArray
    frequency_errors: FloatArray
    damping_errors: FloatArray
    method: str
    title: str = ""
    notes: tuple[NoteOrText, ...] = ()
    by_record: bool = False
    outside_poles: ComplexArray = field(default_factory=lambda: np.zeros(0, dtype=complex))
    outside_residues: ComplexArray = field(default_factory=lambda: np.zeros((0, 1, 1), dtype=complex))
    against_model: Match | None = field(default=None, metadata=UNSAVED)

    def __len__(self) -> int:
        return len(self.poles)

    @cached_property
    def natural_frequencies(self) -> FloatArray:
        """Natural frequencies ``|lambda| / 2 pi`` of the identified modes in Hz, (n_modes,)."""
        return pole_numbers.natural_frequencies(self.poles)

    @cached_property
    def damped_frequencies(self) -> FloatArray:
        """Damped frequencies ``Im lambda / 2 pi`` of the identified modes in Hz, (n_modes,), 0 for real poles."""
        return np.asarray(self.poles.imag / (2 * np.pi))

    @cached_property
    def damping_ratios(self) -> FloatArray:
        """Damping ratios ``-Re lambda / |lambda|`` of the identified modes, (n_modes,), 1 for a real pole."""
        return pole_numbers.damping_ratios(self.poles)

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kind of each identified mode, ``"oscillatory"`` or ``"real pole"``, as of :class:`torsionnet.Modes`."""
        return pole_numbers.kinds(self.poles)

    @property
    def shapes(self) -> ComplexArray:
        """Mode shapes (n_out, n_modes), angles at the sensors over the largest, and torques in N m for that angle.

        Each is the best shape of rank one in the residues of all inputs.
        """
        moving = np.array([channel.unit != "N*m" for channel in self.outputs])
        shapes = np.zeros((len(self.outputs), len(self)), dtype=complex)
        for mode, residue in enumerate(self.residues):
            # The residues are shape times participation: all inputs alike in size, their common direction by the SVD.
            size = np.linalg.norm(residue, axis=0)
            left = np.linalg.svd(residue / np.where(size > 0, size, 1))[0][:, 0]
            # 1 where the shaft moves most; a torque's number would depend on its unit.
            among = np.where(moving, np.abs(left), 0) if moving.any() else np.abs(left)
            shapes[:, mode] = left / left[int(among.argmax())]
        return shapes

    def shape_at(self, output: str) -> ComplexArray:
        """Angle (or torque in N m) of all mode shapes at one sensor, complex, (n_modes,)."""
        names = [channel.name for channel in self.outputs]
        if output not in names:
            raise UsageError(
                f'no output is named "{output}"{did_you_mean(output, names)}; there is {", ".join(names)}',
                kind="unknown-name",
            )
        return np.asarray(self.shapes[names.index(output)])

    def response(self, frequencies: FloatArray) -> FrequencyResponse:
        """Frequency response of the identified modes and residual terms at frequencies (n_f,) in Hz."""
        f = np.asarray(frequencies, dtype=float)
        poles = np.concatenate([self.poles, self.outside_poles])
        residues = np.concatenate([self.residues, self.outside_residues]) if len(self.outside_poles) else self.residues
        expansion = Expansion(poles, residues, self.lower, self.upper)
        values = expansion.values(2j * np.pi * f, powers_of(self.outputs, self.inputs))
        return FrequencyResponse(f, values, self.outputs, self.inputs, f"{self.title}, {self.method}")

    @cached_property
    def synthesised(self) -> FrequencyResponse:
        """Frequency response of the identified modes and residual terms at the lines they were fitted to."""
        return self.response(self.frequencies)

    def only(self, modes: NDArray[np.bool_]) -> ModalEstimate:
        """Copy of the estimate with only some modes, those where the mask (n_modes,) is true."""
        names = ("poles", "residues", "contributions", "frequency_errors", "damping_errors")
        return replace(self, against_model=None, **{name: getattr(self, name)[modes] for name in names})

    def within_band(self) -> ModalEstimate:
        """Copy of the estimate whose modes are the poles in the band of its lines; the others are ``outside_poles``."""
        low, high = self.frequencies[[0, -1]]
        inside = (self.natural_frequencies >= low) & (self.natural_frequencies <= high)
        return replace(self.only(inside), outside_poles=self.poles[~inside], outside_residues=self.residues[~inside])

    def table(self, conventions: Conventions = SI) -> Table:
        """Table with a row for each mode, its frequency and damping with standard errors, MPC, and contribution."""
        title = f"{self.title}: modes by {self.method}"
        return result_table(
            title, self.modes, IdentifiedMode, IDENTIFIED_COLUMNS, conventions, tuple(map(str, self.notes))
        )

    @property
    def modes(self) -> tuple[IdentifiedMode, ...]:
        """Identified modes, one for each mode, in the order of ``|lambda|``."""
        names = [channel.name for channel in self.outputs]
        collinear = mpc(self.shapes)
        return tuple(
            IdentifiedMode(
                mode + 1, self.kinds[mode], float(self.natural_frequencies[mode]), float(self.frequency_errors[mode]),
                float(self.damping_ratios[mode]), float(self.damping_errors[mode]), complex(self.poles[mode]),
                dict(zip(names, self.shapes[:, mode].tolist(), strict=True)), float(self.damped_frequencies[mode]),
                float(collinear[mode]), float(self.contributions[mode]),
            )
            for mode in range(len(self))
        )  # fmt: skip

    def shape_table(self) -> Table:
        """Table with a row for each sensor, magnitude and phase (degrees) of every mode shape there."""
        columns = [Column("sensor")]
        for mode in range(len(self)):
            columns += [Column(f"|shape {mode + 1}|"), Column(f"phase {mode + 1}", "deg")]
        rows = []
        for channel, row in zip(self.outputs, self.shapes, strict=True):
            cells = [cell for value in row for cell in (float(abs(value)), float(np.degrees(np.angle(value))))]
            rows.append((channel.name, *cells))
        return Table(f"{self.title}: shapes", tuple(columns), tuple(rows), ("1 at the sensor that moves most",))

    def to_csv(self, path: str | Path | None = None, conventions: Conventions = SI) -> str:
        """Table of the identified modes as CSV text, also written to ``path``."""
        return self.table(conventions).to_csv(path)

    def __repr__(self) -> str:
        listed = ", ".join(
            f"{f:.4g} Hz ({100 * z:.3g} %)"
            for f, z in zip(self.natural_frequencies[:6], self.damping_ratios[:6], strict=True)
        )
        more = ", ..." if len(self) > 6 else ""
        return f"<ModalEstimate: {len(self)} modes at {listed}{more}>"


def estimate_from_expansion(
    response: FrequencyResponse,
    lines: Lines,
    expansion: Expansion,
    notes: tuple[NoteOrText, ...],
    method: str = "",
) -> ModalEstimate:
    """Modal estimate from an expansion fitted to the lines of a response, with contributions and misfit."""
    modes = range(len(expansion.poles))
    factor = lines.s[:, None, None] ** lines.powers * lines.balance
    # Contribution of a mode: root mean square of its term over the lines, in balanced units.
    shares = [np.sqrt(np.mean(np.abs(expansion.term(mode, lines.s) * factor) ** 2)) for mode in modes]
    left = lines.values - expansion.values(lines.s, lines.powers)
    unknown = np.full(len(modes), np.nan)
    return ModalEstimate(
        expansion.poles,
        expansion.residues,
        expansion.lower,
        expansion.upper,
        response.outputs,
        response.inputs,
        np.asarray(np.abs(lines.s) / (2 * np.pi)),
        np.array(shares),
        np.sqrt(np.mean(np.abs(left) ** 2, axis=0)) * lines.balance,
        unknown,
        unknown,
        method,
        response.title,
        notes,
    )


# Warnings about identified modes that are outside the band, uncertain, computational, too narrow or badly fitted.

FEWEST_PEAK_LINES = 3
"""Number of lines within a half-power bandwidth below which a warning is given, as a window may have widened the
peak."""
FAR_OUTSIDE_BAND = 2.0
"""Ratio of a natural frequency to an end of the band beyond which a pole stands for residual terms, not for a mode."""
LARGEST_MISFIT = 0.1
"""RMS residual of a fit of modes over RMS of the response above which a warning is given, as modes may be missing."""
LARGEST_ERROR = 0.1
"""Standard error over its value above which a warning calls a natural frequency or damping ratio uncertain."""
FEWEST_ORDERS = 2
"""Fewest orders of a stabilisation diagram at which a pole must be found, as fewer may be a computational pole."""


def about_fit(estimate: ModalEstimate, seen: Sequence[int] = (), orders: int = 0) -> tuple[NoteOrText, ...]:
    """Warnings about modes outside the band, uncertain, computational or narrow, and about a large misfit of a fit."""
    narrow = () if estimate.by_record else _notes_on_narrow_peaks(estimate)
    remarks = [*_notes_beyond_the_band(estimate), *_uncertain(estimate), *_rare(estimate, seen, orders), *narrow]
    worst = float(np.max(estimate.misfit))
    if worst > LARGEST_MISFIT:
        remarks.append(warning(f"the fit leaves {worst:.0%} of a response over; more orders or another band may help"))
    return tuple(remarks)


def line_spacing(frequencies: FloatArray, near: float) -> float:
    """Spacing in Hz of the two lines of a response around a frequency in Hz."""
    if len(frequencies) < 2:
        return float("nan")
    place = int(np.clip(np.searchsorted(frequencies, near), 1, len(frequencies) - 1))
    return float(frequencies[place] - frequencies[place - 1])


def _places(estimate: ModalEstimate, chosen: Sequence[int]) -> str:
    names = [
        f"{estimate.natural_frequencies[mode]:.4g} Hz" + ("" if estimate.poles[mode].imag else " (real pole)")
        for mode in chosen
    ]
    return ", ".join(names)


def _notes_beyond_the_band(estimate: ModalEstimate) -> Iterator[NoteOrText]:
    low, high = estimate.frequencies[[0, -1]]
    count = len(estimate.outside_poles)
    if count:
        yield (
            f"{count} pole{'s' * (count > 1)} outside the band of {low:g} to {high:g} Hz "
            f"stand{'s' * (count == 1)} for what is beyond it and {'are' if count > 1 else 'is'} not listed"
        )
    f = estimate.natural_frequencies
    outside = [
        mode for mode in range(len(estimate)) if not low / FAR_OUTSIDE_BAND <= f[mode] <= high * FAR_OUTSIDE_BAND
    ]
    if outside:
        yield (
            warning(
                f"far outside the band of {low:g} to {high:g} Hz: {_places(estimate, outside)}; it stands for "
                "what is beyond the band rather than for a mode"
            )
        )


def _uncertain(estimate: ModalEstimate) -> Iterator[NoteOrText]:
    f, z = estimate.natural_frequencies, estimate.damping_ratios
    large = (estimate.frequency_errors > LARGEST_ERROR * f) | (estimate.damping_errors > LARGEST_ERROR * z)
    if large.any():
        yield warning(f"standard error above {LARGEST_ERROR:.0%} at {_places(estimate, list(np.flatnonzero(large)))}")


def _rare(estimate: ModalEstimate, seen: Sequence[int], orders: int) -> Iterator[NoteOrText]:
    rare = [mode for mode, count in enumerate(seen) if count < FEWEST_ORDERS] if len(seen) == len(estimate) else []
    if rare and orders > FEWEST_ORDERS:
        yield warning(f"seen at one order of {orders} only, perhaps computational: {_places(estimate, rare)}")


def _notes_on_narrow_peaks(estimate: ModalEstimate) -> Iterator[NoteOrText]:
    narrow = [
        mode
        for mode, pole in enumerate(estimate.poles)
        if pole.imag
        and -pole.real / np.pi
        < FEWEST_PEAK_LINES * line_spacing(estimate.frequencies, estimate.natural_frequencies[mode])
    ]
    if narrow:
        yield (
            warning(
                f"half-power bandwidth under {FEWEST_PEAK_LINES} lines at {_places(estimate, narrow)}: if a "
                "window was used, its damping reads high; use longer segments"
            )
        )
