"""Measured dynamic stiffness over frequency: rows of frequency, stiffness and damping, interpolated linearly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from torsionnet.base.entries.scalars import NumberTable, RowColumn
from torsionnet.base.entries.spec import Json, full_name
from torsionnet.base.expressions import Rows
from torsionnet.model.element_base.dynamic_stiffness import DynamicStiffness

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class StiffnessTable(DynamicStiffness):
    """Dynamic stiffness kappa(omega) = k(f) + j omega c(f) from a table.

    Attributes
    ----------
    frequencies : tuple of float
        Hz, strictly increasing, at least one.
    stiffness : tuple of float
        k(f), the real part, N m/rad.
    damping : tuple of float
        c(f), the imaginary part divided by omega, N m s/rad.

    Between the rows k and c are interpolated linearly, outside they keep the value of the nearest row.
    """

    frequencies: tuple[float, ...]
    stiffness: tuple[float, ...]
    damping: tuple[float, ...]

    def frozen(self, omega: NDArray[np.float64]) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
        """Stiffness k in N m/rad and damping c in N m s/rad of the table at omega >= 0 in rad/s."""
        import numpy as np

        frequency = np.asarray(omega, dtype=float) / (2 * np.pi)
        k = np.interp(frequency, self.frequencies, self.stiffness)
        return np.asarray(k, dtype=complex), np.asarray(np.interp(frequency, self.frequencies, self.damping))

    def kappa(self, omega: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Complex stiffness k + j omega c in N m/rad at omega >= 0 in rad/s, in the shape of ``omega``."""
        k, c = self.frozen(omega)
        return k + 1j * omega * c

    def frozen_rate(self, omega: float) -> tuple[complex, float]:
        """Derivatives of k and c of the table to omega in rad/s; at a row, those of the piece above it."""
        import numpy as np

        place = int(np.searchsorted(self.frequencies, omega / (2 * np.pi), side="right"))
        # Before the first and after the last row k and c are constant.
        if place in (0, len(self.frequencies)):
            return 0j, 0.0
        width = 2 * np.pi * (self.frequencies[place] - self.frequencies[place - 1])
        k, c = ((column[place] - column[place - 1]) / width for column in (self.stiffness, self.damping))
        return complex(k), float(c)

    def kappa_rate(self, omega: float) -> complex:
        """Derivative of kappa to omega in N m s/rad, at omega in rad/s; at a row, the derivative of the piece above it.

        >>> StiffnessTable((1.0, 3.0), (300.0, 500.0), (2.0, 2.0)).kappa_rate(0.0)
        2j
        """
        import numpy as np

        k, c = self.frozen_rate(omega)
        return k + 1j * (float(self.frozen(np.array(omega))[1]) + omega * c)

    @property
    def rows(self) -> tuple[float, ...]:
        return self.frequencies

    @property
    def is_passive(self) -> bool:
        """Whether the table can only take energy out of a vibration (c >= 0 at every row)."""
        return min(self.damping) >= 0

    @property
    def holds_at_rest(self) -> bool:
        """Whether the table has a stiffness above zero at its lowest frequency."""
        return self.stiffness[0] > 0

    def in_many_digits(self, s: Any) -> Any:
        """Complex stiffness k + s c in N m/rad at an mpmath number s, with k and c at ``|Im s|``."""
        import mpmath
        import numpy as np

        k, c = self.frozen(np.array(abs(float(mpmath.im(s)))))
        return mpmath.mpmathify(complex(k)) + s * mpmath.mpf(float(c))


# Complex stiffness over frequency from storage and loss parts, interpolated as powers of the frequency.


@dataclass(frozen=True)
class SampledStiffness(StiffnessTable):
    """Dynamic stiffness k'(f) + j k''(f) of rubber, silicone or oil in N m/rad; all rows are above zero.

    Between the rows k' and k'' are powers of f: straight lines on double logarithmic paper, as such data are drawn.
    Below the first row k' keeps its value and k'' falls with f, so that kappa is real at rest; above the last both
    keep their values. A pole meets k' + j k'' as of rubber, or where the loss is that of a fluid (``viscous``)
    k' + s c with c = k''/omega.
    """

    viscous: bool = False

    @classmethod
    def of(
        cls, frequencies: Sequence[float], storage: Sequence[float], loss: Sequence[float], *, viscous: bool = False
    ) -> SampledStiffness:
        """Sampled stiffness from k' and k'' in N m/rad at frequencies in Hz.

        >>> import numpy as np
        >>> SampledStiffness.of([1, 100], [10, 1000], [5, 5]).kappa(math.tau * np.array([0.0, 10.0])).round(9)
        array([ 10.+0.j, 100.+5.j])
        """
        damping = tuple(k / (math.tau * f) for f, k in zip(frequencies, loss, strict=True))
        return cls(tuple(map(float, frequencies)), tuple(map(float, storage)), damping, viscous)

    def kappa(self, omega: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Complex stiffness k' + j k'' in N m/rad at omega >= 0 in rad/s, in the shape of ``omega``."""
        import numpy as np

        omega, first = np.asarray(omega, dtype=float), self.frequencies[0]
        # k' and k'' are powers of the frequency between rows, straight lines in logarithms.
        at = np.log(np.maximum(omega / math.tau, first))
        f, k, c = self._logarithms
        storage, loss = np.exp(np.interp(at, f, k)), np.exp(np.interp(at, f, c))
        # Below the first row k'' falls with omega, as of a viscous damping, to nothing at rest.
        loss = loss * np.minimum(omega / (math.tau * first), 1.0)
        return np.asarray(storage + 1j * loss)

    @cached_property
    def _logarithms(self) -> tuple[NDArray[np.float64], ...]:
        """Logarithms of frequencies in Hz, and of storage and loss parts in N m/rad, of all rows; modes ask often."""
        import numpy as np

        f, k, c = (np.array(column) for column in (self.frequencies, self.stiffness, self.damping))
        return np.log(f), np.log(k), np.log(math.tau * f * c)

    def frozen(self, omega: NDArray[np.float64]) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
        """Stiffness in N m/rad and, where the loss is viscous, damping in N m s/rad, at omega >= 0 in rad/s."""
        import numpy as np

        kappa = self.kappa(omega)
        if not self.viscous:
            return kappa, np.zeros(np.shape(omega))
        moving = np.asarray(omega) > 0
        # c = k''/omega, at rest that of the first row.
        damping = np.where(moving, kappa.imag / np.where(moving, omega, 1.0), self.damping[0])
        return kappa.real.astype(complex), damping

    def frozen_rate(self, omega: float) -> tuple[complex, float]:
        """Derivatives of ``frozen`` to omega in rad/s; at a row, those of the piece above it."""
        import numpy as np

        rate = self.kappa_rate(omega)
        if not self.viscous:
            return rate, 0.0
        # c = k''/omega: dc/domega = (dk''/domega - c)/omega.
        damping = float(self.frozen(np.array(omega))[1])
        return complex(rate.real), (rate.imag - damping) / omega if omega else 0.0

    def in_many_digits(self, s: Any) -> Any:
        """Complex stiffness in N m/rad at an mpmath number s: what is frozen at ``|Im s|``, and s c at rest."""
        import mpmath

        rest = 0 if self.viscous else mpmath.re(s) * mpmath.mpf(self.damping[0])
        return super().in_many_digits(s) + rest

    def kappa_rate(self, omega: float) -> complex:
        """Derivative of kappa to omega in N m s/rad, at omega in rad/s.

        At a row, the derivative of the piece above it.
        """
        import numpy as np

        f = omega / math.tau
        place = int(np.searchsorted(self.frequencies, f, side="right"))
        if place == 0:
            # k is constant below the first row, and k'' = c omega.
            return 1j * self.damping[0]
        if place == len(self.frequencies):
            return 0j
        here = complex(self.kappa(np.array([omega]))[0])
        loss = [math.tau * frequency * c for frequency, c in zip(self.frequencies, self.damping, strict=True)]
        # k goes with omega^n on a piece, so that dk/domega = n k/omega, with n the slope of the logarithms.
        width = math.log(self.frequencies[place] / self.frequencies[place - 1])
        k, second = (math.log(column[place] / column[place - 1]) / width for column in (self.stiffness, loss))
        return complex(here.real * k / omega, here.imag * second / omega)


# Dynamic stiffness from a stiffness and curves of its factor and loss factor over frequency.


def stiffness_from_curves(
    stiffness: float, factor: Rows, loss: Rows, loss_factor: float = 0.0, *, viscous: bool = False
) -> SampledStiffness:
    """Dynamic stiffness k factor(f) (1 + j eta(f)) in N m/rad, sampled at the frequencies of the curves.

    Without rows in ``loss`` eta is ``loss_factor`` everywhere, without rows in ``factor`` the factor is 1.
    Eta is c omega/k of a ``viscous`` damping, else a loss factor.

    Examples
    --------
    >>> from torsionnet.base.expressions import Number
    >>> rows = ((Number(1), Number(1)), (Number(100), Number(4)))
    >>> stiffness_from_curves(500.0, rows, (), 0.1).stiffness
    (500.0, 2000.0)
    """
    # Powers of the frequency between rows stay powers between the rows of both curves together.
    frequencies = sorted({float(f.value) for f, _ in (*factor, *loss)})
    factors = [_read(factor, f, 1.0) for f in frequencies]
    losses = [_read(loss, f, loss_factor) for f in frequencies]
    storage = [stiffness * share for share in factors]
    second = [k * eta for k, eta in zip(storage, losses, strict=True)]
    return SampledStiffness.of(frequencies, storage, second, viscous=viscous)


def _read(rows: Rows, frequency: float, otherwise: float) -> float:
    """Value of a curve at a frequency in Hz, interpolated as a power of the frequency between its rows."""
    import numpy as np

    if not rows:
        return otherwise
    keys, values = zip(*((math.log(f.value), math.log(number.value)) for f, number in rows), strict=True)
    return math.exp(float(np.interp(math.log(frequency), keys, values)))


# Entry for the rows of a measured dynamic stiffness.


@dataclass(frozen=True, eq=False, repr=False)
class TableEntry(NumberTable[StiffnessTable]):
    """Entry for rows [frequency, stiffness, damping] of a measured dynamic stiffness."""

    columns: tuple[RowColumn, ...] = (
        RowColumn("frequency", "frequency", negative=False),
        RowColumn("stiffness", "stiffness", negative=False),
        RowColumn("damping", "damping"),
    )

    def coerce(self, raw: object) -> StiffnessTable:
        if isinstance(raw, StiffnessTable):
            return raw
        columns = zip(*self.rows(raw), strict=True)
        return StiffnessTable(*(tuple(float(cell.value) for cell in column) for column in columns))

    def plain(self, value: Any) -> Json:
        return [list(row) for row in zip(value.frequencies, value.stiffness, value.damping, strict=True)]

    @property
    def accepted(self) -> str:
        return f"{full_name(StiffnessTable)} | {super().accepted}"
