"""Choice of shapes for modes that share one eigenvalue, of which every combination is a mode shape as well.

For m modes the m nodes that move most are chosen, and each shape is 1 at one of these nodes and 0 at the others, in the
order of the nodes. The shapes are real wherever real ones exist.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from torsionnet.assembly.rows import ComplexArray
from torsionnet.response.mode_numbers import mode_numbers
from torsionnet.solve.modes.eigen import RIGID, EigenSolution

EQUAL_EIGENVALUES = 1e-9
"""Relative difference of eigenvalues below which they are one repeated eigenvalue, as rounding splits them that far."""
LEAST_INDEPENDENCE = 1e-6
"""Ratio of singular values below which mode shapes are linearly dependent, as of a repeated pole with too few
shapes."""
EQUAL_MOTION = 1 - 1e-9
"""Motion of a node, over the largest, from which on nodes move equally, so that the first in the model is chosen."""


def with_chosen_shapes(
    solution: EigenSolution, motion: ComplexArray, nodes: Sequence[str]
) -> tuple[EigenSolution, tuple[str, ...]]:
    """Modes with chosen shapes where several share an eigenvalue, and a note for every such eigenvalue.

    Parameters
    ----------
    solution : EigenSolution
    motion : (n_nodes, n_modes) complex array
        Angles of the shapes at all nodes.
    nodes : sequence of str
    """
    vectors, notes = solution.vectors.copy(), []
    for group in _groups(solution):
        chosen = _nodes_apart(motion[:, group])
        if chosen is None:
            continue
        vectors[:, group] = vectors[:, group] @ np.linalg.inv(motion[np.ix_(chosen, group)])
        names = " and ".join([", ".join(nodes[i] for i in chosen[:-1]), nodes[chosen[-1]]])
        notes.append(
            f"{_named(solution, group)} share one eigenvalue, so every combination of their shapes is a mode too; "
            f"shown are those in which of {names} only one moves, in this order"
        )
    return replace(solution, vectors=vectors), tuple(notes)


def _named(solution: EigenSolution, group: Sequence[int]) -> str:
    """Modes of a group by their numbers, or real poles, which have none, by their eigenvalue."""
    numbers = mode_numbers(solution.kinds)
    known = [str(numbers[i]) for i in group if numbers[i] is not None]
    if known:
        return f"modes {', '.join(known[:-1])} and {known[-1]}"
    return f"{len(group)} real poles at {solution.eigenvalues[group[0]].real:.6g} rad/s"


def _groups(solution: EigenSolution) -> Iterator[list[int]]:
    values, taken = solution.eigenvalues, set[int]()
    for first in range(len(values)):
        if first in taken or solution.kinds[first] == RIGID:
            continue
        close = np.abs(values[first:] - values[first]) <= EQUAL_EIGENVALUES * abs(values[first])
        group = [first + int(i) for i in np.flatnonzero(close) if solution.kinds[first + i] == solution.kinds[first]]
        taken.update(group)
        if len(group) > 1:
            yield group


def _nodes_apart(shapes: ComplexArray) -> list[int] | None:
    """Indices of the m nodes at which shapes (n_nodes, m) are most independent, or None if these are dependent."""
    # All orthonormal bases of the shapes give the same choice, whichever combination the solver returned.
    left, sizes, _ = np.linalg.svd(shapes, full_matrices=False)
    if len(sizes) < shapes.shape[1] or sizes[-1] <= LEAST_INDEPENDENCE * sizes[0]:
        return None
    chosen: list[int] = []
    for _ in range(shapes.shape[1]):
        size = np.linalg.norm(left, axis=1)
        node = int(np.argmax(size >= EQUAL_MOTION * size.max()))
        chosen.append(node)
        along = left[node].conj() / size[node]
        left = left - np.outer(left @ along, along.conj())
    return sorted(chosen)
