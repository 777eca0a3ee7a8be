"""Random drivetrains with every element in every role, and their responses from Lagrange's equations in many digits.

Angles of all nodes and torques of all rigid conditions are solved for together, so that nothing is eliminated
beforehand: neither the order of the nodes nor the choice of coordinates can hide anything.
"""

import random
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from strategies import GROUND, MP, TWO_PI, Blueprint, Mechanics, Piece, mechanics_of, number, solve

import torsionnet as tn

LINKS = (
    "spring", "spring", "damped_spring", "rigid_coupling", "gear", "gear", "compliant_gear", "gear_in_housing",
    "planetary", "differential", "damper", "hysteretic_spring",
)  # fmt: skip
LOOPS = ("spring", "damper", "compliant_gear", "differential", "planetary", "compliant_planetary")


@dataclass
class Draw:
    """Pieces drawn from one source of chance; ``decades`` is how far values of one kind lie apart."""

    chance: random.Random
    decades: float = 9.0

    def __post_init__(self) -> None:
        self.pieces, self.count = [], 1

    def size(self, middle: float) -> Fraction:
        """Three digits, spread around 10^middle."""
        exponent = middle + self.chance.uniform(-self.decades / 2, self.decades / 2)
        return Fraction(f"{10**exponent:.3g}")

    def inertia(self) -> Fraction:
        return self.size(-0.5)

    def stiffness(self) -> Fraction:
        return self.size(5.0)

    def damping(self) -> Fraction:
        return self.size(0.0)

    def ratio(self) -> Fraction:
        value = Fraction(f"{10 ** self.chance.uniform(-1, 1):.4g}")
        return value * self.chance.choice((1, -1))

    def add(self, kind: str, **values) -> None:
        self.pieces.append(Piece(kind, f"{kind}_{len(self.pieces)}", values))

    def fresh(self) -> str:
        self.count += 1
        return f"n{self.count - 1}"

    def nodes(self) -> list[str]:
        return [f"n{i}" for i in range(self.count)]

    def pair(self, a: str, b: str) -> tuple[str, str]:
        return (a, b) if self.chance.random() < 0.5 else (b, a)

    def mesh(self, compliant: bool) -> dict:
        if not compliant:
            return {"stiffness": None, "damping": None}
        return {"stiffness": self.stiffness(), "damping": self.chance.choice((Fraction(0), self.damping()))}

    def connect(self, kind: str, *at: str) -> None:
        """An element of this kind on the nodes ``at``, and on as many new ones as it needs."""
        ends = self.chance.sample(at, len(at))
        new = lambda: ends.pop() if ends else self.fresh()  # noqa: E731
        match kind:
            case "spring" | "damped_spring":
                damping = self.damping() if kind == "damped_spring" else Fraction(0)
                self.add("spring", nodes=self.pair(new(), new()), stiffness=self.stiffness(), damping=damping)
            case "hysteretic_spring":
                eta = Fraction(self.chance.randint(1, 40), 100)
                self.add(kind, nodes=self.pair(new(), new()), stiffness=self.stiffness(), loss_factor=eta)
            case "damper":
                self.add(kind, nodes=self.pair(new(), new()), damping=self.damping())
            case "rigid_coupling":
                self.add(kind, nodes=self.pair(new(), new()))
            case "gear" | "compliant_gear":
                mesh = self.mesh(kind == "compliant_gear")
                self.add("gear", nodes=self.pair(new(), new()), ratio=self.ratio(), **mesh)
            case "gear_in_housing":
                members = self.chance.sample([new(), new(), new()], 3)
                mesh = self.mesh(self.chance.random() < 0.4)
                self.add("gear", nodes=tuple(members[:2]), housing=members[2], ratio=self.ratio(), **mesh)
            case "planetary" | "compliant_planetary":
                self.planetary([new(), new(), new()], kind == "compliant_planetary" or self.chance.random() < 0.3)
            case "differential":
                members = self.chance.sample([new(), new(), new()], 3)
                locked = self.chance.random() < 0.1 and len(at) == 1
                self.add(kind, **dict(zip(("cage", "left", "right"), members, strict=True)), locked=locked)

    def planetary(self, members: list[str], compliant: bool) -> None:
        members = dict(zip(("sun", "ring", "carrier"), self.chance.sample(members, 3), strict=True))
        heavy = self.chance.random() < 0.4
        self.add(
            "planetary", **members, ratio=1 + Fraction(self.chance.randint(2, 60), 16), **self.mesh(compliant),
            planets=3, planet_inertia=self.inertia() if heavy else Fraction(0),
            planet_mass=self.inertia() if heavy else Fraction(0), orbit_radius=Fraction(1, 10),
        )  # fmt: skip

    def hold(self, node: str) -> None:
        kind = self.chance.choice(("lock", "spring", "damper"))
        if kind == "lock":
            self.add("lock", node=node)
        elif kind == "spring":
            self.add("spring", nodes=self.pair(node, GROUND), stiffness=self.stiffness(), damping=Fraction(0))
        else:
            self.add("damper", nodes=self.pair(node, GROUND), damping=self.damping())

    def blueprint(self, links: int) -> Blueprint | None:
        """A drivetrain, or nothing where chance tied it so that no motion is left, or some condition follows."""
        for _ in range(links):
            self.connect(self.chance.choice(LINKS), self.chance.choice(self.nodes()))
        for node in self.nodes():
            if self.chance.random() < 0.75:
                self.add("inertia", node=node, inertia=self.inertia())
        for _ in range(self.chance.choice((0, 0, 1, 1, 2))):
            kind = self.chance.choice(LOOPS)
            ports = 3 if kind in {"differential", "planetary", "compliant_planetary"} else 2
            if ports <= self.count:
                self.connect(kind, *self.chance.sample(self.nodes(), ports))
        for _ in range(self.chance.choice((0, 0, 1, 2))):
            self.hold(self.chance.choice(self.nodes()))
        return self.complete()

    def complete(self) -> Blueprint | None:
        """With inertias where laws leave a motion free; nothing where conditions depend on each other."""
        mechanics = Mechanics(self.pieces)
        n = len(mechanics.conditions)
        if not mechanics.degrees_of_freedom or mechanics.n - mechanics.degrees_of_freedom < n:
            return None
        for node in self.nodes():
            if mechanics.rank_of("J", "c", "k") == mechanics.degrees_of_freedom:
                break
            self.add("inertia", node=node, inertia=self.inertia())
            mechanics = Mechanics(self.pieces)
        return Blueprint(tuple(self.pieces))


def draw(chance: random.Random, links: int | None = None) -> Blueprint:
    """A drivetrain of one to ``links`` connections."""
    while True:
        made = Draw(chance, chance.choice((2.0, 5.0, 9.0)))
        blueprint = made.blueprint(links or chance.randint(1, 7))
        if blueprint is not None:
            return blueprint


@dataclass
class Lagrange:
    """Angles and multipliers of a blueprint in many digits; ``driven`` is the node whose angle is imposed, if any."""

    blueprint: Blueprint
    driven: str | None = None

    def __post_init__(self) -> None:
        parts = [(piece.name, *mechanics_of(piece)) for piece in self.blueprint.pieces]
        self.terms = [term for _, terms, _ in parts for term in terms]
        self.conditions = [(name, row) for name, _, rows in parts for row in rows]
        if self.driven:
            self.conditions.append(("drive", {self.driven: Fraction(1)}))
        nodes = [node for row in [t.row for t in self.terms] + [r for _, r in self.conditions] for node in row]
        self.nodes = tuple(dict.fromkeys(nodes))
        self.place = {node: i for i, node in enumerate(self.nodes)}

    def matrix(self, s):
        n, m = len(self.nodes), len(self.conditions)
        matrix = np.full((n + m, n + m), MP.mpc(0), object)
        for term in self.terms:
            kappa = term.kappa(s)
            for i, a in term.row.items():
                for j, b in term.row.items():
                    matrix[self.place[i], self.place[j]] += kappa * number(a) * number(b)
        for k, (_, row) in enumerate(self.conditions):
            for i, a in row.items():
                matrix[n + k, self.place[i]] = matrix[self.place[i], n + k] = MP.mpc(1) * number(a)
        return matrix

    def right(self, torque_on: str | None):
        right = np.full((len(self.nodes) + len(self.conditions), 1), MP.mpc(0), object)
        right[self.place[torque_on] if torque_on else -1, 0] = MP.mpc(1)
        return right

    def solution(self, frequency, torque_on: str | None = None, solver=solve):
        """(s, angles by node, multipliers) under a unit torque, or a unit imposed angle."""
        s = frequency if isinstance(frequency, MP.mpc) else MP.mpc(0, TWO_PI * MP.mpf(frequency))
        found = solver(self.matrix(s), self.right(torque_on))[:, 0]
        n = len(self.nodes)
        return s, dict(zip(self.nodes, found[:n], strict=True)), found[n:]

    def reading(self, sensor: tn.Sensor, solution, ports):
        """The value of a sensor; ``ports`` (node, sign) of an element's port."""
        s, angles, multipliers = solution
        if sensor.quantity in ("angle", "velocity", "acceleration"):
            return angles[sensor.of] * s ** ("angle", "velocity", "acceleration").index(sensor.quantity)
        node, sign = ports[sensor.of, sensor.at]
        total = MP.mpc(0)
        for term in self.terms:
            if term.owner == sensor.of and node in term.row:
                twist = sum((number(a) * angles[i] for i, a in term.row.items()), MP.mpc(0))
                total += number(term.row[node]) * term.kappa(s) * twist
        for (owner, row), multiplier in zip(self.conditions, multipliers, strict=True):
            if owner == sensor.of and node in row:
                total += number(row[node]) * multiplier
        return sign * total


def sensors_of(drivetrain: tn.Drivetrain):
    """Angle, velocity and acceleration of every node, torque of every element at every port; and (node, sign) of ports."""
    sensors = [tn.Sensor(q, node) for node in drivetrain.nodes for q in ("angle", "velocity", "acceleration")]
    ports = {}
    for name, element in drivetrain.elements.items():
        for index, (port, node) in enumerate(element.ports.items()):
            if node != GROUND:
                sensors.append(tn.Sensor("torque", name, at=port))
                ports[name, port] = node, 1 if index == 0 else -1
    return sensors, ports
