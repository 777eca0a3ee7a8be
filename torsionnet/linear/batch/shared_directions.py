"""Rigid and massless motions that all variants with the same rows and acting laws have in common."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray, RowSystem
from torsionnet.linear.dynamic_stiffness.reduction import complement_within, echelon, require_resistance, stiff_laws
from torsionnet.linear.dynamic_stiffness.row_algebra import unresisted_motions


@dataclass(frozen=True, eq=False)
class SharedDirections:
    """Bases (n_q, n) of rigid and massless motions, which follow from rows alone and not from coefficients.

    Attributes
    ----------
    rows : (n_laws, n_q) array
    heavy, stiff, dissipating : index arrays
        Laws with inertia, with stiffness, with damping of either sign.
    rigid, undamped_rigid : arrays
        Motions that no spring resists, and of these the ones that no damper resists either.
    damped, held : arrays
        Massless directions that dampers hold, and those that springs alone hold.
    """

    rows: FloatArray
    heavy: NDArray[np.intp]
    stiff: NDArray[np.intp]
    dissipating: NDArray[np.intp]
    rigid: FloatArray
    undamped_rigid: FloatArray
    damped: FloatArray
    held: FloatArray

    @property
    def n_moving(self) -> int:
        """Number of independent motions that have inertia."""
        return int(self.rows.shape[1] - self.damped.shape[1] - self.held.shape[1])

    @property
    def spring_rank(self) -> int:
        return int(self.rows.shape[1] - self.rigid.shape[1])

    @property
    def vibrations(self) -> int:
        """Number of vibrations that the inertias and springs have without dampers."""
        return int(min(self.n_moving - self.undamped_rigid.shape[1], self.spring_rank - self.held.shape[1]))

    @classmethod
    def of(cls, system: RowSystem) -> SharedDirections:
        """Bases (n_q, n) of rigid and massless motions of a system, of whose coefficients only the signs count.

        Raises
        ------
        SolveError
            Where some coordinates have neither inertia nor spring nor damper.
        """
        moves = system.rows.any(axis=1)  # laws on clamped nodes alone have empty rows
        heavy, stiff, damped = (laws & moves for laws in (system.inertia > 0, stiff_laws(system), system.damping != 0))
        require_resistance(system, heavy | stiff | damped)
        massless, held = (unresisted_motions(system, laws).basis() for laws in (heavy, heavy | damped))
        return cls(
            rows=system.rows,
            heavy=np.flatnonzero(heavy),
            stiff=np.flatnonzero(stiff),
            dissipating=np.flatnonzero(damped),
            rigid=echelon(unresisted_motions(system, stiff).basis()),
            undamped_rigid=unresisted_motions(system, stiff | damped).basis(),
            damped=complement_within(held, massless),
            held=held,
        )
