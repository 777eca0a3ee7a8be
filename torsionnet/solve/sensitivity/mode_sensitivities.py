"""Derivatives of natural frequencies and damping ratios to parameters.

A pole makes the matrix of the equations singular, K(s) r = 0 and l K(s) = 0. Differentiating along a parameter gives

    d lambda = - (l dK r) / (l dK/ds r)

also for complex modes of any damping. Of a repeated pole the derivatives are the eigenvalues of the small pencil of all
its vectors: it parts in the directions that the parameter chooses. Against a measured input the torque that drives and
the reading that must vanish join the equations. (Nelson 1976 and Lancaster 1964 have the formulas.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.core.errors import UsageError
from torsionnet.model.channels import Input, Sensor
from torsionnet.response import Column, Table
from torsionnet.solve.modes import modes_against
from torsionnet.solve.sensitivity.augmented import Augmented, augmented
from torsionnet.solve.sensitivity.forms import equation_rate, equation_slopes, reading_rate, reading_slopes
from torsionnet.solve.sensitivity.sensor_derivatives import (
    ReadingDerivative,
    derivative_of,
    reading_on_duals,
    rows_of,
)
from torsionnet.solve.sensitivity.unknowns import Unknowns, unknowns
from torsionnet.solve.transfer_request import TransferRequest, driven

SAME = 1e-6
"""Poles closer than this share of their size count as repeated."""
STRONG = 0.05
DEFECTIVE = 1e-5
"""Equal poles with fewer vectors than poles leave a singular value above this, where entries are of the order of 1."""


@dataclass(frozen=True, eq=False)
class ModeSensitivities:
    """How poles move with parameters.

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
    numbers : tuple of int
        Of the modes, as :class:`~torsionnet.response.Modes` has them: rigid-body modes count.
    """

    parameters: tuple[str, ...]
    values: FloatArray
    poles: ComplexArray
    pole_slopes: ComplexArray
    title: str = ""
    numbers: tuple[int, ...] = ()

    @property
    def natural_frequencies(self) -> FloatArray:
        """``|lambda| / 2 pi``, Hz."""
        return np.asarray(np.abs(self.poles) / (2 * np.pi))

    @property
    def damping_ratios(self) -> FloatArray:
        """``-Re lambda / |lambda|``."""
        return np.asarray(0.0 - self.poles.real / np.abs(self.poles))

    @property
    def frequency_slopes(self) -> FloatArray:
        """(n_modes, n_p), Hz per SI unit of the parameter."""
        return np.asarray(self._size_slopes / (2 * np.pi))

    @property
    def damping_slopes(self) -> FloatArray:
        """(n_modes, n_p), per SI unit of the parameter; 0 for real poles, whose ratio stays 1."""
        size = np.abs(self.poles)[:, None]
        moved = -self.pole_slopes.real / size + self.poles.real[:, None] * self._size_slopes / size**2
        return np.asarray(np.where(self.poles.imag[:, None] == 0, 0.0, moved))

    @property
    def _size_slopes(self) -> FloatArray:
        return np.asarray((self.poles.conj()[:, None] * self.pole_slopes).real / np.abs(self.poles)[:, None])

    @property
    def relative_frequencies(self) -> FloatArray:
        """(n_modes, n_p): percent of natural frequency per percent of parameter."""
        return np.asarray(self.frequency_slopes * self.values / self.natural_frequencies[:, None])

    @property
    def relative_dampings(self) -> FloatArray:
        """(n_modes, n_p): percent of damping ratio per percent of parameter."""
        ratios = self.damping_ratios[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            found = self.damping_slopes * self.values / ratios
        return np.asarray(np.where(np.abs(ratios) > 0, found, 0.0))

    def number(self, index: int) -> int:
        """Of the mode at this place."""
        return self.numbers[index] if self.numbers else index + 1

    def words(self, most: int = 3) -> tuple[str, ...]:
        """Of every mode, the parameters that move it most."""
        found = []
        for mode, (f, z) in enumerate(zip(self.natural_frequencies, self.damping_ratios, strict=True)):
            if np.isnan(self.pole_slopes[mode]).any():
                found.append(
                    f"mode {self.number(mode)} ({f:.4g} Hz): two poles meet (critical damping) and have no derivative"
                )
                continue
            kind = "real pole" if self.poles[mode].imag == 0 else f"{100 * z:.3g} % damping"
            parts = [
                f"{what} by {_strongest(relative[mode], self.parameters, most)}"
                for what, relative in (("frequency", self.relative_frequencies), ("damping", self.relative_dampings))
                if np.abs(relative[mode]).max(initial=0.0) > STRONG
            ]
            found.append(
                f"mode {self.number(mode)} ({f:.4g} Hz, {kind}): {'; '.join(parts) or 'hardly moved by any of these'}"
            )
        return tuple(found)

    def table(self) -> Table:
        """A row for each mode and parameter."""
        columns = (
            Column("mode"),
            Column("natural frequency", "Hz", 5),
            Column("damping ratio", "1", 4),
            Column("parameter"),
            Column("frequency", "% per %", 3),
            Column("damping", "% per %", 3),
            Column("d frequency", "Hz per SI unit", 4),
            Column("d damping", "per SI unit", 4),
        )
        rows = tuple(
            (
                self.number(mode),
                float(self.natural_frequencies[mode]),
                float(self.damping_ratios[mode]),
                name,
                float(self.relative_frequencies[mode, p]),
                float(self.relative_dampings[mode, p]),
                float(self.frequency_slopes[mode, p]),
                float(self.damping_slopes[mode, p]),
            )
            for mode in range(len(self.poles))
            for p, name in enumerate(self.parameters)
        )
        return Table(f"{self.title}: what moves the modes", columns, rows, self.words())


def _strongest(relative: FloatArray, names: Sequence[str], most: int) -> str:
    order = np.argsort(-np.abs(relative))[:most]
    return ", ".join(f"{names[p]} ({relative[p]:+.2g})" for p in order if abs(relative[p]) > STRONG)


def mode_sensitivities(
    drivetrain: AssembledModel,
    parameters: Sequence[str] | None = None,
    *,
    measured_input: str | Sensor | None = None,
    excitation: str | None = None,
) -> ModeSensitivities:
    """Derivatives of all poles to parameters.

    Parameters
    ----------
    drivetrain : Drivetrain
        Modes and derivatives are those of its present values.
    parameters : sequence of str, optional
        Names of parameters or ``element.field``; by default every parameter that does not follow from others.
    measured_input : str or Sensor, optional
        The poles of responses against this sensor instead.
    excitation : str, optional
        What drives the drivetrain then.

    Raises
    ------
    UsageError
        An unknown name, or equal poles of a drivetrain with a spring tabulated over frequency.

    Examples
    --------
    >>> import torsionnet as tn
    >>> found = mode_sensitivities(tn.load("dmf_rig"), ["k_2", "c_2"])
    >>> found.relative_frequencies[0].round(3).tolist()
    [0.498, 0.001]
    """
    names = list(parameters) if parameters is not None else _basic(drivetrain)
    chosen = unknowns(drivetrain, names)
    request = None if measured_input is None else driven(drivetrain, measured_input, excitation)
    modes = modes_against(drivetrain, request)
    system = _System(drivetrain, chosen, request)
    numbers = tuple(number for number, kind in enumerate(modes.kinds, 1) if "rigid" not in kind)
    poles = np.array([modes.eigenvalues[number - 1] for number in numbers])
    slopes = np.zeros((len(poles), len(names)), dtype=complex)
    for group in _groups(poles):
        slopes[group] = system.slopes(complex(np.mean(poles[group])), len(group))
    return ModeSensitivities(tuple(names), np.array(chosen.start), poles, slopes, modes.title, numbers)


def _basic(drivetrain: AssembledModel) -> list[str]:
    basic = [name for name, one in drivetrain.parameter_definitions.items() if not one.value.names]
    if not basic:
        raise UsageError(f"{drivetrain.name} has no parameters; name numbers of elements, such as shaft.stiffness")
    return basic


def _groups(poles: ComplexArray) -> list[list[int]]:
    """Places of equal poles."""
    groups: list[list[int]] = []
    for place, pole in enumerate(poles):
        near = [group for group in groups if abs(poles[group[0]] - pole) < SAME * abs(pole)]
        if near:
            near[0].append(place)
        else:
            groups.append([place])
    return groups


class _System:
    """The equations, bordered by drive and reading where the input is measured."""

    def __init__(self, drivetrain: AssembledModel, chosen: Unknowns, request: TransferRequest | None) -> None:
        self.nodes = drivetrain.assembly.kinematics.nodes
        redundant = tuple(sorted(drivetrain.assembly.kinematics.reduction.redundant))
        self.system: Augmented = augmented(chosen, chosen.start, self.nodes, redundant)
        self.count = len(chosen.names)
        self.reading: ReadingDerivative | None = None
        self.load: Input | None = None
        if request is not None:
            (sensor,), (self.load,) = request.sensors, request.excitations
            values, elements = chosen.values(chosen.start), dict(chosen.definition.elements)
            read = reading_on_duals(sensor, elements, self.system, values)
            self.reading = derivative_of(read, self.system, self.nodes)

    def matrix(self, s: complex) -> ComplexArray:
        omega = np.array([s / 1j])
        kappa = self.system.kappa(omega)
        inner: ComplexArray = np.asarray(self.system.matrix(kappa, 1.0)[0])
        if self.reading is None or self.load is None:
            return inner
        n = len(inner)
        whole = np.zeros((n + 1, n + 1), dtype=complex)
        whole[:n, :n] = inner
        whole[self.nodes.index(self.load.of), n] = -1.0
        whole[n, :n] = rows_of([self.reading], self.system, kappa, omega)[0, 0]
        return whole

    def slopes(self, s: complex, multiplicity: int) -> ComplexArray:
        """Derivatives of the poles at s, (multiplicity, n_p)."""
        matrix, scale = self.matrix(s), self._scale(s)
        if multiplicity > len(matrix):
            return np.full((multiplicity, self.count), complex(np.nan, np.nan))
        left, sizes, right = np.linalg.svd(matrix * scale[:, None] * scale)
        if multiplicity > 1 and sizes[-multiplicity] > DEFECTIVE:
            return np.full((multiplicity, self.count), complex(np.nan, np.nan))
        r = scale[:, None] * right[-multiplicity:].conj().T
        l = scale[:, None] * left[:, -multiplicity:].conj()
        rates = np.array([[self._rate(s, r[:, j], l[:, i]) for j in range(multiplicity)] for i in range(multiplicity)])
        moved = np.array([[self._moved(s, r[:, j], l[:, i]) for j in range(multiplicity)] for i in range(multiplicity)])
        if multiplicity == 1:
            return self._followed(-moved[0] / rates[0, 0], -self._frozen_rate(s, r[:, 0], l[:, 0]) / rates[0, 0])
        if self.system.tables:
            owners = ", ".join(dict.fromkeys(self.system.law_owners[law] for law, _ in self.system.tables))
            raise UsageError(f"equal poles have no derivatives here, with springs tabulated over frequency: {owners}")
        found = np.zeros((multiplicity, self.count), dtype=complex)
        for p in range(self.count):
            found[:, p] = np.sort_complex(linalg.eigvals(-moved[:, :, p], rates))
        return found

    @staticmethod
    def _followed(direct: ComplexArray, through: complex) -> ComplexArray:
        """Slopes of a pole whose tabulated stiffnesses are read at its own frequency, and move with it."""
        return np.asarray(direct + through * direct.imag / (1 - through.imag))

    def _frozen_rate(self, s: complex, r: ComplexArray, left: ComplexArray) -> complex:
        """Derivative of the equations between two vectors to the frequency at which tables are read, rad/s."""
        total, n_q = 0j, self.system.laws.values.shape[1]
        for law, table in self.system.tables:
            row = self.system.laws.values[law]
            weight = row @ left[:n_q] + (0.0 if self.reading is None else self.reading.laws[law] * left[-1])
            total += table.kappa_rate(abs(s.imag)) * complex(row @ r[:n_q]) * complex(weight)
        return total

    def _scale(self, s: complex) -> FloatArray:
        """Of every unknown, so that entries are of the order of 1 before anything cancels."""
        kappa = np.abs(self.system.kappa(np.array([s / 1j])))
        n_nodes = self.system.laws.values.shape[1]
        own = (kappa[0][:, None] * self.system.laws.values**2).sum(axis=0)
        scale = np.ones(len(self.matrix(s)))
        scale[:n_nodes] = 1 / np.sqrt(np.where(own > 0, own, own.max(initial=1.0)))
        beyond = np.abs(self.matrix(s))[n_nodes:, :n_nodes] * scale[:n_nodes]
        largest = beyond.max(axis=1, initial=0.0)
        scale[n_nodes:] = 1 / np.where(largest > 0, largest, 1.0)
        return scale

    def _rate(self, s: complex, r: ComplexArray, left: ComplexArray) -> complex:
        n = self.system.laws.values.shape[1] + len(self.system.condition_owners)
        rate = equation_rate(self.system, s, r[:n], left[:n])
        if self.reading is not None:
            rate += complex(left[n]) * reading_rate(self.system, self.reading, s, r[:n])
        return rate

    def _moved(self, s: complex, r: ComplexArray, left: ComplexArray) -> ComplexArray:
        omega = np.array([s / 1j])
        kappa = self.system.kappa(omega)
        n = self.system.laws.values.shape[1] + len(self.system.condition_owners)
        slopes = {law: list(self.system.kappa_slopes(law, omega)) for law in range(len(self.system.law_owners))}
        moved = equation_slopes(self.system, kappa, slopes, r[None, :n], left[None, :n])[:, 0]
        if self.reading is not None:
            moved = moved + left[n] * reading_slopes(self.system, self.reading, omega, kappa, slopes, r[None, :n])[:, 0]
        return np.asarray(moved)
