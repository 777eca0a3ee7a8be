"""Natural frequencies and damping ratios found without a measured input, with 95 % intervals."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

import torsionnet.modal.matrix_fraction as pole_numbers
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.notes import NoteOrText
from torsionnet.base.packages import SavedResult, one_of
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.linear.frequency_response import Channel
from torsionnet.modal.matching import Match
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray

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
