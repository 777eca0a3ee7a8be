"""States and inputs that each output and state derivative of an FMU depends on, from the pattern of its matrices.

Hosts look here for direct ways from inputs to outputs. The pattern holds for any values of the parameters; it may name
one more than needed where numbers would cancel.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.io.fmu.traced_matrices import System

Pattern: TypeAlias = NDArray[np.bool_]


def dependencies(system: System) -> dict[int, tuple[int, ...]]:
    """References of the states and inputs that an output or state derivative depends on, by the reference of it."""
    rates, outputs = _patterns(system)
    n_u, n_y, n_x = len(system.inputs), len(outputs), len(rates)
    first = 1 + n_u + n_y
    columns = np.array([*range(first, first + n_x), *range(1, 1 + n_u)])
    rows = {1 + n_u + row: taken for row, taken in enumerate(outputs)}
    rows |= {first + n_x + row: taken for row, taken in enumerate(rates)}
    return {reference: tuple(sorted(columns[taken].tolist())) for reference, taken in rows.items()}


def _patterns(system: System) -> tuple[Pattern, Pattern]:
    """Patterns (n_x, n_x + n_u) of (A, B) and (n_y, n_x + n_u) of (C, D), true where an entry is not always 0."""
    motion, n_u = system.motion, len(system.inputs)
    n_h, n_b, n = len(motion.heavy), len(motion.damped), len(system.coordinates)
    n_x = 2 * n_h + n_b
    M, C, K = (_pattern(system, letter, n, n) for letter in "MCK")
    loads = np.hstack([np.zeros((n, n_x), dtype=bool), _pattern(system, "L", n, n_u)])
    place, rate = np.zeros((n, n_x + n_u), dtype=bool), np.zeros((n, n_x + n_u), dtype=bool)
    place[:n_h, :n_h] = rate[:n_h, n_h : 2 * n_h] = np.eye(n_h, dtype=bool)
    place[n_h : n_h + n_b, 2 * n_h : n_x] = np.eye(n_b, dtype=bool)
    heavy, damped, static = slice(0, n_h), slice(n_h, n_h + n_b), slice(n_h + n_b, n)
    place[static] = _solved(K[static, static], (loads | K @ place)[static])
    rate[damped] = _solved(C[damped, damped], (loads | K @ place | C @ rate)[damped])
    faster = _solved(M[heavy, heavy], (loads | K @ place | C @ rate)[heavy])
    states = np.vstack([rate[:n_h], faster, rate[damped]])
    outputs = np.hstack(
        [np.zeros((len(system.outputs), n_x), dtype=bool), _pattern(system, "F", len(system.outputs), n_u)]
    )
    row = place
    for power in range(3):
        outputs |= _pattern(system, f"R{power}", len(system.outputs), n) @ row
        row = row[:, :n_x] @ states
    return states, outputs


def _pattern(system: System, letter: str, rows: int, columns: int) -> Pattern:
    found = np.zeros((rows, columns), dtype=bool)
    for i, j, _ in system.matrices[letter]:
        found[i, j] = True
    return found


def _solved(matrix: Pattern, right: Pattern) -> Pattern:
    """Pattern of the inverse of a symmetric matrix times ``right``, the inverse being full within connected parts."""
    from scipy.sparse.csgraph import connected_components

    if not len(matrix):
        return right
    _, label = connected_components(matrix, directed=False)
    together: Pattern = label[:, None] == label[None, :]
    return together @ right
