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
            crossings = vibration_nodes(assembly, shapes[:, index])
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


def _vibration(elements: tuple[str, ...], strain: FloatArray, crossings: list[str]) -> str:
    count = len(crossings)
    nodes = "no node of vibration" if not count else f"{count} node{'s' if count > 1 else ''} of vibration"
    places = list(dict.fromkeys(crossings))
    where = f" {', '.join(places)}" if 0 < len(places) <= 3 else ""  # noqa: PLR2004
    return f"strain in {_leading(elements, strain)}; {nodes}{where}"


def vibration_nodes(assembly: Assembly, shape: ComplexArray) -> list[str]:
    """Where the angle, referred over the ratios, changes its sign: ``in shaft``, or ``at wheel`` if it stands still.

    A complex shape is turned to its main phase first.
    """
    turned = (shape * np.exp(-0.5j * np.angle(np.sum(shape**2)))).real
    angle = dict(zip(assembly.nodes, turned, strict=True))
    limit = STILL * float(np.abs(turned).max(initial=0.0))
    crossings: dict[frozenset[str], str] = {}
    around: dict[str, list[float]] = {}
    for owner, law in assembly.kinematics.laws:
        if len(law.row) != 2 or not law.is_elastic:  # noqa: PLR2004
            continue
        (first, a), (second, b) = law.row.items()
        left, right = float(a) * angle[first], -float(b) * angle[second]
        if min(abs(left), abs(right)) > limit and left * right < 0:
            crossings.setdefault(frozenset(law.row), f"in {owner}")
        around.setdefault(first, []).append(right)
        around.setdefault(second, []).append(left)
    still = [
        node
        for node, values in around.items()
        if abs(angle[node]) <= limit and min(values) < -limit and max(values) > limit
    ]
    return [*crossings.values(), *(f"at {node}" for node in still)]
