"""Eigenvalues in rad/s and mode shapes of a drivetrain, complex with damping, natural frequencies without.

    (s^2 M + s C + K) q = 0,    lambda = -zeta omega_0 +- j omega_0 sqrt(1 - zeta^2)

>>> import numpy as np
>>> from torsionnet.linear.assembly.rows import Rows
>>> rows = Rows.of(np.array([[1.0, 0.0], [0.0, 1.0], [1.0, -1.0]]))
>>> two_mass = RowSystem(rows, np.array([2.0, 2.0, 0.0]), np.array([0.0, 0.0, 0.2]), np.array([0.0, 0.0, 100.0]))
>>> modes = complex_modes(two_mass)
>>> modes.kinds
('rigid body', 'oscillatory')
>>> print(np.round(modes.eigenvalues, 6))
[ 0. +0.j     -0.1+9.9995j]
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray, RowSystem, refuse_actions
from torsionnet.linear.dynamic_stiffness.reduction import (
    LARGE_SYSTEM,
    AnyArray,
    resisted_coordinates,
    restrict_to,
    stiff_laws,
    subspaces,
    without_empty_laws,
)
from torsionnet.linear.modes.spectrum import Eigenpairs, one_per_pair, refined_spectrum, solve_spectrum

LEAST_IMAGINARY_PART = 1e-6
"""Imaginary part of a shape scaled to 1 above which it is more than rounding."""
LEAST_DAMPING_RATIO = 1e-14
"""Damping ratio below which double precision does not tell growth from decay."""
RIGID, REAL, OSCILLATORY = "rigid body", "real pole", "oscillatory"
"""Names of the kinds of modes, which are rigid-body motion, overdamped motion (a real pole) and vibration."""


@dataclass(frozen=True)
class EigenSolution:
    """Eigenvalues (n_modes,) in rad/s and shapes of the modes, rigid bodies first, then by |lambda| ascending.

    Attributes
    ----------
    eigenvalues : (n_modes,) complex array
        lambda in rad/s: one entry per conjugate pair (Im > 0), each real pole once, each rigid-body mode once (0).
    vectors : (n_q, n_modes) complex array
        Displacement shapes in q; the largest component of each is 1 (real positive).
    kinds : tuple of str
        "rigid body", "real pole" or "oscillatory".
    converged : (n_modes,) boolean array
        False where the frequency of a frequency-dependent law and of its mode could not be made to agree.
    iterations : (n_modes,) integer array
        Eigenvalue problems solved for the mode.
    errors : (n_modes,) array
        Estimated relative error of each eigenvalue with respect to the exact one of the given coefficients;
        0 for rigid-body modes, which are exact.
    missing : int
        Number of modes that exist but could not be calculated.
    more : int
        Number of vibrations that meet their own frequency beyond those at rest, where tables over frequency are steep.
    """

    eigenvalues: ComplexArray
    vectors: ComplexArray
    kinds: tuple[str, ...]
    converged: NDArray[np.bool_]
    iterations: NDArray[np.int_]
    errors: FloatArray
    missing: int = 0
    more: int = 0

    def first(self, count: int | None) -> EigenSolution:
        """Copy of the modes with only the first ``count`` of them, or with all of them for None."""
        whole = ("kinds", "missing", "more")
        parts = {part.name: getattr(self, part.name)[..., :count] for part in fields(self) if part.name not in whole}
        return replace(self, kinds=self.kinds[:count], **parts)


def complex_modes(system: RowSystem, lowest: int | None = None) -> EigenSolution:
    """Eigenvalues in rad/s and shapes of a system with damping, all or the ``lowest`` so many modes.

    An undamped system gets purely imaginary eigenvalues.

    Passive laws have a positive semidefinite damping matrix: a positive real part is rounding and set to 0. A negative
    damping, also in a table, can make a mode grow.
    With frequency-dependent laws each mode uses their stiffness and damping at its own frequency |Im lambda|; real
    poles use those at rest.

    Raises
    ------
    SolveError
        Where coordinates have neither inertia nor spring nor damper.
    """
    refuse_actions(system.actions, "these modes are")
    system = without_empty_laws(system)
    if system.is_continuous:
        return _of_continuous(system, lowest)
    stiff = stiff_laws(system)
    if lowest is not None and (few := _few_modes(system, lowest)) is not None:
        return few.first(lowest)
    if system.dynamic:
        from torsionnet.linear.modes import frozen_stiffness

        # Every mode by the laws at its own frequency.
        rigid, pairs, more = frozen_stiffness.modes(system)
        solution = _sorted_solution(rigid, pairs, passive=is_passive(system, pairs.values)).first(lowest)
        return replace(solution, more=more)
    # (4.1) as a first-order problem in velocities and spring forces, equation (4.5).
    spaces = subspaces(system, stiff, system.damping != 0)
    spectrum = refined_spectrum(solve_spectrum(system, spaces, system.stiffness, undamped=not np.any(system.damping)))
    kept, real = one_per_pair(spectrum)
    pairs = Eigenpairs.all_converged(spectrum, kept, real)
    return _sorted_solution(spaces.rigid, pairs, passive=dissipates(system)).first(lowest)


def _of_continuous(system: RowSystem, lowest: int | None) -> EigenSolution:
    from torsionnet.linear.modes import continuous, continuous_damped

    count = lowest or continuous.DEFAULT_COUNT
    rigid, pairs, missing = continuous_damped.damped_modes(system, count)
    solution = _sorted_solution(rigid, pairs, passive=is_passive(system, pairs.values)).first(count)
    return replace(solution, missing=missing)


def _few_modes(system: RowSystem, lowest: int) -> EigenSolution | None:
    """Eigenvalues and shapes of the lowest modes of a large system by sparse methods, or None if these fail."""
    if system.n_coordinates <= LARGE_SYSTEM:
        return None
    from torsionnet.linear.modes.lowest_modes import RigidMotions, lowest_vibrations

    stiffness, damping = system.frozen(0.0)
    damped = damping != 0
    motions = RigidMotions.of(system, stiffness > 0, damped, lowest)
    lossless = not (np.any(damped) or system.dynamic)
    pairs = lowest_vibrations(system, motions, lowest - motions.rigid.shape[1], undamped=lossless)
    return None if pairs is None else _sorted_solution(motions.rigid, pairs, passive=is_passive(system, pairs.values))


def dissipates(system: RowSystem) -> bool:
    """Whether no constant damping is negative, so that no damper feeds energy into vibrations."""
    return not np.any(system.damping < 0)


def is_passive(system: RowSystem, eigenvalues: ComplexArray) -> bool:
    """Whether no law feeds energy into vibrations at the frequencies of the eigenvalues (rad/s)."""
    omega = np.abs(eigenvalues.imag)
    frozen = [law.frozen(omega) for _, law in system.dynamic]
    return dissipates(system) and all(bool(np.all(k.imag >= 0) and np.all(c >= 0)) for k, c in frozen)


def _sorted_solution(rigid: FloatArray, pairs: Eigenpairs, *, passive: bool) -> EigenSolution:
    order = np.argsort(np.abs(pairs.values), kind="stable")
    n_rigid, real = rigid.shape[1], pairs.real[order]
    values = np.where(real, pairs.values[order].real, pairs.values[order])
    # Where nothing feeds energy, growth is rounding.
    if passive:
        values = np.minimum(values.real, 0.0) + 1j * values.imag
    shapes = _real_shapes(unit_shapes(pairs.shapes[:, order]), pairs.values[order], real)
    return EigenSolution(
        eigenvalues=np.concatenate([np.zeros(n_rigid), values]).astype(complex),
        vectors=np.hstack([unit_shapes(rigid), shapes]).astype(complex),
        kinds=(RIGID,) * n_rigid + tuple(REAL if is_real else OSCILLATORY for is_real in real),
        converged=np.concatenate([np.ones(n_rigid, dtype=bool), pairs.converged[order]]),
        iterations=np.concatenate([np.zeros(n_rigid, dtype=int), pairs.iterations[order]]),
        errors=np.concatenate([np.zeros(n_rigid), pairs.errors[order]]),
    )


def _real_shapes(shapes: AnyArray, values: ComplexArray, real: NDArray[np.bool_]) -> AnyArray:
    """Mode shapes (n_q, n_modes), made real where eigenvalues are real.

    A pair on the axis gets real and imaginary part of its shape.
    """
    made_real = shapes.copy()
    made_real[:, real] = shapes[:, real].real
    # Two real poles that came as a pair share a complex shape, of which each takes one part.
    second = real & (values.imag < 0) & (np.abs(shapes.imag).max(axis=0, initial=0) > LEAST_IMAGINARY_PART)
    made_real[:, second] = unit_shapes(shapes[:, second].imag)
    return made_real


def with_zero_damping(values: ComplexArray, errors: FloatArray) -> ComplexArray:
    """Eigenvalues (n,) in rad/s with real parts set to 0 where these are within the relative errors.

    Such a mode neither grows nor decays.
    """
    blurred = np.abs(values.real) <= np.maximum(errors, LEAST_DAMPING_RATIO) * np.abs(values)
    return np.asarray(np.where(blurred, 1j * values.imag, values))


def unit_shapes(shapes: AnyArray) -> AnyArray:
    """Mode shapes (n, n_modes) scaled so that the largest component of each is 1, the first of equal ones."""
    if not shapes.size:
        return shapes
    size = np.abs(shapes)
    first = np.argmax(size >= size.max(axis=0) * (1 - 1e-9), axis=0)
    largest = shapes[first, np.arange(shapes.shape[1])]
    # The pole of a controller that drives a locked node has no motion.
    largest[largest == 0] = 1
    return np.asarray(shapes / largest)


def undamped_modes(system: RowSystem, lowest: int | None = None) -> tuple[FloatArray, FloatArray]:
    """Natural frequencies (n,) in rad/s and shapes (n_q, n) without damping, all or the ``lowest`` so many.

    Damping is ignored; a frequency-dependent law counts with the real part of its stiffness at the mode's own
    frequency. With continuous shafts, which have infinitely many modes, ``lowest`` is 20 by default.

    Returns
    -------
    omega : (n,) array
        One natural frequency in rad/s for each dynamic degree of freedom (rank of M), ascending; 0.0 for rigid bodies.
    shapes : (n_q, n) array
        Real shapes; the largest component of each is 1.
    """
    refuse_actions(system.actions, "undamped modes are")
    system = without_empty_laws(system)
    if system.is_continuous:
        from torsionnet.linear.modes import continuous

        return continuous.undamped_modes(system, lowest or continuous.DEFAULT_COUNT)
    kept = resisted_coordinates(system)
    omega, shapes = _undamped_modes(without_empty_laws(restrict_to(system, kept)), lowest)
    every = np.zeros((system.n_coordinates, len(omega)))
    every[kept] = shapes
    return omega, every


def _undamped_modes(system: RowSystem, lowest: int | None) -> tuple[FloatArray, FloatArray]:
    stiff = stiff_laws(system)
    undamped = np.zeros_like(stiff)
    if system.dynamic:
        from torsionnet.linear.modes import frozen_stiffness

    if lowest is not None and system.n_coordinates > LARGE_SYSTEM:
        from torsionnet.linear.modes.lowest_modes import RigidMotions, lowest_vibrations

        low = frozen_stiffness.next_to_rest(system) if system.dynamic else 0.0
        motions = RigidMotions.of(system, system.frozen(low)[0] > 0, undamped, lowest)
        few = lowest_vibrations(system, motions, lowest - motions.rigid.shape[1], undamped=True)
        if few is not None:
            return _sorted_undamped(motions.rigid, few, lowest)
    if system.dynamic:
        return _sorted_undamped(*frozen_stiffness.modes(system, undamped=True)[:2], lowest)
    # (K - omega^2 M) phi = 0, from rows scaled by the roots of their coefficients.
    spaces = subspaces(system, stiff, undamped)
    spectrum = refined_spectrum(solve_spectrum(system, spaces, system.stiffness, undamped=True))
    pairs = Eigenpairs.all_converged(spectrum, *one_per_pair(spectrum))
    return _sorted_undamped(spaces.rigid, pairs, lowest)


def _sorted_undamped(rigid: FloatArray, pairs: Eigenpairs, lowest: int | None) -> tuple[FloatArray, FloatArray]:
    order = np.argsort(pairs.values.imag, kind="stable")
    omega = np.concatenate([np.zeros(rigid.shape[1]), pairs.values.imag[order]])
    shapes = np.hstack([rigid, pairs.shapes[:, order].real])
    return omega[:lowest], np.asarray(unit_shapes(shapes)[:, :lowest])
