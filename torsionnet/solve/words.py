"""A sentence about each mode: what strains, what swings against what, what damps."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.assembly.system import Assembly
from torsionnet.solve.eigen import EigenSolution

NOTEWORTHY = 0.1
STILL = 1e-6


def describe(
    assembly: Assembly,
    solution: EigenSolution,
    shapes: ComplexArray,
    elements: tuple[str, ...],
    strain: FloatArray,
    dissipated: FloatArray,
) -> tuple[str, ...]:
    """One description per mode; ``shapes`` (n_nodes, n_modes), shares (n_elements, n_modes)."""
    sentences = []
    links = Links.of(assembly)
    for index, kind in enumerate(solution.kinds):
        if kind == "rigid body":
            sentences.append(_rigid(assembly, shapes[:, index]))
        elif kind == "real pole":
            sentences.append(_overdamped(solution.eigenvalues[index], elements, strain[:, index], dissipated[:, index]))
        else:
            crossings = links.vibration_nodes(shapes[:, index])
            grows = "unstable, it grows; " if solution.eigenvalues[index].real > 0 else ""
            sentences.append(grows + _vibration(elements, strain[:, index], crossings))
    return tuple(sentences)


def _rigid(assembly: Assembly, shape: ComplexArray) -> str:
    still = int(np.sum(np.abs(shape) < STILL))
    return (
        "rigid-body rotation"
        if not still
        else f"rigid-body rotation of {len(assembly.nodes) - still} of {len(assembly.nodes)} nodes"
    )


def _leading(elements: tuple[str, ...], shares: FloatArray) -> str:
    largest = np.argsort(-np.round(shares, 9), kind="stable")[:3]  # of equal ones the first
    order = [index for index in largest if shares[index] >= NOTEWORTHY] or list(largest[:1])
    return ", ".join(f"{elements[index]} {100 * shares[index]:.0f} %" for index in order if shares[index] > 0)


def _overdamped(value: complex, elements: tuple[str, ...], strain: FloatArray, dissipated: FloatArray) -> str:
    time = 1 / abs(value.real) if value.real else math.inf
    damping = _leading(elements, dissipated)
    text = f"overdamped, time constant {time:.3g} s"
    text += f"; damped by {damping}" if damping else ""
    return text if strain.any() else f"{text}; no spring involved"


def _vibration(elements: tuple[str, ...], strain: FloatArray, crossings: list[str]) -> str:
    count = len(crossings)
    nodes = "no node of vibration" if not count else f"{count} node{'s' if count > 1 else ''} of vibration"
    places = list(dict.fromkeys(crossings))
    where = f" {', '.join(places)}" if 0 < len(places) <= 3 else ""  # noqa: PLR2004
    return f"strain in {_leading(elements, strain)}; {nodes}{where}"


@dataclass(frozen=True)
class Links:
    """The elastic laws between two nodes: left = a * angle[first], right = -b * angle[second]."""

    nodes: tuple[str, ...]
    owners: tuple[str, ...]
    ends: NDArray[np.int_]
    factors: NDArray[np.float64]

    @classmethod
    def of(cls, assembly: Assembly) -> Links:
        laws = [(owner, law.row) for owner, law in assembly.kinematics.laws if len(law.row) == 2 and law.is_elastic]  # noqa: PLR2004
        ends = np.array([[assembly.node_index[node] for node in row] for _, row in laws], dtype=int)
        factors = np.array([[float(factor) for factor in row.values()] for _, row in laws])
        owners = tuple(owner for owner, _ in laws)
        return cls(assembly.nodes, owners, ends.reshape(-1, 2), factors.reshape(-1, 2) * [1.0, -1.0])

    def vibration_nodes(self, shape: ComplexArray) -> list[str]:
        """Where the angle, referred over the ratios, changes its sign: ``in shaft``, or ``at wheel`` if it rests.

        A complex shape is turned to its main phase first.
        """
        angle = (shape * np.exp(-0.5j * np.angle(np.sum(shape**2)))).real
        limit = STILL * float(np.abs(angle).max(initial=0.0))
        sides = self.factors * angle[self.ends]
        crossing = (np.abs(sides).min(axis=1) > limit) & (sides[:, 0] * sides[:, 1] < 0)
        crossings: dict[frozenset[int], str] = {}
        for number in np.flatnonzero(crossing):
            crossings.setdefault(frozenset(self.ends[number].tolist()), f"in {self.owners[number]}")
        around: dict[int, list[float]] = {}
        for number in np.flatnonzero((np.abs(angle[self.ends]) <= limit).any(axis=1)):
            for node, beyond in zip(self.ends[number].tolist(), sides[number, ::-1].tolist(), strict=True):
                around.setdefault(node, []).append(beyond)
        still = [
            self.nodes[node]
            for node, values in around.items()
            if abs(angle[node]) <= limit and min(values) < -limit and max(values) > limit
        ]
        return [*crossings.values(), *(f"at {node}" for node in still)]
