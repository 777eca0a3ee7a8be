"""Descriptions of modes in words, by elements under strain, vibration nodes and dampers, and accuracy warnings.

Choice of shapes for modes that share one eigenvalue, of which every combination is a mode shape as well.

For m modes the m nodes that move most are chosen, and each shape is 1 at one of these nodes and 0 at the others, in the
order of the nodes. The shapes are real wherever real ones exist.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.conventions import mode_numbers
from torsionnet.base.phrases import ModelName, joined, phrase
from torsionnet.linear.assembly.rows import Assembly, ComplexArray, FloatArray
from torsionnet.linear.modes.eigen import RIGID, EigenSolution

LEAST_SHARE = 0.1
"""Share of the energy of a mode from which on a description names an element, so that the description stays short."""
STILL_NODE = 1e-6
"""Angle of a node, over its neighbours or the largest, up to which the node stands still."""
LARGEST_ERROR = 1e-6
"""Relative error of an eigenvalue above which a warning about its accuracy is given."""
SHARED = (
    "{modes} share one eigenvalue, so every combination of their shapes is a mode too; shown are those in which of "
    "{nodes} only one moves, in this order"
)
"""Note on modes whose shapes are one choice of many."""
UNSTABLE = "unstable, it grows"
"""Words with which the description of a mode begins if its real part is positive."""
SAME_POLE = 1e-6
"""Relative distance of two real poles and of their shapes below which they are one that critical damping makes, as
rounding parts a double pole by the root of its size."""
ROUNDED_ANGLE = 1e-10
"""Angle of a node, over the largest, below which it is rounding and has no sign."""


def describe(
    assembly: Assembly,
    solution: EigenSolution,
    shapes: ComplexArray,
    elements: tuple[str, ...],
    strain: FloatArray,
    dissipated: FloatArray,
) -> tuple[str, ...]:
    """Words on what moves in each mode, from its shape and the shares of elements in its energies.

    Shapes are (n_nodes, n_modes), ``strain`` and ``dissipated`` (n_elements, n_modes).
    """
    sentences = []
    links = Links.of(assembly)
    crossings = links.vibration_nodes(solution.vectors)
    for index, kind in enumerate(solution.kinds):
        if kind == "rigid body":
            sentences.append(_rigid_rotation_words(assembly, shapes[:, index]))
        elif kind == "real pole":
            fall = "overdamped, time constant {time:.3g} s{more}"
            if _is_critical(solution, index):
                fall = "critically damped, time constant {time:.3g} s{more}"
            value = solution.eigenvalues[index]
            sentences.append(_decaying(fall, value, elements, strain[:, index], dissipated[:, index]))
        else:
            sentences.append(_vibration(elements, strain[:, index], crossings[index]))
    return tuple(sentences)


def with_growth(solution: EigenSolution, motions: tuple[str, ...]) -> tuple[str, ...]:
    """Description of each mode: what moves, behind the word that it is unstable where it grows."""
    pairs = zip(solution.kinds, solution.eigenvalues.real.tolist(), motions, strict=True)
    return tuple(
        joined("; ", (UNSTABLE, text)) if kind != "rigid body" and real > 0 else text for kind, real, text in pairs
    )


def convergence_warnings(solution: EigenSolution) -> tuple[str, ...]:
    """Warnings about modes that were lost, or whose frequency-dependent stiffness did not converge."""
    lost = (
        (f"{solution.missing} mode(s) could not be followed from the undamped model and are not listed",)
        if solution.missing
        else ()
    )
    if solution.converged.all():
        return lost
    stuck = ", ".join(f"{abs(value) / (2 * np.pi):.4g} Hz" for value in solution.eigenvalues[~solution.converged])
    text = f"the frequency-dependent stiffness did not settle for the mode(s) near {stuck}"
    return (*lost, f"{text}; take these frequencies from a frequency response")


def accuracy_warnings(errors: FloatArray) -> tuple[str, ...]:
    """Warning with the number and worst error of uncertain eigenvalues, empty where all are accurate."""
    count = int(np.count_nonzero(errors > LARGEST_ERROR))
    if not count:
        return ()
    text = f"{count} eigenvalues are uncertain, the worst by {errors.max():.1g} of its size"
    return (f"{text}; look for a stiffness, damping or inertia of a size far from the others",)


def _rigid_rotation_words(assembly: Assembly, shape: ComplexArray) -> str:
    still = int(np.sum(np.abs(shape) < STILL_NODE))
    return (
        "rigid-body rotation"
        if not still
        else phrase(
            "rigid-body rotation of {count} of {all} nodes", count=len(assembly.nodes) - still, all=len(assembly.nodes)
        )
    )


def _leading(elements: tuple[str, ...], shares: FloatArray) -> str:
    even = np.round(shares, 9)  # the first of equal shares
    large = np.flatnonzero(shares >= LEAST_SHARE)
    order = large[np.argsort(-even[large], kind="stable")[:3]].tolist() or [int(even.argmax())]
    return joined(
        ", ",
        (
            phrase("{name} {share:.0f} %", name=ModelName(elements[index]), share=100 * shares[index])
            for index in order
            if shares[index] > 0
        ),
    )


def _decaying(fall: str, value: complex, elements: tuple[str, ...], strain: FloatArray, dissipated: FloatArray) -> str:
    time = 1 / abs(value.real) if value.real else math.inf
    damping = _leading(elements, dissipated)
    more = [] if strain.any() else ["; no spring involved"]
    if value.real > 0:
        return joined("", (f"e times as much every {time:.3g} s", *more))
    damped = [phrase("; damped by {shares}", shares=damping)] if damping else []
    return phrase(fall, time=time, more=joined("", (*damped, *more)))


def _is_critical(solution: EigenSolution, index: int) -> bool:
    """Whether a real pole meets another one with the same shape, as both do that a vibration becomes."""
    value, shape = solution.eigenvalues[index], solution.vectors[:, index]
    near = np.abs(solution.eigenvalues - value) <= SAME_POLE * abs(value)
    apart = np.abs(solution.vectors - shape[:, None]).max(axis=0, initial=0.0)
    return int(np.sum(near & (apart <= SAME_POLE))) > 1


def _vibration(elements: tuple[str, ...], strain: FloatArray, crossings: list[str] | None) -> str:
    if not strain.any():
        return "no spring involved"
    if crossings is None:
        return phrase("strain in {shares}", shares=_leading(elements, strain))
    count, places = len(crossings), list(dict.fromkeys(crossings))
    template = "strain in {shares}; no node of vibration"
    if count:
        several = "strain in {shares}; {count} nodes of vibration{where}"
        template = several if count > 1 else "strain in {shares}; 1 node of vibration{where}"
    where = joined("", (" ", joined(", ", places))) if 0 < len(places) <= 3 else ""
    return phrase(template, shares=_leading(elements, strain), count=count, where=where)


@dataclass(frozen=True)
class Links:
    """Elastic elements between two coordinates, by whose twist the vibration nodes of a mode are counted.

    They twist by a * first - b * second; ``inside`` are words for a vibration node in each.

    Nodes that are rigidly geared together are one coordinate. ``wide`` says that a law ties three coordinates, or that
    a continuous shaft has nodes of vibration inside.
    """

    names: tuple[str, ...]
    inside: tuple[str, ...]
    ends: NDArray[np.int_]
    factors: NDArray[np.float64]
    wide: bool

    @classmethod
    def of(cls, assembly: Assembly) -> Links:
        """Elastic elements of an assembly between two coordinates each."""
        laws = zip(assembly.owners, assembly.laws, assembly.system.sparse_rows, strict=True)
        elastic = [(owner, row) for owner, law, row in laws if law.is_elastic and len(row) > 1]
        pairs = [(owner, row) for owner, row in elastic if len(row) == 2]
        ends = np.array([list(row) for _, row in pairs], dtype=int).reshape(-1, 2)
        factors = np.array([list(row.values()) for _, row in pairs]).reshape(-1, 2)
        inside = tuple(phrase("in {element}", element=ModelName(owner)) for owner, _ in pairs)
        names = assembly.kinematics.coordinates
        waves = any(table.is_continuous for _, table in assembly.system.dynamic)
        return cls(names, inside, ends, factors * [1.0, -1.0], wide=len(pairs) < len(elastic) or waves)

    def vibration_nodes(self, motions: ComplexArray) -> list[list[str] | None]:
        """Vibration nodes of motions (n_q, n) in words, ``in shaft``, or ``at wheel`` where a wheel stands still.

        Angles at both ends of an elastic element are compared over its ratio, after a complex shape was rotated to its
        main phase. None where they cannot be counted: an element ties three coordinates, or is a continuous shaft.
        """
        if self.wide:
            return [None] * motions.shape[1]
        # A complex shape is turned to the phase in which the sum of its squares is real.
        angle = (motions * np.exp(-0.5j * np.angle(np.sum(motions**2, axis=0)))).real
        angle = np.where(np.abs(angle) > ROUNDED_ANGLE * np.abs(angle).max(axis=0, initial=0.0), angle, 0.0)
        first, second = (self.factors[:, end, None] * angle[self.ends[:, end]] for end in (0, 1))
        size = np.abs(first), np.abs(second)
        crossing = (first * second < 0) & (np.minimum(*size) > STILL_NODE * np.maximum(*size))
        # A coordinate that stands still is a node if parts on both sides of it turn in opposite directions.
        low, high = np.zeros_like(angle), np.zeros_like(angle)
        for end, other in ((0, second), (1, first)):
            beyond = other / self.factors[:, end, None]
            np.minimum.at(low, self.ends[:, end], beyond)
            np.maximum.at(high, self.ends[:, end], beyond)
        rests = (low < 0) & (high > 0) & (np.abs(angle) <= STILL_NODE * np.minimum(-low, high))
        between = list(map(frozenset, self.ends.tolist()))
        found: list[list[str] | None] = []
        for crosses, rest in zip(crossing.T, rests.T, strict=True):
            # Parallel elements between two coordinates have one vibration node together.
            inside: dict[frozenset[int], str] = {}
            for number in np.flatnonzero(crosses).tolist():
                inside.setdefault(between[number], self.inside[number])
            still = (phrase("at {node}", node=ModelName(self.names[node])) for node in np.flatnonzero(rest).tolist())
            found.append([*inside.values(), *still])
        return found


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
        # The inverse at the chosen nodes makes each shape 1 at its own node and 0 at the others.
        vectors[:, group] = vectors[:, group] @ np.linalg.inv(motion[np.ix_(chosen, group)])
        names = " and ".join([", ".join(nodes[i] for i in chosen[:-1]), nodes[chosen[-1]]])
        notes.append(phrase(SHARED, modes=_named(solution, group), nodes=names))
    return replace(solution, vectors=vectors), tuple(notes)


def _named(solution: EigenSolution, group: Sequence[int]) -> str:
    """Modes of a group by their numbers, or real poles, which have none, by their eigenvalue."""
    numbers = mode_numbers(solution.kinds)
    known = [str(numbers[i]) for i in group if numbers[i] is not None]
    if known:
        return phrase("modes {first} and {last}", first=", ".join(known[:-1]), last=known[-1])
    return f"{len(group)} real poles at {solution.eigenvalues[group[0]].real:.6g} rad/s"


def _groups(solution: EigenSolution) -> Iterator[list[int]]:
    values, taken = solution.eigenvalues, set[int]()
    sizes = np.sort(np.abs(values))
    if not np.any(np.diff(sizes) <= EQUAL_EIGENVALUES * sizes[1:]):
        return
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
        # What the chosen node fixes is taken out of all shapes, as by Gram and Schmidt.
        along = left[node].conj() / size[node]
        left = left - np.outer(left @ along, along.conj())
    return sorted(chosen)
