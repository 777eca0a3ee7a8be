"""A sentence about each mode: what strains, what swings against what, what damps."""

from __future__ import annotations

import math

import numpy as np

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
    for index, kind in enumerate(solution.kinds):
        if kind == "rigid body":
            sentences.append(_rigid(assembly, shapes[:, index]))
        elif kind == "real pole":
            sentences.append(_overdamped(solution.eigenvalues[index], elements, strain[:, index], dissipated[:, index]))
        else:
            crossings = vibration_nodes(assembly, solution.vectors[:, index])
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
    order = [index for index in np.argsort(-shares) if shares[index] >= NOTEWORTHY][:3]
    order = order or list(np.argsort(-shares)[:1])
    return ", ".join(f"{elements[index]} {100 * shares[index]:.0f} %" for index in order if shares[index] > 0)


def _overdamped(value: complex, elements: tuple[str, ...], strain: FloatArray, dissipated: FloatArray) -> str:
    time = 1 / abs(value.real) if value.real else math.inf
    damping = _leading(elements, dissipated)
    text = f"overdamped, time constant {time:.3g} s"
    text += f"; damped by {damping}" if damping else ""
    return text if strain.any() else f"{text}; no spring involved"


def _vibration(elements: tuple[str, ...], strain: FloatArray, crossings: list[str] | None) -> str:
    if crossings is None:
        return f"strain in {_leading(elements, strain)}"
    count = len(crossings)
    nodes = "no node of vibration" if not count else f"{count} node{'s' if count > 1 else ''} of vibration"
    places = list(dict.fromkeys(crossings))
    where = f" {', '.join(places)}" if 0 < len(places) <= 3 else ""  # noqa: PLR2004
    return f"strain in {_leading(elements, strain)}; {nodes}{where}"


def vibration_nodes(assembly: Assembly, motion: ComplexArray) -> list[str] | None:
    """Where the motion changes its sense: ``in shaft``, or ``at wheel`` if a node stands still.

    ``motion`` (n_q,) is over coordinates, so that what is rigidly geared together counts as one wheel, and angles
    either side of an elastic element are compared over its ratio. A complex shape is turned to its main phase first.
    None where an elastic element ties three coordinates, for which there is no such count.
    """
    turned = (motion * np.exp(-0.5j * np.angle(np.sum(motion**2)))).real
    moves = dict(zip(assembly.kinematics.coordinates, turned, strict=True))
    crossings: dict[frozenset[str], str] = {}
    around: dict[str, list[float]] = {}
    for owner, law, row in zip(assembly.owners, assembly.laws, assembly.exact_rows, strict=True):
        if not law.is_elastic or len(row) < 2:  # noqa: PLR2004
            continue
        if len(row) > 2 or not row.keys() <= moves.keys():  # noqa: PLR2004
            return None
        (first, a), (second, b) = row.items()
        left, right = float(a) * moves[first], -float(b) * moves[second]
        around.setdefault(first, []).append(right / float(a))
        around.setdefault(second, []).append(-left / float(b))
        if left * right < 0 and min(abs(left), abs(right)) > STILL * max(abs(left), abs(right)):
            crossings.setdefault(frozenset(row), f"in {owner}")
    still = [node for node, near in around.items() if _stands(moves[node], near)]
    return [*crossings.values(), *(f"at {node}" for node in still)]


def _stands(here: float, near: list[float]) -> bool:
    """Whether a coordinate rests between neighbours that swing against each other."""
    return min(near) < 0 < max(near) and abs(here) <= STILL * min(-min(near), max(near))
