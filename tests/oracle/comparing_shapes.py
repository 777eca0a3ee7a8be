"""Mode shapes of the package beside the motions that D leaves without torque at an eigenvalue."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf, isfinite
from typing import Any

from flint import acb, arb

from oracle.calls import TOLERANCE, Context
from oracle.elimination import SingularError, solve
from oracle.exact import ball, precision
from oracle.poles import Poles
from oracle.solution import Mechanics

BITS, NEAR = 800, 200
"""Precision, and the distance 2^-NEAR of the eigenvalue at which any load gives its shape."""
EPSILON = 2.0**-52
ROUNDINGS = 1e4


def compare_shapes(context: Context, modes: Any, every: Sequence[complex]) -> None:
    """All nodes in the modes that stand apart from the others; ``every`` has the conjugates too.

    A shape is 1 where it is largest, and known to the rounding of the model over the distance to the next eigenvalue;
    one that is many decades slower than the fastest, in which all but nothing moves, to rounding times these decades.
    """
    mechanics, name = context.mechanics, "mode shapes"
    fastest = max((abs(z) for z in every), default=0.0)
    for i, kind in enumerate(modes.kinds):
        z = complex(modes.eigenvalues[i])
        if kind == "rigid body" or not z:
            continue
        gap = min((abs(z - other) / max(abs(z), abs(other)) for other in every if other != z), default=1.0)
        if sum(other == z for other in every) > 1 or gap < 1e-6:
            continue
        exact = shape(mechanics, z)
        if exact is None:
            continue
        given = {node: complex(value) for node, value in zip(modes.nodes, modes.shapes[:, i], strict=True)}
        right = scaled(exact, given)
        off = max(abs(given[node] - value) if isfinite(abs(given[node])) else inf for node, value in right.items())
        if off <= TOLERANCE + ROUNDINGS * EPSILON / gap + EPSILON * fastest / abs(z):
            context.agreed(name, off, len(exact))
        else:
            context.wrong(name, f"of {z}", str(right), str(given), off)


def shape(mechanics: Mechanics, z: complex) -> Mapping[str, acb] | None:
    """Motion of all nodes at the eigenvalue next to z, to any scale."""
    poles = Poles(mechanics)
    with precision(BITS):
        s = acb(ball(z.real), ball(z.imag))
        try:
            for _ in range(4):
                s = (s - poles.step(s * (1 + arb(2) ** -NEAR))).mid()
            load = {node: acb(1 + k) / (3 + k * k) for k, node in enumerate(mechanics.nodes)}
            (motion,) = solve(mechanics.entries(s * (1 + arb(2) ** -NEAR)), mechanics.order, [load])
        except (SingularError, ZeroDivisionError):
            return None
        return {node: motion[node] for node in mechanics.nodes}


def scaled(exact: Mapping[str, acb], given: Mapping[str, complex]) -> dict[str, complex]:
    """The exact shape, equal to the given one where that is largest."""
    largest = max(given, key=lambda node: abs(given[node]))
    with precision(BITS):
        return {node: complex(value / exact[largest]) * given[largest] for node, value in exact.items()}
