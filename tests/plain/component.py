"""An element as a model file has it, beside the laws that are documented of it."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from flint import acb, arb

Row = Mapping[str, Any]
Value = Callable[[Any], acb]
"""A number, or the name of a parameter, to what it is worth."""


@dataclass(frozen=True)
class Law:
    """Torque kappa(s) times the motion ``sensed``, on the nodes as ``driven`` says; both are the same but for active laws."""

    driven: Row
    kappa: Callable[[acb], acb]
    sensed: Row | None = None


@dataclass(frozen=True)
class Equations:
    """What an element does: laws, and motions that it holds at zero."""

    laws: Sequence[Law] = ()
    held: Sequence[Row] = ()


@dataclass(frozen=True)
class Component:
    """Entries of a model file; ``equations`` makes the laws from values of parameters. ``sign`` is that of its torque."""

    entries: Mapping[str, Any]
    equations: Callable[[Value], Equations]
    port: str
    sign: int = 1
    is_rational: bool = True
    roots: Callable[[Value], Sequence[acb]] = field(default=lambda _: ())
    """Poles of its law, where it has some."""

    @property
    def kind(self) -> str:
        return str(self.entries["type"])

    def renamed(self, nodes: Mapping[str, str], prefix: str) -> Component:
        """As one of a part: other nodes at the ports, and a prefix before what is inside."""

        def node(name: str) -> str:
            return name if name == "ground" else nodes.get(name, prefix + name)

        def row(given: Row | None) -> Row | None:
            return None if given is None else combined(*((node(name), x) for name, x in given.items()))

        def inside(value: Value) -> Value:
            return lambda one: value(prefix + one if isinstance(one, str) else one)

        def equations(value: Value) -> Equations:
            found = self.equations(inside(value))
            laws = [Law(row(law.driven) or {}, law.kappa, row(law.sensed)) for law in found.laws]
            return Equations(laws, [row(one) or {} for one in found.held])

        return Component(
            self.entries, equations, node(self.port), self.sign, self.is_rational, lambda v: self.roots(inside(v))
        )


def combined(*terms: tuple[str, Any]) -> dict[str, Any]:
    """A row; what stands on one node twice is added."""
    found: dict[str, Any] = {}
    for node, factor in terms:
        found[node] = found[node] + factor if node in found else factor
    return found


def twist(a: str, b: str) -> dict[str, Any]:
    return combined((a, 1), (b, -1))


def inertia(node: str, J: acb) -> Law:
    return Law({node: 1}, lambda s: J * s * s)


def spring(a: str, b: str, k: acb, c: acb | int = 0) -> Law:
    return Law(twist(a, b), lambda s: k + c * s)


def hertz(s: acb) -> arb:
    return s.imag / (2 * arb.pi())


class Draw:
    """Numbers, parameters and names out of one source of chance."""

    def __init__(self, chance: random.Random) -> None:
        self.chance = chance
        self.parameters: dict[str, float] = {}

    def sometimes(self, share: float) -> bool:
        return self.chance.random() < share

    def pick(self, *choices: Any) -> Any:
        return self.chance.choice(choices)

    def plain(self, low: float, high: float) -> float:
        """Three digits, spread evenly over the powers of ten."""
        return float(f"{10 ** self.chance.uniform(math.log10(low), math.log10(high)):.3g}")

    def number(self, low: float, high: float) -> float | str:
        """A number, often as a parameter."""
        found = self.plain(low, high)
        if self.sometimes(0.5):
            return found
        name = f"p{len(self.parameters)}"
        self.parameters[name] = found
        return name

    def maybe(self, share: float, entry: str, low: float, high: float) -> dict[str, Any]:
        return {entry: self.number(low, high)} if self.sometimes(share) else {}

    def rows(self, low: float, high: float, count: int) -> list[float]:
        """Increasing numbers."""
        return sorted({self.plain(low, high) for _ in range(count)})

    @property
    def J(self) -> float | str:
        return self.number(0.02, 5)

    @property
    def k(self) -> float | str:
        return self.number(1e3, 1e6)

    @property
    def c(self) -> float | str:
        return self.number(0.2, 200)


def straight(rows: Sequence[tuple[float, float]], at: float) -> tuple[float, float]:
    """Value and slope of straight lines between the rows."""
    for (x0, y0), (x1, y1) in pairwise(rows):
        if x0 <= at <= x1:
            slope = (y1 - y0) / (x1 - x0)
            return y0 + slope * (at - x0), slope
    raise ValueError("beyond the rows")


def powers(rows: Sequence[tuple[float, float]], f: arb) -> arb:
    """Between the rows by powers of the frequency, constant beyond them."""
    if not f > rows[0][0]:
        return arb(rows[0][1])
    for (x0, y0), (x1, y1) in pairwise(rows):
        if not f > x1:
            share = (f / x0).log() / (arb(x1) / x0).log()
            return arb(y0) * (arb(y1) / y0) ** share
    return arb(rows[-1][1])


def pi() -> acb:
    return acb(arb.pi())
