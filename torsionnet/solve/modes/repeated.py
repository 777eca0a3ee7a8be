"""Modes that share one eigenvalue: every combination of their shapes is a mode too, so one set of them is chosen.

Chosen are the shapes that are 1 at one of as many nodes and 0 at the others of these, the ones that move most, in
the order of the nodes. They are real wherever real ones exist.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from torsionnet.assembly.rows import ComplexArray
from torsionnet.solve.modes.eigen import RIGID, EigenSolution

EQUAL = 1e-9
"""Relative difference of eigenvalues below which they are one."""
INDEPENDENT = 1e-6
"""Ratio of singular values below which shapes are the same one: a repeated pole with too few modes."""
ALIKE = 1 - 1e-9


def with_chosen_shapes(
    solution: EigenSolution, motion: ComplexArray, nodes: Sequence[str]
) -> tuple[EigenSolution, tuple[str, ...]]:
    """The solution with those shapes, and a note for every repeated eigenvalue.

    Parameters
    ----------
    solution : EigenSolution
    motion : (n_nodes, n_modes) complex array
        Angles of its shapes.
    nodes : sequence of str
    """
    vectors, notes = solution.vectors.copy(), []
    for group in _groups(solution):
        chosen = _nodes_apart(motion[:, group])
        if chosen is None:
            continue
        vectors[:, group] = vectors[:, group] @ np.linalg.inv(motion[np.ix_(chosen, group)])
        names = " and ".join([", ".join(nodes[i] for i in chosen[:-1]), nodes[chosen[-1]]])
        modes = " and ".join([", ".join(str(i + 1) for i in group[:-1]), str(group[-1] + 1)])
        notes.append(
            f"modes {modes} share one eigenvalue, so every combination of their shapes is a mode too; shown are those "
            f"in which of {names} only one moves, in this order"
        )
    return replace(solution, vectors=vectors), tuple(notes)


def _groups(solution: EigenSolution) -> Iterator[list[int]]:
    values, taken = solution.eigenvalues, set[int]()
    for first in range(len(values)):
        if first in taken or solution.kinds[first] == RIGID:
            continue
        close = np.abs(values[first:] - values[first]) <= EQUAL * abs(values[first])
        group = [first + int(i) for i in np.flatnonzero(close) if solution.kinds[first + i] != RIGID]
        taken.update(group)
        if len(group) > 1:
            yield group


def _nodes_apart(shapes: ComplexArray) -> list[int] | None:
    """As many nodes as there are shapes (n_nodes, m) at which these are most independent; None if they are not."""
    # Of an orthonormal basis every choice has the same rows, so that it makes no difference which shapes came out.
    left, sizes, _ = np.linalg.svd(shapes, full_matrices=False)
    if len(sizes) < shapes.shape[1] or sizes[-1] <= INDEPENDENT * sizes[0]:
        return None
    chosen: list[int] = []
    for _ in range(shapes.shape[1]):
        size = np.linalg.norm(left, axis=1)
        node = int(np.argmax(size >= ALIKE * size.max()))
        chosen.append(node)
        along = left[node].conj() / size[node]
        left = left - np.outer(left @ along, along.conj())
    return sorted(chosen)
