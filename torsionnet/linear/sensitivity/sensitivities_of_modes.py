"""Derivatives of natural frequencies and damping ratios of modes with respect to parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from torsionnet.base.conventions import MODE_NUMBER, RIGID, counting_notes
from torsionnet.base.errors import UsageError
from torsionnet.base.packages import SavedResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.transfer_request import resolve_inputs
from torsionnet.linear.modes.natural_modes import modes_against
from torsionnet.linear.sensitivity.pole_slopes import ResponsesAroundPoles, clearance
from torsionnet.linear.sensitivity.unknowns import unknowns
from torsionnet.model.channels import Sensor
from torsionnet.model.operating_values import operating_speed_notes

REPEATED_POLE_DISTANCE = 1e-6
"""Relative distance below which poles count as one repeated pole, so that rounding does not split them."""
NAMED_EFFECT = 0.05
"""Change of a mode in percent per percent of a parameter above which a sentence names the parameter."""


@dataclass(frozen=True)
class ModeEffect:
    """Effect of one parameter on one mode's frequency and damping ratio, in % per % and per SI unit."""

    mode: Annotated[int | None, Out("mode")]
    natural_frequency: Annotated[float, Out("natural frequency", "Hz", digits=5)]
    damping_ratio: Annotated[float, Out("damping ratio", "1", digits=4)]
    parameter: Annotated[str, Out("parameter")]
    frequency: Annotated[float, Out("frequency", "% per %", digits=3)]
    damping: Annotated[float, Out("damping", "% per %", digits=3)]
    d_frequency: Annotated[float, Out("d frequency", "Hz per SI unit", digits=4)]
    d_damping: Annotated[float, Out("d damping", "per SI unit", digits=4)]


@dataclass(frozen=True, eq=False)
class ModeSlopes:
    """Effects (n_p,) of all parameters on one mode's frequency and damping ratio, in % per % and per SI unit."""

    mode: Annotated[int | None, Out(schema=MODE_NUMBER)]
    natural_frequency: Annotated[float, Out(json="natural_frequency_Hz")]
    damping_ratio: float
    frequency: Annotated[FloatArray, Out(json="frequency_percent_per_percent")]
    damping: Annotated[FloatArray, Out(json="damping_percent_per_percent")]
    d_frequency: FloatArray
    d_damping: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class ModeSensitivities(SavedResult):
    """Derivatives of poles, natural frequencies and damping ratios of a drivetrain with respect to parameters.

    Attributes
    ----------
    parameters : tuple of str
    values : (n_p,) array
        SI.
    poles : (n_modes,) complex array
        rad/s; rigid-body modes are left out.
    pole_slopes : (n_modes, n_p) complex array
        d lambda / dp; nan where two poles meet at critical damping, and move with the root of a change.
    title : str
    numbers : tuple of int or None
        Of the modes, as :class:`~torsionnet.Modes` has them; real poles have none.
    notes : tuple of str
        On the operating point at which they hold.
    """

    picture: ClassVar[str] = "tornado"
    SHOWN: ClassVar = ("title", "parameters", "values", "modes", "remarks")

    parameters: tuple[str, ...]
    values: FloatArray
    poles: ComplexArray
    pole_slopes: ComplexArray
    title: str = ""
    numbers: tuple[int | None, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def natural_frequencies(self) -> FloatArray:
        """Natural frequencies ``|lambda| / 2 pi`` in Hz, shape (n_modes,)."""
        return np.asarray(np.abs(self.poles) / (2 * np.pi))

    @property
    def damping_ratios(self) -> FloatArray:
        """Damping ratios ``-Re lambda / |lambda|``, shape (n_modes,)."""
        return np.asarray(0.0 - self.poles.real / np.abs(self.poles))

    @property
    def frequency_slopes(self) -> FloatArray:
        """Derivatives of natural frequencies in Hz per SI unit of the parameter, shape (n_modes, n_p)."""
        return np.asarray(self._size_slopes / (2 * np.pi))

    @property
    def damping_slopes(self) -> FloatArray:
        """Derivatives of damping ratios per SI unit of the parameter, shape (n_modes, n_p), 0 for real poles."""
        size = np.abs(self.poles)[:, None]
        # d zeta = -Re d lambda / |lambda| + Re lambda d|lambda| / |lambda|^2
        moved = -self.pole_slopes.real / size + self.poles.real[:, None] * self._size_slopes / size**2
        return np.asarray(np.where(self.poles.imag[:, None] == 0, 0.0, moved))

    @property
    def _size_slopes(self) -> FloatArray:
        return np.asarray((self.poles.conj()[:, None] * self.pole_slopes).real / np.abs(self.poles)[:, None])

    @property
    def relative_frequencies(self) -> FloatArray:
        """Percent of natural frequency per percent of parameter, shape (n_modes, n_p)."""
        return np.asarray(self.frequency_slopes * self.values / self.natural_frequencies[:, None])

    @property
    def relative_dampings(self) -> FloatArray:
        """Percent of damping ratio per percent of parameter, shape (n_modes, n_p)."""
        ratios = self.damping_ratios[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            relative = self.damping_slopes * self.values / ratios
        return np.asarray(np.where(np.abs(ratios) > 0, relative, 0.0))

    def number(self, place: int) -> int | None:
        """Number of the mode at this index, counted from 1, or None for a real pole."""
        return self.numbers[place] if self.numbers else place + 1

    def name(self, place: int) -> str:
        """Name of the mode at this index, such as "mode 1", or "real pole".

        >>> import torsionnet as tn
        >>> mode_sensitivities(tn.load("dmf_rig"), ["k_2"]).name(0)
        'mode 1'
        """
        number = self.number(place)
        return "real pole" if number is None else f"mode {number}"

    def words(self, most: int = 3) -> tuple[str, ...]:
        """Sentences, one per mode, that name the ``most`` parameters which change the mode most."""
        sentences = []
        for mode, (f, z) in enumerate(zip(self.natural_frequencies, self.damping_ratios, strict=True)):
            if np.isnan(self.pole_slopes[mode]).any():
                sentences.append(
                    f"{self.name(mode)} ({f:.4g} Hz): two poles meet (critical damping) and have no derivative"
                )
                continue
            kind = "" if self.number(mode) is None else f", {100 * z:.3g} % damping"
            parts = [
                f"{what} by {_strongest(relative[mode], self.parameters, most)}"
                for what, relative in (("frequency", self.relative_frequencies), ("damping", self.relative_dampings))
                if np.abs(relative[mode]).max(initial=0.0) > NAMED_EFFECT
            ]
            sentences.append(
                f"{self.name(mode)} ({f:.4g} Hz{kind}): {'; '.join(parts) or 'hardly moved by any of these'}"
            )
        return tuple(sentences)

    def table(self) -> Table:
        """Table of effects with a row for each mode and parameter, in % per % and per SI unit."""
        rows = [row for mode in range(len(self.poles)) for row in self.rows(mode)]
        notes = (*self.words(), *counting_notes(self.numbers), *self.notes)
        return result_table(f"{self.title}: what moves the modes", rows, ModeEffect, notes=notes)

    def rows(self, mode: int) -> list[ModeEffect]:
        """Effects of all parameters, one by one, on the mode at this index."""
        about = self.number(mode), float(self.natural_frequencies[mode]), float(self.damping_ratios[mode])
        effects = [
            self.relative_frequencies[mode], self.relative_dampings[mode],
            self.frequency_slopes[mode], self.damping_slopes[mode],
        ]  # fmt: skip
        return [
            ModeEffect(*about, name, *numbers)
            for name, numbers in zip(self.parameters, np.stack(effects, axis=1).tolist(), strict=True)
        ]

    @property
    def modes(self) -> tuple[ModeSlopes, ...]:
        """Effects of all parameters on each mode."""
        return tuple(
            ModeSlopes(
                self.number(mode), float(self.natural_frequencies[mode]), float(self.damping_ratios[mode]),
                self.relative_frequencies[mode], self.relative_dampings[mode],
                self.frequency_slopes[mode], self.damping_slopes[mode],
            )
            for mode in range(len(self.poles))
        )  # fmt: skip

    @property
    def remarks(self) -> Annotated[tuple[str, ...], Out(json="words")]:
        """Sentences on what moves each mode, and the notes."""
        return (*self.words(), *self.notes)


def _strongest(relative: FloatArray, names: Sequence[str], most: int) -> str:
    order = np.argsort(-np.abs(relative))[:most]
    return ", ".join(f"{names[p]} ({relative[p]:+.2g})" for p in order if abs(relative[p]) > NAMED_EFFECT)


def mode_sensitivities(
    drivetrain: AssembledModel,
    parameters: Sequence[str] | None = None,
    *,
    measured_input: str | Sensor | None = None,
    driven_by: str | None = None,
) -> ModeSensitivities:
    """Derivatives (n_modes, n_p) of all poles, natural frequencies and damping ratios with respect to parameters.

    Parameters
    ----------
    drivetrain : Drivetrain
        Modes and derivatives are those of its present values.
    parameters : sequence of str, optional
        Names of parameters or ``element.field``; by default every parameter that does not follow from others.
    measured_input : str or Sensor, optional
        The poles of responses against this sensor instead.
    driven_by : str, optional
        What drives the drivetrain then.

    Raises
    ------
    UsageError
        An unknown name, or equal poles of a drivetrain with a spring tabulated over frequency.

    Examples
    --------
    >>> import torsionnet as tn
    >>> slopes = mode_sensitivities(tn.load("dmf_rig"), ["k_2", "c_2"])
    >>> slopes.relative_frequencies[0].round(3).tolist()
    [0.498, 0.001]
    """
    names = list(parameters) if parameters is not None else _basic(drivetrain)
    chosen = unknowns(drivetrain, names)
    request = None if measured_input is None else resolve_inputs(drivetrain, measured_input, driven_by)
    modes = modes_against(drivetrain, request)
    # A rigid-body pole stays at zero whatever the parameters are.
    kept = [place for place, kind in enumerate(modes.kinds) if kind != RIGID]
    numbers = tuple(modes.numbers[place] for place in kept)
    poles = np.array([modes.eigenvalues[place] for place in kept], dtype=complex)
    slopes = np.zeros((len(poles), len(names)), dtype=complex)
    system = ResponsesAroundPoles.of(drivetrain, chosen, request)
    places = [modes.nodes.index(node) for node in system.nodes]
    shapes = modes.shapes[places][:, kept]
    # Equal poles part in directions that a parameter chooses, so that they share one circle.
    for group in _groups(poles):
        slopes[group] = system.slopes(poles[group], shapes[:, group], clearance(poles, group))
    notes = (*modes.notes, *operating_speed_notes(drivetrain.external_torques))
    return ModeSensitivities(tuple(names), np.array(chosen.start), poles, slopes, modes.title, numbers, notes)


def _basic(drivetrain: AssembledModel) -> list[str]:
    basic = [name for name, parameter in drivetrain.parameter_definitions.items() if not parameter.value.names]
    if not basic:
        raise UsageError(
            f"{drivetrain.name} has no parameters; name numbers of elements, such as shaft.stiffness",
            kind="missing-entry",
        )
    return basic


def _groups(poles: ComplexArray) -> list[list[int]]:
    """Groups of indices of poles that are equal within rounding."""
    groups: list[list[int]] = []
    for place, pole in enumerate(poles):
        near = [group for group in groups if abs(poles[group[0]] - pole) < REPEATED_POLE_DISTANCE * abs(pole)]
        if near:
            near[0].append(place)
        else:
            groups.append([place])
    return groups
