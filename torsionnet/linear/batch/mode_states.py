"""Modes written as vectors of energy over the laws, and the energy that two modes have in common.

The state of a mode has for every law the velocity times the root of its inertia and the twist times the root of its
stiffness: the square of its length is the energy of the vibration. States of different modes of an undamped drivetrain
are orthogonal, whatever inertias and stiffnesses are, which angles at nodes are not; and two real poles that share a
shape differ in velocity over twist.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray, RowSystem
from torsionnet.linear.assembly.system import Assembly
from torsionnet.linear.batch.batched_modes import BatchedModes, stacked_coefficients
from torsionnet.model.element_base.dynamic_stiffness import ComplexStiffness


def mode_states(found: BatchedModes, places: NDArray[np.intp]) -> ComplexArray:
    """Modes as vectors of energy over the laws, of length 1, shape (n, n_states, n_modes).

    They are 0 for rigid bodies and missing modes.

    Variants whose laws are not those of the drivetrain itself, one to one, have states of zeros.
    """
    assembly = found.drivetrain.assembly
    n_laws, n_modes = len(assembly.kinematics.laws), found.eigenvalues.shape[1]
    states = np.zeros((len(places), 2 * n_laws, n_modes), dtype=complex)
    counts = np.where(np.isin(places, list(found.singles)), 0, _counts(found, places))
    for number in np.flatnonzero(counts == 0):
        place = int(places[number])
        own = found.singles.get(place)
        if own is not None and len(own.kinematics.laws) == n_laws:
            count, coefficients = int(_counts(found, places[[number]])[0]), (own.system.inertia, _springs(own.system))
            states[number, :, :count] = _states(own, *coefficients, found, places[[number]], count)[0]
    given = None if found.batch is None else stacked_coefficients(found.batch)
    if given is None:
        return states
    for count in np.unique(counts[counts > 0]).tolist():
        some = np.flatnonzero(counts == count)  # a product's bits may depend on the number of its columns
        coefficients = given.inertia[places[some]], given.stiffness[places[some]]
        states[some, :, :count] = _states(assembly, *coefficients, found, places[some], count)
    return states


def _springs(system: RowSystem) -> FloatArray:
    """Stiffness (n_laws,) of all laws in N m/rad, with that of hysteretic springs."""
    stiffness = system.stiffness.copy()
    for law, table in system.dynamic:
        if isinstance(table, ComplexStiffness):
            stiffness[law] += table.kappa(np.zeros(1))[0].real
    return stiffness


def _counts(found: BatchedModes, places: NDArray[np.intp]) -> NDArray[np.intp]:
    """Number of modes of each variant at these places, shape (n,)."""
    return np.asarray(np.sum(~np.isnan(found.eigenvalues[places]), axis=1))


def _states(
    assembly: Assembly,
    inertia: FloatArray,
    stiffness: FloatArray,
    found: BatchedModes,
    places: NDArray[np.intp],
    count: int,
) -> ComplexArray:
    """Modes as unit vectors of energy (n, 2 n_laws, count) of the variants that have ``count`` modes."""
    values = found.eigenvalues[places, :count]
    nodes = [assembly.node_index[name] for name in assembly.kinematics.coordinates]
    motion = assembly.system.rows @ found.shapes[places, :, :count][:, nodes]
    acting = np.flatnonzero([law.acts for _, law in assembly.kinematics.laws])
    states = np.zeros((len(places), 2, len(assembly.kinematics.laws), count), dtype=complex)
    states[:, 0, acting] = np.sqrt(np.maximum(inertia, 0))[..., None] * motion * values[:, None, :]
    states[:, 1, acting] = np.sqrt(np.maximum(stiffness, 0))[..., None] * motion
    return _unit(states.reshape(len(places), -1, count) * (values != 0)[:, None, :])


def common_energy(first: ComplexArray, second: ComplexArray) -> FloatArray:
    """Energy in common (n, n_first, n_second) of modes given as energy vectors, 1 for equal and 0 for orthogonal ones.

    It is the modal assurance criterion of these vectors.
    """
    return np.asarray(np.abs(np.conj(np.swapaxes(first, -1, -2)) @ second) ** 2)


def inertia_mac(first: ComplexArray, second: ComplexArray) -> FloatArray:
    """Modal assurance criterion (n, n_first, n_second) of modes, weighted with inertias, 0 where nothing moves."""
    half = first.shape[1] // 2
    return common_energy(_unit(first[:, :half]), _unit(second[:, :half]))


def _unit(states: ComplexArray) -> ComplexArray:
    size = np.linalg.norm(states, axis=1, keepdims=True)
    return np.asarray(np.divide(states, size, out=np.zeros_like(states), where=size > 0))
