"""Measured dynamic stiffness over frequency: rows of frequency, stiffness and damping, interpolated linearly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

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
