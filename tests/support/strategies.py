"""Random valid drivetrains, and their mechanics from first principles.

A :class:`Blueprint` is plain data: pieces with exact values. It makes a drivetrain through the public API, and
:class:`Mechanics` calculates the same from Lagrange's equations in 100 digits: rows of all laws, an exact null space of
all rigid conditions, nothing taken from the package.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Any

import mpmath
import numpy as np
from hypothesis import strategies as st

import torsionnet as tn

GROUND = "ground"
CLASSES = {
    "inertia": tn.Inertia,
    "spring": tn.Spring,
    "damper": tn.Damper,
    "hysteretic_spring": tn.HystereticSpring,
    "tabulated_spring": tn.TabulatedSpring,
    "gear": tn.Gear,
    "planetary": tn.Planetary,
    "differential": tn.Differential,
    "rigid_coupling": tn.RigidCoupling,
    "lock": tn.Lock,
    "shaft": tn.Shaft,
}
PORTS = {
    "planetary": ("sun", "ring", "carrier"),
    "differential": ("cage", "left", "right"),
    "inertia": ("node",),
    "lock": ("node",),
    "gear": ("nodes", "housing"),
}
MP = mpmath.MPContext()
MP.dps = 100
TWO_PI = 2 * MP.pi


# --- plain data -----------------------------------------------------------------------------------------------------


def written(value: Any) -> Any:
    """A value as the API takes it: a float where its shortest decimal is exact, else a quotient."""
    if not isinstance(value, Fraction):
        return value
    number = float(value)
    return number if Fraction(repr(number)) == value else f"{value.numerator}/{value.denominator}"


@dataclass(frozen=True)
class Piece:
    """One element: its kind, name and arguments."""

    kind: str
    name: str
    values: Mapping[str, Any] = field(default_factory=dict)

    @property
    def nodes(self) -> tuple[str, ...]:
        """The nodes of its ports, the one that defines the sign first."""
        nodes: list[str] = []
        for port in PORTS.get(self.kind, ("nodes",)):
            at = self.values.get(port)
            nodes += [at] if isinstance(at, str) else at or []
        return tuple(nodes)

    def moved(self, place: Mapping[str, str]) -> Piece:
        """The same piece at other nodes."""
        values = dict(self.values)
        for port in PORTS.get(self.kind, ("nodes",)):
            at = values.get(port)
            if isinstance(at, str):
                values[port] = place.get(at, at)
            elif at is not None:
                values[port] = tuple(place.get(node, node) for node in at)
        return replace(self, values=values)

    def scaled(self, factor: Fraction) -> Piece:
        """All inertias, stiffnesses and dampings of it times a factor."""
        scaled = ("inertia", "stiffness", "damping", "planet_inertia", "planet_mass")
        values = {k: v * factor if k in scaled and v is not None else v for k, v in self.values.items()}
        if "table" in values:
            values["table"] = [[f, k * factor, c * factor] for f, k, c in values["table"]]
        return replace(self, values=values)

    def element(self) -> tn.Element:
        """The element of the package."""
        values = {name: written(value) for name, value in self.values.items() if value is not None}
        if self.kind == "gear" and isinstance(values["ratio"], str):
            ratio = self.values["ratio"]
            values.pop("ratio")
            values["teeth"] = (ratio.denominator, ratio.numerator)
        if "table" in values:
            values["table"] = [[written(cell) for cell in row] for row in values["table"]]
        return CLASSES[self.kind](self.name, **values)


@dataclass(frozen=True)
class Blueprint:
    """The pieces of a drivetrain."""

    pieces: tuple[Piece, ...]

    def drivetrain(self, **more: Any) -> tn.Drivetrain:
        return tn.Drivetrain("random", [piece.element() for piece in self.pieces], **more)

    def prefixed(self, prefix: str) -> Blueprint:
        """The same with other names of elements and nodes."""
        place = {node: prefix + node for node in self.nodes if node != GROUND}
        return Blueprint(tuple(replace(p.moved(place), name=prefix + p.name) for p in self.pieces))

    def plus(self, *more: Blueprint | Piece) -> Blueprint:
        added = (piece for part in more for piece in (part.pieces if isinstance(part, Blueprint) else [part]))
        return Blueprint((*self.pieces, *added))

    @property
    def nodes(self) -> tuple[str, ...]:
        """Nodes of the ports in the order of their mention, without ground."""
        return tuple(dict.fromkeys(node for piece in self.pieces for node in piece.nodes if node != GROUND))

    @cached_property
    def mechanics(self) -> Mechanics:
        return Mechanics(self.pieces)


# --- mechanics ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Term:
    """kappa(s) = J s^2 + c s + k (1 + j eta) + table on the row gamma."""

    owner: str
    row: Mapping[str, Fraction]
    J: Any = 0
    c: Any = 0
    k: Any = 0
    eta: Any = 0
    table: Any = None

    def kappa(self, s: Any) -> Any:
        value = self.J * s * s + self.c * s + self.k
        if self.eta:
            value += MP.mpc(0, 1) * self.k * number(self.eta)
        if self.table:
            stiffness, damping = interpolated(self.table, abs(s.imag) / TWO_PI)
            value += stiffness + MP.mpc(0, 1) * abs(s.imag) * damping
        return value


def number(value: Any) -> Any:
    return MP.mpf(value.numerator) / value.denominator if isinstance(value, Fraction | int) else MP.mpf(value)


def interpolated(table: Any, frequency: Any) -> tuple[Any, Any]:
    rows = [[number(cell) for cell in row] for row in table]
    if frequency <= rows[0][0]:
        return rows[0][1], rows[0][2]
    for (f0, k0, c0), (f1, k1, c1) in pairwise(rows):
        if frequency <= f1:
            part = (frequency - f0) / (f1 - f0)
            return k0 + part * (k1 - k0), c0 + part * (c1 - c0)
    return rows[-1][1], rows[-1][2]


def combination(*pairs: tuple[str | None, Any]) -> dict[str, Fraction]:
    row: dict[str, Fraction] = {}
    for node, factor in pairs:
        if node is not None and node != GROUND:
            row[node] = row.get(node, Fraction(0)) + Fraction(factor)
    return {node: factor for node, factor in row.items() if factor}


def shaft_terms(piece: Piece) -> list[Term]:
    v = piece.values
    n = v["segments"]
    a, b = v["nodes"]
    stations = [a, *(f"{piece.name}.{i}" for i in range(1, n)), b]
    area = MP.pi * (number(v["outer_diameter"]) ** 4 - number(v["inner_diameter"]) ** 4) / 32
    k = number(v["shear_modulus"]) * area / number(v["length"]) * n
    J = number(v["density"]) * area * number(v["length"]) / n
    terms = []
    for left, right in pairwise(stations):
        terms.append(Term(piece.name, combination((left, 1), (right, -1)), k=k, c=number(v["damping"]) * n))
        rows = [combination((left, 1)), combination((right, 1))]
        if v["inertia"] == "lumped":
            terms += [Term(piece.name, row, J=J / 2) for row in rows]
        elif v["inertia"] == "consistent":  # J/6 (a^2 + b^2 + (a + b)^2): the integral of a linear twist squared
            terms += [Term(piece.name, row, J=J / 6) for row in (*rows, combination((left, 1), (right, 1)))]
    return terms


def mechanics_of(piece: Piece) -> tuple[list[Term], list[dict[str, Fraction]]]:
    """Laws and rigid conditions of a piece."""
    v, kind, name = piece.values, piece.kind, piece.name
    rigid = v.get("stiffness") is None
    terms: list[Term] = []
    row: dict[str, Fraction] = {}
    match kind:
        case "shaft":
            return shaft_terms(piece), []
        case "inertia":
            return [Term(name, combination((v["node"], 1)), J=number(v["inertia"]))], []
        case "lock":
            row = combination((v["node"], 1))
        case "differential" if v["locked"]:
            return [], [combination((v["cage"], 1), (v[side], -1)) for side in ("left", "right")]
        case "differential":
            row = combination((v["cage"], 2), (v["left"], -1), (v["right"], -1))
        case "planetary":
            # Willis: seen from the carrier, the sun turns -z times as fast as the ring; the planets roll on the sun
            z = v["ratio"]
            row = combination((v["sun"], 1), (v["carrier"], -1), (v["ring"], z), (v["carrier"], -z))
            share = 2 / (z - 1)  # teeth of the sun over those of a planet
            spin = combination((v["carrier"], 1), (v["sun"], -share), (v["carrier"], share))
            orbit = v["planets"] * v["planet_mass"] * v["orbit_radius"] ** 2
            terms = [
                Term(name, spin, J=number(v["planets"] * v["planet_inertia"])),
                Term(name, combination((v["carrier"], 1)), J=number(orbit)),
            ]
        case "gear" if v.get("housing"):
            # seen from the housing the first shaft turns tau times as fast as the second
            (a, b), housing, tau = v["nodes"], v["housing"], v["ratio"]
            row = combination((a, 1), (housing, -1), (b, -tau), (housing, tau))
        case "gear":
            row = combination((v["nodes"][0], 1), (v["nodes"][1], -v["ratio"]))
        case _:
            row = combination((v["nodes"][0], 1), (v["nodes"][1], -1))
            rigid = kind == "rigid_coupling"
    if rigid:
        return terms, [row]
    c, k = (number(v.get(law) or 0) for law in ("damping", "stiffness"))
    return [*terms, Term(name, row, c=c, k=k, eta=v.get("loss_factor", 0), table=v.get("table"))], []


def null_space(rows: list[list[Fraction]], n: int) -> list[list[Fraction]]:
    """Exact basis of {x: rows x = 0}, by Gauss-Jordan."""
    rows = [list(row) for row in rows]
    pivots: list[int] = []
    for column in range(n):
        pivot = next((i for i in range(len(pivots), len(rows)) if rows[i][column]), None)
        if pivot is None:
            continue
        rank = len(pivots)
        rows[rank], rows[pivot] = rows[pivot], rows[rank]
        rows[rank] = [x / rows[rank][column] for x in rows[rank]]
        for i in range(len(rows)):
            if i != rank and rows[i][column]:
                rows[i] = [x - rows[i][column] * y for x, y in zip(rows[i], rows[rank], strict=True)]
        pivots.append(column)
    basis = []
    for free in (column for column in range(n) if column not in pivots):
        vector = [Fraction(0)] * n
        vector[free] = Fraction(1)
        for i, column in enumerate(pivots):
            vector[column] = -rows[i][free]
        basis.append(vector)
    return basis


def rank(rows: list[list[Fraction]], n: int) -> int:
    return n - len(null_space(rows, n))


def solve(D: np.ndarray, B: np.ndarray) -> np.ndarray:
    """D^-1 B for object arrays of 100 digits."""
    n = len(D)
    work = np.hstack([D, B])
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(work[r, i]))
        work[[i, pivot]] = work[[pivot, i]]
        work[i, i:] = work[i, i:] / work[i, i]
        for r in range(n):
            if r != i and work[r, i] != 0:
                work[r, i:] = work[r, i:] - work[r, i] * work[i, i:]
    return work[:, n:]


class Mechanics:
    """Laws, rigid conditions and their null space; receptances in 100 digits."""

    def __init__(self, pieces: Iterable[Piece]) -> None:
        self.terms: list[Term] = []
        self.conditions: list[tuple[str, dict[str, Fraction]]] = []
        nodes: dict[str, None] = {}
        for piece in pieces:
            terms, rows = mechanics_of(piece)
            self.terms += terms
            self.conditions += [(piece.name, row) for row in rows]
            nodes |= dict.fromkeys(node for node in piece.nodes if node != GROUND)
            nodes |= dict.fromkeys(node for term in terms for node in term.row)
        self.nodes = tuple(nodes)
        self.n = len(self.nodes)
        self.basis = null_space([self.full(row) for _, row in self.conditions], self.n)

    def full(self, row: Mapping[str, Fraction]) -> list[Fraction]:
        return [row.get(node, Fraction(0)) for node in self.nodes]

    def reduced(self, row: Mapping[str, Fraction]) -> list[Fraction]:
        full = self.full(row)
        return [
            sum((x * y for x, y in zip(full, vector, strict=True) if x and y), Fraction(0)) for vector in self.basis
        ]

    @property
    def degrees_of_freedom(self) -> int:
        return len(self.basis)

    def rank_of(self, *laws: str) -> int:
        """Rank of the rows on which some of J, c, k (or a table) act."""
        rows = [
            self.reduced(term.row)
            for term in self.terms
            if any(getattr(term, law) for law in laws) or (term.table and "k" in laws)
        ]
        return rank(rows, self.degrees_of_freedom)

    @property
    def rigid_modes(self) -> int:
        return self.degrees_of_freedom - self.rank_of("k")

    def moves(self, node: str) -> bool:
        return any(vector[self.nodes.index(node)] for vector in self.basis)

    @cached_property
    def N(self) -> np.ndarray:
        """(nodes, coordinates), object array."""
        return np.array([[number(x) for x in vector] for vector in self.basis], object).reshape(-1, self.n).T

    @cached_property
    def R(self) -> np.ndarray:
        """(terms, coordinates): the rows of all laws in the coordinates."""
        rows = [[number(x) for x in self.reduced(term.row)] for term in self.terms]
        return np.array(rows, object).reshape(-1, self.degrees_of_freedom)

    def stiffness(self, s: Any) -> np.ndarray:
        kappa = np.array([term.kappa(s) for term in self.terms], object)
        return self.R.T @ (kappa[:, None] * self.R)

    def receptance(self, frequency: Any) -> np.ndarray:
        """(nodes, nodes) in 100 digits; ``frequency`` in Hz."""
        D = self.stiffness(MP.mpc(0, TWO_PI * MP.mpf(frequency)))
        return self.N @ solve(D, self.N.T)

    def receptances(self, frequencies: Iterable[float]) -> tuple[np.ndarray, np.ndarray]:
        """(f, nodes, nodes) receptances, and the change of each for relative changes of one of all coefficients."""
        values, sensitivity = [], []
        rows, N = np.abs(self.R.astype(float)), np.abs(self.N.astype(float))
        for frequency in frequencies:
            s = MP.mpc(0, TWO_PI * MP.mpf(frequency))
            G = solve(self.stiffness(s), self.N.T)
            values.append((self.N @ G).astype(complex))
            size = np.array([sum(map(abs, (t.J * s * s, t.c * s, t.kappa(s)))) for t in self.terms], float)
            reach = rows @ np.abs(G.astype(complex))
            sensitivity.append(reach.T @ (size[:, None] * reach) + N @ np.abs(G.astype(complex)))
        return np.array(values), np.array(sensitivity)


# --- strategies -----------------------------------------------------------------------------------------------------


@st.composite
def decades(draw, low: int, high: int) -> Fraction:
    """Two significant digits between 10^low and 10^high."""
    return Fraction(draw(st.integers(10, 99)), 10) * Fraction(10) ** draw(st.integers(low, high - 1))


inertias = decades(-4, 3)
stiffnesses = decades(2, 8)
dampings = decades(-2, 4)
ratios = st.builds(
    lambda p, q, sign: Fraction(p, q) * sign, st.integers(1, 60), st.integers(1, 20), st.sampled_from((1, -1))
)
speeds_up_to_ring = st.builds(lambda p, q: 1 + Fraction(p, q), st.integers(1, 40), st.sampled_from((4, 5, 10, 17)))
frequencies = st.lists(decades(-1, 3).map(float), min_size=2, max_size=3, unique=True)

TREE = (
    "spring",
    "damped_spring",
    "spring",
    "rigid_coupling",
    "gear",
    "compliant_gear",
    "gear_in_housing",
    "planetary",
    "differential",
    "damper",
    "shaft",
)
LOSSY = (*TREE, "hysteretic_spring", "tabulated_spring")
CLOSING = ("spring", "gear_loop", "compliant_gear", "damper", "rigid_loop")
HOLDS = ("spring_to_ground", "damper_to_ground", "lock", "spring_to_ground")


class _Builder:
    """Grows a drivetrain from one node; rigid trains keep their speeds so that a loop can be closed consistently."""

    def __init__(self, draw: Any) -> None:
        self.draw = draw
        self.pieces: list[Piece] = []
        self.nodes = ["n0"]
        self.body = {"n0": ("n0", Fraction(1))}

    def add(self, kind: str, **values: Any) -> None:
        self.pieces.append(Piece(kind, f"{kind}_{len(self.pieces)}", values))

    def fresh(self, carried_by: str | None = None, speed: Fraction = Fraction(1)) -> str:
        name = f"n{len(self.nodes)}"
        self.nodes.append(name)
        root, own = self.body[carried_by] if carried_by else (name, Fraction(1))
        self.body[name] = root, own * speed
        return name

    def node(self) -> str:
        return self.draw(st.sampled_from(self.nodes))

    def pair(self, a: str, b: str) -> tuple[str, str]:
        return (a, b) if self.draw(st.booleans()) else (b, a)

    def maybe(self, strategy: Any) -> Any:
        return self.draw(st.one_of(st.just(Fraction(0)), strategy))

    def mesh(self, compliant: bool) -> dict[str, Any]:
        if not compliant:
            return {"stiffness": None, "damping": None}
        return {"stiffness": self.draw(stiffnesses), "damping": self.maybe(dampings)}

    def grow(self, kind: str) -> None:
        a = self.node()
        getattr(self, f"grow_{kind}")(a)

    def grow_spring(self, a: str) -> None:
        self.add("spring", nodes=self.pair(a, self.fresh()), stiffness=self.draw(stiffnesses), damping=Fraction(0))

    def grow_damped_spring(self, a: str) -> None:
        nodes = self.pair(a, self.fresh())
        self.add("spring", nodes=nodes, stiffness=self.draw(stiffnesses), damping=self.draw(dampings))

    def grow_damper(self, a: str) -> None:
        self.add("damper", nodes=self.pair(a, self.fresh()), damping=self.draw(dampings))

    def grow_hysteretic_spring(self, a: str) -> None:
        eta = self.draw(decades(-2, 0))
        nodes = self.pair(a, self.fresh())
        self.add("hysteretic_spring", nodes=nodes, stiffness=self.draw(stiffnesses), loss_factor=eta)

    def grow_tabulated_spring(self, a: str) -> None:
        at = sorted(self.draw(st.lists(decades(0, 3), min_size=1, max_size=3, unique=True)))
        table = [[f, self.draw(stiffnesses), self.draw(dampings)] for f in at]
        self.add("tabulated_spring", nodes=self.pair(a, self.fresh()), table=table)

    def grow_rigid_coupling(self, a: str) -> None:
        self.add("rigid_coupling", nodes=self.pair(a, self.fresh(a)))

    def grow_gear(self, a: str) -> None:
        tau = self.draw(ratios)
        if self.draw(st.booleans()):
            self.add("gear", nodes=(a, self.fresh(a, 1 / tau)), ratio=tau, **self.mesh(compliant=False))
        else:
            self.add("gear", nodes=(self.fresh(a, tau), a), ratio=tau, **self.mesh(compliant=False))

    def grow_compliant_gear(self, a: str) -> None:
        self.add("gear", nodes=self.pair(a, self.fresh()), ratio=self.draw(ratios), **self.mesh(compliant=True))

    def grow_gear_in_housing(self, a: str) -> None:
        tau = self.draw(ratios.filter(lambda tau: tau != 1))
        mesh = self.mesh(compliant=self.draw(st.booleans()))
        members = self.draw(st.permutations([a, self.fresh(), self.draw(st.sampled_from((GROUND, self.fresh())))]))
        if members[2] == GROUND:
            members[0], members[2] = members[2], members[0]
        self.add("gear", nodes=tuple(members[:2]), housing=members[2], ratio=tau, **mesh)
        self.nodes = [node for node in self.nodes if node == "n0" or any(node in p.nodes for p in self.pieces)]

    def grow_planetary(self, a: str) -> None:
        b, c = self.fresh(), self.fresh()
        held = self.draw(st.sampled_from(("free", "ground", "lock", "spring")))
        if held == "ground":
            self.nodes.remove(c)
            c = GROUND
        members = dict(zip(("sun", "ring", "carrier"), self.draw(st.permutations([a, b, c])), strict=True))
        self.add(
            "planetary",
            **members,
            ratio=self.draw(speeds_up_to_ring),
            **self.mesh(compliant=self.draw(st.booleans())),
            planets=self.draw(st.integers(1, 5)),
            planet_inertia=self.maybe(decades(-5, 0)),
            planet_mass=self.maybe(decades(-2, 2)),
            orbit_radius=self.draw(decades(-2, 0)),
        )
        if held == "lock":
            self.add("lock", node=c)
        elif held == "spring":
            self.add("spring", nodes=(c, GROUND), stiffness=self.draw(stiffnesses), damping=self.maybe(dampings))

    def grow_differential(self, a: str) -> None:
        locked = self.draw(st.booleans())
        others = [self.fresh(a if locked else None) for _ in range(2)]
        members = self.draw(st.permutations([a, *others]))
        self.add("differential", **dict(zip(("cage", "left", "right"), members, strict=True)), locked=locked)

    def grow_shaft(self, a: str) -> None:
        outer = self.draw(decades(-2, 0))
        self.add(
            "shaft",
            nodes=self.pair(a, self.fresh()),
            outer_diameter=outer,
            inner_diameter=outer * self.draw(st.sampled_from((Fraction(0), Fraction(1, 2)))),
            length=self.draw(decades(-1, 1)),
            shear_modulus=Fraction(793) * 10**8,
            density=Fraction(7850),
            segments=self.draw(st.integers(1, 3)),
            inertia=self.draw(st.sampled_from(("consistent", "lumped", "none"))),
            damping=self.maybe(dampings),
        )

    def close(self, kind: str) -> None:
        """A loop: an elastic one, a compliant mesh of any ratio, or rigid gears whose ratios agree."""
        pairs = [(a, b) for a in self.nodes for b in self.nodes if a < b]
        if kind in {"gear_loop", "rigid_loop"}:
            pairs = [(a, b) for a, b in pairs if self.body[a][0] == self.body[b][0]]
        if not pairs:
            return
        a, b = self.draw(st.sampled_from(pairs))
        tau = self.body[a][1] / self.body[b][1]
        if kind == "spring":
            self.add("spring", nodes=(a, b), stiffness=self.draw(stiffnesses), damping=self.maybe(dampings))
        elif kind == "damper":
            self.add("damper", nodes=(a, b), damping=self.draw(dampings))
        elif kind == "compliant_gear":
            self.add("gear", nodes=(a, b), ratio=self.draw(ratios), **self.mesh(compliant=True))
        elif kind == "gear_loop":
            self.add("gear", nodes=(a, b), ratio=tau, **self.mesh(compliant=True))
        else:
            self.add("gear", nodes=(a, b), ratio=tau, **self.mesh(compliant=False))

    def hold(self, kind: str) -> None:
        a = self.node()
        if kind == "lock":
            self.add("lock", node=a)
        elif kind == "damper_to_ground":
            self.add("damper", nodes=self.pair(a, GROUND), damping=self.draw(dampings))
        else:
            values = {"stiffness": self.draw(stiffnesses), "damping": self.maybe(dampings)}
            self.add("spring", nodes=self.pair(a, GROUND), **values)

    def fill(self, *laws: str, kind: str) -> None:
        """Inertias (or springs to ground) until the named laws act on every motion."""
        for node in [n for n in self.nodes if n != GROUND]:
            mechanics = Mechanics(self.pieces)
            if mechanics.rank_of(*laws) == mechanics.degrees_of_freedom:
                return
            if kind == "inertia":
                self.add("inertia", node=node, inertia=self.draw(inertias))
            else:
                self.add("spring", nodes=(node, GROUND), stiffness=self.draw(stiffnesses), damping=Fraction(0))


@st.composite
def blueprints(
    draw,
    *,
    kinds: tuple[str, ...] = TREE,
    closing: tuple[str, ...] = CLOSING,
    holds: tuple[str, ...] = HOLDS,
    size: int = 4,
    held: bool = False,
    heavy: bool = False,
) -> Blueprint:
    """Drivetrains of one part, valid by construction.

    ``held``: springs to ground are added until a static torque moves nothing without end; ``heavy``: an inertia on
    every node. Otherwise massless nodes, free and held drivetrains all occur.
    """
    builder = _Builder(draw)
    for kind in draw(st.lists(st.sampled_from(kinds), min_size=1, max_size=size)):
        builder.grow(kind)
    for node in builder.nodes:
        if heavy or draw(st.integers(0, 3)):
            builder.add("inertia", node=node, inertia=draw(inertias))
    if closing:
        for kind in draw(st.lists(st.sampled_from(closing), max_size=2)):
            builder.close(kind)
    if holds:
        for kind in draw(st.lists(st.sampled_from(holds), max_size=2)):
            builder.hold(kind)
    if not Mechanics(builder.pieces).degrees_of_freedom:
        builder.pieces = [piece for piece in builder.pieces if piece.kind != "lock"]
    builder.fill("J", "c", "k", kind="inertia")
    if held:
        builder.fill("k", kind="spring")
    return Blueprint(tuple(builder.pieces))


def matching(mechanics: Mechanics, nodes: Iterable[str]) -> np.ndarray:
    """Indices of nodes in the order of the mechanics."""
    return np.array([mechanics.nodes.index(node) for node in nodes])
