"""Complex stiffness over frequency from storage and loss parts, interpolated as powers of the frequency."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from torsionnet.model.element_base.stiffness_table import StiffnessTable

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


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
        damping = tuple(one / (math.tau * f) for f, one in zip(frequencies, loss, strict=True))
        return cls(tuple(map(float, frequencies)), tuple(map(float, storage)), damping, viscous)

    def kappa(self, omega: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Complex stiffness k' + j k'' in N m/rad at omega >= 0 in rad/s, in the shape of ``omega``."""
        import numpy as np

        omega, first = np.asarray(omega, dtype=float), self.frequencies[0]
        at = np.log(np.maximum(omega / math.tau, first))
        f, k, c = self._logarithms
        storage, loss = np.exp(np.interp(at, f, k)), np.exp(np.interp(at, f, c))
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
        damping = np.where(moving, kappa.imag / np.where(moving, omega, 1.0), self.damping[0])
        return kappa.real.astype(complex), damping

    def frozen_rate(self, omega: float) -> tuple[complex, float]:
        """Derivatives of ``frozen`` to omega in rad/s; at a row, those of the piece above it."""
        import numpy as np

        rate = self.kappa_rate(omega)
        if not self.viscous:
            return rate, 0.0
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
            return 1j * self.damping[0]
        if place == len(self.frequencies):
            return 0j
        here = complex(self.kappa(np.array([omega]))[0])
        loss = [math.tau * one * c for one, c in zip(self.frequencies, self.damping, strict=True)]
        width = math.log(self.frequencies[place] / self.frequencies[place - 1])
        k, second = (math.log(column[place] / column[place - 1]) / width for column in (self.stiffness, loss))
        return complex(here.real * k / omega, here.imag * second / omega)
