"""Complex modes of a drivetrain, eigenvalues, shapes and energy shares, with their tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.conventions import (
    MODE_KIND,
    MODE_NUMBER,
    OSCILLATORY,
    REAL,
    RIGID,
    SI,
    Conventions,
    counting_notes,
    mode_names,
    mode_numbers,
)
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.packages import SavedResult
from torsionnet.base.result_rows import Out

if TYPE_CHECKING:
    from torsionnet.base.table import Table

FloatArray: TypeAlias = NDArray[np.float64]
ComplexArray: TypeAlias = NDArray[np.complex128]
__all__ = ["OSCILLATORY", "REAL", "RIGID", "ComplexArray", "FloatArray", "Modes"]


@dataclass(frozen=True)
class EnergyShares:
    """Shares of an element, without unit, in the kinetic energy, strain energy and dissipation of a mode."""

    kinetic: float
    strain: float
    dissipated: float


@dataclass(frozen=True, eq=False)
class ModeRow:
    """Mode of a drivetrain as plain data, frequencies in Hz and eigenvalue in rad/s.

    Shape by node (1 at the node that moves most), energy shares by element.
    """

    mode: Annotated[int | None, Out("mode", schema=MODE_NUMBER)]
    kind: Annotated[str, Out("kind", schema=MODE_KIND)]
    natural_frequency: Annotated[float, Out("natural frequency |lambda|/2pi", "Hz", "natural_frequency_Hz")]
    damped_frequency: Annotated[float, Out("damped frequency Im lambda/2pi", "Hz", "damped_frequency_Hz")]
    damping_ratio: Annotated[float, Out("damping ratio", "1")]
    eigenvalue: Annotated[complex, Out(json="eigenvalue_rad_per_s")]
    converged: bool
    description: Annotated[str, Out("description")]
    shape: Mapping[str, complex]
    energy_shares: Mapping[str, EnergyShares]

    @property
    def real_part(self) -> Annotated[float, Out("Re lambda", "rad/s", None)]:
        """Real part of a mode's eigenvalue in rad/s."""
        return self.eigenvalue.real

    @property
    def imaginary_part(self) -> Annotated[float, Out("Im lambda", "rad/s", None)]:
        """Imaginary part of a mode's eigenvalue in rad/s."""
        return self.eigenvalue.imag


MODE_COLUMNS = (
    "mode", "natural_frequency", "damped_frequency", "damping_ratio", "real_part", "imaginary_part", "kind",
    "description",
)  # fmt: skip


@dataclass(frozen=True, eq=False, repr=False)
class Modes(SavedResult):
    """Complex modes of a drivetrain, one per conjugate pair, real pole or rigid-body mode, sorted by ``|lambda|``.

    Attributes
    ----------
    eigenvalues : (n_modes,) complex array
        Eigenvalues lambda in rad/s, Im >= 0.
    kinds : tuple of str
        ``"rigid body"``, ``"real pole"`` or ``"oscillatory"``.
    nodes : tuple of str
        Node of each row of ``shapes``.
    shapes : (n_nodes, n_modes) complex array
        Angles, scaled to 1 at the node that moves most; nan at nodes that are not part of a cut system.
    undamped_natural_frequencies : (n,) array
        Natural frequencies of M and K alone, Hz, ascending, rigid-body modes as 0.
    elements : tuple of str
        Element of each row of the energy shares.
    kinetic, strain, dissipated : (n_elements, n_modes) arrays
        Share of each element in the kinetic energy, strain energy and dissipated power of a mode. The magnitudes of
        the shares sum to 1, unless all are 0. Shares of elements that feed energy into the vibration, such as
        controllers, are negative in ``dissipated``, those of negative stiffnesses or inertias in the energies.
    converged : (n_modes,) bool array
        False where the iteration for a frequency-dependent law did not settle.
    descriptions : tuple of str
        Sentence on each mode.
    title : str
    notes : tuple of str
    motions : tuple of str
        What moves in each mode: its description without whether it grows.

    Examples
    --------
    >>> import torsionnet as tn
    >>> modes = tn.load("dmf_rig").modes()
    >>> len(modes), round(float(modes.natural_frequencies[0]), 3), round(float(modes.damping_ratios[0]), 4)
    (2, 7.105, 0.2227)
    """

    SHOWN: ClassVar = ("title", "notes", "undamped_natural_frequencies", "nodes", "rows")

    eigenvalues: ComplexArray
    kinds: tuple[str, ...]
    nodes: tuple[str, ...]
    shapes: ComplexArray
    undamped_natural_frequencies: Annotated[FloatArray, Out(json="undamped_natural_frequencies_Hz")]
    elements: tuple[str, ...]
    kinetic: FloatArray
    strain: FloatArray
    dissipated: FloatArray
    converged: NDArray[np.bool_]
    descriptions: tuple[str, ...]
    title: str = ""
    notes: tuple[str, ...] = ()
    motions: tuple[str, ...] = ()

    @property
    def numbers(self) -> tuple[int | None, ...]:
        """Number of every mode, vibrations from 1 by rising ``|lambda|``, None for rigid bodies and real poles."""
        return mode_numbers(self.kinds)

    @property
    def names(self) -> tuple[str, ...]:
        """Name of every mode in headings, its number, or "rigid body", "real pole"."""
        return mode_names(self.kinds)

    @cached_property
    def natural_frequencies(self) -> FloatArray:
        """Natural frequencies ``|lambda| / 2 pi`` of the modes in Hz, shape (n_modes,); 0 for a rigid-body mode."""
        return np.asarray(np.abs(self.eigenvalues) / (2 * np.pi))

    @cached_property
    def damped_frequencies(self) -> FloatArray:
        """Damped frequencies Im lambda / 2 pi of the modes in Hz, shape (n_modes,); 0 where nothing vibrates."""
        return np.asarray(self.eigenvalues.imag / (2 * np.pi))

    @cached_property
    def damping_ratios(self) -> FloatArray:
        """Damping ratios ``-Re lambda / |lambda|`` of the modes, without unit, shape (n_modes,).

        1 for a stable real pole, nan for a rigid one.
        """
        size = np.abs(self.eigenvalues)
        ratios = np.full(len(size), np.nan)
        np.divide(-self.eigenvalues.real, size, out=ratios, where=size > 0)
        return ratios + 0.0

    def first(self, count: int | None) -> Modes:
        """Copy of the modes cut to the first ``count`` modes and as many undamped natural frequencies."""
        cut = {
            name: getattr(self, name)[..., :count]
            for name in ("eigenvalues", "shapes", "kinetic", "strain", "dissipated", "converged")
        }
        return replace(
            self,
            **cut,
            kinds=self.kinds[:count],
            descriptions=self.descriptions[:count],
            motions=self.motions[:count],
            undamped_natural_frequencies=self.undamped_natural_frequencies[:count],
        )

    def __len__(self) -> int:
        return len(self.eigenvalues)

    def shape_at(self, node: str) -> ComplexArray:
        """Complex angle of a node in every mode, without unit, 1 at the node that moves most, shape (n_modes,)."""
        if node not in self.nodes:
            raise UsageError(f'no node is named "{node}"{did_you_mean(node, self.nodes)}', kind="unknown-node")
        return np.asarray(self.shapes[self.nodes.index(node)])

    def energy_shares(self, mode: int) -> Mapping[str, tuple[float, float, float]]:
        """Triples of shares (kinetic, strain, dissipated) in the energies of one mode, by name of element."""
        shares = np.stack([self.kinetic[:, mode], self.strain[:, mode], self.dissipated[:, mode]], axis=1)
        return {name: (float(k), float(s), float(d)) for name, (k, s, d) in zip(self.elements, shares, strict=True)}

    def table(self, conventions: Conventions = SI) -> Table:
        """Table with a row per mode, natural and damped frequency, damping ratio, eigenvalue, kind and description."""
        from torsionnet.base.table import result_table

        scale = conventions.frequency_scale
        undamped = ", ".join(f"{value * scale:.6g}" for value in self.undamped_natural_frequencies)
        notes = (
            *counting_notes(self.numbers),
            f"undamped natural frequencies [{conventions.frequency}]: {undamped}",
            *self.notes,
        )
        return result_table(self.title, self.rows(), ModeRow, MODE_COLUMNS, conventions, notes)

    def rows(self) -> Annotated[tuple[ModeRow, ...], Out(json="modes")]:
        """Modes as plain data, a record for each by rising ``|lambda|``, frequencies in Hz, eigenvalues in rad/s."""
        return tuple(
            ModeRow(
                self.numbers[index],
                self.kinds[index],
                float(self.natural_frequencies[index]),
                float(self.damped_frequencies[index]),
                float(self.damping_ratios[index]),
                complex(value),
                bool(self.converged[index]),
                self.descriptions[index],
                dict(zip(self.nodes, self.shapes[:, index].tolist(), strict=True)),
                {name: EnergyShares(*parts) for name, parts in self.energy_shares(index).items()},
            )
            for index, value in enumerate(self.eigenvalues)
        )

    def shape_table(self) -> Table:
        """Table of mode shapes with a row per node, magnitude in rad and phase in deg for each mode."""
        from torsionnet.base.table import Column, Table

        columns = [Column("node")]
        for name in self.names:
            columns += [Column(f"|shape {name}|", "rad"), Column(f"phase {name}", "deg")]
        rows = []
        for node, row in zip(self.nodes, self.shapes, strict=True):
            cells: list[float] = []
            for value in row:
                cells += [float(abs(value)), float(np.degrees(np.angle(value)))]
            rows.append((node, *cells))
        return Table(
            f"{self.title}: mode shapes", tuple(columns), tuple(rows), ("scaled to 1 at the node that moves most",)
        )

    def energy_table(self) -> Table:
        """Table with a row per element, share in kinetic and strain energy and dissipation of each mode, percent."""
        from torsionnet.base.table import Column, Table

        columns = [Column("element")]
        for name in self.names:
            columns += [Column(f"{what} {name}", "%", 4) for what in ("kinetic", "strain", "dissipated")]
        rows = []
        for number, name in enumerate(self.elements):
            shares = [
                100 * table[number, index]
                for index in range(len(self))
                for table in (self.kinetic, self.strain, self.dissipated)
            ]
            rows.append((name, *(float(share) for share in shares)))
        return Table(f"{self.title}: energy shares", tuple(columns), tuple(rows))

    def to_csv(self, path: str | Path | None = None, conventions: Conventions = SI) -> str:
        """Table of the modes as CSV text, also written to the file ``path`` if given."""
        return self.table(conventions).to_csv(path)

    def __repr__(self) -> str:
        listed = ", ".join(f"{value:.4g}" for value in self.natural_frequencies[:8])
        more = ", ..." if len(self) > 8 else ""
        return f"<Modes: {len(self)} modes at {listed}{more} Hz>"
